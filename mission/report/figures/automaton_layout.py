"""Where states, arrows and guards stand in the picture of an automaton: in layers, and no guard on another."""

import itertools
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import shapely

from mission.geometry.arrays import FloatArray
from mission.logic.automata.automaton import Edge
from mission.report.figures.arrows import between_discs, bowed
from mission.report.figures.canvas import text_size_em
from mission.report.figures.fitting import boxes_at
from mission.report.figures.layering import Layers, layered

CLASH = 100.0
DISC_PT = 15.0
LOOP_PT = 40.0
ROW_PT = 74.0
WIDEST_PT = 900.0
APART_PT = 5.0  # between guards side by side
Pair = tuple[int, int]
PLACES_ON_ARROW = (0.5, 0.42, 0.58, 0.34, 0.66, 0.26, 0.74, 0.19, 0.81)


@dataclass(frozen=True)
class Part:
    """What is drawn of an automaton, and how its guards are written.

    Attributes:
        states: Those drawn, ascending.
        edges: Those drawn.
        idle: Indices into ``edges`` of those that no label of the domain can take.
        texts: What is written at each edge.
        key: Lines that explain the texts.
        note: What the reader must know of what was left out.
    """

    states: tuple[int, ...]
    edges: tuple[Edge, ...]
    idle: frozenset[int]
    texts: tuple[str, ...]
    key: tuple[str, ...]
    note: str

    @property
    def pairs(self) -> list[Pair]:
        """The ends of the edges, as indices into ``states``."""
        place = {state: index for index, state in enumerate(self.states)}
        return [(place[edge.source], place[edge.target]) for edge in self.edges]


@dataclass(frozen=True, eq=False)
class Arrangement:
    """Where things stand, in points.

    Attributes:
        size_pt: Size of the guards.
        roots: Nodes with an arrow from outside.
        nodes: Centres of the states, (N, 2).
        curves: One polyline an edge.
        labels: Centre of the guard of each edge, (E, 2).
        sizes: Width and height of each guard.
        clashes: Number of guards that hide a state or another guard.
    """

    size_pt: float
    roots: tuple[int, ...]
    nodes: FloatArray
    curves: list[FloatArray]
    labels: FloatArray
    sizes: list[tuple[float, float]]
    clashes: int


def arranged(part: Part, roots: Sequence[int], size_pt: float) -> Arrangement:
    """Find a place for everything in ``part``, with guards of the given size."""
    pairs = part.pairs
    sizes = [(size_pt * width, size_pt * height) for width, height in map(text_size_em, part.texts)]
    layers = layered(len(part.states), roots, pairs)
    columns, row_pt = _spacing(layers, pairs, sizes)
    nodes = np.stack((columns[list(layers.layer)], -row_pt * np.array(layers.row)), axis=-1)
    curves = [
        _loop(nodes[source]) if source == target else _way(layers, (source, target), pairs, columns, row_pt)
        for source, target in pairs
    ]
    labels, clashes = _label_places(curves, pairs, sizes, nodes)
    return Arrangement(size_pt, tuple(roots), nodes, curves, labels, sizes, clashes)


def _spacing(layers: Layers, pairs: Sequence[Pair], sizes: Sequence[tuple[float, float]]) -> tuple[FloatArray, float]:
    """Where each layer stands, shape (layers,), and the height of a row, in points: as wide as the guards need."""
    count = max(layers.layer) + 1
    gaps, loops = np.full(count, 60.0), np.zeros(count)
    for (source, target), (width, _) in zip(pairs, sizes, strict=True):
        first, last = sorted((layers.layer[source], layers.layer[target]))
        if source == target:
            loops[first] = max(loops[first], 0.5 * width)
        else:
            gaps[first:last] = np.maximum(gaps[first:last], (width if last - first == 1 else 0.5 * width) + 34.0)
    steps = np.maximum(2 * DISC_PT + gaps[:-1], loops[:-1] + loops[1:] + 12.0)
    columns = np.concatenate(([0.0], np.cumsum(steps)))
    columns *= min(1.0, WIDEST_PT / max(float(columns[-1]), 1.0))
    tallest = max((height for _, height in sizes), default=0.0)
    return columns, max(ROW_PT, LOOP_PT + DISC_PT + tallest + 8.0)


