"""Somebody who knows the flight and the vehicle, and pushes it off its path within a bound, as badly as may be.

The disturbance is what the tracking law does not know of: all of the air's push, the drag of the vehicle's own motion
too. So the air is moved such that its drag is the push that is chosen, of at most w on each axis.
"""

import random
from collections.abc import Callable
from typing import TYPE_CHECKING

from tests.support.lockstep import LockstepVehicle

if TYPE_CHECKING:
    from vehicle_sim.dynamics.airframe import Airframe
    from vehicle_sim.signals import Command, Motion, Vector
    from vehicle_sim.vehicle import Vehicle

Sign = Callable[[float, float, float], float]
"""Where to push on an axis, by the time and the errors of position and velocity on it: -1 to 1."""


def away(_t_s: float, off_m: float, _off_m_s: float) -> float:
    """On to where the vehicle already is too far."""
    return _sign(off_m)


def pumping(_t_s: float, _off_m: float, off_m_s: float) -> float:
    """Along with its motion about the path: the most work, at whatever frequency it swings."""
    return _sign(off_m_s)


def beating(period_s: float) -> Sign:
    """To and fro with a period; a long one lets the vehicle learn the push and then takes it back, twice over."""
    return lambda t_s, _off_m, _off_m_s: 1.0 if t_s % period_s < 0.5 * period_s else -1.0


def rambling(seed: int) -> Sign:
    """To and fro at random, on average for two seconds each, by the step of 10 ms."""
    draw, state = random.Random(seed), [1.0]  # noqa: S311 - a test, not cryptography

    def sign(_t_s: float, _off_m: float, _off_m_s: float) -> float:
        if draw.random() < 0.005:
            state[0] = -state[0]
        return state[0]

    return sign


def _sign(value: float) -> float:
    return 1.0 if value >= 0.0 else -1.0


class PushedAirframe:
    """An airframe in air that pushes by a choice of the adversary while setpoints are flown, and is calm before."""

    def __init__(self, vehicle: "Vehicle", bound_m_s2: float, signs: tuple[Sign, Sign]) -> None:
        """Push with at most so much on each axis, north and east."""
        self._own: Airframe = vehicle.airframe
        self._vehicle, self._bound_m_s2, self._signs = vehicle, bound_m_s2, signs

    def __getattr__(self, name: str) -> object:
        return getattr(self._own, name)

    def step(self, command: "Command", wind_ned_m_s: "Vector") -> "Motion":
        vehicle, truth = self._vehicle, self._own.motion
        setpoint = vehicle.autopilot.guidance.setpoint
        moved = list(wind_ned_m_s)
        if setpoint is not None and setpoint.acceleration_ned_m_s2[0] is not None:
            for axis in (0, 1):
                place, speed = setpoint.position_ned_m[axis], setpoint.velocity_ned_m_s[axis]
                here, going = truth.position_ned_m[axis], truth.velocity_ned_m_s[axis]
                off_m, off_m_s = here - (here if place is None else place), going - (speed or 0.0)
                push = self._bound_m_s2 * self._signs[axis](vehicle.time_s, off_m, off_m_s)
                moved[axis] = going + push / vehicle.config.drag_per_s
        return self._own.step(command, (moved[0], moved[1], moved[2]))


def pushed(vehicle: LockstepVehicle, bound_m_s2: float, signs: tuple[Sign, Sign]) -> LockstepVehicle:
    """The vehicle with an adversary."""
    vehicle.vehicle.airframe = PushedAirframe(vehicle.vehicle, bound_m_s2, signs)  # type: ignore[assignment]
    return vehicle
