"""Calibrations as the sensors pages of QGroundControl watch them, by the words and messages that those look for."""

import re

import pytest
from pymavlink.dialects.v20 import ardupilotmega as mavlink

from tests.support.station import Station, endpoint_of
from vehicle_sim.parameters import Flavour

AP, PX4 = Flavour.ARDUPILOT, Flavour.PX4
ACCEPTED, REJECTED, DENIED, UNSUPPORTED, FAILED = range(5)
CALIBRATE = mavlink.MAV_CMD_PREFLIGHT_CALIBRATION
SIDES = {"down", "up", "left", "right", "front", "back"}
SUCCESS = 16_777_215


def asked(place: int, value: float = 1.0) -> list[float]:
    return [value if number == place else 0.0 for number in range(7)]


def cal_texts(station: Station, *, within_s: float = 30.0) -> list[str]:
    station.wait_until(
        lambda: any("done" in text and "side" not in text for text in station.texts()), within_s=within_s
    )
    return [text.removeprefix("[cal] ") for text in station.texts() if text.startswith("[cal] ")]


@pytest.mark.parametrize(("place", "value", "name"), [(0, 1, "gyro"), (2, 1, "baro"), (4, 2, "level"), (4, 4, "accel")])
def test_px4_calibrates_what_lies_still(place: int, value: float, name: str) -> None:
    station = Station(endpoint_of(PX4))
    assert station.command(CALIBRATE, *asked(place, value)) == ACCEPTED
    texts = cal_texts(station)
    assert texts[0] == f"calibration started: 2 {name}"
    progress = [int(found[1]) for text in texts if (found := re.fullmatch(r"progress <(\d+)>", text))]
    assert progress == sorted(progress)
    assert (progress[0], progress[-1]) == (0, 100)
    assert texts[-1] == f"calibration done: {name}"


@pytest.mark.parametrize(("place", "name"), [(1, "mag"), (4, "accel")])
def test_px4_asks_for_all_sides(place: int, name: str) -> None:
    station = Station(endpoint_of(PX4))
    assert station.command(CALIBRATE, *asked(place)) == ACCEPTED
    texts = cal_texts(station)
    assert {text.split()[0] for text in texts if text.endswith(" orientation detected")} == SIDES
    assert {text.split()[0] for text in texts if text.endswith(" side done, rotate to a different side")} == SIDES
    assert texts[-1] == f"calibration done: {name}"


def test_px4_does_one_at_a_time_and_ends_it_on_request() -> None:
    station = Station(endpoint_of(PX4))
    assert station.command(CALIBRATE) == ACCEPTED
    station.command(CALIBRATE, *asked(1))
    station.run(1.0)
    assert station.command(CALIBRATE, *asked(0)) == REJECTED
    assert station.command(CALIBRATE) == ACCEPTED
    station.run(2.0)
    assert station.texts()[-1] == "[cal] calibration cancelled"
    assert station.command(CALIBRATE, *asked(6)) == DENIED
    assert station.command(CALIBRATE, *asked(3, 77)) == UNSUPPORTED
    station.wait_for_position()
    assert station.command(mavlink.MAV_CMD_COMPONENT_ARM_DISARM, 1) == ACCEPTED
    assert station.command(CALIBRATE, *asked(0)) == REJECTED


@pytest.mark.parametrize("by_command", [True, False])
def test_ardupilots_accelerometers_are_turned_side_by_side(by_command: bool) -> None:  # noqa: FBT001 - a case
    station = Station(endpoint_of(AP))
    assert station.command(CALIBRATE, *asked(4)) == ACCEPTED
    for side in range(1, 7):
        station.run(1.1)
        wanted = [message for message in station.of("COMMAND_LONG") if message.param1 == side]
        assert len(wanted) == 2  # asked for again each second
        assert wanted[0].command == mavlink.MAV_CMD_ACCELCAL_VEHICLE_POS
        assert len([text for text in station.texts() if text.startswith("Place vehicle ")]) == side
        if by_command:
            assert station.command(mavlink.MAV_CMD_ACCELCAL_VEHICLE_POS, side) == ACCEPTED
        else:
            station.send(mavlink.MAVLink_command_ack_message(0, 1))
    station.run(0.1)
    assert station.last("COMMAND_LONG").param1 == SUCCESS
    assert station.texts()[-1] == "Calibration successful"
    assert station.command(mavlink.MAV_CMD_ACCELCAL_VEHICLE_POS, 3) == FAILED


def test_ardupilots_compass_tells_how_far_it_is() -> None:
    station = Station(endpoint_of(AP))
    assert station.command(mavlink.MAV_CMD_DO_ACCEPT_MAG_CAL) == FAILED
    assert station.command(mavlink.MAV_CMD_DO_START_MAG_CAL, 0, 1, 0) == ACCEPTED
    station.wait_until(lambda: bool(station.of("MAG_CAL_REPORT")), within_s=12.0)
    assert [message.completion_pct for message in station.of("MAG_CAL_PROGRESS")] == list(range(0, 101, 10))
    report = station.last("MAG_CAL_REPORT")
    assert (report.cal_status, report.autosaved) == (mavlink.MAG_CAL_SUCCESS, 0)
    assert station.command(mavlink.MAV_CMD_DO_ACCEPT_MAG_CAL) == ACCEPTED
    station.forget()
    station.run(2.0)
    assert not station.of("MAG_CAL_REPORT")


def test_what_ardupilot_does_at_once() -> None:
    station = Station(endpoint_of(AP))
    for place, value in ((0, 1), (2, 1), (4, 2), (4, 4)):
        assert station.command(CALIBRATE, *asked(place, value)) == ACCEPTED
        station.run(0.6)
    assert {"Barometer calibration complete", "Calibration successful"} <= set(station.texts())
    assert station.command(CALIBRATE, *asked(3)) == UNSUPPORTED
    station.wait_for_position()
    station.command(mavlink.MAV_CMD_COMPONENT_ARM_DISARM, 1)
    assert station.command(CALIBRATE, *asked(0)) == FAILED
    assert station.texts()[-1] == "Disarm to allow calibration"
