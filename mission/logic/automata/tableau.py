"""From a formula to a generalised Büchi automaton, on the fly.

States are sets of formulas that must all hold from here on. What a formula asks of a letter and of the rest of the word
is a diagram whose leaves are sets of clauses (obligations for the next position, promises put off once more); clauses
that ask for more than another one are dropped at once. This is the tableau of Couvreur, "On-the-fly verification of
linear temporal logic" (1999), on the clauses of Gastin and Oddoux, "Fast LTL to Büchi automata translation" (2001).
Eventualities that wait for the same formula are one acceptance set: the transitions that put none of them off.
"""

from functools import reduce
from operator import or_

from mission.logic.automata.diagrams import Diagram, Diagrams, TooLargeError
from mission.logic.automata.structure import Moves, Structure
from mission.logic.formula.operators import Operator
from mission.logic.formula.syntax import Formula, postorder

Clause = tuple[int, int]
Clauses = tuple[Clause, ...]

_PROMISES = frozenset({Operator.EVENTUALLY, Operator.UNTIL, Operator.STRONG_RELEASE})
_WAITING = frozenset({Operator.EVENTUALLY, Operator.UNTIL})
_REPEATING = frozenset({Operator.ALWAYS, Operator.RELEASE, Operator.STRONG_RELEASE})


