"""Take-off, landing, return and home of the bare vehicle, as timelines."""

import numpy as np
import pytest

from tests.support.bare_vehicle import booted, hovering, landed_state, place, run, wait_until
from vehicle_sim.autopilot import LandedState, Mode, Outcome
from vehicle_sim.parameters import Flavour
from vehicle_sim.signals import Setpoint

AP, PX4 = Flavour.ARDUPILOT, Flavour.PX4
BOTH = pytest.mark.parametrize("flavour", [AP, PX4])


@BOTH
def test_take_off_hover_and_land(flavour: Flavour) -> None:
    vehicle = hovering(flavour, height_m=8.0)
    autopilot = vehicle.autopilot
    assert autopilot.mode is {AP: Mode.GUIDED, PX4: Mode.HOLD}[flavour]
    run(vehicle, 5.0)
    home = autopilot._home_ned_m
    assert home[2] - vehicle.estimate.position_ned_m[2] == pytest.approx(8.0, abs=0.3)
    assert np.hypot(vehicle.truth.position_ned_m[0], vehicle.truth.position_ned_m[1]) < 1.0
    assert autopilot.land() is Outcome.ACCEPTED
    run(vehicle, 2.0)
    assert landed_state(vehicle) is LandedState.LANDING
    touched_s = wait_until(vehicle, lambda v: v.truth.on_ground, within_s=30.0)
    disarmed_s = wait_until(vehicle, lambda v: not v.autopilot.armed, within_s=10.0)
    # Detection takes a second; then ArduPilot disarms at once and PX4 after COM_DISARM_LAND.
    assert disarmed_s - touched_s == pytest.approx({AP: 1.5, PX4: 3.5}[flavour], abs=0.7)
    # ArduPilot calls itself landing for half a second more.
    run(vehicle, 0.6)
    assert landed_state(vehicle) is LandedState.ON_GROUND


def test_ardupilot_takes_off_only_armed_and_guided_and_only_upwards() -> None:
    vehicle = booted()
    autopilot = vehicle.autopilot
    assert autopilot.takeoff(10.0) is Outcome.FAILED
    autopilot.set_mode(Mode.POSITION)
    autopilot.arm()
    assert autopilot.takeoff(10.0) is Outcome.FAILED
    autopilot.set_mode(Mode.GUIDED)
    assert autopilot.takeoff(-1.0) is Outcome.FAILED
    assert autopilot.takeoff(10.0) is Outcome.ACCEPTED
    assert autopilot.takeoff(10.0) is Outcome.ACCEPTED
    run(vehicle, 3.0)
    assert vehicle.truth.on_ground
    run(vehicle, 1.5)
    assert not vehicle.truth.on_ground


def test_ardupilot_setpoints_do_not_lift_it_from_the_ground_and_px4_ones_do() -> None:
    for flavour, lifts in ((AP, False), (PX4, True)):
        vehicle = booted(flavour)
        climb = Setpoint(position_ned_m=place(vehicle, up=5.0))
        run(vehicle, 1.0, climb)
        vehicle.autopilot.set_mode(Mode.GUIDED)
        assert vehicle.autopilot.arm() is Outcome.ACCEPTED
        run(vehicle, 6.0, climb)
        assert vehicle.truth.on_ground is not lifts


@BOTH
def test_return_climbs_flies_home_and_lands_there(flavour: Flavour) -> None:
    vehicle = hovering(flavour, height_m=6.0, wind_m_s=3.0)
    autopilot = vehicle.autopilot
    name = {AP: "RTL_ALT", PX4: "RTL_RETURN_ALT"}[flavour]
    vehicle.parameters.set(name, {AP: 1200.0, PX4: 12.0}[flavour])
    autopilot.reposition(place(vehicle, north=30.0, east=-20.0))
    run(vehicle, 15.0)
    assert np.hypot(*vehicle.truth.position_ned_m[:2]) > 30.0
    assert autopilot.return_to_launch() is Outcome.ACCEPTED
    highest = 0.0
    deadline_s = vehicle.time_s + 90.0
    while autopilot.armed and vehicle.time_s < deadline_s:
        vehicle.step()
        highest = min(highest, vehicle.truth.position_ned_m[2])
    assert not autopilot.armed
    assert -highest == pytest.approx(12.0, abs=1.5)
    assert np.hypot(*vehicle.truth.position_ned_m[:2]) < 1.5


def test_home_is_where_it_was_armed_unless_it_was_set() -> None:
    vehicle = hovering()
    autopilot = vehicle.autopilot
    first = autopilot.home
    revision = autopilot.home_revision
    assert autopilot.set_home() is Outcome.ACCEPTED
    assert autopilot.home != first
    assert autopilot.home_revision == revision + 1
    kept = autopilot.home
    autopilot.land()
    wait_until(vehicle, lambda v: not v.autopilot.armed, within_s=40.0)
    autopilot.set_mode(Mode.GUIDED)
    autopilot.arm()
    assert autopilot.home == kept
