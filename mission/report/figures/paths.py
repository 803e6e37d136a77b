"""Figures 5, 7 and 10: the planned path, the smoothed path with its tube, and the flown path, on the partition."""

import math
from collections.abc import Sequence
from itertools import pairwise

import numpy as np
import shapely
from matplotlib import colormaps
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection, PolyCollection
from matplotlib.colors import LinearSegmentedColormap
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch, PathPatch
from numpy.typing import NDArray
from shapely.geometry.base import BaseGeometry

from mission.geometry.arrays import FloatArray
from mission.plan import FlightPlan
from mission.report.figures.canvas import LEAST_PT, POINTS_PER_INCH, drawing, text_size_em
from mission.report.figures.chart import Chart, chart_of, draw_names, name_sizes, outline_of
from mission.report.figures.fitting import place_names
from mission.report.palette import BLACK, FLOWN, LOOP, PLANNED, QUIET, SMOOTHED, TUBE, VERMILLION, WHITE
from mission.report.reading import Record
from mission.report.tracking import Tracking, tracking_of
from mission.spec.model import FIELD
from mission.steering.certificate import Certificate

GeometryArray = NDArray[np.object_]
SAMPLES = 2000
PIECE = 40
NAME_SIZES_PT = (13.0, 11.5, 10.0, 8.5)
NUMBER_SIZES_PT = (8.5, LEAST_PT)
ARROW_EVERY_PT, ARROWS_APART_PT = 95.0, 60.0
SAME_WAY = 0.7  # cosine of the angle between two
FLOWN_PACE_PT = 25.0  # more than the noise of reported positions, also on the page of a small domain
MOST_NUMBERED = 60
TUBE_ALPHA = 0.6
FINE_PT = 1.0
SAME_PLACE_M = 1e-3
MOST_STRETCHES = 400
COLOUR_BAR_PT = 64.0
FLOWN_PT = 3.2
ERROR_COLOURS = LinearSegmentedColormap.from_list("error", colormaps["plasma"](np.linspace(0.08, 0.85, 64)))
"""Ever lighter, so that all eyes and a grey print tell them apart, and none too light for paper."""


def planned_path(plan: FlightPlan) -> Figure:
    """Figure 5: the steering path through the triangles of the run; the loop of a recurrent run in its own colour."""
    chart = chart_of(plan)
    times = _times(plan.path.duration_s, plan.path.knots_s)
    position = plan.path.position(times)
    loops = plan.run.recurrent
    with drawing():
        legend: list[Artist] = [Line2D([], [], color=PLANNED, lw=1.3, label="planned path")]
        if loops:
            legend.append(Line2D([], [], color=LOOP, lw=5.0, label="loop, repeated"))
        states = plan.run.states
        note = f"Run of {len(states)} states: " + _shortened([f"T{i}" for i in states])
        figure, axes = chart.figure("Planned path, before smoothing", legend=legend + end_handles(), note=note)
        chart.draw_domain(axes)
        begins_s, ends_s = plan.path.lap_s or (math.inf, math.inf)
        loop = position[(times >= begins_s) & (times <= ends_s)]
        if len(loop):
            axes.plot(*loop.T, color=LOOP, lw=5.0, zorder=2.8, gid="loop")
        axes.plot(*position.T, color=PLANNED, lw=1.3, zorder=3, gid="planned")
        draw_arrows(axes, position, chart.em_m, PLANNED)
        draw_ends(axes, position)
        draw_region_names(axes, chart, [position], numbers=sorted(set(states)))
    return figure


