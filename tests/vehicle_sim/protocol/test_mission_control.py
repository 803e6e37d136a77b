"""What a pilot does to a mission: start, refusals, pause, resume, choose, replace, clear."""

from math import hypot, nan
from struct import unpack

import pytest
from pymavlink.dialects.v20 import ardupilotmega as mavlink

from tests.support.missions import DELAY, SPEED, UNLIMITED, WAIT, Pilot, Step, land, takeoff, waypoint
from vehicle_sim.autopilot import Mode, Progress
from vehicle_sim.parameters import Flavour
from vehicle_sim.protocol.opaque_ids import plan_id
from vehicle_sim.protocol.plan_store import PlanKind

AP, PX4 = Flavour.ARDUPILOT, Flavour.PX4
BOTH = pytest.mark.parametrize("flavour", Flavour)
ACCEPTED, DENIED, FAILED = mavlink.MAV_RESULT_ACCEPTED, mavlink.MAV_RESULT_DENIED, mavlink.MAV_RESULT_FAILED
REJECTED = mavlink.MAV_RESULT_TEMPORARILY_REJECTED
ARM, START = mavlink.MAV_CMD_COMPONENT_ARM_DISARM, mavlink.MAV_CMD_MISSION_START
PAUSE = mavlink.MAV_CMD_DO_PAUSE_CONTINUE
LONG = [takeoff(5.0), waypoint(60.0, 0.0, 5.0), waypoint(60.0, 30.0, 5.0), land(60.0, 30.0)]


def cruising(flavour: Flavour, steps: list[Step] | None = None) -> Pilot:
    """Return a vehicle on its way to the first waypoint."""
    pilot = Pilot(flavour)
    pilot.fly(LONG if steps is None else steps)
    pilot.until_reached(0)
    pilot.station.run(3.0)
    return pilot


@BOTH
def test_without_a_mission_the_mode_is_refused(flavour: Flavour) -> None:
    pilot = Pilot(flavour)
    station = pilot.station
    # Disarmed, ArduPilot changes to any mode.
    assert station.command(START) == (ACCEPTED if flavour is AP else DENIED)
    station.set_mode(Mode.GUIDED if flavour is AP else Mode.HOLD)
    station.take_off(5.0)
    assert station.set_mode(Mode.AUTO) == (FAILED if flavour is AP else REJECTED)
    assert pilot.autopilot.mode is not Mode.AUTO
    assert pilot.said()[-1] == (
        "Mode change to AUTO failed: init failed"
        if flavour is AP
        else "Switching to Mission is currently not available\t"
    )


def test_ardupilot_wants_a_take_off_first_on_the_ground() -> None:
    pilot = Pilot(AP)
    station = pilot.station
    pilot.upload([waypoint(10.0, 0.0), takeoff()])
    assert station.command(ARM, 1) == ACCEPTED
    assert station.command(START) == FAILED
    assert pilot.said()[-2:] == ["Auto: Missing Takeoff Cmd", "Mode change to AUTO failed: init failed"]
    pilot.upload([Step(DELAY, (1.0, 0.0, 0.0, 0.0)), takeoff()])
    assert station.command(START) == ACCEPTED
    pilot.until_reached(1)


@BOTH
def test_arming_in_the_mission_mode(flavour: Flavour) -> None:
    pilot = Pilot(flavour)
    station = pilot.station
    assert station.set_mode(Mode.AUTO) == ACCEPTED
    assert station.command(ARM, 1) == (FAILED if flavour is AP else REJECTED)
    pilot.upload(LONG)
    if flavour is AP:
        assert station.command(ARM, 1) == FAILED
        assert pilot.said()[-1] == "Arm: AUTO mode not armable"
        pilot.station.endpoint.vehicle.parameters.set("AUTO_OPTIONS", 1)
        station.run(0.1)
    assert station.command(ARM, 1) == ACCEPTED
    station.run(6.0)
    # ArduPilot waits for the throttle, for a command, or for the option that does without.
    assert pilot.autopilot.flying is (flavour is PX4)
    if flavour is AP:
        assert station.command(START) == ACCEPTED
        station.run(1.0)
        assert pilot.autopilot.flying


