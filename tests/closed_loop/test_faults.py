"""Fault x response: a small mission under each fault ends with the right outcome, and keeps out where it must.

Times count from take-off; the mission takes about 40 s from there. The truth is watched, not only what the vehicle
reports: while the position that it flies by is wrong by less than the clearance of the plan, it never enters the
restricted region.
"""

import io
from dataclasses import dataclass, replace
from enum import Enum, auto

import pytest
from shapely import Point, Polygon

from mission.errors import MissionError
from mission.fly import fly
from mission.link.ending import Ending
from mission.plan import FlightPlan
from mission.report.record import FlightRecord
from tests.support.faults import schedule_of
from tests.support.lockstep import LockstepVehicle, vehicle_of
from tests.support.small_missions import FLOWN_BRISKLY, plan_of
from vehicle_sim.autopilot import Mode

WALL = Polygon([(18, 0), (22, 0), (22, 8), (18, 8)])
ROUND_THE_WALL = (
    """\
name: Round the wall
domain:
  boundary: [[0, 0], [40, 0], [40, 30], [0, 30]]
regions:
  home: {kind: home, polygon: [[4, 4], [12, 4], [12, 12], [4, 12]]}
  goal: {kind: survey, polygon: [[28, 4], [36, 4], [36, 12], [28, 12]], loiter_s: 2}
  wall: {kind: restricted, polygon: [[18, 0], [22, 0], [22, 8], [18, 8]]}
mission:
  formula: F (goal & F G home) & G !wall
start:
  position_m: [9, 8]
"""
    + FLOWN_BRISKLY
)
START_M = (9.0, 8.0)


class Outcome(Enum):
    """How a flight under a fault ends."""

    ACHIEVED = auto()
    HANDED_OVER = auto()
    NOT_FLOWN = auto()


@dataclass(frozen=True)
class Case:
    """A fault, and for each flavour what comes of it, with words of the reason that is given."""

    fault: str
    ardupilot: tuple[Outcome, str]
    px4: tuple[Outcome, str]


FINE = (Outcome.ACHIEVED, "")
GRID = {
    "gps gone for good": Case(
        "gps_loss, at_s: 15",
        (Outcome.HANDED_OVER, "LAND; it says: EKF variance"),
        (Outcome.HANDED_OVER, "Position estimate invalid"),
    ),
    "gps gone for a moment": Case("gps_loss, at_s: 15, for_s: 3", FINE, FINE),
    "gps with a glitch": Case("gps_jump, at_s: 15, for_s: 0.6, north_m: 20", FINE, FINE),
    "gps that jumps for good": Case(
        "gps_jump, at_s: 15, north_m: 20",
        (Outcome.HANDED_OVER, "EKF variance"),
        (Outcome.HANDED_OVER, "estimate invalid"),
    ),
    "gps that drifts a little": Case("gps_drift, at_s: 0, ramp_s: 2, north_m_s: 0.02", FINE, FINE),
    "gps that is late": Case("gps_lag, lag_s: 0.24", FINE, FINE),
    "few satellites": Case("gps_satellites, count: 5", FINE, FINE),
    "no satellites at boot": Case(
        "gps_satellites, since: boot, count: 2", (Outcome.NOT_FLOWN, "no position"), (Outcome.NOT_FLOWN, "no position")
    ),
    "a gust": Case("gust, at_s: 14, for_s: 4, north_m_s: -8", FINE, FINE),
    "a bias of the accelerometers": Case("accelerometer_bias, at_s: 8, ramp_s: 4, x_m_s2: 0.15", FINE, FINE),
    "a bias of the gyros": Case("gyro_bias, at_s: 8, ramp_s: 4, x_rad_s: 0.002", FINE, FINE),
    "no compass": Case("compass_loss, at_s: 8", FINE, FINE),
    "no barometer": Case("baro_loss, at_s: 8", FINE, FINE),
    "a weak motor": Case("motor, at_s: 8, ramp_s: 1, rotor: 3, efficiency: 0.8", FINE, FINE),
    "a link that loses and mixes": Case(
        "link, drop: 0.1, duplicate: 0.2, reorder: 0.1, corrupt: 0.05, delay_s: 0.03", FINE, FINE
    ),
    "a link that is cut upwards": Case(
        "link, at_s: 15, drop: 1, down: 0",
        (Outcome.HANDED_OVER, "never answered"),
        (Outcome.HANDED_OVER, "No offboard signal"),
    ),
}


