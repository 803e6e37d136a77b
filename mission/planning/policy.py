"""What to do next from any triangle and any state of the automaton: values over the product, and descent on them.

A run is one way; here every state of P has a cost to go. What is entered next is always what makes it least, so that
a vehicle that is pushed elsewhere goes on from there. Staying and moving are kept apart: a vehicle spells a letter for
each triangle that it *enters*, and stays only to stay for ever. So u_0 is no step of these ways; to stay is where they
end, at a cost of its own (how little room the place has), as in optimal stopping.

Laps end nowhere. Within the components of P whose transitions bear all marks of a pair of the automaton's condition,
the way leads to the nearest transition that bears one of those that are still due, until none is; then all are due
again. Each round is finite, so every mark comes again and again.
"""

from dataclasses import dataclass

import numpy as np

from mission.geometry.arrays import BoolArray, FloatArray, IntArray
from mission.logic.automata.conjunction import Conjunction
from mission.logic.automata.rabin import DEAD
from mission.planning.product import Product
from mission.planning.recurrence import Component, accepting_components
from mission.planning.sweeps import Graph
from mission.planning.transition_system import TransitionSystem
from mission.spec.model import Semantics


@dataclass(frozen=True)
class Choice:
    """What to do in a state of P.

    Attributes:
        enter: The triangle to enter next; None to stay for good.
        cost: What is left to be paid, that of the end included.
    """

    enter: int | None
    cost: float


class Values:
    """The cost to go from each state of P to the best place to stop.

    Args:
        moves: P without u_0.
        ends: (M * Q,) what stopping in each state costs; infinite where that is no end.
    """

    def __init__(self, moves: Product, ends: FloatArray) -> None:
        self._moves, self._ends = moves, ends
        goals = np.flatnonzero(np.isfinite(ends))
        self.costs = _to_root(moves.graph.reversed, goals, ends[goals])

    def choice(self, state: int) -> Choice | None:
        """What to do in a state; None where no end can be reached."""
        steps = self._moves.out(np.array([state]))
        costs = steps.weights + self.costs[steps.states]
        best = int(np.argmin(costs)) if len(costs) else -1
        onward = float(costs[best]) if len(costs) else np.inf
        if not np.isfinite(min(onward, self._ends[state])):
            return None
        if self._ends[state] <= onward:
            return Choice(None, float(self._ends[state]))
        return Choice(int(self._moves.parts(steps.states[best : best + 1])[0][0]), onward)


class Circuits:
    """The laps that satisfy one pair of the automaton's condition.

    Args:
        moves: P without u_0.
        pair: Its number.

    Attributes:
        reach: The way to where laps are flown.
    """

    def __init__(self, moves: Product, pair: int) -> None:
        self._moves = moves
        _, inf = moves.automaton.whole.pairs[pair]
        self._marks = [mark for mark in range(inf.bit_length()) if inf >> mark & 1]
        self._of: dict[int, tuple[Component, int]] = {}
        for component in accepting_components(moves, pair, np.zeros(moves.full_size)):
            self._of |= {state: (component, place) for place, state in enumerate(component.states.tolist())}
        ends = np.full(moves.full_size, np.inf)
        ends[list(self._of)] = 0.0
        self.reach = Values(moves, ends)
        self._toward: dict[tuple[int, int], FloatArray] = {}

    def choice(self, state: int, due: int) -> Choice | None:
        """What to do in a state while these marks of the automaton are due; None where no lap can be reached."""
        found = self._of.get(state)
        if found is None:
            return self.reach.choice(state)
        component, place = found
        bits = self._numbered(due)
        onward = self._costs(component, bits)
        edges = np.flatnonzero(component.sources == place)
        costs = _costs_of_edges(component, bits, onward)[edges]
        best = int(np.argmin(costs))
        entered = component.states[component.targets[edges[best]]]
        return Choice(int(entered) % self._moves.system.size, float(costs[best]))

    def _numbered(self, due: int) -> int:
        """Marks of the automaton as ``Component`` numbers them; all of them where none is among them."""
        bits = sum((due >> mark & 1) << bit for bit, mark in enumerate(self._marks))
        return bits or (1 << max(len(self._marks), 1)) - 1

    def _costs(self, component: Component, due: int) -> FloatArray:
        """(n,) the cost to the end of the nearest transition of a component that bears one of the marks."""
        key = (int(component.states[0]), due)
        if key not in self._toward:
            bears = component.marks & due > 0
            ends = np.full(component.size, np.inf)
            np.minimum.at(ends, component.sources[bears], component.weights[bears])
            backward = Graph.from_edges(component.size, component.targets, component.sources, component.weights)
            goals = np.flatnonzero(np.isfinite(ends))
            self._toward[key] = _to_root(backward, goals, ends[goals])
        return self._toward[key]


