"""Figure 4: the Büchi automaton of the formula, states in layers from the initial ones to the accepting ones."""

import itertools
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
import shapely
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from mission.geometry.arrays import FloatArray
from mission.logic.automaton import BuchiAutomaton, Edge
from mission.plan import FlightPlan
from mission.report.figures.arrows import between_discs, bowed, draw_arrows
from mission.report.figures.canvas import drawing, new_figure, text_size_em, titled
from mission.report.figures.fitting import boxes_at
from mission.report.figures.guard_text import keyed, shortened, written
from mission.report.figures.layering import Layers, layered
from mission.report.figures.palette import BLACK, BLUE, QUIET, WHITE
from mission.spec.model import RegionKind, Semantics

MOST_STATES = 30
MOST_STATES_IN_FULL = 8
MOST_EDGES_IN_FULL = 24
CLASH = 100.0
DISC_PT = 15.0
LOOP_PT = 40.0
GUARD_PT, SMALL_GUARD_PT = 10.0, 8.5
ROW_PT = 74.0
WIDEST_PT = 900.0
LEAST_WIDTH_PT = 470.0
MARGIN_PT = 26.0
INITIAL_ARROW_PT = 24.0
KEY_LINE_PT = 14.0
ACCEPTING_FILL = "#CCEBE3"  # GREEN at a fifth
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
    """Where things stand, in points: nodes (N, 2), one polyline an edge, one label centre an edge (E, 2)."""

    nodes: FloatArray
    curves: list[FloatArray]
    labels: FloatArray
    sizes: list[tuple[float, float]]
    clashes: int


def automaton(plan: FlightPlan) -> Figure:
    """The automaton with its guards; of one with more than 30 states, the part that the run goes through.

    Guards are written in full where they find room, else as short as the labels of the domain allow, else by a key.
    """
    machine = plan.automaton
    for part in _parts(plan):
        roots = [part.states.index(state) for state in machine.initial if state in part.states]
        size_pt = GUARD_PT if len(part.states) <= MOST_STATES_IN_FULL else SMALL_GUARD_PT
        arrangement = _arranged(part, roots, size_pt)
        if arrangement.clashes == 0:
            break
    with drawing():
        title = f"Automaton: {machine.size} states, {machine.edge_count} edges"
        corners = [arrangement.labels + 0.5 * sign * np.array(arrangement.sizes).reshape(-1, 2) for sign in (-1, 1)]
        figure, axes = _canvas([arrangement.nodes, *arrangement.curves, *corners], title, part)
        for idle, colour in ((False, BLACK), (True, QUIET)):
            chosen = [curve for k, curve in enumerate(arrangement.curves) if (k in part.idle) is idle]
            draw_arrows(axes, chosen, colour=colour, width=1.0, head=8.0, dashed=idle)
        _draw_states(axes, machine, part.states, arrangement.nodes, roots)
        for k, ((x, y), text) in enumerate(zip(arrangement.labels.tolist(), part.texts, strict=True)):
            axes.text(
                x,
                y,
                text,
                fontsize=size_pt,
                color=QUIET if k in part.idle else BLUE,
                ha="center",
                va="center",
                linespacing=1.0,
                zorder=4,
                gid="guard",
                bbox={"facecolor": WHITE, "linewidth": 0, "boxstyle": "square,pad=0.06"},
            )
    return figure


def _parts(plan: FlightPlan) -> Iterator[Part]:
    """Ways to show the plan's automaton on one page, the most complete first."""
    machine = plan.automaton
    states, notes = tuple(range(machine.size)), []
    if machine.size > MOST_STATES:
        states = tuple(sorted(states_along(plan)[:MOST_STATES]))
        notes = [f"{len(states)} of {machine.size} states: those along the run."]
    edges = [edge for edge in machine.edges if edge.source in states and edge.target in states]
    idle = frozenset(k for k, edge in enumerate(edges) if not _takes_any(edge, plan.labelling.letters))
    if len(edges) <= MOST_EDGES_IN_FULL and len(states) <= MOST_STATES_IN_FULL:
        more = ["Dashed: edges that no label of the domain can take."] if idle else []
        texts = tuple(written(edge.guard) for edge in edges)
        yield Part(states, tuple(edges), idle, texts, (), " ".join(notes + more))
    restricted = {region.name for region in plan.spec.regions if region.kind is RegionKind.RESTRICTED}
    met = [letter for letter in plan.labelling.letters if not letter & restricted]
    taken = [edge for edge in edges if _takes_any(edge, met)]
    guards = [shortened(edge.guard, met) for edge in taken]
    if any(guard != edge.guard for guard, edge in zip(guards, taken, strict=True)):
        notes.append("Guards are cut to what tells the labels outside restricted regions apart.")
    if len(taken) < len(edges):
        notes.append(f"{len(edges) - len(taken)} edges that none of these labels can take are left out.")
    note = "\n".join(notes)
    yield Part(states, tuple(taken), frozenset(), tuple(map(written, guards)), (), note)
    names, key = keyed(guards)
    yield Part(states, tuple(taken), frozenset(), tuple(names), tuple(key), note)


