"""All the words that a vehicle can spell while its position is known only as a set of triangles at a time.

The flight is a row of *layers*; in each the vehicle is somewhere in a known set of closed triangles. Its word has one
letter for every triangle that it enters: the label of the start triangle (standard semantics; the paper's leaves it
out), then one letter each time that it changes triangle. So a region that is meshed by several triangles spells its
label once a triangle, and flying on inside one triangle spells nothing. In detail:

- Within a layer the vehicle may change to any triangle of the layer that shares a vertex with the one it is in (at the
  moment of a change both closed triangles hold its position), as often as it likes but finitely often.
- From a layer to the next it keeps its triangle and spells nothing. A triangle that the next layer lacks is left
  behind: the vehicle cannot have been in it at the moment that the two layers share.
- A flight that *stays* remains in the last layer for ever. It may change triangle there for ever, and each repetition
  of u_0 spells the label of the triangle that it is in once more, as the stay transition of the planner does.
- A *recurrent* flight goes from its last layer back to the layer ``loop_from``, for ever. It comes back in the triangle
  in which it left, silently, or in another one of that layer, spelling its label. One that has not left its triangle
  for a whole lap spells its label once more, as staying does.

So the possible words are the language of a finite automaton, and none of them violates the formula if and only if its
product with the automaton of the negated formula has no accepting lasso. Sets of automaton states are bit masks here:
they are pushed through the layers once, and only the loop is searched for accepting components.
"""

from collections import deque
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass
from functools import cached_property
from itertools import groupby
from typing import NamedTuple

import numpy as np
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from mission.geometry.arrays import BoolArray, IntArray
from mission.logic.automata.automaton import CompiledAutomaton
from mission.spec.model import Semantics

Node = tuple[int, int, int]  # layer, triangle, automaton state
Way = tuple[tuple[int, int], ...]  # layer, triangle


class _Edge(NamedTuple):
    """A step of a flight and of the automaton: whether a label is spelled, and whether time goes on if it recurs."""

    source: Node | None
    target: Node
    spells: bool
    progress: bool


@dataclass(frozen=True)
class Layers:
    """Where the vehicle may be, one set of triangles after the other.

    Attributes:
        triangles: The triangles of each layer, ascending, none empty.
        loop_from: The layer that the last one leads back to in a recurrent flight; None where the vehicle stays.
    """

    triangles: tuple[tuple[int, ...], ...]
    loop_from: int | None

    @property
    def last(self) -> int:
        """Index of the last layer."""
        return len(self.triangles) - 1

    @property
    def head(self) -> int:
        """Index of the first layer that is visited for ever."""
        return self.last if self.loop_from is None else self.loop_from

    @cached_property
    def unmoved(self) -> frozenset[int]:
        """Triangles that the vehicle need not leave in a whole lap; all of the last layer where it stays."""
        sets = [frozenset(layer) for layer in self.triangles[self.head :]]
        return frozenset.intersection(*sets)


