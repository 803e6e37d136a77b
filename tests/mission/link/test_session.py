"""The session against vehicles that behave as ArduPilot and PX4 were observed to, and against worse ones."""

import math
from collections import Counter
from dataclasses import replace
from itertools import pairwise

import pytest
from pymavlink.dialects.v20 import ardupilotmega as mavlink

from mission.errors import LinkError, VehicleError
from mission.link.course import Course
from mission.link.ending import Ending
from mission.link.events import Answered, Asked, Moved, Said, SetpointSent, WentOn
from mission.link.identity import LinkOptions
from mission.link.session import Session
from mission.monitor.stage import Stage
from mission.plan.heading import Nose
from mission.plan.turning import TURN_RAD_S
from mission.spec.heading import Heading, Look
from tests.support.scripted_vehicle import (
    ARM,
    BRAKE,
    FAILED,
    GUIDED,
    LAND,
    ORIGIN,
    PX4_HOLD,
    PX4_RTL,
    REJECTED,
    REQUEST,
    RTL,
    SET_MODE,
    STABILIZE,
    TAKEOFF,
    DistantVehicle,
    Script,
    ScriptedVehicle,
)
from tests.support.sessions import ALTITUDE_M, END_M, START_M, Driven, Straight, anchor_at_start, course

FLAVOURS = pytest.mark.parametrize("flavour", ["ardupilot", "px4"])


def named(commands: list[int]) -> list[int]:
    """Commands in order, without streams and requests, equal neighbours once."""
    kept = [c for c in commands if c not in (511, 512)]
    return [c for i, c in enumerate(kept) if i == 0 or kept[i - 1] != c]


@FLAVOURS
def test_a_flight_ends_on_the_ground_where_the_trajectory_ended(flavour: str) -> None:
    vehicle = ScriptedVehicle(flavour)
    driven = Driven(vehicle)
    driven.fly()
    assert driven.session.ending is Ending.LANDED
    assert not vehicle.armed
    # Local frame: the vehicle stood at (3, -2) north, east; the way goes 8 m east and 6 m south.
    assert vehicle.position[:2] == pytest.approx([3.0 - 6.0, -2.0 + 8.0], abs=0.1)
    highest = max(event.position_m[2] for event in driven.events if isinstance(event, Moved))
    assert highest == pytest.approx(ALTITUDE_M, abs=0.2)


def test_ardupilot_is_guided_first_then_armed_then_taken_off() -> None:
    vehicle = ScriptedVehicle("ardupilot")
    Driven(vehicle).fly()
    assert named([c.command for c in vehicle.commands]) == [SET_MODE, ARM, TAKEOFF, LAND]
    takeoff = next(c for c in vehicle.commands if c.command == TAKEOFF)
    assert takeoff.param7 == pytest.approx(ALTITUDE_M, abs=0.2)  # above home


def test_px4_streams_before_offboard_and_takes_off_above_the_sea() -> None:
    vehicle = ScriptedVehicle("px4")
    driven = Driven(vehicle)
    driven.until(Stage.STREAM)
    while len(vehicle.setpoints) < 30:  # for about a second before the mode is asked for
        driven.turn()
        assert vehicle.mode == PX4_HOLD
        assert SET_MODE not in [c.command for c in vehicle.commands]
    driven.fly()
    assert named([c.command for c in vehicle.commands]) == [ARM, TAKEOFF, SET_MODE, LAND]
    takeoff = next(c for c in vehicle.commands if c.command == TAKEOFF)
    assert takeoff.param7 == pytest.approx(100.0 + ALTITUDE_M, abs=0.2)
    assert math.isnan(takeoff.param5)


