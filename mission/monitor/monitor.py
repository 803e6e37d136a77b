"""The word that a vehicle really spells, from the positions that it reports, and what that word is worth.

Between two reports the vehicle is taken to have moved straight, so no triangle is skipped. Letters follow the same
rule as the certificate's: one for each triangle that is entered; the label of the first triangle is read under the
standard semantics only; at the end of a flight that stays, the last label repeats for ever.

Where triangles move, each position is taken back to the point of the fixed triangles of which it is the image then, by
a clock that begins with the first position that counts; between two reports it is there that the vehicle is taken to
have moved straight. Until then all stands where it begins.
"""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from enum import StrEnum
from itertools import pairwise

import numpy as np
import shapely

from mission.geometry.arrays import BoolArray, IntArray
from mission.geometry.location import OUTSIDE, Locator
from mission.geometry.moving import MovingPartition
from mission.geometry.regions import Labelling
from mission.logic.automata.automaton import CompiledAutomaton
from mission.logic.automata.rabin import Rabin
from mission.logic.formula.syntax import Formula
from mission.logic.formula.word import LassoWord, Letter
from mission.monitor.laps import Laps, laps_text
from mission.monitor.time_bounds import BoundNow, BoundWatch
from mission.monitor.verdict import FormulaWatch, Progress, Verdict
from mission.spec.model import Point, Semantics


@dataclass(frozen=True)
class Visit:
    """A triangle that the vehicle entered, and when."""

    triangle: int
    entered_s: float


@dataclass(frozen=True)
class Whereabouts:
    """Where a flight is, in the domain and in the automaton of its specification.

    Attributes:
        triangle: The last one that was entered.
        state: Of the automaton; -1 where it has no run on the word.
        due: For each pair of its condition the marks that the present round has not met.
        laps: How many rounds are over.
    """

    triangle: int
    state: int
    due: tuple[int, ...]
    laps: int


@dataclass(frozen=True)
class Foreseen:
    """A word, and where the automaton of the specification is after it.

    Attributes:
        word: Its letters.
        state: As in ``Whereabouts``.
        due: Likewise.
        laps: How often the loop was flown.
        lap_due: The labels that the lap under way has not met; None where none is under way.
    """

    word: tuple[frozenset[str], ...]
    state: int
    due: tuple[int, ...]
    laps: int
    lap_due: tuple[Letter, ...] | None = None

    def agrees(self, other: "Foreseen") -> bool:
        """Whether what is left after both is the same."""
        return (self.state, self.due, self.laps, self.lap_due) == (other.state, other.due, other.laps, other.lap_due)


class ViolationKind(StrEnum):
    """What a flight must never do, whatever its specification says."""

    LEFT_DOMAIN = "left the domain"
    ENTERED_RESTRICTED = "entered a restricted region"


@dataclass(frozen=True)
class Violation:
    """Something that happened and must not.

    Attributes:
        kind: What.
        time_s: When, on the clock of the reports.
        position_m: Where it began, ENU.
        names: Labels of the triangle that was entered; empty outside the domain.
    """

    kind: ViolationKind
    time_s: float
    position_m: Point
    names: tuple[str, ...]


@dataclass(frozen=True)
class Outcome:
    """The verdict on a finished flight, with its reason in plain words."""

    achieved: bool
    reason: str


