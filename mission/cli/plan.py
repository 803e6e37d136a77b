"""``mission plan``: plan a mission, show the plan, write it, draw it."""

import math
from argparse import Namespace
from dataclasses import asdict
from itertools import islice
from pathlib import Path
from typing import Final

import numpy as np

from mission.cli.drawing import draw
from mission.cli.equations import equations, print_equations, print_product
from mission.cli.extent import extent, length_m
from mission.cli.given import changes_of
from mission.cli.inputs import planned, write_named
from mission.cli.screen import out, print_json, print_warnings, reach, tube_costs
from mission.decimals import count, decimal, measure
from mission.geometry.simplices import Partition
from mission.plan import CoveredVisit, FlightPlan, plan_to_json, shortest_runs
from mission.plan.costs import MEASURED, UNIT
from mission.plan.definitions import product_steps
from mission.plan.policy import policy_of
from mission.planning.run import Run
from mission.printable import printable
from mission.spec.clearances import clearances_by_name
from mission.spec.model import CORRIDOR, FIELD, Cost
from mission.spec.motion import motion_data
from mission.spec.moving import motions_by_name
from mission.spec.tasks import task_text
from mission.steering.path import SteeringPath
from mission.steering.polyline import Polyline


def run(arguments: Namespace) -> int:
    """Plan and show; what is to be written is written first, whoever reads the rest."""
    plan = planned(arguments.file, arguments.run, changes_of(arguments))
    if arguments.out is not None:
        write_named("--out", Path(arguments.out), plan_to_json(plan))
    if arguments.pictures is not None:
        draw(Path(arguments.pictures), arguments.format, plan)
    if arguments.json:
        print_json({"exit_code": 0, **_asked_for(plan, arguments)})
        return 0
    print_plan(plan)
    if arguments.transitions:
        _print_tables(plan)
        _print_transitions(plan)
        print_product(plan)
    if arguments.equations:
        print_equations(plan)
    if arguments.runs:
        _print_runs(plan, arguments.runs)
    if arguments.out is not None or arguments.pictures is not None:
        _print()
    if arguments.out is not None:
        _print(f"Plan           {printable(arguments.out)}")
    if arguments.pictures is not None:
        _print(f"Pictures       {printable(arguments.pictures)}")
    return 0


def _asked_for(plan: FlightPlan, arguments: Namespace) -> dict[str, object]:
    """The summary, with the runs and the transitions where they are asked for."""
    document = summary(plan)
    if arguments.runs:
        document["runs"] = [
            {"prefix": list(found.prefix), "suffix": list(found.suffix), "controls": list(found.controls)}
            for found in islice(shortest_runs(plan), arguments.runs)
        ]
    if arguments.transitions:
        document["transitions"] = {
            "T": plan.successors.tolist(),
            "A": [[edge.source, str(edge.guard), edge.target] for edge in plan.shown_automaton.edges],
            "P": [list(step) for step in product_steps(plan)],
        }
    if arguments.equations:
        document["equations"] = equations(plan)
    return document