@FLAVOURS
def test_setpoints_are_whole_groups_with_yaw_in_the_local_frame(flavour: str) -> None:
    vehicle = ScriptedVehicle(flavour)
    Driven(vehicle).fly()
    for setpoint in vehicle.setpoints:
        assert setpoint.coordinate_frame == 1
        assert setpoint.type_mask == 0  # nothing is ignored
        values = (setpoint.x, setpoint.y, setpoint.z, setpoint.vx, setpoint.vy, setpoint.vz, setpoint.afx, setpoint.yaw)
        assert all(map(math.isfinite, values))
        assert setpoint.z == pytest.approx(-0.5 - ALTITUDE_M, abs=0.01)


@FLAVOURS
def test_setpoints_come_at_20_hz_or_more_and_turn_slowly_into_the_flight(flavour: str) -> None:
    vehicle = ScriptedVehicle(flavour)
    driven = Driven(vehicle)
    driven.fly()
    times = vehicle.setpoint_times
    assert (len(times) - 1) / (times[-1] - times[0]) >= 20.0
    assert max(b - a for a, b in pairwise(times)) <= 0.1
    sent = [event for event in driven.events if isinstance(event, SetpointSent)]
    turns = [abs(b.yaw_rad - a.yaw_rad) / (b.t_s - a.t_s) for a, b in pairwise(sent)]
    assert max(turns) <= 1.02 * TURN_RAD_S
    assert sent[-1].yaw_rad == pytest.approx(math.atan2(END_M[0] - START_M[0], END_M[1] - START_M[1]), abs=0.01)


@FLAVOURS
def test_it_waits_for_the_position_and_says_so(flavour: str) -> None:
    vehicle = ScriptedVehicle(flavour, Script(origin_at_s=25.0))
    driven = Driven(vehicle)
    reasons = set()
    while vehicle.now_s() < 24.0:
        driven.turn()
        reasons.add(driven.session.waiting_for)
    assert any("position" in reason for reason in reasons)
    assert ARM not in [c.command for c in vehicle.commands]
    driven.fly()
    assert driven.session.ending is Ending.LANDED


@pytest.mark.parametrize("script", [Script(), Script(origin_at_s=20.0), Script(deaf_to=Counter({REQUEST: 7}))])
def test_an_origin_that_is_sent_on_request_only_is_asked_for_until_it_comes(script: Script) -> None:
    script = replace(script, on_request_only=frozenset((ORIGIN,)))
    driven = Driven(ScriptedVehicle("px4", script), Session(needs_origin=True))
    driven.until(Stage.MODE, within_s=max(script.origin_at_s, 10.0) + 5.0)
    driven.fly()
    assert driven.session.ending is Ending.LANDED


def test_a_vehicle_that_never_gets_a_position_is_given_up_with_the_reason() -> None:
    vehicle = ScriptedVehicle("ardupilot", Script(origin_at_s=1e9))
    driven = Driven(vehicle, Session(needs_origin=False, options=LinkOptions(ready_s=20.0)))
    with pytest.raises(VehicleError, match="no position"):
        driven.fly()


@FLAVOURS
def test_lost_acknowledgements_are_made_good_by_repetition(flavour: str) -> None:
    script = Script(silent_about=Counter({ARM: 2, TAKEOFF: 2, SET_MODE: 1, LAND: 1, 511: 3}))
    driven = Driven(ScriptedVehicle(flavour, script))
    driven.fly()
    assert driven.session.ending is Ending.LANDED


@FLAVOURS
def test_lost_commands_are_repeated_and_counted(flavour: str) -> None:
    vehicle = ScriptedVehicle(flavour, Script(deaf_to=Counter({ARM: 3, TAKEOFF: 1, LAND: 2})))
    driven = Driven(vehicle)
    driven.fly()
    assert driven.session.ending is Ending.LANDED
    assert [c.confirmation for c in vehicle.commands if c.command == ARM] == [0, 1, 2, 3]


def test_a_command_that_is_never_answered_is_a_link_failure() -> None:
    driven = Driven(ScriptedVehicle("ardupilot", Script(deaf_to=Counter({ARM: 99}))))
    with pytest.raises(LinkError, match="never answered the command to arm"):
        driven.fly()


