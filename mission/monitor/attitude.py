"""What the attitude of a multicopter tells of the forces on it."""

from math import cos, sin
from typing import Final, TypeVar

import numpy as np

from mission.geometry.arrays import FloatArray

GRAVITY_M_S2: Final = 9.80665

_Part = TypeVar("_Part", float, FloatArray)


def horizontal_acceleration(attitude_rad: FloatArray) -> FloatArray:
    """Acceleration, east and north, of a multicopter at these attitudes whose thrust just carries its weight.

    The thrust acts along the body's -z axis, whose direction in NED is the third column of the rotation from roll,
    pitch and yaw; its vertical part is g.

    Args:
        attitude_rad: Roll, pitch, yaw (NED body angles), shape (N, 3).

    Returns:
        Shape (N, 2), m/s^2.
    """
    roll, pitch, yaw = attitude_rad.T
    level = _level((np.sin(roll), np.cos(roll)), (np.sin(pitch), np.cos(pitch)), (np.sin(yaw), np.cos(yaw)))
    return np.stack(level, axis=-1)


def level_acceleration(roll: float, pitch: float, yaw: float) -> tuple[float, float]:
    """The same, east and north, m/s^2, at one attitude."""
    return _level((sin(roll), cos(roll)), (sin(pitch), cos(pitch)), (sin(yaw), cos(yaw)))


def _level(roll: tuple[_Part, _Part], pitch: tuple[_Part, _Part], yaw: tuple[_Part, _Part]) -> tuple[_Part, _Part]:
    """The same of sines and cosines."""
    (sr, cr), (sp, cp), (sy, cy) = roll, pitch, yaw
    lift = cr * cp
    return -GRAVITY_M_S2 * (sy * sp * cr - cy * sr) / lift, -GRAVITY_M_S2 * (cy * sp * cr + sy * sr) / lift


def tilt(attitude_rad: FloatArray) -> FloatArray:
    """Angle between the body's z axis and the vertical, shape (N,), rad."""
    angle: FloatArray = np.arccos(np.clip(np.cos(attitude_rad[:, 0]) * np.cos(attitude_rad[:, 1]), -1.0, 1.0))
    return angle
