"""Where an accepting run may go round for ever: components whose transitions bear every acceptance mark."""

from dataclasses import dataclass

import numpy as np

from mission.geometry.arrays import BoolArray, FloatArray, IntArray
from mission.logic.automata.automaton import CompiledGeneralised
from mission.planning.product import Product, mark_bits
from mission.planning.sweeps import Codes, Graph


@dataclass(frozen=True, eq=False)
class Component:
    """A strongly connected part of P, or of a graph made from it, with marked transitions.

    Attributes:
        states: (n,) product states, ascending.
        sources: (E,) index into ``states`` that a transition leaves.
        targets: (E,) index that it enters.
        controls: (E,) the control of T.
        marks: (E,) the acceptance sets that it belongs to, as bits.
        weights: (E,) what it costs.
    """

    states: Codes
    sources: IntArray
    targets: IntArray
    controls: IntArray
    marks: IntArray
    weights: FloatArray

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
            self.controls[inside],
            self.marks[inside],
            self.weights[inside],
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


def recurrent_automaton_states(product: Product) -> BoolArray:
    """Whether each state of A lies on a loop, of any letters, that bears all marks, (Q,)."""
    return recurrent(automaton_graph(product.automaton), mark_bits(product.automaton), product.all_marks)


def automaton_graph(automaton: CompiledGeneralised) -> Graph:
    """A as a graph, an edge for each transition in their order, which is by source as that of a graph's edges is."""
    begins = np.searchsorted(automaton.sources, np.arange(automaton.states + 1)).astype(np.int32)
    return Graph(automaton.targets.astype(np.int32), begins, 1.0)


def recurrent_candidates(product: Product) -> IntArray:
    """The reachable states of P whose automaton state may recur, ascending."""
    states = np.flatnonzero(recurrent_automaton_states(product))
    which, triangles = np.nonzero(np.isfinite(product.distances.reshape(product.automaton.states, -1)[states]))
    return np.asarray(states[which] * product.system.size + triangles, dtype=np.int64)


def accepting_components(product: Product, candidates: IntArray) -> list[Component]:
    """The components of P, within ``candidates``, in which accepting runs go round; by their least state."""
    steps = product.out(candidates)
    place = np.full(product.full_size, -1, dtype=np.int64)
    place[candidates] = np.arange(len(candidates))
    inside = place[steps.states] >= 0
    sources, targets = steps.rows[inside], place[steps.states[inside]]
    marks, weights = steps.marks[inside], steps.weights[inside].astype(np.float64)
    begins = np.searchsorted(sources, np.arange(len(candidates) + 1)).astype(np.int32)
    graph = Graph(targets.astype(np.int32), begins, weights)
    kept = recurrent(graph, marks, product.all_marks)
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
                steps.controls[inside][between],
                marks[between],
                weights[between],
            )
        )
    return sorted(components, key=lambda component: int(component.states[0]))