@pytest.mark.parametrize("command", [SET_MODE, ARM])
@FLAVOURS
def test_accepted_but_not_done_is_asked_again(flavour: str, command: int) -> None:
    vehicle = ScriptedVehicle(flavour, Script(ignores=Counter({command: 2})))
    driven = Driven(vehicle)
    driven.fly()
    assert driven.session.ending is Ending.LANDED
    assert len([c for c in vehicle.commands if c.command == command]) >= 3


@pytest.mark.parametrize(
    ("command", "words"),
    [(SET_MODE, "did not change to GUIDED"), (ARM, "did not arm"), (TAKEOFF, "did not leave the ground")],
)
def test_accepted_and_never_done_is_a_failure(command: int, words: str) -> None:
    vehicle = ScriptedVehicle("ardupilot", Script(ignores=Counter({command: 99})))
    with pytest.raises(VehicleError, match=words):
        Driven(vehicle).fly()
    assert not vehicle.armed  # it was not left standing with running motors


def test_px4_that_accepts_offboard_and_does_not_enter_it_is_left_holding_in_the_air() -> None:
    vehicle = ScriptedVehicle("px4", Script(ignores=Counter({SET_MODE: 99})))
    with pytest.raises(VehicleError, match="did not change to OFFBOARD"):
        Driven(vehicle).fly()
    assert vehicle.armed
    assert vehicle.mode == PX4_HOLD
    assert vehicle.height_m == pytest.approx(ALTITUDE_M, abs=0.2)


def test_a_passing_refusal_is_waited_out() -> None:
    script = Script(refuses={ARM: (4, FAILED, "Arm: Need Position Estimate"), TAKEOFF: (2, FAILED, "")})
    driven = Driven(ScriptedVehicle("ardupilot", script))
    driven.fly()
    assert driven.session.ending is Ending.LANDED
    answers = [event.result for event in driven.events if isinstance(event, Answered) and event.command == "arm"]
    assert answers == ["failed"] * 4 + ["accepted"]


@pytest.mark.parametrize(("flavour", "result"), [("ardupilot", FAILED), ("px4", REJECTED)])
def test_a_lasting_refusal_is_reported_in_the_vehicles_own_words(flavour: str, result: int) -> None:
    words = "Arm: Compass not calibrated, and this is a text that takes more than one message"
    driven = Driven(ScriptedVehicle(flavour, Script(refuses={ARM: (999, result, words)})))
    with pytest.raises(VehicleError) as caught:
        driven.fly()
    assert "refused to arm" in str(caught.value)
    assert words in str(caught.value)
    assert any(isinstance(event, Said) and event.text == words for event in driven.events)


def test_a_plain_refusal_is_final() -> None:
    vehicle = ScriptedVehicle("ardupilot", Script(refuses={SET_MODE: (999, 2, "Mode change failed: no pilot")}))
    with pytest.raises(VehicleError, match=r"refused to change to GUIDED \(denied\).*no pilot"):
        Driven(vehicle).fly()
    assert len([c for c in vehicle.commands if c.command == SET_MODE]) == 1


@FLAVOURS
@pytest.mark.parametrize("seed", [1, 2])
def test_a_link_that_loses_doubles_and_reorders(flavour: str, seed: int) -> None:
    vehicle = ScriptedVehicle(flavour, Script(lose=0.1, double=0.2, shuffle=True), seed)
    driven = Driven(vehicle)
    driven.fly()
    assert driven.session.ending is Ending.LANDED
    times = [event.t_s for event in driven.events if isinstance(event, Moved)]
    assert times == sorted(set(times))