def smoothed_path(plan: FlightPlan) -> Figure:
    """Figure 7: the smoothed path and the tube around it for which the certificate holds, where that is flown."""
    chart = chart_of(plan)
    position = plan.curve.position(_times(plan.curve.duration_s))
    by_field = plan.spec.flight.guidance == FIELD
    half_m = 0.0 if by_field else plan.certificate.tube_m
    tube = tube_pieces(position, half_m) if half_m > 0.0 else np.empty(0, dtype=np.object_)
    beside_m = float(np.hypot(*(position[0] - plan.start_m)))
    moved = beside_m > SAME_PLACE_M
    with drawing():
        legend: list[Artist] = [Line2D([], [], color=SMOOTHED, lw=1.8, label="smoothed path")]
        if len(tube):
            label = f"tracking tube, ±{half_m:.3g} m"
            legend.append(Patch(facecolor=(TUBE, TUBE_ALPHA), edgecolor=SMOOTHED, lw=0.5, label=label))
        notes = [_BY_FIELD if by_field else _proof(plan.certificate, with_clearances=bool(chart.margins))]
        if moved:
            notes.append(f"The smoothed path begins {beside_m:.2g} m beside the start that is given.")
        figure, axes = chart.figure(
            "Smoothed path and its tube" if len(tube) else "Smoothed path, without a tube",
            legend=legend + end_handles() + [_given_start()] * moved,
            note=" ".join(notes),
        )
        chart.draw_domain(axes)
        if len(tube):
            patch = PathPatch(outline_of(shapely.union_all(tube)), facecolor=(TUBE, TUBE_ALPHA), edgecolor=SMOOTHED)
            patch.set(linewidth=0.5, zorder=2.5, gid="tube")
            axes.add_patch(patch)
        axes.plot(*position.T, color=SMOOTHED, lw=1.8, zorder=3, gid="smoothed")
        draw_arrows(axes, position, chart.em_m, SMOOTHED)
        draw_ends(axes, position)
        marked = [position]
        if moved:
            given = _given_start()
            given.set(xdata=[plan.start_m[0]], ydata=[plan.start_m[1]], zorder=6.1, gid="given start")
            axes.add_line(given)
            marked.append(np.stack((np.array(plan.start_m), position[0])))
        draw_region_names(axes, chart, marked, tube=list(tube))
    return figure


_BY_FIELD = "This path is not flown: the flight is led by the field, of which no tube is proved."
NO_TUBE = "There is no tube: the mission counts on no disturbance."
"""Of a proof that is one of the path alone."""


def _given_start() -> Line2D:
    return Line2D([], [], marker="x", ms=8, mew=2.0, ls="", color=VERMILLION, label="start as given")


def flown_path(plan: FlightPlan, record: Record) -> Figure:
    """Figure 10: where the vehicle said that it was, coloured by its error, over the planned path."""
    chart = chart_of(plan)
    planned = plan.curve.position(_times(plan.curve.duration_s))
    later = [each.plan.curve.position(_times(each.plan.curve.duration_s)) for each in record.later]
    flown = record.track.position_m[:, :2]
    flown = flown[np.isfinite(flown).all(axis=1)]
    tracking = tracking_of(record)
    coloured = plan.spec.flight.guidance != FIELD and len(tracking.t_s) > 1
    with drawing():
        legend: list[Artist] = [
            Line2D([], [], color=ERROR_COLOURS(0.3) if coloured else FLOWN, lw=FLOWN_PT, label="flown, as reported"),
            Line2D([], [], color=PLANNED, lw=1.0, label="planned"),
            *([Line2D([], [], color=PLANNED, lw=1.0, ls="--", label="planned in flight")] if later else []),
        ]
        figure, axes = chart.figure(
            "Flown and planned path",
            legend=legend + end_handles(),
            note=_ERROR_NOTE * coloured + "White in it: the planned path.",
            beside_pt=COLOUR_BAR_PT if coloured else 0.0,
        )
        chart.draw_domain(axes)
        axes.plot(*flown.T, color=FLOWN, lw=FLOWN_PT, zorder=3, gid="flown")
        if coloured:
            _draw_error(figure, axes, tracking, plan.certificate.tube_m)
        for number, line in enumerate((planned, *later), 1):
            style, gid = ("-", "planned") if number == 1 else ("--", f"planned {number}")
            draw_planned(axes, line, flown, chart.em_m, style=style, gid=gid)
        if len(flown):
            draw_arrows(axes, flown, chart.em_m, BLACK, FLOWN_PACE_PT)
            draw_ends(axes, flown)
        draw_region_names(axes, chart, [planned, *later, *([flown] if len(flown) else [])])
    return figure


_ERROR_NOTE = "Colour of the flown path: the largest horizontal distance from the setpoint in each stretch of it. "


