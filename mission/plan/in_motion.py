"""Plans on a map that moves.

A path is found on maps that stand still, in which what is to be kept out of is closed wherever it is while the flight
is near, and what is to be gone to is where it is while the flight arrives. When that is shows in the plan itself: what
it meets on the map that moves is closed for that time as well, and what it comes to at another time than was thought is
taken to be there then, until nothing changes. The plan counts only if it is proved on the map that moves.
"""

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from itertools import groupby
from typing import Final

import numpy as np

from mission.errors import NoPlanError
from mission.geometry.simplices import Partition
from mission.logic.automata.automaton import compile_to_alphabet
from mission.logic.formula.operators import Operator
from mission.logic.formula.syntax import postorder
from mission.plan.best_runs import best_runs, objective_of
from mission.plan.carried import carried_path, is_carried
from mission.plan.flight_plan import FlightPlan, prover_of
from mission.plan.heading import looked_toward
from mission.plan.pace import trajectory_of
from mission.plan.passed import run_through
from mission.plan.photographs import along_lanes
from mission.plan.slow_parts import slow_parts
from mission.plan.still_life import Guess, MovingMap, Span, asserted
from mission.plan.time_bounds import followed
from mission.spec.domain import build_domain, restricted_triangles
from mission.spec.model import CORRIDOR, MissionSpec, RegionKind
from mission.spec.moving import moving_of
from mission.spec.specification import of_mission
from mission.steering.touched import MovingTouched
from mission.steering.trajectory import Trajectory

_ROUNDS: Final = 16
_MOST_WAITS: Final = 40
_LATE_S: Final = 1.0
"""By how much a flight may be late, at any time, and still is proved to do what is asked for."""
_AROUND_S: Final = 1.5
"""For how much longer, before and after, what is in the way is taken to be there, and what is gone to."""
_SAMPLE_S: Final = 0.02
_NO_SERIES: Final = (
    "the series of the path of the fields is made for a map that stands still: take `motion` away, or write "
    f"`smoothing: {CORRIDOR}`"
)
_NO_LAPS: Final = (
    "laps are flown again and again, and what moves is somewhere else each time: ask for visits instead, or take "
    "`motion` away"
)

Planned = Callable[[MissionSpec], FlightPlan]
"""Plans a mission that stands still; raises MissionError."""


def planned_in_motion(spec: MissionSpec, planned: Planned) -> FlightPlan:
    """Plan a mission of whose domain a part moves.

    Args:
        spec: The mission.
        planned: Plans a mission on a map that stands still, from the same beginning.

    Raises:
        NoPlanError: No plan is found, or what is asked for is not planned where something moves.
        MissionError: As ``planned`` raises it.
    """
    partition, labelling = build_domain(spec)
    moving = moving_of(spec, partition, labelling)
    if moving is None:
        raise ValueError("nothing moves")
    if spec.smoothing != CORRIDOR:
        raise NoPlanError(_NO_SERIES)
    plan = _Seeker(MovingMap(spec, moving, labelling), partition, planned).plan()
    if is_carried(plan):
        carried_path(plan)  # raises where a triangle of it moves too fast
    return plan


