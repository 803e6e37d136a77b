"""Costs of transitions against plain geometry."""

import numpy as np
import pytest

from mission.geometry.triangulation import triangulate_nodes
from mission.plan.costs import passage_lengths, transition_weights
from mission.spec.model import Cost
from tests.support.domains import random_nodes


def test_lengths_are_measured_over_the_middles_of_the_facets() -> None:
    partition = triangulate_nodes(np.array([[0.0, 0.0], [4.0, 0.0], [4.0, 3.0], [0.0, 3.0]]))
    lengths = passage_lengths(partition)
    inner = partition.neighbours >= 0
    # Incentres lie 1 m from the legs, the middle of the diagonal is the centre of the rectangle.
    assert lengths[inner] == pytest.approx(2.0 * np.hypot(1.0, 0.5))
    weights = transition_weights(partition, Cost.DISTANCE, 1.0)
    assert weights[:, 1:][inner].tolist() == [2236, 2236]
    assert (weights[:, 0] == weights[:, 1:].min()).all()
    assert transition_weights(partition, Cost.TIME, 2.0)[:, 1:][inner].tolist() == [1118, 1118]


def test_a_transition_counts_one_and_nothing_is_free() -> None:
    partition = triangulate_nodes(random_nodes(3, 12))
    assert (transition_weights(partition, Cost.TRANSITIONS, 1.0) == 1).all()
    tiny = triangulate_nodes(random_nodes(3, 12) * 1e-6)
    assert (transition_weights(tiny, Cost.DISTANCE, 1.0) >= 1).all()
