"""Whole missions, flown through the endpoint in lock-step by a scripted ground station."""

from math import hypot, radians

import pytest
from pymavlink.dialects.v20 import ardupilotmega as mavlink

from tests.support.missions import (
    DELAY,
    JUMP,
    RETURN,
    SPEED,
    TIME,
    TURNS,
    UNLIMITED,
    WAIT,
    WAYPOINT,
    YAW,
    Pilot,
    Step,
    land,
    takeoff,
    waypoint,
)
from tests.support.station import Station, endpoint_of
from vehicle_sim.autopilot import LandedState, Mode, Progress
from vehicle_sim.parameters import Flavour
from vehicle_sim.protocol.flavour import Rates

AP, PX4 = Flavour.ARDUPILOT, Flavour.PX4
BOTH = pytest.mark.parametrize("flavour", Flavour)
ACCEPTED = mavlink.MAV_RESULT_ACCEPTED


def near(pilot: Pilot, north: float, east: float, up: float, within: float = 2.5) -> bool:
    n, e, u = pilot.place()
    return hypot(n - north, e - east, u - up) <= within


@BOTH
def test_take_off_waypoints_a_slower_leg_and_landing(flavour: Flavour) -> None:
    pilot = Pilot(flavour)
    pilot.fly(
        [
            takeoff(8.0),
            waypoint(30.0, 0.0, 8.0),
            Step(SPEED, (1.0, 2.0, -1.0, 0.0)),
            waypoint(30.0, 20.0, 12.0),
            land(28.0, 22.0),
        ]
    )
    pilot.until_reached(1)
    assert near(pilot, 30.0, 0.0, 8.0)
    pilot.station.run(4.0)
    assert pilot.speed() == pytest.approx(2.0, abs=0.3)
    pilot.until_reached(3)
    assert near(pilot, 30.0, 20.0, 12.0)
    pilot.station.wait_until(lambda: not pilot.autopilot.armed, within_s=60.0)
    assert near(pilot, 28.0, 22.0, 0.0, within=1.0)
    assert pilot.reached() == [0, 1, 2, 3, 4]
    assert pilot.autopilot.mode is Mode.AUTO
    assert pilot.autopilot.mission.progress is Progress.COMPLETE
    assert pilot.autopilot.landed_state is LandedState.ON_GROUND


@BOTH
def test_the_vehicle_keeps_to_the_straight_line(flavour: Flavour) -> None:
    pilot = Pilot(flavour)
    pilot.fly([takeoff(10.0), waypoint(50.0, 0.0), waypoint(50.0, 50.0, 20.0), land(50.0, 50.0)])
    pilot.until_reached(0)
    worst = 0.0
    while pilot.reached()[-1] < 1:
        pilot.station.run(0.1)
        worst = max(worst, abs(pilot.place()[1]))
    assert worst < 0.8
    pilot.station.run(3.0)
    while pilot.reached()[-1] < 2:
        pilot.station.run(0.1)
        north, east, up = pilot.place()
        assert abs(north - 50.0) < 1.5
        assert up == pytest.approx(10.0 + 0.2 * east, abs=1.5)


@BOTH
def test_corners_are_passed_without_a_stop_unless_a_hold_is_asked_for(flavour: Flavour) -> None:
    pilot = Pilot(flavour)
    pilot.fly([takeoff(), waypoint(40.0, 0.0), waypoint(80.0, 0.0), waypoint(80.0, 30.0, hold_s=4.0), land(80.0, 60.0)])
    pilot.until_reached(1)
    straight = pilot.speed()
    assert straight == pytest.approx(pilot.autopilot.settings.cruise_m_s, rel=0.1)
    pilot.until_reached(2)
    assert 1.0 < pilot.speed() < straight
    before_s = pilot.station.endpoint.vehicle.time_s
    pilot.station.wait_until(lambda: near(pilot, 80.0, 30.0, 10.0, within=2.0), within_s=30.0)
    pilot.until_reached(3)
    assert pilot.station.endpoint.vehicle.time_s - before_s > 4.0
    assert pilot.speed() < 0.3


