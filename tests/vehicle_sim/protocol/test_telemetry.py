"""What the vehicle says of itself, in both flavours."""

import math

import pytest
from pymavlink.dialects.v20 import ardupilotmega as mavlink

from tests.support.station import Station, endpoint_of
from vehicle_sim.autopilot import Mode
from vehicle_sim.geodesy import ned_offset_m
from vehicle_sim.parameters import Flavour
from vehicle_sim.protocol.flavour import TABLES, Rates
from vehicle_sim.signals import Geodetic

SENSORS = 1 | 2 | 4
GPS = 32
PREARM = 0x10000000

IN_FLIGHT = {"POSITION_TARGET_LOCAL_NED", "WIND_COV", "ORBIT_EXECUTION_STATUS"}
"""Of these there is something to say in flight alone, or in a mode of it."""


@pytest.mark.parametrize(
    ("flavour", "autopilot", "base_mode", "custom_mode", "system"),
    [(Flavour.ARDUPILOT, 3, 81, 0, 1), (Flavour.PX4, 12, 29, 0x3040000, 7)],
)
def test_heartbeat_once_a_second_from_the_first_step(
    flavour: Flavour, autopilot: int, base_mode: int, custom_mode: int, system: int
) -> None:
    station = Station(endpoint_of(flavour, system_id=system))
    station.run(10.0)
    beats = station.of("HEARTBEAT")
    assert len(beats) == 10
    beat = beats[0]
    assert (beat.get_srcSystem(), beat.get_srcComponent()) == (system, 1)
    assert (beat.type, beat.autopilot, beat.base_mode, beat.custom_mode) == (2, autopilot, base_mode, custom_mode)
    assert (beat.system_status, beat.mavlink_version) == (mavlink.MAV_STATE_STANDBY, 3)


@pytest.mark.parametrize(
    ("flavour", "mode", "number"),
    [
        (Flavour.ARDUPILOT, Mode.GUIDED, 4),
        (Flavour.ARDUPILOT, Mode.POSITION, 5),
        (Flavour.ARDUPILOT, Mode.RETURN, 6),
        (Flavour.ARDUPILOT, Mode.LAND, 9),
        (Flavour.PX4, Mode.GUIDED, 0x60000),
        (Flavour.PX4, Mode.HOLD, 0x3040000),
        (Flavour.PX4, Mode.RETURN, 0x5040000),
        (Flavour.PX4, Mode.POSITION, 0x30000),
    ],
)
def test_custom_modes_as_observed(flavour: Flavour, mode: Mode, number: int) -> None:
    assert TABLES[flavour].custom_modes[mode] == number
    assert TABLES[flavour].modes[number] is mode


@pytest.mark.parametrize("flavour", Flavour)
def test_every_mode_of_the_autopilot_has_a_number(flavour: Flavour) -> None:
    table = TABLES[flavour]
    assert set(table.custom_modes) == set(endpoint_of(flavour).vehicle.autopilot.modes)
    assert len(table.modes) == len(table.custom_modes)


@pytest.mark.parametrize("flavour", Flavour)
def test_every_default_stream_and_group_can_be_sent(flavour: Flavour) -> None:
    endpoint = endpoint_of(flavour)
    asked = [message_id for rates in endpoint.table.default_rates_hz.values() for message_id in rates]
    asked += [message_id for group in endpoint.table.stream_groups.values() for message_id in group]
    assert [message_id for message_id in asked if not endpoint.has_telemetry(message_id)] == []


@pytest.mark.parametrize(
    ("flavour", "capabilities", "version"),
    [
        (Flavour.ARDUPILOT, 1 | 2 | 4 | 8 | 32 | 64 | 128 | 256 | 512 | 4096 | 8192 | 16384 | 32768 | 2048, 0x04070000),
        (Flavour.PX4, 1 | 2 | 4 | 8 | 16 | 32 | 64 | 128 | 2048 | 8192 | 16384 | 32768, 0x011001FF),
    ],
)
def test_autopilot_version_by_new_and_old_request(flavour: Flavour, capabilities: int, version: int) -> None:
    station = Station(endpoint_of(flavour))
    assert station.request(mavlink.MAVLINK_MSG_ID_AUTOPILOT_VERSION) == mavlink.MAV_RESULT_ACCEPTED
    assert station.command(mavlink.MAV_CMD_REQUEST_AUTOPILOT_CAPABILITIES, 1) == mavlink.MAV_RESULT_ACCEPTED
    station.send(mavlink.MAVLink_autopilot_version_request_message(1, 1))
    versions = station.of("AUTOPILOT_VERSION")
    assert len(versions) == 3
    assert {(m.capabilities, m.flight_sw_version) for m in versions} == {(capabilities, version)}


