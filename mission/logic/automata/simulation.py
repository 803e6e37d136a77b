"""Smaller automata by direct simulation, forward and backward.

A state simulates another one if it can answer each of its moves, for each letter, by a move that belongs to at least
the same acceptance sets and enters a state that simulates the one entered. States that simulate each other are one
state, and a move that another one simulates is superfluous (Etessami, Wilke and Schuller, "Fair simulation relations,
parity games, and state space reduction for Büchi automata", 2001; Babiak et al., "Compositional approach to suspension
and other improvements to LTL translation", 2013, for the sets on transitions).

Backward, the same is asked of the moves that enter a state, and only the initial state simulates the initial state.
States that simulate each other backward are one state with the moves of both, and a move is superfluous if one for the
same letter, with at least its marks, enters the same state from a state that simulates its source backward (Somenzi and
Bloem, "Efficient Büchi automata from LTL formulae", 2000; Clemente and Mayr, "Advanced automata minimization", 2013).
"""

from functools import partial
from typing import TYPE_CHECKING, Final

from mission.logic.automata.simulators import backward, letter_classes, simulators
from mission.logic.automata.structure import Moves, Structure, components, pruned

if TYPE_CHECKING:
    from mission.logic.automata.diagrams import Diagram

_MAX_STEPS: Final = 1_000_000  # rounds of refinement times states


def reduced(structure: Structure) -> Structure:
    """A structure that accepts the same words, with no more states and moves; unchanged where it is too large.

    One whose states accept stays so, and then all moves of a state have the same marks.
    """
    by_state = structure.accepting_by_state
    current = pruned(_bisimilar(pruned(structure)))
    while not current.deterministic:
        smaller = _smaller(current, by_state=by_state)
        if smaller is None or (smaller.size == current.size and smaller.moves == current.moves):
            break
        current = smaller
    return _marked_by_state(current) if by_state else current


def _smaller(structure: Structure, *, by_state: bool) -> Structure | None:
    """One round of both quotients; None where the structure is too large."""
    letters = letter_classes(structure)
    if letters is None:
        return None
    smaller = pruned(_forward_quotient(structure, letters))
    if smaller.deterministic:
        return smaller
    if by_state:
        smaller = _marked_by_state(smaller)
    letters = letter_classes(smaller)
    return smaller if letters is None else pruned(_backward_quotient(smaller, letters, by_state=by_state))


def _marked_by_state(structure: Structure) -> Structure:
    """The marks of a state's moves that stay in its component on all its moves.

    That is right where the marks come from accepting states: a state that simulates an accepting one is accepting.
    """
    parts = components(structure)
    rows = []
    for state, transitions in enumerate(structure.transitions()):
        inner = [marks for target, marks in transitions if parts.of_state[target] == parts.of_state[state]]
        change = partial(_remarked, max(inner, default=0))
        rows.append(structure.diagrams.transform(structure.moves[state], change, {}))
    return Structure(structure.diagrams, structure.propositions, structure.initial, tuple(rows), structure.sets)


def _remarked(marks: int, moves: Moves) -> Moves:
    return tuple(sorted({(target, marks) for target, _ in moves}))


def _bisimilar(structure: Structure) -> Structure:
    """States with the same moves into the same classes made one; in a deterministic structure no others are equal.

    Unchanged where that takes too long.
    """
    classes = [0] * structure.size
    for _ in range(_MAX_STEPS // structure.size):
        known: dict[Diagram, Diagram] = {}
        rows = [structure.diagrams.transform(row, partial(_classed, classes), known) for row in structure.moves]
        numbers: dict[tuple[int, Diagram], int] = {}
        finer = [numbers.setdefault(key, len(numbers)) for key in zip(classes, rows, strict=True)]
        if finer == classes:
            break
        classes = finer
    else:
        return structure
    first = dict(zip(classes[::-1], range(structure.size - 1, -1, -1), strict=True))
    moves = tuple(rows[first[number]] for number in range(len(first)))
    return Structure(structure.diagrams, structure.propositions, classes[structure.initial], moves, structure.sets)


def _classed(classes: list[int], moves: Moves) -> Moves:
    return tuple(sorted({(classes[target], marks) for target, marks in moves}))


def _forward_quotient(structure: Structure, letters: list[tuple[Moves, ...]]) -> Structure:
    above = simulators(letters, [(1 << structure.size) - 1] * structure.size)
    representative = _representatives(above)

    def maximal(moves: Moves) -> Moves:
        renamed = sorted({(representative[target], marks) for target, marks in moves})
        kept = []
        for target, marks in renamed:
            if not any(
                above[target] >> other & 1 and not marks & ~more
                for other, more in renamed
                if (other, more) != (target, marks)
            ):
                kept.append((target, marks))
        return tuple(kept)

    changed = structure.rewritten(maximal)
    keep = sorted(set(representative))
    moved = Structure(
        changed.diagrams,
        changed.propositions,
        representative[changed.initial],
        changed.moves,
        changed.sets,
    )
    return moved.restricted(keep)


def _backward_quotient(structure: Structure, letters: list[tuple[Moves, ...]], *, by_state: bool) -> Structure:
    size, diagrams = structure.size, structure.diagrams
    start = [(1 << size) - 1] * size
    if by_state:
        accepting = [any(marks for _, marks in moves) for moves in structure.transitions()]
        these = sum(1 << state for state in range(size) if accepting[state])
        start = [these if accepts else (1 << size) - 1 for accepts in accepting]
    start[structure.initial] &= 1 << structure.initial
    above = simulators([backward(rows) for rows in letters], start)
    representative = _representatives(above)

    def union(left: Moves, right: Moves) -> Moves:
        return tuple(sorted({*left, *right}))

    def without(left: Moves, right: Moves) -> Moves:
        return tuple(
            (target, marks)
            for target, marks in left
            if not any(target == other and not marks & ~more for other, more in right)
        )

    renamed = structure.rewritten(lambda moves: tuple((representative[target], marks) for target, marks in moves))
    joined: dict[int, Diagram] = {}
    known: dict[tuple[Diagram, Diagram], Diagram] = {}
    for state, moves in enumerate(renamed.moves):
        home = representative[state]
        joined[home] = diagrams.combine(joined[home], moves, union, known) if home in joined else moves
    known = {}
    rows = list(renamed.moves)
    for state, moves in joined.items():
        rows[state] = moves
        for other, better in joined.items():
            if other != state and above[state] >> other & 1:
                rows[state] = diagrams.combine(rows[state], better, without, known)
    smaller = Structure(diagrams, structure.propositions, structure.initial, tuple(rows), structure.sets)
    return smaller.restricted(sorted(joined))


def _representatives(above: list[int]) -> list[int]:
    """For each state, the first of those that simulate it and that it simulates."""
    return [
        min(other for other in range(len(above)) if simulators >> other & 1 and above[other] >> state & 1)
        for state, simulators in enumerate(above)
    ]