@pytest.fixture(scope="module")
def plan() -> FlightPlan:
    return plan_of(ROUND_THE_WALL)


def flown(plan: FlightPlan, flavour: str, fault: str) -> tuple[Outcome, str, LockstepVehicle, float]:
    """Fly, and return the outcome, its reason, the vehicle, and how close it truly came to the wall."""
    nearest = [1e9]

    def watch(lockstep: LockstepVehicle) -> None:
        north, east, _ = lockstep.vehicle.truth.position_ned_m
        if lockstep.vehicle.steps % 10 == 0:
            nearest[0] = min(nearest[0], WALL.distance(Point(START_M[0] + east, START_M[1] + north)))

    since = "" if "since:" in fault else ", since: takeoff"
    config = replace(vehicle_of(flavour), faults=schedule_of(fault + since))
    vehicle = LockstepVehicle(config, at_step=watch)
    try:
        result = fly(plan, vehicle, vehicle, FlightRecord(io.BytesIO(), mission="wall"))
    except MissionError as error:
        outcome = Outcome.HANDED_OVER if vehicle.vehicle.autopilot.flying else Outcome.NOT_FLOWN
        return outcome, str(error), vehicle, nearest[0]
    if result.achieved:
        return Outcome.ACHIEVED, result.reason, vehicle, nearest[0]
    assert result.ending is Ending.HANDED_OVER
    return Outcome.HANDED_OVER, result.reason, vehicle, nearest[0]


USUAL = [
    ("gps that jumps for good", "px4"),
    ("a gust", "px4"),
    ("a link that loses and mixes", "ardupilot"),
    ("a link that is cut upwards", "px4"),
]
"""One of each sort, beside the one that is followed to the ground; the whole grid takes half a minute."""

CELLS = [
    pytest.param(name, flavour, marks=() if (name, flavour) in USUAL else pytest.mark.long)
    for name in GRID
    for flavour in ("ardupilot", "px4")
]


@pytest.mark.parametrize(("name", "flavour"), CELLS)
def test_each_fault_has_its_outcome(plan: FlightPlan, name: str, flavour: str) -> None:
    case = GRID[name]
    expected, words = case.ardupilot if flavour == "ardupilot" else case.px4
    outcome, reason, _, nearest_m = flown(plan, flavour, case.fault)
    assert outcome is expected, reason
    assert words in reason
    assert nearest_m > 0.0


def test_a_fault_of_the_estimator_is_its_failsafe_and_it_lands_by_itself(plan: FlightPlan) -> None:
    case = GRID["gps gone for good"]
    outcome, reason, lockstep, nearest_m = flown(plan, "ardupilot", case.fault)
    vehicle = lockstep.vehicle
    assert outcome is case.ardupilot[0]
    assert case.ardupilot[1] in reason
    assert nearest_m > 0.0
    assert vehicle.autopilot.mode is Mode.LAND
    until_s = vehicle.time_s + 60.0
    while vehicle.autopilot.armed and vehicle.time_s < until_s:
        vehicle.step()
    assert vehicle.truth.on_ground
    assert not vehicle.autopilot.armed


@pytest.mark.long
def test_the_same_fault_and_seed_is_the_same_flight(plan: FlightPlan) -> None:
    fault = GRID["a link that loses and mixes"].fault
    first, second = (flown(plan, "px4", fault)[2].vehicle for _ in range(2))
    assert (first.time_s, first.truth, first.estimate) == (second.time_s, second.truth, second.estimate)
