"""A mission in which something moves, at several moments: where triangles and regions are, and what is flown."""

import math
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
import shapely
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from mission.geometry.arrays import FloatArray
from mission.geometry.moving import MovingPartition
from mission.plan import FlightPlan
from mission.report.figures.canvas import SIDE_PT, about, drawing, head_pt, new_figure, titled
from mission.report.figures.chart import LEGEND_ROW_PT, WIDTH_PT, Chart, chart_of, draw_names, name_sizes
from mission.report.figures.fitting import place_names
from mission.report.moving import begun
from mission.report.palette import BLACK, FLOWN, QUIET, SMOOTHED, WHITE
from mission.report.reading import Record
from mission.simulate import Simulation

if TYPE_CHECKING:
    from matplotlib.artist import Artist

_SHARES = ((0.0, "begin"), (1.0 / 3.0, "1/3"), (2.0 / 3.0, "2/3"), (1.0, "end"))
_APART = 0.02
"""Of the whole time: moments that are nearer to each other are one."""
_SAMPLES = 1200
_TITLE_PT, _ABOVE_PT, _BETWEEN_PT, _BOTTOM_PT = 10.0, 22.0, 14.0, 30.0
_TICKS_PT, _NAMES_PT = 9.0, (10.0, 9.0, 8.0)
_CLEAR_PT = 6.0
_TALL, _MOST_COLUMNS = 1.2, 3


class _Way(NamedTuple):
    """A line on the maps, and when it is where: times (N,), points (N, 2)."""

    times_s: FloatArray
    points_m: FloatArray
    colour: str
    label: str


def planned_moments(plan: FlightPlan) -> Figure:
    """The smoothed path: what of it is flown by each moment, and what is to come."""
    trajectory = plan.trajectory
    end_s = trajectory.duration_s if math.isfinite(trajectory.duration_s) else trajectory.ended_after(0.0).duration_s
    times = np.linspace(0.0, end_s, _SAMPLES)
    return _moments(plan, "The flight at several moments", _Way(times, trajectory.position(times), SMOOTHED, "path"))


def flown_moments(plan: FlightPlan, record: Record) -> Figure:
    """What was reported of the flight by each moment, on the clock of its trajectory."""
    track, begun_s = record.track, begun(record)
    known = np.isfinite(track.position_m[:, :2]).all(axis=1) & np.isfinite(track.t_s)
    known &= track.t_s >= begun_s
    way = _Way(track.t_s[known] - begun_s, track.position_m[known, :2], FLOWN, "flown, as reported")
    return _moments(plan, "What was flown, at several moments", way)