@FLAVOURS
def test_others_on_the_link_are_not_taken_for_the_vehicle(flavour: str) -> None:
    vehicle = ScriptedVehicle(flavour, Script(second_station=True, other_vehicle=True))
    driven = Driven(vehicle)
    driven.fly()
    assert driven.session.ending is Ending.LANDED
    assert all(math.dist(e.position_m, (*START_M, 0.0)) < 50 for e in driven.events if isinstance(e, Moved))


@pytest.mark.parametrize(
    ("script", "words"),
    [
        (Script(autopilot=13), "SMACCMPILOT"),
        (Script(vehicle_type=1), "FIXED_WING, not a multicopter"),
        (Script(armed_at_start=True), "armed already"),
    ],
)
def test_what_cannot_be_flown_from_here_is_refused(script: Script, words: str) -> None:
    vehicle = ScriptedVehicle("ardupilot", script)
    with pytest.raises(VehicleError, match=words):
        Driven(vehicle).fly()
    assert {c.command for c in vehicle.commands} <= {511, 512}


@pytest.mark.parametrize("number", sorted(set(range(22)) - {3, 8, 12}))
def test_every_autopilot_that_is_not_known_is_refused_by_name_and_left_alone(number: int) -> None:
    vehicle = ScriptedVehicle("px4", Script(autopilot=number))
    with pytest.raises(VehicleError, match=r"the vehicle's autopilot is \S+; .*known of ArduPilot and PX4 only"):
        Driven(vehicle).fly()
    assert not vehicle.commands
    assert not vehicle.setpoints


def test_ground_stations_alone_are_no_vehicle() -> None:
    vehicle = ScriptedVehicle("ardupilot", Script(autopilot=8, vehicle_type=6))
    driven = Driven(vehicle, Session(needs_origin=False, options=LinkOptions(connect_s=5.0)))
    with pytest.raises(LinkError, match="no vehicle was heard within 5 s"):
        driven.fly()
    assert vehicle.heartbeats >= 5


@FLAVOURS
@pytest.mark.parametrize("failsafe", [False, True])
def test_whoever_else_flies_is_never_fought(flavour: str, failsafe: bool) -> None:  # noqa: FBT001 - a test's parameter
    vehicle = ScriptedVehicle(flavour)
    driven = Driven(vehicle)
    driven.until(Stage.FLY)
    vehicle.mode = PX4_RTL if vehicle.px4 else RTL
    vehicle.failsafe = failsafe
    vehicle.say("Battery 1 is low")
    driven.fly()
    assert driven.session.ending is (Ending.FAILSAFE if failsafe else Ending.HANDED_OVER)
    assert "RTL" in driven.session.ending_reason
    assert "Battery 1 is low" in driven.session.ending_reason
    asked, setpoints = len(vehicle.commands), len(vehicle.setpoints)
    for _ in range(100):
        driven.turn()
    assert (len(vehicle.commands), len(vehicle.setpoints)) == (asked, setpoints)


@pytest.mark.parametrize(
    ("flavour", "text", "severity"),
    [
        ("ardupilot", "Max Alt fence breached", 5),
        ("ardupilot", "EKF Failsafe: changed to RTL Mode", 2),
        ("px4", "Geofence: approaching or outside geofence", 2),
    ],
)
@pytest.mark.parametrize("before_s", [0.0, 9.0])
def test_what_tells_of_a_failsafe_is_the_reason_though_the_status_stays_active(
    flavour: str, text: str, severity: int, before_s: float
) -> None:
    vehicle = ScriptedVehicle(flavour)
    driven = Driven(vehicle)
    driven.until(Stage.FLY)
    if before_s:
        vehicle.say("GPS Glitch", 2)
    vehicle.say(text, severity)
    until_s = vehicle.now_s() + before_s - 1.5
    while vehicle.now_s() < until_s:
        driven.turn()
    vehicle.mode = PX4_RTL if vehicle.px4 else RTL
    driven.fly()
    assert driven.session.ending is Ending.FAILSAFE
    assert f"a failsafe put the vehicle into {'AUTO.RTL' if vehicle.px4 else 'RTL'}; it says: " in (
        driven.session.ending_reason
    )
    assert text in driven.session.ending_reason
    assert ("GPS Glitch" in driven.session.ending_reason) is bool(before_s)


