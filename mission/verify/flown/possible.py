"""Every word that a flight may have spelled, as far as its log tells: the states that an automaton may be in.

Between two positions that are close in time the straight line between them counts as flown, as it does in flight; yet
where other regions are within reach of that line, the vehicle may have been in them. In a gap it may have gone through
whatever is within reach, again and again. So the flight is followed as a set of pairs of a triangle and a state of the
deterministic automaton of the mission; what all of them agree on is known, and all else is open.

Where triangles move, all of this is about the triangles, wherever they are meanwhile (``over``).
"""

from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass, field, replace
from typing import Final, TypeVar

import numpy as np

from mission.geometry.arrays import BoolArray, FloatArray, IntArray
from mission.geometry.location import OUTSIDE, Locator
from mission.geometry.moving import MovingPartition
from mission.geometry.regions import Labelling
from mission.logic.automata.rabin import DEAD, Rabin
from mission.monitor.monitor import Violation, ViolationKind
from mission.spec.model import Semantics
from mission.verify.flown.over import MovingOver, Over
from mission.verify.flown.reach import Reaches

MOST_PAIRS: Final = 200_000
"""Pairs of a triangle and a state that are followed through one gap; where there are more, any state is possible."""

Pair = tuple[int, int]
"""A triangle and a state."""

Node = TypeVar("Node", bound=tuple[int, ...])


@dataclass(frozen=True)
class Doubt:
    """A time of which it cannot be told what the vehicle did, and what it may have done makes a difference.

    Attributes:
        from_s: Begin.
        to_s: End.
        regions: Regions that it may have entered.
        restricted: Those of them that must not be entered.
        outside: Whether it may have left the domain.
    """

    from_s: float
    to_s: float
    regions: tuple[str, ...]
    restricted: tuple[str, ...]
    outside: bool

    @property
    def violates(self) -> bool:
        """Whether it may have done what must never be done."""
        return self.outside or bool(self.restricted)


@dataclass(frozen=True)
class Entered:
    """A triangle that was entered, and when; None for what was entered in a gap, which nobody knows."""

    t_s: float
    triangle: int | None


@dataclass(frozen=True, eq=False)
class Ground:
    """What a flight is judged on.

    Attributes:
        locator: The domain.
        labelling: Its labels.
        restricted: Shape (M,), triangles that must not be entered.
        automaton: Of the mission, deterministic, over the numbers of the letters.
        semantics: Whether the label of the first triangle is read.
        moving: How the domain moves; None where it stands.
        began_s: From when on it does, on the clock of the reports.
    """

    locator: Locator
    labelling: Labelling
    restricted: BoolArray
    automaton: Rabin
    semantics: Semantics
    moving: MovingPartition | None = None
    began_s: float = 0.0

    def over(self, reaches: Reaches) -> Over:
        """What a flight was over."""
        if self.moving is None:
            return Over(self.locator, reaches)
        return MovingOver(self.locator, reaches, self.moving, self.began_s)

    def step(self, state: int, triangle: int) -> int:
        """The state after a triangle was entered; -1 where nothing is accepted any more."""
        if state == DEAD:
            return DEAD
        return int(self.automaton.targets[state, self.labelling.letter_of[triangle]])


@dataclass(eq=False)
class Following:
    """What was found.

    Attributes:
        pairs: Triangles and states that are possible at the end, of flights that never did what must not be done.
        entered: Triangles that were entered for certain, and gaps, in order.
        doubts: What cannot be told.
        violations: What was done for certain and must not be.
    """

    pairs: set[Pair] = field(default_factory=set)
    entered: list[Entered] = field(default_factory=list)
    doubts: list[Doubt] = field(default_factory=list)
    violations: list[Violation] = field(default_factory=list)


def follow(ground: Ground, reaches: Reaches, word_from_s: float, *, begins_whole: bool) -> Following:
    """Follow a flight from its first report to its last.

    Args:
        ground: What it is judged on.
        reaches: The reports, and how far the vehicle may have been off between them.
        word_from_s: From when on it spells its word.
        begins_whole: Whether nothing is missing before its first report.
    """
    return _Follower(ground, reaches, word_from_s, begins_whole=begins_whole).followed()


