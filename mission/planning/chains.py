"""Chains: all sequences of triangles of one length between given ends, counted, ordered and picked by number.

Shortest ways form a layered graph over product states. Two ways may be one sequence of triangles and controls and
differ in automaton states only; they are one run. Where the states of a layered graph have at most one successor for
each control, and the first layer is one state, that cannot happen, and the graph is counted as it is. Elsewhere it is
made deterministic: a node is then a triangle with the *set* of automaton states that the sequence may have led to.
Either way sequences and ways through the nodes correspond one to one, and counting them is a sum over the steps into
each node, in Python's integers, which have no largest.

Sets of automaton states are bit sets. For loops from several heads a bit stands for a pair (number of the head in
which the loop began, state now), so that a sequence counts only where one and the same head closes it.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from mission.geometry.arrays import IntArray
from mission.logic.automaton import CompiledAutomaton
from mission.planning.product import Codes, Product

Pair = tuple[int, int]


@dataclass(frozen=True, eq=False)
class Layered:
    """Product states by layers; a state is in the first and in the last layer of a loop.

    Attributes:
        states: (n,) product states, ordered by layer and number.
        layers: (n,) number of the layer of each, from 0, none left out.
    """

    states: Codes
    layers: IntArray


@dataclass(frozen=True, eq=False)
class Chain:
    """A graph of nodes, layer by layer, in which every way to a node is a sequence of triangles of its own.

    Attributes:
        triangles: The triangle of each node.
        begins: Where the steps into each node begin in ``sources`` and ``controls``; one more than nodes.
        sources: The node that a step comes from; for each node ordered by control, then by triangle.
        controls: The control that leads from there.
        ends: The nodes of the last layer, each with its bit set.
        counts: How many sequences lead to each node.
    """

    triangles: list[int]
    begins: list[int]
    sources: list[int]
    controls: list[int]
    ends: list[Pair]
    counts: list[int]

    def walk(self, node: int, rank: int) -> tuple[list[int], list[int]]:
        """The ``rank``-th sequence that ends in a node: its triangles and the controls between them.

        Sequences are ordered from their end: by the last control, then by the triangle it came from, then likewise
        before that.
        """
        triangles, controls = [self.triangles[node]], []
        while self.begins[node] < self.begins[node + 1]:
            for step in range(self.begins[node], self.begins[node + 1]):
                source = self.sources[step]
                if rank < self.counts[source]:
                    break
                rank -= self.counts[source]
            node = source
            triangles.append(self.triangles[node])
            controls.append(self.controls[step])
        return triangles[::-1], controls[::-1]


def _counted(begins: list[int], sources: list[int]) -> list[int]:
    counts: list[int] = []
    for begin, end in pairwise(begins):
        counts.append(sum([counts[source] for source in sources[begin:end]]) if begin < end else 1)
    return counts


def chain(product: Product, graphs: Sequence[Layered]) -> Chain:
    """Unite layered graphs with equal numbers of layers, one for each head, into one chain of distinct sequences."""
    if len(graphs) == 1:
        plain = _as_it_is(product, graphs[0])
        if plain is not None:
            return plain
    return _made_deterministic(product, graphs)


def _as_it_is(product: Product, graph: Layered) -> Chain | None:
    """The chain whose nodes are the product states, None where two ways may be one sequence."""
    size = len(graph.states)
    if np.count_nonzero(graph.layers == 0) > 1:
        return None
    node_of = np.full(product.full_size, -1, dtype=np.int64)
    node_of[graph.states] = np.arange(size)  # of a state in two layers the last: nothing leads into the first one
    steps = product.out(graph.states)
    targets = node_of[steps.states]
    onward = (targets >= 0) & (graph.layers[targets] == graph.layers[steps.rows] + 1)
    sources, controls, targets = steps.rows[onward], steps.controls[onward], targets[onward]
    if ((np.diff(sources) == 0) & (np.diff(controls) == 0)).any():
        return None
    triangles, automaton_states = product.parts(graph.states)
    order = np.lexsort((triangles[sources], controls, targets))
    begins = np.concatenate(([0], np.cumsum(np.bincount(targets, minlength=size)))).tolist()
    sources_listed = sources[order].tolist()
    last = np.flatnonzero(graph.layers == graph.layers[-1])
    last = last[np.lexsort((automaton_states[last], triangles[last]))]
    return Chain(
        triangles=triangles.tolist(),
        begins=begins,
        sources=sources_listed,
        controls=controls[order].tolist(),
        ends=[(node, 1 << q) for node, q in zip(last.tolist(), automaton_states[last].tolist(), strict=True)],
        counts=_counted(begins, sources_listed),
    )


def _made_deterministic(product: Product, graphs: Sequence[Layered]) -> Chain:
    """The chain whose nodes are triangles with the sets of (head, automaton state) that a sequence leads to."""
    allowed = _allowed(product, graphs)
    reader = _Reader(product.automaton)
    letter_of, successors = product.system.letter_of, product.system.successors
    layer = sorted(allowed[0].items())  # (triangle, bit set) of each node
    triangles, begins = [x for x, _ in layer], [0] * (len(layer) + 1)
    sources: list[int] = []
    controls: list[int] = []
    for here in allowed[1:]:
        first = len(triangles) - len(layer)
        into: dict[Pair, list[tuple[int, int, int]]] = {}
        for node, (x, bits) in enumerate(layer, first):
            for control, y in enumerate(successors[x].tolist()):
                if y in here and (reached := reader.read(bits, int(letter_of[y])) & here[y]):
                    into.setdefault((y, reached), []).append((control, x, node))
        layer = sorted(into)
        for key in layer:
            steps = sorted(into[key])
            triangles.append(key[0])
            sources.extend(node for _, _, node in steps)
            controls.extend(control for control, _, _ in steps)
            begins.append(len(sources))
    ends = [(node, bits) for node, (_, bits) in enumerate(layer, len(triangles) - len(layer))]
    return Chain(triangles, begins, sources, controls, ends, _counted(begins, sources))


def _allowed(product: Product, graphs: Sequence[Layered]) -> list[dict[int, int]]:
    """For each layer the triangles in it with the bit set of all (head, automaton state) there."""
    states = product.automaton.states
    layers: list[dict[int, int]] = [{} for _ in range(int(graphs[0].layers[-1]) + 1)]
    for head, graph in enumerate(graphs):
        triangles, automaton_states = product.parts(graph.states)
        for layer, x, q in zip(graph.layers.tolist(), triangles.tolist(), automaton_states.tolist(), strict=True):
            layers[layer][x] = layers[layer].get(x, 0) | 1 << (head * states + q)
    return layers


class _Reader:
    """What reading a letter makes of a bit set of (head, automaton state); each distinct question is answered once."""

    def __init__(self, automaton: CompiledAutomaton) -> None:
        self._states = automaton.states
        self._targets: dict[Pair, int] = {}
        rows = zip(automaton.sources.tolist(), automaton.letters.tolist(), automaton.targets.tolist(), strict=True)
        for source, letter, target in rows:
            self._targets[source, letter] = self._targets.get((source, letter), 0) | 1 << target
        self._read: dict[Pair, int] = {}

    def read(self, bits: int, letter: int) -> int:
        if (bits, letter) not in self._read:
            self._read[bits, letter] = _image(bits, letter, self._targets, self._states)
        return self._read[bits, letter]


def _image(bits: int, letter: int, targets: Mapping[Pair, int], states: int) -> int:
    image = 0
    while bits:
        lowest = (bits & -bits).bit_length() - 1
        head, q = divmod(lowest, states)
        image |= targets.get((q, letter), 0) << (head * states)
        bits &= bits - 1
    return image
