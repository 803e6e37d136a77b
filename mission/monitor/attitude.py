"""What the attitude of a multicopter tells of the forces on it."""

from typing import Final

import numpy as np

from mission.geometry.arrays import FloatArray

GRAVITY_M_S2: Final = 9.80665


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
    lift = np.cos(roll) * np.cos(pitch)
    north = np.cos(yaw) * np.sin(pitch) * np.cos(roll) + np.sin(yaw) * np.sin(roll)
    east = np.sin(yaw) * np.sin(pitch) * np.cos(roll) - np.cos(yaw) * np.sin(roll)
    acceleration: FloatArray = -GRAVITY_M_S2 * np.stack((east, north), axis=-1) / lift[:, None]
    return acceleration


def tilt(attitude_rad: FloatArray) -> FloatArray:
    """Angle between the body's z axis and the vertical, shape (N,), rad."""
    angle: FloatArray = np.arccos(np.clip(np.cos(attitude_rad[:, 0]) * np.cos(attitude_rad[:, 1]), -1.0, 1.0))
    return angle
