"""A program that is killed in flight, and its flight taken up again: nothing is done twice, and nothing left out."""

import math
from dataclasses import replace
from itertools import groupby, product

import numpy as np
import pytest
from pymavlink.dialects.v20 import ardupilotmega as mavlink

from mission.errors import LinkError, MissionError, NoPlanError, RecordError, VehicleError
from mission.fly import FlightOptions
from mission.fly.amendments import Amendment, AmendmentAnswer
from mission.fly.resuming import RETURNING, unfinished
from mission.link.contact import Contact
from mission.link.ending import Ending
from mission.link.identity import LinkOptions
from mission.link.values import Version
from mission.plan import FlightPlan
from mission.report.reading import LaterPlan
from mission.report.replay import judged_again
from mission.report.tracking import tracking_of
from mission.spec.model import MissionSpec
from mission.verify.flown.judging import Judged, judged
from mission.verify.logs.flight_record import track_of_record
from tests.support.fault_grid import Bench, FullDisk, KilledError
from tests.support.lockstep import LINK
from tests.support.resumed import Killed
from tests.support.small_missions import PHOTOGRAPHED, ROUNDS, SMALL, plan_of
from tests.support.station import Station
from tests.support.usual_cases import ARDUPILOT, EACH, PX4, sampled
from vehicle_sim.autopilot import Mode
from vehicle_sim.faults import NO_FAULTS
from vehicle_sim.parameters import Flavour
from vehicle_sim.protocol.endpoint import Endpoint
from vehicle_sim.protocol.plan_store import PlanItem, PlanKind

ALONE_S = 8.0
FAR_CIRCLE = PlanItem(
    mavlink.MAV_FRAME_GLOBAL, mavlink.MAV_CMD_NAV_FENCE_CIRCLE_EXCLUSION, 1, (20.0, 0.0, 0.0, 0.0), 1, 1, 0.0
)
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
def small() -> FlightPlan:
    return plan_of(SMALL)


@pytest.fixture(scope="module")
def covered() -> FlightPlan:
    return plan_of(COVERED)


@pytest.fixture(scope="module")
def rounds() -> FlightPlan:
    return plan_of(ROUNDS.replace("laps: 2", "laps: 3"))


def instants(count: int, seed: int) -> list[float]:
    """Vehicle times from arming to the landing of a flight of about 33 s."""
    return [round(float(at_s), 2) for at_s in np.random.default_rng(seed).uniform(13.0, 46.0, count)]


def taken_up(killed: Killed) -> None:
    """Resume, and see that what the mission asks for was done once."""
    result = killed.resume()
    assert result.achieved, result.reason
    assert result.ending is Ending.LANDED
    # A region out of which the vehicle has braked before its stay was over is entered again for what is left of that.
    goals = [name for name, _ in groupby(name for name in killed.entered() if name != "home")]
    assert goals == ["goal", "pond"], killed.entered()
    assert not result.violations
    told = told_afterwards(killed)
    assert told.achieved, (told.reason, told.doubts)
    assert not told.violations


def told_afterwards(killed: Killed) -> Judged:
    """The verdict on the record, as ``mission verify --flight`` gives it."""
    record, plan = killed.record, killed.plan
    legs = (LaterPlan(-math.inf, plan, 0), *record.later)
    return judged(plan.spec, track_of_record(record), plan=plan, legs=legs)


@sampled(
    ("flavour", "at_s"),
    product(Flavour, (16.0, 27.0, 33.5)),
    [(Flavour.ARDUPILOT, 16.0), (Flavour.PX4, 27.0), (Flavour.ARDUPILOT, 33.5)],
)
def test_a_flight_goes_on_from_its_record(two_places: FlightPlan, flavour: Flavour, at_s: float) -> None:
    killed = Killed(two_places, flavour, at_s)
    killed.leave(ALONE_S)
    taken_up(killed)


@PX4
def test_what_moves_still_is_waited_for(two_places: FlightPlan, flavour: Flavour) -> None:
    killed = Killed(two_places, flavour, {Flavour.ARDUPILOT: 25.5, Flavour.PX4: 28.0}[flavour])
    north_m_s, east_m_s, _ = killed.bench.vehicle.truth.velocity_ned_m_s
    assert math.hypot(north_m_s, east_m_s) > 2.0
    taken_up(killed)


