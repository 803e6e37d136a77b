"""Between automata with accepting states and generalised ones with marked transitions."""

from contextlib import suppress
from typing import Final

from mission.errors import AutomatonSizeError
from mission.logic.automata.automaton import BuchiAutomaton, Edge, GeneralisedBuchi, MarkedEdge
from mission.logic.automata.degeneralisation import degeneralised
from mission.logic.automata.diagrams import TooLargeError
from mission.logic.automata.simulation import reduced
from mission.logic.automata.structure import state_based, structure_of

MAX_COPIES: Final = 100_000
"""States times acceptance sets of an automaton that is given accepting states."""


def with_accepting_states(automaton: GeneralisedBuchi) -> BuchiAutomaton:
    """An automaton of the same words with accepting states.

    Where all transitions of each state are marked or none is, and there is one set at most, the states keep their
    numbers. Any other automaton loses states that are not needed, and may get copies of others.

    Raises:
        AutomatonSizeError: It is too large for that.
    """
    kept = _with_the_same_states(automaton)
    if kept is not None:
        return kept
    if automaton.size * automaton.sets <= MAX_COPIES:
        with suppress(TooLargeError):
            structure = structure_of(automaton)
            return state_based(reduced(degeneralised(structure, range(structure.sets))))
    raise AutomatonSizeError(
        f"the automaton has {automaton.size} states and {automaton.sets} acceptance sets, too many to be given "
        "accepting states; give one with Büchi acceptance on states"
    )


def with_marked_transitions(automaton: BuchiAutomaton) -> GeneralisedBuchi:
    """An automaton with accepting states as one whose transitions from these are marked."""
    edges = tuple(
        MarkedEdge(edge.source, edge.guard, edge.target, (0,) * (edge.source in automaton.accepting))
        for edge in automaton.edges
    )
    return GeneralisedBuchi(automaton.propositions, automaton.size, automaton.initial, 1, edges)


def _with_the_same_states(automaton: GeneralisedBuchi) -> BuchiAutomaton | None:
    if automaton.sets > 1:
        return None
    marks: dict[int, set[tuple[int, ...]]] = {}
    for edge in automaton.edges:
        marks.setdefault(edge.source, set()).add(edge.marks)
    if any(len(found) > 1 for found in marks.values()):
        return None
    wanted = tuple(range(automaton.sets))
    accepting = frozenset(state for state, found in marks.items() if wanted in found)
    edges = tuple(Edge(edge.source, edge.guard, edge.target) for edge in automaton.edges)
    return BuchiAutomaton(automaton.propositions, automaton.size, automaton.initial, accepting, edges)
