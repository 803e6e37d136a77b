"""Figure 3: the quotient, the transition system of triangles and controls, at the triangles' centroids."""

from dataclasses import dataclass
from itertools import pairwise

import numpy as np
import shapely
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection
from matplotlib.figure import Figure

from mission.geometry.arrays import BoolArray, FloatArray, IntArray
from mission.plan import FlightPlan
from mission.report.figures.arrows import between_discs, bowed, draw_arrows
from mission.report.figures.canvas import LEAST_PT, drawing, text_size_em
from mission.report.figures.chart import Chart, chart_of, draw_names, name_sizes
from mission.report.figures.fitting import Placed, boxes_at, place_names
from mission.report.palette import BLACK, BLUE, MESH, QUIET, VERMILLION, WHITE

MOST_IN_FULL = 40
LARGEST_DISC_PT, SMALLEST_DISC_PT = 12.0, 8.5  # of states whose numbers can be read
DOT_PT, RUN_DOT_PT = 1.5, 2.8
NUMBER_SIZES_PT = (8.5, LEAST_PT)
LABEL_PT = 9.0
ROOM_FOR_LABEL_PT = 24.0
PART_WITH_ROOM = 0.75
DISC_PART_OF_DISTANCE = 0.21
BOW = 0.13
PLACES_ON_ARROW = (0.3, 0.4, 0.5, 0.22, 0.6)
CONTROLS = "₁₂₃"
NAME_SIZES_PT = (12.0, 10.5, 9.0)


@dataclass(frozen=True, eq=False)
class Move:
    """One transition: its source, which facet it leaves by, and its arrow in the domain's frame."""

    source: int
    facet: int
    curve: FloatArray


def quotient(plan: FlightPlan) -> Figure:
    """States at the centroids of their triangles, an arrow with its control for each move to a neighbour.

    Of more than 40 triangles, or where they are too small for numbers, the run and its neighbours are drawn strongly
    and the rest faintly.
    """
    chart = chart_of(plan)
    partition = plan.partition
    centres = partition.corners_m.mean(axis=1)
    restricted = np.zeros(partition.size, dtype=bool)
    restricted[list(chart.restricted)] = True
    allowed = (partition.neighbours >= 0) & ~restricted[:, None] & ~restricted[partition.neighbours]
    sources, facets = np.nonzero(allowed)
    targets = partition.neighbours[sources, facets]
    lengths = np.hypot(*(centres[targets] - centres[sources]).T) / chart.em_m
    disc_pt = min(LARGEST_DISC_PT, DISC_PART_OF_DISTANCE * float(np.median(lengths))) if len(lengths) else 0.0
    title = f"Quotient: {partition.size} states, {len(sources) + partition.size} transitions"
    with drawing():
        if partition.size > MOST_IN_FULL or disc_pt < SMALLEST_DISC_PT:
            return _along_the_run(chart, title, centres, restricted, np.stack((sources, targets), axis=-1))
        labelled = float(np.mean(lengths - 2 * disc_pt >= ROOM_FOR_LABEL_PT)) >= PART_WITH_ROOM
        figure, axes = chart.figure(title, legend=[], note=_note(labelled=labelled))
        chart.draw_domain(axes)
        moves = _moves(chart, centres, sources, facets, disc_pt * chart.em_m)
        head_m = min(7.0, 0.8 * disc_pt + 1.0) * chart.em_m
        draw_arrows(axes, [move.curve for move in moves], colour=BLACK, width=0.9, head=head_m)
        taken = list(shapely.buffer(shapely.points(centres), disc_pt * chart.em_m))
        _draw_numbers(axes, centres, disc_pt, restricted)
        if labelled:
            taken += _draw_controls(axes, chart, moves, centres, disc_pt)
        taken += [shapely.LineString(move.curve).buffer(chart.em_m) for move in moves]
        draw_names(axes, _names(chart, taken))
    return figure


def _names(chart: Chart, taken: list[shapely.Geometry]) -> tuple[Placed, ...]:
    names = name_sizes(chart.shapes, chart.titles)
    return place_names(names, em_m=chart.em_m, sizes_pt=NAME_SIZES_PT, obstacles=taken, frame=chart.frame)


def _note(*, labelled: bool) -> str:
    if not labelled:
        return "u₀ stays; u₁, u₂, u₃ move. Their names have no room here. None enters a restricted triangle."
    return "u₀, which stays, is left out; uⱼ leaves opposite the j-th vertex. None enters a restricted triangle."


