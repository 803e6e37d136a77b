"""From many acceptance sets on transitions to one set of accepting states.

Copies of the states, one for each level, wait for the sets one after the other; sets that are met on the way are
skipped (Gastin and Oddoux, 2001; Giannakopoulou and Lerda, "From states to transitions", 2002). Levels are kept only
inside a component where a run can be accepting.
"""

from mission.logic.structure import Moves, Structure, components


def degeneralised(structure: Structure, order: tuple[int, ...]) -> Structure:
    """An equivalent structure with one set, whose transitions from a state are all in it or all not.

    Args:
        structure: Any structure.
        order: The order in which the levels wait for the acceptance sets.
    """
    parts = components(structure)
    top = len(order)
    diagrams = structure.diagrams
    start = (structure.initial, 0)
    numbers = {start: 0}
    queue = [start]
    rows = []
    for state, level in queue:
        home = parts.of_state[state]

        def moves(values: Moves, level: int = level, home: int = home, marked: int = int(level == top)) -> Moves:
            found = []
            for target, marks in values:
                inside = parts.of_state[target] == home and parts.accepting[home]
                entered = (target, _next_level(level, marks, order) if inside else 0)
                if entered not in numbers:
                    numbers[entered] = len(queue)
                    queue.append(entered)
                found.append((numbers[entered], marked))
            return tuple(sorted(set(found)))

        rows.append(diagrams.transform(structure.moves[state], moves, {}))
    return Structure(diagrams, structure.propositions, 0, tuple(rows), 1)


def _next_level(level: int, marks: int, order: tuple[int, ...]) -> int:
    if level == len(order):
        level = 0
    while level < len(order) and marks >> order[level] & 1:
        level += 1
    return level
