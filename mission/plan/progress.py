"""The stages of a run: how its automaton comes on, and where the vehicle may be meanwhile.

A run of triangles spells a word, and the states that the automaton goes through while it reads it are all of the run
that matters. While the automaton is in one of them, the vehicle may be wherever no letter does harm: where a letter
leads to the same state, or to one that *simulates* it (it accepts every word that the state accepts, with no better
marks on the way). Then whatever the tube around a path touches in whatever order leaves the automaton at least where
the run has it. The stage ends where all of the tube lies in triangles whose letters lead to the next state. So the
triangles of the run no longer matter, and how fine the mesh is never did.
"""

from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from functools import cached_property, reduce
from itertools import chain
from operator import or_
from typing import Final

import numpy as np
import shapely
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from mission.errors import MissionError
from mission.geometry.arrays import BoolArray, IntArray
from mission.geometry.regions import Labelling
from mission.geometry.shapes import Area, narrowed, polygonal, widened, without_straight_corners
from mission.geometry.simplices import ROUNDING, Partition
from mission.logic.automata.conjunction import Conjunction
from mission.logic.automata.rabin import DEAD, Pair, Rabin
from mission.planning.run import Run
from mission.spec.model import Semantics
from mission.steering.taut import Stretch

_MOST_COMPARED: Final = 400
"""States of a part above which only equal ones are taken to simulate each other."""


class NoStagesError(MissionError):
    """A run whose word cannot be cut into stages; the message says why."""

    exit_code = 3


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


def stages_of(
    run: Run,
    automaton: Conjunction,
    partition: Partition,
    labelling: Labelling,
    *,
    restricted: BoolArray,
    semantics: Semantics,
    margin_m: float,
) -> Stages:
    """Cut a run into stages.

    Args:
        run: The run.
        automaton: The deterministic automaton that accepts its word, over the numbers of ``labelling.letters``.
        partition: The domain.
        labelling: Its labels.
        restricted: Shape (M,), what the tube must never touch.
        semantics: Whether the word begins with the label of the start triangle.
        margin_m: Half width of the square around the path that touches only what it may, with some room for rounding.

    Raises:
        NoStagesError: What is read counts triangles, or a region is too small for the square.
    """
    grounds = Grounds(partition, labelling, restricted, margin_m)
    return StagesOfRuns(grounds, automaton, semantics).of(run)