def summary(plan: FlightPlan) -> dict[str, object]:
    """The figures of a plan, for programs; run and controls as the paper writes them."""
    certificate = plan.certificate
    return {
        "name": plan.spec.name,
        "formula": plan.specification,
        "automaton_file": plan.spec.automaton.file if plan.spec.automaton else None,
        "tasks": [task_text(task) for task in plan.spec.tasks],
        "dropped_tasks": [asdict(task) for task in plan.dropped],
        "warnings": list(plan.warnings),
        "triangles": plan.partition.size,
        "smallest_angle_deg": math.degrees(plan.partition.angles_rad.min()),
        "largest_edge_m": float(plan.partition.edge_lengths_m.max()),
        "automaton_parts": plan.shown_parts,
        "automaton_states": plan.shown_automaton.size,
        "automaton_edges": plan.shown_automaton.edge_count,
        "automaton_deterministic": all(part.deterministic for part in plan.required.shown),
        "searched_automaton_states": plan.product_states // plan.partition.size,
        "product_states": plan.product_states,
        "product_states_reachable": plan.product_states_reachable,
        "shortest_runs": plan.shortest_runs,
        "cost": str(plan.spec.search.cost),
        "cost_measures": MEASURED[plan.spec.search.cost],
        "costs": dict(zip(("prefix", "suffix"), plan.costs, strict=True)),
        "best_in_any_order": plan.best_in_any_order,
        "run_index": plan.run_index,
        "runs_passed_over": [asdict(run) for run in plan.passed_over],
        "avoidance": plan.avoidance and asdict(plan.avoidance),
        "run": list(plan.run.states),
        "prefix_states": len(plan.run.prefix),
        "controls": list(plan.run.controls),
        "length_m": plan.path.length_m,
        "curve_length_m": plan.curve.length_m,
        "flight_length_m": length_m(plan),
        "duration_s": plan.path.duration_s,
        "flight_duration_s": plan.trajectory.duration_s if math.isfinite(plan.trajectory.duration_s) else None,
        "laps": None if plan.trajectory.lap is None else plan.spec.flight.laps,
        "way_back": None if plan.homeward is None else list(plan.homeward.run.states),
        "frequencies": plan.curve.frequencies,
        "guidance": plan.spec.flight.guidance,
        "covers": [visit.figures() for visit in plan.covers],
        "motions": {name: motion_data(motion) for name, motion in motions_by_name(plan.spec).items()},
        "bounds": [bound.to_json() for bound in plan.bounds],
        "certificate": {
            "holds": certificate.holds,
            "tube_m": certificate.tube_m,
            "tube_m_s": plan.spec.flight.tube_m_s,
            "tube_causes": dict(plan.spec.flight.tube_causes),
            "landing_m": plan.landing_m,
            "clearance_m": certificate.clearance_m,
            "word": [sorted(letter) for letter in certificate.word],
        },
    }


_MOST_LISTED: Final = 60
"""Of larger meshes only the triangles of the run are listed; the file that ``--out`` writes holds all."""


def _label(plan: FlightPlan, triangle: int) -> str:
    return " ".join(sorted(plan.labelling.label(triangle))) or "-"


def _print(text: str = "") -> None:
    out.out(text, highlight=False)


def _print_mission(plan: FlightPlan) -> None:
    lost = {task.number: task for task in plan.dropped}
    for i, task in enumerate(plan.spec.tasks):
        weight = "" if task.weight is None else f" (weight {decimal(task.weight)})"
        _print(f"  {'dropped' if i in lost else 'task':<11}{task_text(task)}{weight}")
        if i in lost:
            _print(f"               {lost[i].reason}")
    for kind, text in plan.written:
        _print(f"  {kind:<11}{text}")


def print_plan(plan: FlightPlan) -> None:
    """What is flown and what is proved of it; then what was searched."""
    _print(printable(plan.spec.name))
    _print_mission(plan)
    _print()
    _print(f"Flight         {extent(plan, 1)}{_stays(plan)}")
    for visit in plan.covers:
        _print(f"Covered        {_lanes(visit)}")
    for number, (name, motion) in enumerate(motions_by_name(plan.spec).items()):
        _print(f"{'Moves' if number == 0 else '':<15}{name} {motion.text}")
    _print_certificate(plan)
    for number, bound in enumerate(plan.bounds):
        _print(f"{'In time' if number == 0 else '':<15}{bound.text}")
    if plan.spec.flight.guidance == FIELD:
        _print_guidance(plan)
    print_warnings(plan.warnings)
    _print()
    _print(f"Path           {_path(plan)}{_one_lap(plan)}")
    _print(f"Smoothing      {_smoothing(plan)}{_one_lap(plan)}")
    _print_mesh(plan.partition)
    if clearances_m := clearances_by_name(plan.spec):
        _print(f"Clearances     {', '.join(f'{name} {decimal(metres)} m' for name, metres in clearances_m.items())}")
    _print_search(plan)


