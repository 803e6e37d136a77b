"""A plan as JSON, and back.

The file holds everything that was decided, and the automaton that the mission names, if it does. The automata of the
plan are written for readers; reading a plan makes them anew from the formula or from the mission's automaton, so that a
proof from the file rests on these and not on what somebody wrote beside them.
"""

import json
from dataclasses import asdict
from typing import Any

import numpy as np

from mission.errors import Fault, GeometryError, SpecError
from mission.geometry.arrays import IntArray
from mission.geometry.regions import Labelling
from mission.geometry.simplices import Partition
from mission.logic.automata.automaton import BuchiAutomaton
from mission.plan.covering import CoveredVisit
from mission.plan.detour import Avoidance, Avoided
from mission.plan.flight_plan import FlightPlan
from mission.plan.homeward import Homeward
from mission.plan.photographs import photographs_from_json, photographs_to_json
from mission.plan.proved_run import PassedOver
from mission.plan.specification import of_mission
from mission.plan.tasks import DroppedTask
from mission.planning.run import Run
from mission.spec.document import document_of
from mission.spec.loader import parse_mission
from mission.spec.model import MissionSpec
from mission.spec.tasks import task_text
from mission.steering.certificate import Certificate
from mission.steering.path import Segment, SteeringPath
from mission.steering.rounded import RoundedPolyline
from mission.steering.trajectory import Trajectory

FORMAT = "ltl-mission plan 3"
_NAMED = "mission_automaton"


def plan_to_json(plan: FlightPlan) -> str:
    """The whole plan as JSON text; every number is kept to the last bit."""
    path, partition = plan.path, plan.partition
    document = {
        "format": FORMAT,
        "mission": document_of(plan.spec),
        **_named(plan.spec),
        "start_m": list(plan.start_m),
        "partition": {
            "vertices_m": partition.vertices_m.tolist(),
            "triangles": partition.triangles.tolist(),
            "neighbours": partition.neighbours.tolist(),
        },
        "labels": {
            "letters": [sorted(letter) for letter in plan.labelling.letters],
            "letter_of": plan.labelling.letter_of.tolist(),
        },
        "automaton": _automaton(plan.shown_automaton),
        "automaton_parts": plan.shown_parts,
        "refutation": _automaton(plan.required.refutation),
        "product_states": plan.product_states,
        "product_states_reachable": plan.product_states_reachable,
        "shortest_runs": plan.shortest_runs,
        "best_in_any_order": plan.best_in_any_order,
        "run_index": plan.run_index,
        "passed_over": [asdict(run) for run in plan.passed_over],
        "avoidance": plan.avoidance and asdict(plan.avoidance),
        "run": _run_data(plan.run),
        "path": {
            "lap": path.lap,
            "segments": [
                {
                    "triangle": segment.triangle,
                    "control": segment.control,
                    "F": segment.F.tolist(),
                    "g": segment.g.tolist(),
                    "entry_m": list(segment.entry_m),
                    "start_s": segment.start_s,
                    "duration_s": segment.duration_s,
                    **({} if segment.lanes is None else {"lanes": segment.lanes.to_json()}),
                }
                for segment in path.segments
            ],
        },
        "covers": [visit.to_json() for visit in plan.covers],
        "stops": [list(stop) for stop in plan.stops],
        "trajectory": plan.trajectory.to_json(),
        "certificate": plan.certificate.to_json(),
        "photographs": photographs_to_json(plan.photographs),
        "dropped": [asdict(task) for task in plan.dropped],
        "homeward": None
        if plan.homeward is None
        else {"run": _run_data(plan.homeward.run), "certificate": plan.homeward.certificate.to_json()},
    }
    return json.dumps(document, ensure_ascii=False, allow_nan=False) + "\n"


def plan_from_json(text: str) -> FlightPlan:
    """Read what ``plan_to_json`` wrote.

    Raises:
        SpecError: If the text is not such a plan, or its mission has faults.
    """
    try:
        return _plan(json.loads(text))
    except (GeometryError, ArithmeticError, LookupError, RecursionError, TypeError, ValueError) as error:
        hint = "name a file that 'mission plan --out' wrote"
        raise SpecError((Fault(0, 0, "", f"this is not a plan: {error}", hint),)) from error


