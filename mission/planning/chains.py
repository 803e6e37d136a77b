"""Chains: all sequences of triangles of one length between given ends, counted, ordered and picked by number.

Shortest ways form a layered graph over product states. Where the automaton is nondeterministic, ways that differ in
automaton states only are one sequence of triangles; so each layer is made deterministic: a node is a triangle with the
*set* of automaton states that the sequence may have led to. Then sequences and ways through the nodes correspond one
to one, and counting is a sum over the layers, in integers of any size.

Automaton states are held as bit sets, in Python integers. For loops, a bit stands for a pair (state in which the loop
began, state now), so that a sequence counts only where one and the same state closes it.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from mission.geometry.arrays import IntArray
from mission.planning.product import Product

Counts = NDArray[np.object_]


@dataclass(frozen=True, eq=False)
class Layer:
    """The nodes at one distance from the start.

    Attributes:
        triangles: (n,) the triangle of each node.
        sets: (n,) the bit set of each node, as its number in the chain's list of bit sets.
        counts: (n,) Python integers: how many sequences lead to each node.
        begins: (n + 1,) where the steps into each node begin in ``sources`` and ``controls``.
        sources: Node of the layer before; for each node ordered by control, then by triangle.
        controls: The control that leads from there.
    """

    triangles: IntArray
    sets: IntArray
    counts: Counts
    begins: IntArray
    sources: IntArray
    controls: IntArray


class Chain:
    """All sequences of triangles that follow the marked product states, layer by layer.

    Args:
        product: P.
        marked: For each layer, pairs (product states, anchor): the product states that a way may use there, and the
            number of the loop head they belong to. Prefixes have the single anchor 0.
    """

    def __init__(self, product: Product, marked: Sequence[Sequence[tuple[IntArray, int]]]) -> None:
        self._product = product
        self._numbers: dict[int, int] = {}
        self._sets: list[int] = []
        self._images: dict[tuple[int, int], int] = {}
        self._common: dict[tuple[int, int], int] = {}
        triangles, sets = self._allowed(marked[0])
        ones: Counts = np.full(len(triangles), 1, dtype=np.object_)
        none = np.zeros(0, dtype=np.int64)
        layers = [Layer(triangles, sets, ones, np.zeros(len(triangles) + 1, dtype=np.int64), none, none)]
        for pairs in marked[1:]:
            layers.append(self._next(layers[-1], *self._allowed(pairs)))
        self.layers = tuple(layers)

    def bits(self, number: int) -> int:
        """A bit set by its number."""
        return self._sets[number]

    def walk(self, node: int, rank: int) -> tuple[list[int], list[int]]:
        """The ``rank``-th sequence that ends in a node of the last layer: its triangles and the controls between them.

        Sequences are ordered from their end: by the last control, then by the triangle it came from, then likewise
        before that.
        """
        triangles, controls = [int(self.layers[-1].triangles[node])], []
        for before, layer in zip(reversed(self.layers[:-1]), reversed(self.layers[1:]), strict=True):
            for step in range(int(layer.begins[node]), int(layer.begins[node + 1])):
                source = int(layer.sources[step])
                if rank < before.counts[source]:
                    break
                rank -= before.counts[source]
            node = source
            triangles.append(int(before.triangles[node]))
            controls.append(int(layer.controls[step]))
        return triangles[::-1], controls[::-1]

    def _number(self, bits: int) -> int:
        if bits not in self._numbers:
            self._numbers[bits] = len(self._sets)
            self._sets.append(bits)
        return self._numbers[bits]

    def _allowed(self, pairs: Sequence[tuple[IntArray, int]]) -> tuple[IntArray, IntArray]:
        """The triangles of a layer, ascending, with the numbers of the bit sets that are allowed there."""
        states = self._product.automaton.states
        found: dict[int, int] = {}
        for codes, anchor in pairs:
            for code in codes.tolist():
                triangle, q = divmod(code, states)
                found[triangle] = found.get(triangle, 0) | 1 << (anchor * states + q)
        triangles = sorted(found)
        numbers = [self._number(found[triangle]) for triangle in triangles]
        return np.array(triangles, dtype=np.int64), np.array(numbers, dtype=np.int64)

    def _next(self, layer: Layer, triangles: IntArray, allowed: IntArray) -> Layer:
        system = self._product.system
        targets = system.successors[layer.triangles]
        place = np.minimum(np.searchsorted(triangles, targets), len(triangles) - 1)
        sources, controls = np.nonzero((targets >= 0) & (triangles[place] == targets))
        entered, place = targets[sources, controls], place[sources, controls]
        read = self._mapped(self._image, layer.sets[sources], system.letter_of[entered])
        sets = self._mapped(self._meet, read, allowed[place])
        alive = np.flatnonzero([self._sets[number] != 0 for number in sets.tolist()])
        sources, controls, entered, sets = sources[alive], controls[alive], entered[alive], sets[alive]
        order = np.lexsort((layer.triangles[sources], controls, sets, entered))
        sources, controls, entered, sets = sources[order], controls[order], entered[order], sets[order]
        fresh = np.ones(len(entered), dtype=np.bool_)
        fresh[1:] = (np.diff(entered) != 0) | (np.diff(sets) != 0)
        firsts = np.flatnonzero(fresh)
        counts: Counts = np.add.reduceat(layer.counts[sources], firsts)
        begins = np.append(firsts, len(entered))
        return Layer(entered[firsts], sets[firsts], counts, begins, sources, controls)

    def _mapped(self, operation: Callable[[int, int], int], left: IntArray, right: IntArray) -> IntArray:
        """Apply an operation on numbers to each pair; each distinct pair once."""
        width = int(right.max(initial=0)) + 1
        keys, inverse = np.unique(left * width + right, return_inverse=True)
        return np.array([operation(*divmod(key, width)) for key in keys.tolist()], dtype=np.int64)[inverse]

    def _image(self, number: int, letter: int) -> int:
        """The bit set after reading a letter."""
        if (number, letter) not in self._images:
            states = self._product.automaton.states
            members = np.array(
                [i for i, bit in enumerate(bin(self._sets[number])[:1:-1]) if bit == "1"], dtype=np.int64
            )
            rows, reached = self._product.read(members % states, np.full(len(members), letter))
            bits = 0
            for anchor, q in zip((members[rows] // states).tolist(), reached.tolist(), strict=True):
                bits |= 1 << (anchor * states + q)
            self._images[number, letter] = self._number(bits)
        return self._images[number, letter]

    def _meet(self, left: int, right: int) -> int:
        if (left, right) not in self._common:
            self._common[left, right] = self._number(self._sets[left] & self._sets[right])
        return self._common[left, right]