class _Follower:
    def __init__(self, ground: Ground, reaches: Reaches, word_from_s: float, *, begins_whole: bool) -> None:
        self._ground, self._reaches, self._from_s = ground, reaches, word_from_s
        self._begins_whole = begins_whole
        self._over = ground.over(reaches)
        self._at = self._over.at
        self._found = Following()
        self._inside = True

    def followed(self) -> Following:
        """Look at each interval that may hold more than a stay in one triangle."""
        spelled = int(np.searchsorted(self._reaches.t_s, self._from_s))
        plain = plain_intervals(self._ground, self._over)
        for index in np.flatnonzero(~plain[:spelled]).tolist():
            self._guard(index)
        if spelled < len(self._at):
            self._begin(spelled)
            for index in (spelled + np.flatnonzero(~plain[spelled:])).tolist():
                self._go_on(index)
        elif len(self._at):
            self._stand(0)
        self._found.doubts = _merged(self._found.doubts)
        return self._found

    def _guard(self, index: int) -> None:
        """Before the word begins, nothing is spelled."""
        self._stand(index)
        self._doubt(index, {int(self._at[index])}, differs=False)

    def _begin(self, index: int) -> None:
        """The first report that counts for the word."""
        self._stand(index)
        triangle, time_s = int(self._at[index]), float(self._reaches.t_s[index])
        if not self._begins_whole:
            names = tuple(sorted(self._restricted_names(range(len(self._ground.restricted)))))
            self._found.doubts.append(Doubt(-np.inf, time_s, (), names, outside=True))
        if triangle != OUTSIDE:
            self._found.entered.append(Entered(time_s, triangle))
        if self._found.violations:
            return
        initial = self._ground.automaton.initial
        standard = self._ground.semantics is Semantics.STANDARD
        self._found.pairs = (
            {(triangle, self._ground.step(initial, triangle) if standard else initial)}
            if self._begins_whole
            else self._anything(triangle)
        )

    def _anything(self, triangle: int) -> set[Pair]:
        return {(triangle, state) for state in (DEAD, *range(self._ground.automaton.size))}

    def _is_bad(self, triangle: int) -> bool:
        return triangle == OUTSIDE or bool(self._ground.restricted[triangle])

    def _stand(self, index: int) -> None:
        """A report from where the vehicle must not be."""
        triangle = int(self._at[index])
        if self._is_bad(triangle):
            self._violated(triangle, float(self._reaches.t_s[index]), self._reaches.position_m[index])
        else:
            self._inside = True

    def _violated(self, triangle: int, time_s: float, place_m: FloatArray) -> None:
        if not self._inside:
            return  # it has not come back since
        self._inside = False
        kind = ViolationKind.LEFT_DOMAIN if triangle == OUTSIDE else ViolationKind.ENTERED_RESTRICTED
        names = () if triangle == OUTSIDE else tuple(sorted(self._restricted_names((triangle,))))
        self._found.violations.append(Violation(kind, time_s, (float(place_m[0]), float(place_m[1])), names))
        self._found.pairs = set()

    def _restricted_names(self, triangles: Iterable[int]) -> set[str]:
        chosen = [triangle for triangle in triangles if self._ground.restricted[triangle]]
        letters = np.unique(self._ground.labelling.letter_of[chosen]).tolist() if chosen else []
        return {name for letter in letters for name in self._ground.labelling.letters[letter]}

    def _go_on(self, index: int) -> None:
        """From one report to the next."""
        begin, end = self._at[index : index + 2].tolist()
        before = len({state for _, state in self._found.pairs})
        violations = len(self._found.violations)
        gap = bool(self._reaches.is_open[index])
        walk = [] if gap else self._walk(index)
        line = [triangle for triangle, _ in walk]
        within = self._over.within(index)
        safe = set(within[~self._ground.restricted[within]].tolist())
        if gap or any(map(self._is_bad, line)):
            self._found.pairs = self._astray(safe | {begin}, begin, end)
            known = {begin, end}
            if not (self._is_bad(begin) or self._is_bad(end)) and not self._way_round(safe, begin, end):
                self._crossed(index, walk)
        else:
            self._found.pairs = self._straight(line, safe)
            known = set(line)
        if self._is_bad(end):
            self._crossed(index, walk)
        self._note_entered(index, walk, within=within, known=known)
        if len(self._found.violations) == violations:
            differs = len({state for _, state in self._found.pairs}) > max(before, 1)
            self._doubt(index, known, differs=differs)
        self._stand(index + 1)

    def _walk(self, index: int) -> list[tuple[int, float]]:
        """The triangles on the straight line, and when each is entered."""
        time_s, lasts_s = float(self._reaches.t_s[index]), float(self._reaches.gap_s[index])
        return [(triangle, time_s + share * lasts_s) for triangle, share in self._over.line(index)]

    def _beside(self, triangle: int, allowed: set[int]) -> Iterator[int]:
        return (each for each in self._ground.locator.partition.neighbours[triangle].tolist() if each in allowed)

    def _way_round(self, safe: set[int], begin: int, end: int) -> bool:
        """Whether there is a way within reach on which nothing is violated."""
        found = _closure({(begin,)}, lambda node: ((each,) for each in self._beside(node[0], safe)))
        return found is None or (end,) in found

    def _astray(self, allowed: set[int], begin: int, end: int) -> set[Pair]:
        """All that may have become of it where it went from neighbour to neighbour in some triangles."""
        step = self._ground.step
        # A report on a border lies in several triangles.
        starts = self._found.pairs | {(begin, step(state, begin)) for at, state in self._found.pairs if at != begin}
        found = _closure(starts, lambda node: ((each, step(node[1], each)) for each in self._beside(node[0], allowed)))
        return self._anything(end) if found is None else {(at, state) for at, state in found if at == end}

    def _straight(self, line: list[int], safe: set[int]) -> set[Pair]:
        """All that may have become of it on a straight line, with ways aside to other letters within reach."""
        letter_of, step, last = self._ground.labelling.letter_of, self._ground.step, len(line) - 1
        own = {int(letter_of[triangle]) for triangle in line}
        aside = sorted(triangle for triangle in safe if int(letter_of[triangle]) not in own)

        def onward(node: tuple[int, int, int]) -> Iterator[tuple[int, int, int]]:
            """Of a place on the line, whether the vehicle is aside of it, and a state."""
            place, is_aside, state = node
            for triangle in aside:
                yield place, 1, step(state, triangle)
            for after in range(place, last + 1) if is_aside else range(place + 1, min(place + 2, last + 1)):
                yield after, 0, step(state, line[after])

        # A report on a border lies in several triangles; the line tells which one was meant.
        starts = {(0, 0, state if at == line[0] else step(state, line[0])) for at, state in self._found.pairs}
        found = _closure(starts, onward)
        if found is None:
            return self._anything(line[-1])
        return {(line[-1], state) for place, is_aside, state in found if place == last and not is_aside}

    def _crossed(self, index: int, walk: list[tuple[int, float]]) -> None:
        """What must not be entered was entered between two reports, or at the second."""
        reports = self._reaches
        for triangle, time_s in walk:
            if self._is_bad(triangle):
                share = (time_s - reports.t_s[index]) / reports.gap_s[index]
                begin, end = reports.position_m[index : index + 2]
                self._violated(triangle, time_s, begin + share * (end - begin))
                return
        end = int(self._at[index + 1])
        if not self._is_bad(end):
            within = self._over.within(index)
            end = next(iter(within[self._ground.restricted[within]].tolist()), OUTSIDE)
        self._violated(end, float(reports.t_s[index + 1]), reports.position_m[index + 1])

    def _note_entered(self, index: int, walk: list[tuple[int, float]], *, within: IntArray, known: set[int]) -> None:
        """The word as far as it is known."""
        entered, letter_of = self._found.entered, self._ground.labelling.letter_of
        if not walk:
            told = {int(letter_of[triangle]) for triangle in known if triangle != OUTSIDE}
            if not set(letter_of[within].tolist()) <= told:
                entered.append(Entered(float(self._reaches.t_s[index]), None))
            walk = [(int(self._at[index + 1]), float(self._reaches.t_s[index + 1]))]
        for triangle, time_s in walk:
            if triangle != OUTSIDE and not (entered and entered[-1].triangle == triangle):
                entered.append(Entered(time_s, triangle))

    def _doubt(self, index: int, known: set[int], *, differs: bool) -> None:
        """Take note of what may have happened, but for what is known, where it makes a difference."""
        within, labelling = self._over.within(index), self._ground.labelling
        sure = {name for triangle in known if triangle != OUTSIDE for name in labelling.label(triangle)}
        letters = np.unique(labelling.letter_of[within]).tolist()
        regions = {name for letter in letters for name in labelling.letters[letter]} - sure
        restricted = self._restricted_names(within.tolist()) - sure
        outside = OUTSIDE not in known and self._over.leaves(index)
        if differs or restricted or outside:
            begin_s, end_s = self._reaches.t_s[index : index + 2].tolist()
            names = tuple(sorted(regions)), tuple(sorted(restricted))
            self._found.doubts.append(Doubt(begin_s, end_s, *names, outside=outside))