def _plan(document: dict[str, Any]) -> FlightPlan:
    if document["format"] != FORMAT:
        raise ValueError(f"the format is not {FORMAT!r}")
    named = str(document.get(_NAMED, "")).encode()
    spec = parse_mission(json.dumps(document["mission"]).encode(), read=lambda _: named)
    dropped = tuple(_dropped(spec, task) for task in document.get("dropped", []))
    labels, path, homeward = document["labels"], document["path"], document["homeward"]
    labelling = Labelling(tuple(frozenset(letter) for letter in labels["letters"]), _whole(labels["letter_of"]))
    start = document["start_m"]
    return FlightPlan(
        spec=spec,
        start_m=(float(start[0]), float(start[1])),
        partition=Partition(
            np.array(document["partition"]["vertices_m"]),
            _whole(document["partition"]["triangles"]),
            _whole(document["partition"]["neighbours"]),
        ),
        labelling=labelling,
        required=of_mission(spec, labelling.letters, (task.number for task in dropped)),
        product_states=int(document["product_states"]),
        product_states_reachable=int(document["product_states_reachable"]),
        shortest_runs=int(document["shortest_runs"]),
        best_in_any_order=bool(document["best_in_any_order"]),
        run_index=int(document["run_index"]),
        passed_over=tuple(PassedOver(int(run["index"]), str(run["reason"])) for run in document.get("passed_over", [])),
        avoidance=_avoidance(document.get("avoidance")),
        run=_run(document["run"]),
        path=SteeringPath(
            tuple(_segment(segment) for segment in path["segments"]),
            None if path["lap"] is None else (int(path["lap"][0]), int(path["lap"][1])),
        ),
        stops=tuple((float(place), float(seconds)) for place, seconds in document["stops"]),
        trajectory=Trajectory.from_json(document["trajectory"]),
        certificate=Certificate.from_json(document["certificate"]),
        photographs=photographs_from_json(document.get("photographs", [])),
        dropped=dropped,
        covers=tuple(CoveredVisit.from_json(visit) for visit in document["covers"]),
        homeward=None
        if homeward is None
        else Homeward(_run(homeward["run"]), Certificate.from_json(homeward["certificate"])),
    )


def _named(spec: MissionSpec) -> dict[str, str]:
    """The content of the file that the mission names, so that the plan needs no other file."""
    return {} if spec.automaton is None else {_NAMED: spec.automaton.text}


def _whole(rows: Any) -> IntArray:  # noqa: ANN401 - any JSON value
    """Whole numbers, not only numbers that could be cast to some."""
    values = np.array(rows)
    if values.dtype.kind != "i":
        raise ValueError("whole numbers are expected here")
    return values.astype(np.int64)


def _run_data(run: Run) -> dict[str, list[int]]:
    return {"prefix": list(run.prefix), "suffix": list(run.suffix), "controls": list(run.controls)}


def _run(data: dict[str, Any]) -> Run:
    return Run(tuple(data["prefix"]), tuple(data["suffix"]), tuple(data["controls"]))


def _dropped(spec: MissionSpec, data: dict[str, Any]) -> DroppedTask:
    """A dropped task; a file cannot drop what must be met."""
    number = int(data["number"])
    task = spec.tasks[number] if 0 <= number < len(spec.tasks) else None
    if task is None or task.weight is None:
        raise ValueError(f"there is no task {number} that may be dropped")
    return DroppedTask(number, task_text(task), task.weight, str(data["reason"]))


def _avoidance(data: dict[str, Any] | None) -> Avoidance | None:
    if data is None:
        return None
    prefix, suffix = data["best_costs"]
    triangles = tuple(Avoided(int(each["triangle"]), str(each["reason"])) for each in data["triangles"])
    return Avoidance(triangles, (float(prefix), float(suffix)))


def _segment(data: dict[str, Any]) -> Segment:
    return Segment(
        triangle=int(data["triangle"]),
        control=int(data["control"]),
        F=np.array(data["F"], dtype=np.float64),
        g=np.array(data["g"], dtype=np.float64),
        entry_m=(float(data["entry_m"][0]), float(data["entry_m"][1])),
        start_s=float(data["start_s"]),
        duration_s=float(data["duration_s"]),
        lanes=RoundedPolyline.from_json(data["lanes"]) if "lanes" in data else None,
    )


def _automaton(automaton: BuchiAutomaton) -> dict[str, Any]:
    return {
        "states": automaton.size,
        "initial": list(automaton.initial),
        "accepting": sorted(automaton.accepting),
        "edges": [[edge.source, str(edge.guard), edge.target] for edge in automaton.edges],
    }