@BOTH
def test_loiter_for_a_time_and_delay(flavour: Flavour) -> None:
    pilot = Pilot(flavour)
    loiter = Step(TIME, (6.0, 0.0, 0.0, 0.0), (10.0, 0.0), 10.0)
    pilot.fly([takeoff(), loiter, Step(DELAY, (5.0, 0.0, 0.0, 0.0)), waypoint(0.0, 0.0)])
    vehicle = pilot.station.endpoint.vehicle
    pilot.station.wait_until(lambda: near(pilot, 10.0, 0.0, 10.0, within=2.0), within_s=60.0)
    near_s = vehicle.time_s
    pilot.until_reached(1)
    loitered_s = vehicle.time_s
    assert loitered_s - near_s == pytest.approx(6.0, abs=1.0)
    pilot.until_reached(2)
    assert vehicle.time_s - loitered_s == pytest.approx(5.0, abs=0.1)
    assert near(pilot, 10.0, 0.0, 10.0, within=0.7)


@BOTH
def test_unlimited_loiter_lasts_until_another_item_is_chosen(flavour: Flavour) -> None:
    pilot = Pilot(flavour)
    pilot.fly([takeoff(), Step(UNLIMITED, at=(15.0, 0.0)), waypoint(0.0, 15.0)])
    pilot.station.wait_until(lambda: near(pilot, 15.0, 0.0, 10.0, within=0.5), within_s=60.0)
    pilot.station.run(30.0)
    assert near(pilot, 15.0, 0.0, 10.0, within=0.5)
    assert pilot.reached() == [0]
    seq = pilot.first + 2
    assert pilot.station.command(mavlink.MAV_CMD_DO_SET_MISSION_CURRENT, seq) == ACCEPTED
    assert pilot.station.last("MISSION_CURRENT").seq == seq
    pilot.until_reached(2)
    assert near(pilot, 0.0, 15.0, 10.0)


def test_circles_have_a_radius_a_number_and_a_direction() -> None:
    pilot = Pilot(AP)
    pilot.fly([takeoff(), Step(TURNS, (2.0, 0.0, -8.0, 0.0), (30.0, 0.0)), waypoint(0.0, 0.0)])
    circling = [f"Mission: starting circle {turn}/2" for turn in (1, 2)]
    pilot.station.wait_until(lambda: circling[0] in pilot.station.texts(), within_s=60.0)
    pilot.station.run(3.0)
    swept = 0.0
    vehicle = pilot.station.endpoint.vehicle
    while 1 not in pilot.reached():
        north, east, _ = pilot.place()
        v_north, v_east, _ = vehicle.truth.velocity_ned_m_s
        radius = hypot(north - 30.0, east)
        # The estimate of the place is a few decimetres off.
        assert radius == pytest.approx(8.0, abs=1.2)
        # The cross product of place and velocity is negative where the compass course decreases.
        swept += ((north - 30.0) * v_east - east * v_north) / radius**2 * 0.1
        pilot.station.run(0.1)
    assert swept < radians(-600.0)
    assert [text for text in pilot.station.texts() if "circle" in text] == circling


@BOTH
def test_jumps_are_counted(flavour: Flavour) -> None:
    pilot = Pilot(flavour)
    jump = Step(JUMP, (pilot.first + 1, 2.0, 0.0, 0.0))
    pilot.fly([takeoff(), waypoint(12.0, 0.0), waypoint(0.0, 12.0), jump, land(0.0, 0.0)])
    pilot.station.wait_until(lambda: not pilot.autopilot.armed, within_s=150.0)
    assert pilot.reached() == [0, 1, 2, 1, 2, 1, 2, 4]
    if flavour is AP:
        said = [text for text in pilot.station.texts() if "Jump" in text]
        assert said == ["Mission: 4 Jump 1/2", "Mission: 4 Jump 2/2"]


@BOTH
def test_endless_jumps_never_end_and_never_hang(flavour: Flavour) -> None:
    pilot = Pilot(flavour)
    pilot.fly([takeoff(), waypoint(0.0, 0.0), Step(JUMP, (pilot.first + 1, -1.0, 0.0, 0.0)), land(0.0, 0.0)])
    pilot.until_reached(0)
    pilot.station.run(20.0)
    assert set(pilot.reached()[1:]) == {1}
    assert pilot.autopilot.flying


