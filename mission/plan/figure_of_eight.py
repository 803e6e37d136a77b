"""A figure of eight in a mission's free space, at its speed: the flight by which a vehicle's following is measured.

The curve is Gerono's lemniscate, turned by an angle phi about the start,

    x = A sin(u),    y = A / 2 sin(2 u),    u = 2 pi n s / T    (n rounds),

an odd Fourier series of two waves. It is fastest at the crossing, A sqrt(2) u', and nowhere accelerates by more than
1.2 A u'^2: with the speed v at the crossing, by no more than 0.6 v^2 / A. So with A = v^2 / a the limits leave the
speed as it is.
"""

import math
from dataclasses import replace
from typing import Final

import numpy as np
import shapely

from mission.errors import NoPlanError
from mission.geometry.regions import union_of
from mission.plan.flight_plan import FlightPlan
from mission.plan.pace import trajectory_of
from mission.plan.stages import plan_mission
from mission.spec.model import Extension, Flight, Limits, MissionSpec, Point
from mission.steering.joined import JoinedCurve
from mission.steering.smoothing import FourierCurve
from mission.steering.timing import level_acceleration

_ROUNDS: Final = 3
_SIZES: Final = (1.0, 0.8, 0.65, 0.5)
"""Of the figure that the speed asks for; on a smaller one the vehicle is slower where it bends most."""

_TURNS: Final = 24
_SMALLEST_M: Final = 3.0
_AROUND_M: Final = 2.0
"""Kept free around it at least: how far the vehicle strays is not known yet."""


def figure_of_eight(spec: MissionSpec, start_m: Point | None = None) -> FlightPlan:
    """Plan a figure of eight about the start, flown several times, and nothing else.

    What is restricted stays so, and the boundary too: a flight of the plan is watched like any other. Its proof is that
    of standing at the start; that the figure keeps out of everything by twice the tube is seen here.

    Args:
        spec: The mission, whose place, limits, speed and tube are taken.
        start_m: Where the vehicle stands; the mission's own start by default.

    Raises:
        NoPlanError: There is no room for it.
    """
    still = replace(
        spec,
        formula="true",
        tasks=(),
        automaton=None,
        run=0,
        regions=tuple(replace(region, loiter_s=0.0, cover=None) for region in spec.regions),
    )
    plan = plan_mission(still, start_m=start_m)
    around_m = max(2.0 * math.sqrt(2.0) * spec.flight.tube_m, _AROUND_M)
    free = union_of(plan.partition, ~plan.restricted).buffer(-around_m)
    largest_m = _half_length_m(spec.flight, spec.limits)
    for size in _SIZES:
        for turn in range(_TURNS):
            curve = _eight(
                plan.start_m, max(size * largest_m, _SMALLEST_M), math.pi * turn / _TURNS, spec.flight.speed_m_s
            )
            if free.contains(shapely.LineString(curve.position(np.linspace(0.0, curve.duration_s / _ROUNDS, 129)))):
                trajectory = trajectory_of(still, JoinedCurve((curve,)), (), None)
                return replace(plan, trajectory=trajectory, stops=(), photographs=(), covers=())
    smallest_m = 2.0 * max(_SIZES[-1] * largest_m, _SMALLEST_M)
    raise NoPlanError(
        f"there is no room for a figure of eight of {smallest_m:.0f} m by {smallest_m / 2.0:.0f} m about the start at "
        f"({plan.start_m[0]:.1f}, {plan.start_m[1]:.1f}) m with {around_m:.1f} m around it: start where there is more, "
        f"or give the mission a smaller `flight.speed_m_s`"
    )


def _half_length_m(flight: Flight, limits: Limits) -> float:
    """A of a figure on which the limits leave the speed as it is."""
    speed_m_s = min(flight.speed_m_s, limits.speed_m_s)
    return max(speed_m_s**2 / level_acceleration(limits.acceleration_m_s2, limits.tilt_rad), _SMALLEST_M)


def _eight(centre_m: Point, half_length_m: float, angle_rad: float, speed_m_s: float) -> FourierCurve:
    """The figure about a point, with a parameter by which the crossing is passed at the speed."""
    duration_s = _ROUNDS * 2.0 * math.pi * half_length_m * math.sqrt(2.0) / speed_m_s
    along, across = (
        np.array([math.cos(angle_rad), math.sin(angle_rad)]),
        np.array([-math.sin(angle_rad), math.cos(angle_rad)]),
    )
    waves = np.zeros((4 * _ROUNDS, 2))
    waves[2 * _ROUNDS - 1] = half_length_m * along
    waves[4 * _ROUNDS - 1] = 0.5 * half_length_m * across
    return FourierCurve(Extension.ODD, duration_s, np.array(centre_m), np.zeros(2), waves)
