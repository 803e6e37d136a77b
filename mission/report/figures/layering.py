"""Layered drawing of a directed graph: left to right, long edges through way points, few crossings.

The classic four steps of Sugiyama: edges that go back are reversed, layers are longest paths, way points are put on
edges that skip layers and the order in each layer is improved by sweeping barycentres, and coordinates are evened out.
Every choice has a fixed order, so the same graph gives the same drawing.
"""

import itertools
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from mission.geometry.arrays import FloatArray

Edge = tuple[int, int]
SWEEPS = 12
EVENINGS = 40
BESIDE_A_WAY = 0.6  # rows between a node and the way point of an edge that passes by
BETWEEN_WAYS = 0.4  # rows between two such way points


@dataclass(frozen=True)
class Layers:
    """A layered drawing, in units of one layer (x) and one row (y).

    Attributes:
        layer: The layer of each node, from 0.
        row: The row of each node; nodes of one layer are at least one row apart, and less so the edges that pass by.
        ways: The way points of each edge, as pairs (layer, row), from its source to its target, both included.
    """

    layer: tuple[int, ...]
    row: tuple[float, ...]
    ways: Mapping[Edge, tuple[tuple[int, float], ...]]


def layered(size: int, roots: Sequence[int], edges: Sequence[Edge]) -> Layers:
    """Lay out nodes 0 to ``size`` - 1; edges from a node to itself are left to the caller."""
    distinct = sorted({edge for edge in edges if edge[0] != edge[1]})
    forward = _acyclic(size, roots, distinct)
    layer = _longest_paths(size, sorted(set(forward.values())))
    chains, height = _with_way_points(size, layer, sorted(set(forward.values())))
    levels = [*layer, *(height[k] for k in range(size, len(height)))]
    order = _ordered(levels, chains)
    loops = {source for source, target in edges if source == target}
    rows = _evened(order, chains, _Gaps(size, loops))
    ways: dict[Edge, tuple[tuple[int, float], ...]] = {}
    for edge in distinct:
        chain = chains[forward[edge]]
        points = tuple((levels[node], rows[node]) for node in chain)
        ways[edge] = points if forward[edge] == edge else points[::-1]
    return Layers(tuple(layer), tuple(rows[node] for node in range(size)), ways)


def _acyclic(size: int, roots: Sequence[int], edges: Sequence[Edge]) -> dict[Edge, Edge]:
    """Each edge, reversed where it leads back to a node from which a depth-first search is still under way."""
    successors: list[list[int]] = [[] for _ in range(size)]
    for source, target in edges:
        successors[source].append(target)
    fresh, open_, done = 0, 1, 2
    state = [fresh] * size
    forward: dict[Edge, Edge] = {}
    for root in [*roots, *range(size)]:
        if state[root] != fresh:
            continue
        state[root] = open_
        stack = [(root, iter(successors[root]))]
        while stack:
            node, rest = stack[-1]
            for target in rest:
                back = state[target] == open_
                forward[node, target] = (target, node) if back else (node, target)
                if state[target] == fresh:
                    state[target] = open_
                    stack.append((target, iter(successors[target])))
                    break
            else:
                state[node] = done
                stack.pop()
    return forward


def _longest_paths(size: int, edges: Sequence[Edge]) -> list[int]:
    """The number of edges on a longest path to each node of an acyclic graph."""
    waiting = [0] * size
    successors: list[list[int]] = [[] for _ in range(size)]
    for source, target in edges:
        successors[source].append(target)
        waiting[target] += 1
    layer = [0] * size
    ready = [node for node in range(size) if waiting[node] == 0]
    for node in ready:  # grows while it is read
        for target in successors[node]:
            layer[target] = max(layer[target], layer[node] + 1)
            waiting[target] -= 1
            if waiting[target] == 0:
                ready.append(target)
    return layer


def _with_way_points(
    size: int, layer: Sequence[int], edges: Sequence[Edge]
) -> tuple[dict[Edge, tuple[int, ...]], dict[int, int]]:
    """Each edge as a chain of nodes, one in each layer that it passes; and the layers of the nodes added for that."""
    chains: dict[Edge, tuple[int, ...]] = {}
    added: dict[int, int] = {}
    for source, target in edges:
        inner = []
        for level in range(layer[source] + 1, layer[target]):
            inner.append(size + len(added))
            added[inner[-1]] = level
        chains[source, target] = (source, *inner, target)
    return chains, {node: added.get(node, 0) for node in range(size + len(added))}


