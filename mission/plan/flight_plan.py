"""The plan of a flight: everything that was decided, and the proof; what flying, drawing and checking start from."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
import shapely

from mission.geometry.arrays import BoolArray, IntArray
from mission.geometry.location import Locator
from mission.geometry.moving import MovingPartition
from mission.geometry.regions import Labelling, union_of
from mission.geometry.simplices import Partition
from mission.logic.automata.automaton import BuchiAutomaton, CompiledAutomaton, compile_to_alphabet
from mission.logic.automata.combination import union
from mission.logic.automata.conjunction import Conjunction
from mission.logic.automata.rabin import Rabin
from mission.logic.formula.syntax import TRUE, Formula
from mission.plan.air_time import AirTime
from mission.plan.cautions import cautions, flight_cautions, window_cautions
from mission.plan.closings import Closing, closings
from mission.plan.costs import UNIT, transition_weights
from mission.plan.covering import SHARE_TO_SPARE, CoveredVisit
from mission.plan.detour import Avoidance
from mission.plan.homeward import Homeward, ends_of_flight
from mission.plan.landing import little_room_to_land
from mission.plan.photographs import Photographs, planned_pictures
from mission.plan.proved_run import PassedOver
from mission.plan.tasks import DroppedTask
from mission.plan.time_bounds import TimeBound, behaviour_flown, bounds_of, met_at_rest
from mission.plan.way import Way
from mission.planning.run import Run
from mission.planning.transition_system import TransitionSystem
from mission.spec.domain import restricted_triangles
from mission.spec.loss import cut_off, out_of_reach
from mission.spec.model import FIELD, MissionSpec, Point
from mission.spec.moving import moving_of
from mission.spec.specification import Specification, deterministic_of
from mission.steering.certificate import Certificate
from mission.steering.joined import JoinedCurve
from mission.steering.path import SteeringPath
from mission.steering.polyline import Polyline
from mission.steering.prover import Prover
from mission.steering.touched import Touched
from mission.steering.trajectory import Trajectory

_NO_WAY_BACK = (
    "the flight ends where its laps do: no way back to where it may end is proved to violate nothing; "
    "a region of kind `home` that can be reached would be one"
)
_ONE_ORDER = "the tasks that recur are too many to try every order: the loop is the best in one order of them"


@dataclass(frozen=True, eq=False)
class FlightPlan:
    """One planned flight.

    Attributes:
        spec: The mission.
        start_m: Where the flight begins, ENU in the domain.
        partition: The domain's triangles.
        labelling: Their labels.
        required: What the flight satisfies: the mission's formula or automaton and its tasks, but for those that were
            dropped.
        product_states: Number of states of the product, reachable or not.
        product_states_reachable: How many of them can be reached from the start.
        shortest_runs: How many runs have the least cost.
        best_in_any_order: Whether no other order of the tasks that recur has a better run; False where they are too
            many for an exact search.
        run_index: Which of them is flown.
        run: The run that is flown: the triangles that the curve passes. Where fields steer, it is that of the search.
        costs: What the prefix of the run of the search and one round of its loop cost, in the unit of the mission's
            costs.
        path: What is smoothed: the path of the fields that steer through it, or the shortest path that does what it
            does; of a recurrent run, the way to the lap, the lap, and the way back.
        stops: Pairs (curve parameter, seconds) at which the vehicle loiters.
        trajectory: The smoothed path with its time law.
        certificate: The proof that every flight within the tube satisfies it; of a recurrent run, that it does if the
            lap is repeated for ever.
        dropped: The soft tasks that could not be met, in the order of the file.
        homeward: The way back of a recurrent run; None where there is none on which nothing is violated.
        passed_over: The shortest runs that were tried before the one that is flown, and were not proved.
        avoidance: What the run that is flown, and the shortest ones that are counted, keep out of, as no run through it
            is proved; None where it is one of the best.
        covers: Where regions are covered by lanes, in the order of the path.
        photographs: The stretches of the trajectory in which pictures are taken, in order.
        way: The shortest way in the plane that the run goes along; None where the best runs were searched in T.
        instead: Why the path of the fields is flown where a curve in a corridor was asked for; empty where it was not.
        onward: The velocity and the acceleration with which the flight begins, ENU; None where it begins at rest.
    """

    spec: MissionSpec
    start_m: Point
    partition: Partition
    labelling: Labelling
    required: Specification
    product_states: int
    product_states_reachable: int
    shortest_runs: int
    best_in_any_order: bool
    run_index: int
    run: Run
    costs: tuple[float, float]
    path: SteeringPath | Polyline
    stops: tuple[tuple[float, float], ...]
    trajectory: Trajectory
    certificate: Certificate
    dropped: tuple[DroppedTask, ...] = ()
    homeward: Homeward | None = None
    passed_over: tuple[PassedOver, ...] = ()
    avoidance: Avoidance | None = None
    covers: tuple[CoveredVisit, ...] = ()
    photographs: tuple[Photographs, ...] = ()
    way: Way | None = None
    instead: str = ""
    onward: tuple[Point, Point] | None = None

    @cached_property
    def planned_pictures(self) -> int:
        """How many pictures a flight takes that keeps to the trajectory."""
        return planned_pictures(self.trajectory, self.photographs)

    @cached_property
    def bounds(self) -> tuple[TimeBound | AirTime, ...]:
        """What is asked for in seconds, with the margins of every flight within the tube."""
        aloft = AirTime.of(self.spec.flight, self.trajectory.duration_s)
        met = met_at_rest(self.trajectory, self.certificate, self.locator, self.moving)
        in_place = bounds_of(self.required.timed, self.trajectory, self.certificate, met, self.labelling)
        return (*in_place, *(() if aloft is None else (aloft,)))

    @cached_property
    def closings(self) -> tuple[Closing, ...]:
        """The restricted regions that are there for a time only, and when a flight that is not late may be in them."""
        if not self.required.timed:
            return ()
        met = met_at_rest(self.trajectory, self.certificate, self.locator, self.moving)
        flown = behaviour_flown(self.trajectory, self.certificate, met, self.labelling)
        return closings(self.required.timed, flown)

    @property
    def specification(self) -> str:
        """What the flight satisfies as text: a formula as it was written, where the mission has no tasks."""
        return str(self.required) if self.spec.tasks or self.spec.automaton else self.spec.formula

    @property
    def written(self) -> tuple[tuple[str, str], ...]:
        """The same in parts, of kind ``automaton`` or ``formula``, each with its text."""
        if self.spec.automaton is None:
            return (("formula", self.specification),)
        return (
            ("automaton", self.spec.automaton.file),
            *([("formula", str(self.formula))] * (self.formula is not TRUE)),
        )

    @property
    def formula(self) -> Formula:
        """The formula that the flight satisfies; true where the mission is an automaton alone."""
        return self.required.formula

    @property
    def automaton(self) -> BuchiAutomaton:
        """A Büchi automaton of what the flight satisfies."""
        return self.required.automaton

    @property
    def shown_parts(self) -> int:
        """Of how many parts, all of which must accept, the automaton that is shown is; 1 where it is that of all."""
        return len(self.required.shown)

    @cached_property
    def shown_automaton(self) -> BuchiAutomaton:
        """The automaton for readers: that of all that the flight satisfies, or its parts side by side."""
        return union(*self.required.shown)

    @property
    def proofs(self) -> tuple[Certificate, ...]:
        """Of the whole curve, one after the other."""
        return (self.certificate, *((self.homeward.certificate,) if self.homeward else ()))

    @property
    def curve(self) -> JoinedCurve:
        """The smoothed path, each leg once."""
        return self.trajectory.curve

    @cached_property
    def leg_starts_s(self) -> tuple[float, ...]:
        """Where on the curve its legs begin: a triangle each where fields steer, from rest to rest in a corridor."""
        if isinstance(self.path, SteeringPath):
            return tuple(segment.start_s for segment in self.path.segments)
        return tuple(self.curve.joints_s[:-1].tolist())

    @cached_property
    def system(self) -> TransitionSystem:
        """T of this domain, its restricted triangles closed, with the mission's costs."""
        weights = transition_weights(self.partition, self.spec.search.cost, self.spec.flight.speed_m_s)
        return TransitionSystem.from_partition(self.partition, self.labelling, self.restricted, weights)

    @property
    def successors(self) -> IntArray:
        """The transition map of T, shape (M, 4)."""
        return self.system.successors

    @cached_property
    def restricted(self) -> BoolArray:
        """Triangles that must never be entered, shape (M,)."""
        return restricted_triangles(self.spec, self.labelling)

    def area_of(self, region: str) -> shapely.Geometry:
        """What of a region may be entered, as a polygon or several, metres."""
        inside = np.zeros(self.partition.size, dtype=np.bool_)
        inside[self.labelling.triangles_of(region)] = True
        return union_of(self.partition, inside & ~self.restricted)

    @cached_property
    def locator(self) -> Locator:
        """Point location in the domain."""
        return Locator(self.partition)

    @cached_property
    def moving(self) -> MovingPartition | None:
        """How the triangles move, by the clock of the trajectory; None where all of them stand still."""
        return moving_of(self.spec, self.partition, self.labelling)

    @cached_property
    def warnings(self) -> tuple[str, ...]:
        """What the writer of the mission may not have meant, in words; empty where nothing is odd."""
        start = int(self.labelling.letter_of[self.run.states[0]])
        return (
            *cut_off(self.spec),
            *out_of_reach(self.spec, self.start_m),
            *flight_cautions(self.spec.flight, self.spec.limits),
            *window_cautions(self.spec.regions),
            *self._about_landing,
            *cautions(self.required, self.labelling.letters, start, self.spec.semantics, self._covered),
            *((f"the path of the fields is flown: {self.instead}",) if self.instead else ()),
            *((self._passing_over,) if self.passed_over else ()),
            *((_ONE_ORDER,) if not self.best_in_any_order else ()),
            *(_too_little(visit) for visit in self.covers if visit.planned_share < visit.share + SHARE_TO_SPARE),
            *((_NO_WAY_BACK,) if self.run.recurrent and not self._returns else ()),
        )

    @property
    def asked_run(self) -> int | None:
        """The number of the run that was asked for instead of the mission's own choice; None where that was left."""
        return None if self.passed_over or self.run_index == self.spec.run else self.run_index

    @property
    def landing_m(self) -> float | None:
        """How far the landing is proved to be able to drift; None where it is not known where the flight ends."""
        return None if self.run.recurrent and self.homeward is None else self.proofs[-1].landing_m

    @property
    def _about_landing(self) -> tuple[str, ...]:
        flight, landing_m = self.spec.flight, self.landing_m
        little = "" if landing_m is None or flight.guidance == FIELD else little_room_to_land(flight, landing_m)
        return (little,) if little else ()

    @property
    def _covered(self) -> frozenset[str]:
        return frozenset(visit.region for visit in self.covers)

    @property
    def _passing_over(self) -> str:
        first, more = self.passed_over[0], len(self.passed_over) - 1
        if self.avoidance is not None:
            return (
                f"no best run is flown, for {'none' if more else 'the one'} that was tried is "
                f"{'' if more else 'not '}proved: {first.reason}; the run that is flown is a best one without "
                f"{self.avoidance.listed} and costs {self._dearer(self.avoidance)}"
            )
        others = f" and {more} others" if more > 1 else f" and run {self.passed_over[-1].index}" * more
        return (
            f"run {self.run_index} of the {self.shortest_runs} shortest is flown; run {first.index}{others} "
            f"{'were' if more else 'was'} passed over for want of a proof: {first.reason}"
        )

    def _dearer(self, avoidance: Avoidance) -> str:
        """What the run that is flown costs, beside the best ones."""
        cost = self.spec.search.cost
        unit = UNIT[cost][0] or str(cost)
        parts = zip(("up to the loop", "round it"), avoidance.best_costs, self.costs, strict=True)
        return " and ".join(
            f"{now:.12g} instead of {best:.12g} {unit} {part}" for part, best, now in parts if now != best
        )

    @property
    def _returns(self) -> bool:
        ends = ends_of_flight(self.spec, self.labelling, self.restricted, self.run.states[0])
        return self.homeward is not None and bool(ends[self.homeward.run.suffix[0]])

    @cached_property
    def deterministic(self) -> Rabin:
        """A deterministic automaton of what the flight satisfies, over the letters of the domain."""
        return self.conjunction.whole

    @cached_property
    def conjunction(self) -> Conjunction:
        """The deterministic automata whose product that is."""
        return deterministic_of(self.required.formula, self.required.given, self.labelling.letters)

    @cached_property
    def compiled_parts(self) -> tuple[CompiledAutomaton, ...]:
        """An automaton of each conjunct, over the letters of the domain."""
        return tuple(compile_to_alphabet(part, self.labelling.letters) for part in self.required.automata)

    @cached_property
    def compiled_refutation(self) -> CompiledAutomaton:
        """The automaton of what the flight must not be, over the letters of the domain."""
        return compile_to_alphabet(self.required.refutation, self.labelling.letters)


def _too_little(visit: CoveredVisit) -> str:
    if visit.planned_share >= visit.share:
        return (
            f"the lanes cover {visit.planned_share:.1%} of {visit.region}, hardly more than the {visit.share:.1%} that "
            f"`regions.{visit.region}.cover.share` asks for: what wind carries the vehicle off its lanes may be too "
            f"much; a narrower tube or clearance, or wider lanes, cover more"
        )
    return (
        f"the lanes cover {visit.planned_share:.1%} of {visit.region}, less than the {visit.share:.1%} that "
        f"`regions.{visit.region}.cover.share` asks for: nothing is covered where the tube and the "
        f"clearance reach, nor where the mission forbids to be"
    )


def prover_of(
    spec: MissionSpec,
    partition: Partition,
    labelling: Labelling,
    refutation: CompiledAutomaton,
    restricted: BoolArray,
    *,
    touched: Touched | None = None,
) -> Prover:
    """The prover of a mission with its tube."""
    return Prover(
        partition,
        labelling,
        refutation=refutation,
        semantics=spec.semantics,
        restricted=restricted,
        tube_m=spec.flight.tube_m,
        landing_m=spec.flight.landing_m,
        touched=touched,
    )
