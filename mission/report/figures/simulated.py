"""Figures 8 to 10 as the paper has them: the closed loop of Eq. 5 and 12, without sensors and without an autopilot."""

from matplotlib.artist import Artist
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from mission.plan import FlightPlan
from mission.plan.carried import is_carried
from mission.report.figures.canvas import drawing
from mission.report.figures.chart import chart_of
from mission.report.figures.histories import AXIS_NAMES, MOST_DRAWN, grid_of, name_quantity
from mission.report.figures.paths import FLOWN_PT, draw_arrows, draw_ends, draw_planned, draw_region_names, end_handles
from mission.report.palette import FLOWN, PLANNED
from mission.simulate import Simulation

_TIME = "time on the trajectory, s"
_TRANSIENT = 12.0
"""Time constants that the loop takes to settle, and some more."""


def true_states(plan: FlightPlan, simulation: Simulation) -> Figure:
    """Figure 8: position and velocity of the steering law and of the vehicle; below, how the error decays."""
    step, shown_s = _step(simulation), _shown_s(simulation)
    early = simulation.t_s <= shown_s
    rows = (
        ("position, m", simulation.position_m, simulation.asked_position_m),
        ("velocity, m/s", simulation.velocity_m_s, simulation.asked_velocity_m_s),
    )
    early_step = max(1, int(early.sum()) // MOST_DRAWN)
    with drawing():
        note = f"Below: the error over the first {shown_s:.3g} s, tau being {simulation.time_constant_s:g} s."
        title = "Steering law and true states"
        figure, grid = grid_of(plan, title, 3, _legend(plan), note=note, time=_TIME, own_times=True)
        for column in range(2):
            for row, (name, true, asked) in enumerate(rows):
                axes = grid[row][column]
                axes.plot(simulation.t_s[::step], true[::step, column], color=FLOWN, lw=2.4, gid="true")
                axes.plot(simulation.t_s[::step], asked[::step, column], color=PLANNED, lw=1.0, gid="asked")
                name_quantity(axes, AXIS_NAMES[column], name)
            axes = grid[2][column]
            error = simulation.error_m[early, column]
            axes.plot(simulation.t_s[early][::early_step], error[::early_step], color=FLOWN, lw=2.0, gid="error")
            name_quantity(axes, AXIS_NAMES[column], "error, m")
    return figure


def true_control(plan: FlightPlan, simulation: Simulation) -> Figure:
    """Figure 9: both control signals, over the flight, and over the time in which the error decays."""
    shown_s, control = _shown_s(simulation), simulation.control_m_s2
    early = simulation.t_s <= shown_s
    with drawing():
        note = f"Below: the first {shown_s:.3g} s, in which the error at the start decays."
        legend: list[Artist] = [
            Line2D([], [], color=FLOWN, lw=2.0, label="control, u = -K e + v'"),
            Line2D([], [], color=PLANNED, lw=1.0, label="v', what the steering law asks for"),
        ]
        figure, grid = grid_of(plan, "Control signals", 2, legend, note=note, time=_TIME, own_times=True)
        for column in range(2):
            for row, step, end in ((0, _step(simulation), len(early)), (1, 1, int(early.sum()))):
                axes, t_s = grid[row][column], simulation.t_s[:end:step]
                axes.plot(t_s, control[:end:step, column], color=FLOWN, lw=2.0, gid="control")
                asked = simulation.asked_acceleration_m_s2[:end:step, column]
                axes.plot(t_s, asked, color=PLANNED, lw=1.0, gid="asked")
                name_quantity(axes, AXIS_NAMES[column], f"u{'₁₂'[column]}, m/s²")
    return figure


def true_path(plan: FlightPlan, simulation: Simulation) -> Figure:
    """Figure 10: the true trajectory over the planned path, on the partition."""
    chart = chart_of(plan)
    step = _step(simulation)
    true, planned = simulation.position_m[::step], simulation.asked_position_m[::step]
    with drawing():
        note = "White in the true trajectory: the planned path."
        figure, axes = chart.figure("Planned path and true trajectory", legend=_legend(plan) + end_handles(), note=note)
        chart.draw_domain(axes)
        axes.plot(*true.T, color=FLOWN, lw=FLOWN_PT, zorder=3, gid="true")
        draw_planned(axes, planned, true, chart.em_m)
        draw_arrows(axes, true, chart.em_m, FLOWN)
        draw_ends(axes, true)
        draw_region_names(axes, chart, [planned, true])
    return figure


def _legend(plan: FlightPlan) -> list[Artist]:
    return [
        Line2D([], [], color=FLOWN, lw=2.4, label="true state"),
        Line2D([], [], color=PLANNED, lw=1.0, label="steering law" if is_carried(plan) else "steering law, smoothed"),
    ]


def _step(simulation: Simulation) -> int:
    return max(1, len(simulation.t_s) // MOST_DRAWN)


def _shown_s(simulation: Simulation) -> float:
    return min(_TRANSIENT * simulation.time_constant_s, float(simulation.t_s[-1]))
