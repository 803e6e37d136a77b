"""A plan as JSON, and back.

The file holds everything that was decided, and the automaton that the mission names, if it does. The automata of the
plan are written for readers; reading a plan makes them anew from the formula or from the mission's automaton, so that a
proof from the file rests on these and not on what somebody wrote beside them.
"""

import json
from collections.abc import Callable
from dataclasses import asdict
from functools import partial
from typing import Any, Final, TypeVar

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
from mission.plan.tasks import DroppedTask
from mission.plan.way import Way
from mission.planning.run import Run
from mission.spec.document import document_of
from mission.spec.loader import parse_mission
from mission.spec.model import MissionSpec
from mission.spec.specification import of_mission
from mission.spec.tasks import task_text
from mission.steering.certificate import Certificate
from mission.steering.path import Segment, SteeringPath
from mission.steering.polyline import Polyline
from mission.steering.rounded import RoundedPolyline
from mission.steering.trajectory import Trajectory

FORMAT = "ltl-mission plan 4"
_NAMED = "mission_automaton"
_OPTIONAL: Final[dict[str, Any]] = {
    _NAMED: "",
    "dropped": [],
    "passed_over": [],
    "avoidance": None,
    "photographs": [],
    "way": None,
    "instead": "",
    "onward": None,
}

_Value = TypeVar("_Value")


def plan_to_json(plan: FlightPlan) -> str:
    """The whole plan as JSON text; every number is kept to the last bit."""
    partition = plan.partition
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
        "costs": list(plan.costs),
        "way": plan.way and plan.way.to_json(),
        "path": _path_data(plan.path),
        "instead": plan.instead,
        "onward": plan.onward and [list(each) for each in plan.onward],
        "covers": [visit.to_json() for visit in plan.covers],
        "stops": [list(stop) for stop in plan.stops],
        "trajectory": plan.trajectory.to_json(),
        "certificate": plan.certificate.to_json(),
        **({"bounds": [bound.to_json() for bound in plan.bounds]} if plan.bounds else {}),
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
        document = json.loads(text)
    except json.JSONDecodeError as error:
        raise _no_plan(f"JSON ends at line {error.lineno}, column {error.colno}") from error
    except (RecursionError, ValueError) as error:
        raise _no_plan("it is nested too deep, or has too long a number") from error
    if not isinstance(document, dict) or document.get("format") != FORMAT:
        raise _no_plan(f"its format is not {FORMAT!r}")
    return _plan({**_OPTIONAL, **document})


def _no_plan(why: str) -> SpecError:
    return SpecError((Fault(0, 0, "", f"this is not a plan: {why}", "name a file that 'mission plan --out' wrote"),))


def _part(document: dict[str, Any], key: str, made: Callable[[Any], _Value]) -> _Value:
    """What is made of a part of the document.

    Raises:
        SpecError: It is missing, or nothing can be made of it.
    """
    if key not in document:
        raise _no_plan(f"it has no `{key}`")
    try:
        return made(document[key])
    except GeometryError as error:
        raise _no_plan(f"`{key}` is not as it was written: {error}") from error
    except (ArithmeticError, AttributeError, LookupError, RecursionError, TypeError, ValueError) as error:
        # In the words of Python, which are not about the plan.
        raise _no_plan(f"`{key}` is not as it was written") from error


def _plan(document: dict[str, Any]) -> FlightPlan:
    part = partial(_part, document)
    named = str(document[_NAMED]).encode()
    spec = part("mission", lambda data: parse_mission(json.dumps(data).encode(), read=lambda _: named))
    labelling = part("labels", _labelling)
    dropped = part("dropped", lambda tasks: tuple(_dropped(spec, task) for task in tasks))
    return FlightPlan(
        spec=spec,
        start_m=part("start_m", _point),
        partition=part("partition", _partition),
        labelling=labelling,
        required=part("labels", lambda _: of_mission(spec, labelling.letters, (task.number for task in dropped))),
        product_states=part("product_states", int),
        product_states_reachable=part("product_states_reachable", int),
        shortest_runs=part("shortest_runs", int),
        best_in_any_order=part("best_in_any_order", bool),
        run_index=part("run_index", int),
        passed_over=part(
            "passed_over", lambda runs: tuple(PassedOver(int(run["index"]), str(run["reason"])) for run in runs)
        ),
        avoidance=part("avoidance", _avoidance),
        run=part("run", _run),
        costs=part("costs", _point),
        path=part("path", _path),
        stops=part("stops", lambda stops: tuple((float(place), float(seconds)) for place, seconds in stops)),
        trajectory=part("trajectory", Trajectory.from_json),
        certificate=part("certificate", Certificate.from_json),
        photographs=part("photographs", photographs_from_json),
        dropped=dropped,
        covers=part("covers", lambda visits: tuple(CoveredVisit.from_json(visit) for visit in visits)),
        homeward=part("homeward", _homeward),
        instead=part("instead", str),
        onward=part("onward", lambda data: None if data is None else (_point(data[0]), _point(data[1]))),
        way=part("way", lambda data: None if data is None else Way.from_json(data)),
    )


def _path_data(path: SteeringPath | Polyline) -> dict[str, Any]:
    if isinstance(path, Polyline):
        return path.to_json()
    return {
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
    }


def _point(data: list[Any]) -> tuple[float, float]:
    return float(data[0]), float(data[1])


def _partition(data: dict[str, Any]) -> Partition:
    return Partition(np.array(data["vertices_m"]), _whole(data["triangles"]), _whole(data["neighbours"]))


def _labelling(data: dict[str, Any]) -> Labelling:
    return Labelling(tuple(frozenset(letter) for letter in data["letters"]), _whole(data["letter_of"]))


def _path(data: dict[str, Any]) -> SteeringPath | Polyline:
    if "segments" not in data:
        return Polyline.from_json(data)
    lap = data["lap"]
    return SteeringPath(
        tuple(_segment(segment) for segment in data["segments"]), None if lap is None else (int(lap[0]), int(lap[1]))
    )


def _homeward(data: dict[str, Any] | None) -> Homeward | None:
    return None if data is None else Homeward(_run(data["run"]), Certificate.from_json(data["certificate"]))


def _named(spec: MissionSpec) -> dict[str, str]:
    """The content of the file that the mission names, so that the plan needs no other file."""
    return {} if spec.automaton is None else {_NAMED: spec.automaton.text}


def _whole(rows: Any) -> IntArray:  # noqa: ANN401 - any JSON value
    """Whole numbers, not only numbers that could be cast to some."""
    values = np.array(rows)
    if values.dtype.kind != "i":
        raise GeometryError("whole numbers are expected here")
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
        raise _no_plan(f"there is no task {number} that may be dropped")
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
        entry_m=_point(data["entry_m"]),
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