def _draw_error(figure: Figure, axes: Axes, tracking: Tracking, tube_m: float) -> None:
    """Colour the flown path by its error, and say at the right what the colours are."""
    ends = np.unique(np.linspace(0, len(tracking.t_s) - 1, MOST_STRETCHES + 1).astype(int))
    stretches = [slice(first, last + 1) for first, last in pairwise(ends.tolist())]
    lines = LineCollection(
        [tracking.position_m[each] for each in stretches],
        array=[float(tracking.distance_m[each].max()) for each in stretches],
        cmap=ERROR_COLOURS,
        linewidths=FLOWN_PT,
        capstyle="butt",
        zorder=3.1,
        gid="error",
    )
    lines.set_clim(0.0, max(float(tracking.distance_m.max()), SAME_PLACE_M))
    axes.add_collection(lines)
    west, south, width, height = axes.get_position().bounds
    pt = 1.0 / (figure.get_figwidth() * POINTS_PER_INCH)
    scale = figure.add_axes((west + width + 14 * pt, south + 0.2 * height, 10 * pt, 0.6 * height))
    tube = f"; the tube is ±{tube_m:.3g} m on each axis" if tube_m > 0.0 else ""
    figure.colorbar(lines, cax=scale, label=f"error, m{tube}")


def _proof(certificate: Certificate, *, with_clearances: bool) -> str:
    about = "every path in the tube" if certificate.tube_m > 0.0 else "the path itself"
    proved = f"proved for {about}" if certificate.holds else f"NOT proved for {about}"
    clearance = certificate.clearance_m
    beyond = " and their clearances" * with_clearances
    kept = "" if clearance is None else f"; the path keeps at least {clearance:.3g} m from restricted regions{beyond}"
    waves = f"Frequencies of the Fourier series: {certificate.frequencies}; " if certificate.frequencies else ""
    told = f"{waves}{proved}{kept}."
    return told[0].upper() + told[1:] + (f" {NO_TUBE}" if certificate.tube_m == 0.0 else "")


def tube_pieces(position_m: FloatArray, half_m: float) -> GeometryArray:
    """All points within ``half_m`` of a polyline on each axis, as one convex piece for each of its segments.

    The tube's section is a square; between two samples it sweeps the convex hull of its two places.
    """
    boxes = position_m[:, None] + half_m * np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]])
    pieces: GeometryArray = shapely.convex_hull(shapely.multipoints(np.concatenate((boxes[:-1], boxes[1:]), axis=1)))
    return pieces


def _times(duration_s: float, knots_s: FloatArray | Sequence[float] = ()) -> FloatArray:
    return np.union1d(np.linspace(0.0, duration_s, SAMPLES), np.asarray(knots_s, dtype=np.float64))


def _shortened(words: list[str], most: int = 22) -> str:
    if len(words) <= most:
        return " ".join(words)
    return " ".join(words[: most - 8]) + " … " + " ".join(words[-7:])


def draw_region_names(
    axes: Axes,
    chart: Chart,
    lines: list[FloatArray],
    *,
    tube: Sequence[BaseGeometry] = (),
    numbers: Sequence[int] = (),
) -> None:
    """Name the regions, then number some triangles, where that hides no line; numbers without room are left out."""
    ways = [*tube]
    for line in lines:
        # In short pieces: a name is then compared only with those nearby.
        pieces = [line[k : k + PIECE + 1] for k in range(0, len(line) - 1, PIECE)]
        ways += [shapely.LineString(piece).simplify(0.3 * chart.em_m).buffer(3 * chart.em_m) for piece in pieces]
        ways += [shapely.Point(end).buffer(8 * chart.em_m) for end in line[[0, -1]]]
    placed = place_names(
        name_sizes(chart.shapes, chart.titles),
        em_m=chart.em_m,
        sizes_pt=NAME_SIZES_PT,
        obstacles=ways,
        frame=chart.frame,
    )
    draw_names(axes, placed)
    if not 0 < len(numbers) <= MOST_NUMBERED:
        return
    taken = [*ways, *(name.box(chart.em_m) for name in placed)]
    triangles = shapely.polygons(chart.partition.corners_m[list(numbers)])
    texts = [f"T{i}" for i in numbers]
    small = place_names(
        [(text, shape, text_size_em(text)) for text, shape in zip(texts, triangles, strict=True)],
        em_m=chart.em_m,
        sizes_pt=NUMBER_SIZES_PT,
        obstacles=taken,
        frame=None,
    )
    draw_names(axes, small, colour=QUIET, bold=False, gid="number")