def test_parts_of_a_mission_cannot_be_started_on_ardupilot_and_px4_knows_a_first_item() -> None:
    pilot = Pilot(AP)
    pilot.upload(LONG)
    assert pilot.station.command(START, 1, 0) == DENIED
    assert pilot.station.command(START, 0, 2) == DENIED
    pilot = Pilot(PX4)
    pilot.upload(LONG)
    assert [pilot.station.command(START, first) for first in (-2, 4, nan)] == [DENIED] * 3
    assert pilot.station.command(START, 2) == ACCEPTED
    assert pilot.autopilot.armed
    pilot.until_reached(2)
    assert pilot.reached() == [2]


@BOTH
def test_pause_and_continue(flavour: Flavour) -> None:
    pilot = cruising(flavour)
    assert pilot.station.command(PAUSE, 0) == ACCEPTED
    assert pilot.autopilot.mode is (Mode.AUTO if flavour is AP else Mode.HOLD)
    pilot.station.run(6.0)
    assert pilot.speed() < 0.3
    north, east, _ = pilot.place()
    assert 5.0 < north < 55.0
    assert abs(east) < 1.0
    assert pilot.station.command(PAUSE, 1) == ACCEPTED
    pilot.until_reached(1)
    assert pilot.reached() == [0, 1]


def test_ardupilot_pauses_legs_only() -> None:
    pilot = Pilot(AP)
    pilot.fly([takeoff(5.0), Step(UNLIMITED, at=(0.0, 0.0), up=5.0)])
    pilot.station.run(3.0)
    assert pilot.station.command(PAUSE, 0) == FAILED
    assert pilot.station.command(PAUSE, 1) == FAILED


@BOTH
def test_after_another_mode_it_goes_on_where_it_was(flavour: Flavour) -> None:
    pilot = cruising(flavour)
    pilot.until_reached(1)
    pilot.station.set_mode(Mode.POSITION if flavour is AP else Mode.HOLD)
    pilot.station.run(3.0)
    assert pilot.autopilot.mission.progress is Progress.PAUSED
    assert pilot.station.set_mode(Mode.AUTO) == ACCEPTED
    pilot.until_reached(2)
    assert pilot.reached() == [0, 1, 2]


def test_ardupilot_starts_anew_where_the_parameter_says_so() -> None:
    pilot = cruising(AP)
    pilot.until_reached(1)
    pilot.station.set_mode(Mode.POSITION)
    pilot.station.endpoint.vehicle.parameters.set("MIS_RESTART", 1)
    pilot.station.run(0.1)
    pilot.station.set_mode(Mode.AUTO)
    pilot.station.run(5.0)
    assert pilot.reached()[:3] == [0, 1, 0]


def test_px4_sets_the_speed_of_the_mission_again_when_it_resumes() -> None:
    pilot = cruising(PX4, [takeoff(5.0), Step(SPEED, (1.0, 3.0, -1.0, 0.0)), waypoint(80.0, 0.0, 5.0)])
    pilot.station.set_mode(Mode.HOLD)
    pilot.station.run(2.0)
    pilot.station.set_mode(Mode.AUTO)
    pilot.station.run(4.0)
    assert pilot.speed() == pytest.approx(3.0, abs=0.3)


@BOTH
def test_the_pilot_changes_the_speed(flavour: Flavour) -> None:
    pilot = cruising(flavour, [takeoff(5.0), waypoint(90.0, 0.0, 5.0)])
    assert pilot.station.command(mavlink.MAV_CMD_DO_CHANGE_SPEED, 1, 2.0, -1) == ACCEPTED
    pilot.station.run(5.0)
    assert pilot.speed() == pytest.approx(2.0, abs=0.3)


@BOTH
def test_an_item_is_chosen_by_message_and_by_command(flavour: Flavour) -> None:
    pilot = cruising(flavour)
    seq = pilot.first + 2
    pilot.station.send(mavlink.MAVLink_mission_set_current_message(1, 1, seq))
    assert pilot.station.last("MISSION_CURRENT").seq == seq
    pilot.until_reached(2)
    assert pilot.reached() == [0, 2]
    pilot.station.send(mavlink.MAVLink_mission_set_current_message(1, 1, 99))
    assert pilot.station.last("MISSION_CURRENT").seq != 99
    assert pilot.station.command(mavlink.MAV_CMD_DO_SET_MISSION_CURRENT, 99) == (FAILED if flavour is AP else DENIED)