@dataclass(frozen=True, eq=False)
class _Seeker:
    """Looks for a plan.

    Attributes:
        map: What moves.
        partition: Its triangles at first.
        planned: Plans on a map that stands still.
    """

    map: MovingMap
    partition: Partition
    planned: Planned

    def plan(self) -> FlightPlan:
        """The soonest plan of those that are found."""
        first = self._tried(self._first_guess())
        found: list[FlightPlan] = []
        refused: list[NoPlanError] = []
        for way in (self._round, self._after_a_wait):
            try:
                found.append(way(first))
            except NoPlanError as error:
                refused.append(error)
        if not found:
            raise refused[0]
        soonest = min(found, key=lambda plan: plan.trajectory.duration_s)
        times = np.arange(0.0, max(soonest.trajectory.duration_s, self.map.moving.last_s) + _SAMPLE_S, _SAMPLE_S)
        points = self.map.moving.pulled_back(times, soonest.trajectory.position(times))
        run = run_through(points, soonest.locator)
        asked = soonest.spec.semantics, objective_of(soonest.spec)
        product = best_runs(soonest.system, soonest.required, run.states[0], *asked).product
        return replace(
            soonest,
            run=run,
            product_states=product.full_size,
            product_states_reachable=product.reachable_size,
            photographs=along_lanes(soonest.trajectory, soonest.covers),
        )

    def _first_guess(self) -> Guess:
        """What is gone to is where a straight flight would meet it, and what is kept out of is nowhere yet."""
        spec, required = self.map.spec, of_mission(self.map.spec, self.map.labelling.letters)
        if any(node.operator is Operator.NEXT for node in postorder(required.formula)):
            raise NoPlanError("a task counts triangles, and here some move: ask for it without counting")
        ahead, named = asserted(required), {name for task in spec.tasks for name in task.regions}
        closed, met = dict[str, tuple[Span, ...]](), dict[str, Span]()
        for region in self.map.drifting:
            if region.kind is not RegionKind.RESTRICTED and region.name in ahead:
                middle = self.partition.incentres_m[self.map.labelling.triangles_of(region.name)].mean(axis=0)
                way_m = float(np.hypot(*(middle - spec.start.position_m)))
                arrived_s = way_m / spec.flight.speed_m_s
                met[region.name] = (arrived_s, arrived_s + region.loiter_s)
            elif region.kind is not RegionKind.RESTRICTED or region.name in named:
                closed[region.name] = ((0.0, 0.0),)  # what is spoken of is somewhere
        return Guess(closed, met)

    def _round(self, tried: "_Tried") -> FlightPlan:
        """A plan that goes round what is in the way."""
        guesses = [tried.guess]
        while not (_is_kept(tried.plan) and self._stands_over(tried)):
            guesses.append(self._better(tried))
            if guesses[-1] in guesses[:-1] or len(guesses) > _ROUNDS:
                raise NoPlanError(_reason(tried.plan))
            tried = self._tried(guesses[-1])
        return tried.plan

    def _stands_over(self, tried: "_Tried") -> bool:
        """Whether what the vehicle stands still over is below it all that time."""
        held = [region.name for region in self.map.drifting if region.name in tried.guess.met and region.loiter_s]
        return all(self._arrived(tried.still, name, (span := tried.guess.met[name])) == span for name in held)

    def _after_a_wait(self, tried: "_Tried") -> FlightPlan:
        """A plan that waits where it begins until what is in the way is gone."""
        still, plan = tried.still, tried.plan
        slow = slow_parts(still.proofs, still.labelling, still.spec.regions)
        toward_m = looked_toward(still.spec, still.partition, still.labelling)
        wait_s = 0.0
        for _ in range(_MOST_WAITS):
            if _is_kept(plan) and not tried.guess.met:
                return plan
            met = [span for region in self.map.drifting for span in self._met(plan, region.name)]
            if not met or tried.guess.met or wait_s > self.map.moving.last_s:
                break
            wait_s += _AROUND_S + min(end_s - begin_s for begin_s, end_s in met)
            wait = (0.0, wait_s)
            later = trajectory_of(
                still.spec, still.curve, still.stops, None, still.covers, slow=slow, toward_m=toward_m, wait=wait
            )
            plan = self._on_the_map(still, later)
        raise NoPlanError(_reason(plan))

    def _tried(self, guess: Guess) -> "_Tried":
        still = self.planned(self.map.still(guess))
        if still.run.recurrent:
            raise NoPlanError(_NO_LAPS)
        return _Tried(guess, still, self._on_the_map(still, still.trajectory))

    def _on_the_map(self, still: FlightPlan, trajectory: Trajectory) -> FlightPlan:
        """A plan for a map that stood still, on the one that moves, with what is proved there; but for its run."""
        spec, partition, labelling = self.map.spec, self.partition, self.map.labelling
        restricted = restricted_triangles(spec, labelling)
        required = of_mission(spec, labelling.letters, [task.number for task in still.dropped])
        touched = MovingTouched(self.map.moving, restricted, spec.flight.tube_m, followed(trajectory, _LATE_S))
        refutation = compile_to_alphabet(required.refutation, labelling.letters)
        prover = prover_of(spec, partition, labelling, refutation, restricted, touched=touched)
        return replace(
            still,
            spec=spec,
            partition=partition,
            labelling=labelling,
            required=required,
            trajectory=trajectory,
            certificate=prover.certify(trajectory.curve),
            passed_over=(),
            avoidance=None,
        )

    def _better(self, tried: "_Tried") -> Guess:
        """A guess by when a plan meets, and comes to, what moves."""
        closed, met = dict(tried.guess.closed), dict(tried.guess.met)
        for region in self.map.drifting:
            if region.name in met:
                met[region.name] = self._arrived(tried.still, region.name, met[region.name])
                continue
            spans = [(a - _AROUND_S, b + _AROUND_S) for a, b in self._met(tried.plan, region.name)]
            if spans:
                closed[region.name] = tuple(_joined([*closed.get(region.name, ()), *spans]))
        return Guess(closed, met)

    def _met(self, plan: FlightPlan, name: str) -> Iterator[Span]:
        """When the tube of a plan may be in a region, on the map that moves."""
        own = self.map.triangles_of(name)
        yield from _spans(plan, [bool(own[list(each)].any()) for each in plan.certificate.possible])

    def _arrived(self, still: FlightPlan, name: str, guessed: Span) -> Span:
        """When a plan for a map that stood still is in a region for certain, in the middle of that; or as guessed."""
        labels = still.labelling
        inside = [all(name in labels.label(t) for t in each) for each in still.certificate.possible]
        spans = list(_spans(still, inside))
        if not spans:
            return guessed
        begin_s, end_s = spans[0]
        (region,) = (each for each in self.map.spec.regions if each.name == name)
        if inside[-1] and len(spans) == 1:
            begin_s, end_s = still.trajectory.duration_s, np.inf
        elif not region.loiter_s:
            begin_s = end_s = 0.5 * (begin_s + end_s)
        if guessed[0] <= begin_s and end_s <= guessed[1]:
            return guessed
        return begin_s - _AROUND_S, end_s + _AROUND_S


