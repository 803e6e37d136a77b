"""A circle flown by setpoints, as it was flown on real autopilots: 6 m of radius at 2.1 m/s."""

from math import cos, hypot, pi, sin, sqrt

from tests.support.bare_vehicle import hovering
from vehicle_sim.autopilot import Mode
from vehicle_sim.control.controller import TrackingGains
from vehicle_sim.dynamics.airframe import Dynamics
from vehicle_sim.dynamics.hover import DRAG_PER_S
from vehicle_sim.parameters import Flavour
from vehicle_sim.signals import FREE, Setpoint

RADIUS_M = 6.0
SPEED_M_S = 2.1
_EVERY = 5
"""Steps of 10 ms between two setpoints: 20 Hz."""


def rms_error_m(
    flavour: Flavour,
    dynamics: Dynamics,
    *,
    with_acceleration: bool,
    wind_m_s: float = 0.0,
    drag_per_s: float = DRAG_PER_S,
    gains: TrackingGains | None = None,
) -> float:
    """Fly two rounds and return the rms distance between the estimated place and the one asked for, at equal times.

    The first quarter, in which the vehicle gains its speed, does not count. Wind has gusts of a quarter of its speed.
    """
    vehicle = hovering(flavour, dynamics=dynamics, wind_m_s=wind_m_s, drag_per_s=drag_per_s, gains=gains)
    autopilot = vehicle.autopilot
    north_m, east_m, down_m = vehicle.estimate.position_ned_m
    turn_rad_s = SPEED_M_S / RADIUS_M
    round_s = 2.0 * pi / turn_rad_s

    def reference(t_s: float) -> Setpoint:
        c, s = cos(turn_rad_s * t_s), sin(turn_rad_s * t_s)
        pull = SPEED_M_S * turn_rad_s
        return Setpoint(
            position_ned_m=(north_m - RADIUS_M + RADIUS_M * c, east_m + RADIUS_M * s, down_m),
            velocity_ned_m_s=(-SPEED_M_S * s, SPEED_M_S * c, 0.0),
            acceleration_ned_m_s2=(-pull * c, -pull * s, 0.0) if with_acceleration else FREE,
        )

    autopilot.setpoint(reference(0.0))
    if flavour is Flavour.PX4:
        autopilot.set_mode(Mode.GUIDED)
    squares = []
    for step in range(round(2.25 * round_s / vehicle.config.step_s)):
        t_s = step * vehicle.config.step_s
        if step % _EVERY == 0:
            autopilot.setpoint(reference(t_s))
        vehicle.step()
        if t_s >= 0.25 * round_s:
            place, wanted = vehicle.estimate.position_ned_m, reference(t_s + vehicle.config.step_s).position_ned_m
            assert wanted[0] is not None
            assert wanted[1] is not None
            squares.append(hypot(place[0] - wanted[0], place[1] - wanted[1]) ** 2)
    assert autopilot.mode is Mode.GUIDED
    return sqrt(sum(squares) / len(squares))
