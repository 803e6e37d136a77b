"""The translator's working form of automata: one decision diagram for each state.

The diagram of a state maps a letter to the moves that the state has for it: a tuple of pairs (target state, marks),
where bit i of the marks says that the transition belongs to acceptance set i. A run is accepting if it meets every set
infinitely often.
"""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property, partial
from typing import Final

from mission.logic.automata.automaton import BuchiAutomaton, Edge, GeneralisedBuchi, MarkedEdge
from mission.logic.automata.components import backward_reachable, strong_components
from mission.logic.automata.diagrams import Diagram, Diagrams, TooLargeError
from mission.logic.automata.guards import Guard

_GROWTH_OF_READ: Final = 1_000_000  # nodes of diagrams
_WORK_OF_READ: Final = 20_000_000  # moves joined

Move = tuple[int, int]
Moves = tuple[Move, ...]


@dataclass(frozen=True)
class Structure:
    """A generalised Büchi automaton with marked transitions and one initial state.

    Attributes:
        diagrams: The pool that ``moves`` live in; variable i is proposition i.
        propositions: Names of the propositions.
        initial: The initial state.
        moves: One diagram a state, with ``Moves`` in ascending order on its leaves.
        sets: Number of acceptance sets.
    """

    diagrams: Diagrams
    propositions: tuple[str, ...]
    initial: int
    moves: tuple[Diagram, ...]
    sets: int

    @property
    def size(self) -> int:
        """Number of states."""
        return len(self.moves)

    @property
    def all_marks(self) -> int:
        """The marks of a transition that belongs to every set."""
        return (1 << self.sets) - 1

    def transitions(self) -> list[tuple[Move, ...]]:
        """The distinct moves of each state, over all letters, in a fixed order."""
        value = self.diagrams.value
        known: dict[Diagram, tuple[Move, ...]] = {}
        for diagram in self.moves:
            if diagram not in known:
                leaves = self.diagrams.leaves(diagram)
                known[diagram] = tuple(dict.fromkeys(move for leaf in leaves for move in value[leaf]))
        return [known[diagram] for diagram in self.moves]

    def successors(self) -> list[tuple[int, ...]]:
        """The distinct targets of each state."""
        return [tuple(dict.fromkeys(target for target, _ in moves)) for moves in self.transitions()]

    def rewritten(self, change: Callable[[Moves], Moves], sets: int | None = None) -> "Structure":
        """The structure with ``change`` made to the moves for each letter; it need not keep them in order."""
        known: dict[Diagram, Diagram] = {}

        def changed(moves: Moves) -> Moves:
            return tuple(sorted(set(change(moves))))

        moves = tuple(self.diagrams.transform(diagram, changed, known) for diagram in self.moves)
        return Structure(self.diagrams, self.propositions, self.initial, moves, self.sets if sets is None else sets)

    def restricted(self, keep: list[int]) -> "Structure":
        """Only the states ``keep``, numbered in that order; the initial state is among them."""
        number = {state: index for index, state in enumerate(keep)}
        smaller = Structure(
            self.diagrams,
            self.propositions,
            number[self.initial],
            tuple(self.moves[state] for state in keep),
            self.sets,
        )
        return smaller.rewritten(
            lambda moves: tuple((number[target], marks) for target, marks in moves if target in number)
        )

    @cached_property
    def deterministic(self) -> bool:
        """Whether no state has two moves for the same letter."""
        value = self.diagrams.value
        return all(len(value[leaf]) <= 1 for diagram in set(self.moves) for leaf in self.diagrams.leaves(diagram))

    @cached_property
    def edge_count(self) -> int:
        """Number of pairs of states with a move from the one to the other."""
        return sum(map(len, self.successors()))

    @cached_property
    def accepting_by_state(self) -> bool:
        """Whether all moves of a state that stay in its component are in the same sets, and there is at most one."""
        if self.sets > 1:
            return False
        parts = components(self)
        for state, moves in enumerate(self.transitions()):
            home = parts.of_state[state]
            if len({marks for target, marks in moves if parts.of_state[target] == home}) > 1:
                return False
        return True