def _ordered(levels: Sequence[int], chains: Mapping[Edge, tuple[int, ...]]) -> list[list[int]]:
    """The nodes of each layer in an order with few crossings."""
    order: list[list[int]] = [[] for _ in range(max(levels) + 1)]
    for node, level in enumerate(levels):
        order[level].append(node)
    links = [pair for chain in chains.values() for pair in itertools.pairwise(chain)]
    before: list[list[int]] = [[] for _ in levels]
    after: list[list[int]] = [[] for _ in levels]
    for source, target in links:
        after[source].append(target)
        before[target].append(source)
    best, fewest = [list(nodes) for nodes in order], _crossings(order, after)
    for sweep in range(SWEEPS):
        down = sweep % 2 == 0
        near = before if down else after
        for nodes in order[1:] if down else order[-2::-1]:
            place = {node: index for nodes_ in order for index, node in enumerate(nodes_)}
            mean = {
                node: sum(place[other] for other in near[node]) / len(near[node]) if near[node] else place[node]
                for node in nodes
            }
            nodes.sort(key=lambda node: (mean[node], place[node]))
        crossings = _crossings(order, after)
        if crossings < fewest:
            best, fewest = [list(nodes) for nodes in order], crossings
    return best


def _crossings(order: Sequence[Sequence[int]], after: Sequence[Sequence[int]]) -> int:
    total = 0
    for nodes, following in itertools.pairwise(order):
        place = {node: index for index, node in enumerate(following)}
        ends = np.array([place[target] for node in nodes for target in sorted(after[node], key=place.__getitem__)])
        # Pairs of links that are out of order at their ends; those of one node are in order by construction.
        total += int(np.count_nonzero(np.triu(ends[:, None] > ends[None], 1))) if len(ends) else 0
    return total


@dataclass(frozen=True)
class _Gaps:
    """Rows between neighbours in a layer; nodes are numbers below ``size``, and ``loops`` are drawn above theirs."""

    size: int
    loops: set[int]

    def between(self, upper: int, lower: int) -> float:
        if lower in self.loops or max(upper, lower) < self.size:
            return 1.0
        return BESIDE_A_WAY if min(upper, lower) < self.size else BETWEEN_WAYS


def _evened(order: Sequence[Sequence[int]], chains: Mapping[Edge, tuple[int, ...]], gaps: _Gaps) -> list[float]:
    """Rows near the mean of the neighbours' rows, in the given order and far enough apart."""
    count = sum(len(nodes) for nodes in order)
    near: list[list[int]] = [[] for _ in range(count)]
    for chain in chains.values():
        for source, target in itertools.pairwise(chain):
            near[source].append(target)
            near[target].append(source)
    offsets = []
    rows = np.zeros(count)
    for nodes in order:
        offsets.append(np.cumsum([0.0, *(gaps.between(*pair) for pair in itertools.pairwise(nodes))]))
        rows[list(nodes)] = offsets[-1] - 0.5 * offsets[-1][-1]
    for turn in range(EVENINGS):
        layers = list(zip(order, offsets, strict=True))
        for nodes, places in layers if turn % 2 == 0 else layers[::-1]:
            wished = np.array([rows[near[node]].mean() if near[node] else rows[node] for node in nodes])
            rows[list(nodes)] = _spaced(wished, places)
    return [float(row) for row in rows - rows.min()]


def _spaced(wished: FloatArray, offsets: FloatArray) -> FloatArray:
    """The places nearest to those wished for (least squares) that are as far apart as ``offsets``, or farther."""
    # With the offsets taken off, this is an isotonic regression: blocks that clash are merged to their mean.
    blocks: list[tuple[float, int]] = []
    for value in wished - offsets:
        mean, weight = float(value), 1
        while blocks and blocks[-1][0] > mean:
            other, size = blocks.pop()
            mean, weight = (mean * weight + other * size) / (weight + size), weight + size
        blocks.append((mean, weight))
    places: FloatArray = np.concatenate([np.full(weight, mean) for mean, weight in blocks]) + offsets
    return places
