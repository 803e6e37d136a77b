"""Lanes, what a flight covered of its regions, what it left out, and where images were taken."""

from typing import TYPE_CHECKING

import numpy as np
import shapely
from matplotlib.collections import LineCollection
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch, PathPatch

from mission.monitor.coverage import Covered
from mission.plan import FlightPlan
from mission.report.coverage import covered_again
from mission.report.figures.canvas import drawing
from mission.report.figures.chart import chart_of, outline_of
from mission.report.figures.paths import draw_region_names
from mission.report.palette import BLACK, FLOWN, LOOP, PLANNED
from mission.report.reading import Record

if TYPE_CHECKING:
    from matplotlib.artist import Artist


def coverage(plan: FlightPlan, record: Record | None) -> Figure:
    """The lanes of a plan; of its flight, what it left out of each region, and its images."""
    chart = chart_of(plan)
    plans = [plan, *(each.plan for each in record.later)] if record else [plan]
    lanes = np.concatenate([visit.lanes_m for each in plans for visit in each.covers])
    flown = () if record is None else covered_again(plan, record)
    images = np.array([each.position_m[:2] for each in record.pictures if each.position_m] if record else [])
    missed = shapely.MultiPolygon([part for part in _parts(flown) if part.area > 0.0])
    legend: list[Artist] = [Line2D([], [], color=PLANNED, lw=1.2, label="lanes")]
    if record is not None:
        legend.append(Line2D([], [], color=FLOWN, lw=0.9, label="flown, as reported"))
    if flown:
        legend.append(Patch(facecolor=LOOP, label="not covered"))
    if len(images):
        legend.append(Line2D([], [], color=BLACK, lw=0, marker=".", ms=4, label="images"))
    with drawing():
        note = "; ".join(
            f"{visit.region} to {visit.share:.1%}" + (f" in lap {visit.lap}" if visit.lap else "") for visit in flown
        )
        figure, axes = chart.figure("Coverage", legend=legend, note=f"Covered: {note}." if note else "")
        chart.draw_domain(axes, mesh=False)
        if not missed.is_empty:
            patch = PathPatch(outline_of(missed), facecolor=LOOP, linewidth=0, zorder=2.0, gid="left out")
            axes.add_patch(patch)
        axes.add_collection(LineCollection(list(lanes), colors=PLANNED, linewidths=1.2, zorder=3, gid="lanes"))
        if record is not None:
            track = record.track.position_m[:, :2]
            track = track[np.isfinite(track).all(axis=1)]
            axes.plot(*track.T, color=FLOWN, lw=0.9, zorder=2.8, gid="flown")
        if len(images):
            axes.plot(*images.T, color=BLACK, lw=0, marker=".", ms=3, zorder=3.5, gid="images")
        draw_region_names(axes, chart, list(lanes))
    return figure


def _parts(flown: tuple[Covered, ...]) -> list[shapely.Polygon]:
    """The polygons of what was left out."""
    left_out = shapely.union_all([visit.left_out for visit in flown])
    return [part for part in shapely.get_parts(left_out) if isinstance(part, shapely.Polygon)]