@pytest.mark.long
@EACH
@pytest.mark.parametrize("at_s", instants(120, seed=11))
def test_a_flight_goes_on_from_whatever_instant(two_places: FlightPlan, flavour: Flavour, at_s: float) -> None:
    killed = Killed(two_places, flavour, at_s)
    killed.leave(ALONE_S)
    try:
        taken_up(killed)
    except (RecordError, VehicleError) as refusal:
        words = str(refusal)
        assert any(
            said in words for said in ("had not begun", "motors are off", "has landed", "has come to its end", "is in")
        ), words
        assert killed.entered() in ([], ["home"], ["home", "goal", "pond", "home"])


def test_a_flight_goes_on_after_a_second_kill(two_places: FlightPlan) -> None:
    killed = Killed(two_places, Flavour.ARDUPILOT, 24.0)
    killed.leave(ALONE_S)
    with pytest.raises(KilledError):
        killed.resume(killed_at_s=44.0)
    killed.leave(ALONE_S)
    taken_up(killed)
    assert len(killed.record.takeovers) == 2


@ARDUPILOT
def test_the_largest_error_is_that_of_both_parts(two_places: FlightPlan, flavour: Flavour) -> None:
    killed = Killed(two_places, flavour, 33.5)
    before = tracking_of(killed.record)
    killed.leave(ALONE_S)
    result = killed.resume()
    whole = tracking_of(killed.record)
    assert result.largest_error_m >= np.abs(before.error_m).max() > 0.0
    assert result.largest_error_m == pytest.approx(np.abs(whole.error_m).max(), abs=0.02)
    assert result.largest_distance_m == pytest.approx(whole.distance_m.max(), abs=0.02)


class Told:
    """One change, as soon as it can be taken."""

    def __init__(self, change: Amendment) -> None:
        self.waiting, self.answers = [change], list[AmendmentAnswer]()

    def take(self) -> Amendment | None:
        return self.waiting.pop() if self.waiting else None

    def answer(self, _amendment: Amendment, answer: AmendmentAnswer) -> None:
        self.answers.append(answer)

    def keep(self, number: int, mission: MissionSpec) -> None:
        """Nobody looks for it."""


def test_a_mission_that_is_amended_once_it_was_taken_up_is_what_was_written(two_places: FlightPlan) -> None:
    """The same mission with a region more asks for nothing new: the first place is not visited again."""
    killed = Killed(two_places, Flavour.ARDUPILOT, 33.5)
    killed.leave(ALONE_S)
    far = "  far: {kind: restricted, polygon: [[20, 24], [23, 24], [23, 28], [20, 28]]}\nmission:\n"
    told = Told(Amendment("", mission=TWO_PLACES.replace("mission:\n", far)))
    result = killed.resume(amendments=told)
    assert result.achieved, result.reason
    assert [answer.accepted for answer in told.answers] == [True], told.answers
    assert [name for name in killed.entered() if name != "home"] == ["goal", "pond"]


def test_laps_that_are_left_are_counted_once(rounds: FlightPlan) -> None:
    """Taken up twice and amended then, a flight of three laps has three."""
    killed = Killed(rounds, Flavour.ARDUPILOT, 32.0)
    killed.leave(ALONE_S)
    with pytest.raises(KilledError):
        killed.resume(killed_at_s=50.0)
    assert told_afterwards(killed).laps == (unfinished(rounds, killed.record).legs.laps, 3)
    killed.leave(ALONE_S)
    told = Told(Amendment("", ("restrict far [[17, 24], [20, 24], [20, 28], [17, 28]]",)))
    result = killed.resume(amendments=told)
    assert result.achieved, result.reason
    assert [answer.accepted for answer in told.answers] == [True], told.answers
    assert result.laps == 3
    assert killed.entered().count("north") >= 3


