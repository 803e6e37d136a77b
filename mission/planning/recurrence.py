"""Where an accepting run may go round for ever: components whose transitions bear every acceptance mark."""

from dataclasses import dataclass

import numpy as np

from mission.geometry.arrays import BoolArray, FloatArray, IntArray
from mission.planning.product import Product
from mission.planning.sweeps import Codes, Graph


@dataclass(frozen=True, eq=False)
class Component:
    """A strongly connected part of P, or of a graph made from it, with marked transitions.

    Attributes:
        states: (n,) product states, ascending.
        sources: (E,) index into ``states`` that a transition leaves.
        targets: (E,) index that it enters.
        marks: (E,) the acceptance sets that it belongs to, as bits.
        weights: (E,) what it costs.
        every: The bits of all acceptance sets.
    """

    states: Codes
    sources: IntArray
    targets: IntArray
    marks: IntArray
    weights: FloatArray
    every: int

    @property
    def size(self) -> int:
        """Number of states."""
        return len(self.states)

    def part(self, kept: BoolArray) -> "Component":
        """What is left of it when only the ``kept`` (n,) states are; it need not be strongly connected any more."""
        number = np.cumsum(kept) - 1
        inside = kept[self.sources] & kept[self.targets]
        return Component(
            self.states[kept],
            number[self.sources[inside]],
            number[self.targets[inside]],
            self.marks[inside],
            self.weights[inside],
            self.every,
        )


def recurrent(graph: Graph, marks: IntArray, all_marks: int) -> BoolArray:
    """Whether each vertex lies in a component whose transitions bear all marks between them, (V,).

    Args:
        graph: Any graph.
        marks: (E,) the marks of each edge, as bits.
        all_marks: All of them.
    """
    components = graph.components
    inside = components[graph.sources] == components[graph.targets]
    borne = np.zeros(int(components.max(initial=-1)) + 1, dtype=np.int64)
    np.bitwise_or.at(borne, components[graph.sources[inside]], marks[inside])
    found: BoolArray = borne[components] == all_marks
    return found


def recurrent_candidates(product: Product, pair: int, distances: FloatArray) -> IntArray:
    """The states of P at finite distances whose automaton state may recur by a pair of its condition, ascending."""
    states = np.flatnonzero(product.automaton.whole.recurrent[pair])
    which, triangles = np.nonzero(np.isfinite(distances.reshape(product.automaton.size, -1)[states]))
    return np.asarray(states[which] * product.system.size + triangles, dtype=np.int64)


def accepting_components(product: Product, pair: int, distances: FloatArray) -> list[Component]:
    """The components of P in which runs that satisfy a pair of the condition go round; by their least state.

    Only states at finite ``distances`` (M * Q,) count. Marks are those that must come again and again, numbered from 0;
    where there are none, every transition bears one.
    """
    fin, inf = product.automaton.whole.pairs[pair]
    candidates = recurrent_candidates(product, pair, distances)
    steps = product.out(candidates)
    place = np.full(product.full_size, -1, dtype=np.int64)
    place[candidates] = np.arange(len(candidates))
    inside = (place[steps.states] >= 0) & (steps.marks & fin == 0)
    sources, targets = steps.rows[inside], place[steps.states[inside]]
    marks, every = _numbered(steps.marks[inside], inf)
    weights = steps.weights[inside].astype(np.float64)
    begins = np.searchsorted(sources, np.arange(len(candidates) + 1)).astype(np.int32)
    graph = Graph(targets.astype(np.int32), begins, weights)
    kept = recurrent(graph, marks, every)
    if not kept.any():
        return []
    numbers = graph.components
    within = kept[sources] & (numbers[sources] == numbers[targets])
    vertices, edges = np.flatnonzero(kept), np.flatnonzero(within)
    vertices = vertices[np.argsort(numbers[vertices], kind="stable")]
    edges = edges[np.argsort(numbers[sources[edges]], kind="stable")]
    found, vertex_begins = np.unique(numbers[vertices], return_index=True)
    edge_begins = np.searchsorted(numbers[sources[edges]], found)
    components = []
    for inner, between in zip(np.split(vertices, vertex_begins[1:]), np.split(edges, edge_begins[1:]), strict=True):
        components.append(
            Component(
                candidates[inner].astype(np.int32),
                np.searchsorted(inner, sources[between]),
                np.searchsorted(inner, targets[between]),
                marks[between],
                weights[between],
                every,
            )
        )
    return sorted(components, key=lambda component: int(component.states[0]))


def has_runs(product: Product) -> bool:
    """Whether some run is accepted."""
    pairs = range(len(product.automaton.whole.pairs))
    return any(accepting_components(product, pair, product.distances) for pair in pairs)


def _numbered(marks: IntArray, inf: int) -> tuple[IntArray, int]:
    """Marks of one set with its bits moved together, and all of them; the first bit of each where there is none."""
    wanted = [mark for mark in range(inf.bit_length()) if inf >> mark & 1]
    if not wanted:
        return np.ones_like(marks), 1
    return sum(((marks >> mark & 1) << bit for bit, mark in enumerate(wanted)), 0 * marks), (1 << len(wanted)) - 1
