"""Kinematics of a rigid body with yaw-pitch-roll angles (ZYX): exact, whatever moves the body."""

from math import cos, sin

from vehicle_sim.signals import GRAVITY_M_S2, Vector


def body_rates(roll_rad: float, pitch_rad: float, euler_rates_rad_s: Vector) -> Vector:
    """Return the body angular rates (p, q, r) that belong to the rates of roll, pitch and yaw."""
    roll_rate, pitch_rate, yaw_rate = euler_rates_rad_s
    sin_roll, cos_roll = sin(roll_rad), cos(roll_rad)
    turn = cos(pitch_rad) * yaw_rate
    return (
        roll_rate - sin(pitch_rad) * yaw_rate,
        cos_roll * pitch_rate + sin_roll * turn,
        cos_roll * turn - sin_roll * pitch_rate,
    )


def to_body(roll_rad: float, pitch_rad: float, yaw_rad: float, vector_ned: Vector) -> Vector:
    """Return the components of `vector_ned` along forward, right and down."""
    north, east, down = vector_ned
    cos_yaw, sin_yaw = cos(yaw_rad), sin(yaw_rad)
    ahead = north * cos_yaw + east * sin_yaw
    right = east * cos_yaw - north * sin_yaw
    cos_pitch, sin_pitch = cos(pitch_rad), sin(pitch_rad)
    under = ahead * sin_pitch + down * cos_pitch
    cos_roll, sin_roll = cos(roll_rad), sin(roll_rad)
    return (
        ahead * cos_pitch - down * sin_pitch,
        right * cos_roll + under * sin_roll,
        under * cos_roll - right * sin_roll,
    )


def specific_force(roll_rad: float, pitch_rad: float, yaw_rad: float, acceleration_ned_m_s2: Vector) -> Vector:
    """Return what an ideal accelerometer at the centre of mass measures: acceleration less gravity, in body axes."""
    north, east, down = acceleration_ned_m_s2
    return to_body(roll_rad, pitch_rad, yaw_rad, (north, east, down - GRAVITY_M_S2))
