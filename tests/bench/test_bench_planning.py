"""What the fields of a large mesh cost, beside inverting a matrix each; product and search are in ``test_bars.py``."""

import numpy as np
import pytest

from mission.steering.facet_control import affine_fields, exit_velocities, stay_velocities
from tests.support.measuring import compared, seconds
from tests.support.searches import mesh

ROUNDS = 9
MOST_INVERSIONS = 3.0


@pytest.mark.bench
@pytest.mark.timeout(600)
def test_bench_fields() -> None:
    partition = mesh(100_000)
    _ = partition.incentres_m, partition.edge_lengths_m  # the geometry is there before the fields

    def fields() -> None:
        velocities = np.concatenate((stay_velocities(partition, 1.0)[:, None], exit_velocities(partition, 1.0)), axis=1)
        affine_fields(partition.corners_m[:, None], velocities)

    # A field is three linear equations: numpy inverts as many matrices of three rows.
    matrices = np.random.default_rng(1).random((partition.size, 4, 3, 3))
    took = compared(fields, lambda: np.linalg.inv(matrices), ROUNDS)
    print(
        f"\nall four fields of {partition.size:,} triangles: {seconds(took.times.wall_s)}, {took.units:.2f} inversions"
    )
    assert took.units < MOST_INVERSIONS
