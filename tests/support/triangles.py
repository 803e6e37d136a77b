"""Random triangles of every reasonable shape, as partitions of one triangle."""

import numpy as np
from hypothesis import strategies as st

from mission.geometry.arrays import FloatArray
from mission.geometry.simplices import Partition


def single(corners_m: FloatArray) -> Partition:
    """A domain that is one triangle."""
    return Partition(corners_m, np.array([[0, 1, 2]]), np.full((1, 3), -1))


@st.composite
def triangles(draw: st.DrawFn) -> Partition:
    """Angles of 3 degrees at least, sides from centimetres to kilometres, anywhere."""
    first = draw(st.floats(3.0, 87.0))
    second = draw(st.floats(3.0, 177.0 - first))
    size = 10.0 ** draw(st.floats(-1.0, 3.0))
    turn = draw(st.floats(0.0, 2.0 * np.pi))
    alpha, beta = np.radians([first, second])
    side = size * np.sin(beta) / np.sin(alpha + beta)
    corners = np.array([[0.0, 0.0], [size, 0.0], [side * np.cos(alpha), side * np.sin(alpha)]])
    rotation = np.array([[np.cos(turn), -np.sin(turn)], [np.sin(turn), np.cos(turn)]])
    shift = np.array([draw(st.floats(-1000.0, 1000.0)), draw(st.floats(-1000.0, 1000.0))])
    return single(corners @ rotation.T + shift)


@st.composite
def shares(draw: st.DrawFn) -> FloatArray:
    """Barycentric coordinates of a point of the closed triangle, corners and edges included."""
    weights = [draw(st.one_of(st.just(0.0), st.floats(0.01, 1.0))) for _ in range(3)]
    if not any(weights):
        weights[draw(st.integers(0, 2))] = 1.0
    return np.array(weights) / sum(weights)