@BOTH
def test_a_mission_replaced_in_flight_goes_on_at_the_same_number(flavour: Flavour) -> None:
    pilot = cruising(flavour)
    pilot.upload([takeoff(5.0), waypoint(0.0, 40.0, 5.0), waypoint(10.0, 40.0, 5.0)])
    pilot.station.run(0.1)
    assert ("Auto mission changed, restarted command" in pilot.said()) is (flavour is AP)
    pilot.until_reached(1)
    assert hypot(pilot.place()[0], pilot.place()[1] - 40.0) < 2.5
    assert pilot.reached() == [0, 1]


def test_px4_begins_a_replaced_mission_at_the_marked_item() -> None:
    pilot = cruising(PX4)
    pilot.upload([takeoff(5.0), waypoint(60.0, 0.0, 5.0), waypoint(10.0, 0.0, 5.0)], marked=2)
    pilot.until_reached(2)
    assert pilot.reached() == [0, 2]


def test_the_same_mission_again_changes_nothing_on_px4() -> None:
    pilot = cruising(PX4)
    assert pilot.upload(LONG) == mavlink.MAV_MISSION_ACCEPTED
    pilot.until_reached(1)
    assert [m.seq for m in pilot.station.of("MISSION_CURRENT")].count(1) <= 2


def test_a_mission_too_short_for_where_ardupilot_is() -> None:
    pilot = cruising(AP)
    pilot.until_reached(1)
    pilot.upload([takeoff(5.0)])
    pilot.station.run(0.1)
    assert "Auto mission changed but failed to restart command" in pilot.said()
    pilot.station.run(15.0)
    assert pilot.autopilot.mission.progress is Progress.COMPLETE
    assert hypot(pilot.place()[0] - 60.0, pilot.place()[1] - 30.0) < 1.5


@BOTH
def test_clearing_the_mission_that_is_flown(flavour: Flavour) -> None:
    pilot = cruising(flavour)
    pilot.station.send(mavlink.MAVLink_mission_clear_all_message(1, 1, 255))
    result = pilot.station.last("MISSION_ACK").type
    pilot.station.run(6.0)
    if flavour is AP:
        assert result == mavlink.MAV_MISSION_ERROR
        assert pilot.autopilot.mission.present
        pilot.until_reached(1)
    else:
        assert result == mavlink.MAV_MISSION_ACCEPTED
        assert "No valid mission available, loitering" in pilot.said()
        assert pilot.autopilot.mode is Mode.HOLD
        assert pilot.speed() < 0.3


def test_px4_stores_what_it_will_not_fly_and_says_why() -> None:
    pilot = Pilot(PX4)
    condition = Step(WAIT, (3.0, 0.0, 0.0, 0.0))
    far = waypoint(20_000.0, 0.0)
    for steps, text in (
        ([takeoff(), condition], "Mission rejected: item 2: unsupported cmd: 112"),
        ([takeoff(2.0)], "Mission rejected: Takeoff altitude too low!"),
        ([waypoint(1.0, 0.0), takeoff()], "Mission rejected: takeoff not first waypoint item"),
        ([land(0.0, 0.0)], "Mission rejected: starts with landing"),
        ([far], "First waypoint too far away: "),
    ):
        pilot.station.forget()
        assert pilot.upload(steps) == mavlink.MAV_MISSION_ACCEPTED
        assert pilot.said()[-1].startswith(text)
        assert pilot.station.command(START) == DENIED
        assert pilot.station.request(mavlink.MAVLINK_MSG_ID_MISSION_CURRENT) == ACCEPTED
        assert pilot.station.last("MISSION_CURRENT").mission_state == 1
    assert not pilot.autopilot.armed


def test_px4_takes_a_latitude_of_95_degrees_and_does_not_fly_there() -> None:
    pilot = Pilot(PX4)
    messages = pilot.items([takeoff(), waypoint(5.0, 0.0)])
    messages[1].x = 950_000_000
    pilot.station.send(mavlink.MAVLink_mission_count_message(1, 1, 2, 0), *messages)
    assert pilot.station.last("MISSION_ACK").type == mavlink.MAV_MISSION_ACCEPTED
    assert pilot.said()[-1] == "Mission rejected: item 2: no place on earth"
    assert pilot.station.command(START) == DENIED
    pilot.station.set_mode(Mode.AUTO)
    assert pilot.station.command(ARM, 1) == REJECTED