def true_moments(plan: FlightPlan, simulation: Simulation) -> Figure:
    """The true trajectory of a simulated flight by each moment."""
    step = max(1, len(simulation.t_s) // _SAMPLES)
    way = _Way(simulation.t_s[::step], simulation.position_m[::step], FLOWN, "true trajectory")
    return _moments(plan, "The simulated flight at several moments", way)


def _moments(plan: FlightPlan, title: str, way: _Way) -> Figure:
    ends_s = {"the flight": (0.0, float(way.times_s[-1]) if len(way.times_s) else 0.0)}
    moments = _times({**ends_s, **({} if plan.moving is None else {"the motion": _span_s(plan.moving)})})
    first = chart_of(plan, 0.0)
    west, south, east, north = first.bounds_m.tolist()
    aspect = (north - south) / (east - west)
    columns = min(_MOST_COLUMNS if aspect > _TALL else 2, len(moments))
    rows = -(-len(moments) // columns)
    width = (WIDTH_PT - 2 * SIDE_PT - (columns - 1) * _BETWEEN_PT) / columns
    pad_m = 0.02 * (east - west)
    em_m = (east - west + 2 * pad_m) / width
    panel = (north - south + 2 * pad_m) / em_m
    legend: list[Artist] = [
        Line2D([], [], color=way.colour, lw=2.4, label=f"{way.label}, so far"),
        Line2D([], [], color=QUIET, lw=0.9, label="still to come"),
        Line2D([], [], marker="o", ms=7, mfc=BLACK, mec=WHITE, ls="", label="vehicle"),
    ]
    with drawing():
        about_it = about(plan, WIDTH_PT)
        head = head_pt(about_it) + LEGEND_ROW_PT + 4
        height = head + rows * (panel + _ABOVE_PT) + _BOTTOM_PT
        figure = new_figure(WIDTH_PT, height)
        note = "Seconds on the clock of the trajectory, by which regions move; after their motion they stay."
        titled(figure, title, note, about_it)
        figure.legend(
            handles=[*first.kind_handles(), *legend],
            loc="upper left",
            bbox_to_anchor=(SIDE_PT / WIDTH_PT, 1 - (head - LEGEND_ROW_PT - 2) / height),
            ncols=6,
            borderpad=0,
            borderaxespad=0,
            handlelength=1.6,
            handletextpad=0.4,
            columnspacing=1.0,
        )
        for number, (time_s, words) in enumerate(moments):
            row, column = divmod(number, columns)
            x = SIDE_PT + column * (width + _BETWEEN_PT)
            y = height - head - (row + 1) * (panel + _ABOVE_PT)
            axes = figure.add_axes((x / WIDTH_PT, y / height, width / WIDTH_PT, panel / height))
            axes.set(xlim=(west - pad_m, east + pad_m), ylim=(south - pad_m, north + pad_m), xticks=[], yticks=[])
            axes.set_axis_off()
            axes.set_title(f"{time_s:.1f} s: {words}", fontsize=_TITLE_PT, loc="left", pad=3.0)
            _draw(axes, chart_of(plan, time_s), em_m, way)
    return figure


def _span_s(moving: MovingPartition) -> tuple[float, float]:
    """From when to when anything moves."""
    changes = np.flatnonzero((np.diff(moving.places_m, axis=0) != 0.0).any(axis=(1, 2)))
    return (float(moving.times_s[changes[0]]), float(moving.times_s[changes[-1] + 1])) if len(changes) else (0.0, 0.0)


def _times(spans: dict[str, tuple[float, float]]) -> list[tuple[float, str]]:
    """Moments in order, and what each is of which span; those that are nearly the same are one."""
    last_s = max(end for _, end in spans.values())
    found: list[tuple[float, list[str]]] = []
    named = ((a + share * (b - a), f"{word} of {what}") for what, (a, b) in spans.items() for share, word in _SHARES)
    for time_s, words in sorted(named, key=lambda each: each[0]):
        if found and time_s - found[-1][0] < _APART * last_s:
            found[-1][1].append(words)
        else:
            found.append((time_s, [words]))
    return [(time_s, ", ".join(words)) for time_s, words in found]


def _draw(axes: Axes, chart: Chart, em_m: float, way: _Way) -> None:
    """The map at the time of a chart, and the line up to then and from then on."""
    time_s = chart.time_s or 0.0
    chart.draw_domain(axes)
    done = way.times_s <= time_s
    here = _place_at(time_s, way)
    axes.plot(*np.concatenate((way.points_m[done], here)).T, color=way.colour, lw=2.4, zorder=3, gid="so far")
    axes.plot(*np.concatenate((here, way.points_m[~done])).T, color=QUIET, lw=0.9, zorder=2.9, gid="to come")
    axes.plot(*here.T, marker="o", ms=8, mfc=BLACK, mec=WHITE, mew=1.2, ls="", zorder=6, gid="vehicle")
    placed = place_names(
        name_sizes(chart.shapes, {name: name for name in chart.shapes}),
        em_m=em_m,
        sizes_pt=_NAMES_PT,
        obstacles=[*shapely.buffer(shapely.points(here), _CLEAR_PT * em_m)],
        frame=chart.frame,
    )
    draw_names(axes, placed)


def _place_at(time_s: float, way: _Way) -> FloatArray:
    """Where the line is at a time, shape (1, 2); before it begins and after it ends at its ends; none of no line."""
    if not len(way.times_s):
        return np.empty((0, 2))
    return np.array([[np.interp(time_s, way.times_s, axis) for axis in way.points_m.T]])
