"""Figure 3: the quotient, the transition system of triangles and controls, at the triangles' centroids."""

from dataclasses import dataclass

import numpy as np
import shapely
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection
from matplotlib.figure import Figure

from mission.geometry.arrays import BoolArray, FloatArray, IntArray
from mission.plan import FlightPlan
from mission.report.figures.arrows import between_discs, bowed, draw_arrows
from mission.report.figures.canvas import drawing, text_size_em
from mission.report.figures.chart import Chart, chart_of, draw_names, name_sizes
from mission.report.figures.fitting import boxes_at, place_names
from mission.report.palette import BLACK, BLUE, VERMILLION, WHITE

LARGEST_DISC_PT, DOT_PT = 12.0, 2.0
SMALLEST_NUMBERED_PT = 5.0
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
    """States at the centroids of their triangles, an arrow with its control for each move to a neighbour."""
    chart = chart_of(plan)
    partition = plan.partition
    centres = partition.corners_m.mean(axis=1)
    restricted = np.zeros(partition.size, dtype=bool)
    restricted[list(chart.restricted)] = True
    allowed = (partition.neighbours >= 0) & ~restricted[:, None] & ~restricted[partition.neighbours]
    sources, facets = np.nonzero(allowed)
    lengths = np.hypot(*(centres[partition.neighbours[sources, facets]] - centres[sources]).T) / chart.em_m
    disc_pt = min(LARGEST_DISC_PT, DISC_PART_OF_DISTANCE * float(np.median(lengths))) if len(lengths) else DOT_PT
    numbered = disc_pt >= SMALLEST_NUMBERED_PT
    labelled = numbered and float(np.mean(lengths - 2 * disc_pt >= ROOM_FOR_LABEL_PT)) >= PART_WITH_ROOM
    title = f"Quotient: {partition.size} states, {len(sources) + partition.size} transitions"
    with drawing():
        figure, axes = chart.figure(title, legend=[], note=_note(numbered=numbered, labelled=labelled))
        chart.draw_domain(axes)
        if numbered:
            moves = _moves(chart, centres, sources, facets, disc_pt * chart.em_m)
            head_m = min(7.0, 0.8 * disc_pt + 1.0) * chart.em_m
            draw_arrows(axes, [move.curve for move in moves], colour=BLACK, width=0.9, head=head_m)
            taken = list(shapely.buffer(shapely.points(centres), disc_pt * chart.em_m))
            _draw_numbers(axes, centres, disc_pt, restricted)
            if labelled:
                taken += _draw_controls(axes, chart, moves, centres, disc_pt)
            taken += [shapely.LineString(move.curve).buffer(chart.em_m) for move in moves]
        else:
            targets = partition.neighbours[sources, facets]
            ends = np.stack((centres[sources], centres[targets]), axis=1)[sources < targets]
            axes.add_collection(LineCollection(list(ends), colors=BLACK, linewidths=0.8, zorder=2))
            colours = np.where(restricted, VERMILLION, BLACK)
            axes.scatter(
                centres[:, 0], centres[:, 1], s=(2 * DOT_PT) ** 2, c=colours, linewidth=0, zorder=3, gid="states"
            )
            taken = []
        names = name_sizes(chart.shapes)
        draw_names(
            axes, place_names(names, em_m=chart.em_m, sizes_pt=NAME_SIZES_PT, obstacles=taken, frame=chart.frame)
        )
    return figure


def _note(*, numbered: bool, labelled: bool) -> str:
    if not numbered:
        return "Dots are states, lines are moves in both directions; u₀ stays. None enters a restricted triangle."
    if not labelled:
        return "u₀ stays; u₁, u₂, u₃ move. Their names have no room here. None enters a restricted triangle."
    return "u₀, which stays, is left out; uⱼ leaves opposite the j-th vertex. None enters a restricted triangle."


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
        size = min(0.95 * disc_pt, 1.6 * disc_pt / text_size_em(text)[0])
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