@PX4
def test_laps_that_were_ended_before_stay_ended_and_too_few(rounds: FlightPlan, flavour: Flavour) -> None:
    killed = Killed(rounds, flavour, 33.0, ends_laps_at_s=28.0)
    assert any(event.text == RETURNING for event in killed.record.events)
    killed.leave(ALONE_S)
    result = killed.resume()
    assert result.ending is Ending.LANDED
    assert not result.achieved
    assert "1 of 3 laps were flown" in result.reason
    assert judged_again(rounds, killed.record).outcome().achieved is False


def test_pictures_of_both_parts_are_counted() -> None:
    killed = Killed(plan_of(PHOTOGRAPHED), Flavour.ARDUPILOT, 60.0)
    taken = len(killed.record.pictures)
    assert taken
    killed.leave(ALONE_S)
    result = killed.resume()
    assert len(result.pictures) == len(killed.record.pictures) > taken
    assert abs(len(result.pictures) - result.planned_pictures) <= 1


@ARDUPILOT
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


@PX4
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


@sampled(
    ("flavour", "at_s"),
    product(Flavour, [12.5, 48.0]),
    [(Flavour.ARDUPILOT, 12.5), (Flavour.PX4, 48.0)],
)
def test_a_vehicle_on_the_ground_gets_its_own_fence_back(small: FlightPlan, flavour: Flavour, at_s: float) -> None:
    """Also where the flight had not begun, or is over; once, and not where somebody else has set another since."""
    killed = Killed(small, flavour, at_s, FlightOptions(fence=True))
    killed.leave(30.0)
    autopilot = killed.bench.vehicle.autopilot
    if autopilot.armed:  # as PX4 it took off by itself
        killed.bench.station.set_mode(Mode.LAND)
        killed.leave(30.0)
    assert [*autopilot.guard.fence.plan.areas]
    with pytest.raises(VehicleError, match="its flight is over"):
        killed.resume()
    assert not [*autopilot.guard.fence.plan.areas]
    [told, *_] = [event.values for event in killed.record.events if event.text == "geofence"]
    for name, value in told["parameters_before"].items():
        assert killed.bench.vehicle.parameters[name] == value
    killed.bench.endpoint._plans.store.replace(PlanKind.FENCE, (FAR_CIRCLE,))
    with pytest.raises(VehicleError, match="somebody else has given the vehicle another geofence since"):
        killed.resume()
    assert killed.bench.endpoint._plans.store.plans[PlanKind.FENCE] == (FAR_CIRCLE,)


def _stands_there(flavour: Flavour, system_id: int, sink: FullDisk) -> Bench:
    """Another vehicle, with a flight's record."""
    other = Bench(None, math.inf, flavour, NO_FAULTS, wind=False)
    other.endpoint = Endpoint(other.vehicle, flavour, system_id=system_id)
    other.endpoint.add_link(LINK)
    other.sink, other.station = sink, Station(other.endpoint)
    return other


def test_another_vehicle_that_answers_is_refused_and_changes_nothing(small: FlightPlan) -> None:
    """Neither is it given the fence of the flight's own one; and that one is known all the same afterwards."""
    killed = Killed(small, Flavour.ARDUPILOT, 24.0, FlightOptions(fence=True))
    for flavour, system_id, link, words in (
        (Flavour.PX4, 1, LinkOptions(), "was one with ArduPilot, and this vehicle flies with PX4"),
        (Flavour.ARDUPILOT, 7, LinkOptions(), "no vehicle of system id 1 was heard, only of 7,"),
        (Flavour.ARDUPILOT, 7, LinkOptions(vehicle_id=7), "was one of system id 1, and this vehicle has 7"),
    ):
        other = _stands_there(flavour, system_id, killed.bench.sink)
        killed.bench, killed.options = other, FlightOptions(fence=True, link=replace(link, connect_s=2.0))
        revision = other.vehicle.parameters.revision
        with pytest.raises((VehicleError, LinkError), match=words):
            killed.resume()
        assert other.vehicle.parameters.revision == revision
    left, contact = unfinished(small, killed.record), Contact(LinkOptions(), needs_origin=False)
    assert (left.record.vehicle["autopilot"], left.system_id) == ("ArduPilot", 1)
    contact.vehicle.version = Version((4, 7, 0), "another")
    with pytest.raises(VehicleError, match="its board has another number"):
        left.check_whose(contact)
