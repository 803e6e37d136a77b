"""MAV_CMD_INJECT_FAILURE, as PX4 takes it, and as ArduPilot does not."""

import pytest
from pymavlink.dialects.v20 import ardupilotmega as mavlink

from tests.support.station import Station, endpoint_of
from vehicle_sim.parameters import Flavour

INJECT = mavlink.MAV_CMD_INJECT_FAILURE
GPS, MOTOR, AIRSPEED = (
    mavlink.FAILURE_UNIT_SENSOR_GPS,
    mavlink.FAILURE_UNIT_SYSTEM_MOTOR,
    mavlink.FAILURE_UNIT_SENSOR_AIRSPEED,
)
OK, OFF, GARBAGE = mavlink.FAILURE_TYPE_OK, mavlink.FAILURE_TYPE_OFF, mavlink.FAILURE_TYPE_GARBAGE


def px4(*, enabled: bool = True) -> Station:
    station = Station(endpoint_of(Flavour.PX4))
    station.endpoint.vehicle.parameters.set("SYS_FAILURE_EN", float(enabled))
    return station


def test_ardupilot_does_not_know_it_and_px4_denies_it_unless_enabled() -> None:
    assert Station(endpoint_of(Flavour.ARDUPILOT)).command(INJECT, GPS, OFF) == mavlink.MAV_RESULT_UNSUPPORTED
    assert px4(enabled=False).command(INJECT, GPS, OFF) == mavlink.MAV_RESULT_DENIED


@pytest.mark.parametrize(
    "params",
    [(AIRSPEED, OFF), (GPS, GARBAGE), (GPS, OFF, 7), (MOTOR, OFF, 5), (-1, OFF), (GPS, float("nan")), (4.5, 1)],
)
def test_what_it_has_not_is_not_supported_and_changes_nothing(params: tuple[float, ...]) -> None:
    station = px4()
    station.run(0.1)
    before = station.endpoint.vehicle.faults.conditions
    assert station.command(INJECT, *params) == mavlink.MAV_RESULT_UNSUPPORTED
    station.run(0.1)
    assert station.endpoint.vehicle.faults.conditions == before


def test_the_gps_goes_off_and_comes_back() -> None:
    station = px4()
    station.wait_for_position()
    for _ in range(2):  # repeats are as good as one
        assert station.command(INJECT, GPS, OFF) == mavlink.MAV_RESULT_ACCEPTED
    station.run(6.0)
    station.request(mavlink.MAVLINK_MSG_ID_ESTIMATOR_STATUS)
    assert not station.last("ESTIMATOR_STATUS").flags & mavlink.ESTIMATOR_POS_HORIZ_ABS
    station.request(mavlink.MAVLINK_MSG_ID_SYS_STATUS)
    assert not station.last("SYS_STATUS").onboard_control_sensors_health & mavlink.MAV_SYS_STATUS_SENSOR_GPS
    assert station.command(INJECT, GPS, OK) == mavlink.MAV_RESULT_ACCEPTED
    station.run(2.0)
    station.request(mavlink.MAVLINK_MSG_ID_ESTIMATOR_STATUS)
    assert station.last("ESTIMATOR_STATUS").flags & mavlink.ESTIMATOR_POS_HORIZ_ABS
    station.request(mavlink.MAVLINK_MSG_ID_SYS_STATUS)
    assert station.last("SYS_STATUS").onboard_control_sensors_health & mavlink.MAV_SYS_STATUS_SENSOR_GPS


def test_a_motor_stops_in_flight_and_the_vehicle_comes_down() -> None:
    station = px4()
    station.take_off()
    assert station.command(INJECT, MOTOR, OFF, 0) == mavlink.MAV_RESULT_ACCEPTED
    station.wait_until(lambda: station.endpoint.vehicle.truth.on_ground, within_s=5.0)
