"""Flight by hand: the sticks of a joystick, and channels that override a receiver."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st
from pymavlink.dialects.v20 import ardupilotmega as mavlink

from tests.support.station import Station, endpoint_of
from vehicle_sim.autopilot import Mode
from vehicle_sim.autopilot.hand import CENTRED, Pilot, Sticks
from vehicle_sim.parameters import Flavour, default_parameters
from vehicle_sim.parameters.hand import hand_settings

BOTH = pytest.mark.parametrize("flavour", Flavour)
MIDDLE = 500
SPEED = {Flavour.ARDUPILOT: ("LOIT_SPEED", 400.0), Flavour.PX4: ("MPC_VEL_MANUAL", 4.0)}


def hold_sticks(
    station: Station, seconds: float, *, x: int = 0, y: int = 0, z: int = MIDDLE, r: int = 0, target: int = 1
) -> None:
    """Send the sticks at 10 Hz, as ground stations do."""
    for _ in range(round(seconds * 10)):
        station.send(mavlink.MAVLink_manual_control_message(target, x, y, z, r, 0))
        station.run(0.1)


def speed_m_s(station: Station) -> float:
    return math.hypot(*station.endpoint.vehicle.truth.velocity_ned_m_s[:2])


def by_hand(flavour: Flavour, mode: Mode) -> Station:
    """Return a station whose vehicle hovers in a mode by hand."""
    station = Station(endpoint_of(flavour))
    station.take_off(8.0)
    station.run(3.0)
    name, value = SPEED[flavour]
    station.endpoint.vehicle.parameters.set(name, value)
    assert station.set_mode(mode) == mavlink.MAV_RESULT_ACCEPTED
    return station


@BOTH
def test_a_stick_flies_and_a_stick_let_go_stops_and_keeps_the_place(flavour: Flavour) -> None:
    station = by_hand(flavour, Mode.POSITION)
    hold_sticks(station, 5.0, x=1000)
    north, east, _ = station.endpoint.vehicle.truth.velocity_ned_m_s
    assert (north, east) == pytest.approx((4.0, 0.0), abs=0.4)
    hold_sticks(station, 4.0)
    assert speed_m_s(station) < 0.3
    place = station.endpoint.vehicle.truth.position_ned_m
    hold_sticks(station, 5.0)
    assert station.endpoint.vehicle.truth.position_ned_m == pytest.approx(place, abs=1.0)
    hold_sticks(station, 5.0, y=-1000)
    north, east, _ = station.endpoint.vehicle.truth.velocity_ned_m_s
    assert (north, east) == pytest.approx((0.0, -4.0), abs=0.4)


@BOTH
def test_right_is_the_vehicles_right(flavour: Flavour) -> None:
    station = by_hand(flavour, Mode.POSITION)
    before = station.endpoint.vehicle.estimate.yaw_rad
    hold_sticks(station, 1.0, r=600)
    hold_sticks(station, 2.0)
    yaw = station.endpoint.vehicle.estimate.yaw_rad
    assert 0.3 < math.remainder(yaw - before, math.tau) < 3.1
    hold_sticks(station, 5.0, y=1000)
    north, east, _ = station.endpoint.vehicle.truth.velocity_ned_m_s
    assert math.atan2(east, north) == pytest.approx(math.remainder(yaw + math.pi / 2, math.tau), abs=0.15)


@BOTH
def test_the_throttle_climbs_descends_and_keeps_the_height_in_the_middle(flavour: Flavour) -> None:
    station = by_hand(flavour, Mode.ALT_HOLD)
    hand = station.endpoint.vehicle.autopilot.settings.hand
    hold_sticks(station, 4.0, z=1000)
    assert -station.endpoint.vehicle.truth.velocity_ned_m_s[2] == pytest.approx(hand.climb_m_s, abs=0.3)
    hold_sticks(station, 3.0)
    height = station.height_m()
    hold_sticks(station, 4.0)
    assert station.height_m() == pytest.approx(height, abs=0.7)
    hold_sticks(station, 3.0, z=0)
    assert station.endpoint.vehicle.truth.velocity_ned_m_s[2] == pytest.approx(hand.descent_m_s, abs=0.3)


@BOTH
def test_without_a_place_to_keep_a_stick_leans_and_a_stick_let_go_levels_and_drifts_on(flavour: Flavour) -> None:
    station = by_hand(flavour, Mode.ALT_HOLD)
    hand = station.endpoint.vehicle.autopilot.settings.hand
    hold_sticks(station, 1.5, x=500)
    zone = hand.dead_zone
    assert -station.endpoint.vehicle.truth.pitch_rad == pytest.approx(
        hand.tilt_rad * (0.5 - zone) / (1.0 - zone), abs=0.03
    )
    hold_sticks(station, 1.0)
    assert station.endpoint.vehicle.truth.pitch_rad == pytest.approx(0.0, abs=0.03)
    assert speed_m_s(station) > 2.0


@BOTH
def test_sticks_that_fall_silent_count_as_let_go(flavour: Flavour) -> None:
    station = by_hand(flavour, Mode.POSITION)
    without_failsafe = {"FS_THR_ENABLE": 0} if flavour is Flavour.ARDUPILOT else {"NAV_RCL_ACT": 1}
    for name, value in without_failsafe.items():
        station.endpoint.vehicle.parameters.set(name, value)
    hold_sticks(station, 5.0, x=1000)
    assert speed_m_s(station) > 3.0
    timeout_s = station.endpoint.vehicle.autopilot.settings.hand.timeout_s
    assert timeout_s == (3.0 if flavour is Flavour.ARDUPILOT else 0.5)
    station.run(timeout_s - 0.2)
    assert speed_m_s(station) > 3.0
    station.run(4.0)
    assert speed_m_s(station) < 0.3
    pilot = station.endpoint.vehicle.autopilot.pilot
    assert pilot.silent_s(station.endpoint.vehicle.time_s) == pytest.approx(timeout_s + 3.9, abs=0.02)


@BOTH
def test_a_whole_flight_by_hand_from_the_ground_and_back(flavour: Flavour) -> None:
    station = Station(endpoint_of(flavour))
    station.wait_for_position()
    assert station.set_mode(Mode.POSITION) == mavlink.MAV_RESULT_ACCEPTED
    hold_sticks(station, 0.2, z=0)
    assert station.command(mavlink.MAV_CMD_COMPONENT_ARM_DISARM, 1) == mavlink.MAV_RESULT_ACCEPTED
    hold_sticks(station, 3.0)
    assert station.height_m() == pytest.approx(0.0, abs=0.01)
    hold_sticks(station, 4.0, z=900)
    hold_sticks(station, 2.0)
    assert station.height_m() > 3.0
    hold_sticks(station, 20.0, z=0)
    assert station.height_m() == pytest.approx(0.0, abs=0.05)
    station.wait_until(lambda: not station.endpoint.vehicle.autopilot.armed, within_s=30.0)


@BOTH
def test_modes_that_fly_by_themselves_do_not_listen_to_sticks(flavour: Flavour) -> None:
    station = by_hand(flavour, Mode.GUIDED if flavour is Flavour.ARDUPILOT else Mode.HOLD)
    before = station.endpoint.vehicle.truth.position_ned_m
    hold_sticks(station, 3.0, x=1000, z=1000)
    assert station.endpoint.vehicle.truth.position_ned_m == pytest.approx(before, abs=1.5)


def test_ardupilot_listens_to_its_own_ground_station_and_its_own_number_only() -> None:
    endpoint = endpoint_of(Flavour.ARDUPILOT)
    pilot = endpoint.vehicle.autopilot.pilot
    other = Station(endpoint, "other", system_id=254)
    other.send(mavlink.MAVLink_manual_control_message(1, 1000, 0, 500, 0, 0))
    other.send(mavlink.MAVLink_rc_channels_override_message(1, 1, *(2000,) * 8))
    station = Station(endpoint)
    station.send(mavlink.MAVLink_manual_control_message(0, 1000, 0, 500, 0, 0))
    station.send(mavlink.MAVLink_manual_control_message(2, 1000, 0, 500, 0, 0))
    assert pilot.heard_s is None
    station.send(mavlink.MAVLink_manual_control_message(1, 1000, -500, 500, 250, 0))
    assert pilot.sticks == Sticks(1.0, -0.5, 0.25, 0.0)
    station.send(mavlink.MAVLink_manual_control_message(1, 32767, 32767, 32767, 0, 0))
    assert pilot.sticks == Sticks(1.0, -0.5, 0.0, 0.0)


@pytest.mark.parametrize(("mode", "counts"), [(0, False), (1, True), (2, True), (3, True), (4, False)])
def test_px4_asks_its_parameter_whether_sticks_count(mode: int, *, counts: bool) -> None:
    endpoint = endpoint_of(Flavour.PX4)
    endpoint.vehicle.parameters.set("COM_RC_IN_MODE", mode)
    station = Station(endpoint, system_id=77)
    station.run(0.1)
    station.send(mavlink.MAVLink_manual_control_message(0, 1000, 0, 500, 0, 0))
    autopilot = endpoint.vehicle.autopilot
    assert (autopilot.pilot.asked(endpoint.vehicle.time_s) != CENTRED) is counts


def test_channels_of_ardupilot_are_mapped_shown_and_given_back() -> None:
    endpoint = endpoint_of(Flavour.ARDUPILOT)
    station = Station(endpoint)
    pilot = endpoint.vehicle.autopilot.pilot
    station.send(mavlink.MAVLink_rc_channels_override_message(1, 1, 1600, 1250, 1500, 1750, 0, 0, 0, 0))
    assert pilot.sticks == Sticks(0.5, 0.2, 0.5, 0.0)  # pitch is low for forward
    station.request(mavlink.MAVLINK_MSG_ID_RC_CHANNELS)
    shown = station.last("RC_CHANNELS")
    assert (shown.chan1_raw, shown.chan2_raw, shown.chan3_raw, shown.chan4_raw) == (1600, 1250, 1500, 1750)
    assert (shown.chancount, shown.chan5_raw) == (4, 65535)
    station.send(mavlink.MAVLink_rc_channels_override_message(1, 1, 65535, 1500, 65535, 0, 0, 0, 0, 0))
    assert pilot.sticks == Sticks(0.0, 0.2, 0.0, 0.0)
    endpoint.vehicle.parameters.set("RCMAP_ROLL", 5)
    station.send(mavlink.MAVLink_rc_channels_override_message(1, 1, 65535, 65535, 65535, 65535, 1000, 0, 0, 0))
    assert pilot.sticks == Sticks(0.0, -1.0, 0.0, 0.0)
    station.send(mavlink.MAVLink_rc_channels_override_message(1, 1, *(0,) * 8))
    assert (pilot.heard_s, pilot.sticks) == (None, CENTRED)
    station.request(mavlink.MAVLINK_MSG_ID_RC_CHANNELS)
    assert station.last("RC_CHANNELS").chancount == 0


ways = st.floats(-3.0, 3.0)


@given(st.sampled_from(Flavour), st.tuples(ways, ways, ways, ways), st.floats(0.0, 10.0))
def test_what_sticks_ask_for_is_bounded_and_odd(
    flavour: Flavour, stand: tuple[float, float, float, float], silent_s: float
) -> None:
    pilot = Pilot(hand_settings(default_parameters(flavour)))
    assert pilot.asked(0.0) == CENTRED
    pilot.move(Sticks(*stand), 5.0)
    asked = pilot.asked(5.0 + silent_s)
    if silent_s > pilot.hand.timeout_s + 1e-9:
        assert asked == CENTRED
        return
    for wanted, way in zip(asked, stand, strict=True):
        assert abs(wanted) <= min(1.0, abs(way))
        assert wanted * way >= 0.0
    pilot.move(Sticks(*(-way for way in stand)), 5.0)
    assert pilot.asked(5.0 + silent_s) == tuple(-value for value in asked)


def test_new_settings_count_from_the_next_moment_on() -> None:
    station = by_hand(Flavour.PX4, Mode.POSITION)
    hold_sticks(station, 4.0, x=1000)
    station.endpoint.vehicle.parameters.set("MPC_VEL_MANUAL", 8.0)
    hold_sticks(station, 4.0, x=1000)
    assert speed_m_s(station) == pytest.approx(8.0, abs=0.6)