def _costs_of_edges(component: Component, due: int, onward: FloatArray) -> FloatArray:
    """(E,) what each transition costs, and what is left after it."""
    costs: FloatArray = component.weights + np.where(component.marks & due > 0, 0.0, onward[component.targets])
    return costs


def _to_root(backward: Graph, goals: IntArray, costs: FloatArray) -> FloatArray:
    """(V,) the least cost of a way against the edges from goals, each of which costs something itself."""
    if not len(goals):
        return np.full(backward.size, np.inf)
    return backward.with_root(goals, costs + 1.0).distances(np.array([backward.size]))[:-1] - 1.0


class Policy:
    """What to do next, whatever has happened.

    Args:
        system: T, its weights the costs; what must not be entered is closed.
        automaton: A, over the numbers of the letters of T.
        start: Any triangle of T.
        semantics: Of the words.
        shallow: (M,) what it costs to stop in each triangle, at least 0; infinite where nobody may.
        homes: (M,) the triangles in which a flight of laps may end.
        laps: Whether laps are flown where they can be; a flight ends in a stay else.

    Attributes:
        moves: P without u_0.
        possible: (Q, M) whether the specification can be satisfied from each state.
        safe: (Q, M) whether the flight can be ended from each state without having violated it.
    """

    def __init__(
        self,
        system: TransitionSystem,
        automaton: Conjunction,
        start: int,
        semantics: Semantics,
        *,
        shallow: FloatArray,
        homes: BoolArray,
        laps: bool,
    ) -> None:
        onward = np.column_stack((np.full(system.size, -1), system.successors[:, 1:]))
        moves = TransitionSystem(onward, system.letter_of, system.letters, system.weights)
        self.moves = Product(moves, automaton, start, semantics)
        self._shallow = shallow
        self._staying = Values(self.moves, self._ends(automaton.repeated[:, moves.letter_of]))
        self._circuits = [Circuits(self.moves, pair) for pair in range(len(automaton.whole.pairs))] if laps else []
        safe = _never_dead(automaton)[:, moves.letter_of]
        self._homeward = Values(self.moves, self._ends(safe & homes))
        self._anywhere = Values(self.moves, self._ends(safe))
        found = np.isfinite(self._staying.costs)
        for circuits in self._circuits:
            found |= np.isfinite(circuits.reach.costs)
        self.possible: BoolArray = found.reshape(automaton.size, system.size)
        self.safe: BoolArray = np.isfinite(self._anywhere.costs).reshape(automaton.size, system.size)

    def _ends(self, where: BoolArray) -> FloatArray:
        ends: FloatArray = np.where(where, self._shallow, np.inf).reshape(-1)
        return ends

    def completing(self, triangle: int, state: int, due: tuple[int, ...]) -> Choice | None:
        """What to do next to satisfy the specification; None where no way from here does.

        Args:
            triangle: Where the vehicle is.
            state: The state of A after the label of that triangle, where that was read; -1 for none.
            due: For each pair of A's condition the marks that the present round has not met.
        """
        if state == DEAD:
            return None
        number = self._number(triangle, state)
        # In a fixed order: what is possible by one pair stays so on its way, and no lap is given up for another.
        for circuits, marks in zip(self._circuits, due, strict=False):
            if (choice := circuits.choice(number, marks)) is not None:
                return choice
        return self._staying.choice(number)

    def returning(self, triangle: int, state: int) -> Choice | None:
        """What to do next after the laps: home, or else to stay where nothing is violated; None where neither is."""
        if state == DEAD:
            return None
        number = self._number(triangle, state)
        return self._homeward.choice(number) or self._anywhere.choice(number)

    def visiting(self, inside: BoolArray) -> Values:
        """The way to a good place to stop in some triangles (M,), from all of which the task can be completed."""
        return Values(self.moves, self._ends(self.possible & inside))

    def onward(self, values: Values, triangle: int, state: int) -> Choice | None:
        """What to do next by some values; None where they lead nowhere from here."""
        return None if state == DEAD else values.choice(self._number(triangle, state))

    def closed(self, state: int, *, returning: bool) -> BoolArray:
        """(M, 3) the facets that must not be crossed in a state of A, not -1: nothing can be completed behind them."""
        possible = self.safe if returning else self.possible
        behind = self.moves.system.successors[:, 1:]
        after = self.moves.automaton.whole.targets[state, self.moves.system.letter_of[behind]]
        shut: BoolArray = (behind < 0) | (after == DEAD) | ~possible[after, behind]
        shut &= possible[state][:, None]
        return shut

    def _number(self, triangle: int, state: int) -> int:
        return state * self.moves.system.size + triangle


def _never_dead(automaton: Conjunction) -> BoolArray:
    """(Q, letters) whether no repetition of a letter is a bad prefix after each state."""
    targets = automaton.whole.targets
    found: BoolArray = targets != DEAD
    columns = np.arange(targets.shape[1])
    while True:
        fewer = found & found[targets, columns]
        if (fewer == found).all():
            return found
        found = fewer
