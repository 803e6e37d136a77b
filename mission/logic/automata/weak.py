"""Minimal deterministic automata of obligations: safety, guarantee (co-safety), and their Boolean combinations.

Such a language has a deterministic automaton in which all cycles of a component agree, accepting or not, and the
smallest one is unique: its states are the different languages that can remain (Staiger, "Finite-state omega-languages",
1983). It is found as that of a finite automaton once transient states are coloured right (Löding, "Efficient
minimization of deterministic weak omega-automata", 2001); what a component accepts shows on any one of its cycles (Dax,
Eisinger and Klaedtke, "Mechanizing the powerset construction for restricted classes of omega-automata", 2007).
"""

from collections.abc import Hashable, Sequence
from functools import partial
from itertools import pairwise

from mission.logic.automata.components import strong_components
from mission.logic.automata.diagrams import Diagram, Diagrams
from mission.logic.automata.progression import Progression
from mission.logic.automata.structure import Moves, Structure
from mission.logic.formula.operators import Operator
from mission.logic.formula.syntax import Formula, postorder

_SAFETY, _GUARANTEE, _OBLIGATION, _PERSISTENCE = 1, 2, 4, 8
_ALL = _SAFETY | _GUARANTEE | _OBLIGATION | _PERSISTENCE


def is_obligation(formula: Formula) -> bool:
    """Whether the syntax of a formula in negation normal form shows that its language is an obligation."""
    return bool(_kinds(formula) & _OBLIGATION)


def is_persistence(formula: Formula) -> bool:
    """Whether the syntax of a formula in negation normal form shows that it asks for something from some time on.

    No deterministic Büchi automaton accepts such a language, unless it is an obligation.
    """
    return bool(_kinds(formula) & _PERSISTENCE)


def _kinds(formula: Formula) -> int:
    """The classes of the temporal hierarchy that a formula in negation normal form is in by its syntax, as bits.

    Source: the grammar of Černá and Pelánek, "Relating hierarchy of temporal properties to model checking" (2003).
    """
    kinds: dict[Formula, int] = {}
    for node in postorder(formula):
        parts = [kinds[operand] for operand in node.operands]
        shared = _ALL
        for part in parts:
            shared &= part
        match node.operator:
            case Operator.EVENTUALLY:
                kind = shared & (_GUARANTEE | _PERSISTENCE)
            case Operator.ALWAYS:
                kind = shared & _SAFETY
            case Operator.UNTIL:
                kind = shared & (_GUARANTEE | _PERSISTENCE) | (parts[0] & _OBLIGATION if parts[1] & _GUARANTEE else 0)
            case Operator.RELEASE:
                kind = shared & _SAFETY | (parts[0] & (_OBLIGATION | _PERSISTENCE) if parts[1] & _SAFETY else 0)
            case Operator.WEAK_UNTIL:
                kind = shared & _SAFETY | (parts[1] & (_OBLIGATION | _PERSISTENCE) if parts[0] & _SAFETY else 0)
            case Operator.STRONG_RELEASE:
                kind = shared & (_GUARANTEE | _PERSISTENCE) | (parts[1] & _OBLIGATION if parts[0] & _GUARANTEE else 0)
            case _:
                kind = shared
        if kind & (_SAFETY | _GUARANTEE):
            kind |= _OBLIGATION
        kinds[node] = kind | _PERSISTENCE if kind & _OBLIGATION else kind
    return kinds[formula]


def weak_structure(
    progression: Progression, diagrams: Diagrams, propositions: tuple[str, ...], formula: Formula, limit: int
) -> Structure:
    """The minimal deterministic automaton of an obligation, complete, with one acceptance set.

    Args:
        progression: Of the same pool and propositions.
        diagrams: The pool.
        propositions: Names of the propositions.
        formula: An obligation; of another formula, some deterministic automaton that means something else.
        limit: Number of states before minimisation at which to give up.

    Raises:
        TooLargeError: The limit was passed.
    """
    states, rows = progression.explore(progression.state(formula), limit)
    accepting = [colour % 2 == 0 for colour in _colours(progression, diagrams, states, rows)]
    classes = refined(diagrams, rows, accepting)
    merged = renamed(diagrams, rows, classes)
    first: dict[int, int] = {}
    for state, number in enumerate(classes):
        first.setdefault(number, state)
    known: tuple[dict[Diagram, Diagram], ...] = ({}, {})
    moves = tuple(
        diagrams.transform(merged[state], partial(_marked, accepting[state]), known[accepting[state]])
        for state in first.values()
    )
    return Structure(diagrams, propositions, 0, moves, 1)