@dataclass(frozen=True)
class Components:
    """The strongly connected components of a structure, each before those that lead to it.

    Attributes:
        members: The states of each.
        of_state: The component of each state; -1 where unreachable.
        accepting: Whether a run can stay in the component and meet every acceptance set.
        cyclic: Whether a run can stay in the component at all.
    """

    members: tuple[tuple[int, ...], ...]
    of_state: tuple[int, ...]
    accepting: tuple[bool, ...]
    cyclic: tuple[bool, ...]


def components(structure: Structure) -> Components:
    """Find the components that the initial state reaches."""
    transitions = structure.transitions()
    successors = structure.successors()
    found = strong_components(successors, (structure.initial,))
    of_state = [-1] * structure.size
    for index, states in enumerate(found):
        for state in states:
            of_state[state] = index
    met = [-1] * len(found)
    for state, moves in enumerate(transitions):
        component = of_state[state]
        for target, marks in moves:
            if component >= 0 and of_state[target] == component:
                met[component] = max(met[component], 0) | marks
    return Components(
        members=tuple(tuple(sorted(states)) for states in found),
        of_state=tuple(of_state),
        accepting=tuple(marks == structure.all_marks for marks in met),
        cyclic=tuple(marks >= 0 for marks in met),
    )


def pruned(structure: Structure) -> Structure:
    """Without states that are unreachable or accept nothing; the initial state stays.

    Acceptance sets are reduced to as many as some component needs: one that contains another one there is superfluous
    there. Marks that no accepting run can meet infinitely often are taken away.
    """
    parts = components(structure)
    needed = _needed_sets(structure, parts)
    sets = max((len(kept) for kept in needed.values()), default=0)
    if sets == 0 and structure.sets and parts.accepting != parts.cyclic:
        sets = 1  # it tells components where every run is accepting from those where none is
    successors = structure.successors()
    heads = [states[0] for states, accepting in zip(parts.members, parts.accepting, strict=True) if accepting]
    alive = backward_reachable(successors, heads)
    if structure.initial not in alive:
        nothing = structure.diagrams.leaf(())
        return Structure(structure.diagrams, structure.propositions, 0, (nothing,), sets)
    keep = [state for state in range(structure.size) if state in alive and parts.of_state[state] >= 0]
    known: dict[int, dict[Diagram, Diagram]] = {}
    moves = []
    for state, diagram in enumerate(structure.moves):
        home = parts.of_state[state]
        change = partial(_remarked, home if home in needed else None, parts.of_state, needed.get(home, []), sets)
        moves.append(structure.diagrams.transform(diagram, change, known.setdefault(home, {})))
    changed = Structure(structure.diagrams, structure.propositions, structure.initial, tuple(moves), sets)
    return changed.restricted(keep)


def _needed_sets(structure: Structure, parts: Components) -> dict[int, list[int]]:
    """For each accepting component, acceptance sets that together ask for the same as all of them."""
    seen: dict[int, set[int]] = {}
    for state, moves in enumerate(structure.transitions()):
        home = parts.of_state[state]
        if home >= 0 and parts.accepting[home]:
            inside = (marks for target, marks in moves if parts.of_state[target] == home)
            seen.setdefault(home, set()).update(inside)
    return {home: _minimal_sets(structure.sets, marks) for home, marks in seen.items()}


def _minimal_sets(sets: int, seen: set[int]) -> list[int]:
    kept: list[int] = []
    for index in range(sets):
        others = kept + list(range(index + 1, sets))
        contains = any(all(marks >> index & 1 for marks in seen if marks >> other & 1) for other in others)
        if not contains and not all(marks >> index & 1 for marks in seen):
            kept.append(index)
    return kept


def _remarked(home: int | None, of_state: tuple[int, ...], kept: list[int], sets: int, moves: Moves) -> Moves:
    """The moves of a state of component ``home`` (None: no accepting one) with the sets ``kept`` numbered afresh."""
    always = (1 << sets) - (1 << len(kept))
    return tuple(
        sorted(
            {
                (target, always | sum((marks >> index & 1) << bit for bit, index in enumerate(kept)))
                if of_state[target] == home
                else (target, 0)
                for target, marks in moves
            }
        )
    )


