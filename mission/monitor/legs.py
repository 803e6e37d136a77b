"""The legs of a flight: from one plan to the next, each judged by its own plan, and what comes of them together.

A plan that is made in flight asks for what is left of the mission, so the flight satisfies the mission if its last leg
satisfies what was asked for there, and no leg has violated anything. One plan is taken over from the other at a vehicle
time. Between the reports before and after that, the vehicle is taken to have moved straight.
"""

import math
from collections.abc import Sequence
from dataclasses import replace
from itertools import chain, groupby

import shapely

from mission.logic.automata.rabin import DEAD
from mission.logic.formula.word import LassoWord, Letter
from mission.monitor.air_time import AirWatch
from mission.monitor.coverage import CoverageWatch, Covered, together
from mission.monitor.flight import FlightMonitor
from mission.monitor.laps import laps_text
from mission.monitor.monitor import Foreseen, Outcome, Violation
from mission.monitor.stage import Stage
from mission.monitor.time_bounds import BoundNow
from mission.plan import FlightPlan
from mission.plan.photographs import planned_pictures
from mission.spec.model import Point
from mission.steering.trajectory import Trajectory


class FlightLeg:
    """What is flown by one plan.

    Attributes:
        plan: What is flown.
        from_s: Vehicle time from which it is; minus infinity for the first.
        laps_before: How many laps were flown before, with the one that is under way when the leg begins.
        judged: What of it counts.
        coverage: What of it covers.
        in_tube_until_s: Up to which time of the trajectory the vehicle was in the tube all the while; None before it is
            flown.
        has_left_tube: Whether it was outside once.
        given_up: The leg whose mission was given up for a return, of which this is; None where none was.
        laps_asked: How many laps the whole flight was to have; None where nobody has said.
    """

    def __init__(
        self,
        plan: FlightPlan,
        from_s: float,
        laps_before: int,
        *,
        begun: bool = False,
        given_up: "FlightLeg | None" = None,
        laps_asked: int | None = None,
    ) -> None:
        """Watch a leg that begins after so many laps, the last of which may have been begun only."""
        self.plan, self.from_s, self.laps_before, self._begun = plan, from_s, laps_before, begun
        self.given_up, self.laps_asked = given_up, laps_asked
        self.judged = FlightMonitor(plan, laps_before, begun=begun)
        self.coverage = CoverageWatch(plan, laps_before)
        self.in_tube_until_s: float | None = None
        self.has_left_tube = False

    def keep(self, trajectory_s: float, *, in_tube: bool) -> None:
        """Take note of whether the vehicle was in the tube at a time on the trajectory."""
        self.has_left_tube |= not in_tube
        if not self.has_left_tube:
            self.in_tube_until_s = trajectory_s

    def laps_at(self, foreseen: Foreseen, flown_s: float | None) -> tuple[int, tuple[Letter, ...] | None]:
        """How many laps are over, and what one that is under way has not met; None where none is.

        Args:
            foreseen: What was spelled.
            flown_s: How much of the trajectory was flown; None where that is not known.
        """
        trajectory = self.plan.trajectory
        if flown_s is not None and flown_s < trajectory.laps_end_s and not trajectory.lap_at([flown_s])[0]:
            # Regions of the lap that are met on the way to it are no part of it.
            return self.laps_before - int(self._begun), () if self._begun else None
        over = trajectory.laps is not None and foreseen.laps >= self.laps_before + trajectory.laps
        return foreseen.laps, None if over and self.plan.run.recurrent else foreseen.lap_due

    def is_clear(self, place_m: Point) -> bool:
        """Whether the tube about a place touches nothing that must not be entered, as far as the word has come.

        What moves is taken to stand where it was at the last report.
        """
        plan, (x, y), half_m = self.plan, place_m, self.plan.certificate.tube_m
        box = shapely.box(x - half_m, y - half_m, x + half_m, y + half_m)
        state, touched = self.judged.monitor.known.state, self.judged.monitor.meeting(box)
        if state == DEAD or plan.locator.leaves(box):
            return False
        dead = plan.deterministic.targets[state, plan.labelling.letter_of[touched]] == DEAD
        return not bool((plan.restricted[touched] | dead).any())

    def leads_on(self, places_m: Sequence[Point]) -> bool:
        """Whether a way, from where the vehicle is to where the plan ends, does what is left of the mission."""
        foreseen = self.judged.monitor.foreseen(places_m)
        if not self.is_clear(places_m[0]) or foreseen.state == DEAD or not foreseen.word:
            return False
        return self.plan.run.recurrent or self.plan.required.satisfied_by(LassoWord(foreseen.word, foreseen.word[-1:]))