def plain_intervals(ground: Ground, over: Over) -> BoolArray:
    """Intervals all of whose reach lies well inside one triangle that may be entered, shape (N - 1,).

    Args:
        ground: What the flight is judged on.
        over: What it was over at its N reports.
    """
    at = over.at
    same = (at[:-1] == at[1:]) & (at[:-1] != OUTSIDE)
    same &= ~ground.restricted[at[:-1]]
    plain: BoolArray = same & (over.depth_m(np.where(same, at[:-1], 0)) > 1.05 * over.reaches.reach_m + 1e-6)
    return plain


def _merged(doubts: list[Doubt]) -> list[Doubt]:
    """Doubts of the same kind that follow each other without a break as one."""
    merged: list[Doubt] = []
    for doubt in doubts:
        last = merged[-1] if merged else None
        if last is not None and last == replace(doubt, from_s=last.from_s, to_s=doubt.from_s):
            merged[-1] = replace(last, to_s=doubt.to_s)
            continue
        merged.append(doubt)
    return merged


def _closure(starts: set[Node], onward: Callable[[Node], Iterable[Node]]) -> set[Node] | None:
    """All nodes that can be reached; None where they are too many."""
    found, waiting = set(starts), list(starts)
    while waiting:
        for node in onward(waiting.pop()):
            if node not in found:
                found.add(node)
                waiting.append(node)
        if len(found) > MOST_PAIRS:
            return None
    return found
