"""Parts of plans: items written into a mission, fences and rally points read point by point."""

import pytest
from pymavlink.dialects.v20 import ardupilotmega as mavlink

from tests.support.station import Station, endpoint_of
from vehicle_sim.parameters import Flavour

AP, PX4 = Flavour.ARDUPILOT, Flavour.PX4
MISSION, FENCE, RALLY = range(3)
FRAME = mavlink.MAV_FRAME_GLOBAL_RELATIVE_ALT_INT
LAT, LON = 473_977_420, 85_455_940


def item(seq: int, kind: int, command: int, *, north: int = 0, east: int = 0, param1: float = 0.0, z: float = 10.0):  # type: ignore[no-untyped-def]  # noqa: ANN201
    place = (param1, 0.0, 0.0, 0.0, LAT + north, LON + east, z, kind)
    return mavlink.MAVLink_mission_item_int_message(1, 1, seq, FRAME, command, 0, 1, *place)


def waypoint(seq: int, north: int):  # type: ignore[no-untyped-def]  # noqa: ANN201
    return item(seq, MISSION, mavlink.MAV_CMD_NAV_WAYPOINT, north=north)


def uploaded(station: Station, kind: int, *items: object) -> None:
    station.send(mavlink.MAVLink_mission_count_message(1, 1, len(items), kind), *items)
    assert station.last("MISSION_ACK").type == mavlink.MAV_MISSION_ACCEPTED


def places(station: Station) -> list[int]:
    station.forget()
    station.send(mavlink.MAVLink_mission_request_list_message(1, 1, MISSION))
    count = station.last("MISSION_COUNT").count
    station.send(*(mavlink.MAVLink_mission_request_int_message(1, 1, seq, MISSION) for seq in range(count)))
    return [message.x - LAT for message in station.of("MISSION_ITEM_INT")]


@pytest.fixture
def ardupilot() -> Station:
    station = Station(endpoint_of(AP))
    station.wait_for_position()
    uploaded(station, MISSION, *(waypoint(seq, 1000 * seq) for seq in range(5)))
    return station


def test_items_in_the_middle_are_replaced(ardupilot: Station) -> None:
    ardupilot.forget()
    ardupilot.send(mavlink.MAVLink_mission_write_partial_list_message(1, 1, 2, 3, MISSION))
    assert ardupilot.last("MISSION_REQUEST").seq == 2
    ardupilot.send(waypoint(2, 2222), waypoint(3, 3333))
    assert ardupilot.last("MISSION_ACK").type == mavlink.MAV_MISSION_ACCEPTED
    assert places(ardupilot)[1:] == [1000, 2222, 3333, 4000]


def test_items_are_appended(ardupilot: Station) -> None:
    ardupilot.send(mavlink.MAVLink_mission_write_partial_list_message(1, 1, 5, 5, MISSION), waypoint(5, 5000))
    assert places(ardupilot)[1:] == [1000, 2000, 3000, 4000, 5000]


@pytest.mark.parametrize(("first", "last"), [(6, 6), (3, 2), (-1, 2), (2, 9)])
def test_what_is_not_there_is_not_written(ardupilot: Station, first: int, last: int) -> None:
    ardupilot.send(mavlink.MAVLink_mission_write_partial_list_message(1, 1, first, last, MISSION))
    assert ardupilot.last("MISSION_ACK").type == mavlink.MAV_MISSION_ERROR
    assert "Flight plan update rejected" in ardupilot.texts()


def test_px4_writes_whole_missions() -> None:
    station = Station(endpoint_of(PX4))
    station.send(mavlink.MAVLink_mission_write_partial_list_message(1, 1, 0, 1, MISSION))
    assert station.last("MISSION_ACK").type == mavlink.MAV_MISSION_UNSUPPORTED


def test_a_fence_is_read_point_by_point(ardupilot: Station) -> None:
    corners = [(-9000, -9000), (9000, -9000), (9000, 9000)]
    fetch = mavlink.MAVLink_fence_fetch_point_message
    ardupilot.forget()
    ardupilot.send(fetch(1, 1, 0))
    assert not ardupilot.of("FENCE_POINT")
    vertex = mavlink.MAV_CMD_NAV_FENCE_POLYGON_VERTEX_INCLUSION
    uploaded(
        ardupilot,
        FENCE,
        *(item(seq, FENCE, vertex, north=n, east=e, param1=3.0) for seq, (n, e) in enumerate(corners)),
    )
    ardupilot.send(*(fetch(1, 1, index) for index in range(5)))
    points = ardupilot.of("FENCE_POINT")
    assert [(point.idx, point.count) for point in points] == [(index, 5) for index in range(5)]
    assert [round(point.lat * 1e7) - LAT for point in points[1:]] == pytest.approx([-9000, 9000, 9000, -9000], abs=30)
    ardupilot.send(fetch(1, 1, 5))
    assert ardupilot.texts()[-1] == "Invalid fence point, index past end"


def test_rally_points_are_read_one_by_one(ardupilot: Station) -> None:
    rally = mavlink.MAV_CMD_NAV_RALLY_POINT
    uploaded(ardupilot, RALLY, item(0, RALLY, rally, north=100, z=20.0), item(1, RALLY, rally, north=200, z=30.0))
    ardupilot.send(*(mavlink.MAVLink_rally_fetch_point_message(1, 1, index) for index in range(3)))
    points = ardupilot.of("RALLY_POINT")
    assert [(point.idx, point.count, point.lat - LAT, point.alt) for point in points] == [
        (0, 2, 100, 20),
        (1, 2, 200, 30),
    ]
    assert ardupilot.texts()[-1] == "Bad rally point index"
