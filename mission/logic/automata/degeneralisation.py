"""From acceptance sets on transitions to one set of accepting states.

Copies of the states, one for each level, wait for the sets one after the other; sets that are met on the way are
skipped (Gastin and Oddoux, "Fast LTL to Büchi automata translation", 2001; Giannakopoulou and Lerda, "From states to
transitions", 2002). Levels exist only inside an accepting component, and all levels of a state accept the same words:
a component is entered at those levels that a run can meet again and again, and where there is a choice, at the fewest.
"""

from collections.abc import Sequence

from mission.logic.automata.components import reachable, strong_components
from mission.logic.automata.structure import Components, Moves, Structure, components


def degeneralised(structure: Structure, order: Sequence[int]) -> Structure:
    """An equivalent structure with one set, whose transitions from a state are all in it or all not.

    Args:
        structure: Any structure.
        order: The order in which the levels wait for the acceptance sets.
    """
    parts = components(structure)
    levels = _Levels(structure, parts, order)
    diagrams = structure.diagrams
    start = (structure.initial, levels.entry[structure.initial])
    numbers = {start: 0}
    queue = [start]
    rows = []
    for state, level in queue:
        home = parts.of_state[state]
        accepting = int(parts.accepting[home] and level == len(order))

        def moves(values: Moves, level: int = level, home: int = home, accepting: int = accepting) -> Moves:
            found = set()
            for target, marks in values:
                inside = parts.of_state[target] == home and parts.accepting[home]
                entered = (target, levels.after(level, marks) if inside else levels.entry[target])
                if entered not in numbers:
                    numbers[entered] = len(queue)
                    queue.append(entered)
                found.add((numbers[entered], accepting))
            return tuple(sorted(found))

        rows.append(diagrams.transform(structure.moves[state], moves, {}))
    return Structure(diagrams, structure.propositions, 0, tuple(rows), 1)


class _Levels:
    """The levels that runs go through.

    Attributes:
        entry: For each state, the level at which a run enters its component there.
    """

    def __init__(self, structure: Structure, parts: Components, order: Sequence[int]) -> None:
        self._order = order
        self.entry = [0] * structure.size
        transitions = structure.transitions()
        for home, members in enumerate(parts.members):
            if parts.accepting[home]:
                inside = {
                    state: [(target, marks) for target, marks in transitions[state] if parts.of_state[target] == home]
                    for state in members
                }
                self._choose(members, inside)

    def after(self, level: int, marks: int) -> int:
        """The level after a transition with ``marks`` at ``level``; the last level waits for the first set again."""
        level %= max(len(self._order), 1)
        while level < len(self._order) and marks >> self._order[level] & 1:
            level += 1
        return level

    def _choose(self, members: tuple[int, ...], inside: dict[int, list[tuple[int, int]]]) -> None:
        height = len(self._order) + 1
        copies = [(state, level) for state in members for level in range(height)]
        number = {copy: index for index, copy in enumerate(copies)}
        successors = [
            [number[target, self.after(level, marks)] for target, marks in inside[state]] for state, level in copies
        ]
        found = strong_components(successors, range(len(copies)))
        home = {copy: index for index, component in enumerate(found) for copy in component}
        closed = [
            component
            for index, component in enumerate(found)
            if all(home[target] == index for copy in component for target in successors[copy])
        ]
        smallest = min(closed, key=lambda component: (len(component), min(component)))
        for copy in sorted(smallest, reverse=True):
            state, level = copies[copy]
            self.entry[state] = level


def with_few_mixed_states(structure: Structure, order: Sequence[int]) -> Structure:
    """The marks of a structure with one set, changed so that few states are entered both with and without a mark.

    Such states need a copy for each when states and not transitions accept. A transition can be marked if every cycle
    through it has a mark anyhow, and need not be if every such cycle has another one.

    Args:
        structure: With one acceptance set.
        order: All states, those first whose marks are to be given up first.
    """
    parts = components(structure)
    inner: list[tuple[int, int, int]] = [
        (state, target, marks)
        for state, moves in enumerate(structure.transitions())
        for target, marks in moves
        if parts.of_state[state] == parts.of_state[target] and parts.accepting[parts.of_state[state]]
    ]
    plain = [(state, target) for state, target, marks in inner if not marks]
    circles = _Circles(structure.size, plain)
    unmarkable = {(state, target) for state, target in plain if circles.joins(state, target)}
    markable = {(state, target, marks) for state, target, marks in inner if marks or (state, target) not in unmarkable}
    successors: list[list[int]] = [[] for _ in range(structure.size)]
    for state, target in unmarkable:
        successors[state].append(target)
    sources: list[list[int]] = [[] for _ in range(structure.size)]
    for state, target, _ in sorted(markable):
        sources[target].append(state)
    mixed = {target for _, target in unmarkable if sources[target]}
    light: set[int] = set()
    for chosen in order:
        # Without the marks of what enters the state, no cycle may be left that had no other mark.
        if chosen in mixed and reachable(successors, chosen).isdisjoint(sources[chosen]):
            light.add(chosen)
            for state in sources[chosen]:
                successors[state].append(chosen)
    rows = []
    for state, diagram in enumerate(structure.moves):

        def moves(values: Moves, state: int = state) -> Moves:
            return tuple(
                sorted(
                    {
                        (target, int((state, target, marks) in markable and target not in light))
                        for target, marks in values
                    }
                )
            )

        rows.append(structure.diagrams.transform(diagram, moves, {}))
    return Structure(structure.diagrams, structure.propositions, structure.initial, tuple(rows), 1)


class _Circles:
    """Tells which transitions lie on a cycle of ``pairs``."""

    def __init__(self, size: int, pairs: list[tuple[int, int]]) -> None:
        successors: list[list[int]] = [[] for _ in range(size)]
        for source, target in pairs:
            successors[source].append(target)
        self._home: dict[int, int] = {}
        for index, component in enumerate(strong_components(successors, range(size))):
            self._home.update(dict.fromkeys(component, index))

    def joins(self, source: int, target: int) -> bool:
        """Whether a transition between the two is on a cycle of transitions among ``pairs`` and itself."""
        return self._home[source] == self._home[target]
