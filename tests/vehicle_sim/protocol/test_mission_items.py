"""What each flavour says to each item of a mission, and what an accepted one comes to mean."""

from math import inf, nan, pi

import pytest
from pymavlink.dialects.v20 import ardupilotmega as mavlink

from tests.support.station import Station, endpoint_of
from vehicle_sim.autopilot import Command, Datum
from vehicle_sim.autopilot.mission_items import FOREVER
from vehicle_sim.parameters import Flavour
from vehicle_sim.protocol.mission_items import item_fault, mission_item
from vehicle_sim.protocol.plan_store import MOST_ITEMS, PlanItem

AP, PX4 = Flavour.ARDUPILOT, Flavour.PX4
OK, UNSUPPORTED = mavlink.MAV_MISSION_ACCEPTED, mavlink.MAV_MISSION_UNSUPPORTED
FRAME = mavlink.MAV_MISSION_UNSUPPORTED_FRAME
P1, P2, P4 = (
    mavlink.MAV_MISSION_INVALID_PARAM1,
    mavlink.MAV_MISSION_INVALID_PARAM2,
    mavlink.MAV_MISSION_INVALID_PARAM4,
)
X, Y, Z = (
    mavlink.MAV_MISSION_INVALID_PARAM5_X,
    mavlink.MAV_MISSION_INVALID_PARAM6_Y,
    mavlink.MAV_MISSION_INVALID_PARAM7,
)
NONE = (0.0, 0.0, 0.0, 0.0)


def item(
    command: str = "NAV_WAYPOINT",
    params: tuple[float, float, float, float] = NONE,
    *,
    frame: int = mavlink.MAV_FRAME_GLOBAL_RELATIVE_ALT_INT,
    x: int = 473_977_420,
    y: int = 85_455_940,
    z: float = 10.0,
    autocontinue: int = 1,
) -> PlanItem:
    number = getattr(mavlink, f"MAV_CMD_{command}") if isinstance(command, str) else command
    return PlanItem(frame, number, autocontinue, params, x, y, z)


MISSION = mavlink.MAV_FRAME_MISSION
TABLE = [
    (item(), OK, OK),
    (item(frame=mavlink.MAV_FRAME_GLOBAL), OK, OK),
    (item(frame=mavlink.MAV_FRAME_GLOBAL_RELATIVE_ALT), OK, OK),
    (item(frame=mavlink.MAV_FRAME_GLOBAL_TERRAIN_ALT), OK, FRAME),
    (item(frame=mavlink.MAV_FRAME_LOCAL_NED), FRAME, FRAME),
    (item(frame=mavlink.MAV_FRAME_LOCAL_ENU), FRAME, FRAME),
    (item(frame=200), FRAME, FRAME),
    (item(frame=MISSION), OK, UNSUPPORTED),
    (item(x=950_000_000), X, OK),
    (item(x=-900_000_001), X, OK),
    (item(y=1_810_000_000), Y, OK),
    (item(z=nan), Z, Z),
    (item(z=inf), Z, Z),
    (item(z=83_000.0), Z, OK),
    (item(params=(0.0, 0.0, 0.0, nan)), OK, OK),
    (item(params=(nan, 0.0, 0.0, 0.0)), P1, OK),
    (item(params=(0.0, inf, 0.0, 0.0)), P2, OK),
    (item("NAV_TAKEOFF", (0.0, 0.0, 0.0, nan)), OK, OK),
    (item("NAV_LAND", (0.0, 0.0, 0.0, nan)), OK, OK),
    (item("NAV_LOITER_UNLIM", (0.0, 0.0, 0.0, nan)), P4, OK),
    (item("NAV_LOITER_TIME", (5.0, 0.0, 0.0, 0.0)), OK, OK),
    (item("NAV_LOITER_TURNS", (2.0, 0.0, 5.0, 0.0)), OK, UNSUPPORTED),
    (item("NAV_LOITER_TO_ALT"), OK, OK),
    (item("NAV_SPLINE_WAYPOINT"), OK, UNSUPPORTED),
    (item("NAV_RETURN_TO_LAUNCH", frame=MISSION), OK, OK),
    (item("NAV_RETURN_TO_LAUNCH"), OK, UNSUPPORTED),
    (item("NAV_DELAY", (5.0, 0.0, 0.0, 0.0), frame=MISSION), OK, OK),
    (item("DO_JUMP", (1.0, 2.0, 0.0, 0.0), frame=MISSION), OK, OK),
    (item("DO_JUMP", (1.0, 2.0, 0.0, 0.0), frame=mavlink.MAV_FRAME_LOCAL_NED), OK, FRAME),
    (item("DO_CHANGE_SPEED", (1.0, 3.0, -1.0, 0.0), frame=MISSION), OK, OK),
    (item("DO_CHANGE_SPEED", (1.0, 3.0, nan, 0.0), frame=MISSION), mavlink.MAV_MISSION_INVALID_PARAM3, OK),
    (item("CONDITION_DELAY", (5.0, 0.0, 0.0, 0.0), frame=MISSION), OK, OK),
    (item("CONDITION_YAW", (90.0, 0.0, 1.0, 0.0), frame=MISSION), OK, UNSUPPORTED),
    (item("DO_SET_ROI_LOCATION"), OK, OK),
    (item("DO_SET_ROI_LOCATION", x=910_000_000), X, OK),
    (item("DO_SET_ROI", (3.0, 0.0, 0.0, 0.0)), OK, OK),
    (item("DO_SET_ROI", (4.0, 0.0, 0.0, 0.0)), OK, P1),
    (item("DO_SET_SERVO", (1.0, 1500.0, 0.0, 0.0), frame=MISSION), OK, UNSUPPORTED),
    (item("NAV_FENCE_CIRCLE_INCLUSION"), UNSUPPORTED, UNSUPPORTED),
    (item("NAV_RALLY_POINT"), UNSUPPORTED, UNSUPPORTED),
    (item("COMPONENT_ARM_DISARM", frame=MISSION), UNSUPPORTED, UNSUPPORTED),
]