def _loop(node: FloatArray) -> FloatArray:
    """An arrow from a node round to itself, above it."""
    t = np.linspace(0.0, 1.0, 33)[:, None]
    left, right = np.array([-24.0, LOOP_PT + 12.0]), np.array([24.0, LOOP_PT + 12.0])
    start = DISC_PT * np.array([-np.sin(0.5), np.cos(0.5)])
    end = start * (-1.0, 1.0)
    curve: FloatArray = node + _bezier(t, start, left, right, end)
    return curve


def _way(layers: Layers, pair: Pair, pairs: Sequence[Pair], columns: FloatArray, row_pt: float) -> FloatArray:
    """An arrow between two nodes through its way points, level at each; apart from one that goes the other way."""
    points = np.array([(columns[level], -row_pt * row) for level, row in layers.ways[pair]])
    both_ways = pair[::-1] in pairs
    if both_ways and len(points) == 2:  # noqa: PLR2004 - nothing in between
        return between_discs(bowed(points[0], points[1], 0.14), DISC_PT, DISC_PT)
    if both_ways:
        points[1:-1, 1] += 9.0 if pair[0] < pair[1] else -9.0
    t = np.linspace(0.0, 1.0, 25)[:, None]
    pieces = []
    for start, end in itertools.pairwise(points):
        middle = 0.5 * (start[0] + end[0])
        pieces.append(_bezier(t, start, np.array([middle, start[1]]), np.array([middle, end[1]]), end))
    return between_discs(np.concatenate(pieces), DISC_PT, DISC_PT)


def _bezier(t: FloatArray, a: FloatArray, b: FloatArray, c: FloatArray, d: FloatArray) -> FloatArray:
    curve: FloatArray = (1 - t) ** 3 * a + 3 * t * (1 - t) ** 2 * b + 3 * t**2 * (1 - t) * c + t**3 * d
    return curve


def _label_places(
    curves: Sequence[FloatArray], pairs: Sequence[Pair], sizes: Sequence[tuple[float, float]], nodes: FloatArray
) -> tuple[FloatArray, int]:
    """The centre of each guard, and how many hide a state or another guard.

    Guards stand over their loops, or on their arrows where they hide no state, no other guard and few arrows.
    """
    discs = shapely.buffer(shapely.points(nodes), DISC_PT + 1.0)
    lines = np.array([shapely.LineString(curve) for curve in curves], dtype=object)
    clashes = 0
    taken: list[shapely.Geometry] = []
    places = np.zeros((len(curves), 2))
    loops_first = sorted(range(len(curves)), key=lambda k: (pairs[k][0] != pairs[k][1], k))
    for k in loops_first:
        curve, (width, height) = curves[k], sizes[k]
        if pairs[k][0] == pairs[k][1]:
            spots = np.array([[curve[:, 0].mean(), curve[:, 1].max() + 0.5 * height + 1.0]])
        else:
            along = np.concatenate(([0.0], np.cumsum(np.hypot(*np.diff(curve, axis=0).T))))
            at = along[-1] * np.array(PLACES_ON_ARROW)
            spots = np.stack((np.interp(at, along, curve[:, 0]), np.interp(at, along, curve[:, 1])), axis=-1)
        boxes = boxes_at(spots[:, 0], spots[:, 1], (width + APART_PT, height), 1.0)
        cost = 3.0 * CLASH * shapely.intersects(boxes[:, None], discs[None]).sum(axis=1)
        if taken:
            cost += CLASH * shapely.intersects(boxes[:, None], np.array(taken)[None]).sum(axis=1)
        cost += shapely.intersects(boxes[:, None], np.delete(lines, k)[None]).sum(axis=1)
        best = int(np.argmin(cost))
        places[k] = spots[best]
        clashes += bool(cost[best] >= CLASH)
        taken.append(boxes[best])
    return places, clashes
