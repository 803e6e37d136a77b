"""Figures 6, 8 and 9: planned and smoothed path, tracked states and control signals, over time."""

from collections.abc import Sequence

import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch
from matplotlib.ticker import MaxNLocator

from mission.geometry.arrays import FloatArray
from mission.monitor.attitude import horizontal_acceleration, tilt
from mission.plan import FlightPlan
from mission.report.figures.canvas import (
    NOTE_LINE_PT,
    NOTE_PT,
    SIDE_PT,
    about,
    drawing,
    head_pt,
    in_width,
    new_figure,
    titled,
)
from mission.report.figures.filtering import Filtered, filtered, time_constant
from mission.report.figures.paths import NO_TUBE
from mission.report.palette import BLACK, FLOWN, MESH, PLANNED, QUIET, SMOOTHED, VERMILLION
from mission.report.reading import Record
from mission.report.tracking import Tracking, led_by_field, tracking_of
from mission.spec.model import FIELD

WIDTH_PT, ROW_PT = 700.0, 135.0
SAMPLES = 2000
MOST_DRAWN = 4000
AXIS_NAMES = ("east", "north")
BAND_ALPHA = 0.28


def time_histories(plan: FlightPlan) -> Figure:
    """Figure 6: position and velocity of the planned and of the smoothed path, over the time of the curve."""
    curve = plan.trajectory.curve
    s = np.linspace(0.0, curve.duration_s, SAMPLES)
    # What is planned is passed in its own time where it is no path of fields; it is drawn over that of the curve.
    faster = plan.path.duration_s / curve.duration_s
    planned = (plan.path.position(s * faster), plan.path.velocity(s * faster) * faster)
    smoothed = (curve.position(s), curve.derivative(s, 1))
    with drawing():
        legend: list[Artist] = [
            Line2D([], [], color=SMOOTHED, lw=2.4, label="smoothed"),
            Line2D([], [], color=PLANNED, lw=1.0, label="planned"),
        ]
        note = "Time of the curve, before the time law that keeps the vehicle's limits."
        figure, grid = grid_of(
            plan, "Planned and smoothed path over time", 2, legend, note=note, time="time of the curve, s"
        )
        for column in range(2):
            for row, name in enumerate(("position, m", "velocity, m/s")):
                axes = grid[row][column]
                axes.plot(s, smoothed[row][:, column], color=SMOOTHED, lw=2.4, gid="smoothed")
                axes.plot(s, planned[row][:, column], color=PLANNED, lw=1.0, gid="planned")
                name_quantity(axes, AXIS_NAMES[column], name)
    return figure


def tracked_states(plan: FlightPlan, record: Record) -> Figure:
    """Figure 8: position and velocity asked for and reported, and the difference of the positions against the tube.

    A flight that is led by the field is asked for a velocity alone, and no tube is about it.
    """
    by_field = plan.spec.flight.guidance == FIELD
    tracking = _tracking(plan, record)
    t_s, constant_s = _since(tracking), time_constant(tracking.t_s)
    half_m = plan.certificate.tube_m
    with drawing():
        legend = [*_reported("reported", constant_s), Line2D([], [], color=PLANNED, lw=1.0, label="setpoint")]
        if not by_field:
            legend.append(Line2D([], [], color=VERMILLION, lw=1.6, label="error"))
        if not by_field and half_m > 0.0:
            tube = f"tube of the certificate, ±{half_m:.3g} m"
            legend.append(Line2D([], [], color=QUIET, lw=1.2, ls="--", label=tube))
        notes = [_BY_FIELD] if by_field else [NO_TUBE] if half_m == 0.0 else []
        title, note = "Flown states" if by_field else "Tracked states", " ".join([*notes, _filter(constant_s)])
        figure, grid = grid_of(plan, title, 2 if by_field else 3, legend, note=note, time=_time(plan))
        for column in range(2):
            axes = grid[0][column]
            axes.plot(t_s, tracking.position_m[:, column], color=FLOWN, lw=2.4, gid="flown")
            axes.plot(t_s, tracking.asked_position_m[:, column], color=PLANNED, lw=0.8, gid="asked")
            name_quantity(axes, AXIS_NAMES[column], "position, m")
            axes = grid[1][column]
            _draw_noisy(axes, filtered(t_s, tracking.velocity_m_s[:, column], constant_s), FLOWN, "flown")
            axes.plot(t_s, tracking.asked_velocity_m_s[:, column], color=PLANNED, lw=0.8, gid="asked")
            name_quantity(axes, AXIS_NAMES[column], "velocity, m/s")
            if by_field:
                continue
            axes = grid[2][column]
            _draw_noisy(axes, filtered(t_s, tracking.error_m[:, column], constant_s), VERMILLION, "error")
            for bound in (-half_m, half_m) if half_m > 0.0 else ():
                axes.axhline(bound, color=QUIET, lw=1.2, ls="--", gid="tube")
            name_quantity(axes, AXIS_NAMES[column], "error, m")
    return figure


