"""The verdict on a flight, whoever flew it: achieved, not achieved, or not to be told, with its reasons."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import groupby
from typing import Final

import numpy as np

from mission.geometry.arrays import BoolArray
from mission.geometry.location import Locator
from mission.geometry.regions import Labelling, union_of
from mission.geometry.simplices import Partition
from mission.logic.automata.conjunction import Conjunction
from mission.logic.automata.rabin import DEAD
from mission.logic.formula.conjuncts import conjuncts
from mission.logic.formula.syntax import Formula
from mission.logic.formula.word import LassoWord
from mission.monitor.flight import laps_asked, laps_of
from mission.monitor.laps import laps_text
from mission.monitor.monitor import Violation, ViolationKind
from mission.plan import FlightPlan, plan_mission
from mission.report.reading import LaterPlan
from mission.spec.camera import spacing_of
from mission.spec.domain import build_domain, restricted_triangles
from mission.spec.model import MissionSpec, Semantics
from mission.spec.moving import moving_of
from mission.spec.restricted import restricted_as_drawn, restricted_that_move
from mission.spec.specification import Specification, deterministic_of, of_mission
from mission.spec.tasks import task_formula, task_text, timed_formula
from mission.verify.flown.covered import CoveredShare, ToCover, covered_shares
from mission.verify.flown.in_time import BoundFlown, Timing, air_time, beginnings, bounds_flown
from mission.verify.flown.nearness import Deviation, Nearness, deviation_of, nearness_of, nearness_of_moving
from mission.verify.flown.possible import Doubt, Entered, Following, Ground, follow
from mission.verify.flown.reach import FASTEST_M_S, Reaches
from mission.verify.logs.track import Track

ALL: Final = "all"
"""In the place of a region: all pictures, wherever they were taken."""

_PATH_STEP_M: Final = 0.1
_UNTOLD: Final = "what it met depends on when its trajectory began, which the log does not tell"
_NOTICED_S: Final = 1.0
"""So late an autopilot that is led no longer brakes; where it flew on for longer, that is where it is found."""


@dataclass(frozen=True)
class Wish:
    """A task with a weight, and whether the flight met it; None where that cannot be told."""

    task: str
    met: bool | None


@dataclass(frozen=True)
class Letter:
    """A letter of the word that was flown, from when on; None in the place of what was flown in a gap."""

    t_s: float
    regions: tuple[str, ...] | None


@dataclass(frozen=True, eq=False)
class Judged:
    """What is known of a flight.

    Attributes:
        achieved: Whether it satisfies the mission; None where that cannot be told.
        reason: Why, in plain words without times.
        at_s: When that was decided, of what happened at one time; None of all else.
        specification: What it was to satisfy, as text.
        word: What it spelled.
        violations: What it did and must not do.
        doubts: Of which times it cannot be told what it did, as far as that makes a difference.
        nearness: How near it came to restricted regions.
        covered: How much it covered of what is to be covered.
        bounds: What became of what is asked for in seconds.
        wishes: What became of tasks that may be given up.
        laps: How many laps it flew for certain, and how many are asked for, None for as many as somebody
            wants; None of a mission that ends.
        pictures: How many pictures were told of over each region that is to be covered, and in ``ALL``.
        deviation: How far it was from the path of a plan; None without one.
        jumps: Times at which the position jumped.
        longest_gap_s: The longest time without a position.
    """

    achieved: bool | None
    reason: str
    at_s: float | None
    specification: str
    word: tuple[Letter, ...]
    violations: tuple[Violation, ...]
    doubts: tuple[Doubt, ...]
    nearness: tuple[Nearness, ...]
    covered: tuple[CoveredShare, ...]
    bounds: tuple[BoundFlown, ...]
    wishes: tuple[Wish, ...]
    laps: tuple[int, int | None] | None
    pictures: dict[str, int]
    deviation: Deviation | None
    jumps: tuple[float, ...]
    longest_gap_s: float


def judged(
    spec: MissionSpec,
    track: Track,
    *,
    plan: FlightPlan | None = None,
    legs: Sequence[LaterPlan] = (),
    fastest_m_s: float = FASTEST_M_S,
) -> Judged:
    """Judge a flight.

    Args:
        spec: The mission.
        track: Where the vehicle was.
        plan: A plan of the mission, for the distance from its path. A mission that recurs is planned where there is
            none, for what a lap is.
        legs: The plans that were flown, where they are known: laps are counted by each while it was flown, as in
            flight; all in the domain of the mission. By default, all was flown by the plan.
        fastest_m_s: No vehicle was faster: what bounds where it may have been in gaps.

    Raises:
        SpecError: The domain cannot be used.
        AutomatonSizeError: The mission asks for an automaton that is too large.
        NoPlanError: The mission recurs and has no plan.
    """
    judge, begins_s = _Judge(spec, track, plan, legs, fastest_m_s), (track.word_from_s, track.began_by_s)
    if judge.moving is None:
        return judge.judged(begins_s)
    latest_s, *others = beginnings(begins_s, judge.moving.fastest_m_s)
    found = judge.judged((latest_s, latest_s))
    agreed = all(judge.judged((t_s, t_s)).achieved is found.achieved for t_s in others)
    return found if agreed else replace(found, achieved=None, reason=_UNTOLD, at_s=None, violations=())


class _Judge:
    def __init__(
        self,
        spec: MissionSpec,
        track: Track,
        plan: FlightPlan | None,
        legs: Sequence[LaterPlan],
        fastest_m_s: float,
    ) -> None:
        self._spec, self._track, self._compared = spec, track, plan
        self._began_s = track.word_from_s, track.began_by_s
        self._partition, self._labelling = _domain(spec, plan)
        self._restricted = restricted_triangles(spec, self._labelling)
        self.moving = moving_of(spec, self._partition, self._labelling)
        self._locator = Locator(self._partition)
        self._reaches = _reaches(spec, track, fastest_m_s)
        self._whole = track.begins_whole and track.ends_whole
        soft = [number for number, task in enumerate(spec.tasks) if task.weight is not None]
        self._required = of_mission(spec, self._labelling.letters, soft) if plan is None else plan.required
        self._automaton = self._automaton_of(self._required)
        # What stays for ever where it is satisfies no mission that recurs.
        recurs = bool(self._automaton.size) and not self._automaton.repeated.any()
        self._legs: Sequence[LaterPlan] = ()
        if recurs:
            self._legs = legs or (LaterPlan(-math.inf, plan or plan_mission(spec), 0),)

    def judged(self, began_s: tuple[float, float]) -> Judged:
        """What is known if the trajectory began between two times."""
        self._began_s = began_s
        found = self._followed(self._automaton, self._restricted)
        covered = covered_shares(self._reaches, self._to_cover(found), whole=self._whole)
        laps = self._laps(found)
        aloft = air_time(self._spec.flight.longest_s, self._track.aloft_s)
        bounds = (*self._in_time(self._required.timed), *aloft)
        achieved, reason, at_s = self._decided(found, covered, laps)
        if achieved is not False and not found.violations:
            achieved, reason = _with_bounds(achieved, reason, bounds)
        jumps = self._reaches.t_s[1:][self._reaches.jumps].tolist()
        return Judged(
            achieved=achieved,
            reason=reason,
            at_s=at_s,
            specification=_text(self._spec, self._required),
            word=self._word(found.entered),
            violations=tuple(found.violations),
            doubts=(*found.doubts, *self._after()),
            nearness=self._nearness(),
            covered=covered,
            bounds=bounds,
            wishes=self._wishes(),
            laps=laps,
            pictures=self._pictures(),
            deviation=self._deviation(),
            jumps=tuple(jumps),
            longest_gap_s=float(self._reaches.gap_s.max(initial=0.0)),
        )

    def _automaton_of(self, required: Specification) -> Conjunction:
        return deterministic_of(required.formula, required.given, self._labelling.letters)

    def _in_time(self, formulas: Sequence[Formula]) -> tuple[BoundFlown, ...]:
        ground = self._ground(self._automaton, self._restricted)
        timing = Timing(self._began_s, self._track.ends_whole, laps=bool(self._legs))
        found = bounds_flown(formulas, ground, self._reaches, timing)
        whole = self._track.begins_whole
        return found if whole else tuple(BoundFlown(each.formula, None, None, None) for each in found)

    def _ground(self, automaton: Conjunction, restricted: BoolArray) -> Ground:
        read = self._labelling, restricted, automaton.whole, self._spec.semantics
        return Ground(self._locator, *read, self.moving, self._began_s[0])

    def _followed(self, automaton: Conjunction, restricted: BoolArray) -> Following:
        ground = self._ground(automaton, restricted)
        return follow(ground, self._reaches, self._track.word_from_s, begins_whole=self._track.begins_whole)

    def _decided(
        self, found: Following, covered: Sequence[CoveredShare], laps: tuple[int, int | None] | None
    ) -> tuple[bool | None, str, float | None]:
        if found.violations:
            first = found.violations[0]
            if first.kind is ViolationKind.LEFT_DOMAIN and first.time_s == self._track.t_s[0]:
                return False, "the flight begins outside of the domain", first.time_s
            named = f" ({', '.join(first.names)})" if first.names else ""
            return False, f"the vehicle {first.kind}{named}", first.time_s
        satisfied, reason = self._ended(found) if laps is None else self._recurred(found, laps)
        short = [share for share in covered if share.enough is False]
        unsure = [share for share in covered if share.enough is None]
        if satisfied is not False and short:
            return False, f"too little of {short[0].region} was covered, {short[0].asked:.1%} is asked", None
        if satisfied and any(doubt.violates for doubt in (*found.doubts, *self._after())):
            return None, "whether it did what must not be done depends on what the log does not tell", None
        if satisfied and unsure:
            return None, f"whether enough of {unsure[0].region} was covered depends on what the log does not tell", None
        return satisfied, reason, None

    def _after(self) -> tuple[Doubt, ...]:
        """What came after the log, where it ends in the air."""
        if self._track.ends_whole:
            return ()
        names = restricted_as_drawn(self._spec, self._partition, self._labelling)
        return (Doubt(float(self._track.t_s[-1]), math.inf, (), tuple(sorted(names)), outside=True),)

    def _ended(self, found: Following) -> tuple[bool | None, str]:
        """Of a flight that stays where it came to rest."""
        if all(state == DEAD for _, state in found.pairs):
            return False, "the word that was flown violates the specification"
        if not self._track.ends_whole:
            return None, "the log ends in the air, and what followed may have satisfied the mission or not"
        letter_of = self._labelling.letter_of
        outcomes = {state != DEAD and bool(self._automaton.repeated[state, letter_of[at]]) for at, state in found.pairs}
        if outcomes == {True}:
            return True, "the word that was flown satisfies the specification"
        if outcomes == {False}:
            return False, "the word that was flown does not satisfy the specification"
        return None, "whether the word that was flown satisfies the specification depends on what the log does not tell"

    def _recurred(self, found: Following, laps: tuple[int, int | None]) -> tuple[bool | None, str]:
        """Of a flight of laps, which no flight completes."""
        flown, asked = laps
        states = {state for _, state in found.pairs}
        if states == {DEAD}:
            return False, "the word that was flown violates the specification"
        counted = laps_text(flown, asked)
        if flown < (1 if asked is None else asked):
            known = self._whole and all(entered.triangle is not None for entered in found.entered)
            return (False, counted) if known else (None, f"{counted} for certain")
        if DEAD in states:
            return None, f"{counted}; whether something was violated depends on what the log does not tell"
        return True, f"{counted}, nothing was violated so far"

    def _laps(self, found: Following) -> tuple[int, int | None] | None:
        if not self._legs:
            return None
        flown, here = 0, None
        for leg, to_s in zip(self._legs, [*(leg.from_s for leg in self._legs[1:]), math.inf], strict=True):
            told = [each.triangle for each in found.entered if leg.from_s <= each.t_s < to_s]
            triangles = [each for each in (here, *told) if each is not None]
            if triangles:
                here = triangles[-1]
                flown = max(flown, self._laps_by(leg, triangles, sure=None not in told))
        return flown, laps_asked(self._legs[-1].plan, self._legs[-1].laps_before)

    def _laps_by(self, leg: LaterPlan, triangles: Sequence[int], *, sure: bool) -> int:
        """How many laps were over for certain when a plan had been flown, from the triangle on in which that begins."""
        counter, standard = (
            laps_of(leg.plan, leg.laps_before, begun=leg.begun),
            self._spec.semantics is Semantics.STANDARD,
        )
        for number, triangle in enumerate(triangles):
            counter.enter(triangle, spells=number > 0 or standard)
        word = tuple(self._labelling.label(triangle) for triangle in triangles[not standard :])
        stays = LassoWord(word, (self._labelling.label(triangles[-1]),))
        return counter.over(satisfied=sure and counter.ends and leg.plan.required.satisfied_by(stays), sure=sure)

    def _word(self, entered: Sequence[Entered]) -> tuple[Letter, ...]:
        skipped = 0 if self._spec.semantics is Semantics.STANDARD else 1
        letters = [
            Letter(
                each.t_s,
                None if each.triangle is None else tuple(sorted(self._labelling.label(each.triangle))),
            )
            for each in entered[skipped:]
        ]
        return tuple(next(same) for _, same in groupby(letters, key=lambda letter: letter.regions))

    def _to_cover(self, found: Following) -> list[ToCover]:
        """Regions that are to be covered and were entered, or may have been."""
        triangles = [each.triangle for each in found.entered if each.triangle is not None]
        surely = {name for triangle in triangles for name in self._labelling.label(triangle)}
        perhaps = {name for doubt in found.doubts for name in doubt.regions}
        regions = []
        for region in self._spec.regions:
            if region.cover is None or region.name not in surely | perhaps:
                continue
            inside = np.zeros(self._partition.size, dtype=np.bool_)
            inside[self._labelling.triangles_of(region.name)] = True
            area = union_of(self._partition, inside & ~self._restricted)
            spacing_m = spacing_of(region.cover, self._spec.flight.altitude_m)
            regions.append(ToCover(region.name, area, spacing_m, region.cover.share, region.name in surely))
        return regions

    def _wishes(self) -> tuple[Wish, ...]:
        """Each task with a weight, by an automaton of its own."""
        wishes = []
        nowhere = np.zeros_like(self._restricted)  # a task is met or not, whatever else was done
        for task in self._spec.tasks:
            if task.weight is None:
                continue
            automaton = deterministic_of(task_formula(task, self._spec.regions), None, self._labelling.letters)
            found = self._followed(automaton, nowhere)
            letter_of = self._labelling.letter_of
            outcomes = {s != DEAD and bool(automaton.repeated[s, letter_of[at]]) for at, s in found.pairs}
            met = next(iter(outcomes)) if self._track.ends_whole and len(outcomes) == 1 else None
            timed = timed_formula(task, self._spec.regions)
            if met is not False and timed is not None:
                met, _ = _with_bounds(met, "", self._in_time(conjuncts(timed)))
            wishes.append(Wish(task_text(task), met))
        return tuple(wishes)

    def _pictures(self) -> dict[str, int]:
        """How many pictures were taken over each region that asks for them; nothing where none were told of."""
        times = np.array([t_s for t_s, _ in self._track.pictures])
        if not len(times):
            return {}
        places = np.column_stack([np.interp(times, self._track.t_s, axis) for axis in self._track.position_m.T])
        at = self._locator.triangle_at(places)
        counts = {
            region.name: int(np.isin(at, self._labelling.triangles_of(region.name)).sum())
            for region in self._spec.regions
            if region.cover is not None
        }
        return {**counts, ALL: len(times)}

    def _nearness(self) -> tuple[Nearness, ...]:
        shapes = restricted_as_drawn(self._spec, self._partition, self._labelling)
        moving = restricted_that_move(self._spec, self._labelling, self.moving)
        still = {name: shape for name, shape in shapes.items() if name not in moving}
        found = nearness_of(self._reaches, still, whole=self._whole)
        if self.moving is None:
            return found
        clock_s, fastest_m_s = np.maximum(self._track.t_s - self._began_s[0], 0.0), self.moving.fastest_m_s
        return (*found, *nearness_of_moving(self._reaches, moving, clock_s, fastest_m_s, whole=self._whole))

    def _deviation(self) -> Deviation | None:
        if self._compared is None:
            return None
        curve = self._compared.trajectory.curve
        points = 2 + int(curve.length_m / _PATH_STEP_M)
        return deviation_of(self._reaches, curve.position(np.linspace(0.0, curve.duration_s, points)))


def _with_bounds(achieved: bool | None, reason: str, bounds: Sequence[BoundFlown]) -> tuple[bool | None, str]:  # noqa: FBT001 - a verdict
    """A verdict that is not false with what became of bounds in seconds."""
    missed = next((bound for bound in bounds if bound.met is False), None)
    if missed is not None:
        when = "" if missed.at_s is None else f", {missed.at_s:.1f} s after the trajectory began"
        return False, f"{missed.formula} was missed{when}"
    untold = next((bound for bound in bounds if bound.met is None), None)
    if achieved and untold is not None:
        return None, f"whether {untold.formula} was kept depends on what the log does not tell"
    return achieved, reason


def _reaches(spec: MissionSpec, track: Track, fastest_m_s: float) -> Reaches:
    """The reports; where nobody led the vehicle, it stopped by the mission's limits, and held like one that is led."""
    ahead = {}
    for t_s, (east, north) in track.left:
        lasts_s = _NOTICED_S + math.hypot(east, north) / (2.0 * spec.limits.acceleration_m_s2)
        ahead[int(np.searchsorted(track.t_s, t_s))] = (east * lasts_s, north * lasts_s)
    ahead = {index: way for index, way in ahead.items() if index < len(track.t_s) - 1}
    aside_m = math.sqrt(2.0) * spec.flight.tube_m
    return Reaches(track.t_s, track.position_m, fastest_m_s, ahead_m=ahead, aside_m=aside_m)


def _domain(spec: MissionSpec, plan: FlightPlan | None) -> tuple[Partition, Labelling]:
    return build_domain(spec) if plan is None else (plan.partition, plan.labelling)


def _text(spec: MissionSpec, required: Specification) -> str:
    return str(required) if spec.tasks or spec.automaton else spec.formula
