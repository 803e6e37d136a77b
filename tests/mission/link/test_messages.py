"""MAVLink frames as they are on the wire, byte by byte, and what is made of frames that come."""

import math
import random
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st
from pymavlink.dialects.v20 import ardupilotmega as mavlink

from mission.link.messages import Codec, Stream, arm, change_mode, set_message_interval, take_off
from mission.link.values import (
    Acknowledgement,
    Battery,
    Estimates,
    EstimatorReport,
    GlobalPosition,
    Health,
    Heartbeat,
    LandedState,
    Landing,
    LocalPosition,
    LocalSetpoint,
    Received,
    Result,
    Sensors,
    Version,
    Wind,
    Words,
)

# Written by pymavlink 2.4.50 and read back field by field against the message definitions.
GOLDEN_HEARTBEAT = "fd09000000ffbf000000000000000608000403"


def codec() -> Codec:
    return Codec(255, 191)


def from_vehicle(message: Any, system: int = 1, component: int = 1) -> bytes:  # noqa: ANN401 - pymavlink ships no types
    return bytes(message.pack(mavlink.MAVLink(None, srcSystem=system, srcComponent=component)))


def only(data: bytes) -> Any:  # noqa: ANN401 - the test says which it is
    (received,) = codec().decode(data)
    return received.body


def test_our_heartbeat_is_a_ground_stations() -> None:
    frame = codec().heartbeat()
    assert frame[:-2].hex() == GOLDEN_HEARTBEAT


def test_a_setpoint_byte_by_byte() -> None:
    setpoint = LocalSetpoint(1000, (1.0, 2.0, -3.0), (0.5, 0.0, 0.0), (0.0, -0.25, 0.0), 1.5, -0.5)
    frame = codec().setpoint(1, setpoint)
    assert frame[:10].hex() == "fd35000000ffbf540000"
    expected = [
        "e8030000",  # time_boot_ms 1000
        "0000803f00000040000040c0",  # x 1, y 2, z -3
        "0000003f0000000000000000",  # vx 0.5
        "00000000000080be00000000",  # afy -0.25
        "0000c03f000000bf",  # yaw 1.5, yaw rate -0.5
        "0000",  # type mask: nothing is ignored
        "010101",  # system 1, component 1, MAV_FRAME_LOCAL_NED
    ]
    assert frame[10:-2].hex() == "".join(expected)


def test_sequence_numbers_count_up_and_wrap() -> None:
    sender = codec()
    assert [sender.heartbeat()[4] for _ in range(300)] == [i % 256 for i in range(300)]


def test_a_command_goes_to_the_autopilot_with_its_attempt() -> None:
    (message,) = mavlink.MAVLink(None).parse_buffer(codec().command(7, take_off(12.5, math.nan), 3))
    assert (message.target_system, message.target_component) == (7, 1)
    assert (message.command, message.confirmation) == (22, 3)
    assert message.param7 == 12.5
    assert all(map(math.isnan, (message.param4, message.param5, message.param6)))
    assert (message.get_srcSystem(), message.get_srcComponent()) == (255, 191)


def test_parameters_of_commands() -> None:
    assert arm().parameters == (1.0,)
    assert change_mode("OFFBOARD", 6).parameters == (1.0, 6.0, 0.0)
    assert set_message_interval(Stream.ATTITUDE, 20.0).parameters == (30.0, 50_000.0)