@dataclass(frozen=True, eq=False)
class _Tried:
    """What came of a guess: a plan on a map that stands still, and the same on the one that moves."""

    guess: Guess
    still: FlightPlan
    plan: FlightPlan


def _spans(plan: FlightPlan, marked: list[bool]) -> Iterator[Span]:
    """When the marked pieces of a plan's certificate are flown, those that follow each other as one."""
    begins, ends = followed(plan.trajectory)(plan.certificate.knots_s[:-1], plan.certificate.knots_s[1:])
    for is_marked, group in groupby(range(len(marked)), key=marked.__getitem__):
        first, *others = group
        if is_marked:
            yield float(begins[first]), float(ends[[first, *others][-1]])


def _joined(spans: list[Span]) -> Iterator[Span]:
    """Spans of time, those that overlap as one, ascending."""
    begin_s, end_s = min(spans)
    for a, b in sorted(spans):
        if a > end_s:
            yield begin_s, end_s
            begin_s, end_s = a, b
        end_s = max(end_s, b)
    yield begin_s, end_s


def _is_kept(plan: FlightPlan) -> bool:
    return plan.certificate.holds and all(bound.kept for bound in plan.bounds)


def _reason(plan: FlightPlan) -> str:
    """Why a plan does not count."""
    if not plan.certificate.holds:
        said = f"a vehicle that flies the last one that was tried {plan.certificate.reason}"
        return f"no plan is found that is proved while the map moves; {said}"
    late = "; ".join(bound.text for bound in plan.bounds if not bound.kept)
    return f"no plan is found that keeps its bounds in seconds while the map moves: {late}"
