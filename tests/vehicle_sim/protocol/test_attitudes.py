"""SET_ATTITUDE_TARGET in lock-step: leans, climb rates, thrust and body rates, masks, and what ends them."""

from math import cos, hypot, nan, pi, sin
from struct import pack

import pytest
from pymavlink.dialects.v20 import ardupilotmega as mavlink

from tests.support.station import Station, endpoint_of
from vehicle_sim.autopilot import Mode
from vehicle_sim.autopilot.modes import HOLDING
from vehicle_sim.parameters import Flavour
from vehicle_sim.signals import GRAVITY_M_S2, Vector

AP, PX4 = Flavour.ARDUPILOT, Flavour.PX4
BOTH = pytest.mark.parametrize("flavour", Flavour)
NO_RATES, NO_YAW_RATE, NO_THRUST, NO_ATTITUDE = 0b111, 0b100, 64, 128
BODY_THRUST = 32
ACCEPTED = mavlink.MAV_RESULT_ACCEPTED
Quaternion = tuple[float, float, float, float]
HOVER = 0.5


def quaternion(roll: float = 0.0, pitch: float = 0.0, yaw: float = 0.0) -> Quaternion:
    """The product of the turns about down, right and forward, in this order."""
    cr, sr, cp, sp, cy, sy = *half(roll), *half(pitch), *half(yaw)
    return (
        cr * cp * cy + sr * sp * sy,
        sr * cp * cy - cr * sp * sy,
        cr * sp * cy + sr * cp * sy,
        cr * cp * sy - sr * sp * cy,
    )


def half(angle: float) -> tuple[float, float]:
    return cos(0.5 * angle), sin(0.5 * angle)


def ask(
    station: Station,
    q: Quaternion,
    thrust: float,
    *,
    mask: int = NO_RATES,
    rates: Vector = (0.0, 0.0, 0.0),
    body: Vector = (0.0, 0.0, 0.0),
) -> None:
    message = mavlink.MAVLink_set_attitude_target_message(0, 1, 1, mask, q, *rates, thrust)
    if any(body):
        # The field `thrust_body` is younger than the dialect.
        pack_payload = message._pack
        message._pack = lambda mav, extra, payload, **options: pack_payload(
            mav, extra, payload[:39].ljust(39, b"\0") + pack("<3f", *body), **options
        )
    station.send(message)


def stream(
    station: Station,
    seconds: float,
    q: Quaternion,
    thrust: float,
    *,
    mask: int = NO_RATES,
    rates: Vector = (0.0, 0.0, 0.0),
    body: Vector = (0.0, 0.0, 0.0),
) -> None:
    """Ask again and again, at 20 Hz."""
    for _ in range(round(seconds * 20.0)):
        ask(station, q, thrust, mask=mask, rates=rates, body=body)
        station.run(0.05)


def guided(flavour: Flavour) -> Station:
    """Return a station whose vehicle hovers by attitudes."""
    station = Station(endpoint_of(flavour))
    station.take_off(20.0)
    station.run(4.0)
    stream(station, 0.5, quaternion(), HOVER)
    if flavour is PX4:
        assert station.set_mode(Mode.GUIDED) == ACCEPTED
        stream(station, 0.5, quaternion(), HOVER)
    assert mode(station) is Mode.GUIDED
    return station


def mode(station: Station) -> Mode:
    return station.endpoint.vehicle.autopilot.mode


def climb_m_s(station: Station) -> float:
    return -station.endpoint.vehicle.truth.velocity_ned_m_s[2]


@BOTH
@pytest.mark.parametrize(("roll", "pitch", "yaw"), [(0.0, -0.1, 0.0), (0.12, 0.0, 0.0), (0.05, -0.08, 2.0)])
def test_an_attitude_is_taken_up_and_leads_where_thrust_leans(
    flavour: Flavour, roll: float, pitch: float, yaw: float
) -> None:
    station = guided(flavour)
    height = station.height_m()
    stream(station, 3.0, quaternion(0.0, 0.0, yaw), HOVER)
    before = station.endpoint.vehicle.truth.velocity_ned_m_s
    stream(station, 2.0, quaternion(roll, pitch, yaw), HOVER)
    truth = station.endpoint.vehicle.truth
    assert (truth.roll_rad, truth.pitch_rad) == pytest.approx((roll, pitch), abs=0.02)
    assert cos(truth.yaw_rad - yaw) > 0.99
    gained = [truth.velocity_ned_m_s[i] - before[i] for i in range(2)]
    leans = (-pitch * cos(yaw) - roll * sin(yaw), roll * cos(yaw) - pitch * sin(yaw))
    # Half a second to lean, and some drag.
    assert gained == pytest.approx([1.7 * GRAVITY_M_S2 * lean for lean in leans], abs=0.45)
    if flavour is AP:
        assert station.height_m() == pytest.approx(height, abs=0.5)


