"""A vehicle flown in lock-step, without links: waits are in vehicle time and say what they last saw."""

from collections.abc import Callable
from dataclasses import replace

from vehicle_sim.autopilot import LandedState, Mode, Outcome
from vehicle_sim.control.controller import TrackingGains
from vehicle_sim.dynamics.airframe import Dynamics
from vehicle_sim.dynamics.hover import DRAG_PER_S
from vehicle_sim.parameters import Flavour
from vehicle_sim.signals import PartialVector, Setpoint
from vehicle_sim.vehicle import Vehicle, VehicleConfig


def run(vehicle: Vehicle, seconds: float, setpoint: Setpoint | None = None) -> None:
    """Let vehicle time pass; a setpoint is repeated at 20 Hz."""
    steps = round(seconds / vehicle.config.step_s)
    for _ in range(steps):
        if setpoint is not None and vehicle.steps % 5 == 0:
            vehicle.autopilot.setpoint(setpoint)
        vehicle.step()


def wait_until(vehicle: Vehicle, predicate: Callable[[Vehicle], bool], *, within_s: float) -> float:
    """Step until `predicate` holds and return the vehicle time; fail with what was last seen."""
    deadline_s = vehicle.time_s + within_s
    while not predicate(vehicle):
        if vehicle.time_s >= deadline_s:
            autopilot = vehicle.autopilot
            raise AssertionError(
                f"not within {within_s} s; at {vehicle.time_s:.2f} s: {autopilot.mode}, armed {autopilot.armed}, "
                f"{autopilot.landed_state!r}, {vehicle.estimate}, texts {list(autopilot.texts)}"
            )
        vehicle.step()
    return vehicle.time_s


def booted(
    flavour: Flavour = Flavour.ARDUPILOT,
    *,
    seed: int = 1,
    wind_m_s: float = 0.0,
    dynamics: Dynamics = Dynamics.HOVER,
    drag_per_s: float = DRAG_PER_S,
    gains: TrackingGains | None = None,
) -> Vehicle:
    """Return a vehicle that has waited for its position; wind comes with gusts of a quarter of its speed."""
    config = VehicleConfig(flavour=flavour, seed=seed, dynamics=dynamics, drag_per_s=drag_per_s)
    config = replace(config, wind_m_s=wind_m_s, gust_m_s=0.25 * wind_m_s, gains=gains or config.gains)
    vehicle = Vehicle(config)
    wait_until(vehicle, lambda v: v.estimate.status.position_ok and v.autopilot.home is not None, within_s=20.0)
    return vehicle


def hovering(
    flavour: Flavour = Flavour.ARDUPILOT,
    *,
    height_m: float = 10.0,
    seed: int = 1,
    wind_m_s: float = 0.0,
    dynamics: Dynamics = Dynamics.HOVER,
    drag_per_s: float = DRAG_PER_S,
    gains: TrackingGains | None = None,
) -> Vehicle:
    """Return a vehicle that has taken off and hovers."""
    vehicle = booted(flavour, seed=seed, wind_m_s=wind_m_s, dynamics=dynamics, drag_per_s=drag_per_s, gains=gains)
    autopilot = vehicle.autopilot
    if flavour is Flavour.ARDUPILOT:
        assert autopilot.set_mode(Mode.GUIDED) is Outcome.ACCEPTED
    assert autopilot.arm() is Outcome.ACCEPTED
    assert autopilot.takeoff(height_m) is Outcome.ACCEPTED
    wait_until(vehicle, lambda v: v.autopilot.landed_state is LandedState.IN_AIR, within_s=30.0)
    return vehicle


def said(vehicle: Vehicle) -> list[str]:
    """Return the texts since the last call."""
    texts = [text.text for text in vehicle.autopilot.texts]
    vehicle.autopilot.texts.clear()
    return texts


def place(vehicle: Vehicle, north: float = 0.0, east: float = 0.0, up: float = 0.0) -> PartialVector:
    n, e, d = vehicle.estimate.position_ned_m
    return (n + north, e + east, d - up)


def mode_of(vehicle: Vehicle) -> Mode:
    return vehicle.autopilot.mode


def landed_state(vehicle: Vehicle) -> LandedState:
    return vehicle.autopilot.landed_state


def offboard(vehicle: Vehicle) -> Setpoint:
    """Bring a hovering PX4 into Offboard and return the setpoint that it flies."""
    setpoint = Setpoint(position_ned_m=place(vehicle, north=5.0))
    run(vehicle, 0.5, setpoint)
    assert vehicle.autopilot.set_mode(Mode.GUIDED) is Outcome.ACCEPTED
    run(vehicle, 1.0, setpoint)
    assert mode_of(vehicle) is Mode.GUIDED
    return setpoint