@pytest.mark.parametrize(
    ("message", "body"),
    [
        (mavlink.MAVLink_heartbeat_message(2, 12, 157, 0x60000, 4, 3), Heartbeat(2, 12, 157, 0x60000, 4)),
        (
            mavlink.MAVLink_local_position_ned_message(12345, 1.5, -2.5, -10.0, 0.5, 0.25, 0.0),
            LocalPosition(12345, (1.5, -2.5, -10.0), (0.5, 0.25, 0.0)),
        ),
        (
            mavlink.MAVLink_command_ack_message(400, 1, 0, 0, 255, 191),
            Acknowledgement(400, Result.TEMPORARILY_REJECTED, 255, 191),
        ),
        (mavlink.MAVLink_command_ack_message(400, 77, 0, 0, 0, 0), Acknowledgement(400, Result.UNKNOWN, 0, 0)),
        (mavlink.MAVLink_statustext_message(2, b"Arm: no", 0, 0), Words(2, "Arm: no", 0, 0)),
        (mavlink.MAVLink_extended_sys_state_message(0, 4), Landing(LandedState.LANDING)),
        (
            mavlink.MAVLink_ekf_status_report_message(0x3F, 0, 0, 0, 0, 0),
            EstimatorReport(Estimates(0x3F)),
        ),
        (
            mavlink.MAVLink_estimator_status_message(0, 0x3F, 0, 0, 0, 0, 0, 0, 0, 0),
            EstimatorReport(Estimates(0x3F)),
        ),
        (
            mavlink.MAVLink_estimator_status_message(0, 1, 0.25, 0.75, math.nan, 0.5, 9, 9, 0, 0),
            EstimatorReport(Estimates(1), 0.75),
        ),
        (mavlink.MAVLink_wind_message(-90.0, 4.0, 1.0), Wind(4.0, 270.0)),
        (mavlink.MAVLink_wind_cov_message(0, 0.0, 4.0, 0.0, 0, 0, 0, 0, 0), Wind(4.0, 270.0)),
        (
            mavlink.MAVLink_sys_status_message(0x7, 0x3, 0x1, 0, 0, 0, 55, 0, 0, 0, 0, 0, 0),
            Health(Sensors(0x3), Sensors(0x1), 55),
        ),
        (
            mavlink.MAVLink_battery_status_message(0, 0, 0, 0, [0] * 10, 0, 0, 0, 5, 0, 3),
            Battery(critical=True, consumed_mah=0.0, percent=5.0),
        ),
        (
            mavlink.MAVLink_battery_status_message(0, 0, 0, 0, [0] * 10, 0, -1, 0, -1, 0, 1),
            Battery(critical=False),
        ),
        (
            mavlink.MAVLink_autopilot_version_message(0, 0x04070000, 0, 0, 0, *[[0] * 8] * 3, 0, 0, 0),
            Version((4, 7, 0)),
        ),
    ],
)
def test_what_comes_is_read_into_values(message: Any, body: object) -> None:  # noqa: ANN401 - pymavlink ships no types
    assert codec().decode(from_vehicle(message, 3, 1)) == [Received(3, 1, body)]  # type: ignore[arg-type]


def test_units_of_a_global_position() -> None:
    body = only(
        from_vehicle(mavlink.MAVLink_global_position_int_message(9, 473977420, 85455940, 488123, 1500, *[0] * 4))
    )
    assert isinstance(body, GlobalPosition)
    assert body.latitude_deg == pytest.approx(47.3977420)
    assert body.longitude_deg == pytest.approx(8.5455940)
    assert (body.altitude_amsl_m, body.height_above_home_m) == pytest.approx((488.123, 1.5))


def test_mavlink_1_is_understood() -> None:
    sender = mavlink.MAVLink(None, srcSystem=1, srcComponent=1)
    frame = mavlink.MAVLink_heartbeat_message(2, 3, 81, 4, 3, 3).pack(sender, force_mavlink1=True)
    assert isinstance(only(bytes(frame)), Heartbeat)


def test_the_armed_bit_and_the_state_are_the_truth() -> None:
    assert Heartbeat(2, 3, 209, 4, 4).armed
    assert not Heartbeat(2, 3, 81, 4, 4).armed
    assert Heartbeat(2, 3, 209, 4, 5).in_failsafe
    assert not Heartbeat(2, 3, 209, 4, 4).in_failsafe


def test_what_nobody_needs_is_passed_over_and_does_not_stand_in_the_way() -> None:
    sender = mavlink.MAVLink(None, srcSystem=1, srcComponent=1)
    others = [
        mavlink.MAVLink_attitude_quaternion_message(1, 1, 0, 0, 0, 0, 0, 0),
        mavlink.MAVLink_vfr_hud_message(1, 1, 90, 50, 10, 0),
        mavlink.MAVLink_system_time_message(0, 2),
    ]
    wanted = mavlink.MAVLink_heartbeat_message(2, 3, 81, 4, 3, 3)
    frames = b"".join(
        bytes(message.pack(sender, force_mavlink1=old))
        for old in (False, True)
        for message in (*others, wanted, *others)
    )
    assert [type(received.body) for received in codec().decode(frames)] == [Heartbeat, Heartbeat]


@given(st.binary(max_size=400))
def test_noise_is_no_message_and_no_exception(noise: bytes) -> None:
    assert codec().decode(noise) == []


def test_changed_bytes_never_become_another_message() -> None:
    frame = from_vehicle(mavlink.MAVLink_local_position_ned_message(12345, 1.5, -2.5, -10.0, 0.5, 0.25, 0.0))
    numbers = random.Random(1)  # noqa: S311 - noise, not a secret
    for _ in range(500):
        changed = bytearray(frame)
        changed[numbers.randrange(len(changed))] ^= 1 << numbers.randrange(8)
        for received in codec().decode(bytes(changed)):
            # Header bits that no checksum could miss apart from the compatibility flags, which are free to differ.
            assert received.body == LocalPosition(12345, (1.5, -2.5, -10.0), (0.5, 0.25, 0.0))
