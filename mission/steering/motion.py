"""What a vehicle can do, and the motion with which a curve begins or ends."""

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from mission.geometry.arrays import FloatArray


class Motion(NamedTuple):
    """With which a curve goes over into another one.

    Attributes:
        slope: First derivative, shape (2,).
        bend: Second derivative, shape (2,).
        jerk: The largest third derivative for which there is a time law, of who cannot slow down at once.
    """

    slope: FloatArray
    bend: FloatArray
    jerk: float = np.inf


@dataclass(frozen=True)
class Pace:
    """What a vehicle can do: largest speed, acceleration and jerk, in metres and seconds."""

    speed_m_s: float
    acceleration_m_s2: float
    jerk_m_s3: float
