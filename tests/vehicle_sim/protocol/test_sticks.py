"""Flight by hand: the sticks of a joystick, and channels that override a receiver."""

import math
from dataclasses import replace

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
    hold_sticks(station, 0.1)  # PX4 wants to hear them first
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
    # By joystick alone, without a radio that goes on.
    without_failsafe = {"FS_THR_ENABLE": 0, "SIM_RC_FAIL": 1} if flavour is Flavour.ARDUPILOT else {"NAV_RCL_ACT": 1}
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


def standing(station: Station) -> Sticks:
    vehicle = station.endpoint.vehicle
    return vehicle.autopilot.pilot.standing(vehicle.time_s)


def channels(station: Station) -> tuple[int, list[int]]:
    """Return how many channels RC_CHANNELS tells of, and the pulses of all 18."""
    station.request(mavlink.MAVLINK_MSG_ID_RC_CHANNELS)
    shown = station.last("RC_CHANNELS")
    return shown.chancount, [getattr(shown, f"chan{number}_raw") for number in range(1, 19)]


def override(station: Station, **pulses: int) -> None:
    """Override channels, `c5=1100`; those that are not named stay as they are."""
    values = [pulses.get(f"c{number}", 65535) for number in range(1, 19)]
    station.send(mavlink.MAVLink_rc_channels_override_message(1, 1, *values))


def test_ardupilot_listens_to_its_own_ground_station_and_its_own_number_only() -> None:
    endpoint = endpoint_of(Flavour.ARDUPILOT)
    endpoint.vehicle.parameters.set("SIM_RC_FAIL", 1)
    other, station = Station(endpoint, "other", system_id=254), Station(endpoint)
    station.run(0.1)
    assert endpoint.vehicle.autopilot.pilot.heard_s is None
    other.send(mavlink.MAVLink_manual_control_message(1, 1000, 0, 500, 0, 0))
    override(other, c1=2000, c2=2000, c3=2000, c4=2000)
    station.send(mavlink.MAVLink_manual_control_message(0, 1000, 0, 500, 0, 0))
    station.send(mavlink.MAVLink_manual_control_message(2, 1000, 0, 500, 0, 0))
    assert endpoint.vehicle.autopilot.pilot.heard_s is None
    station.send(mavlink.MAVLink_manual_control_message(1, 1000, -500, 500, 250, 0))
    assert standing(station) == Sticks(1.0, -0.5, 0.25, 0.0)
    station.send(mavlink.MAVLink_manual_control_message(1, 32767, 32767, 32767, 0, 0))
    assert standing(station) == Sticks(1.0, -0.5, 0.0, 0.0)


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
    station.run(0.1)
    at_rest = [1500, 1500, 1000, 1500, 1800, 1000, 1000, 1800, *[1500] * 8, 0, 0]
    assert channels(station) == (16, at_rest)
    override(station, c1=1600, c2=1250, c3=1500, c4=1750)
    assert standing(station) == Sticks(0.5, 0.2, 0.5, 0.0)  # pitch is low for forward
    assert channels(station) == (16, [1600, 1250, 1500, 1750, *at_rest[4:]])
    override(station, c2=1500, c4=0)
    assert standing(station) == Sticks(0.0, 0.2, 0.0, 0.0)
    endpoint.vehicle.parameters.set("RCMAP_ROLL", 10)
    endpoint.vehicle.parameters.set("RC10_MIN", 1100)
    endpoint.vehicle.parameters.set("RC10_REVERSED", 1)
    override(station, c10=1200)
    assert standing(station).right == 0.75
    override(station, c10=0)  # so old clients fill the end of the message
    assert standing(station).right == 0.75
    override(station, c10=65534)
    assert standing(station).right == 0.0
    override(station, c1=0, c2=0, c3=0)
    assert channels(station) == (16, at_rest)
    override(station, c1=1900)
    station.run(3.1)
    assert channels(station) == (16, at_rest)


@pytest.mark.parametrize(("mode", "by_radio"), [(0, True), (1, False), (2, True), (3, False), (4, False)])
def test_px4_reads_the_channels_that_are_mapped_and_chooses_among_radio_and_joystick(
    mode: int, *, by_radio: bool
) -> None:
    station = Station(endpoint_of(Flavour.PX4))
    for name, value in {"COM_RC_IN_MODE": mode, "RC_MAP_PITCH": 2, "RC2_REV": -1}.items():
        station.endpoint.vehicle.parameters.set(name, value)
    station.run(0.1)
    assert channels(station) == (0, [65535] * 18)
    station.send(mavlink.MAVLink_manual_control_message(1, 250, 0, 500, 0, 0))
    override(station, c2=1250)
    assert channels(station) == (2, [65535, 1250, *[65535] * 16])
    assert standing(station).forward == (0.5 if by_radio else 0.0 if mode == 4 else 0.25)


