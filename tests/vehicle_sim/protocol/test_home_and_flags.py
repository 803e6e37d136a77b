"""Home is there when the flags of the position are: whoever has seen them may ask for it."""

import pytest
from pymavlink.dialects.v20 import ardupilotmega as mavlink

from tests.support.station import Station, endpoint_of
from vehicle_sim.parameters import Flavour

# A disarmed vehicle counts as ready, in older clients, once it predicts a position.
POSITION = mavlink.ESTIMATOR_POS_HORIZ_ABS | mavlink.ESTIMATOR_PRED_POS_HORIZ_ABS
ESTIMATOR = {
    Flavour.ARDUPILOT: (mavlink.MAVLINK_MSG_ID_EKF_STATUS_REPORT, "EKF_STATUS_REPORT"),
    Flavour.PX4: (mavlink.MAVLINK_MSG_ID_ESTIMATOR_STATUS, "ESTIMATOR_STATUS"),
}


@pytest.mark.parametrize("flavour", Flavour)
def test_home_is_there_when_the_flags_are(flavour: Flavour) -> None:
    station = Station(endpoint_of(flavour))
    number, name = ESTIMATOR[flavour]
    station.command(mavlink.MAV_CMD_SET_MESSAGE_INTERVAL, number, 10_000)
    station.run(1.0)
    station.wait_until(lambda: station.last(name).flags & POSITION != 0, within_s=60.0)
    assert station.of("HOME_POSITION")
    assert station.request(mavlink.MAVLINK_MSG_ID_HOME_POSITION) == mavlink.MAV_RESULT_ACCEPTED
    if flavour is Flavour.ARDUPILOT:
        station.send(mavlink.MAVLink_mission_request_list_message(1, 1))
        assert station.last("MISSION_COUNT").count == 1
        station.send(mavlink.MAVLink_mission_request_int_message(1, 1, 0))
        home = station.last("MISSION_ITEM_INT")
        told = station.last("HOME_POSITION")
        assert (home.x, home.y) == (told.latitude, told.longitude) != (0, 0)
