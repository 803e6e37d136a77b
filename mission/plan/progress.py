"""The stages of a run: how its automaton comes on, and where the vehicle may be meanwhile.

A run of triangles spells a word, and the states that the automaton goes through while it reads it are all of the run
that matters. While the automaton is in one of them, the vehicle may be wherever no letter does harm: where a letter
leads to a state that accepts every word that this one accepts, or, in a lap that is flown for ever, *simulates* it.
Then whatever the tube around a path touches, in whatever order, leaves the automaton no worse off than the run does.
The stage ends where all of the tube lies in triangles whose letters lead to the next state. So the triangles of the run
no longer matter, and how fine the mesh is never did.
"""

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import chain

import numpy as np
import shapely

from mission.errors import MissionError
from mission.geometry.arrays import BoolArray
from mission.geometry.regions import Labelling
from mission.geometry.shapes import Area, narrowed, polygonal, widened, without_straight_corners
from mission.geometry.simplices import ROUNDING, Partition
from mission.logic.automata.conjunction import Conjunction
from mission.logic.automata.inclusion import included, simulated
from mission.logic.automata.rabin import DEAD, Pair
from mission.plan.landing import room_to_land
from mission.planning.run import Run
from mission.spec.model import Point, Semantics
from mission.steering.taut import Stretch


class NoStagesError(MissionError):
    """A run whose word cannot be cut into stages; the message says why.

    Attributes:
        unfit: The letters into whose triangles the tube does not fit, where that is why.
    """

    exit_code = 3

    def __init__(self, message: str, unfit: frozenset[int] = frozenset()) -> None:
        """Keep the letters."""
        super().__init__(message)
        self.unfit = unfit


@dataclass(frozen=True, eq=False)
class Stage(Stretch):
    """A part of a flight in which the automaton is in one state, or in one that is no worse.

    Attributes:
        index: Into ``run.states``: the visit with which it ends; -1 where it ends with none, but only where the
            vehicle has left what it must not touch any more when it touches the target.
        names: The regions that every place of the target lies in.
        stays: Whether the flight ends here.
    """

    index: int = -1
    names: frozenset[str] = frozenset()
    stays: bool = False


@dataclass(frozen=True, eq=False)
class Stages:
    """The stages of a run.

    Attributes:
        stages: In order, at least one.
        lap: The first of those that are repeated for ever, to the last one; None where the flight ends with a stay.
        entries: The stages of the lap, as indices into ``stages``, with which it may begin as well as with ``lap``.
    """

    stages: tuple[Stage, ...]
    lap: int | None = None
    entries: tuple[int, ...] = ()


class Grounds:
    """Where the square around a place lies, by the letters of the triangles that it touches.

    Args:
        partition: The domain.
        labelling: Its labels.
        restricted: Shape (M,), what is never touched.
        margin_m: Half width of the square.
        landing_m: How far a landing may drift.
    """

    def __init__(
        self,
        partition: Partition,
        labelling: Labelling,
        restricted: BoolArray,
        margin_m: float,
        landing_m: float = 0.0,
    ) -> None:
        self._partition, self._labelling, self._restricted = partition, labelling, restricted
        self.landing_m = landing_m
        self._margin_m, self._tolerance_m = margin_m, ROUNDING * partition.extent_m
        self._known: dict[frozenset[int], Area] = {}
        self._grown: dict[int, Area] = {}

    @property
    def labelling(self) -> Labelling:
        """The labels of the domain."""
        return self._labelling

    @cached_property
    def letters(self) -> frozenset[int]:
        """The letters of triangles that are not restricted."""
        return frozenset(np.unique(self._labelling.letter_of[~self._restricted]).tolist())

    def touching_only(self, letters: Iterable[int]) -> Area:
        """The places whose square lies in triangles of some letters, none of them restricted."""
        allowed = self.letters & frozenset(letters)
        if allowed not in self._known:
            self._known[allowed] = self._found(allowed)
        return self._known[allowed]

    def inside(self, triangles: BoolArray) -> Area:
        """The places whose square lies in some triangles, marked in an array of shape (M,), none of them restricted."""
        return narrowed(self._union(triangles), self._margin_m)

    def _found(self, allowed: frozenset[int]) -> Area:
        others = self.letters - allowed
        if len(others) > len(allowed):
            return narrowed(self._union(np.isin(self._labelling.letter_of, list(allowed))), self._margin_m)
        if not others:
            return narrowed(self._union(np.ones(self._partition.size, dtype=np.bool_)), self._margin_m)
        return polygonal(
            shapely.difference(
                self.touching_only(self.letters), shapely.union_all([self._touching(letter) for letter in others])
            )
        )

    def _touching(self, letter: int) -> Area:
        if letter not in self._grown:
            self._grown[letter] = widened(self._union(self._labelling.letter_of == letter), self._margin_m)
        return self._grown[letter]

    def _union(self, triangles: BoolArray) -> Area:
        chosen = self._partition.corners_m[triangles & ~self._restricted]
        # A conforming mesh: its triangles have edges in common, and none overlap.
        return without_straight_corners(
            polygonal(shapely.coverage_union_all(shapely.polygons(chosen))), self._tolerance_m
        )


