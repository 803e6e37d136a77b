"""Plans beside regions that move."""

import io
from dataclasses import replace
from functools import cache

import numpy as np

from mission.plan import FlightPlan, plan_mission
from mission.report.reading import Record, parse_record
from mission.report.record import FlightRecord
from mission.spec.model import MissionSpec
from tests.support.drifting_missions import drifting

SLOW = "{velocity_m_s: [0, 0.5], until_s: 20}"


def standing(spec: MissionSpec) -> MissionSpec:
    """The mission with every region where it is drawn."""
    return replace(spec, regions=tuple(replace(region, motion=None) for region in spec.regions))


@cache
def drifting_plan(motion: str = SLOW, formula: str = "F (S1 & F G home)") -> FlightPlan:
    """The plan of a mission whose region K moves: up to 7 m beside the way from home to S1 and back, if slowly."""
    return plan_mission(drifting(formula, motion))


def drifting_record(plan: FlightPlan, begun_s: float = 12.0) -> Record:
    """The record of a flight that is exactly where its plan says, whose trajectory begins at a time of the vehicle."""
    stream = io.BytesIO()
    record = FlightRecord(stream, mission=plan.spec.name)
    times = np.linspace(0.0, plan.trajectory.duration_s, 300)
    height_m, still = plan.trajectory.altitude_m, {"velocity_m_s": [0, 0, 0], "attitude_rad": [0, 0, 0]}
    record.write("telemetry", 2.0, position_m=[*plan.start_m, 0.0], **still)
    record.write("visit", begun_s, triangle=plan.run.states[0], labels=plan.labelling.label(plan.run.states[0]))
    for t, place in zip(times.tolist(), plan.trajectory.position(times).tolist(), strict=True):
        asked = {"position_m": [*place, height_m], "velocity_m_s": [0, 0, 0], "acceleration_m_s2": [0, 0, 0]}
        record.write("setpoint", begun_s + t, **asked, yaw_rad=0.0, trajectory_s=t)
        record.write("telemetry", begun_s + t, position_m=[*place, height_m], **still)
    record.write("verdict", begun_s + plan.trajectory.duration_s, achieved=True, reason="as planned")
    return parse_record(stream.getvalue())