@pytest.mark.parametrize(("text", "before_s"), [("GCS Failsafe", 11.0), ("Fence breach cleared", 0.0)])
def test_what_is_over_is_no_reason(text: str, before_s: float) -> None:
    vehicle = ScriptedVehicle("ardupilot")
    driven = Driven(vehicle)
    driven.until(Stage.CLIMB)
    vehicle.say(text)
    until_s = vehicle.now_s() + before_s
    while vehicle.now_s() < until_s:
        driven.turn()
    vehicle.mode = STABILIZE
    driven.fly()
    assert driven.session.ending is Ending.HANDED_OVER
    assert "someone else put the vehicle into STABILIZE" in driven.session.ending_reason


@FLAVOURS
def test_two_seconds_on_the_way_are_no_silence(flavour: str) -> None:
    driven = Driven(DistantVehicle(flavour, 2.0))
    driven.fly(within_s=400.0)
    assert driven.session.ending is Ending.LANDED


def test_one_late_heartbeat_is_not_someone_else() -> None:
    vehicle = ScriptedVehicle("ardupilot")
    driven = Driven(vehicle)
    driven.until(Stage.FLY)
    vehicle.mode = STABILIZE
    while driven.session.vehicle.mode == GUIDED:
        driven.turn()
    vehicle.mode = GUIDED
    driven.fly()
    assert driven.session.ending is Ending.LANDED


def test_a_nose_that_never_turns_is_told_of_and_the_flight_goes_on() -> None:
    """The scripted vehicle keeps its heading, which the course asks it to leave."""
    southward = Nose(Heading(Look.FIXED, fixed_rad=math.pi))
    driven = Driven(ScriptedVehicle("ardupilot"), flown=lambda: Course(Straight(), 0.5, nose=southward))
    driven.fly()
    told = next(event for event in driven.events if isinstance(event, WentOn))
    assert told.words.startswith("the vehicle did not come to rest at the start of the trajectory, with its nose")
    assert told.words.endswith("within 20 s")
    assert driven.stages[-3:] == [Stage.TOUCH_DOWN, Stage.DISARM, Stage.DONE]


def test_a_vehicle_that_disarms_in_flight_is_a_failure_with_its_words() -> None:
    vehicle = ScriptedVehicle("ardupilot")
    driven = Driven(vehicle)
    driven.until(Stage.FLY)
    vehicle.say("Crash: Disarming: AngErr=45>30", 0)
    vehicle.armed = False
    with pytest.raises(VehicleError, match=r"disarmed itself while flying.*Crash"):
        driven.fly()


def test_a_vehicle_that_falls_silent_is_a_link_failure() -> None:
    vehicle = ScriptedVehicle("px4")
    driven = Driven(vehicle)
    driven.until(Stage.FLY)
    vehicle.gone = True
    with pytest.raises(LinkError, match="nothing was heard from the vehicle for 5"):
        driven.fly()
    last_s = driven.session.vehicle.clock.newest_s or 0.0
    assert all(event.t_s < last_s + 0.3 for event in driven.events if isinstance(event, SetpointSent))


def test_a_restart_is_a_failure() -> None:
    vehicle = ScriptedVehicle("ardupilot")
    driven = Driven(vehicle)
    driven.until(Stage.FLY)
    vehicle.booted_s = vehicle.now_s()
    with pytest.raises(VehicleError, match="restarted"):
        driven.fly()


