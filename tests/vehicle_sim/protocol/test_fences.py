"""Fences and rally points on the wire: checks at upload, FENCE_STATUS, SYS_STATUS, DO_FENCE_ENABLE."""

from math import nan

import pytest
from pymavlink.dialects.v20 import ardupilotmega as mavlink

from tests.support.station import Station, endpoint_of
from vehicle_sim.autopilot.geofence import Circle, Polygon
from vehicle_sim.errors import PlanError
from vehicle_sim.parameters import FenceType, Flavour
from vehicle_sim.protocol.dialect import Message
from vehicle_sim.protocol.fences import fence_plan
from vehicle_sim.protocol.plan_store import PlanItem, PlanKind
from vehicle_sim.signals import Geodetic

LAT, LON = 473_977_420, 85_455_940
RETURN, STAY_IN, STAY_OUT, CIRCLE_IN, CIRCLE_OUT = 5000, 5001, 5002, 5003, 5004
RALLY_POINT = 5100
FENCE, RALLY = PlanKind.FENCE, PlanKind.RALLY
GEOFENCE_BIT = mavlink.MAV_SYS_STATUS_GEOFENCE
ENABLE = mavlink.MAV_CMD_DO_FENCE_ENABLE
Item = tuple[int, float, int, int]

# About 44 m to each side of where the vehicle stands.
SQUARE: list[Item] = [
    (STAY_IN, 4, LAT + north, LON + east)
    for north, east in ((4000, 6000), (4000, -6000), (-4000, -6000), (-4000, 6000))
]


def plan_item(item: Item) -> PlanItem:
    command, first, x, y = item
    return PlanItem(mavlink.MAV_FRAME_GLOBAL_INT, command, 1, (first, 0.0, 0.0, 0.0), x, y, 0.0)


def upload(station: Station, items: list[Item], kind: PlanKind = FENCE, *, frame: int = 6, z: float = 0.0) -> int:
    """Upload and return the result of the acknowledgement."""
    station.forget()
    station.send(mavlink.MAVLink_mission_count_message(1, 1, len(items), kind))
    for seq, (command, first, x, y) in enumerate(items):
        station.send(
            mavlink.MAVLink_mission_item_int_message(1, 1, seq, frame, command, 0, 1, first, 0, 0, 0, x, y, z, kind)
        )
    # What follows a refusal is answered too.
    return int(station.of("MISSION_ACK")[0].type)


def areas(station: Station) -> int:
    return len(station.endpoint.vehicle.autopilot.guard.fence.plan.areas)


def watched(station: Station) -> FenceType:
    return station.endpoint.vehicle.autopilot.guard.fence.enabled


def status(station: Station) -> Message:
    station.forget()
    assert station.request(mavlink.MAVLINK_MSG_ID_FENCE_STATUS) == mavlink.MAV_RESULT_ACCEPTED
    return station.last("FENCE_STATUS")


def geofence_bits(station: Station) -> tuple[bool, bool, bool]:
    """Whether SYS_STATUS calls the fence present, enabled and well."""
    station.forget()
    station.request(mavlink.MAVLINK_MSG_ID_SYS_STATUS)
    message = station.last("SYS_STATUS")
    sensors = (
        message.onboard_control_sensors_present,
        message.onboard_control_sensors_enabled,
        message.onboard_control_sensors_health,
    )
    return tuple(bool(bits & GEOFENCE_BIT) for bits in sensors)  # type: ignore[return-value]


def test_items_become_areas() -> None:
    triangle: list[Item] = [(STAY_OUT, 3, LAT + i, LON) for i in range(3)]
    items: list[Item] = [*SQUARE, (CIRCLE_OUT, 12.5, LAT, LON), *triangle, (RETURN, 0, LAT, LON), (CIRCLE_IN, 90, 0, 0)]
    plan = fence_plan([plan_item(item) for item in items])
    square, hole, wedge, around = plan.areas
    assert isinstance(square, Polygon)
    assert (square.contains, len(square.vertices)) == (True, 4)
    assert isinstance(wedge, Polygon)
    assert (wedge.contains, len(wedge.vertices)) == (False, 3)
    assert isinstance(hole, Circle)
    assert (hole.contains, hole.radius_m) == (False, 12.5)
    assert isinstance(around, Circle)
    assert around.contains
    assert plan.return_point == Geodetic(47.397742, 8.545594, 0.0)
    assert fence_plan([]).areas == ()