class FlightLegs:
    """The legs of one flight, in the order of time.

    Attributes:
        legs: Those that have begun, at least the first.
    """

    def __init__(self, plan: FlightPlan) -> None:
        """Watch the first from the ground."""
        self.legs = [FlightLeg(plan, -math.inf, 0, laps_asked=plan.trajectory.laps)]
        self._next: list[FlightLeg] = []
        self._last: tuple[float, Point] | None = None
        self._aloft = AirWatch(plan.spec.flight.longest_s)

    @property
    def now(self) -> FlightLeg:
        """The leg that is flown."""
        return self.legs[-1]

    def take_over(
        self,
        plan: FlightPlan,
        at_s: float,
        laps_before: int,
        *,
        begun: bool = False,
        returns: bool = False,
        fresh: bool = False,
        amended: bool = False,
    ) -> None:
        """Let another plan be flown from a vehicle time on, after so many laps.

        Args:
            plan: What is flown from then on.
            at_s: When.
            laps_before: How many laps were flown.
            begun: Whether the last of them was begun only.
            returns: Whether what is left of the mission is given up for it.
            fresh: Whether it asks for something else than what was asked for before.
            amended: Whether the mission was amended for it, its laps maybe.
        """
        before = (self._next or self.legs)[-1]
        given_up = None if fresh else before.given_up or (before if returns else None)
        asked, laps = before.laps_asked, plan.trajectory.laps if plan.run.recurrent else 0
        if amended:
            asked = None if laps is None else laps_before + laps
        self._next.append(FlightLeg(plan, at_s, laps_before, begun=begun, given_up=given_up, laps_asked=asked))

    def report(self, stage: Stage | None, t_s: float, position_m: Point, trajectory_s: float | None = None) -> None:
        """Take a position into account that was reported in a stage, and at a time on the trajectory of the plan."""
        while self._next and t_s >= self._next[0].from_s:
            leg = self._next.pop(0)
            at_s, at_m = max(leg.from_s, t_s if self._last is None else self._last[0]), position_m
            if self._last is not None and t_s > self._last[0]:
                share = (at_s - self._last[0]) / (t_s - self._last[0])
                at_m = (
                    self._last[1][0] + share * (position_m[0] - self._last[1][0]),
                    self._last[1][1] + share * (position_m[1] - self._last[1][1]),
                )
            self.now.judged.report(stage, at_s, at_m)
            self.legs.append(leg)
            leg.judged.report(Stage.FLY, at_s, at_m)
        self._last = (t_s, position_m)
        self._aloft.report(stage, t_s)
        self.now.judged.report(stage, t_s, position_m)
        if trajectory_s is not None:
            self.now.coverage.report(t_s, trajectory_s, position_m)

    @property
    def word(self) -> tuple[frozenset[str], ...]:
        """The letters that were spelled."""
        return tuple(chain.from_iterable(leg.judged.monitor.word for leg in self.legs))

    @property
    def bounds(self) -> tuple[BoundNow, ...]:
        """What is known of what is asked for in seconds: by the plan that is flown, and of the whole flight."""
        return (*self.now.judged.monitor.bounds, *self._aloft.now)

    @property
    def violations(self) -> tuple[Violation, ...]:
        """What must not be and was, in the order of time."""
        return tuple(chain.from_iterable(leg.judged.monitor.violations for leg in self.legs))

    @property
    def laps(self) -> int:
        """How many laps were flown."""
        return max(leg.judged.monitor.laps for leg in self.legs)

    @property
    def given_up(self) -> FlightLeg | None:
        """The leg whose mission was given up for a return, in the plan that was taken over last."""
        return (self._next or self.legs)[-1].given_up

    @property
    def undone(self) -> str:
        """What a return has left undone, in plain words; empty where nothing was given up."""
        left = self.given_up
        if left is None:
            return ""
        flown = frozenset[str]().union(*self.word)
        asked = dict.fromkeys(chain.from_iterable(map(sorted, left.plan.certificate.word)))
        missed = [name for name in asked if name not in flown]
        counted = left.judged.monitor.progress
        steps = f"{counted.done} of {counted.total} steps done" if counted.total and not left.plan.run.recurrent else ""
        named = f"left undone: {', '.join(missed)}" if missed else ""
        return "; ".join(filter(None, ("returned before all was done", steps, named)))

    def _outcome_of_return(self, left: FlightLeg) -> Outcome:
        """The verdict on a mission that was given up for a return: on what was flown of it, and the way home."""
        if left.plan.run.recurrent:
            return left.judged.monitor.outcome(stays=False)
        parts = [leg.judged.monitor.word for leg in self.legs[self.legs.index(left) :]]
        word = tuple(letter for letter, _ in groupby(chain.from_iterable(parts)))
        if not left.plan.required.timed and left.plan.required.satisfied_by(LassoWord(word, word[-1:])):
            return Outcome(achieved=True, reason="the word that was flown satisfies the specification all the same")
        return Outcome(achieved=False, reason="the mission was given up for a return")

    def outcome(self) -> Outcome:
        """The verdict on the flight as if it ended now."""
        return self._aloft.judged(self._outcome_of_words())

    def _outcome_of_words(self) -> Outcome:
        broken = [leg for leg in self.legs if leg.judged.monitor.violations]
        if not broken and self.now.given_up is not None:
            return self._outcome_of_return(self.now.given_up)
        leg = broken[0] if broken else self.now
        outcome = leg.judged.monitor.outcome(stays=not leg.plan.run.recurrent)
        returned = leg.laps_before > 0 and not leg.plan.run.recurrent
        if not returned:
            return outcome
        laps, asked = leg.judged.monitor.laps, leg.laps_asked
        achieved = outcome.achieved and laps >= (asked or 0)
        return Outcome(achieved, f"{laps_text(laps, asked)}; {outcome.reason}")

    def covered(self, laps: int | None) -> tuple[Covered, ...]:
        """What was covered, visit by visit; of the last plan with so many laps."""
        return together([leg.coverage.covered(self._trajectory_of(leg, laps)) for leg in self.legs])

    def _trajectory_of(self, leg: FlightLeg, laps: int | None) -> Trajectory:
        trajectory = leg.plan.trajectory
        if leg is self.now:
            return replace(trajectory, laps=laps)
        return trajectory.ended_after(leg.coverage.flown_s) if trajectory.laps is None else trajectory

    def planned_pictures(self) -> int:
        """How many pictures the plans have, as far as each was flown."""
        before = sum(_pictures_until(leg.plan, leg.coverage.flown_s) for leg in self.legs[:-1])
        return before + self.now.plan.planned_pictures


def _pictures_until(plan: FlightPlan, to_s: float) -> int:
    """How many pictures a plan has before a time on its trajectory; of laps, those of the laps that are begun."""
    trajectory = plan.trajectory.ended_after(to_s)
    once_s = to_s if trajectory.lap is None else math.inf
    flown = [replace(each, end_s=min(each.end_s, once_s)) for each in plan.photographs if each.begin_s < once_s]
    return planned_pictures(trajectory, flown)