def state_based(structure: Structure) -> BuchiAutomaton:
    """The automaton of a structure with at most one set, where a state's transitions are all in it or all not.

    States are numbered in the order in which a breadth-first search meets them.
    """
    order = _breadth_first(structure)
    parts = components(structure)
    number = {state: index for index, state in enumerate(order)}
    known: dict[Diagram, dict[Diagram, Diagram]] = {}
    edges: list[Edge] = []
    accepting: set[int] = set()
    for state in order:
        guards = _guards(structure, state, known)
        if parts.accepting[parts.of_state[state]] and (not structure.sets or any(marks for _, marks in guards)):
            accepting.add(number[state])
        edges.extend(Edge(number[state], guard, number[target]) for (target, _), guard in guards.items())
    edges.sort(key=lambda edge: (edge.source, edge.target))
    return BuchiAutomaton(structure.propositions, len(order), (0,), frozenset(accepting), tuple(edges))


def transition_based(structure: Structure) -> GeneralisedBuchi:
    """A structure as a value; states are numbered in the order in which a breadth-first search meets them."""
    order = _breadth_first(structure)
    number = {state: index for index, state in enumerate(order)}
    known: dict[Diagram, dict[Diagram, Diagram]] = {}
    edges = [
        MarkedEdge(number[state], guard, number[target], _listed(marks))
        for state in order
        for (target, marks), guard in _guards(structure, state, known).items()
    ]
    edges.sort(key=lambda edge: (edge.source, edge.target, edge.marks))
    return GeneralisedBuchi(structure.propositions, len(order), (0,), structure.sets, tuple(edges))


def structure_of(automaton: GeneralisedBuchi) -> Structure:
    """The working form of an automaton; several initial states become one more state with the moves of all.

    Raises:
        TooLargeError: States tell too many letters apart.
    """
    diagrams = Diagrams()
    diagrams.allow(_GROWTH_OF_READ)
    work = _WORK_OF_READ
    nothing = diagrams.leaf(())
    known: dict[tuple[Diagram, Diagram], Diagram] = {}
    rows = [nothing] * automaton.size

    def union(left: Moves, right: Moves) -> Moves:
        nonlocal work
        work -= len(left) + len(right)
        if work < 0:
            raise TooLargeError
        return tuple(sorted({*left, *right}))

    for edge in automaton.edges:
        marks = sum(1 << mark for mark in edge.marks)
        letters = diagrams.any_of(map(diagrams.cube, edge.guard.cubes))
        row = diagrams.choose(letters, diagrams.leaf(((edge.target, marks),)), nothing)
        rows[edge.source] = diagrams.combine(rows[edge.source], row, union, known)
    initial = automaton.initial[0]
    if len(automaton.initial) > 1:
        start = nothing
        for state in automaton.initial:
            start = diagrams.combine(start, rows[state], union, known)
        initial = len(rows)
        rows.append(start)
    return Structure(diagrams, automaton.propositions, initial, tuple(rows), automaton.sets)


def _listed(marks: int) -> tuple[int, ...]:
    return tuple(index for index in range(marks.bit_length()) if marks >> index & 1)


def _breadth_first(structure: Structure) -> list[int]:
    successors = structure.successors()
    order = {structure.initial: None}
    for state in (queue := [structure.initial]):
        for target in successors[state]:
            if target not in order:
                order[target] = None
                queue.append(target)
    return list(order)


def _guards(structure: Structure, state: int, known: dict[Diagram, dict[Diagram, Diagram]]) -> dict[Move, Guard]:
    """The moves of a state, each with the letters that it is made for."""
    diagrams = structure.diagrams
    letters: dict[Move, Diagram] = {}
    for leaf, here in diagrams.regions(structure.moves[state], known).items():
        for move in diagrams.value[leaf]:
            letters[move] = diagrams.either(letters.get(move, diagrams.false), here)
    return {move: Guard(structure.propositions, diagrams.cover(where)) for move, where in letters.items()}
