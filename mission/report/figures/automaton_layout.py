"""Where states, arrows and guards stand in the picture of an automaton: in layers, and no arrow over what it passes."""

import itertools
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from mission.geometry.arrays import FloatArray
from mission.logic.automata.automaton import Edge
from mission.report.figures.canvas import text_size_em
from mission.report.figures.layering import Layers, layered

DISC_PT = 15.0
LOOP_PT = 28.0  # from the rim of its state to the top of a loop
INITIAL_ARROW_PT = 24.0
RUN_UP_PT = 13.0  # of an arrow, level before its state: its head is seen
BESIDE_PT = 3.0  # between a guard and the bends of its arrow
PORTS_PT = 9.0  # between arrows at a state, where they have room
LAST_PORT_PT = 10.0  # from the middle of a state
SLOPE = 0.35  # of the arrow that changes its height most between two layers
LEAST_CHANNEL_PT, WIDEST_CHANNEL_PT = 16.0, 75.0
SAMPLES = 21
Pair = tuple[int, int]


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
        nodes: Centres of the states, (N, 2).
        starts: An arrow from outside for each initial state, (2, 2) each.
        curves: One polyline an edge.
        labels: Centre of the guard of each edge, (E, 2).
        sizes: Width and height of each guard.
    """

    size_pt: float
    nodes: FloatArray
    starts: list[FloatArray]
    curves: list[FloatArray]
    labels: FloatArray
    sizes: list[tuple[float, float]]

    @property
    def corners(self) -> FloatArray:
        """South-west and north-east of all that is drawn, shape (2, 2)."""
        half = 0.5 * np.array(self.sizes).reshape(-1, 2)
        points = (*self.curves, *self.starts, self.labels - half, self.labels + half, self.nodes - DISC_PT)
        drawn = np.concatenate([*points, self.nodes + DISC_PT])
        return np.stack((drawn.min(axis=0), drawn.max(axis=0)))


def arranged(part: Part, roots: Sequence[int], size_pt: float) -> Arrangement:
    """Find a place for everything in ``part``, with guards of the given size."""
    pairs = part.pairs
    sizes = [(size_pt * width, size_pt * height) for width, height in map(text_size_em, part.texts)]
    loops = {pair[0]: k for k, pair in enumerate(pairs) if pair[0] == pair[1]}
    ways = [k for k, pair in enumerate(pairs) if pair[0] != pair[1]]
    extents = [
        (
            DISC_PT + (LOOP_PT + sizes[loops[node]][1] if node in loops else 0.0),
            DISC_PT + INITIAL_ARROW_PT * (node in roots),
        )
        for node in range(len(part.states))
    ]
    layers = layered(extents, roots, [pairs[k] for k in ways], [sizes[k][1] for k in ways])
    columns = _columns(layers, {node: sizes[k][0] for node, k in loops.items()}, [sizes[k][0] for k in ways])
    nodes = np.array([(columns.middle[level], -y) for level, y in zip(layers.layer, layers.y, strict=True)])
    ports = _ports(layers, [pairs[k] for k in ways])
    curves = [np.zeros((0, 2))] * len(pairs)
    labels = np.zeros((len(pairs), 2))
    for node, k in loops.items():
        curves[k] = _loop(nodes[node])
        labels[k] = nodes[node] + (0.0, DISC_PT + LOOP_PT + 0.5 * sizes[k][1])
    for index, k in enumerate(ways):
        way = layers.ways[index]
        curves[k] = _curve(way, columns, ports[index])
        level, y = way[layers.labels[index]]
        labels[k] = columns.middle[level], -y
    return Arrangement(size_pt, nodes, [_start(nodes[k], layers.layer[k]) for k in roots], curves, labels, sizes)


@dataclass(frozen=True, eq=False)
class _Columns:
    """Where each layer stands: its middle, and how far it reaches to either side, points; shape (layers,)."""

    middle: FloatArray
    half: FloatArray


def _columns(layers: Layers, loops: dict[int, float], widths: Sequence[float]) -> _Columns:
    """Layers as wide as what stands in them, and apart so that arrows between them are not too steep."""
    count = max(layers.layer) + 1
    half = np.where(np.arange(count) % 2 == 0, DISC_PT + RUN_UP_PT, 0.0)
    steepest = np.zeros(count)
    for node, width in loops.items():
        half[layers.layer[node]] = max(half[layers.layer[node]], 0.5 * width + BESIDE_PT)
    for way, label, width in zip(layers.ways, layers.labels, widths, strict=True):
        level = way[label][0]
        half[level] = max(half[level], 0.5 * width + BESIDE_PT)
        for here, there in itertools.pairwise(way):
            channel = min(here[0], there[0])
            steepest[channel] = max(steepest[channel], abs(here[1] - there[1]))
    channels = np.clip(SLOPE * steepest[:-1], LEAST_CHANNEL_PT, WIDEST_CHANNEL_PT)
    return _Columns(np.concatenate(([0.0], np.cumsum(half[:-1] + channels + half[1:]))), half)


def _ports(layers: Layers, pairs: Sequence[Pair]) -> list[tuple[float, float]]:
    """How far below the middle of its source and its target each edge ends: those of one side fanned out in order."""
    sides: dict[tuple[int, bool], list[tuple[float, int, int]]] = {}
    for k, (pair, way) in enumerate(zip(pairs, layers.ways, strict=True)):
        for end, (here, there) in enumerate(((way[0], way[1]), (way[-1], way[-2]))):
            sides.setdefault((pair[end], there[0] > here[0]), []).append((there[1], k, end))
    ports = np.zeros((len(pairs), 2))
    for ends in sides.values():
        last = min(LAST_PORT_PT, 0.5 * PORTS_PT * (len(ends) - 1))
        for place, (_, k, end) in zip(np.linspace(-last, last, len(ends)), sorted(ends), strict=True):
            ports[k, end] = place
    return [(float(first), float(second)) for first, second in ports]


def _curve(way: Sequence[tuple[int, float]], columns: _Columns, ports: tuple[float, float]) -> FloatArray:
    """An arrow from rim to rim: level in each layer, bent between them."""
    ahead = 1.0 if way[-1][0] > way[0][0] else -1.0
    x = [columns.middle[level] for level, _ in way]
    half = [ahead * columns.half[level] for level, _ in way]
    y = [-each for _, each in way]
    y[0], y[-1] = y[0] - ports[0], y[-1] - ports[1]
    rims = [ahead * float(np.sqrt(DISC_PT**2 - port**2)) for port in ports]
    t = np.linspace(0.0, 1.0, SAMPLES)[:, None]
    pieces = [np.array([[x[0] + rims[0], y[0]]])]
    for k in range(len(way) - 1):
        start, end = np.array([x[k] + half[k], y[k]]), np.array([x[k + 1] - half[k + 1], y[k + 1]])
        middle = 0.5 * (start[0] + end[0])
        pieces.append(_bezier(t, start, np.array([middle, start[1]]), np.array([middle, end[1]]), end))
    pieces.append(np.array([[x[-1] - rims[1], y[-1]]]))
    return np.concatenate(pieces)


def _loop(node: FloatArray) -> FloatArray:
    """An arrow from a node round to itself, above it."""
    t = np.linspace(0.0, 1.0, 33)[:, None]
    left, right = np.array([-24.0, DISC_PT + LOOP_PT + 10.0]), np.array([24.0, DISC_PT + LOOP_PT + 10.0])
    start = DISC_PT * np.array([-np.sin(0.5), np.cos(0.5)])
    end = start * (-1.0, 1.0)
    curve: FloatArray = node + _bezier(t, start, left, right, end)
    return curve


def _start(node: FloatArray, layer: int) -> FloatArray:
    """An arrow to an initial state from outside: from the left where nothing else comes from there, else from below."""
    towards = np.array([1.0, 0.0]) if layer == 0 else np.array([0.0, 1.0])
    arrow: FloatArray = node - np.array([[DISC_PT + INITIAL_ARROW_PT], [DISC_PT]]) * towards
    return arrow


def _bezier(t: FloatArray, a: FloatArray, b: FloatArray, c: FloatArray, d: FloatArray) -> FloatArray:
    curve: FloatArray = (1 - t) ** 3 * a + 3 * t * (1 - t) ** 2 * b + 3 * t**2 * (1 - t) * c + t**3 * d
    return curve