class Tableau:
    """Builds the automata of formulas in negation normal form, over one pool of diagrams.

    Every automaton raises TooLargeError when ``work`` comparisons of clauses are used up.
    """

    def __init__(self, diagrams: Diagrams, propositions: tuple[str, ...], work: int) -> None:
        self._work = work
        self._diagrams = diagrams
        self._propositions = propositions
        self._bit = {name: index for index, name in enumerate(propositions)}
        self._number: dict[Formula, int] = {}
        self._formulas: list[Formula] = []
        self._repeated: list[int] = []
        self._promise: dict[Formula, int] = {}
        self._expansions: dict[Formula, Diagram] = {}
        self._shortened: dict[int, int] = {}
        self._both: dict[tuple[Diagram, Diagram], Diagram] = {}
        self._either: dict[tuple[Diagram, Diagram], Diagram] = {}
        self._satisfied = diagrams.leaf(((0, 0),))
        self._refused = diagrams.leaf(())

    def structure(self, formula: Formula, states: int, edges: int) -> Structure:
        """The automaton of ``formula``.

        Raises:
            TooLargeError: It has more states or edges than that.
        """
        start = self._obligations(formula)
        numbers = {start: 0}
        queue = [start]
        rows: list[Diagram] = []
        for state in queue:
            row = self._row(state)
            rows.append(row)
            leaves = self._diagrams.leaves(row)
            targets = dict.fromkeys(target for leaf in leaves for target, _ in self._diagrams.value[leaf])
            for target in targets:
                if target not in numbers:
                    numbers[target] = len(queue)
                    queue.append(target)
            edges -= len(targets)
            if len(queue) > states or edges < 0:
                raise TooLargeError
        promises = len(self._promise)
        everything = (1 << promises) - 1
        known: dict[Diagram, Diagram] = {}

        def moves(clauses: Clauses) -> Moves:
            return tuple(sorted((numbers[target], everything & ~late) for target, late in clauses))

        diagrams = tuple(self._diagrams.transform(row, moves, known) for row in rows)
        return Structure(self._diagrams, self._propositions, 0, diagrams, promises)

    def _row(self, state: int) -> Diagram:
        row = self._satisfied
        index = 0
        while state >> index:
            if state >> index & 1:
                row = self._conjoined(row, self._expanded(self._formulas[index]))
            index += 1
        return row

    def _short(self, state: int) -> int:
        """The obligations of a state without those that another one repeats at once, as ``G F a`` repeats ``F a``.

        That another one merely implies an obligation would not do: its promises would be forgotten.
        """
        known = self._shortened.get(state)
        if known is None:
            known = state
            for bit in range(state.bit_length()):
                if state >> bit & 1:
                    known &= ~self._repeated[bit]
            self._shortened[state] = known
        return known

    def _repeat(self, formula: Formula) -> int:
        """The obligations that are part of what ``formula`` asks of every position at which it stands."""
        if formula.operator not in _REPEATING:
            return 0
        inner = formula.operands[-1]
        parts = inner.operands if inner.operator is Operator.AND else (inner,)
        return sum(1 << self._numbered(part) for part in parts)

    def _numbered(self, formula: Formula) -> int:
        if formula not in self._number:
            number = self._number[formula] = len(self._formulas)
            self._formulas.append(formula)
            self._repeated.append(0)
            self._repeated[number] = self._repeat(formula)
        return self._number[formula]

    def _obligations(self, formula: Formula) -> int:
        """A formula as a set of formulas that hold together."""
        parts = formula.operands if formula.operator is Operator.AND else (formula,)
        bits = 0
        for part in parts:
            if part.operator is not Operator.TRUE:
                bits |= 1 << self._numbered(part)
        return bits

    def _expanded(self, formula: Formula) -> Diagram:
        """What ``formula`` asks of a letter and of what follows it."""
        for node in postorder(formula):
            if node not in self._expansions:
                self._expansions[node] = self._expand(node)
        return self._expansions[formula]

    def _expand(self, node: Formula) -> Diagram:  # noqa: PLR0911 - one return for each operator
        diagrams = self._diagrams
        parts = [self._expansions[operand] for operand in node.operands]
        match node.operator:
            case Operator.TRUE:
                return self._satisfied
            case Operator.FALSE:
                return self._refused
            case Operator.PROPOSITION:
                return diagrams.test(self._bit[node.name], self._refused, self._satisfied)
            case Operator.NOT:
                return diagrams.test(self._bit[node.operands[0].name], self._satisfied, self._refused)
            case Operator.AND:
                row = parts[0]
                for part in parts[1:]:
                    row = self._conjoined(row, part)
                return row
            case Operator.OR:
                row = parts[0]
                for part in parts[1:]:
                    row = self._disjoined(row, part)
                return row
            case Operator.NEXT:
                return diagrams.leaf(((self._obligations(node.operands[0]), 0),))
        return self._expand_temporal(node, parts)

    def _expand_temporal(self, node: Formula, parts: list[Diagram]) -> Diagram:
        late = 0
        if node.operator in _PROMISES:
            late = 1 << self._promise.setdefault(_promised(node), len(self._promise))
        again = self._diagrams.leaf(((self._obligations(node), late),))
        match node.operator:
            case Operator.EVENTUALLY:
                return self._disjoined(parts[0], again)
            case Operator.ALWAYS:
                return self._conjoined(parts[0], again)
            case Operator.UNTIL | Operator.WEAK_UNTIL:
                return self._disjoined(parts[1], self._conjoined(parts[0], again))
        return self._conjoined(parts[1], self._disjoined(parts[0], again))

    def _conjoined(self, left: Diagram, right: Diagram) -> Diagram:
        return self._diagrams.combine(left, right, self._product, self._both)

    def _disjoined(self, left: Diagram, right: Diagram) -> Diagram:
        return self._diagrams.combine(left, right, self._union, self._either)

    def _product(self, left: Clauses, right: Clauses) -> Clauses:
        self._work -= len(left) * len(right)
        if self._work < 0:
            raise TooLargeError
        clauses = {(self._short(a | c), b | d) for a, b in left for c, d in right}
        if len(clauses) == len(left) * len(right) and _apart(left, right):
            return tuple(sorted(clauses))
        return self._minimal(clauses)

    def _union(self, left: Clauses, right: Clauses) -> Clauses:
        return self._minimal({*left, *right})

    def _minimal(self, clauses: set[Clause]) -> Clauses:
        """Only the clauses that no other one makes superfluous, in ascending order."""
        self._work -= len(clauses) ** 2
        if self._work < 0:
            raise TooLargeError
        ordered = sorted(clauses)
        return tuple(
            clause
            for clause in ordered
            if not any(not (other[0] & ~clause[0] or other[1] & ~clause[1]) for other in ordered if other != clause)
        )


def _promised(formula: Formula) -> Formula:
    """What an eventuality puts off, which one acceptance set is enough for: ``c`` of ``a U (b U c)`` as of ``F c``.

    When that holds, all that wait for it are met at once; and from when it holds no more, none can be asked for.
    """
    while formula.operator in _WAITING:
        formula = formula.operands[-1]
    return formula


def _apart(left: Clauses, right: Clauses) -> bool:
    """Whether two sets of clauses share nothing, so that no clause of one with one of the other is superfluous."""
    return not any(_all(left, part) & _all(right, part) for part in (0, 1))


def _all(clauses: Clauses, part: int) -> int:
    return reduce(or_, (clause[part] for clause in clauses), 0)