class Monitor:
    """Watches one flight. It has no clock: the time of a report is an argument.

    Args:
        locator: Point location in the domain.
        labelling: Labels of the domain.
        satisfied_by: Whether a word satisfies the specification, by its definition.
        automata: Of the conjuncts of the specification, over ``labelling.letters``.
        whole: Of all of it, over the same, each of its states accepting something.
        refutation: Of the words that do not satisfy it, over the same.
        semantics: Whether the label of the first triangle is read.
        restricted: Shape (M,), triangles that must not be entered.
        counter: What counts laps; by default, of a flight that ends in a stay.
        laps: How many are to be flown in all; None where nobody has said.
        timed: Formulas with bounds in seconds, which the specification has beside that.
        moving: How the triangles move; None where all of them stand still.
    """

    def __init__(
        self,
        locator: Locator,
        labelling: Labelling,
        *,
        satisfied_by: Callable[[LassoWord], bool],
        automata: Sequence[CompiledAutomaton],
        whole: Rabin,
        refutation: CompiledAutomaton,
        semantics: Semantics,
        restricted: BoolArray,
        counter: Laps | None = None,
        laps: int | None = 0,
        timed: Sequence[Formula] = (),
        moving: MovingPartition | None = None,
    ) -> None:
        self._locator, self._labelling, self._moving = locator, labelling, moving
        self._satisfied_by, self._semantics = satisfied_by, semantics
        self._restricted = restricted
        self._watch = FormulaWatch(automata, whole, refutation, labelling.letters)
        self._laps, self._laps_asked = counter or Laps(whole, labelling), laps
        self._in_time = BoundWatch(timed)
        self._began_s = math.inf
        self._last: tuple[float, Point, Point] | None = None
        """Time and place of the last report, and which point of the fixed triangles that was."""
        self._inside = True
        self._visits: list[Visit] = []
        self._violations: list[Violation] = []

    def observe(self, t_s: float, position_m: Point) -> bool:
        """Take a reported position into account.

        Args:
            t_s: Time of the report, on any clock that does not run backwards.
            position_m: Position in the domain, ENU.

        Returns:
            False where the report was left out: not finite, or not later than the last one.
        """
        place = (float(position_m[0]), float(position_m[1]))
        if not all(map(math.isfinite, (t_s, *place))) or (self._last is not None and t_s <= self._last[0]):
            return False
        self._began_s = min(self._began_s, t_s)
        point = self._fixed(t_s, (place,))[0]
        before, start, begin = self._last or (t_s, place, point)
        likely = self._visits[-1].triangle if self._visits else OUTSIDE
        for triangle, fraction in self._locator.crossed(begin, point, likely=likely):
            at = (start[0] + fraction * (place[0] - start[0]), start[1] + fraction * (place[1] - start[1]))
            self._enter(triangle, before + fraction * (t_s - before), at)
        self._last = (t_s, place, point)
        return True

    def guard(self, t_s: float, position_m: Point) -> None:
        """Take a position into account that spells nothing yet, but must not be outside or in a restricted region.

        Before the word begins the vehicle climbs and settles where the flight starts; it may do no wrong there either.
        """
        place = (float(position_m[0]), float(position_m[1]))
        if not all(map(math.isfinite, (t_s, *place))) or self._violations:
            return
        triangle = int(self._locator.triangle_at(np.array(self._fixed(t_s, (place,))))[0])
        if triangle == OUTSIDE:
            self._violations.append(Violation(ViolationKind.LEFT_DOMAIN, t_s, place, ()))
        elif self._restricted[triangle]:
            names = tuple(sorted(self._labelling.label(triangle)))
            self._violations.append(Violation(ViolationKind.ENTERED_RESTRICTED, t_s, place, names))

    @property
    def visits(self) -> tuple[Visit, ...]:
        """The triangles entered so far, in order."""
        return tuple(self._visits)

    @property
    def violations(self) -> tuple[Violation, ...]:
        """Each departure from the domain and each entry into a restricted triangle."""
        return tuple(self._violations)

    @property
    def word(self) -> tuple[frozenset[str], ...]:
        """The letters spelled so far."""
        skipped = 0 if self._semantics is Semantics.STANDARD else 1
        return tuple(self._labelling.label(visit.triangle) for visit in self._visits[skipped:])

    @property
    def verdict(self) -> Verdict:
        """What is known of every continuation of the flight; false too after a violation."""
        return Verdict.FALSE if self._violations else self._watch.verdict

    @property
    def progress(self) -> Progress:
        """How far the automata of the specification have come."""
        return self._watch.progress

    @property
    def laps(self) -> int:
        """How often the loop of a recurrent run has been flown."""
        return self._laps.over(satisfied=self._laps.ends and self.verdict_at_end(stays=True).achieved)

    @property
    def bounds(self) -> tuple[BoundNow, ...]:
        """What is known of what is asked for in seconds."""
        return () if self._last is None else self._in_time.now(self._last[0])

    @property
    def whereabouts(self) -> Whereabouts | None:
        """Where the flight is; None before its word begins, and outside the domain."""
        if not self._visits or not self._inside:
            return None
        rounds = self._laps.rounds
        return Whereabouts(self._visits[-1].triangle, rounds.state, rounds.due, rounds.laps)

    def foreseen(self, places_m: Sequence[Point]) -> "Foreseen":
        """What the word would be, and the automaton's state, if the vehicle flew straight through places in order.

        What moves is taken to stand where it was at the last report.
        """
        laps, letters = self._laps.copy(), list(self.word)
        last = self._visits[-1].triangle if self._visits else OUTSIDE
        for start, end in pairwise(self._fixed(self._now_s, places_m)):
            for triangle, _ in self._locator.crossed(start, end, likely=last):
                if triangle not in (last, OUTSIDE):
                    letters.append(self._labelling.label(triangle))
                    last = triangle
                    laps.enter(triangle)
        return _foreseen(tuple(letters), laps)

    def meeting(self, area: shapely.Geometry) -> IntArray:
        """The triangles that have a point in common with an area, as they were at the last report, ascending."""
        if self._moving is None:
            return self._locator.meeting(area)
        corners_m = self._moving.at(self._clock_s(self._now_s)).corners_m
        return np.flatnonzero(shapely.intersects(shapely.polygons(corners_m), area))

    @property
    def known(self) -> "Foreseen":
        """The word so far, and the automaton's state."""
        return _foreseen(self.word, self._laps)

    def outcome(self, *, stays: bool) -> Outcome:
        """The verdict on the flight as if it ended now, its bounds in seconds among what it has to keep.

        Args:
            stays: As in ``verdict_at_end``.
        """
        found = self.verdict_at_end(stays=stays)
        missed = self._in_time.missed(stays=stays) if found.achieved else None
        if missed is None:
            return found
        when = "" if missed.at_s is None else f" {missed.at_s:.1f} s after the trajectory began"
        return Outcome(achieved=False, reason=f"{missed.formula} was missed{when}")

    def verdict_at_end(self, *, stays: bool) -> Outcome:
        """The verdict on the word as if it ended now.

        Args:
            stays: Whether the vehicle is taken to stay where it is for ever. The word closed that way is judged by the
                definition of the specification, not by the automata made of it. Otherwise the flight is one of laps,
                which no flight completes: it is achieved if the laps asked for were flown, at least one, and nothing
                was violated so far.
        """
        if not self._visits:
            return Outcome(achieved=False, reason="no position inside the domain was reported")
        if self._violations:
            first = self._violations[0]
            named = f" ({', '.join(first.names)})" if first.names else ""
            return Outcome(achieved=False, reason=f"the vehicle {first.kind}{named} at {first.time_s:.1f} s")
        if stays:
            last = self._labelling.label(self._visits[-1].triangle)
            if self._satisfied_by(LassoWord(self.word, (last,))):
                return Outcome(achieved=True, reason="the word that was flown satisfies the specification")
            return Outcome(achieved=False, reason="the word that was flown does not satisfy the specification")
        if self._watch.verdict is Verdict.FALSE:
            return Outcome(achieved=False, reason="the word that was flown violates the specification")
        asked = self._laps_asked
        reason = f"{laps_text(self.laps, asked)}, nothing was violated so far"
        return Outcome(achieved=self.laps >= (1 if asked is None else asked), reason=reason)

    @property
    def _now_s(self) -> float:
        """When the last report was."""
        return -math.inf if self._last is None else self._last[0]

    def _clock_s(self, t_s: float) -> float:
        """How long the trajectory has been flown, on the clock by which triangles move."""
        return max(0.0, t_s - self._began_s)

    def _fixed(self, t_s: float, places_m: Sequence[Point]) -> Sequence[Point]:
        """The points of the fixed triangles of which places are the images at a time."""
        if self._moving is None:
            return places_m
        points = self._moving.pulled_back(np.array([self._clock_s(t_s)]), np.array(places_m))
        return [(float(x), float(y)) for x, y in points]

    def _enter(self, triangle: int, time_s: float, position_m: Point) -> None:
        """Take note of the triangle that the vehicle is in from now on."""
        if triangle == OUTSIDE:
            if self._inside:
                self._violations.append(Violation(ViolationKind.LEFT_DOMAIN, time_s, position_m, ()))
            self._inside = False
            return
        self._inside = True
        if self._visits and self._visits[-1].triangle == triangle:
            return
        if self._restricted[triangle]:
            names = tuple(sorted(self._labelling.label(triangle)))
            self._violations.append(Violation(ViolationKind.ENTERED_RESTRICTED, time_s, position_m, names))
        spells = bool(self._visits) or self._semantics is Semantics.STANDARD
        if spells:
            self._watch.read(int(self._labelling.letter_of[triangle]))
        self._laps.enter(triangle, spells=spells)
        self._visits.append(Visit(triangle, time_s))
        self._in_time.enter(time_s, self._labelling.label(triangle))


def _foreseen(word: tuple[frozenset[str], ...], laps: Laps) -> Foreseen:
    return Foreseen(word, laps.rounds.state, laps.rounds.due, laps.over(satisfied=False), laps.due)
