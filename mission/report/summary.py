"""The numbers of a plan and of its flight, as JSON values; the report shows the same."""

import math
from collections.abc import Sequence
from dataclasses import asdict
from itertools import groupby
from typing import Any

import numpy as np

from mission.monitor.attitude import tilt
from mission.monitor.coverage import covered_values
from mission.monitor.pictures import missing
from mission.plan import FlightPlan
from mission.report.coverage import covered_again
from mission.report.reading import GAP, Record, Visit
from mission.report.replay import judged_again
from mission.report.tracking import flown_by_field, nearest_to, tracking_of
from mission.spec.clearances import clearances_by_name
from mission.spec.model import FIELD
from mission.spec.moving import motions_by_name
from mission.spec.tasks import task_text


def summary(plan: FlightPlan, record: Record | None) -> dict[str, Any]:
    """What was planned, what was proved and what was flown.

    Metres, seconds, ENU. ``verdict`` and ``flown`` are None without a record; a number that cannot be known is None.
    """
    return {
        "mission": plan.spec.name,
        "formula": plan.specification,
        "automaton_file": plan.spec.automaton.file if plan.spec.automaton else None,
        "tasks": [task_text(task) for task in plan.spec.tasks],
        "dropped_tasks": [asdict(task) for task in plan.dropped],
        "semantics": plan.spec.semantics.value,
        "verdict": None if record is None else _verdict(record),
        "planned": _planned(plan),
        "certificate": _certificate(plan),
        "flown": None if record is None else _flown(plan, record),
    }


def condensed(visits: Sequence[Visit]) -> list[tuple[Visit, list[int]]]:
    """The word that was flown: the first visit of each stretch with equal labels, and the stretch's triangles."""
    stretches = [list(group) for _, group in groupby(visits, key=lambda visit: (visit.triangle < 0, visit.labels))]
    return [(stretch[0], [visit.triangle for visit in stretch]) for stretch in stretches]


def _planned(plan: FlightPlan) -> dict[str, Any]:
    return {
        "triangles": plan.partition.size,
        "automaton_states": plan.shown_automaton.size,
        "automaton_edges": plan.shown_automaton.edge_count,
        "product_states": plan.product_states,
        "product_states_reachable": plan.product_states_reachable,
        "shortest_runs": plan.shortest_runs,
        "run_index": plan.run_index,
        "run": list(plan.run.states),
        "loop_from_state": len(plan.run.prefix),
        "recurrent": plan.run.recurrent,
        "controls": list(plan.run.controls),
        "length_m": plan.path.length_m,
        "steering_duration_s": plan.path.duration_s,
        "duration_s": plan.trajectory.duration_s if math.isfinite(plan.trajectory.duration_s) else None,
        "laps": None if plan.trajectory.lap is None else plan.spec.flight.laps,
        "lap_duration_s": None if plan.trajectory.lap is None else plan.trajectory.legs[plan.trajectory.lap].duration_s,
        "way_back": None if plan.homeward is None else list(plan.homeward.run.states),
        "altitude_m": plan.trajectory.altitude_m,
        "guidance": plan.spec.flight.guidance,
        "clearances_m": clearances_by_name(plan.spec),
        "motions": {name: motion.text for name, motion in motions_by_name(plan.spec).items()},
        "covers": [visit.figures() for visit in plan.covers],
    }


def _certificate(plan: FlightPlan) -> dict[str, Any]:
    certificate = plan.certificate
    return {
        "holds": certificate.holds,
        "reason": certificate.reason,
        "frequencies": certificate.frequencies,
        "tube_m": certificate.tube_m,
        "tube_m_s": plan.spec.flight.tube_m_s,
        "clearance_m": certificate.clearance_m,
        "word": [sorted(letter) for letter in certificate.word],
        "way_back": None if plan.homeward is None else plan.homeward.certificate.reason,
        "in_time": [bound.text for bound in plan.bounds],
    }


def _verdict(record: Record) -> dict[str, Any]:
    if record.verdict is None:
        return {"achieved": None, "reason": "the record ends before a verdict was reached"}
    return {"achieved": None, "reason": "", **record.verdict}


def _flown(plan: FlightPlan, record: Record) -> dict[str, Any]:
    tracking = tracking_of(record)
    distance = tracking.distance_m
    tracked = len(distance) > 0
    moved = tracking if plan.spec.flight.guidance != FIELD else flown_by_field(record.track)
    steps = np.hypot(*np.diff(moved.position_m[:, :2], axis=0).T)
    speeds = np.hypot(*moved.velocity_m_s[:, :2].T)
    return {
        "record_is_cut": record.cut,
        "plans": 1 + len(record.takeovers),
        "gaps": [{"t_s": each.t_s, **each.values} for each in record.events if each.text == GAP],
        "covered": [covered_values(visit) for visit in covered_again(plan, record)],
        "photographs": _photographs(plan, record),
        "reports": len(record.track.t_s),
        "reports_on_trajectory": len(distance),
        "duration_s": float(moved.t_s[-1] - moved.t_s[0]) if len(moved.t_s) else None,
        "length_m": float(steps.sum()) if len(moved.t_s) else None,
        "largest_speed_m_s": _largest(speeds),
        "largest_tilt_deg": _largest(np.rad2deg(tilt(moved.attitude_rad))),
        "largest_error_m": _largest(distance),
        "largest_error_per_axis_m": _largest(np.abs(tracking.error_m).ravel()),
        "largest_velocity_error_per_axis_m_s": _largest(np.abs(tracking.velocity_error_m_s).ravel()),
        "rms_error_m": float(np.sqrt(np.mean(distance**2))) if tracked else None,
        "distance_to_restricted_m": {name: metres for name, (_, metres) in nearest_to(plan, record).items()},
        "charge_percent": [each.percent for each in (*record.charges[:1], *record.charges[-1:])] or None,
        "judged": _judged(plan, record),
        "word": [
            {
                "t_s": visit.t_s if math.isfinite(visit.t_s) else None,
                "labels": sorted(visit.labels),
                "triangles": triangles,
            }
            for visit, triangles in condensed(record.visits)
        ],
    }


def _photographs(plan: FlightPlan, record: Record) -> dict[str, Any]:
    """How many pictures were told of, how many more were taken, and how many should have been."""
    numbers = [each.number for each in record.pictures]
    return {"told": len(numbers), "missing": missing(numbers), "planned": plan.planned_pictures}


def _judged(plan: FlightPlan, record: Record) -> dict[str, Any]:
    """What the flight's monitor knows of the record; of a flight that was cut short, too."""
    legs = judged_again(plan, record)
    monitor, progress = legs.now.judged.monitor, legs.now.judged.monitor.progress
    return {
        "so_far": monitor.verdict.value,
        "done": progress.done,
        "total": progress.total,
        "awaited": list(progress.awaited),
        "laps": legs.laps,
        "in_time": [bound.text() for bound in legs.bounds],
        "violations": [{"t_s": each.time_s, "what": each.kind.value, "names": each.names} for each in legs.violations],
    }


def _largest(values: np.ndarray[Any, np.dtype[np.float64]]) -> float | None:
    known = values[np.isfinite(values)]
    return float(known.max()) if len(known) else None