@BOTH
def test_a_loop_of_jumps_alone_ends_the_mission(flavour: Flavour) -> None:
    pilot = Pilot(flavour)
    loop = Step(JUMP, (pilot.first + 1, -1.0, 0.0, 0.0))
    pilot.fly([takeoff(), loop])
    pilot.until_reached(0)
    pilot.station.run(5.0)
    assert pilot.autopilot.mission.progress is Progress.COMPLETE
    assert pilot.autopilot.mode is (Mode.AUTO if flavour is AP else Mode.HOLD)
    assert near(pilot, 0.0, 0.0, 10.0, within=1.0)


def test_what_stands_between_navigation_runs_beside_it_on_ardupilot() -> None:
    pilot = Pilot(AP)
    pilot.fly(
        [
            takeoff(),
            Step(WAIT, (3.0, 0.0, 0.0, 0.0)),
            Step(YAW, (90.0, 60.0, 1.0, 0.0)),
            waypoint(30.0, 0.0),
            Step(WAIT, (300.0, 0.0, 0.0, 0.0)),
            waypoint(0.0, 0.0),
        ]
    )
    pilot.until_reached(0)
    taken_off_s = pilot.station.endpoint.vehicle.time_s
    pilot.until_reached(1)
    assert pilot.station.endpoint.vehicle.time_s - taken_off_s == pytest.approx(3.05, abs=0.1)
    pilot.until_reached(2)
    assert pilot.station.endpoint.vehicle.truth.yaw_rad == pytest.approx(radians(90.0), abs=0.1)
    pilot.until_reached(5)
    assert pilot.reached() == [0, 1, 2, 3, 5]


@BOTH
def test_return_by_an_item(flavour: Flavour) -> None:
    pilot = Pilot(flavour)
    name = "RTL_ALT" if flavour is AP else "RTL_RETURN_ALT"
    pilot.station.endpoint.vehicle.parameters.set(name, 1200.0 if flavour is AP else 12.0)
    pilot.fly([takeoff(), waypoint(20.0, 10.0), Step(RETURN)])
    pilot.until_reached(1)
    pilot.station.run(1.0)
    assert pilot.autopilot.mode is (Mode.AUTO if flavour is AP else Mode.RETURN)
    pilot.station.wait_until(lambda: not pilot.autopilot.armed, within_s=120.0)
    assert near(pilot, 0.0, 0.0, 0.0, within=1.0)
    assert pilot.reached() == [0, 1, 2]


@BOTH
def test_at_the_end_it_stays_where_it_is(flavour: Flavour) -> None:
    pilot = Pilot(flavour)
    pilot.fly([takeoff(), waypoint(20.0, 0.0)])
    pilot.until_reached(1)
    pilot.station.run(10.0)
    assert near(pilot, 20.0, 0.0, 10.0, within=1.0)
    assert pilot.autopilot.mode is (Mode.AUTO if flavour is AP else Mode.HOLD)
    assert pilot.station.request(mavlink.MAVLINK_MSG_ID_MISSION_CURRENT) == ACCEPTED
    current = pilot.station.last("MISSION_CURRENT")
    assert (current.seq, current.total) == (pilot.first + 1, 2)
    assert current.mission_state == 5
    if flavour is PX4:
        assert "Mission finished, loitering" in pilot.station.texts()


@BOTH
def test_landing_and_taking_off_again_in_one_mission(flavour: Flavour) -> None:
    pilot = Pilot(flavour)
    second = waypoint(12.0, 0.0, 6.0) if flavour is PX4 else takeoff(6.0)
    pilot.fly([takeoff(6.0), land(6.0, 0.0), second, land(6.0, 0.0)])
    pilot.until_reached(1)
    assert pilot.place()[2] < 0.3
    assert pilot.autopilot.armed
    pilot.until_reached(2)
    assert pilot.place()[2] > 4.5
    pilot.station.wait_until(lambda: not pilot.autopilot.armed, within_s=60.0)
    assert pilot.reached() == [0, 1, 2, 3]


def test_an_item_of_px4_that_does_not_continue_is_stayed_at() -> None:
    pilot = Pilot(PX4)
    stop = Step(waypoint(0, 0).command, (0.0, 0.0, 0.0, 0.0), (10.0, 0.0), 10.0, autocontinue=0)
    pilot.fly([takeoff(), stop, waypoint(30.0, 0.0)])
    pilot.until_reached(1)
    pilot.station.run(20.0)
    assert pilot.reached() == [0, 1]
    assert near(pilot, 10.0, 0.0, 10.0, within=0.7)


