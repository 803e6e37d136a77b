"""Decision diagrams: functions of propositions, shared and canonical.

A diagram is an integer. It is either a leaf with a value, or a test of one variable with a diagram for each outcome;
variables are tested in ascending order and equal diagrams are the same integer (Bryant, "Graph-based algorithms for
Boolean function manipulation", 1986; with values other than 0 and 1 on the leaves: Fujita et al., "Multi-terminal
binary decision diagrams", 1997). Boolean functions are the diagrams whose leaves are ``False`` and ``True``.
"""

from collections.abc import Callable, Hashable, Iterable, Iterator
from functools import reduce
from typing import Any, Final

Diagram = int
Cube = tuple[int, int]
"""A conjunction of literals: the bits of the variables that hold, and of those that do not."""

MAX_CUBES: Final = 100_000
"""Cubes of a disjunction at which ``cover`` gives up."""

LEAF: Final = 1 << 60
"""The ``variable`` of a leaf: after every variable."""


class TooLargeError(Exception):
    """What is being built grew beyond the size that it was allowed."""


class Diagrams:
    """A pool of diagrams; diagrams of different pools have nothing to do with each other.

    Every operation raises TooLargeError when the pool outgrows what ``allow`` set last, and ``cover`` when it needs
    more than ``MAX_CUBES``.
    """

    def __init__(self) -> None:
        self._limit = 10_000_000
        self.variable: list[int] = []
        self.low: list[Diagram] = []
        self.high: list[Diagram] = []
        self.value: list[Any] = []
        self._leaves: dict[Hashable, Diagram] = {}
        self._tests: dict[tuple[int, Diagram, Diagram], Diagram] = {}
        self._choices: dict[tuple[Diagram, Diagram, Diagram], Diagram] = {}
        self.false = self.leaf(False)
        self.true = self.leaf(True)

    def allow(self, growth: int) -> None:
        """Let the pool grow by so many nodes from here on."""
        self._limit = len(self.variable) + growth

    def leaf(self, value: Hashable) -> Diagram:
        """The constant function ``value``; values of different types are different."""
        key = (type(value), value)
        known = self._leaves.get(key)
        if known is None:
            known = self._leaves[key] = self._new(LEAF, -1, -1, value)
        return known

    def test(self, variable: int, low: Diagram, high: Diagram) -> Diagram:
        """``high`` where ``variable`` holds and ``low`` where not; both test later variables only."""
        if low == high:
            return low
        key = (variable, low, high)
        known = self._tests.get(key)
        if known is None:
            known = self._tests[key] = self._new(variable, low, high, None)
        return known

    def _new(self, variable: int, low: Diagram, high: Diagram, value: Hashable) -> Diagram:
        if len(self.variable) >= self._limit:
            raise TooLargeError
        self.variable.append(variable)
        self.low.append(low)
        self.high.append(high)
        self.value.append(value)
        return len(self.variable) - 1

    def literal(self, variable: int) -> Diagram:
        """The Boolean function that ``variable`` is."""
        return self.test(variable, self.false, self.true)

    def cube(self, cube: Cube) -> Diagram:
        """The Boolean function that a cube is."""
        holds, fails = cube
        result = self.true
        for variable in range((holds | fails).bit_length() - 1, -1, -1):
            if holds >> variable & 1:
                result = self.test(variable, self.false, result)
            elif fails >> variable & 1:
                result = self.test(variable, result, self.false)
        return result

    def combine(
        self,
        left: Diagram,
        right: Diagram,
        operation: Callable[[Any, Any], Hashable],
        known: dict[tuple[Diagram, Diagram], Diagram],
    ) -> Diagram:
        """``operation`` on the values of two diagrams; ``known`` remembers results of this operation."""
        key = (left, right)
        result = known.get(key)
        if result is not None:
            return result
        variable = min(self.variable[left], self.variable[right])
        if variable == LEAF:
            result = self.leaf(operation(self.value[left], self.value[right]))
        else:
            left_low, left_high = self.split(left, variable)
            right_low, right_high = self.split(right, variable)
            result = self.test(
                variable,
                self.combine(left_low, right_low, operation, known),
                self.combine(left_high, right_high, operation, known),
            )
        known[key] = result
        return result

    def transform(
        self, diagram: Diagram, operation: Callable[[Any], Hashable], known: dict[Diagram, Diagram]
    ) -> Diagram:
        """``operation`` on the values of a diagram; ``known`` remembers results of this operation."""
        result = known.get(diagram)
        if result is None:
            variable = self.variable[diagram]
            if variable == LEAF:
                result = self.leaf(operation(self.value[diagram]))
            else:
                low = self.transform(self.low[diagram], operation, known)
                result = self.test(variable, low, self.transform(self.high[diagram], operation, known))
            known[diagram] = result
        return result

    def split(self, diagram: Diagram, variable: int) -> tuple[Diagram, Diagram]:
        """The two cofactors of ``diagram`` by a variable that it does not test earlier ones than."""
        if self.variable[diagram] == variable:
            return self.low[diagram], self.high[diagram]
        return diagram, diagram

    def choose(self, condition: Diagram, then: Diagram, otherwise: Diagram) -> Diagram:
        """``then`` where the Boolean function ``condition`` holds, ``otherwise`` where not."""
        if condition == self.true or then == otherwise:
            return then
        if condition == self.false:
            return otherwise
        if then == self.true and otherwise == self.false:
            return condition
        key = (condition, then, otherwise)
        result = self._choices.get(key)
        if result is None:
            variable = min(self.variable[condition], self.variable[then], self.variable[otherwise])
            if_low, if_high = self.split(condition, variable)
            then_low, then_high = self.split(then, variable)
            else_low, else_high = self.split(otherwise, variable)
            result = self.test(
                variable, self.choose(if_low, then_low, else_low), self.choose(if_high, then_high, else_high)
            )
            self._choices[key] = result
        return result

    def both(self, left: Diagram, right: Diagram) -> Diagram:
        """Conjunction of two Boolean functions."""
        return self.choose(left, right, self.false) if left <= right else self.choose(right, left, self.false)

    def either(self, left: Diagram, right: Diagram) -> Diagram:
        """Disjunction of two Boolean functions."""
        return self.choose(left, self.true, right) if left <= right else self.choose(right, self.true, left)

    def all_of(self, parts: Iterable[Diagram]) -> Diagram:
        """Conjunction of Boolean functions."""
        return reduce(self.both, parts, self.true)

    def any_of(self, parts: Iterable[Diagram]) -> Diagram:
        """Disjunction of Boolean functions."""
        return reduce(self.either, parts, self.false)

    def neither(self, diagram: Diagram) -> Diagram:
        """Negation of a Boolean function."""
        return self.choose(diagram, self.false, self.true)

    def paths(self, diagram: Diagram, below: int = LEAF) -> Iterator[tuple[Cube, Diagram]]:
        """Every way down to a leaf, or to a test of variable ``below`` or later, as a cube; low ways first."""
        pending = [(diagram, 0, 0)]
        while pending:
            node, holds, fails = pending.pop()
            variable = self.variable[node]
            if variable >= below:
                yield (holds, fails), node
            else:
                pending.append((self.high[node], holds | 1 << variable, fails))
                pending.append((self.low[node], holds, fails | 1 << variable))

    def leaves(self, diagram: Diagram, below: int = LEAF) -> tuple[Diagram, ...]:
        """The distinct diagrams at the ends of ``paths``, in the order of the first path to each."""
        found: dict[Diagram, None] = {}
        seen: set[Diagram] = set()
        pending = [diagram]
        while pending:
            node = pending.pop()
            if node in seen:
                continue
            seen.add(node)
            if self.variable[node] >= below:
                found[node] = None
            else:
                pending.extend((self.high[node], self.low[node]))
        return tuple(found)

    def regions(self, diagram: Diagram, known: dict[Diagram, dict[Diagram, Diagram]]) -> dict[Diagram, Diagram]:
        """For each leaf where ``diagram`` ends in it, as a Boolean function; ``known`` remembers results."""
        result = known.get(diagram)
        if result is None:
            variable = self.variable[diagram]
            if variable == LEAF:
                result = {diagram: self.true}
            else:
                low = self.regions(self.low[diagram], known)
                high = self.regions(self.high[diagram], known)
                leaves = dict.fromkeys((*low, *high))
                result = {
                    leaf: self.test(variable, low.get(leaf, self.false), high.get(leaf, self.false)) for leaf in leaves
                }
            known[diagram] = result
        return result

    def evaluate(self, diagram: Diagram, holds: int) -> Hashable:
        """The value where exactly the variables of the bits ``holds`` hold."""
        node = diagram
        while self.variable[node] != LEAF:
            node = self.high[node] if holds >> self.variable[node] & 1 else self.low[node]
        value: Hashable = self.value[node]
        return value

    def cover(self, diagram: Diagram) -> tuple[Cube, ...]:
        """A short irredundant disjunction of cubes for a Boolean function.

        Source: Minato, "Fast generation of irredundant sum-of-products forms from binary decision diagrams" (1992).
        """
        cube = self._single_cube(diagram)
        return self._cover(diagram, diagram, {})[0] if cube is None else (cube,)

    def _single_cube(self, diagram: Diagram) -> Cube | None:
        holds = fails = 0
        while diagram != self.true:
            if diagram == self.false:
                return None
            low, high = self.low[diagram], self.high[diagram]
            if low == self.false:
                holds |= 1 << self.variable[diagram]
                diagram = high
            elif high == self.false:
                fails |= 1 << self.variable[diagram]
                diagram = low
            else:
                return None
        return holds, fails

    def _cover(
        self, lower: Diagram, upper: Diagram, known: dict[tuple[Diagram, Diagram], tuple[tuple[Cube, ...], Diagram]]
    ) -> tuple[tuple[Cube, ...], Diagram]:
        """Cubes of some function between ``lower`` and ``upper``, and that function."""
        if lower == self.false:
            return (), self.false
        if upper == self.true:
            return ((0, 0),), self.true
        result = known.get((lower, upper))
        if result is not None:
            return result
        variable = min(self.variable[lower], self.variable[upper])
        bit = 1 << variable
        lower_low, lower_high = self.split(lower, variable)
        upper_low, upper_high = self.split(upper, variable)
        high_cubes, high = self._cover(self.both(lower_high, self.neither(upper_low)), upper_high, known)
        low_cubes, low = self._cover(self.both(lower_low, self.neither(upper_high)), upper_low, known)
        rest = self.either(self.both(lower_high, self.neither(high)), self.both(lower_low, self.neither(low)))
        free_cubes, free = self._cover(rest, self.both(upper_low, upper_high), known)
        cubes = (
            *((holds | bit, fails) for holds, fails in high_cubes),
            *((holds, fails | bit) for holds, fails in low_cubes),
            *free_cubes,
        )
        if len(cubes) > MAX_CUBES:
            raise TooLargeError
        covered = self.either(free, self.test(variable, low, high))
        known[lower, upper] = cubes, covered
        return cubes, covered
