"""Smaller automata by direct simulation.

A state simulates another one if it can answer each of its moves, for each letter, by a move that belongs to at least
the same acceptance sets and enters a state that simulates the one entered. States that simulate each other are one
state, and a move that another one simulates is superfluous (Etessami, Wilke and Schuller, "Fair simulation relations,
parity games, and state space reduction for Büchi automata", 2001; Babiak et al., "Compositional approach to suspension
and other improvements to LTL translation", 2013, for the sets on transitions).
"""

from collections.abc import Iterable
from functools import reduce
from operator import or_

from mission.logic.structure import Moves, Structure, pruned

_MAX_STATES = 400
_MAX_CLASSES = 4096


def reduced(structure: Structure) -> Structure:
    """A structure that accepts the same words, with no more states and moves; unchanged where it is too large."""
    current = pruned(structure)
    while True:
        smaller = _quotient(current)
        if smaller is None:
            return current
        smaller = pruned(smaller)
        if smaller.size == current.size and smaller.moves == current.moves:
            return smaller
        current = smaller


def _quotient(structure: Structure) -> Structure | None:
    if structure.size > _MAX_STATES:
        return None
    letters = _letter_classes(structure)
    if letters is None:
        return None
    above = _simulators(structure, letters)
    representative = [
        min(other for other in range(structure.size) if above[state] >> other & 1 and above[other] >> state & 1)
        for state in range(structure.size)
    ]

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


def _letter_classes(structure: Structure) -> list[tuple[Moves, ...]] | None:
    """For each set of letters that no state tells apart, the moves of every state; None if they are too many."""
    diagrams = structure.diagrams
    joint = diagrams.leaf(())
    for diagram in structure.moves:
        known: dict[tuple[int, int], int] = {}
        joint = diagrams.combine(joint, diagram, lambda row, moves: (*row, moves), known)
        if len(known) > 4 * _MAX_CLASSES:
            return None
    classes = [diagrams.value[leaf] for leaf in diagrams.leaves(joint)]
    return classes if len(classes) <= _MAX_CLASSES else None


def _simulators(structure: Structure, letters: list[tuple[Moves, ...]]) -> list[int]:
    """For each state, the bits of the states that simulate it."""
    size = structure.size
    entering = [_entering(rows) for rows in letters]
    demands = [
        sorted({(index, marks, target) for index, rows in enumerate(letters) for target, marks in rows[state]})
        for state in range(size)
    ]
    above = [(1 << size) - 1] * size
    while True:
        answered: dict[tuple[int, int, int], int] = {}
        following = []
        for state in range(size):
            able = above[state]
            for index, marks, target in demands[state]:
                key = (index, marks, above[target])
                if key not in answered:
                    answered[key] = _union(
                        sources for entered, sources in entering[index][marks] if above[target] >> entered & 1
                    )
                able &= answered[key]
            following.append(able)
        if following == above:
            return above
        above = following


def _entering(rows: tuple[Moves, ...]) -> dict[int, list[tuple[int, int]]]:
    """For each marks, the states entered by moves with these marks or more, with the bits of where from."""
    wanted = {marks for moves in rows for _, marks in moves}
    entering: dict[int, dict[int, int]] = {marks: {} for marks in wanted}
    for state, moves in enumerate(rows):
        for target, marks in moves:
            for less in wanted:
                if not less & ~marks:
                    entering[less][target] = entering[less].get(target, 0) | 1 << state
    return {marks: list(table.items()) for marks, table in entering.items()}


def _union(parts: Iterable[int]) -> int:
    return reduce(or_, parts, 0)