def test_nothing_but_heartbeat_and_texts_from_ardupilot_until_asked() -> None:
    station = Station(endpoint_of(Flavour.ARDUPILOT), rates=Rates.GROUND_STATION)
    station.run(5.0)
    assert {message.get_type() for message in station.heard} <= {"HEARTBEAT", "STATUSTEXT"}


@pytest.mark.parametrize("rates", [Rates.GROUND_STATION, Rates.ONBOARD])
def test_default_rates_of_px4(rates: Rates) -> None:
    station = Station(endpoint_of(Flavour.PX4), rates=rates)
    station.wait_for_position()
    station.forget()
    station.run(20.0)
    for message_id, hertz in TABLES[Flavour.PX4].default_rates_hz[rates].items():
        name = str(mavlink.mavlink_map[message_id].msgname)
        # The origin and pictures come on change alone, whatever their rate.
        if name not in IN_FLIGHT and message_id not in TABLES[Flavour.PX4].told_on_change:
            assert len(station.of(name)) == pytest.approx(20.0 * hertz, abs=1.1), name


@pytest.mark.parametrize("flavour", Flavour)
def test_no_local_position_before_the_origin_then_origin_and_home_are_announced(flavour: Flavour) -> None:
    station = Station(endpoint_of(flavour))
    local, place = mavlink.MAVLINK_MSG_ID_LOCAL_POSITION_NED, mavlink.MAVLINK_MSG_ID_GLOBAL_POSITION_INT
    for message_id in (local, place):
        assert station.command(mavlink.MAV_CMD_SET_MESSAGE_INTERVAL, message_id, 100_000) == 0
    station.run(1.0)
    assert not station.of("LOCAL_POSITION_NED")
    # ArduPilot's trap: a global position of zeros.
    zeros = station.of("GLOBAL_POSITION_INT")
    assert bool(zeros) is (flavour is Flavour.ARDUPILOT)
    assert all((message.lat, message.lon) == (0, 0) for message in zeros)
    station.wait_until(lambda: bool(station.of("LOCAL_POSITION_NED")), within_s=40.0)
    station.wait_until(lambda: bool(station.of("HOME_POSITION")), within_s=40.0)
    assert len(station.of("GPS_GLOBAL_ORIGIN")) == 1


@pytest.mark.parametrize("flavour", Flavour)
def test_local_and_global_position_agree_by_the_origin(flavour: Flavour) -> None:
    station = Station(endpoint_of(flavour))
    station.take_off(8.0)
    for name in ("GPS_GLOBAL_ORIGIN", "HOME_POSITION", "LOCAL_POSITION_NED", "GLOBAL_POSITION_INT"):
        assert station.request(getattr(mavlink, f"MAVLINK_MSG_ID_{name}")) == mavlink.MAV_RESULT_ACCEPTED
    origin, home = station.last("GPS_GLOBAL_ORIGIN"), station.last("HOME_POSITION")
    local, place = station.last("LOCAL_POSITION_NED"), station.last("GLOBAL_POSITION_INT")
    assert local.time_boot_ms == place.time_boot_ms == station.endpoint.vehicle.time_boot_ms
    zero = Geodetic(origin.latitude * 1e-7, origin.longitude * 1e-7, origin.altitude * 1e-3)
    here = Geodetic(place.lat * 1e-7, place.lon * 1e-7, place.alt * 1e-3)
    assert ned_offset_m(zero, here) == pytest.approx((local.x, local.y, local.z), abs=0.02)
    assert place.relative_alt == pytest.approx(place.alt - home.altitude, abs=2)
    there = Geodetic(home.latitude * 1e-7, home.longitude * 1e-7, home.altitude * 1e-3)
    assert ned_offset_m(zero, there) == pytest.approx((home.x, home.y, home.z), abs=0.02)
    assert local.z < -7.0


@pytest.mark.parametrize("flavour", Flavour)
def test_health_bits_tell_when_it_can_be_armed(flavour: Flavour) -> None:
    station = Station(endpoint_of(flavour))
    station.run(0.1)
    station.request(mavlink.MAVLINK_MSG_ID_SYS_STATUS)
    early = station.last("SYS_STATUS")
    assert early.onboard_control_sensors_present & (SENSORS | GPS | PREARM) == SENSORS | GPS | PREARM
    assert not early.onboard_control_sensors_health & (GPS | PREARM)
    station.wait_for_position()
    station.request(mavlink.MAVLINK_MSG_ID_SYS_STATUS)
    ready = station.last("SYS_STATUS")
    assert ready.onboard_control_sensors_health & (SENSORS | GPS | PREARM) == SENSORS | GPS | PREARM
    assert ready.battery_remaining >= 99