def _along_the_run(chart: Chart, title: str, centres: FloatArray, restricted: BoolArray, moves: IntArray) -> Figure:
    """The states of the run with its moves, strong; the moves between them and their neighbours; faint, the others."""
    run = chart.plan.run
    order = [*run.states, run.suffix[0]]
    steps = sorted({(a, b) for a, b in pairwise(order) if a != b})
    on_run = np.zeros(len(centres), dtype=bool)
    on_run[order] = True
    once = moves[moves[:, 0] < moves[:, 1]]
    near = on_run[once].any(axis=1)
    beside = np.zeros_like(on_run)
    beside[once[near].ravel()] = True
    dot_m = RUN_DOT_PT * chart.em_m
    arrows = [between_discs(bowed(centres[a], centres[b], 0.0), dot_m, dot_m) for a, b in steps]
    arrows = [arrow for arrow in arrows if len(arrow)]
    numbered = np.flatnonzero(on_run).tolist()
    lines = [shapely.LineString(centres[list(step)]).buffer(1.5 * chart.em_m) for step in steps]
    names = _names(chart, lines)
    numbers = place_names(
        [(str(i), shapely.Point(centres[i]).buffer(dot_m), text_size_em(str(i))) for i in numbered],
        em_m=chart.em_m,
        sizes_pt=NUMBER_SIZES_PT,
        obstacles=[*lines, *(name.box(chart.em_m) for name in names)],
        frame=chart.frame,
        needed=False,
    )
    lost = len(numbered) - len(numbers)
    note = f"Strong: the {len(numbered)} states of the run and its moves. Grey: their neighbours. Faint: the others. "
    note += f"{lost} numbers of states have no room. " if lost else ""
    figure, axes = chart.figure(title, legend=[], note=f"{note}u₀ stays. None enters a restricted triangle.")
    chart.draw_domain(axes)
    for gid, chosen, colour, width in (("others", ~near, MESH, 0.5), ("neighbours", near, QUIET, 0.9)):
        axes.add_collection(LineCollection(list(centres[once[chosen]]), colors=colour, lw=width, zorder=2, gid=gid))
    for gid, chosen, colour, size_pt in (
        ("restricted states", restricted, VERMILLION, DOT_PT),
        ("other states", ~restricted & ~beside, MESH, DOT_PT),
        ("neighbours' states", beside & ~on_run, QUIET, DOT_PT),
        ("run's states", on_run, BLACK, RUN_DOT_PT),
    ):
        x, y = centres[chosen].T
        axes.scatter(x, y, s=(2 * size_pt) ** 2, color=colour, linewidth=0, zorder=3, gid=gid)
    draw_arrows(axes, arrows, colour=BLACK, width=1.7, head=6.5 * chart.em_m)
    draw_names(axes, numbers, colour=BLACK, bold=False, gid="state")
    draw_names(axes, names)
    return figure


def _moves(chart: Chart, centres: FloatArray, sources: IntArray, facets: IntArray, disc_m: float) -> list[Move]:
    moves = []
    for source, facet in zip(sources.tolist(), facets.tolist(), strict=True):
        target = int(chart.partition.neighbours[source, facet])
        curve = between_discs(bowed(centres[source], centres[target], BOW), disc_m, disc_m)
        if len(curve):
            moves.append(Move(source, facet, curve))
    return moves


def _draw_numbers(axes: Axes, centres: FloatArray, disc_pt: float, restricted: BoolArray) -> None:
    edges = np.where(restricted, VERMILLION, BLACK)
    axes.scatter(
        centres[:, 0],
        centres[:, 1],
        s=(2 * disc_pt) ** 2,
        facecolor=WHITE,
        edgecolor=edges,
        linewidth=1.1,
        zorder=3,
        gid="states",
    )
    for triangle, (x, y) in enumerate(centres.tolist()):
        text = str(triangle)
        size = max(LEAST_PT, min(0.95 * disc_pt, 1.6 * disc_pt / text_size_em(text)[0]))
        axes.text(x, y, text, fontsize=size, ha="center", va="center_baseline", zorder=4, gid="state")


def _draw_controls(
    axes: Axes, chart: Chart, moves: list[Move], centres: FloatArray, disc_pt: float
) -> list[shapely.Geometry]:
    """Write u_j on the outer side of each arrow that is long enough, near its tail, off the discs and other labels."""
    size = text_size_em("u₁")
    discs = shapely.buffer(shapely.points(centres), disc_pt * chart.em_m)
    taken: list[shapely.Geometry] = []
    for move in moves:
        if shapely.length(shapely.LineString(move.curve)) < ROOM_FOR_LABEL_PT * chart.em_m:
            continue
        spots = np.array([_beside(move.curve, place, 6.5 * chart.em_m) for place in PLACES_ON_ARROW])
        boxes = boxes_at(spots[:, 0], spots[:, 1], size, LABEL_PT * chart.em_m)
        near = discs[shapely.dwithin(discs, shapely.LineString(move.curve), 3 * LABEL_PT * chart.em_m)]
        hits = shapely.intersects(boxes[:, None], near[None]).sum(axis=1)
        if taken:
            hits = hits + shapely.intersects(boxes[:, None], np.array(taken)[None]).sum(axis=1)
        best = int(np.argmin(hits))
        x, y = spots[best].tolist()
        axes.text(
            x,
            y,
            "u" + CONTROLS[move.facet],
            fontsize=LABEL_PT,
            color=BLUE,
            ha="center",
            va="center",
            zorder=4,
            gid="control",
        )
        taken.append(boxes[best])
    return taken


def _beside(curve: FloatArray, place: float, distance: float) -> FloatArray:
    """A point to the right of a polyline, at a fraction of its samples."""
    index = min(len(curve) - 2, int(place * len(curve)))
    way = curve[index + 1] - curve[index]
    right = np.array([way[1], -way[0]]) / max(float(np.hypot(*way)), 1e-12)
    point: FloatArray = curve[index] + distance * right
    return point
