"""What the fields of a large mesh cost; product and search are in ``test_bars.py``."""

import numpy as np
import pytest

from mission.steering.facet_control import affine_fields, exit_velocities, stay_velocities
from tests.support.measuring import seconds, timed
from tests.support.searches import mesh

ROUNDS = 9


@pytest.mark.bench
@pytest.mark.timeout(600)
def test_bench_fields() -> None:
    partition = mesh(100_000)
    _ = partition.incentres_m, partition.edge_lengths_m  # the geometry is there before the fields

    def fields() -> None:
        velocities = np.concatenate((stay_velocities(partition, 1.0)[:, None], exit_velocities(partition, 1.0)), axis=1)
        affine_fields(partition.corners_m[:, None], velocities)

    times = timed(fields, ROUNDS)
    print(f"\nall four fields of {partition.size:,} triangles: {seconds(times.wall_s)}")
    assert times.processor_s < 1.0