def _marked(mark: bool, target: int) -> Moves:  # noqa: FBT001 - one of two marks
    return ((target, int(mark)),)


def _colours(progression: Progression, diagrams: Diagrams, states: list[Diagram], rows: list[Diagram]) -> list[int]:
    """A number for each state: even where accepting; the number of changes that can still come, at least."""
    successors = [[diagrams.value[leaf] for leaf in diagrams.leaves(row)] for row in rows]
    colours = [0] * len(states)
    for component in strong_components(successors, (0,)):
        members = set(component)
        start = component[0]
        colour = max((colours[target] for state in component for target in successors[state]), default=0)
        cycle = cycle_letters(diagrams, rows, successors, members, start)
        if cycle:
            rejecting = not diagrams.evaluate(states[start], progression.truth_on_cycle(cycle))
            colour += colour % 2 != rejecting
        for state in component:
            colours[state] = colour
    return colours


def cycles_disagree(
    progression: Progression, diagrams: Diagrams, start: Diagram, letters: Sequence[int], most: int
) -> bool:
    """Whether words that repeat one of some letters for ever show that a language is no obligation.

    They do where two of them stay in one component, and one is accepted and the other is not.

    Args:
        progression: Of the formula.
        diagrams: Its pool.
        start: Its state.
        letters: The letters that are tried, as bits of what holds.
        most: States that these lead to at which to stop.
    """
    numbers = {start: 0}
    states = [start]
    successors: list[list[int]] = []
    for state in states:
        reached = [progression.step(state, letter) for letter in letters]
        for target in reached:
            if target not in numbers and len(states) < most:
                numbers[target] = len(states)
                states.append(target)
        successors.append([numbers.get(target, -1) for target in reached])
    truths = [progression.truth_on_cycle((letter,)) for letter in letters]
    inner = [[target for target in found if target >= 0] for found in successors]
    for component in strong_components(inner, (0,)):
        outcomes = {
            diagrams.evaluate(states[state], truth)
            for state in component
            for target, truth in zip(successors[state], truths, strict=True)
            if target == state
        }
        if len(outcomes) > 1:
            return True
    return False


def cycle_letters(
    diagrams: Diagrams, rows: Sequence[Diagram], successors: Sequence[Sequence[int]], members: set[int], start: int
) -> list[int]:
    """Letters, as bits of what holds, of a shortest cycle from ``start`` through ``members``; empty if none."""
    parent: dict[int, int] = {}
    queue = [start]
    for state in queue:
        for target in successors[state]:
            if target == start:
                path = [start, state]
                while path[-1] != start:
                    path.append(parent[path[-1]])
                return [_letter(diagrams, rows[source], end) for end, source in pairwise(path)][::-1]
            if target in members and target not in parent:
                parent[target] = state
                queue.append(target)
    return []


def _letter(diagrams: Diagrams, row: Diagram, target: int) -> int:
    leaf = diagrams.leaf(target)
    return next(cube[0] for cube, end in diagrams.paths(row) if end == leaf)


def refined(diagrams: Diagrams, rows: Sequence[Diagram], start: Sequence[Hashable]) -> list[int]:
    """The coarsest classes of states that agree on ``start`` and on the classes of their successors.

    Classes are numbered in the order of their first states.

    Args:
        diagrams: The pool.
        rows: One diagram a state, with numbers of states on its leaves.
        start: Something for each state that members of a class agree on.
    """
    classes = _numbered(start)
    while True:
        finer = _numbered(list(zip(classes, renamed(diagrams, rows, classes), strict=True)))
        if finer == classes:
            return classes
        classes = finer


def renamed(diagrams: Diagrams, rows: Sequence[Diagram], classes: Sequence[int]) -> list[Diagram]:
    """Diagrams with the class of a state on each leaf instead of the state."""
    known: dict[Diagram, Diagram] = {}
    return [diagrams.transform(row, classes.__getitem__, known) for row in rows]


def _numbered(keys: Sequence[Hashable]) -> list[int]:
    numbers: dict[Hashable, int] = {}
    return [numbers.setdefault(key, len(numbers)) for key in keys]
