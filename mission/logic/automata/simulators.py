"""Which states of a structure simulate which: the largest such relation, found by refinement.

States are bits of integers, so that one operation looks at all of them.
"""

from collections.abc import Sequence
from typing import Final

from mission.logic.automata.diagrams import LEAF
from mission.logic.automata.structure import Move, Moves, Structure

_MAX_STATES: Final = 1000
_MAX_ENTRIES: Final = 1 << 18  # states times classes of letters


def letter_classes(structure: Structure) -> list[tuple[Moves, ...]] | None:
    """For each set of letters that no state tells apart, the moves of every state; None where it is too large."""
    if structure.size > _MAX_STATES:
        return None
    diagrams = structure.diagrams
    variable, value, split = diagrams.variable, diagrams.value, diagrams.split
    column = {diagram: index for index, diagram in enumerate(dict.fromkeys(structure.moves))}
    columns = [column[diagram] for diagram in structure.moves]
    classes: list[tuple[Moves, ...]] = []
    pending = [tuple(column)]
    seen = set(pending)
    while pending:
        nodes = pending.pop()
        first = min(variable[node] for node in nodes)
        if first == LEAF:
            if len(classes) * structure.size >= _MAX_ENTRIES:
                return None
            classes.append(tuple(value[nodes[index]] for index in columns))
            continue
        for half in zip(*(split(node, first) for node in nodes), strict=True):
            if half not in seen:
                seen.add(half)
                pending.append(half)
    return classes


def backward(rows: tuple[Moves, ...]) -> tuple[Moves, ...]:
    """For each state, the moves that enter it, with where they come from."""
    entering: list[list[Move]] = [[] for _ in rows]
    for state, moves in enumerate(rows):
        for target, marks in moves:
            entering[target].append((state, marks))
    return tuple(map(tuple, entering))


def simulators(letters: Sequence[tuple[Moves, ...]], start: Sequence[int]) -> list[int]:
    """For each state, the bits of the states that simulate it, out of those of ``start``."""
    size = len(start)
    entering = [_entering(rows) for rows in letters]
    demands: list[set[tuple[int, int, int]]] = [set() for _ in range(size)]  # on those who simulate, by target
    for index, rows in enumerate(letters):
        for state, moves in enumerate(rows):
            for target, marks in moves:
                demands[target].add((state, index, marks))
    above = list(start)
    changed = set(range(size))
    answered: dict[tuple[int, int, int], int] = {}
    while changed:
        following = list(above)
        for target in changed:
            for state, index, marks in demands[target]:
                key = (index, marks, above[target])
                if key not in answered:
                    answered[key] = _answering(entering[index][marks], above[target])
                following[state] &= answered[key]
        changed = {state for state in range(size) if following[state] != above[state]}
        above = following
    return above


def _entering(rows: tuple[Moves, ...]) -> dict[int, dict[int, int]]:
    """For each marks, the states entered by moves with these marks or more, with the bits of where from."""
    wanted = {marks for moves in rows for _, marks in moves}
    entering: dict[int, dict[int, int]] = {marks: {} for marks in wanted}
    for state, moves in enumerate(rows):
        for target, marks in moves:
            for less in wanted:
                if not less & ~marks:
                    entering[less][target] = entering[less].get(target, 0) | 1 << state
    return entering


def _answering(entering: dict[int, int], states: int) -> int:
    """The bits of where the moves come from that enter a state of the bits ``states``."""
    sources = 0
    if states.bit_count() > len(entering):
        for entered, bits in entering.items():
            if states >> entered & 1:
                sources |= bits
        return sources
    while states:
        lowest = states & -states
        sources |= entering.get(lowest.bit_length() - 1, 0)
        states ^= lowest
    return sources
