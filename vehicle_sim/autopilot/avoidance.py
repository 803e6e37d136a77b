"""Velocities that end at the fence.

What of a velocity setpoint leads to a border is kept below the speed from which the vehicle can stop at the margin.
What leads along the border stays, so the vehicle slides. After ArduPilot `AC_Avoid`.
"""

from dataclasses import replace
from math import hypot, sqrt
from typing import Final

import numpy as np

from vehicle_sim.autopilot.fence import FenceWatch
from vehicle_sim.parameters import FenceType, FlightSettings
from vehicle_sim.signals import FREE, Estimate, Setpoint, Vector

_PASSES: Final = 8
_GENTLY: Final = 0.75
"""Share of the vertical acceleration that braking counts on."""

_TOLERANCE_M_S: Final = 1e-6


def stopping_speed(distance_m: float, acceleration_m_s2: float, reaction_s: float) -> float:
    """Return the speed v with v t + v² / 2 a = `distance_m`, t the time of reaction; 0 where there is no room."""
    if distance_m <= 0.0:
        return 0.0
    a, t = acceleration_m_s2, reaction_s
    return a * (sqrt(t * t + 2.0 * distance_m / a) - t)


def _slid(velocity: np.ndarray, normals: np.ndarray, most: np.ndarray) -> tuple[float, float]:
    """Return `velocity` (2,) less what is more than `most` (n,) along each of the `normals` (n, 2).

    In a corner where removing one excess brings another back for too long, stand still.
    """
    if not len(most):
        return float(velocity[0]), float(velocity[1])
    for _ in range(_PASSES):
        over = normals @ velocity - most
        worst = int(over.argmax())
        if over[worst] <= _TOLERANCE_M_S:
            return float(velocity[0]), float(velocity[1])
        velocity = velocity - over[worst] * normals[worst]
    return 0.0, 0.0


def within_fence(
    setpoint: Setpoint, estimate: Estimate, settings: FlightSettings, fence: FenceWatch, home_ned_m: Vector
) -> Setpoint:
    """Return `setpoint` slowed down towards the borders of the kinds of fence that are watched.

    Only velocities without a position are slowed down (a position outside is refused anyway), and only inside.
    """
    kinds, rules = fence.enabled, settings.fence
    if not (kinds and rules.slows_down) or fence.breached or estimate.origin is None:
        return setpoint
    north, east, down = setpoint.velocity_ned_m_s
    if setpoint.position_ned_m != FREE or north is None or east is None or down is None:
        return setpoint
    here = estimate.position_ned_m
    borders = np.empty((0, 2))
    if FenceType.AREAS in kinds:
        borders = fence.local(estimate.origin).nearest_m(here[0], here[1])
    if FenceType.CIRCLE in kinds:
        out_n, out_e = here[0] - home_ned_m[0], here[1] - home_ned_m[1]
        away = hypot(out_n, out_e)
        if away > 0.0:
            rest = (rules.radius_m - away) / away
            borders = np.vstack((borders, (out_n * rest, out_e * rest)))
    distances = np.hypot(borders[:, 0], borders[:, 1])
    normals = borders / np.where(distances > 0.0, distances, 1.0)[:, None]
    braking, reaction_s = settings.braking_m_s2, settings.reaction_s
    most = np.array([stopping_speed(distance - rules.margin_m, braking, reaction_s) for distance in distances])
    north, east = _slid(np.array((north, east)), normals, most)
    climb = -down
    if FenceType.ALTITUDE in kinds:
        room = rules.ceiling_m - (home_ned_m[2] - here[2]) - rules.margin_m
        climb = min(climb, stopping_speed(room, _GENTLY * settings.vertical_acceleration_m_s2, reaction_s))
    slowed = (north, east, -climb)
    return setpoint if slowed == setpoint.velocity_ned_m_s else replace(setpoint, velocity_ned_m_s=slowed)