def test_missions_of_px4_leave_the_ground_by_themselves() -> None:
    pilot = Pilot(PX4)
    pilot.fly([waypoint(20.0, 0.0, 8.0), land(20.0, 0.0)])
    pilot.station.wait_until(lambda: pilot.place()[2] > 7.0, within_s=30.0)
    assert hypot(*pilot.place()[:2]) < 1.5
    pilot.until_reached(0)
    assert near(pilot, 20.0, 0.0, 8.0)


@BOTH
def test_the_order_of_what_is_told(flavour: Flavour) -> None:
    """ArduPilot names the current item only where it is streamed or asked for."""
    pilot = Pilot(flavour)
    pilot.fly([takeoff(6.0), waypoint(10.0, 0.0, 6.0), land(10.0, 0.0)])
    pilot.station.wait_until(lambda: not pilot.autopilot.armed, within_s=60.0)
    names = {"MISSION_ITEM_REACHED": "reached", "MISSION_CURRENT": "current"}
    told = [(names[m.get_type()], m.seq) for m in pilot.station.heard if m.get_type() in names]
    if flavour is AP:
        assert told == [("reached", 1), ("reached", 2), ("reached", 3)]
    else:
        current = [("current", 0)]
        assert [told[i] for i in range(len(told)) if told[i : i + 1] != told[i - 1 : i] or i == 0] == [
            *current,
            ("reached", 0),
            ("current", 1),
            ("reached", 1),
            ("current", 2),
            ("reached", 2),
        ]


def test_a_waypoint_of_px4_has_its_own_radius_and_heading() -> None:
    pilot = Pilot(PX4)
    wide = Step(WAYPOINT, (0.0, 12.0, 0.0, 90.0), (40.0, 0.0), 10.0)
    pilot.fly([takeoff(), wide, Step(UNLIMITED, at=(40.0, 0.0))])
    pilot.until_reached(1)
    assert 9.0 < 40.0 - pilot.place()[0] <= 12.5
    assert pilot.station.endpoint.vehicle.truth.yaw_rad == pytest.approx(radians(90.0), abs=0.1)


@BOTH
def test_the_vehicle_looks_at_a_place_of_interest(flavour: Flavour) -> None:
    pilot = Pilot(flavour)
    look = Step(mavlink.MAV_CMD_DO_SET_ROI_LOCATION, at=(20.0, 100.0), up=0.0)
    ahead = Step(mavlink.MAV_CMD_DO_SET_ROI_NONE)
    pilot.fly([takeoff(), look, waypoint(20.0, 0.0, hold_s=3.0), ahead, waypoint(40.0, 0.0)])
    pilot.until_reached(2)
    truth = pilot.station.endpoint.vehicle.truth
    assert truth.yaw_rad == pytest.approx(radians(90.0), abs=0.15)
    pilot.until_reached(4)
    assert pilot.station.endpoint.vehicle.truth.yaw_rad == pytest.approx(0.0, abs=0.15)


@BOTH
def test_home_is_moved_by_an_item(flavour: Flavour) -> None:
    pilot = Pilot(flavour)
    here = Step(mavlink.MAV_CMD_DO_SET_HOME, (1.0, 0.0, 0.0, 0.0))
    pilot.fly([takeoff(6.0), waypoint(15.0, 0.0, 6.0, hold_s=2.0), here, waypoint(15.0, 10.0, 3.0, hold_s=2.0)])
    pilot.until_reached(3)
    # Three metres above the home that was put six metres up.
    assert pilot.place()[2] == pytest.approx(9.0, abs=1.2)


def test_px4_names_the_current_item_each_second() -> None:
    station = Station(endpoint_of(PX4), rates=Rates.GROUND_STATION)
    station.run(5.0)
    assert len(station.of("MISSION_CURRENT")) == 5
    assert {message.total for message in station.of("MISSION_CURRENT")} == {65535}


@BOTH
def test_equal_flights_are_equal_byte_for_byte(flavour: Flavour) -> None:
    flights = []
    for _ in range(2):
        pilot = Pilot(flavour)
        pilot.fly([takeoff(5.0), waypoint(10.0, 5.0, 5.0), land(10.0, 5.0)])
        pilot.until_reached(1)
        flights.append((pilot.station.endpoint.vehicle.truth, [bytes(m.get_msgbuf()) for m in pilot.station.heard]))
    assert flights[0] == flights[1]
