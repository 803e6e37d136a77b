"""How long a flight takes beside its trajectory, which alone is known before: what `flight.longest_s` is about.

Taking off and landing are the autopilot's own, and reckoned as both of them do it as they come.
"""

from typing import Final

from mission.decimals import decimal

_CLIMB_M_S, _DESCENT_M_S, _BESIDES_S = 1.5, 0.5, 12.0
"""How both autopilots take off and land as they come (MPC_TKO_SPEED 1.5, LAND_SPEED 50), and what the rest takes."""

_TOUCHING_DOWN_S: Final = 3.0
"""To come to rest before, and to be sure of the ground after."""


def landing_s(altitude_m: float) -> float:
    """How long a landing takes from a height, motors stopped at its end."""
    return altitude_m / _DESCENT_M_S + _TOUCHING_DOWN_S


def air_s(altitude_m: float, trajectory_s: float) -> float:
    """How long a flight takes from arming to landing whose trajectory takes so long."""
    return trajectory_s + altitude_m / _CLIMB_M_S + landing_s(altitude_m) + _BESIDES_S


def longest_text(longest_s: float) -> str:
    """What is asked for, as it is written in the file."""
    return f"flight.longest_s: {decimal(longest_s)}"