@pytest.mark.parametrize(("thrust", "climb"), [(0.75, 1.25), (1.0, 2.5), (0.0, -1.5), (7.0, 2.5)])
def test_thrust_of_ardupilot_is_a_climb_rate(thrust: float, climb: float) -> None:
    station = guided(AP)
    stream(station, 3.0, quaternion(), thrust)
    assert climb_m_s(station) == pytest.approx(climb, abs=0.15)


@pytest.mark.parametrize("flavour", [AP, PX4])
def test_thrust_is_thrust_on_px4_and_by_option_on_ardupilot(flavour: Flavour) -> None:
    station = guided(flavour)
    if flavour is AP:
        station.endpoint.vehicle.parameters.set("GUID_OPTIONS", 8)
    stream(station, 0.5, quaternion(), HOVER)
    before = climb_m_s(station)
    stream(station, 1.0, quaternion(), 0.55)
    # Twice the weight is the greatest thrust.
    assert climb_m_s(station) - before == pytest.approx(0.1 * GRAVITY_M_S2, abs=0.25)


def test_px4_takes_thrust_along_the_body_and_none_where_it_is_left_out() -> None:
    station = guided(PX4)
    stream(station, 1.0, quaternion(), 0.0, mask=NO_RATES | BODY_THRUST, body=(0.0, 0.0, -0.55))
    assert 0.6 < climb_m_s(station) < 1.3
    stream(station, 0.5, quaternion(), HOVER, mask=NO_RATES | NO_THRUST)
    assert climb_m_s(station) < -2.0


def test_ardupilot_is_level_and_keeps_its_height_when_attitudes_end() -> None:
    station = guided(AP)
    stream(station, 2.0, quaternion(pitch=-0.1), 0.7)
    assert mode(station) is Mode.GUIDED
    station.run(2.5)
    assert station.endpoint.vehicle.truth.pitch_rad == pytest.approx(-0.1, abs=0.02)
    assert climb_m_s(station) == pytest.approx(1.0, abs=0.15)
    station.run(2.5)
    assert station.endpoint.vehicle.truth.pitch_rad == pytest.approx(0.0, abs=0.02)
    assert abs(climb_m_s(station)) < 0.1
    # Nothing brakes but drag.
    assert hypot(*station.endpoint.vehicle.truth.velocity_ned_m_s[:2]) > 1.0
    assert mode(station) is Mode.GUIDED


def test_attitudes_count_as_the_stream_of_px4() -> None:
    station = Station(endpoint_of(PX4))
    station.take_off(15.0)
    station.run(3.0)
    # Without roll and pitch rates, and without an attitude, there is nothing to fly.
    stream(station, 1.0, quaternion(), HOVER, mask=NO_RATES | NO_ATTITUDE)
    station.set_mode(Mode.GUIDED)
    assert mode(station) is Mode.HOLD
    stream(station, 1.0, quaternion(), HOVER)
    station.set_mode(Mode.GUIDED)
    stream(station, 1.0, quaternion(), HOVER)
    assert mode(station) is Mode.GUIDED
    station.run(1.2)
    assert mode(station) is Mode.POSITION
    assert "Failsafe activated: No offboard signal" in station.texts()


@pytest.mark.parametrize(
    ("mask", "q", "thrust"),
    [
        (NO_RATES | NO_THRUST, quaternion(), HOVER),
        (NO_YAW_RATE, quaternion(), HOVER),
        (0b011, quaternion(), HOVER),
        (NO_RATES, (0.9, 0.0, 0.0, 0.0), HOVER),
        (NO_RATES, (0.0, 0.0, 0.0, 0.0), HOVER),
        (NO_RATES, (nan, 0.0, 0.0, 0.0), HOVER),
        (NO_RATES, quaternion(), nan),
    ],
)
def test_ardupilot_stops_for_what_it_cannot_fly(mask: int, q: Quaternion, thrust: float) -> None:
    station = guided(AP)
    stream(station, 2.0, quaternion(pitch=-0.15), HOVER)
    assert hypot(*station.endpoint.vehicle.truth.velocity_ned_m_s[:2]) > 1.5
    ask(station, q, thrust, mask=mask)
    station.run(5.0)
    target = station.endpoint.vehicle.autopilot.target
    assert target is not None
    assert None not in target.position_ned_m
    assert hypot(*station.endpoint.vehicle.truth.velocity_ned_m_s[:2]) < 0.2