class Grounds:
    """Where the square around a place lies, by the letters of the triangles that it touches.

    Args:
        partition: The domain.
        labelling: Its labels.
        restricted: Shape (M,), what is never touched.
        margin_m: Half width of the square.
    """

    def __init__(self, partition: Partition, labelling: Labelling, restricted: BoolArray, margin_m: float) -> None:
        self._partition, self._labelling, self._restricted = partition, labelling, restricted
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
        self._stepwise, self._onward = zip(*(simulated(part) for part in automaton.parts), strict=True)

    def of(self, run: Run) -> Stages:
        """The stages of a run.

        Raises:
            NoStagesError: What is read counts triangles, or a region is too small for the square.
        """
        letters = [int(self._grounds.labelling.letter_of[triangle]) for triangle in run.states]
        head = len(run.prefix)
        state = self._whole.initial
        steps: list[_Step] = []
        for index in range(0 if self._semantics is Semantics.STANDARD else 1, head + 1):
            after = int(self._whole.targets[state, letters[index]])
            if after != state and index:
                steps.append(_Step(state, after, 0, index))
            state = after
        start = _Step(DEAD, DEAD, 0, 0)
        stages = list(chain.from_iterable(self._cut_all(steps, [start, *steps[:-1]], letters, 0)))
        if not run.recurrent:
            return Stages(self._with_stay(stages, state, letters[-1], len(run.states) - 1))
        steps, pair = self._lap(state, letters, head)
        laps = self._cut_all(steps, [*steps[-1:], *steps[:-1]], letters, pair[0])
        begins = np.cumsum([len(stages), *map(len, laps)]).tolist()
        entries = tuple(
            begin for begin, step in zip(begins, steps, strict=False) if self._no_worse(state, step.state, once=True)
        )
        return Stages((*stages, *chain.from_iterable(laps)), len(stages), entries)

    def _cut_all(self, steps: list[_Step], before: list[_Step], letters: list[int], fin: int) -> list[list[Stage]]:
        """For each of some steps the stages that it ends; beside it, the step before."""
        found: list[list[Stage]] = []
        for step, earlier in zip(steps, before, strict=False):
            ends = self._ends(step, fin) - self._unread(step, earlier, letters, fin)
            if letters[step.index] not in ends:
                raise NoStagesError(f"how many triangles of {self._named(letters[step.index])} are entered is counted")
            found.append(list(self._cut(step, ends, self._named(letters[step.index]), fin)))
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
        begin = next((each for each in again if self._no_worse(begins[0], each, once=True)), DEAD)
        if begin == DEAD:
            raise NoStagesError("the first lap of the run does something else to the automaton than the others")
        state, borne, met = begin, 0, 0
        for index in read:
            borne |= int(self._whole.marks[state, letters[index]])
            state = int(self._whole.targets[state, letters[index]])
        satisfied = [pair for pair in self._whole.pairs if not borne & pair[0] and borne & pair[1] == pair[1]]
        fin, inf = satisfied[0]
        steps, state = [], begin
        for index in read:
            after = int(self._whole.targets[state, letters[index]])
            new = int(self._whole.marks[state, letters[index]]) & inf & ~met
            if after != state or new:
                steps.append(_Step(state, after, new, index))
            state, met = after, met | new
        return steps, (fin, inf)

    def _ends(self, step: _Step, fin: int) -> set[int]:
        """The letters that make a step, however often they are read."""
        found = self._reading(
            step.state,
            lambda after, marks: self._no_worse(after, step.after) and marks & step.marks == step.marks,
            fin,
        )
        return found & self._reading(step.after, lambda after, _: self._no_worse(after, step.after), fin)

    def _unread(self, step: _Step, earlier: _Step, letters: list[int], fin: int) -> set[int]:
        """The letters that are read when the stage before ends, and would have to be read again to make a step.

        Where all of the tube lies in triangles with such a letter, no other need be entered.
        """
        if earlier.state == DEAD:
            return {letters[0]}
        both = self._reading(
            earlier.state,
            lambda after, marks: self._no_worse(after, step.after) and marks & step.marks == step.marks,
            fin,
        )
        return self._ends(earlier, fin) - both

    def _cut(self, step: _Step, ends: set[int], name: str, fin: int) -> Iterator[Stage]:
        """The stages that a step ends: one, but where what harms after the step does not before it."""
        harmless = self._reading(step.state, lambda after, _: self._no_worse(after, step.state), fin)
        undone = {
            letter
            for letter in harmless - ends
            if not any(
                self._no_worse(int(self._whole.targets[step.after, letter]), state)
                for state in (step.state, step.after)
            )
        }
        last = self._grounds.touching_only((harmless - undone) | ends)
        if undone:
            free = self._grounds.touching_only(harmless - ends)
            yield Stage(free, polygonal(shapely.intersection(free, last)))
        target = self._grounds.touching_only(ends)
        if target.is_empty:
            raise NoStagesError(f"{name} is too small for the square around the path")
        names = [self._grounds.labelling.letters[letter] for letter in ends]
        yield Stage(last, target, index=step.index, names=frozenset.intersection(*names))

    def _with_stay(self, stages: list[Stage], state: int, letter: int, index: int) -> tuple[Stage, ...]:
        """The stages with the one that leads to where the flight stays."""
        allowed = self._staying(state, letter)
        target = self._grounds.touching_only(allowed)
        if target.is_empty:
            raise NoStagesError(f"{self._named(letter)} is too small for the square around the path")
        names = frozenset.intersection(*(self._grounds.labelling.letters[each] for each in allowed))
        if stages and shapely.covers(target, stages[-1].target):
            last = stages.pop()
            return (*stages, Stage(last.free, last.target, None, last.index, last.names, stays=True))
        harmless = self._reading(state, lambda after, _: self._no_worse(after, state), 0)
        free = self._grounds.touching_only(harmless | allowed)
        return (*stages, Stage(free, target, None, index, names, stays=True))

    def _staying(self, state: int, letter: int) -> set[int]:
        """Letters of which every word for ever is accepted from a state."""
        for fin, inf in self._whole.pairs:
            found = self._reading(state, lambda after, marks: after == state and marks & inf == inf, fin)  # noqa: B023
            if letter in found:
                return found
        if not self._repeated[state, letter]:
            raise NoStagesError(f"to stay in {self._named(letter)} is not accepted")
        return {letter}

    def _reading(self, state: int, wanted: Callable[[int, int], bool], fin: int) -> set[int]:
        """The letters that lead from a state to where it is wanted, and have none of some marks."""
        return {
            letter
            for letter in self._grounds.letters
            if (marks := int(self._whole.marks[state, letter])) & fin == 0
            and wanted(int(self._whole.targets[state, letter]), marks)
        }

    def _no_worse(self, state: int, than: int, *, once: bool = False) -> bool:
        """Whether a state simulates another one; only from here on, if what follows is asked once."""
        if state == DEAD:
            return False
        orders = self._onward if once else self._stepwise
        pairs = zip(orders, self._digits[than].tolist(), self._digits[state].tolist(), strict=True)
        return all(bool(order[worse, better]) for order, worse, better in pairs)

    def _named(self, letter: int) -> str:
        return " & ".join(sorted(self._grounds.labelling.letters[letter])) or "what is in no region"