def _takes_any(edge: Edge, letters: Sequence[frozenset[str]]) -> bool:
    return any(edge.guard.allows(letter) for letter in letters)


def _arranged(part: Part, roots: Sequence[int], size_pt: float) -> Arrangement:
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
    return Arrangement(nodes, curves, labels, sizes, clashes)


def states_along(plan: FlightPlan) -> list[int]:
    """States that some accepting reading of the run's word goes through, in the order in which they are met.

    The word is that of the run's triangles; where the automaton has several readings, all states count from which the
    end of the second round of the loop can still be reached.
    """
    machine = plan.automaton
    triangles = [*plan.run.prefix, *plan.run.suffix, *plan.run.suffix]
    letters = [plan.labelling.label(triangle) for triangle in triangles]
    if plan.spec.semantics is Semantics.PAPER:
        letters = letters[1:]
    reached = [frozenset(machine.initial)]
    for letter in letters:
        steps = (edge.target for state in reached[-1] for edge in machine.outgoing[state] if edge.guard.allows(letter))
        reached.append(frozenset(steps))
    useful = reached[-1]
    kept = [useful]
    for states, letter in zip(reached[-2::-1], letters[::-1], strict=True):
        useful = frozenset(
            state
            for state in states
            if any(edge.target in useful and edge.guard.allows(letter) for edge in machine.outgoing[state])
        )
        kept.append(useful)
    return list(dict.fromkeys(state for states in kept[::-1] for state in sorted(states)))


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
    lines = shapely.linestrings(
        [point for curve in curves for point in curve],
        indices=np.repeat(np.arange(len(curves)), [len(curve) for curve in curves]),
    )
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
        boxes = boxes_at(spots[:, 0], spots[:, 1], (width, height), 1.0)
        cost = 3.0 * CLASH * shapely.intersects(boxes[:, None], discs[None]).sum(axis=1)
        if taken:
            cost += CLASH * shapely.intersects(boxes[:, None], np.array(taken)[None]).sum(axis=1)
        cost += shapely.intersects(boxes[:, None], np.delete(lines, k)[None]).sum(axis=1)
        best = int(np.argmin(cost))
        places[k] = spots[best]
        clashes += bool(cost[best] >= CLASH)
        taken.append(boxes[best])
    return places, clashes


def _canvas(content: Sequence[FloatArray], title: str, part: Part) -> tuple[Figure, Axes]:
    """A figure as large as what it shows, with axes in points that cover it."""
    points = np.concatenate([part for part in content if len(part)])
    (west, south), (east, north) = points.min(axis=0) - DISC_PT, points.max(axis=0) + DISC_PT
    west -= INITIAL_ARROW_PT
    more = max(0.0, 0.5 * (LEAST_WIDTH_PT - 2 * MARGIN_PT - (east - west)))
    west, east = west - more - MARGIN_PT, east + more + MARGIN_PT
    below = 30.0 + KEY_LINE_PT * len(part.key) + 13.0 * part.note.count("\n") + (8.0 if part.key else 0.0)
    north, south = north + 38.0, south - below
    figure = new_figure(east - west, north - south)
    axes = figure.add_axes((0.0, 0.0, 1.0, 1.0))
    axes.set(xlim=(west, east), ylim=(south, north))
    axes.set_axis_off()
    titled(figure, title, part.note)
    for k, line in enumerate(part.key):
        axes.text(
            west + 12.0, south + below - KEY_LINE_PT * (k + 1), line, fontsize=9.0, va="bottom", color=BLUE, gid="key"
        )
    return figure, axes


def _draw_states(
    axes: Axes, machine: BuchiAutomaton, states: Sequence[int], nodes: FloatArray, roots: Sequence[int]
) -> None:
    axes.scatter(
        nodes[:, 0],
        nodes[:, 1],
        s=(2 * DISC_PT) ** 2,
        facecolor=WHITE,
        edgecolor=BLACK,
        linewidth=1.4,
        zorder=3,
        gid="states",
    )
    accepting = nodes[[k for k, state in enumerate(states) if state in machine.accepting]]
    axes.scatter(
        accepting[:, 0],
        accepting[:, 1],
        s=(2 * DISC_PT - 7) ** 2,
        facecolor=ACCEPTING_FILL,
        edgecolor=BLACK,
        linewidth=1.4,
        zorder=3.1,
        gid="accepting",
    )
    for state, (x, y) in zip(states, nodes.tolist(), strict=True):
        axes.text(
            x,
            y,
            f"q{state}",
            fontsize=min(10.5, 1.7 * DISC_PT / text_size_em(f"q{state}")[0]),
            ha="center",
            va="center_baseline",
            zorder=4,
            gid="state",
        )
    starts = [
        np.array([node - (DISC_PT + INITIAL_ARROW_PT, 0.0), node - (DISC_PT, 0.0)]) for node in nodes[list(roots)]
    ]
    draw_arrows(axes, starts, colour=BLACK, width=1.8, head=9.0)