BAD: dict[str, list[Item]] = {
    "two vertices": [(STAY_IN, 2, LAT, LON), (STAY_IN, 2, LAT, LON + 9)],
    "no count": [(STAY_IN, 0, LAT + i, LON) for i in range(3)],
    "no number": [(STAY_IN, nan, LAT + i, LON) for i in range(3)],
    "half a vertex": [(STAY_IN, 3.5, LAT + i, LON) for i in range(4)],
    "a run too short": SQUARE[:3],
    "a run of two kinds": [*SQUARE[:3], (STAY_OUT, 4, LAT, LON)],
    "a run of two counts": [*SQUARE[:3], (STAY_IN, 5, LAT, LON)],
    "a run broken by a circle": [*SQUARE[:2], (CIRCLE_IN, 9, LAT, LON), *SQUARE[2:]],
    "a circle of nothing": [(CIRCLE_IN, 0, LAT, LON)],
    "a circle of less": [(CIRCLE_OUT, -5, LAT, LON)],
    "two return points": [(RETURN, 0, LAT, LON), (RETURN, 0, LAT, LON)],
}


@pytest.mark.parametrize("case", BAD)
@pytest.mark.parametrize("flavour", Flavour)
def test_a_bad_fence_is_refused_as_a_whole_and_the_former_one_kept(flavour: Flavour, case: str) -> None:
    with pytest.raises(PlanError):
        fence_plan([plan_item(item) for item in BAD[case]])
    station = Station(endpoint_of(flavour))
    assert upload(station, SQUARE) == mavlink.MAV_MISSION_ACCEPTED
    assert upload(station, BAD[case]) == mavlink.MAV_MISSION_ERROR
    station.forget()
    station.send(mavlink.MAVLink_mission_request_list_message(1, 1, FENCE))
    assert station.last("MISSION_COUNT").count == 4
    assert areas(station) == 1


@pytest.mark.parametrize("flavour", Flavour)
def test_a_latitude_beyond_the_pole_is_refused(flavour: Flavour) -> None:
    station = Station(endpoint_of(flavour))
    beyond: list[Item] = [(STAY_IN, 4, 950_000_000, LON), *SQUARE[1:]]
    assert upload(station, beyond) == mavlink.MAV_MISSION_INVALID_PARAM5_X


@pytest.mark.parametrize("flavour", Flavour)
def test_clearing_the_fence_ends_it(flavour: Flavour) -> None:
    station = Station(endpoint_of(flavour))
    upload(station, SQUARE)
    assert areas(station) == 1
    station.send(mavlink.MAVLink_mission_clear_all_message(1, 1, FENCE))
    assert areas(station) == 0
    upload(station, SQUARE)
    upload(station, [])
    assert areas(station) == 0


