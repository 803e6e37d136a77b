"""QGroundControl's sequences leave nothing unanswered: initial connection, component information, plans, events."""

import pytest
from pymavlink.dialects.v20 import ardupilotmega as mavlink

from tests.clients.ground_control import GroundControl
from vehicle_sim.parameters import Flavour
from vehicle_sim.protocol.dialect import Message

AP, PX4 = Flavour.ARDUPILOT, Flavour.PX4
BOTH = pytest.mark.parametrize("flavour", Flavour)
MISSION, FENCE, RALLY = range(3)
FRAME = mavlink.MAV_FRAME_GLOBAL_RELATIVE_ALT_INT
LAT, LON = 473_977_420, 85_455_940


def item(kind: int, seq: int, command: int, *, north: int, east: int, param1: float = 0.0) -> Message:
    place = (param1, 0.0, 0.0, 0.0, LAT + north, LON + east, 10.0, kind)
    return mavlink.MAVLink_mission_item_int_message(1, 1, seq, FRAME, command, 0, 1, *place)


def plan(kind: int) -> list[Message]:
    """Return a small plan of each kind: a square, flown, fenced or rallied at."""
    command, param1 = {
        MISSION: (mavlink.MAV_CMD_NAV_WAYPOINT, 0.0),
        FENCE: (mavlink.MAV_CMD_NAV_FENCE_POLYGON_VERTEX_INCLUSION, 4.0),
        RALLY: (mavlink.MAV_CMD_NAV_RALLY_POINT, 0.0),
    }[kind]
    corners = ((-9000, -9000), (9000, -9000), (9000, 9000), (-9000, 9000))
    return [item(kind, seq, command, north=n, east=e, param1=param1) for seq, (n, e) in enumerate(corners)]


@BOTH
def test_the_initial_connection_is_answered_throughout(flavour: Flavour) -> None:
    station = GroundControl(flavour)
    station.wait_for_position()
    station.connect()
    assert station.missing == []


@BOTH
def test_modes_parameters_and_metadata_are_whole(flavour: Flavour) -> None:
    station = GroundControl(flavour)
    assert set(station.modes()) == set(station.endpoint.table.modes)
    assert station.parameters() == len(list(station.endpoint.vehicle.parameters))
    assert set(station.component_information()) == (set() if flavour is AP else {4, 5})
    assert station.missing == []


@BOTH
@pytest.mark.parametrize("kind", range(3))
def test_plans_go_up_and_come_down(flavour: Flavour, kind: int) -> None:
    station = GroundControl(flavour)
    station.wait_for_position()
    items = plan(kind)
    assert station.upload(kind, items) == mavlink.MAV_MISSION_ACCEPTED
    down = station.download(kind)
    home = 1 if kind == MISSION and flavour is AP else 0  # item 0 of ArduPilot's mission is home
    assert [(one.command, one.x, one.y) for one in down[home:]] == [(one.command, one.x, one.y) for one in items[home:]]
    assert station.missing == []


def test_a_part_of_a_mission_goes_up() -> None:
    station = GroundControl(AP)
    station.wait_for_position()
    assert station.upload(MISSION, plan(MISSION)) == mavlink.MAV_MISSION_ACCEPTED
    other = item(MISSION, 2, mavlink.MAV_CMD_NAV_WAYPOINT, north=1234, east=0)
    begin = mavlink.MAVLink_mission_write_partial_list_message(1, 1, 2, 2, MISSION)
    assert station.upload(MISSION, [other], begin, first=2) == mavlink.MAV_MISSION_ACCEPTED
    assert [one.x - LAT for one in station.download(MISSION)[1:]] == [9000, 1234, -9000]
    assert station.missing == []


def test_px4s_report_of_its_arming_checks_is_understood() -> None:
    station = GroundControl(PX4)
    station.wait_for_position()
    groups = station.component_information()[4]["components"]["1"]["event_groups"]
    known = {
        1 << 24 | int(number): (group, event)
        for group, one in groups.items()
        for number, event in one["events"].items()
    }
    station.command(mavlink.MAV_CMD_RUN_PREARM_CHECKS)
    report = [known[event.id] for event in station.of("EVENT")]
    # First a summary of arming, then what fails, then a summary of health: only so it is shown.
    assert (report[0][0], report[0][1]["type"]) == ("arming_check", "summary")
    assert (report[-1][0], report[-1][1]["type"]) == ("health", "summary")
    assert all(group == "arming_check" and "type" not in event for group, event in report[1:-1])
    station.forget()
    assert len(station.events(len(report))) == len(report)
    assert station.missing == []
