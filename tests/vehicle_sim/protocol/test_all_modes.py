"""All modes that the autopilots list: each is entered, or refused, as there."""

import pytest
from pymavlink.dialects.v20 import ardupilotmega as mavlink

from tests.support.station import Station, endpoint_of
from vehicle_sim.autopilot import Mode
from vehicle_sim.autopilot.modes import MODES, Entry
from vehicle_sim.parameters import Flavour

AP = Flavour.ARDUPILOT
ACCEPTED, FAILED = mavlink.MAV_RESULT_ACCEPTED, mavlink.MAV_RESULT_FAILED
NUMBERS = {*range(8), 9, 11, 14, 15, 16, 17, 18, 19, 20, 21, 22, 23, 24, 25, 27, 28}
"""Of ArduCopter on a multicopter, as built: 13 (sport) is left out, 26 is for helicopters."""


@pytest.mark.parametrize("flavour", Flavour)
def test_every_row_has_a_number_and_flags(flavour: Flavour) -> None:
    table = endpoint_of(flavour).table
    assert set(table.custom_modes) == set(table.base_modes) == set(MODES[flavour])
    for rule in MODES[flavour].values():
        assert rule.like is None or MODES[flavour][rule.like].like is None


def test_ardupilots_numbers() -> None:
    assert set(endpoint_of(AP).table.modes) == NUMBERS


@pytest.fixture(scope="module")
def flying() -> Station:
    station = Station(endpoint_of(AP))
    station.take_off(5.0)
    return station


@pytest.mark.parametrize("mode", MODES[AP])
def test_on_the_ground_and_in_the_air(flying: Station, mode: Mode) -> None:
    rule = MODES[AP][mode]
    grounded = Station(endpoint_of(AP))
    # Before there is a position, there is no way back.
    refused_there = rule.entry in (Entry.NEVER, Entry.FLYING) or mode is Mode.SMART_RTL
    assert grounded.set_mode(mode) == (FAILED if refused_there else ACCEPTED)
    grounded.run(0.05)
    if refused_there:
        said = "".join(grounded.texts())  # long ones come in parts
        assert f"{rule.wants}Mode change to {rule.name} failed: {rule.refusal}" in said
    if mode is not Mode.AUTO:  # which wants a mission
        assert flying.set_mode(mode) == (FAILED if rule.entry in (Entry.NEVER, Entry.DISARMED) else ACCEPTED)
        flying.run(0.5)
        assert flying.endpoint.vehicle.autopilot.flying
        assert flying.set_mode(Mode.GUIDED) == ACCEPTED


def test_without_satellites_attitudes_are_flown() -> None:
    station = Station(endpoint_of(AP))
    station.take_off(5.0)
    assert station.set_mode(Mode.GUIDED_NOGPS) == ACCEPTED
    for _ in range(30):
        # 5 degrees nose down, climbing by nothing
        station.send(
            mavlink.MAVLink_set_attitude_target_message(0, 1, 1, 7, [0.99905, 0.0, -0.04362, 0.0], 0, 0, 0, 0.5)
        )
        station.run(0.1)
    assert station.endpoint.vehicle.truth.velocity_ned_m_s[0] > 1.0
