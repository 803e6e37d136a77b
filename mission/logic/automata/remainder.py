"""What is left of an automaton once a beginning of a word has been read."""

from collections.abc import Iterable
from dataclasses import replace

from mission.logic.automata.automaton import GeneralisedBuchi, MarkedEdge
from mission.logic.automata.guards import Guard
from mission.logic.formula.word import Letter


def remainder(automaton: GeneralisedBuchi, word: Iterable[Letter]) -> GeneralisedBuchi | None:
    """The automaton that accepts v exactly if w.v is accepted: it begins in the states that w leads to.

    Args:
        automaton: Of the whole word.
        word: How it begins, w.

    Returns:
        None where no run reads that beginning.
    """
    states = set(automaton.initial)
    for letter in word:
        states = {edge.target for edge in automaton.edges if edge.source in states and edge.guard.allows(letter)}
        if not states:
            return None
    return replace(automaton, initial=tuple(sorted(states)))


def delayed(automaton: GeneralisedBuchi) -> GeneralisedBuchi:
    """The automaton of the words that are accepted from their second letter on."""
    first, anything = automaton.size, Guard(automaton.propositions, ((0, 0),))
    edges = (MarkedEdge(first, anything, state, ()) for state in automaton.initial)
    return replace(automaton, size=first + 1, initial=(first,), edges=(*automaton.edges, *edges))