def draw_planned(
    axes: Axes, line: FloatArray, flown: FloatArray, em_m: float, *, style: str = "-", gid: str = "planned"
) -> None:
    """A thin planned line under a strong flown one, white where that covers it."""
    axes.plot(*line.T, color=PLANNED, lw=1.0, ls=style, zorder=2.9, gid=gid)
    if len(flown) > 1:
        over = shapely.LineString(flown)
        shapely.prepare(over)
        covered = shapely.dwithin(over, shapely.points(line), 0.5 * FLOWN_PT * em_m)
        axes.plot(*np.where(covered[:, None], line, np.nan).T, color=WHITE, lw=0.6, ls=style, zorder=3.2)


def draw_ends(axes: Axes, position: FloatArray) -> None:
    """Mark where a line begins and ends."""
    (x0, y0), (x1, y1) = position[0].tolist(), position[-1].tolist()
    axes.plot(x1, y1, marker="s", ms=11, mfc=BLACK, mec=WHITE, mew=1.2, ls="", color=BLACK, zorder=6, gid="end")
    axes.plot(x0, y0, marker="o", ms=7, mfc=WHITE, mec=BLACK, mew=1.6, ls="", color=BLACK, zorder=6, gid="start")


def end_handles() -> list[Artist]:
    """Their entries in a legend."""
    return [
        Line2D([], [], marker="o", ms=7, mfc=WHITE, mec=BLACK, mew=1.6, ls="", label="start"),
        Line2D([], [], marker="s", ms=7, mfc=BLACK, mec=BLACK, ls="", label="end"),
    ]


def draw_arrows(axes: Axes, position: FloatArray, em_m: float, colour: str, pace_pt: float = FINE_PT) -> None:
    """Small arrowheads along a line, evenly spaced on the page; none on one that shows the same way there.

    Args:
        axes: Where.
        position: The line, shape (N, 2).
        em_m: Metres for one point on the page.
        colour: Of the heads.
        pace_pt: The way is measured in steps of this length, points: noise within one is no way.
    """
    way = shapely.LineString(_paced(position, pace_pt * em_m))
    count = int(way.length / (ARROW_EVERY_PT * em_m))
    heads: list[FloatArray] = []
    shown: list[tuple[FloatArray, FloatArray]] = []
    for at in (np.arange(count) + 0.5) * way.length / max(count, 1):
        reach = np.array([at - FINE_PT * em_m, at, at + FINE_PT * em_m])
        back, middle, front = shapely.get_coordinates(shapely.line_interpolate_point(way, reach))
        length = float(np.hypot(*(front - back)))
        if length < FINE_PT * em_m:  # it turns on the spot here
            continue
        ahead = (front - back) / length * em_m
        crowded = any(
            np.hypot(*(middle - other)) < ARROWS_APART_PT * em_m and ahead @ way_there > SAME_WAY * em_m**2
            for other, way_there in shown
        )
        if crowded:
            continue
        shown.append((middle, ahead))
        tip = position[int(np.argmin(np.hypot(*(position - middle).T)))] if pace_pt > FINE_PT else middle
        aside = np.array([-ahead[1], ahead[0]])
        heads.append(np.array([tip + 6 * ahead, tip - 4 * ahead + 4.2 * aside, tip - 4 * ahead - 4.2 * aside]))
    axes.add_collection(
        PolyCollection(heads, facecolors=colour, edgecolors=WHITE, linewidths=0.6, zorder=3.6, gid="arrows")
    )


def _paced(position: FloatArray, pace_m: float) -> FloatArray:
    """Points of a line that are at least so far apart, and its ends; at least two."""
    kept = [position[0]]
    for point in position[1:]:
        if math.hypot(*(point - kept[-1])) >= pace_m:
            kept.append(point)
    return np.array([*kept, position[-1]])
