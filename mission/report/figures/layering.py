"""Layered drawing of a directed graph whose edges are labelled: left to right, no edge over a node or a label.

The classic four steps of Sugiyama: edges that go back are reversed, layers are longest paths, way points are put on
edges that skip layers and the order in each layer is improved by sweeping barycentres, and coordinates are evened out.
Between two layers of nodes lies one of labels: a label is a way point that takes room. In a layer each edge keeps its
height, so that it passes what stands there; between layers there is nothing that it could cross but other edges.
Every choice has a fixed order, so the same graph gives the same drawing.
"""

import itertools
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from mission.geometry.arrays import FloatArray

Edge = tuple[int, int]
Extent = tuple[float, float]
SWEEPS = 24
EVENINGS = 60
APART_PT = 7.0  # between what stands, or passes, in a layer
STIFFNESS = 6.0  # of edges that pass, against nodes: how much more straight they are


@dataclass(frozen=True)
class Layers:
    """A layered drawing: whole numbers of layers, and heights in points, downwards.

    Attributes:
        layer: The layer of each node, even, from 0.
        y: The height of each node.
        ways: The way points of each edge, as pairs (layer, y), from its source to its target, both included.
        labels: Which of its way points is the label of each edge.
    """

    layer: tuple[int, ...]
    y: tuple[float, ...]
    ways: tuple[tuple[tuple[int, float], ...], ...]
    labels: tuple[int, ...]


def layered(extents: Sequence[Extent], roots: Sequence[int], edges: Sequence[Edge], heights: Sequence[float]) -> Layers:
    """Lay out nodes and the labels of the edges between them.

    Args:
        extents: How far each node reaches above and below its centre, points.
        roots: Nodes that stand to the left, where no edge that is not reversed leads to them.
        edges: Between two different nodes each; there may be several between the same.
        heights: Of the label of each edge, points.
    """
    size = len(extents)
    forward = _acyclic(size, roots, sorted(set(edges)))
    layer = [2 * each for each in _longest_paths(size, sorted(set(forward.values())))]
    levels, reach = list(layer), list(extents)
    chains, labels, load = [], [], dict[int, float]()
    for edge, height in zip(edges, heights, strict=True):
        low, high = forward[edge]
        inner = range(layer[low] + 1, layer[high])
        middle = 0.5 * (layer[low] + layer[high])
        label = min(inner[::2], key=lambda level: (load.get(level, 0.0), abs(level - middle)))
        load[label] = load.get(label, 0.0) + height + APART_PT
        first = len(levels)
        levels += inner
        reach += [(0.5 * height, 0.5 * height) if level == label else (0.0, 0.0) for level in inner]
        chains.append((low, *range(first, len(levels)), high))
        labels.append(1 + inner.index(label))
    y = _evened(_ordered(levels, chains), chains, reach, size)
    ways = []
    for k, (edge, chain) in enumerate(zip(edges, chains, strict=True)):
        points = tuple((levels[node], y[node]) for node in chain)
        if forward[edge] != edge:
            points, labels[k] = points[::-1], len(points) - 1 - labels[k]
        ways.append(points)
    return Layers(tuple(layer), tuple(y[:size]), tuple(ways), tuple(labels))


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


def _ordered(levels: Sequence[int], chains: Sequence[tuple[int, ...]]) -> list[list[int]]:
    """The nodes of each layer in an order with few crossings."""
    order: list[list[int]] = [[] for _ in range(max(levels) + 1)]
    for node, level in enumerate(levels):
        order[level].append(node)
    links = [pair for chain in chains for pair in itertools.pairwise(chain)]
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


def _evened(
    order: Sequence[Sequence[int]], chains: Sequence[tuple[int, ...]], reach: Sequence[Extent], size: int
) -> list[float]:
    """Heights near the mean of the neighbours' heights, in the given order and far enough apart; from 0."""
    count = sum(len(nodes) for nodes in order)
    near: list[list[int]] = [[] for _ in range(count)]
    for chain in chains:
        for source, target in itertools.pairwise(chain):
            near[source].append(target)
            near[target].append(source)
    weights = np.where(np.arange(count) < size, 1.0, STIFFNESS)
    offsets = []
    y = np.zeros(count)
    for nodes in order:
        gaps = (reach[upper][1] + APART_PT + reach[lower][0] for upper, lower in itertools.pairwise(nodes))
        offsets.append(np.cumsum([0.0, *gaps]))
        y[list(nodes)] = offsets[-1] - 0.5 * offsets[-1][-1]
    for turn in range(EVENINGS):
        layers = list(zip(order, offsets, strict=True))
        for nodes, places in layers if turn % 2 == 0 else layers[::-1]:
            wished = np.array([y[near[node]].mean() if near[node] else y[node] for node in nodes])
            y[list(nodes)] = _spaced(wished, places, weights[list(nodes)])
    tops = [y[node] - reach[node][0] for node in range(count)]
    return [float(each) for each in y - min(tops)]


def _spaced(wished: FloatArray, offsets: FloatArray, weights: FloatArray) -> FloatArray:
    """The places nearest to those wished for (least squares) that are as far apart as ``offsets``, or farther."""
    # With the offsets taken off, this is an isotonic regression: blocks that clash are merged to their mean.
    blocks: list[tuple[float, float, int]] = []
    for value, own in zip((wished - offsets).tolist(), weights.tolist(), strict=True):
        mean, weight, count = value, own, 1
        while blocks and blocks[-1][0] > mean:
            other, heavy, more = blocks.pop()
            mean = (mean * weight + other * heavy) / (weight + heavy)
            weight, count = weight + heavy, count + more
        blocks.append((mean, weight, count))
    places: FloatArray = np.concatenate([np.full(count, mean) for mean, _, count in blocks]) + offsets
    return places
