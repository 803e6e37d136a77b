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

from collections.abc import Iterable
from functools import reduce
from operator import or_

from mission.logic.diagrams import Diagram
from mission.logic.structure import Move, Moves, Structure, pruned

_MAX_STATES = 400
_MAX_CLASSES = 4096


def reduced(structure: Structure) -> Structure:
    """A structure that accepts the same words, with no more states and moves; unchanged where it is too large."""
    current = pruned(structure)
    while True:
        smaller = current
        for quotient in (_forward_quotient, _backward_quotient):
            letters = _letter_classes(smaller)
            if letters is None:
                return smaller
            smaller = pruned(quotient(smaller, letters))
        if smaller.size == current.size and smaller.moves == current.moves:
            return smaller
        current = smaller


def _forward_quotient(structure: Structure, letters: list[tuple[Moves, ...]]) -> Structure:
    above = _simulators(letters, [(1 << structure.size) - 1] * structure.size)
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


def _backward_quotient(structure: Structure, letters: list[tuple[Moves, ...]]) -> Structure:
    if structure.deterministic:
        return structure  # a word leads to one state, so that only a state itself simulates it backward
    size, diagrams = structure.size, structure.diagrams
    start = [(1 << size) - 1] * size
    start[structure.initial] = 1 << structure.initial
    above = _simulators([_reversed(rows) for rows in letters], start)
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
        for other in joined:
            if other != state and above[state] >> other & 1:
                rows[state] = diagrams.combine(rows[state], joined[other], without, known)
    smaller = Structure(diagrams, structure.propositions, structure.initial, tuple(rows), structure.sets)
    return smaller.restricted(sorted(joined))


def _representatives(above: list[int]) -> list[int]:
    """For each state, the first of those that simulate it and that it simulates."""
    return [
        min(other for other in range(len(above)) if simulators >> other & 1 and above[other] >> state & 1)
        for state, simulators in enumerate(above)
    ]


def _reversed(rows: tuple[Moves, ...]) -> tuple[Moves, ...]:
    """For each state, the moves that enter it, with where they come from."""
    entering: list[list[Move]] = [[] for _ in rows]
    for state, moves in enumerate(rows):
        for target, marks in moves:
            entering[target].append((state, marks))
    return tuple(map(tuple, entering))


def _letter_classes(structure: Structure) -> list[tuple[Moves, ...]] | None:
    """For each set of letters that no state tells apart, the moves of every state; None where it is too large."""
    if structure.size > _MAX_STATES:
        return None
    diagrams = structure.diagrams
    joint = diagrams.leaf(())
    for diagram in structure.moves:
        known: dict[tuple[int, int], int] = {}
        joint = diagrams.combine(joint, diagram, lambda row, moves: (*row, moves), known)
        if len(known) > 4 * _MAX_CLASSES:
            return None
    classes = [diagrams.value[leaf] for leaf in diagrams.leaves(joint)]
    return classes if len(classes) <= _MAX_CLASSES else None


def _simulators(letters: list[tuple[Moves, ...]], start: list[int]) -> list[int]:
    """For each state, the bits of the states that simulate it, out of those of ``start``."""
    size = len(start)
    entering = [_entering(rows) for rows in letters]
    demands = [
        sorted({(index, marks, target) for index, rows in enumerate(letters) for target, marks in rows[state]})
        for state in range(size)
    ]
    above = start
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