class Violations:
    """The product of the possible words with the automaton of the negated formula.

    Args:
        layers: Where the vehicle may be.
        corners: Shape (M, 3), the vertices of the triangles.
        letter_of: Shape (M,), the letter of each triangle.
        refutation: The automaton of the negated formula, over the same letters.
        semantics: Whether the label of the start triangle is read.
        begins: Of a flight that goes on from another one, the automaton states (bits) that are possible in each
            triangle in which it begins; None where the word begins here.
    """

    def __init__(
        self,
        layers: Layers,
        *,
        corners: IntArray,
        letter_of: IntArray,
        refutation: CompiledAutomaton,
        semantics: Semantics,
        begins: Mapping[int, int] | None = None,
    ) -> None:
        self._layers = layers
        self._corners = corners
        self._semantics = semantics
        self._refutation = refutation
        self._begins = begins
        self._images: dict[tuple[int, int], int] = {}
        self._near: dict[tuple[int, ...], dict[int, tuple[int, ...]]] = {}
        self._letters = {t: int(letter_of[t]) for layer in set(layers.triangles) for t in layer}

    def exists(self) -> bool:
        """Whether the vehicle can spell a word that violates the formula."""
        return bool(self._bad_nodes)

    def at_end(self) -> dict[int, int]:
        """The automaton states (bits) that are possible in each triangle of the last layer, after any laps."""
        return self._reach[-1]

    def witness(self, expected: tuple[frozenset[int], ...]) -> tuple[Way, Way]:
        """One violating way, as (layer, triangle) at the start and at each change of either: up to its loop, and that.

        Args:
            expected: For each layer the triangles that the middle of the tube visits; of all violating ways the one is
                given that leaves them least often.

        Returns:
            The way, and a loop from its end back to there; both empty where none violates.
        """
        bad = self._bad_nodes
        way = self._least_astray(self._start_nodes(), expected, lambda edge: edge.target in bad)
        if not way:
            return (), ()
        begin = way[-1].target
        # Each of these recurs in the component of the bad node, so it is found from wherever the last one was.
        recurring: tuple[Callable[[_Edge], bool], ...] = (
            lambda edge: bool(self._refutation.accepting[edge.target[2]]),
            lambda edge: edge.progress,
            lambda edge: edge.spells,
        )
        loop: list[_Edge] = []
        for found in (*recurring, lambda edge: edge.target == begin):
            if not any(map(found, loop[-1:] if found not in recurring else loop)):
                here = loop[-1].target if loop else begin
                loop += self._least_astray([here], expected, found, within=bad[begin])[1:]
        return _changes(edge.target for edge in way), _changes((begin, *(edge.target for edge in loop)))

    def _least_astray(
        self,
        starts: Iterable[Node],
        expected: tuple[frozenset[int], ...],
        found: Callable[["_Edge"], bool],
        within: int | None = None,
    ) -> list["_Edge"]:
        """A way from a start to the first edge that is looked for, over the fewest triangles that are not expected.

        Args:
            starts: Where it may begin.
            expected: As in ``witness``.
            found: Whether an edge is looked for.
            within: The component of bad nodes that is not left; then entering the start is not looked for. None where
                there is no such bound.
        """
        best: dict[Node, int] = {}
        parents: dict[Node, _Edge] = {}
        queue: deque[tuple[int, _Edge]] = deque(
            sorted((int(node[1] not in expected[0]), _Edge(None, node, spells=True, progress=False)) for node in starts)
        )
        while queue:
            cost, edge = queue.popleft()
            node = edge.target
            if found(edge) and (within is None or edge.source is not None):
                return _back(edge, parents)
            if cost >= best.get(node, cost + 1):
                continue
            best[node], parents[node] = cost, edge
            for onward in self._onward(node):
                layer, triangle, _ = onward.target
                if within is not None and self._bad_nodes.get(onward.target) != within:
                    continue
                if triangle in expected[layer]:
                    queue.appendleft((cost, onward))
                else:
                    queue.append((cost + 1, onward))
        return []

    # -- sets of automaton states, as bit masks ------------------------------------------------------------------

    @cached_property
    def _successor_masks(self) -> dict[int, list[int]]:
        """For each letter, the mask of the successors of each state."""
        masks = {letter: [0] * self._refutation.states for letter in set(self._letters.values())}
        rows = zip(
            self._refutation.sources.tolist(),
            self._refutation.letters.tolist(),
            self._refutation.targets.tolist(),
            strict=True,
        )
        for source, letter, target in rows:
            if letter in masks:
                masks[letter][source] |= 1 << target
        return masks

    def _image(self, mask: int, triangle: int) -> int:
        """States that entering ``triangle`` leads to."""
        key = (mask, self._letters[triangle])
        image = self._images.get(key)
        if image is None:
            targets = self._successor_masks[key[1]]
            image = 0
            for state in _bits(mask):
                image |= targets[state]
            self._images[key] = image
        return image

    def _neighbours(self, layer: tuple[int, ...]) -> dict[int, tuple[int, ...]]:
        """For each triangle of a layer the others that share a vertex with it."""
        near = self._near.get(layer)
        if near is None:
            corners = {t: frozenset(self._corners[t].tolist()) for t in layer}
            near = {t: tuple(u for u in layer if u != t and corners[t] & corners[u]) for t in layer}
            self._near[layer] = near
        return near

    def _settled(self, layer: tuple[int, ...], masks: dict[int, int]) -> dict[int, int]:
        """The states possible in a layer, changes of triangle within it included."""
        masks = dict(masks)
        if len(layer) == 1:
            return masks
        near = self._neighbours(layer)
        waiting = [t for t in layer if masks[t]]
        while waiting:
            triangle = waiting.pop()
            for other in near[triangle]:
                new = self._image(masks[triangle], other) & ~masks[other]
                if new:
                    masks[other] |= new
                    waiting.append(other)
        return masks

    def _joined(self, masks: dict[int, int]) -> dict[int, int]:
        """What the head of the loop receives from the last layer."""
        head = self._layers.triangles[self._layers.head]
        received = dict.fromkeys(head, 0)
        for source, mask in masks.items():
            for target in head:
                if target != source:
                    if self._layers.loop_from is not None:
                        received[target] |= self._image(mask, target)
                    continue
                received[target] |= mask
                if target in self._layers.unmoved:
                    received[target] |= self._image(mask, target)
        return received

    @cached_property
    def _start_masks(self) -> dict[int, int]:
        if self._begins is not None:
            return {t: self._begins.get(t, 0) for t in self._layers.triangles[0]}
        initial = sum(1 << int(state) for state in set(self._refutation.initial.tolist()))
        first = self._layers.triangles[0]
        if self._semantics is Semantics.PAPER:
            return dict.fromkeys(first, initial)
        return {t: self._image(initial, t) for t in first}

    @cached_property
    def _reach(self) -> list[dict[int, int]]:
        """For each layer the automaton states that are possible in each of its triangles."""
        triangles = self._layers.triangles
        reach: list[dict[int, int]] = [dict.fromkeys(layer, 0) for layer in triangles]
        incoming, index = self._start_masks, 0
        while True:
            for place in range(index, len(triangles)):
                layer = triangles[place]
                merged = {t: reach[place][t] | incoming.get(t, 0) for t in layer}
                reach[place] = self._settled(layer, merged)
                incoming = reach[place]
            incoming, index = self._joined(reach[-1]), self._layers.head
            if all(mask & ~reach[index][t] == 0 for t, mask in incoming.items()):
                return reach

    # -- the loop, as a graph ------------------------------------------------------------------------------------

    @cached_property
    def _bad_nodes(self) -> dict[Node, int]:
        """Nodes of the loop where an accepting state, letters and the progress of the flight recur for ever.

        Each with the number of its component, in which they all recur.
        """
        head = self._layers.head
        places = [(layer, t) for layer in range(head, self._layers.last + 1) for t in self._layers.triangles[layer]]
        if not any(self._reach[layer][t] for layer, t in places):
            return {}
        states = self._refutation.states
        base = {place: index * states for index, place in enumerate(places)}
        present = np.concatenate([_array(self._reach[layer][t], states) for layer, t in places])
        edges = self._edges(base)
        kept = present[edges[0]]
        sources, targets, progress, spelling = edges[0][kept], edges[1][kept], edges[2][kept], edges[3][kept]
        shape = (len(present), len(present))
        matrix = coo_array((np.ones(len(sources), dtype=np.int8), (sources, targets)), shape=shape)
        _, component = connected_components(matrix.tocsr(), directed=True, connection="strong")
        inner = component[sources] == component[targets]
        moving, worded = np.zeros((2, len(present)), dtype=np.bool_)
        moving[component[sources[inner & progress]]] = True
        worded[component[sources[inner & spelling]]] = True  # a lap that spells nothing adds nothing to the word
        accepting = np.zeros(len(present), dtype=np.bool_)
        accepting[component[present & np.tile(self._refutation.accepting, len(places))]] = True
        bad = np.flatnonzero(present & (moving & worded & accepting)[component])
        return {(*places[index // states], index % states): int(component[index]) for index in bad.tolist()}

    def _edges(self, base: dict[tuple[int, int], int]) -> tuple[IntArray, IntArray, BoolArray, BoolArray]:
        """Edges of the loop: sources, targets, whether one recurs only if time goes on, whether it spells a letter."""
        letters = self._refutation.letters
        rows = {
            letter: (self._refutation.sources[letters == letter], self._refutation.targets[letters == letter])
            for letter in set(self._letters.values())
        }
        every = np.arange(self._refutation.states)
        parts: list[tuple[IntArray, IntArray, bool, bool]] = []
        for (layer, triangle), start in base.items():
            for place, spells, progress in self._ways_on(layer, triangle):
                read, reached = rows[self._letters[place[1]]] if spells else (every, every)
                parts.append((start + read, base[place] + reached, progress, spells))
        counts = [len(read) for read, *_ in parts]
        return (
            np.concatenate([read for read, *_ in parts]).astype(np.int64),
            np.concatenate([reached for _, reached, *_ in parts]).astype(np.int64),
            np.repeat([progress for *_, progress, _ in parts], counts).astype(np.bool_),
            np.repeat([spells for *_, spells in parts], counts).astype(np.bool_),
        )

    def _ways_on(self, layer: int, triangle: int) -> Iterator[tuple[tuple[int, int], bool, bool]]:
        """Where one can go from a place: the next place, whether its label is spelled, whether the flight goes on."""
        layers = self._layers
        stays = layers.loop_from is None and layer == layers.last
        for other in self._neighbours(layers.triangles[layer])[triangle]:
            yield (layer, other), True, stays
        if layer < layers.last:
            if triangle in layers.triangles[layer + 1]:
                yield (layer + 1, triangle), False, False
            return
        if triangle in layers.unmoved:
            yield (layers.head, triangle), True, True
        if layers.loop_from is not None:
            for other in layers.triangles[layers.head]:
                yield (layers.head, other), other != triangle, True

    def _onward(self, node: Node) -> Iterator["_Edge"]:
        layer, triangle, state = node
        for (following, other), spells, progress in self._ways_on(layer, triangle):
            mask = self._image(1 << state, other) if spells else 1 << state
            yield from (
                _Edge(node, (following, other, target), spells=spells, progress=progress) for target in _bits(mask)
            )

    def _start_nodes(self) -> Iterator[Node]:
        for triangle, mask in self._start_masks.items():
            yield from ((0, triangle, state) for state in _bits(mask))


def _back(edge: _Edge, parents: Mapping[Node, _Edge]) -> list[_Edge]:
    """The edges that led to one, from the one from nowhere on, and itself."""
    way = [edge]
    while (source := way[-1].source) is not None:
        way.append(parents[source])
    return way[::-1]


def _changes(nodes: Iterable[Node]) -> Way:
    """Layer and triangle of the first node and wherever one of them changes."""
    return tuple(place for place, _ in groupby(node[:2] for node in nodes))


def _bits(mask: int) -> Iterator[int]:
    """Indices of the bits that are set, ascending."""
    while mask:
        lowest = mask & -mask
        yield lowest.bit_length() - 1
        mask ^= lowest


def _array(mask: int, size: int) -> BoolArray:
    """A bit mask as an array of truth values."""
    octets = np.frombuffer(mask.to_bytes((size + 7) // 8, "little"), dtype=np.uint8)
    return np.unpackbits(octets, bitorder="little", count=size).astype(np.bool_)
