"""Fences around home, and flights against them."""

from math import cos, hypot, pi, sin

from vehicle_sim.autopilot import Mode
from vehicle_sim.autopilot.geofence import Area, Circle, FencePlan, Polygon
from vehicle_sim.geodesy import geodetic_at
from vehicle_sim.signals import Geodetic, Setpoint
from vehicle_sim.vehicle import Vehicle


def at_home(vehicle: Vehicle, north: float, east: float) -> Geodetic:
    """A place relative to home."""
    home = vehicle.autopilot.home
    assert home is not None
    return geodetic_at(home, (north, east, 0.0))


def ring(vehicle: Vehicle, radius_m: float, *, corners: int = 4, north: float = 0.0, contains: bool = True) -> Polygon:
    """A regular polygon whose edges are `radius_m` from its centre, one of them straight north."""
    reach = radius_m / cos(pi / corners)
    turns = [pi * (2 * i + 1) / corners for i in range(corners)]
    return Polygon(contains, tuple(at_home(vehicle, north + reach * cos(t), reach * sin(t)) for t in turns))


def circle(vehicle: Vehicle, radius_m: float, *, north: float = 0.0, contains: bool = True) -> Circle:
    return Circle(contains, at_home(vehicle, north, 0.0), radius_m)


def fenced(vehicle: Vehicle, *areas: Area, **parameters: float) -> Vehicle:
    """Set parameters, upload areas, and return the vehicle."""
    for name, value in parameters.items():
        vehicle.parameters.set(name, value)
    vehicle.autopilot.fence_in(FencePlan(areas))
    return vehicle


def stopping_distance_m(vehicle: Vehicle, speed_m_s: float) -> float:
    """What the vehicle needs to stop from a speed, by its own limits: reaction, then braking."""
    settings = vehicle.autopilot.settings
    return settings.reaction_s * speed_m_s + speed_m_s**2 / (2.0 * settings.braking_m_s2)


class Timeline:
    """What happens to a flying vehicle: its modes with times, how far it gets, how fast it was."""

    def __init__(self, vehicle: Vehicle) -> None:
        self.vehicle = vehicle
        self.modes: list[tuple[float, Mode]] = [(vehicle.time_s, vehicle.autopilot.mode)]
        self.north_m = self.up_m = self.fastest_m_s = -1e9

    def fly(self, seconds: float, setpoint: Setpoint | None = None) -> "Timeline":
        """Go on; a setpoint is repeated at 20 Hz."""
        vehicle = self.vehicle
        for _ in range(round(seconds / vehicle.config.step_s)):
            if setpoint is not None and vehicle.steps % 5 == 0:
                vehicle.autopilot.setpoint(setpoint)
            vehicle.step()
            north, _, down = vehicle.truth.position_ned_m
            self.north_m, self.up_m = max(self.north_m, north), max(self.up_m, -down)
            self.fastest_m_s = max(self.fastest_m_s, hypot(*vehicle.truth.velocity_ned_m_s[:2]))
            if vehicle.autopilot.mode is not self.modes[-1][1]:
                self.modes.append((vehicle.time_s, vehicle.autopilot.mode))
        return self

    @property
    def sequence(self) -> list[Mode]:
        """The modes in their order."""
        return [mode for _, mode in self.modes]

    def when(self, mode: Mode) -> float:
        """The vehicle time at which a mode was entered last."""
        return max(time_s for time_s, entered in self.modes if entered is mode)