@pytest.mark.parametrize("on_request_only", [frozenset[int](), frozenset((ORIGIN,))])
def test_an_origin_that_moves_in_flight_ends_it_holding(on_request_only: frozenset[int]) -> None:
    vehicle = ScriptedVehicle("ardupilot", Script(on_request_only=on_request_only))
    driven = Driven(vehicle, Session(needs_origin=True))
    driven.until(Stage.FLY)
    vehicle.origin[0] += 0.001
    if on_request_only:
        vehicle.slip_in(mavlink.MAVLink_gps_global_origin_message(round(vehicle.origin[0] * 1e7), 80_000_000, 0))
    with pytest.raises(VehicleError, match="moved the origin"):
        driven.fly()
    assert vehicle.mode == BRAKE


@FLAVOURS
def test_stopped_in_the_air_it_holds_and_lands_if_asked_to(flavour: str) -> None:
    vehicle = ScriptedVehicle(flavour)
    driven = Driven(vehicle, Session(needs_origin=False, land_when_stopped=True))
    driven.until(Stage.FLY)
    for _ in range(200):
        driven.turn()
    driven.session.stop("interrupted", vehicle.now_s())
    setpoints = len(vehicle.setpoints)
    driven.fly()
    assert driven.session.ending is Ending.STOPPED
    assert driven.session.ending_reason == "interrupted"
    assert not vehicle.armed
    assert len(vehicle.setpoints) == setpoints
    asked = [event.command for event in driven.events if isinstance(event, Asked)][-2:]
    assert asked == ["change to BRAKE" if flavour == "ardupilot" else "change to AUTO.LOITER", "land"]


@FLAVOURS
def test_stopped_in_the_air_it_is_left_holding_otherwise(flavour: str) -> None:
    vehicle = ScriptedVehicle(flavour)
    driven = Driven(vehicle)
    driven.until(Stage.FLY)
    driven.session.stop("interrupted", vehicle.now_s())
    driven.fly()
    assert vehicle.armed
    assert vehicle.mode == (BRAKE if flavour == "ardupilot" else PX4_HOLD)
    assert "left holding in" in driven.session.ending_reason


def test_stopped_on_the_ground_it_disarms() -> None:
    vehicle = ScriptedVehicle("ardupilot", Script(ignores=Counter({TAKEOFF: 99})))
    driven = Driven(vehicle)
    driven.until(Stage.TAKE_OFF)
    driven.session.stop("interrupted", vehicle.now_s())
    driven.fly()
    assert not vehicle.armed
    assert driven.session.ending is Ending.STOPPED


@FLAVOURS
def test_stopped_before_it_is_seen_armed_it_does_not_stay_armed(flavour: str) -> None:
    vehicle = ScriptedVehicle(flavour)
    driven = Driven(vehicle)
    driven.until(Stage.ARM)
    driven.session.stop("interrupted", vehicle.now_s())
    driven.fly()
    assert vehicle.commands[-1].command == ARM
    assert vehicle.commands[-1].param1 == 0
    assert not vehicle.armed
    assert driven.session.ending is Ending.STOPPED


def test_stopped_before_anything_it_is_over() -> None:
    session = Session(needs_origin=False)
    session.stop("interrupted", 0.0)
    assert session.ending is Ending.STOPPED
    session.advance(1.0)
    assert session.outgoing() == []


def test_stopping_while_it_lands_lets_it_land() -> None:
    vehicle = ScriptedVehicle("px4")
    driven = Driven(vehicle)
    driven.until(Stage.TOUCH_DOWN)
    driven.session.stop("interrupted", vehicle.now_s())
    driven.fly()
    assert driven.session.ending is Ending.LANDED


def test_departing_before_standby_is_a_mistake() -> None:
    with pytest.raises(RuntimeError, match="cannot depart"):
        Session(needs_origin=False).depart(course(), anchor_at_start)


def test_our_heartbeat_comes_once_a_second_of_vehicle_time() -> None:
    vehicle = ScriptedVehicle("ardupilot")
    driven = Driven(vehicle)
    driven.fly()
    assert vehicle.heartbeats == pytest.approx(vehicle.now_s(), rel=0.1)