def _print_search(plan: FlightPlan) -> None:
    automaton, parts = plan.shown_automaton, plan.shown_parts
    kind = "deterministic" if all(part.deterministic for part in plan.required.shown) else "nondeterministic"
    beside = "" if parts == 1 else f"{parts} automata side by side, all of which must accept: "
    _print(f"T  {count(plan.partition.size, 'state')}")
    _print(f"A  {beside}{count(automaton.size, 'state')}, {count(automaton.edge_count, 'edge')}, {kind}")
    searched = plan.product_states // plan.partition.size
    same = parts == 1 and searched == automaton.size
    several = "" if same else f" (with deterministic automata of its parts, {count(searched, 'state')} together)"
    _print(f"P  {count(plan.product_states, 'state')}, {plan.product_states_reachable:,} of them reachable{several}")
    _print(f"Best runs      {plan.shortest_runs:,}{_costs(plan)}")
    _print(f"Run {plan.run_index:<11}{_lasso(plan.run)}")
    if plan.homeward is not None:
        _print(f"Way back       {' '.join(map(str, plan.homeward.run.states))}")


def _print_tables(plan: FlightPlan) -> None:
    """The triangles, and the run with its controls."""
    size = plan.partition.size
    listed = range(size) if size <= _MOST_LISTED else sorted(set(plan.run.states))
    which = "the partition" if size <= _MOST_LISTED else "the run"
    _print()
    _print(f"Triangles of {which} (vertices counter-clockwise; u_j leaves through the facet opposite vertex j)")
    _print(f"  {'T':>6}  {'vertices':<20}{'neighbours 1 2 3':<22}label")
    for i in listed:
        corners, neighbours = plan.partition.triangles[i].tolist(), plan.partition.neighbours[i].tolist()
        across = " ".join("-" if n < 0 else str(n) for n in neighbours)
        _print(f"  {i:>6}  {' '.join(map(str, corners)):<20}{across:<22}{_label(plan, i)}")
    _print()
    _print(f"Run {plan.run_index}: state, label, control")
    for i, (state, control) in enumerate(zip(plan.run.states, plan.run.controls, strict=True)):
        loop = "   <- the loop begins" if i == len(plan.run.prefix) and plan.run.recurrent else ""
        _print(f"  {state:>6}  {_label(plan, state):<20}u{control}{loop}")


def _stays(plan: FlightPlan) -> str:
    held = sum(hold for _, hold in plan.stops)
    return f", {held:g} s of stays included{_one_lap(plan)}" if held else ""


def _one_lap(plan: FlightPlan) -> str:
    """That a figure counts the lap once."""
    return "" if plan.trajectory.lap is None else ", with one lap"


def _path(plan: FlightPlan) -> str:
    length = f"{plan.path.length_m:.2f} m"
    if isinstance(plan.path, SteeringPath):
        return f"{length} in {plan.path.duration_s:.1f} s"
    return f"{length}, the shortest with room for the tube"


def _smoothing(plan: FlightPlan) -> str:
    if isinstance(plan.path, Polyline):
        return f"a curve in the corridor of the path, {plan.curve.length_m:.2f} m long"
    asked = plan.spec.smoothing
    extension, few = ("odd", True) if asked == CORRIDOR else (asked.extension.value, asked.frequencies == "auto")
    return f"{extension} extension, frequencies: {plan.curve.frequencies}{' (as few as the proof needs)' * few}"


