"""What the time law and the proof see of a curve: its values at knots that resolve it."""

from typing import NamedTuple

from mission.geometry.arrays import FloatArray


class Sampled(NamedTuple):
    """A curve at ascending knots from 0 to T, shape (K + 1,), with its first two derivatives, each (K + 1, 2)."""

    knots_s: FloatArray
    points_m: FloatArray
    slopes_m_s: FloatArray
    bends_m_s2: FloatArray