def test_fence_status_and_sys_status_tell_of_a_breach() -> None:
    station = Station(endpoint_of(Flavour.ARDUPILOT))
    vehicle = station.endpoint.vehicle
    station.take_off()
    assert upload(station, SQUARE) == mavlink.MAV_MISSION_ACCEPTED
    assert station.request(mavlink.MAVLINK_MSG_ID_FENCE_STATUS) == mavlink.MAV_RESULT_FAILED
    assert geofence_bits(station) == (True, False, True)
    vehicle.parameters.set("AVOID_ENABLE", 0)
    assert station.command(ENABLE, 1) == mavlink.MAV_RESULT_ACCEPTED
    message = status(station)
    assert (message.breach_status, message.breach_count, message.breach_type) == (0, 0, mavlink.FENCE_BREACH_NONE)
    assert message.breach_mitigation == mavlink.FENCE_MITIGATE_NONE
    assert geofence_bits(station) == (True, True, True)
    station.forget()
    for _ in range(150):
        station.setpoint(velocity=(5, 0, 0), mask=0xDC7)
        station.run(0.1)
        if vehicle.autopilot.guard.fence.breaches:
            break
    assert "Polygon fence breached" in station.texts()
    station.run(0.5)
    message = status(station)
    assert (message.breach_status, message.breach_count, message.breach_type) == (1, 1, mavlink.FENCE_BREACH_BOUNDARY)
    assert vehicle.time_s * 1000.0 - message.breach_time == pytest.approx(550.0, abs=100.0)
    assert geofence_bits(station) == (True, True, False)
    assert station.command(ENABLE, 0) == mavlink.MAV_RESULT_ACCEPTED
    assert not vehicle.autopilot.guard.fence.breached
    assert geofence_bits(station) == (True, False, True)


def test_fence_status_tells_of_slower_velocities() -> None:
    station = Station(endpoint_of(Flavour.ARDUPILOT))
    station.take_off()
    upload(station, SQUARE)
    station.command(ENABLE, 1)
    for _ in range(150):
        station.setpoint(velocity=(6, 0, 0), mask=0xDC7)
        station.run(0.1)
    message = status(station)
    assert message.breach_count == 0
    assert message.breach_mitigation == mavlink.FENCE_MITIGATE_VEL_LIMIT


def test_fences_are_switched_by_command_in_whole_or_in_part() -> None:
    station = Station(endpoint_of(Flavour.ARDUPILOT))
    accepted, failed = mavlink.MAV_RESULT_ACCEPTED, mavlink.MAV_RESULT_FAILED
    assert watched(station) == FenceType.NONE
    assert station.command(ENABLE, 1, FenceType.CIRCLE) == accepted
    assert watched(station) == FenceType.CIRCLE
    assert station.command(ENABLE, 1) == accepted
    assert station.command(ENABLE, 0, FenceType.ALTITUDE) == accepted
    assert watched(station) == FenceType.CIRCLE | FenceType.AREAS
    assert station.command(ENABLE, 7) == failed
    assert station.command(ENABLE, nan) == failed
    # A parameter that changes outweighs the command.
    station.endpoint.vehicle.parameters.set("FENCE_TYPE", FenceType.AREAS)
    station.run(0.1)
    assert watched(station) == FenceType.NONE
    assert station.command(ENABLE, 1) == failed  # nothing uploaded, so there is no fence to watch
    upload(station, SQUARE)
    assert station.command(ENABLE, 1) == accepted
    assert Station(endpoint_of(Flavour.PX4)).command(ENABLE, 1) == mavlink.MAV_RESULT_UNSUPPORTED


def test_rally_points_and_their_frames() -> None:
    relative, absolute = mavlink.MAV_FRAME_GLOBAL_RELATIVE_ALT_INT, mavlink.MAV_FRAME_GLOBAL_INT
    for flavour, absolute_is, height_m in (
        (Flavour.ARDUPILOT, mavlink.MAV_MISSION_UNSUPPORTED_FRAME, 22.0),
        (Flavour.PX4, mavlink.MAV_MISSION_ACCEPTED, 9.0),
    ):
        station = Station(endpoint_of(flavour))
        station.wait_for_position()
        autopilot = station.endpoint.vehicle.autopilot
        assert autopilot.home is not None
        point: list[Item] = [(RALLY_POINT, 0, LAT + 100, LON)]
        assert upload(station, point, RALLY, frame=relative, z=22.0) == mavlink.MAV_MISSION_ACCEPTED
        assert [one.height_m for one in autopilot.rally] == [22.0]
        assert upload(station, point, RALLY, frame=absolute, z=autopilot.home.alt_m + 9.0) == absolute_is
        assert [one.height_m for one in autopilot.rally] == pytest.approx([height_m], abs=1e-3)
        assert upload(station, [], RALLY) == mavlink.MAV_MISSION_ACCEPTED
        assert autopilot.rally == ()