@BOTH
def test_the_mode_switch_changes_the_mode_once_it_has_settled(flavour: Flavour) -> None:
    station = Station(endpoint_of(flavour))
    autopilot, parameters = station.endpoint.vehicle.autopilot, station.endpoint.vehicle.parameters
    for name, value in {"COM_RC_IN_MODE": 0, "RC_MAP_FLTMODE": 5, "COM_FLTMODE2": 1, "COM_FLTMODE6": 2}.items():
        parameters.set(name, value) if name in parameters else None
    station.wait_for_position()
    override(station, c5=1100)
    station.run(0.5)  # as PX4 this is how it stands at first
    first = autopilot.mode
    for pulse, seconds, mode in (
        (1900, 0.1, first),
        (1300, 0.1, first),
        (1300, 0.3, Mode.LAND if flavour is Flavour.ARDUPILOT else Mode.ALT_HOLD),
        (1900, 0.4, Mode.STABILIZE if flavour is Flavour.ARDUPILOT else Mode.POSITION),
    ):
        override(station, c5=pulse)
        station.run(seconds)
        assert autopilot.mode is mode


def test_ardupilot_waits_for_a_radio_and_for_a_throttle_that_is_down() -> None:
    station = Station(endpoint_of(Flavour.ARDUPILOT))
    parameters = station.endpoint.vehicle.parameters
    parameters.set("SIM_RC_FAIL", 1)
    parameters.set("ARMING_CHECK", 1 << 3)
    station.wait_for_position()

    def refusal() -> str | None:
        station.forget()
        result = station.command(mavlink.MAV_CMD_COMPONENT_ARM_DISARM, 1)
        station.run(0.05)
        if result == mavlink.MAV_RESULT_ACCEPTED:
            assert station.command(mavlink.MAV_CMD_COMPONENT_ARM_DISARM, 0) == mavlink.MAV_RESULT_ACCEPTED
            return None
        return next(text for text in station.texts() if text.startswith("Arm: "))

    assert refusal() is None
    parameters.set("ARMING_CHECK", 1)
    assert refusal() == "Arm: RC not found"
    parameters.set("SIM_RC_FAIL", 2)
    station.run(0.1)
    assert refusal() == "Arm: Throttle below failsafe"
    parameters.set("SIM_RC_FAIL", 0)
    station.run(0.1)
    assert refusal() is None
    assert station.set_mode(Mode.STABILIZE) == mavlink.MAV_RESULT_ACCEPTED
    assert refusal() is None
    override(station, c3=1100)
    assert refusal() == "Arm: Throttle too high"
    assert station.set_mode(Mode.POSITION) == mavlink.MAV_RESULT_ACCEPTED
    assert refusal() is None
    override(station, c3=1700)
    assert refusal() == "Arm: Throttle too high"
    assert station.set_mode(Mode.GUIDED) == mavlink.MAV_RESULT_ACCEPTED
    assert refusal() is None


@pytest.mark.parametrize(("is_v1", "count"), [(True, 4), (False, 0)])
def test_ardupilot_streams_eight_raw_channels_to_who_speaks_mavlink_1(*, is_v1: bool, count: int) -> None:
    station = Station(endpoint_of(Flavour.ARDUPILOT))
    asked = mavlink.MAVLink_request_data_stream_message(1, 1, mavlink.MAV_DATA_STREAM_RC_CHANNELS, 4, 1)
    station.endpoint.receive(station.name, asked.pack(station.mav, force_mavlink1=is_v1))
    station.run(1.0)
    told = station.of("RC_CHANNELS_RAW")
    assert len(told) == count
    assert len(station.of("RC_CHANNELS")) == len(station.of("SERVO_OUTPUT_RAW")) == 4
    for raw in told:
        assert (raw.port, raw.chan1_raw, raw.chan3_raw) == (0, 1500, 1000)


@pytest.mark.parametrize("failed", [1, 2])
@pytest.mark.parametrize(("options", "mode"), [(0, Mode.RETURN), (4, Mode.GUIDED)])
def test_a_radio_that_fails_in_flight_leads_home_unless_guided_flight_goes_on(
    failed: int, options: int, mode: Mode
) -> None:
    station = Station(endpoint_of(Flavour.ARDUPILOT))
    vehicle = station.endpoint.vehicle
    vehicle.parameters.set("FS_OPTIONS", options)
    station.take_off(5.0)
    for name, is_well in (("SIM_RC_FAIL", True), ("SIM_RC_FAIL", False)):
        vehicle.parameters.set(name, 0 if is_well else failed)
        station.run(1.5)
        station.request(mavlink.MAVLINK_MSG_ID_SYS_STATUS)
        status = station.last("SYS_STATUS")
        bit = mavlink.MAV_SYS_STATUS_SENSOR_RC_RECEIVER
        assert (
            bool(status.onboard_control_sensors_present & bit),
            bool(status.onboard_control_sensors_health & bit),
        ) == (
            True,
            is_well,
        )
    assert vehicle.autopilot.mode is mode


ways = st.floats(-3.0, 3.0)


@given(st.sampled_from(Flavour), st.tuples(ways, ways, ways, ways), st.floats(0.0, 10.0))
def test_what_sticks_ask_for_is_bounded_and_odd(
    flavour: Flavour, stand: tuple[float, float, float, float], silent_s: float
) -> None:
    pilot = Pilot(replace(hand_settings(default_parameters(flavour)), joystick=True))
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