@pytest.mark.parametrize(("sent", "ardupilot", "px4"), TABLE)
def test_results(sent: PlanItem, ardupilot: int, px4: int) -> None:
    assert (item_fault(AP, sent), item_fault(PX4, sent)) == (ardupilot, px4)


@pytest.mark.parametrize("flavour", Flavour)
@pytest.mark.parametrize("in_integers", [True, False])
def test_a_bad_item_ends_the_upload_and_keeps_the_mission(flavour: Flavour, *, in_integers: bool) -> None:
    station = Station(endpoint_of(flavour))

    def send(command: int, lat: float = 47.0) -> None:
        station.send(mavlink.MAVLink_mission_count_message(1, 1, 3, 0))
        for seq in range(3):
            number = command if seq == 1 else mavlink.MAV_CMD_NAV_WAYPOINT
            if in_integers:
                place = (round(lat * 1e7), round(8.0 * 1e7), 10.0, 0)
                station.send(mavlink.MAVLink_mission_item_int_message(1, 1, seq, 6, number, 0, 1, *NONE, *place))
            else:
                station.send(mavlink.MAVLink_mission_item_message(1, 1, seq, 3, number, 0, 1, *NONE, lat, 8.0, 10.0, 0))

    send(mavlink.MAV_CMD_NAV_WAYPOINT)
    assert station.last("MISSION_ACK").type == OK
    held = station.endpoint.vehicle.autopilot.mission.items
    station.forget()
    send(31_000)
    assert [ack.type for ack in station.of("MISSION_ACK")] == [UNSUPPORTED, mavlink.MAV_MISSION_ERROR]
    station.forget()
    send(mavlink.MAV_CMD_NAV_WAYPOINT, 95.0)
    assert station.of("MISSION_ACK")[0].type == (X if flavour is AP else OK)
    if flavour is AP:
        assert station.endpoint.vehicle.autopilot.mission.items == held


@pytest.mark.parametrize("flavour", Flavour)
def test_too_many_items(flavour: Flavour) -> None:
    station = Station(endpoint_of(flavour))
    station.send(mavlink.MAVLink_mission_count_message(1, 1, MOST_ITEMS + 1, 0))
    assert station.last("MISSION_ACK").type == mavlink.MAV_MISSION_NO_SPACE
    assert station.of("MISSION_REQUEST") == station.of("MISSION_REQUEST_INT") == []


@pytest.mark.parametrize(
    ("frame", "datum"),
    [
        (mavlink.MAV_FRAME_GLOBAL, Datum.SEA),
        (mavlink.MAV_FRAME_GLOBAL_INT, Datum.SEA),
        (mavlink.MAV_FRAME_GLOBAL_RELATIVE_ALT, Datum.HOME),
        (mavlink.MAV_FRAME_GLOBAL_RELATIVE_ALT_INT, Datum.HOME),
        (mavlink.MAV_FRAME_GLOBAL_TERRAIN_ALT_INT, Datum.HOME),
        (MISSION, Datum.SEA),
    ],
)
def test_what_heights_count_from(frame: int, datum: Datum) -> None:
    place = mission_item(AP, item(frame=frame)).place
    assert place == (47.397742, 8.545594, 10.0, datum)


def test_zeros_mean_here_to_ardupilot_alone() -> None:
    zeros = item(x=0, y=0, z=0.0)
    assert mission_item(AP, zeros).place == (None, 0.0, None, Datum.HOME)
    assert mission_item(PX4, zeros).place == (0.0, 0.0, 0.0, Datum.HOME)


def test_numbers_of_waypoints_belong_to_px4_except_the_time() -> None:
    sent = item(params=(3.0, 4.0, 0.0, 90.0), autocontinue=0)
    px4, ardupilot = mission_item(PX4, sent), mission_item(AP, sent)
    assert (px4.seconds, px4.radius_m, px4.yaw_rad, px4.continues) == (3.0, 4.0, pi / 2.0, False)
    assert (ardupilot.seconds, ardupilot.radius_m, ardupilot.yaw_rad, ardupilot.continues) == (3.0, 0.0, None, True)
    assert mission_item(PX4, item(params=(nan, nan, nan, nan))).yaw_rad is None


def test_jumps_and_circles() -> None:
    assert mission_item(PX4, item("DO_JUMP", (2.0, -1.0, 0.0, 0.0), frame=MISSION)).repeats == FOREVER
    jump = mission_item(AP, item("DO_JUMP", (2.0, 3.0, 0.0, 0.0), frame=MISSION))
    assert (jump.command, jump.target, jump.repeats) == (Command.JUMP, 2, 3)
    circle = mission_item(AP, item("NAV_LOITER_TURNS", (1.5, 0.0, -7.0, 0.0)))
    assert (circle.turns, circle.radius_m, circle.clockwise) == (1.5, 7.0, False)
    yaw = mission_item(AP, item("CONDITION_YAW", (90.0, 20.0, -1.0, 1.0), frame=MISSION))
    assert (yaw.yaw_rad, yaw.clockwise, yaw.relative) == (pi / 2.0, False, True)
