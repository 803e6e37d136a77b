"""Costs of transitions: lengths against plain geometry, times against the fields' exact flows."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from mission.geometry.triangulation import triangulate_nodes
from mission.plan.costs import passage_lengths, passage_times, transition_weights
from mission.spec.model import Cost
from mission.steering.facet_control import affine_fields, exit_velocities
from mission.steering.flow import exit_time
from tests.support.domains import random_nodes


@settings(max_examples=25, deadline=None)
@given(seed=st.integers(0, 2**32 - 1), speed=st.sampled_from([0.05, 3.0]))
def test_no_entry_takes_longer_to_leave_than_the_bound(seed: int, speed: float) -> None:
    partition = triangulate_nodes(random_nodes(seed, 10))
    bounds = passage_times(partition, speed)
    F, g = affine_fields(partition.corners_m[:, None], exit_velocities(partition, speed))
    rng = np.random.default_rng(seed)
    for triangle in rng.choice(partition.size, size=min(6, partition.size), replace=False).tolist():
        corners = partition.corners_m[triangle]
        for j in range(3):
            for _ in range(4):
                shares = rng.dirichlet((0.3, 0.3, 0.3))
                place = shares @ corners
                left, _ = exit_time(F[triangle, j], g[triangle, j], corners, j, place)
                assert 0.0 <= left <= bounds[triangle, j] * (1.0 + 1e-9)


def test_the_bound_is_met_where_the_rates_on_the_facet_are_alike() -> None:
    side = np.sqrt(3.0) / 2.0
    partition = triangulate_nodes(np.array([[0.0, 0.0], [1.0, 0.0], [0.5, side]]))
    # From the vertex opposite the exit: at the rate c there, and c cos 30 degrees at both ends of the facet.
    assert passage_times(partition, 2.0) == pytest.approx(side * np.log(1.0 / side) / (2.0 - 2.0 * side))


def test_lengths_are_measured_over_the_middles_of_the_facets() -> None:
    partition = triangulate_nodes(np.array([[0.0, 0.0], [4.0, 0.0], [4.0, 3.0], [0.0, 3.0]]))
    lengths = passage_lengths(partition)
    inner = partition.neighbours >= 0
    # Incentres lie 1 m from the legs, the middle of the diagonal is the centre of the rectangle.
    assert lengths[inner] == pytest.approx(2.0 * np.hypot(1.0, 0.5))
    weights = transition_weights(partition, Cost.DISTANCE, 1.0)
    assert weights[:, 1:][inner].tolist() == [2236, 2236]
    assert (weights[:, 0] == weights[:, 1:].min()).all()


def test_a_transition_counts_one_and_nothing_is_free() -> None:
    partition = triangulate_nodes(random_nodes(3, 12))
    assert (transition_weights(partition, Cost.TRANSITIONS, 1.0) == 1).all()
    tiny = triangulate_nodes(random_nodes(3, 12) * 1e-6)
    assert (transition_weights(tiny, Cost.DISTANCE, 1.0) >= 1).all()