@dataclass(frozen=True)
class _Step:
    """A step of the automaton.

    Attributes:
        state: Before it.
        after: After it.
        marks: Marks that are waited for, as bits.
        index: Into the states of the run.
    """

    state: int
    after: int
    marks: int
    index: int


class StagesOfRuns:
    """Cuts runs into stages; what depends on the domain and the automaton alone is found once.

    Args:
        grounds: The domain.
        automaton: Over the numbers of its letters.
        semantics: Whether words begin with the label of the start triangle.
    """

    def __init__(self, grounds: Grounds, automaton: Conjunction, semantics: Semantics) -> None:
        self._grounds, self._whole, self._semantics = grounds, automaton.whole, semantics
        self._repeated = automaton.repeated
        self._digits = automaton.digits
        self._simulated = [simulated(part) for part in automaton.parts]
        self._accepted = [included(part) for part in automaton.parts]

    def of(self, run: Run, start_m: Point | None = None) -> Stages:
        """The stages of a run.

        Args:
            run: The run.
            start_m: Where the flight begins; None where all of the square lies in the start triangle's letter there.

        Raises:
            NoStagesError: What is read counts triangles, or a region is too small for the square.
        """
        letters = [int(self._grounds.labelling.letter_of[triangle]) for triangle in run.states]
        head = len(run.prefix)
        state = self._whole.initial
        steps: list[_Step] = []
        for index in range(0 if self._semantics is Semantics.STANDARD else 1, head + 1):
            after = int(self._whole.targets[state, letters[index]])
            if index and after != state and self._no_worse(state, after, None):
                continue  # what is read here only makes more to be done: it is left out
            step = _Step(state, after, 0, index)
            if (index or self._begins_beside(step, start_m)) and not self._alike(state, after, None):
                steps.append(step)
            state = after
        start = _Step(DEAD, DEAD, 0, 0)
        stages = list(chain.from_iterable(self._cut_all(steps, [start, *steps[:-1]], letters, None)))
        if not run.recurrent:
            return Stages(self._with_stay(stages, state, letters[-1], len(run.states) - 1))
        steps, pair = self._lap(state, letters, head)
        laps = self._cut_all(steps, [*steps[-1:], *steps[:-1]], letters, pair)
        stages.extend(self._ending(stages, (state, steps[0].state), letters[0], laps[0][0].free, pair))
        begins = np.cumsum([len(stages), *map(len, laps)]).tolist()
        entries = tuple(
            begin for begin, step in zip(begins, steps, strict=False) if self._no_worse(state, step.state, None)
        )
        return Stages((*stages, *chain.from_iterable(laps)), len(stages), entries)

    def _begins_beside(self, step: _Step, start_m: Point | None) -> bool:
        """Whether not all of the square about the start makes the step that the start itself makes."""
        if start_m is None:
            return False
        made = self._grounds.touching_only(self._ends(step, None))
        return not shapely.intersects(made, shapely.Point(start_m))

    def _ending(
        self, stages: Sequence[Stage], states: tuple[int, int], start: int, lap: Area, pair: Pair
    ) -> Iterator[Stage]:
        """The stage in which the vehicle leaves what laps must not touch again, where it is there before them.

        ``states`` are those before the laps and at their first step.
        """
        before, first = states
        harmless = self._reading(before, [before], None)
        there = (
            not shapely.covers(lap, stages[-1].target) if stages else start not in self._reading(first, [first], pair)
        )
        if there:
            free = self._grounds.touching_only(harmless)
            yield Stage(free, polygonal(shapely.intersection(free, lap)))

    def _cut_all(
        self, steps: list[_Step], before: list[_Step], letters: list[int], lap: Pair | None
    ) -> list[list[Stage]]:
        """For each of some steps the stages that it ends.

        Args:
            steps: The steps.
            before: Beside each the step before.
            letters: Of the run's states.
            lap: The pair that is satisfied by what is repeated; None where nothing is.
        """
        found: list[list[Stage]] = []
        for step, earlier in zip(steps, before, strict=False):
            ends = self._ends(step, lap) - self._unread(step, earlier, letters, lap)
            if letters[step.index] not in ends:
                raise NoStagesError(f"how many triangles of {self._named(letters[step.index])} are entered is counted")
            found.append(list(self._cut(step, ends, self._named(letters[step.index]), lap)))
        return found

    def _lap(self, state: int, letters: list[int], head: int) -> tuple[list[_Step], Pair]:
        """The steps of a lap after a state, and the pair that it satisfies."""
        read = [*range(head + 1, len(letters)), head]
        begins = [state]
        while begins[-1] not in begins[:-1]:
            for index in read:
                state = int(self._whole.targets[state, letters[index]])
            begins.append(state)
        # As many rounds of the run as the automaton needs to come back are one lap.
        again = begins[begins.index(state) : -1]
        read *= len(again)
        begin = next((each for each in again if self._no_worse(begins[0], each, None)), DEAD)
        if begin == DEAD:
            raise NoStagesError("the first lap of the run does something else to the automaton than the others")
        state, borne, met = begin, 0, 0
        for index in read:
            borne |= int(self._whole.marks[state, letters[index]])
            state = int(self._whole.targets[state, letters[index]])
        pair = next(each for each in self._whole.pairs if not borne & each[0] and borne & each[1] == each[1])
        steps, state = [], begin
        for index in read:
            after = int(self._whole.targets[state, letters[index]])
            new = int(self._whole.marks[state, letters[index]]) & pair[1] & ~met
            if new or not self._alike(state, after, pair):
                steps.append(_Step(state, after, new, index))
            state, met = after, met | new
        return steps, pair

    def _ends(self, step: _Step, lap: Pair | None) -> set[int]:
        """The letters that make a step, however often they are read."""
        return self._making(step, step.state, lap) & self._reading(step.after, [step.after], lap)

    def _unread(self, step: _Step, earlier: _Step, letters: list[int], lap: Pair | None) -> set[int]:
        """The letters that are read when the stage before ends, and would have to be read again to make a step.

        Where all of the tube lies in triangles with such a letter, no other need be entered.
        """
        if earlier.state == DEAD:
            return {letters[0]} if step.index else set()
        return self._ends(earlier, lap) - self._making(step, earlier.state, lap)

    def _making(self, step: _Step, state: int, lap: Pair | None) -> set[int]:
        """The letters that make a step from a state."""
        found = self._reading(state, [step.after], lap)
        return {each for each in found if int(self._whole.marks[state, each]) & step.marks == step.marks}

    def _cut(self, step: _Step, ends: set[int], name: str, lap: Pair | None) -> Iterator[Stage]:
        """The stages that a step ends: one, but where what harms after the step does not before it."""
        harmless = self._reading(step.state, [step.state], lap)
        undone = harmless - ends - self._reading(step.after, [step.state, step.after], lap)
        last = self._grounds.touching_only((harmless - undone) | ends)
        if undone:
            free = self._grounds.touching_only(harmless - ends)
            yield Stage(free, polygonal(shapely.intersection(free, last)))
        target = self._grounds.touching_only(ends)
        if target.is_empty:
            raise NoStagesError(f"the tube does not fit into {name}", frozenset(ends))
        names = [self._grounds.labelling.letters[letter] for letter in ends]
        yield Stage(last, target, index=step.index, names=frozenset.intersection(*names))

    def _with_stay(self, stages: list[Stage], state: int, letter: int, index: int) -> tuple[Stage, ...]:
        """The stages with the one that leads to where the flight stays."""
        allowed = self._staying(state, letter)
        target = self._grounds.touching_only(allowed)
        if target.is_empty:
            raise NoStagesError(f"the tube does not fit into {self._named(letter)}", allowed)
        names = frozenset.intersection(*(self._grounds.labelling.letters[each] for each in allowed))
        harmless = self._reading(state, [state], None)
        free = self._grounds.touching_only(harmless | allowed)
        ends = room_to_land(target, free, self._grounds.landing_m)
        if stages and shapely.covers(target, stages[-1].target):
            at_once = polygonal(shapely.intersection(ends, stages[-1].target))
            if not at_once.is_empty:
                last = stages.pop()
                return (*stages, Stage(last.free, at_once, None, last.index, last.names, stays=True))
        return (*stages, Stage(free, ends, None, index, names, stays=True))

    def _staying(self, state: int, letter: int) -> frozenset[int]:
        """Letters of which every word for ever is accepted from a state."""
        after, marks = self._whole.targets[state], self._whole.marks[state]
        for fin, inf in self._whole.pairs:
            kept = np.flatnonzero((after == state) & (marks & fin == 0) & (marks & inf == inf))
            if letter in kept:
                return self._grounds.letters & set(kept.tolist())
        if not self._repeated[state, letter]:
            raise NoStagesError(f"to stay in {self._named(letter)} is not accepted")
        return frozenset((letter,))

    def _reading(self, state: int, than: Sequence[int], lap: Pair | None) -> set[int]:
        """The letters that lead from a state to one that is no worse than some state, without what a lap must not."""
        targets, marks = self._whole.targets[state].tolist(), self._whole.marks[state].tolist()
        return {
            letter
            for letter in self._grounds.letters
            if (lap is None or not marks[letter] & lap[0])
            and any(self._no_worse(targets[letter], other, lap) for other in than)
        }

    def _alike(self, state: int, other: int, lap: Pair | None) -> bool:
        return self._no_worse(state, other, lap) and self._no_worse(other, state, lap)

    def _no_worse(self, state: int, than: int, lap: Pair | None) -> bool:
        """Whether a state accepts what another one does, or in a lap, over and over, simulates it."""
        if state == DEAD:
            return False
        orders = self._accepted if lap is None else self._simulated
        pairs = zip(orders, self._digits[than].tolist(), self._digits[state].tolist(), strict=True)
        return all(bool(order[worse, better]) for order, worse, better in pairs)

    def _named(self, letter: int) -> str:
        return " & ".join(sorted(self._grounds.labelling.letters[letter])) or "what is in no region"
