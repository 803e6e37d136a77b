"""A state that only waits, and need not commit itself to what it could wait in as well.

In the automaton of ``F G a | G F b``, one state waits for a guess: it reads everything, and may enter at any time the
state of ``G F b``, which reads everything too. Its loop may as well bear the marks of that state's loop: a run that
stays in it for ever meets the acceptance sets exactly where one does that enters the other state at once.
"""

from collections import Counter
from functools import partial
from typing import Final

from mission.logic.automata.simulators import letter_classes, simulators
from mission.logic.automata.structure import Moves, Structure, components

_BOTH: Final = 2  # states that lead to one: itself and another one


def anticipated(structure: Structure) -> Structure:
    """An automaton of the same words, where states that no run is accepted in bear the marks of one that they lead to.

    The other one has loops for all letters for which the first one has, and whatever it can do, the first one can at
    once as well. Nothing else leads to it, so that it is superfluous then, or nearly.
    """
    pairs = _pairs(structure)
    letters = letter_classes(structure) if pairs else None
    if letters is None:
        return structure
    pairs = [(state, other) for state, other in pairs if all(_follows(row, state, other) for row in letters)]
    above = simulators(letters, [(1 << structure.size) - 1] * structure.size) if pairs else []
    rows = list(structure.moves)
    for state, other in pairs:
        if rows[state] == structure.moves[state] and all(_covers(row, state, other, above) for row in letters):
            rows[state] = structure.diagrams.combine(rows[state], rows[other], partial(_marked, state, other), {})
    return Structure(structure.diagrams, structure.propositions, structure.initial, tuple(rows), structure.sets)


def _pairs(structure: Structure) -> list[tuple[int, int]]:
    """States with loops that are components of their own where nothing is accepted, with accepting ones after them."""
    parts = components(structure)
    successors = structure.successors()
    entering = Counter(target for targets in successors for target in targets)
    return [
        (members[0], other)
        for members, accepting in zip(parts.members, parts.accepting, strict=True)
        if not accepting and len(members) == 1 and members[0] in successors[members[0]]
        for other in successors[members[0]]
        if parts.accepting[parts.of_state[other]] and other in successors[other] and entering[other] <= _BOTH
    ]


def _follows(row: tuple[Moves, ...], state: int, other: int) -> bool:
    """Whether the other state has a loop for a letter if the first one has."""
    return _loops(row, other) or not _loops(row, state)


def _loops(row: tuple[Moves, ...], state: int) -> bool:
    return any(target == state for target, _ in row[state])


def _covers(row: tuple[Moves, ...], state: int, other: int, above: list[int]) -> bool:
    """Whether a state answers all moves of another one for a letter; what they meet does not matter, as it is once."""
    entered = sum(1 << target for target in {target for target, _ in row[state]})
    return all(above[target] & entered for target, _ in row[other])


def _marked(state: int, other: int, mine: Moves, others: Moves) -> Moves:
    """The moves of ``state`` with its loops as those of ``other``."""
    loops = {(state, marks) for target, marks in others if target == other}
    kept = {move for move in mine if move[0] != state}
    return tuple(sorted(kept | loops)) if len(kept) < len(mine) else mine