@pytest.mark.parametrize("q", [(nan, 0.0, 0.0, 0.0), (0.0, 0.0, 0.0, 0.0)])
def test_px4_goes_on_with_the_last_attitude_where_one_is_none(q: Quaternion) -> None:
    station = guided(PX4)
    stream(station, 0.5, quaternion(pitch=-0.1), HOVER)
    before = station.endpoint.vehicle.autopilot.target
    ask(station, q, HOVER)
    ask(station, quaternion(), nan)
    assert station.endpoint.vehicle.autopilot.target == before
    # One of any other length is an attitude all the same.
    ask(station, (3.0, 0.0, 0.0, 0.0), HOVER)
    target = station.endpoint.vehicle.autopilot.target
    assert target is not None
    assert target.lean_ne_rad == pytest.approx((0.0, 0.0))


@BOTH
def test_body_rates_alone_turn_and_lean(flavour: Flavour) -> None:
    station = guided(flavour)
    stream(station, 2.0, quaternion(), HOVER, mask=NO_ATTITUDE, rates=(0.0, 0.0, 0.5))
    assert station.endpoint.vehicle.truth.yaw_rad == pytest.approx(1.0, abs=0.15)
    stream(station, 1.0, quaternion(), HOVER, mask=NO_ATTITUDE, rates=(0.1, 0.0, 0.0))
    stream(station, 1.0, quaternion(), HOVER, mask=NO_ATTITUDE)
    assert station.endpoint.vehicle.truth.roll_rad == pytest.approx(0.1, abs=0.03)


def test_rates_turn_an_attitude_of_ardupilot_on_between_messages() -> None:
    station = guided(AP)
    ask(station, quaternion(), HOVER, mask=0, rates=(0.0, 0.0, 0.4))
    station.run(2.0)
    assert station.endpoint.vehicle.truth.yaw_rad == pytest.approx(0.8, abs=0.12)


@BOTH
def test_no_attitude_leans_more_than_the_largest_tilt(flavour: Flavour) -> None:
    station = guided(flavour)
    ask(station, quaternion(roll=1.4), HOVER)
    target = station.endpoint.vehicle.autopilot.target
    assert target is not None
    assert target.lean_ne_rad is not None
    assert hypot(*target.lean_ne_rad) == pytest.approx((30.0 if flavour is AP else 45.0) * pi / 180.0)


@BOTH
def test_a_setpoint_ends_the_attitude(flavour: Flavour) -> None:
    station = guided(flavour)
    stream(station, 1.0, quaternion(pitch=-0.1), HOVER)
    if flavour is AP:
        station.request(mavlink.MAVLINK_MSG_ID_POSITION_TARGET_LOCAL_NED)
        assert not station.of("POSITION_TARGET_LOCAL_NED")
    north, east, down = station.endpoint.vehicle.estimate.position_ned_m
    for _ in range(120):
        station.setpoint((north + 5.0, east, down), mask=0xDF8)
        station.run(0.05)
    assert station.endpoint.vehicle.estimate.position_ned_m == pytest.approx((north + 5.0, east, down), abs=0.4)


@BOTH
def test_it_is_not_flown_in_other_modes_or_by_others(flavour: Flavour) -> None:
    station = guided(flavour)
    station.set_mode(HOLDING[flavour])
    before = station.endpoint.vehicle.autopilot.target
    ask(station, quaternion(pitch=-0.3), 1.0)
    station.send(mavlink.MAVLink_set_attitude_target_message(0, 9, 1, NO_RATES, quaternion(roll=0.3), 0, 0, 0, 0.5))
    assert station.endpoint.vehicle.autopilot.target == before


@BOTH
def test_a_climb_leaves_the_ground(flavour: Flavour) -> None:
    station = Station(endpoint_of(flavour))
    station.wait_for_position()
    stream(station, 1.0, quaternion(), HOVER)
    if flavour is PX4:
        station.set_mode(Mode.GUIDED)
        stream(station, 0.2, quaternion(), HOVER)
    assert station.command(mavlink.MAV_CMD_COMPONENT_ARM_DISARM, 1) == ACCEPTED
    stream(station, 3.0, quaternion(), HOVER)
    assert station.height_m() == pytest.approx(0.0, abs=0.01)
    stream(station, 3.0, quaternion(), 0.6)
    assert station.height_m() > 0.5
