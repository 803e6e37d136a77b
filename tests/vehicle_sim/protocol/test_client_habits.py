"""What clients send that a vehicle has to put up with: each seen from a client that stumbled."""

import pytest
from pymavlink.dialects.v20 import ardupilotmega as mavlink

from tests.support.station import Station, endpoint_of
from vehicle_sim.parameters import Flavour

MISSION = mavlink.MAV_MISSION_TYPE_MISSION


@pytest.mark.parametrize("flavour", Flavour)
def test_mavsdk_leaves_the_height_of_a_speed_change_without_a_value(flavour: Flavour) -> None:
    station = Station(endpoint_of(flavour))
    speed = (mavlink.MAV_FRAME_MISSION, mavlink.MAV_CMD_DO_CHANGE_SPEED, 0, 1, 1.0, 5.0, -1.0, 0.0, 0, 0, float("nan"))
    point = (mavlink.MAV_FRAME_GLOBAL_RELATIVE_ALT_INT, mavlink.MAV_CMD_NAV_WAYPOINT)
    place = (1, 1, 0.0, 1.0, 0.0, float("nan"), 473_977_500, 85_456_000, 8.0)
    station.send(
        mavlink.MAVLink_mission_count_message(1, 1, 2, MISSION),
        mavlink.MAVLink_mission_item_int_message(1, 1, 0, *point, *place, MISSION),
        mavlink.MAVLink_mission_item_int_message(1, 1, 1, *speed, MISSION),
    )
    assert station.last("MISSION_ACK").type == mavlink.MAV_MISSION_ACCEPTED


def test_dronekit_asks_for_home_before_there_is_one() -> None:
    station = Station(endpoint_of(Flavour.ARDUPILOT))
    station.send(mavlink.MAVLink_mission_request_list_message(1, 1, MISSION))
    assert station.last("MISSION_COUNT").count == 0
    station.send(mavlink.MAVLink_mission_request_message(1, 1, 0, MISSION))
    home = station.last("MISSION_ITEM")
    assert (home.seq, home.command, home.frame) == (0, mavlink.MAV_CMD_NAV_WAYPOINT, mavlink.MAV_FRAME_GLOBAL)
    assert (home.x, home.y, home.z) == (0.0, 0.0, 0.0)
    station.send(mavlink.MAVLink_mission_request_message(1, 1, 1, MISSION))
    assert station.last("MISSION_ACK").type == mavlink.MAV_MISSION_INVALID_SEQUENCE


def test_px4_has_no_home_in_its_mission() -> None:
    station = Station(endpoint_of(Flavour.PX4))
    station.send(mavlink.MAVLink_mission_request_int_message(1, 1, 0, MISSION))
    assert station.last("MISSION_ACK").type == mavlink.MAV_MISSION_INVALID_SEQUENCE
