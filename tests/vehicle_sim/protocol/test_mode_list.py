"""Which modes there are, and which one it is: AVAILABLE_MODES, CURRENT_MODE."""

import pytest
from pymavlink.dialects.v20 import ardupilotmega as mavlink

from tests.support.station import Station, endpoint_of
from vehicle_sim.autopilot import Mode
from vehicle_sim.autopilot.modes import MODES
from vehicle_sim.parameters import Flavour

AVAILABLE_MODES, CURRENT_MODE = 435, 436
ACCEPTED = mavlink.MAV_RESULT_ACCEPTED
REQUEST = mavlink.MAV_CMD_REQUEST_MESSAGE
DO_SET_STANDARD_MODE = 262
BOTH = pytest.mark.parametrize("flavour", Flavour)


@BOTH
def test_the_whole_list_and_each_page_of_it(flavour: Flavour) -> None:
    station = Station(endpoint_of(flavour))
    assert station.command(REQUEST, AVAILABLE_MODES, 0) == ACCEPTED
    whole = station.of("AVAILABLE_MODES")
    count = len(MODES[flavour])
    assert [entry.mode_index for entry in whole] == list(range(1, count + 1))
    assert {entry.number_modes for entry in whole} == {count}
    assert {entry.custom_mode for entry in whole} == set(station.endpoint.table.modes)
    for entry in whole:
        station.forget()
        assert station.command(REQUEST, AVAILABLE_MODES, entry.mode_index) == ACCEPTED
        assert [page.to_dict() for page in station.of("AVAILABLE_MODES")] == [entry.to_dict()]
    for place in (count + 1, -1, 0.5, float("nan"), 1e9):
        station.forget()
        assert station.command(REQUEST, AVAILABLE_MODES, place) == station.endpoint.table.no_message
        assert not station.of("AVAILABLE_MODES")


def entries(flavour: Flavour) -> dict[int, tuple[int, int, str]]:
    station = Station(endpoint_of(flavour))
    station.command(REQUEST, AVAILABLE_MODES, 0)
    return {
        entry.custom_mode: (entry.standard_mode, entry.properties, entry.mode_name)
        for entry in station.of("AVAILABLE_MODES")
    }


def test_px4_tells_standard_modes_by_number_and_others_by_name() -> None:
    modes = entries(Flavour.PX4)
    assert modes[0x30000] == (1, 0, "")  # position hold
    assert modes[0x20000] == (4, 0, "")  # altitude hold
    assert modes[0x5040000] == (5, 1, "")  # safe recovery
    assert modes[0x4040000] == (6, 1, "")  # mission
    assert modes[0x6040000] == (7, 1, "")  # land
    assert modes[0x2040000] == (8, 1, "")  # take-off
    assert modes[0x3040000] == (0, 1, "Hold")
    assert modes[0x60000] == (0, 1, "Offboard")


def test_ardupilot_names_them_all() -> None:
    modes = entries(Flavour.ARDUPILOT)
    assert modes[4] == (0, 0, "GUIDED")
    assert modes[6] == (0, 0, "RTL")
    assert all(name and (standard, properties) == (0, 0) for standard, properties, name in modes.values())


def test_only_px4_has_a_message_for_the_present_mode() -> None:
    station = Station(endpoint_of(Flavour.ARDUPILOT))
    assert station.request(CURRENT_MODE) == mavlink.MAV_RESULT_FAILED
    station = Station(endpoint_of(Flavour.PX4))
    station.wait_for_position()
    assert station.request(CURRENT_MODE) == ACCEPTED
    now = station.last("CURRENT_MODE")
    assert (now.standard_mode, now.custom_mode, now.intended_custom_mode) == (0, 0x3040000, 0x3040000)
    station.set_mode(Mode.POSITION)
    station.request(CURRENT_MODE)
    now = station.last("CURRENT_MODE")
    assert (now.standard_mode, now.custom_mode, now.intended_custom_mode) == (1, 0x30000, 0x30000)


def test_a_failsafe_changes_the_mode_but_not_the_intended_one() -> None:
    station = Station(endpoint_of(Flavour.PX4))
    station.take_off(6.0)
    station.wait_until(lambda: station.endpoint.vehicle.autopilot.mode is Mode.HOLD, within_s=20.0)
    for _ in range(10):
        station.setpoint((0, 0, -6), mask=0xDF8)
        station.run(0.1)
    station.set_mode(Mode.GUIDED)
    assert station.endpoint.vehicle.autopilot.mode is Mode.GUIDED
    station.wait_until(lambda: station.endpoint.vehicle.autopilot.mode is not Mode.GUIDED, within_s=10.0)
    station.request(CURRENT_MODE)
    now = station.last("CURRENT_MODE")
    assert now.intended_custom_mode == 0x60000
    assert now.custom_mode != 0x60000


def test_standard_modes_are_entered_by_their_number() -> None:
    station = Station(endpoint_of(Flavour.PX4))
    station.wait_for_position()
    for standard, mode in ((1, Mode.POSITION), (2, Mode.CIRCLE), (4, Mode.ALT_HOLD), (5, Mode.RETURN), (7, Mode.LAND)):
        assert station.command(DO_SET_STANDARD_MODE, standard) == ACCEPTED
        assert station.endpoint.vehicle.autopilot.mode is mode
    for unknown in (0, 3, 99, float("nan")):
        assert station.command(DO_SET_STANDARD_MODE, unknown) == mavlink.MAV_RESULT_FAILED
    station = Station(endpoint_of(Flavour.ARDUPILOT))
    assert station.command(DO_SET_STANDARD_MODE, 1) == mavlink.MAV_RESULT_UNSUPPORTED


@BOTH
@pytest.mark.parametrize("message_id", [148, 300, 397, 410, 411, AVAILABLE_MODES, CURRENT_MODE, 60_000])
def test_whatever_a_ground_station_asks_for_is_acknowledged_at_once(flavour: Flavour, message_id: int) -> None:
    station = Station(endpoint_of(flavour))
    assert station.request(message_id) in (ACCEPTED, station.endpoint.table.no_message)
    assert len(station.of("COMMAND_ACK")) == 1