def simulated(part: Rabin) -> tuple[BoolArray, BoolArray]:
    """(Q, Q) whether the second state simulates the first: at every step, and where it matters in the end.

    One state simulates another if for each letter on which the other's run goes on, its own does with at least the
    marks that must come again and none of those that must not but the other's, and enters a state that simulates the
    one that the other enters. Steps that are taken once only, between components, have no marks that matter. To be
    compared step by step, again and again, they count as the worst; to be compared once, from here on, they count as
    the worst of the first state's and as the best of the second's. The second relation contains the first; of very
    large automata both hold the states themselves only.
    """
    if part.size > _MOST_COMPARED:
        return np.eye(part.size, dtype=np.bool_), np.eye(part.size, dtype=np.bool_)
    fin, inf = (reduce(or_, (pair[place] for pair in part.pairs), 0) for place in (0, 1))
    sources, letters = np.nonzero(part.targets != DEAD)
    graph = coo_array((np.ones(len(sources)), (sources, part.targets[sources, letters])), (part.size, part.size))
    _, component = connected_components(graph.tocsr(), directed=True, connection="strong")
    again = component[:, None] == component[part.targets]
    worst, best = np.where(again, part.marks, fin & ~inf), np.where(again, part.marks, inf & ~fin)
    return _greatest(part.targets, worst, worst, fin, inf), _greatest(part.targets, worst, best, fin, inf)


def _greatest(targets: IntArray, of_first: IntArray, of_second: IntArray, fin: int, inf: int) -> BoolArray:
    """The greatest simulation (Q, Q), with the marks (Q, letters) of the first and of the second state."""
    order = np.ones((len(targets), len(targets)), dtype=np.bool_)
    for entered, first, second in zip(targets.T, of_first.T, of_second.T, strict=True):
        worse = (first[:, None] & inf & ~second[None]) | (second[None] & fin & ~first[:, None])
        order &= (entered == DEAD)[:, None] | ((entered != DEAD)[None] & (worse == 0))
    while True:
        before = order.copy()
        for entered in targets.T:
            order &= (entered == DEAD)[:, None] | before[entered[:, None], entered[None]]
        if (order == before).all():
            return order
