"""Automata on infinite words, as values: Büchi with accepting states, generalised Büchi with marked transitions."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from mission.logic.automata.components import backward_reachable, strong_components
from mission.logic.automata.diagrams import Diagram, Diagrams
from mission.logic.automata.guards import Guard
from mission.logic.formula.word import LassoWord, Letter

IntArray = NDArray[np.int64]
BoolArray = NDArray[np.bool_]


@dataclass(frozen=True)
class Edge:
    """All transitions between two states: one for each letter that ``guard`` allows."""

    source: int
    guard: Guard
    target: int


@dataclass(frozen=True)
class MarkedEdge:
    """All transitions between two states that carry the same marks.

    Attributes:
        source: The state it leaves.
        guard: The letters that it reads.
        target: The state it enters.
        marks: The acceptance sets that it belongs to, ascending.
    """

    source: int
    guard: Guard
    target: int
    marks: tuple[int, ...]


@dataclass(frozen=True)
class BuchiAutomaton:
    """A Büchi automaton with accepting states.

    A word is accepted if some run from some initial state meets accepting states infinitely often. A state without an
    edge for a letter has no run there: no sink that only rejects is needed.

    Attributes:
        propositions: The names that the guards are over.
        size: Number of states, which are 0 to ``size - 1``.
        initial: Initial states, ascending, at least one.
        accepting: Accepting states.
        edges: At most one edge between two states, ordered by source and target.

    Raises:
        ValueError: One of these does not hold.
    """

    propositions: tuple[str, ...]
    size: int
    initial: tuple[int, ...]
    accepting: frozenset[int]
    edges: tuple[Edge, ...]

    def __post_init__(self) -> None:
        _check_states(self.propositions, self.size, self.initial)
        if not all(0 <= state < self.size for state in self.accepting):
            raise ValueError("an accepting state does not exist")
        _check_edges(self.propositions, self.size, self.edges)
        pairs = [(edge.source, edge.target) for edge in self.edges]
        if pairs != sorted(set(pairs)):
            raise ValueError("edges are not ordered by source and target, or two of them join the same states")

    @property
    def edge_count(self) -> int:
        """Number of edges; all transitions between two states are one edge."""
        return len(self.edges)

    @cached_property
    def outgoing(self) -> tuple[tuple[Edge, ...], ...]:
        """The edges that leave each state."""
        groups: list[list[Edge]] = [[] for _ in range(self.size)]
        for edge in self.edges:
            groups[edge.source].append(edge)
        return tuple(tuple(group) for group in groups)

    @cached_property
    def deterministic(self) -> bool:
        """Whether there is one initial state and no state has two transitions for the same letter."""
        return len(self.initial) == 1 and not _offers_a_choice(self.edges)

    @cached_property
    def complete(self) -> bool:
        """Whether every state has a transition for every letter."""
        return _read_everything(self.size, self.edges)

    def accepts(self, word: LassoWord) -> bool:
        """Whether ``word`` is in the language: an accepting cycle in the product with the lasso."""
        letters = word.prefix + word.suffix
        length = len(letters)
        successors: list[list[int]] = [[] for _ in range(length * self.size)]
        for position, letter in enumerate(letters):
            following = position + 1 if position + 1 < length else len(word.prefix)
            for edge in self.edges:
                if edge.guard.allows(letter):
                    successors[position * self.size + edge.source].append(following * self.size + edge.target)
        for component in strong_components(successors, self.initial):
            cyclic = len(component) > 1 or component[0] in successors[component[0]]
            if cyclic and any(vertex % self.size in self.accepting for vertex in component):
                return True
        return False


@dataclass(frozen=True)
class GeneralisedBuchi:
    """A generalised Büchi automaton with marked transitions: every set must be met infinitely often.

    Attributes:
        propositions: The names that the guards are over.
        size: Number of states.
        initial: Initial states, ascending, at least one.
        sets: Number of acceptance sets; with none, every infinite run is accepting.
        edges: Ordered by source, target and marks, one for each such triple.

    Raises:
        ValueError: One of these does not hold.
    """

    propositions: tuple[str, ...]
    size: int
    initial: tuple[int, ...]
    sets: int
    edges: tuple[MarkedEdge, ...]

    def __post_init__(self) -> None:
        _check_states(self.propositions, self.size, self.initial)
        _check_edges(self.propositions, self.size, self.edges)
        keys = [(edge.source, edge.target, edge.marks) for edge in self.edges]
        if keys != sorted(set(keys)):
            raise ValueError("edges are not ordered by source, target and marks, or two of them could be one")
        for edge in self.edges:
            if list(edge.marks) != sorted({mark for mark in edge.marks if 0 <= mark < self.sets}):
                raise ValueError(f"an edge has the marks {edge.marks}, with {self.sets} acceptance sets")

    @cached_property
    def deterministic(self) -> bool:
        """Whether there is one initial state and no state has two transitions for the same letter."""
        return len(self.initial) == 1 and not _offers_a_choice(self.edges)

    @cached_property
    def complete(self) -> bool:
        """Whether every state has a transition for every letter."""
        return _read_everything(self.size, self.edges)


def _offers_a_choice(edges: Sequence[Edge | MarkedEdge]) -> bool:
    """Whether some state has two edges for the same letter."""
    diagrams = Diagrams()
    read: dict[int, Diagram] = {}
    for edge in edges:
        seen = read.get(edge.source, diagrams.false)
        letters = diagrams.any_of(map(diagrams.cube, edge.guard.cubes))
        if diagrams.both(seen, letters) != diagrams.false:
            return True
        read[edge.source] = diagrams.either(seen, letters)
    return False


def _read_everything(size: int, edges: Sequence[Edge | MarkedEdge]) -> bool:
    """Whether every state has an edge for every letter."""
    diagrams = Diagrams()
    read = [diagrams.false] * size
    for edge in edges:
        read[edge.source] = diagrams.either(read[edge.source], diagrams.any_of(map(diagrams.cube, edge.guard.cubes)))
    return all(letters == diagrams.true for letters in read)


def _check_states(propositions: tuple[str, ...], size: int, initial: tuple[int, ...]) -> None:
    if len(set(propositions)) != len(propositions):
        raise ValueError("a proposition is listed twice")
    if not initial or list(initial) != sorted({state for state in initial if 0 <= state < size}):
        raise ValueError(f"{initial} are no ordered initial states among {size} states")


def _check_edges(propositions: tuple[str, ...], size: int, edges: Sequence[Edge | MarkedEdge]) -> None:
    for edge in edges:
        if not (0 <= edge.source < size and 0 <= edge.target < size):
            raise ValueError(f"an edge from {edge.source} to {edge.target} leaves the {size} states")
        if edge.guard.propositions != propositions or not edge.guard.cubes:
            raise ValueError(f"the guard of the edge from {edge.source} to {edge.target} does not fit")


@dataclass(frozen=True, eq=False)
class CompiledAutomaton:
    """A Büchi automaton over the letters that really occur: one row for each transition.

    Rows are ordered by source, letter and target.

    Attributes:
        states: Number of states Q.
        sources: (N,) state that the transition leaves.
        letters: (N,) index of the letter that it reads.
        targets: (N,) state that it enters.
        initial: Initial states, ascending.
        accepting: (Q,) whether a state is accepting.
    """

    states: int
    sources: IntArray
    letters: IntArray
    targets: IntArray
    initial: IntArray
    accepting: BoolArray


@dataclass(frozen=True, eq=False)
class CompiledGeneralised:
    """A generalised Büchi automaton over the letters that really occur; rows as in ``CompiledAutomaton``.

    Attributes:
        states: Number of states Q.
        sets: Number of acceptance sets K.
        sources: (N,) state that the transition leaves.
        letters: (N,) index of the letter that it reads.
        targets: (N,) state that it enters.
        marks: (N, K) whether the transition belongs to an acceptance set.
        initial: Initial states, ascending.
    """

    states: int
    sets: int
    sources: IntArray
    letters: IntArray
    targets: IntArray
    marks: BoolArray
    initial: IntArray


def compile_to_alphabet(automaton: BuchiAutomaton, letters: tuple[Letter, ...]) -> CompiledAutomaton:
    """Restrict an automaton to ``letters``; propositions that it does not speak of are ignored."""
    rows, _ = _transitions(automaton.propositions, automaton.edges, letters)
    accepting = np.zeros(automaton.size, dtype=np.bool_)
    accepting[sorted(automaton.accepting)] = True
    return CompiledAutomaton(
        states=automaton.size,
        sources=_frozen(rows[:, 0]),
        letters=_frozen(rows[:, 1]),
        targets=_frozen(rows[:, 2]),
        initial=_frozen(np.array(automaton.initial, dtype=np.int64)),
        accepting=_frozen_flags(accepting),
    )


def compile_generalised(automaton: GeneralisedBuchi, letters: tuple[Letter, ...]) -> CompiledGeneralised:
    """The same for a generalised automaton."""
    rows, origins = _transitions(automaton.propositions, automaton.edges, letters)
    marked = np.zeros((len(automaton.edges), automaton.sets), dtype=np.bool_)
    for row, edge in enumerate(automaton.edges):
        marked[row, list(edge.marks)] = True
    return CompiledGeneralised(
        states=automaton.size,
        sets=automaton.sets,
        sources=_frozen(rows[:, 0]),
        letters=_frozen(rows[:, 1]),
        targets=_frozen(rows[:, 2]),
        marks=_frozen_flags(marked[origins]),
        initial=_frozen(np.array(automaton.initial, dtype=np.int64)),
    )


def generalised(automaton: CompiledAutomaton) -> CompiledGeneralised:
    """The same automaton with one acceptance set: the transitions that leave accepting states."""
    return CompiledGeneralised(
        states=automaton.states,
        sets=1,
        sources=automaton.sources,
        letters=automaton.letters,
        targets=automaton.targets,
        marks=_frozen_flags(automaton.accepting[automaton.sources][:, None]),
        initial=automaton.initial,
    )


def _transitions(
    propositions: tuple[str, ...], edges: Sequence[Edge | MarkedEdge], letters: tuple[Letter, ...]
) -> tuple[IntArray, IntArray]:
    """(N, 3) source, letter and target of every transition in order, and (N,) the edge that each comes from."""
    words = [sum(1 << bit for bit, name in enumerate(propositions) if name in letter) for letter in letters]
    allowed: dict[Guard, list[int]] = {}
    rows: list[tuple[int, int, int, int]] = []
    for index, edge in enumerate(edges):
        read = allowed.get(edge.guard)
        if read is None:
            read = [letter for letter, bits in enumerate(words) if edge.guard.allows_bits(bits)]
            allowed[edge.guard] = read
        rows.extend((edge.source, letter, edge.target, index) for letter in read)
    table = np.array(sorted(rows), dtype=np.int64).reshape(-1, 4)
    return table[:, :3], table[:, 3]


def _frozen(values: IntArray) -> IntArray:
    values = np.ascontiguousarray(values)
    values.setflags(write=False)
    return values


def _frozen_flags(values: BoolArray) -> BoolArray:
    values.setflags(write=False)
    return values


def states_with_nonempty_language(compiled: CompiledAutomaton) -> BoolArray:
    """(Q,) whether some infinite word over the letters of ``compiled`` is accepted from each state."""
    pairs = np.unique(np.column_stack((compiled.sources, compiled.targets)), axis=0)
    successors: list[list[int]] = [[] for _ in range(compiled.states)]
    for source, target in pairs.tolist():
        successors[source].append(target)
    heads = [
        component[0]
        for component in strong_components(successors, range(compiled.states))
        if compiled.accepting[component].any() and (len(component) > 1 or component[0] in successors[component[0]])
    ]
    alive = np.zeros(compiled.states, dtype=np.bool_)
    alive[sorted(backward_reachable(successors, heads))] = True
    return alive
