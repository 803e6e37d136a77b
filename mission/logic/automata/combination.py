"""Automata of two things at once, and of either."""

from itertools import product
from typing import Final

from mission.errors import AutomatonSizeError
from mission.logic.automata.automaton import BuchiAutomaton, Edge, GeneralisedBuchi, MarkedEdge
from mission.logic.automata.diagrams import Diagrams, TooLargeError
from mission.logic.automata.guards import Guard

MAX_STATES: Final = 20_000
"""States of an intersection at which its construction gives up."""


def intersection(left: GeneralisedBuchi, right: GeneralisedBuchi) -> GeneralisedBuchi:
    """An automaton of the words that both accept: runs go side by side and meet the acceptance sets of both.

    The propositions are those of the left, then further ones of the right; so are the acceptance sets.

    Raises:
        AutomatonSizeError: It has too many states.
    """
    names = tuple(dict.fromkeys((*left.propositions, *right.propositions)))
    joint = _JointGuards(names)
    outgoing = _outgoing(left), _outgoing(right)
    queue = [(a, b) for a in left.initial for b in right.initial]
    number = {pair: index for index, pair in enumerate(queue)}
    initial = tuple(range(len(queue)))
    edges: list[MarkedEdge] = []
    for source, (a, b) in enumerate(queue):
        for one, other in product(outgoing[0][a], outgoing[1][b]):
            guard = joint.both(one.guard, other.guard)
            if guard is None:
                continue
            pair = (one.target, other.target)
            if pair not in number:
                number[pair] = len(queue)
                queue.append(pair)
            marks = (*one.marks, *(left.sets + mark for mark in other.marks))
            edges.append(MarkedEdge(source, guard, number[pair], marks))
        if len(queue) > MAX_STATES:
            raise _too_large()
    edges.sort(key=lambda edge: (edge.source, edge.target, edge.marks))
    return GeneralisedBuchi(names, len(queue), initial, left.sets + right.sets, tuple(edges))


def union(*automata: BuchiAutomaton) -> BuchiAutomaton:
    """An automaton of the words that one of these accepts, at least: all of them side by side."""
    names = tuple(dict.fromkeys(name for automaton in automata for name in automaton.propositions))
    initial: list[int] = []
    accepting: list[int] = []
    edges: list[Edge] = []
    size = 0
    for part in automata:
        initial += [size + state for state in part.initial]
        accepting += [size + state for state in part.accepting]
        edges += [Edge(size + edge.source, over(names, edge.guard), size + edge.target) for edge in part.edges]
        size += part.size
    return BuchiAutomaton(names, size, tuple(initial), frozenset(accepting), tuple(edges))


def over(names: tuple[str, ...], guard: Guard) -> Guard:
    """The same guard over more propositions."""
    places = [names.index(name) for name in guard.propositions]

    def placed(bits: int) -> int:
        return sum(1 << place for bit, place in enumerate(places) if bits >> bit & 1)

    return Guard(names, tuple((placed(holds), placed(fails)) for holds, fails in guard.cubes))


def _too_large() -> AutomatonSizeError:
    return AutomatonSizeError(
        f"the mission's automaton and its tasks together have more than {MAX_STATES} states, or too complicated labels"
    )


def _outgoing(automaton: GeneralisedBuchi) -> list[list[MarkedEdge]]:
    groups: list[list[MarkedEdge]] = [[] for _ in range(automaton.size)]
    for edge in automaton.edges:
        groups[edge.source].append(edge)
    return groups


class _JointGuards:
    """Conjunctions of guards over the propositions of both."""

    def __init__(self, names: tuple[str, ...]) -> None:
        self._names = names
        self._diagrams = Diagrams()
        self._known: dict[tuple[Guard, Guard], Guard | None] = {}

    def both(self, one: Guard, other: Guard) -> Guard | None:
        """What both allow; None where that is nothing."""
        if (one, other) not in self._known:
            diagrams = self._diagrams
            parts = (over(self._names, guard).cubes for guard in (one, other))
            try:
                cubes = diagrams.cover(diagrams.all_of(diagrams.any_of(map(diagrams.cube, part)) for part in parts))
            except TooLargeError as error:
                raise _too_large() from error
            self._known[one, other] = Guard(self._names, cubes) if cubes else None
        return self._known[one, other]
