"""From a formula to a deterministic structure: what remains to be satisfied after each letter.

A state is a Boolean function of *atoms*, as a decision diagram: propositions, ``X`` of an atom, and ``U`` of two such
functions; every other operator is expressed by these. Reading a letter turns it into another such function (Bacchus
and Kabanza, "Planning for temporally extended goals", 1998). Formulas that are equal as Boolean functions of their
atoms are the same state, so that there are finitely many.
"""

from collections.abc import Sequence
from typing import Final

from mission.logic.automata.diagrams import Diagram, Diagrams, TooLargeError
from mission.logic.formula.operators import Operator
from mission.logic.formula.syntax import Formula, postorder

MAX_ATOMS: Final = 200
"""Atoms that a formula may have: the depth of a diagram."""


class Progression:
    """The functions of atoms that formulas are, and how they progress, over one pool of diagrams.

    Variables of the pool from ``len(propositions)`` on are atoms, in the order of their making.
    """

    def __init__(self, diagrams: Diagrams, propositions: tuple[str, ...]) -> None:
        self._diagrams = diagrams
        self._propositions = propositions
        self._first = len(propositions)
        self._bit = {name: index for index, name in enumerate(propositions)}
        self._atoms: list[tuple[Operator, Diagram, Diagram]] = []
        self._numbers: dict[tuple[Operator, Diagram, Diagram], int] = {}
        self._after_atom: list[Diagram] = []
        self._after: dict[Diagram, Diagram] = {diagrams.false: diagrams.false, diagrams.true: diagrams.true}
        self._delayed: dict[Diagram, Diagram] = {diagrams.false: diagrams.false, diagrams.true: diagrams.true}
        self._encoded: dict[Formula, Diagram] = {}

    def state(self, formula: Formula) -> Diagram:
        """``formula`` as a Boolean function of atoms."""
        for node in postorder(formula):
            if node not in self._encoded:
                self._encoded[node] = self._encode(node)
        return self._encoded[formula]

    def _encode(self, node: Formula) -> Diagram:  # noqa: C901, PLR0911, PLR0912 - one case for each operator
        diagrams = self._diagrams
        parts = [self._encoded[operand] for operand in node.operands]
        match node.operator:
            case Operator.TRUE:
                return diagrams.true
            case Operator.FALSE:
                return diagrams.false
            case Operator.PROPOSITION:
                return self._atom(Operator.PROPOSITION, self._bit[node.name], 0)
            case Operator.NOT:
                return diagrams.neither(parts[0])
            case Operator.AND:
                return diagrams.all_of(parts)
            case Operator.OR:
                return diagrams.any_of(parts)
            case Operator.IMPLIES:
                return diagrams.choose(parts[0], parts[1], diagrams.true)
            case Operator.IFF:
                return diagrams.choose(parts[0], parts[1], diagrams.neither(parts[1]))
            case Operator.NEXT:
                return self._delay(parts[0])
            case Operator.EVENTUALLY:
                return self._until(diagrams.true, parts[0])
            case Operator.ALWAYS:
                return diagrams.neither(self._until(diagrams.true, diagrams.neither(parts[0])))
            case Operator.UNTIL:
                return self._until(parts[0], parts[1])
            case Operator.STRONG_RELEASE:
                return self._until(parts[1], diagrams.both(parts[0], parts[1]))
        left, right = (diagrams.neither(part) for part in parts)
        if node.operator is Operator.RELEASE:
            return diagrams.neither(self._until(left, right))
        return diagrams.neither(self._until(right, diagrams.both(left, right)))

    def _until(self, left: Diagram, right: Diagram) -> Diagram:
        if right in (self._diagrams.true, self._diagrams.false) or left == self._diagrams.false:
            return right
        return self._atom(Operator.UNTIL, self._diagrams.either(left, right), right)

    def _atom(self, operator: Operator, first: Diagram, second: Diagram) -> Diagram:
        key = (operator, first, second)
        number = self._numbers.get(key)
        if number is None:
            if len(self._atoms) >= MAX_ATOMS:
                raise TooLargeError
            number = self._numbers[key] = len(self._atoms)
            self._atoms.append(key)
            self._after_atom.append(self._atom_after(number))
        return self._diagrams.literal(self._first + number)

    def _atom_after(self, number: int) -> Diagram:
        """What is left of an atom, as a function of the letter read and of the atoms at the next position."""
        operator, first, second = self._atoms[number]
        if operator is Operator.PROPOSITION:
            return self._diagrams.literal(first)
        if operator is Operator.NEXT:
            return self._diagrams.literal(first)
        again = self._diagrams.literal(self._first + number)
        return self._diagrams.either(self.after(second), self._diagrams.both(self.after(first), again))

    def after(self, state: Diagram) -> Diagram:
        """What is left of a state, as a function of the letter read and of the atoms at the next position."""
        known = self._after.get(state)
        if known is None:
            atom = self._diagrams.variable[state] - self._first
            high = self.after(self._diagrams.high[state])
            low = self.after(self._diagrams.low[state])
            known = self._after[state] = self._diagrams.choose(self._after_atom[atom], high, low)
        return known

    def step(self, state: Diagram, letter: int) -> Diagram:
        """What is left of a state after a letter, given as the bits of what holds."""
        node = self.after(state)
        while self._diagrams.variable[node] < self._first:
            holds = letter >> self._diagrams.variable[node] & 1
            node = self._diagrams.high[node] if holds else self._diagrams.low[node]
        return node

    def _delay(self, state: Diagram) -> Diagram:
        """``X`` of a state; it distributes over every Boolean function."""
        known = self._delayed.get(state)
        if known is None:
            atom = self._atom(Operator.NEXT, self._diagrams.variable[state], 0)
            high = self._delay(self._diagrams.high[state])
            known = self._diagrams.choose(atom, high, self._delay(self._diagrams.low[state]))
            self._delayed[state] = known
        return known

    def explore(self, start: Diagram, limit: int) -> tuple[list[Diagram], list[Diagram]]:
        """The states that ``start`` reaches, itself first, and for each the diagram from letters to states.

        The leaves of these diagrams are the indices of states.

        Raises:
            TooLargeError: They are more than ``limit``.
        """
        numbers = {start: 0}
        queue = [start]
        rows: list[Diagram] = []
        for state in queue:
            after = self.after(state)
            for end in self._diagrams.leaves(after, self._first):
                if end not in numbers:
                    numbers[end] = len(queue)
                    queue.append(end)
            if len(queue) > limit:
                raise TooLargeError
            rows.append(after)
        known: dict[Diagram, Diagram] = {}
        return queue, [self._numbered(row, numbers, known) for row in rows]

    def _numbered(self, row: Diagram, numbers: dict[Diagram, int], known: dict[Diagram, Diagram]) -> Diagram:
        result = known.get(row)
        if result is None:
            variable = self._diagrams.variable[row]
            if variable >= self._first:
                result = self._diagrams.leaf(numbers[row])
            else:
                low = self._numbered(self._diagrams.low[row], numbers, known)
                high = self._numbered(self._diagrams.high[row], numbers, known)
                result = self._diagrams.test(variable, low, high)
            known[row] = result
        return result

    def truth_on_cycle(self, letters: Sequence[int]) -> int:
        """The bits of the atoms that hold on the word that repeats ``letters`` (bits of what holds) for ever."""
        length = len(letters)
        truth = [0] * length  # the bits of the atoms that hold at each position
        for number, (operator, first, second) in enumerate(self._atoms):
            bit = 1 << number + self._first
            if operator is Operator.PROPOSITION:
                values = [letter >> first & 1 for letter in letters]
            elif operator is Operator.NEXT:
                values = [truth[(position + 1) % length] >> first & 1 for position in range(length)]
            else:
                values = self._until_on_cycle(first, second, truth)
            for position, value in enumerate(values):
                truth[position] |= bit * value
        return truth[0]

    def _until_on_cycle(self, first: Diagram, second: Diagram, truth: list[int]) -> list[int]:
        length = len(truth)
        values = [0] * length
        held = 0
        for position in reversed(range(2 * length)):  # what holds now may rest on what comes one lap later
            here = truth[position % length]
            if self._diagrams.evaluate(second, here):
                held = 1
            elif not self._diagrams.evaluate(first, here):
                held = 0
            values[position % length] = held
        return values
