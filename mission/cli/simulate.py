"""``mission simulate``: fly a plan with the paper's vehicle and tracking law, and draw its Figures 8 to 10."""

import io
import math
from argparse import Namespace
from pathlib import Path
from typing import Final

import numpy as np

from mission.cli.drawing import draw
from mission.cli.given import changes_of
from mission.cli.inputs import planned, write_named
from mission.cli.screen import out, print_json, print_warnings
from mission.monitor.monitor import Outcome
from mission.plan import FlightPlan
from mission.plan.carried import is_carried
from mission.printable import printable
from mission.simulate import SETTLED, Simulation, judged, simulate_plan
from mission.spec.model import FIELD

_G: Final = 9.80665
_COLUMNS: Final = "t_s,x_m,y_m,vx_m_s,vy_m_s,rx_m,ry_m,rvx_m_s,rvy_m_s,rax_m_s2,ray_m_s2,ux_m_s2,uy_m_s2"


def run(arguments: Namespace) -> int:
    """Plan, simulate, write what is asked for, and show; 0 where what was flown satisfies the mission."""
    plan = planned(arguments.file, arguments.run, changes_of(arguments))
    simulation = simulate_plan(plan, off_m=arguments.off)
    monitor = judged(plan, simulation)
    outcome = monitor.outcome(stays=not plan.run.recurrent)
    if arguments.csv is not None:
        write_named("--csv", Path(arguments.csv), _table(simulation))
    if not arguments.no_pictures:
        draw(Path(arguments.pictures), arguments.format, plan, simulation)
    exit_code = int(not outcome.achieved)
    if arguments.json:
        print_json({"exit_code": exit_code, **_values(plan, simulation, outcome, monitor.word)})
        return exit_code
    print_warnings(plan.warnings)
    _print(plan, simulation, outcome, monitor.word)
    if arguments.csv is not None:
        _line("Table", printable(arguments.csv))
    if not arguments.no_pictures:
        _line("Pictures", printable(arguments.pictures))
    return exit_code


def _table(simulation: Simulation) -> str:
    """All samples as comma-separated values."""
    rows = np.column_stack(
        (
            simulation.t_s,
            simulation.position_m,
            simulation.velocity_m_s,
            simulation.asked_position_m,
            simulation.asked_velocity_m_s,
            simulation.asked_acceleration_m_s2,
            simulation.control_m_s2,
        )
    )
    text = io.StringIO()
    np.savetxt(text, rows, fmt="%.9g", delimiter=",", header=_COLUMNS, comments="")
    return text.getvalue()


def _values(
    plan: FlightPlan, simulation: Simulation, outcome: Outcome, word: tuple[frozenset[str], ...]
) -> dict[str, object]:
    settled_s = simulation.settled_s(SETTLED * float(simulation.distance_m[0]))
    return {
        "mission": plan.spec.name,
        "duration_s": float(simulation.t_s[-1]),
        "gain": simulation.gain.tolist(),
        "start_error_m": simulation.error_m[0].tolist(),
        "start_velocity_error_m_s": simulation.velocity_error_m_s[0].tolist(),
        "settled_s": settled_s if math.isfinite(settled_s) else None,
        "largest_error_m": float(simulation.distance_m.max()),
        "largest_control_m_s2": float(np.hypot(*simulation.control_m_s2.T).max()),
        "word": [sorted(letter) for letter in word],
        "achieved": outcome.achieved,
        "reason": outcome.reason,
    }


def _print(plan: FlightPlan, simulation: Simulation, outcome: Outcome, word: tuple[frozenset[str], ...]) -> None:
    tau = simulation.time_constant_s
    _line("Mission", printable(plan.spec.name))
    stiffness, damping = simulation.gain[0, 0], simulation.gain[0, 2]
    _line("Vehicle", "x'' = u on each axis (Eq. 5): no sensors, no wind, no limits")
    _line("Tracking", f"u = -K e + v' (Eq. 12), K = [{stiffness:.4g} I, {damping:.4g} I], tau = {tau:g} s")
    if is_carried(plan):
        _line("", "the path of the fields is tracked, unsmoothed, as the moving triangles carry it along (Sec. 4.4)")
    elif plan.spec.flight.guidance == FIELD:
        _line("", "the smoothed path is tracked, which a flight by the field does not follow")
    (east, north), (to_east, to_north) = simulation.position_m[0], simulation.velocity_m_s[0]
    start_m, start_m_s = float(simulation.distance_m[0]), float(np.hypot(*simulation.velocity_error_m_s[0]))
    _line("Start", f"({east:.3f}, {north:.3f}) m at ({to_east:.3f}, {to_north:.3f}) m/s")
    _line("", f"{start_m:.3g} m and {start_m_s:.3g} m/s beside the steering law")
    if start_m > 0.0:
        settled_s = simulation.settled_s(SETTLED * start_m)
        still = f"within {SETTLED:.0%} of that from {settled_s:.1f} s on, {settled_s / tau:.2f} tau"
        _line("Error", still if math.isfinite(settled_s) else f"not within {SETTLED:.0%} of that by the end")
    _line("" if start_m > 0.0 else "Error", f"at most {simulation.distance_m.max():.3g} m")
    pull = float(np.hypot(*simulation.control_m_s2.T).max())
    asked = float(np.hypot(*simulation.asked_acceleration_m_s2.T).max())
    _line("Control", f"at most {pull:.3g} m/s², where the steering law asks for {asked:.3g} m/s² at most")
    _line("", f"a tilt of {math.degrees(pull / _G):.2g} degrees by Eq. 9")
    _line("Word", " ".join("{" + ",".join(sorted(letter)) + "}" for letter in word))
    verdict = "achieved" if outcome.achieved else "not achieved"
    _line("Verdict", f"{verdict}: {outcome.reason}, over {simulation.t_s[-1]:.0f} s")


def _line(name: str, words: str) -> None:
    out.out(f"{name:<15}{words}")