@pytest.mark.parametrize(
    ("value", "steps", "flies"),
    [
        (1, [waypoint(1.0, 0.0)], False),
        (2, [takeoff()], False),
        (3, [takeoff(), land(0, 0)], True),
        (4, [takeoff()], False),
    ],
)
def test_px4_can_be_told_what_a_mission_needs(value: int, steps: list[Step], *, flies: bool) -> None:
    pilot = Pilot(PX4)
    pilot.station.endpoint.vehicle.parameters.set("MIS_TKO_LAND_REQ", value)
    pilot.station.run(0.1)
    pilot.upload(steps)
    assert (pilot.station.command(START) == ACCEPTED) is flies


def extension(message: object, length: int) -> tuple[int, ...]:
    """Return the identifiers behind a payload of `length`, of which MAVLink 2 has cut the zeros off."""
    frame = message.get_msgbuf()  # type: ignore[attr-defined]
    payload = bytes(frame[10 : 10 + frame[1]])
    tail = payload[length:].ljust((len(payload) - length + 3) // 4 * 4, b"\0")
    return unpack(f"<{len(tail) // 4}I", tail)


def test_plans_of_px4_have_identifiers() -> None:
    pilot = Pilot(PX4)
    pilot.upload(LONG)
    store = pilot.station.endpoint._plans.store
    name = plan_id(store.plans[PlanKind.MISSION])
    assert name != 0
    assert extension(pilot.station.last("MISSION_ACK"), 4) == (name,)
    pilot.station.send(mavlink.MAVLink_mission_request_list_message(1, 1, 0))
    assert extension(pilot.station.last("MISSION_COUNT"), 5) == (name,)
    pilot.station.request(mavlink.MAVLINK_MSG_ID_MISSION_CURRENT)
    assert extension(pilot.station.last("MISSION_CURRENT"), 6) == (name,)


def test_plans_of_ardupilot_have_none() -> None:
    pilot = Pilot(AP)
    pilot.upload(LONG)
    pilot.station.request(mavlink.MAVLINK_MSG_ID_MISSION_CURRENT)
    assert extension(pilot.station.last("MISSION_CURRENT"), 6) == ()


def test_heights_of_px4_follow_home() -> None:
    pilot = cruising(PX4, [takeoff(5.0), waypoint(60.0, 0.0, 5.0)])
    home = pilot.autopilot.home
    assert home is not None
    place = (round(home.lat_deg * 1e7), round(home.lon_deg * 1e7), home.alt_m + 4.0)
    assert pilot.station.command_int(mavlink.MAV_CMD_DO_SET_HOME, 0, (0, 0, 0, 0), place) == ACCEPTED
    pilot.until_reached(1)
    assert pilot.place()[2] == pytest.approx(9.0, abs=1.0)


@pytest.mark.parametrize(("value", "turns"), [(0, False), (2, True)])
def test_where_ardupilot_looks(value: int, *, turns: bool) -> None:
    pilot = Pilot(AP)
    pilot.station.endpoint.vehicle.parameters.set("WP_YAW_BEHAVIOR", value)
    pilot.station.run(0.1)
    pilot.fly([takeoff(5.0), waypoint(0.0, 30.0, 5.0)])
    pilot.until_reached(1)
    assert (pilot.station.endpoint.vehicle.truth.yaw_rad > 1.4) is turns


def test_an_item_changes_the_height_alone_in_guided() -> None:
    pilot = Pilot(AP)
    pilot.station.take_off(5.0)
    change = mavlink.MAVLink_mission_item_message(1, 1, 0, 3, 16, 3, 1, 0, 0, 0, 0, 0.0, 0.0, 9.0, 0)
    pilot.station.send(change)
    assert pilot.station.last("MISSION_ACK").type == mavlink.MAV_MISSION_ACCEPTED
    pilot.station.wait_until(lambda: pilot.place()[2] > 8.5, within_s=20.0)
    assert hypot(*pilot.place()[:2]) < 1.0
