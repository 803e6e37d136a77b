"""A program that is killed in flight, and its flight taken up again: nothing is done twice, and nothing left out."""

import math
from dataclasses import replace

import numpy as np
import pytest

from mission.errors import MissionError, NoPlanError, RecordError, VehicleError
from mission.link.ending import Ending
from mission.plan import FlightPlan
from tests.support.fault_grid import KilledError
from tests.support.resumed import Killed
from tests.support.small_missions import SMALL, plan_of
from vehicle_sim.autopilot import Mode
from vehicle_sim.parameters import Flavour

FLAVOURS = pytest.mark.parametrize("flavour", list(Flavour))
ALONE_S = 8.0
TWO_PLACES = (
    SMALL.replace("F (goal & F G home)", "F (goal & F (pond & F G home))")
    .replace("& G !pond", "")
    .replace("pond: {kind: restricted", "pond: {kind: survey")
)
COVERED = """\
name: Covered once
domain:
  boundary: [[0, 0], [60, 0], [60, 40], [0, 40]]
regions:
  home: {kind: home, polygon: [[4, 4], [14, 4], [14, 14], [4, 14]]}
  field:
    kind: survey
    polygon: [[30, 10], [54, 10], [54, 30], [30, 30]]
    cover: {spacing_m: 6, heading_deg: 90, share: 0.9}
mission:
  formula: F (field & F G home)
start:
  position_m: [9, 8]
flight: {speed_m_s: 4, altitude_m: 6, final_stay_s: 1, time_constant_s: 1.0, disturbance_m_s2: 0.5}
limits: {speed_m_s: 6, acceleration_m_s2: 2.5, tilt_deg: 25}
"""


@pytest.fixture(scope="module")
def two_places() -> FlightPlan:
    return plan_of(TWO_PLACES)


@pytest.fixture(scope="module")
def covered() -> FlightPlan:
    return plan_of(COVERED)


def instants(count: int, seed: int) -> list[float]:
    """Vehicle times from arming to the landing of a flight of about 50 s."""
    return [round(float(at_s), 2) for at_s in np.random.default_rng(seed).uniform(13.0, 62.0, count)]


def taken_up(killed: Killed) -> None:
    """Resume, and see that what the mission asks for was done once."""
    result = killed.resume()
    assert result.achieved, result.reason
    assert result.ending is Ending.LANDED
    goals = [name for name in killed.entered() if name != "home"]
    assert goals == ["goal", "pond"], killed.entered()
    assert not result.violations


@FLAVOURS
@pytest.mark.parametrize("at_s", [16.0, 27.0, 33.5])
def test_a_flight_goes_on_from_its_record(two_places: FlightPlan, flavour: Flavour, at_s: float) -> None:
    killed = Killed(two_places, flavour, at_s)
    killed.leave(ALONE_S)
    taken_up(killed)


@FLAVOURS
def test_what_moves_still_is_waited_for(two_places: FlightPlan, flavour: Flavour) -> None:
    killed = Killed(two_places, flavour, 24.0)
    north_m_s, east_m_s, _ = killed.bench.vehicle.truth.velocity_ned_m_s
    assert math.hypot(north_m_s, east_m_s) > 2.0
    taken_up(killed)


@pytest.mark.long
@FLAVOURS
@pytest.mark.parametrize("at_s", instants(120, seed=11))
def test_a_flight_goes_on_from_whatever_instant(two_places: FlightPlan, flavour: Flavour, at_s: float) -> None:
    killed = Killed(two_places, flavour, at_s)
    killed.leave(ALONE_S)
    try:
        taken_up(killed)
    except (RecordError, VehicleError) as refusal:
        words = str(refusal)
        assert any(said in words for said in ("had not begun", "motors are off", "has come to its end", "is in")), words
        assert killed.entered() in ([], ["home"], ["home", "goal", "pond", "home"])


def test_a_flight_goes_on_after_a_second_kill(two_places: FlightPlan) -> None:
    killed = Killed(two_places, Flavour.ARDUPILOT, 24.0)
    killed.leave(ALONE_S)
    with pytest.raises(KilledError):
        killed.resume(killed_at_s=44.0)
    killed.leave(ALONE_S)
    taken_up(killed)
    assert len(killed.record.takeovers) == 2


@FLAVOURS
def test_lanes_that_were_flown_are_not_flown_again(covered: FlightPlan, flavour: Flavour) -> None:
    visit = covered.covers[0]
    times = covered.trajectory.time_at(visit.lanes_s.ravel()).reshape(-1, 2)
    middle = times[len(times) // 2].mean()
    began_s = {Flavour.ARDUPILOT: 20.0, Flavour.PX4: 22.0}[flavour]
    killed = Killed(covered, flavour, began_s + float(middle))
    killed.leave(ALONE_S)
    result = killed.resume()
    assert result.achieved, result.reason
    again = result.plans[1].covers[0]
    lengths = [np.diff(plan_visit.lanes_s, axis=1).sum() for plan_visit in (visit, again)]
    assert lengths[1] < 0.75 * lengths[0]
    [what] = result.covered
    assert what.share >= visit.share


@FLAVOURS
def test_what_makes_it_another_flight_is_refused(two_places: FlightPlan, flavour: Flavour) -> None:
    killed = Killed(two_places, flavour, 26.0)
    killed.leave(ALONE_S)
    killed.bench.station.set_mode(Mode.RETURN)
    killed.leave(3.0)
    with pytest.raises(VehicleError, match="RTL: somebody else flies it"):
        killed.resume()
    killed.leave(150.0)
    with pytest.raises(VehicleError, match="motors are off"):
        killed.resume()


def test_a_restarted_vehicle_is_refused(two_places: FlightPlan) -> None:
    killed = Killed(two_places, Flavour.PX4, 26.0)
    killed.bench.endpoint.reboot_in(0)
    killed.leave(2.0)
    with pytest.raises(MissionError):
        killed.resume()


def test_a_flight_that_ended_or_never_began_is_refused(two_places: FlightPlan) -> None:
    with pytest.raises(RecordError, match="had not begun"):
        Killed(two_places, Flavour.ARDUPILOT, 5.0).resume()
    whole = Killed(two_places, Flavour.ARDUPILOT, 1e6)
    with pytest.raises(RecordError, match="has come to its end"):
        whole.resume()


def test_a_vehicle_above_what_is_restricted_now_is_refused(two_places: FlightPlan) -> None:
    killed = Killed(two_places, Flavour.ARDUPILOT, 24.0)
    killed.leave(ALONE_S)
    north, east, down = killed.bench.vehicle.truth.position_ned_m
    del down
    x, y = 9.0 + east, 8.0 + north
    corners = [[x - 1, y - 1], [x + 1, y - 1], [x + 1, y + 1], [x - 1, y + 1]]
    over = f"  over: {{kind: restricted, polygon: {corners}}}\n"
    killed.plan = replace(plan_of(TWO_PLACES.replace("mission:\n", over + "mission:\n")), start_m=killed.plan.start_m)
    with pytest.raises(NoPlanError, match="restricted over"):
        killed.resume()