@pytest.mark.parametrize("flavour", Flavour)
def test_the_bit_stays_after_a_landing(flavour: Flavour) -> None:
    station = Station(endpoint_of(flavour))
    station.take_off(2.0)
    assert station.command(mavlink.MAV_CMD_NAV_LAND) == mavlink.MAV_RESULT_ACCEPTED
    station.wait_until(lambda: not station.endpoint.vehicle.autopilot.armed, within_s=30.0)
    station.run(0.1)
    station.request(mavlink.MAVLINK_MSG_ID_SYS_STATUS)
    assert station.last("SYS_STATUS").onboard_control_sensors_health & PREARM


def test_each_flavour_has_its_own_estimator_message() -> None:
    for flavour, own, other, result in (
        (Flavour.ARDUPILOT, 193, 230, mavlink.MAV_RESULT_DENIED),
        (Flavour.PX4, 230, 193, mavlink.MAV_RESULT_FAILED),
    ):
        station = Station(endpoint_of(flavour))
        station.wait_for_position()
        assert station.request(own) == mavlink.MAV_RESULT_ACCEPTED
        flags = station.heard[-2].flags
        assert flags & 16
        assert station.command(mavlink.MAV_CMD_SET_MESSAGE_INTERVAL, other, 1e6) == result


@pytest.mark.parametrize("flavour", Flavour)
def test_attitude_as_angles_and_as_quaternion_agree(flavour: Flavour) -> None:
    station = Station(endpoint_of(flavour))
    station.take_off()
    station.request(mavlink.MAVLINK_MSG_ID_ATTITUDE)
    station.request(mavlink.MAVLINK_MSG_ID_ATTITUDE_QUATERNION)
    euler, quaternion = station.last("ATTITUDE"), station.last("ATTITUDE_QUATERNION")
    w, x, y, z = quaternion.q1, quaternion.q2, quaternion.q3, quaternion.q4
    assert math.hypot(w, x, y, z) == pytest.approx(1.0, abs=1e-6)
    yaw = math.atan2(2 * (w * z + x * y), 1 - 2 * (y * y + z * z))
    assert math.remainder(yaw - euler.yaw, math.tau) == pytest.approx(0.0, abs=1e-6)
    assert math.asin(2 * (w * y - z * x)) == pytest.approx(euler.pitch, abs=1e-6)


@pytest.mark.parametrize("flavour", Flavour)
def test_every_message_can_be_sent_at_every_stage_of_a_flight(flavour: Flavour) -> None:
    station = Station(endpoint_of(flavour))
    ids = [message_id for message_id in mavlink.mavlink_map if station.endpoint.has_telemetry(message_id)]

    def ask_for_all() -> set[str]:
        station.forget()
        results = {message_id: station.request(message_id) for message_id in ids}
        refused = station.endpoint.table.no_message
        assert set(results.values()) <= {mavlink.MAV_RESULT_ACCEPTED, refused}
        return {mavlink.mavlink_map[number].msgname for number, result in results.items() if result == refused}

    ask_for_all()
    station.wait_for_position()
    # No target is flown yet, no fence watched, no picture taken.
    pictures = {"CAMERA_FEEDBACK", "CAMERA_TRIGGER", "CAMERA_IMAGE_CAPTURED"}
    assert ask_for_all() <= {"POSITION_TARGET_GLOBAL_INT", "FENCE_STATUS"} | IN_FLIGHT | pictures
    station.take_off()
    ask_for_all()


@pytest.mark.parametrize("flavour", Flavour)
def test_landed_state_from_ground_to_air_and_back(flavour: Flavour) -> None:
    station = Station(endpoint_of(flavour))
    station.command(mavlink.MAV_CMD_SET_MESSAGE_INTERVAL, mavlink.MAVLINK_MSG_ID_EXTENDED_SYS_STATE, 100_000)
    station.take_off()
    assert station.command(mavlink.MAV_CMD_NAV_LAND) == mavlink.MAV_RESULT_ACCEPTED
    station.wait_until(lambda: not station.endpoint.vehicle.autopilot.armed, within_s=60.0)
    station.run(2.0)
    states = [message.landed_state for message in station.of("EXTENDED_SYS_STATE")]
    changes = [now for before, now in zip([0, *states], states, strict=False) if before != now]
    assert changes[0] == 1
    assert changes[-1] == 1
    assert {2, 3, 4} & set(changes) >= {2, 4} or {3, 4} <= set(changes)