def control_signals(plan: FlightPlan, record: Record) -> Figure:
    """Figure 9: acceleration asked for and the one that the reported attitude gives; the tilt against its limit."""
    tracking = _tracking(plan, record)
    t_s, constant_s = _since(tracking), time_constant(tracking.t_s)
    flown = horizontal_acceleration(tracking.attitude_rad)
    limit_deg = float(np.rad2deg(plan.spec.limits.tilt_rad))
    with drawing():
        legend = _reported("from the reported attitude", constant_s)
        if plan.spec.flight.guidance != FIELD:
            legend.append(Line2D([], [], color=PLANNED, lw=1.0, label="setpoint"))
        legend.append(Line2D([], [], color=QUIET, lw=1.2, ls="--", label=f"limit of the tilt, {limit_deg:.3g}°"))
        note = f"In hover, an attitude tilted by α accelerates by g tan α. {_filter(constant_s)}"
        time = _time(plan)
        figure, grid = grid_of(plan, "Control signals", 2, legend, note=note, time=time, wide_last=True, own_times=True)
        for column in range(2):
            axes = grid[0][column]
            _draw_noisy(axes, filtered(t_s, flown[:, column], constant_s), FLOWN, "flown")
            axes.plot(t_s, tracking.asked_acceleration_m_s2[:, column], color=PLANNED, lw=0.8, gid="asked")
            name_quantity(axes, AXIS_NAMES[column], "acceleration, m/s²")
        axes = grid[1][0]
        _draw_noisy(axes, filtered(t_s, np.rad2deg(tilt(tracking.attitude_rad)), constant_s), FLOWN, "tilt")
        axes.axhline(limit_deg, color=QUIET, lw=1.2, ls="--", gid="limit")
        name_quantity(axes, "", "tilt, °")
        axes.set_ylim(bottom=0.0)
    return figure


def _reported(name: str, constant_s: float) -> list[Artist]:
    """The entries of a legend for a line and its band."""
    return [
        Line2D([], [], color=FLOWN, lw=2.0, label=f"{name}, low-pass τ = {constant_s:g} s"),
        Patch(facecolor=(FLOWN, BAND_ALPHA), label="least to greatest"),
    ]


def _filter(constant_s: float) -> str:
    low_pass = f"a first-order low-pass of {constant_s:g} s, run forward and back"
    return f"Lines on bands: {low_pass}; bands: least to greatest value within {0.5 * constant_s:g} s."


def _draw_noisy(axes: Axes, seen: Filtered, colour: str, gid: str) -> None:
    axes.fill_between(seen.t_s, seen.low, seen.high, color=colour, alpha=BAND_ALPHA, lw=0, gid=f"{gid} band")
    axes.plot(seen.t_s, seen.line, color=colour, lw=2.0, gid=gid)


_BY_FIELD = "Led by the field: at each moment a velocity is asked for, and no position."


def _tracking(plan: FlightPlan, record: Record) -> Tracking:
    return led_by_field(record) if plan.spec.flight.guidance == FIELD else tracking_of(record)


def _since(tracking: Tracking) -> FloatArray:
    return tracking.t_s - tracking.t_s[0] if len(tracking.t_s) else tracking.t_s


def _time(plan: FlightPlan) -> str:
    return (
        "time since the flight began, s" if plan.spec.flight.guidance == FIELD else "time since the trajectory began, s"
    )


def grid_of(
    plan: FlightPlan,
    title: str,
    rows: int,
    legend: Sequence[Artist],
    *,
    note: str,
    time: str,
    wide_last: bool = False,
    own_times: bool = False,
) -> tuple[Figure, list[list[Axes]]]:
    """Rows of two plots, the last row one wide plot if asked for; time is named at the bottom.

    They have a common time, numbered at the bottom, or their own.
    """
    about_it = about(plan, WIDTH_PT)
    note = in_width(note, (WIDTH_PT - 2 * SIDE_PT) / NOTE_PT)
    head = head_pt(about_it)
    top, bottom, left, right, between, above = (
        head + 38.0,
        60.0 + NOTE_LINE_PT * note.count("\n") if note else 46.0,
        58.0,
        16.0,
        56.0,
        44.0 if own_times else 30.0,
    )
    height = top + rows * ROW_PT + (rows - 1) * above + bottom
    figure = new_figure(WIDTH_PT, height)
    titled(figure, title, note, about_it)
    figure.legend(
        handles=list(legend),
        loc="upper left",
        bbox_to_anchor=(SIDE_PT / WIDTH_PT, 1 - (head + 2) / height),
        ncols=len(legend),
        borderpad=0,
        borderaxespad=0,
        handletextpad=0.5,
        columnspacing=1.4,
    )
    half = 0.5 * (WIDTH_PT - left - right - between)
    grid: list[list[Axes]] = []
    for row in range(rows):
        y = height - top - (row + 1) * ROW_PT - row * above
        last = row == rows - 1
        whole = wide_last and last
        boxes = [(left, 2 * half + between)] if whole else [(left, half), (left + half + between, half)]
        grid.append([])
        for x, width in boxes:
            axes = figure.add_axes((x / WIDTH_PT, y / height, width / WIDTH_PT, ROW_PT / height))
            axes.grid(color=MESH, lw=0.4)
            axes.set_axisbelow(True)
            axes.margins(x=0.01)
            axes.xaxis.set_major_locator(MaxNLocator(6 if not whole else 12))
            axes.yaxis.set_major_locator(MaxNLocator(5))
            axes.tick_params(labelbottom=last or own_times)
            if last:
                axes.set_xlabel(time)
            grid[-1].append(axes)
    return figure, grid


def name_quantity(axes: Axes, direction: str, quantity: str) -> None:
    """Say over the plot what it shows, where it takes no room from it."""
    axes.text(
        0.0,
        1.03,
        f"{direction} {quantity}".strip(),
        transform=axes.transAxes,
        fontsize=10.5,
        color=BLACK,
        gid="quantity",
    )