def _lanes(visit: CoveredVisit) -> str:
    images = "" if visit.trigger_m is None else f"; images every {decimal(round(visit.trigger_m, 2))} m"
    order = "" if visit.exact else "; in the best order that was found"
    lanes = f"{count(len(visit.lanes_m), 'lane')} {decimal(round(visit.spacing_m, 2))} m apart"
    lengths = f"{visit.lanes_length_m:,.0f} m, and {visit.ways_m:,.0f} m between"
    share = f"{visit.planned_share:.1%} of {visit.region}"
    return f"{share} by {lanes}, heading {visit.heading_deg:.0f} degrees, {lengths}{images}{order}"


def _print_mesh(mesh: Partition) -> None:
    angle_deg, edge_m = math.degrees(mesh.angles_rad.min()), mesh.edge_lengths_m.max()
    triangles = count(mesh.size, "triangle")
    _print(f"Mesh           {triangles}, smallest angle {angle_deg:.1f} degrees, largest edge {edge_m:.2f} m")


def _costs(plan: FlightPlan) -> str:
    cost = plan.spec.search.cost
    prefix, suffix = plan.costs
    if cost is Cost.TRANSITIONS:
        return f", of {count(round(prefix + suffix), 'transition')} each"
    unit, _ = UNIT[cost]
    found = f"{prefix:.1f} {unit} up to the loop, {suffix:.1f} {unit} round it (number {plan.run_index})"
    return f" by {cost}: {found}\n               ({MEASURED[cost]}; what is flown is the path above)"


def _print_guidance(plan: FlightPlan) -> None:
    """What is flown instead of the trajectory, and what is known of it."""
    possible = policy_of(plan).possible[:, ~plan.restricted]
    _print("Guidance       field: the path and its certificate are not what is flown; no tube is proved")
    _print("               at each moment control to the facet that leads on, by the estimated position: undisturbed,")
    _print("               each triangle is left through that facet and no other")
    _print(
        f"               from {np.count_nonzero(possible):,} of {possible.size:,} states of P outside what is "
        "restricted the mission can be completed"
    )


def _print_certificate(plan: FlightPlan) -> None:
    certificate = plan.certificate
    _print(f"Certificate    holds {reach(certificate.tube_m)}")
    for line in tube_costs(plan.spec.flight):
        _print(f"               {line}")
    if certificate.tube_m > 0.0:
        _print(
            f"               it is flown within {plan.spec.flight.tube_m_s:.2g} m/s of its velocity, by the same causes"
        )
    if plan.landing_m:
        _print(f"               landing at its end, it may drift by {measure(plan.landing_m)} m more")
    if certificate.clearance_m is not None:
        _print(f"               at least {certificate.clearance_m:.2f} m from every restricted triangle")
    if plan.homeward is not None:
        _print("               on the way back from the laps nothing is violated")
    word = " ".join("{" + ",".join(sorted(letter)) + "}" for letter in certificate.word)
    _print(f"               the flight surely spells {word}")


def _print_transitions(plan: FlightPlan) -> None:
    _print()
    _print("Transitions of T: state, control -> state (-1: not admissible)")
    for i, successors in enumerate(plan.successors.tolist()):
        _print("  " + "   ".join(f"{i}, u{u} -> {target}" for u, target in enumerate(successors)))
    _print()
    shown = plan.shown_automaton
    accepting = " ".join(f"q{q}" for q in sorted(shown.accepting))
    _print(f"Transitions of A: initial {' '.join(f'q{q}' for q in shown.initial)}, accepting {accepting}")
    for edge in shown.edges:
        _print(f"  q{edge.source} --[{edge.guard}]--> q{edge.target}")


def _print_runs(plan: FlightPlan, most: int) -> None:
    _print()
    runs, without = shortest_runs(plan), "" if plan.avoidance is None else f" without {plan.avoidance.listed}"
    _print(f"The first {min(most, runs.count):,} of {count(runs.count, 'shortest run')}{without}")
    for i, found in enumerate(islice(runs, most)):
        _print(f"  {i:>4}  {_lasso(found)}")


def _lasso(found: Run) -> str:
    return " ".join([*map(str, found.prefix), f"({' '.join(map(str, found.suffix))})*"])
