"""Plans to draw: real domains, paths and curves, with a run given by the regions to go through, and flights of them."""

import io
import itertools
from collections import deque
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache

import numpy as np

from mission.geometry.arrays import FloatArray
from mission.geometry.simplices import Partition
from mission.logic.formula.parser import parse_formula
from mission.plan import FlightPlan, trajectory_of
from mission.planning.run import Run
from mission.report.reading import Record, parse_record
from mission.report.record import FlightRecord
from mission.spec.domain import build_domain, restricted_triangles
from mission.spec.loader import parse_mission
from mission.spec.specification import Specification
from mission.steering.certificate import Certificate
from mission.steering.path import build_path
from mission.steering.proved_smoothing import fit_legs
from tests.support.steered_plans import fields_of, series_of

PAPER = b"""
name: paper
domain:
  nodes: [[0, 0], [0, 10], [15, 10], [15, 0], [6, 10], [9, 10], [11, 0], [2, 8], [8, 7], [11, 2], [5, 5]]
regions:
  R: {kind: home, triangle: [9, 6, 3]}
  S1: {kind: survey, triangle: [7, 4, 1]}
  S2: {kind: survey, triangle: [5, 8, 2]}
  K1: {kind: restricted, triangle: [4, 10, 8]}
mission: {formula: "F (S1 & F R) & G !K1"}
start: {position_m: [11.0, 9.5]}
flight: {speed_m_s: 0.05, altitude_m: 10, final_stay_s: 100, time_constant_s: 5, disturbance_m_s2: 0.002}
limits: {speed_m_s: 1, acceleration_m_s2: 1, tilt_deg: 20}
smoothing: {extension: odd}
search: {cost: transitions}
"""

SURVEY = b"""
name: Field survey
domain:
  boundary: [[0, 0], [150, 0], [150, 70], [105, 70], [105, 100], [20, 100], [0, 75]]
regions:
  base: {kind: home, polygon: [[6, 8], [20, 8], [20, 20], [6, 20]]}
  north_field: {kind: survey, polygon: [[62, 76], [90, 76], [90, 92], [62, 92]]}
  orchard: {kind: survey, polygon: [[122, 44], [140, 44], [142, 62], [124, 62]]}
  pond: {kind: survey, polygon: [[112, 10], [134, 10], [134, 26], [114, 26]]}
  school: {kind: restricted, polygon: [[50, 38], [72, 36], [74, 54], [52, 56]]}
  mast: {kind: restricted, polygon: [[20, 58], [28, 60], [24, 67]]}
mission: {formula: "F north_field & F orchard & F pond & F G base & G !school & G !mast"}
start: {position_m: [12, 13]}
flight: {speed_m_s: 4, altitude_m: 20, time_constant_s: 1, disturbance_m_s2: 0.5}
limits: {speed_m_s: 8, acceleration_m_s2: 2.5, tilt_deg: 25}
smoothing: {extension: odd}
search: {cost: transitions}
"""


@dataclass(frozen=True)
class Tour:
    """A mission file and the triangles that a run goes through: those with these labels, in turn."""

    content: bytes
    regions: tuple[str, ...]
    recurrent: bool = False


PAPER_TOUR = Tour(PAPER, ("S2", "S1", "R"))
SURVEY_TOUR = Tour(SURVEY, ("base", "north_field", "orchard", "pond", "base"))
PATROL_TOUR = Tour(SURVEY, ("base", "pond", "base"), recurrent=True)


@cache
def plan_of(tour: Tour) -> FlightPlan:
    """A plan with everything that the report reads; the certificate is made up, the rest is real."""
    spec = parse_mission(tour.content)
    partition, labelling = build_domain(spec)
    restricted = restricted_triangles(spec, labelling)
    states = _route(partition, [int(labelling.triangles_of(name)[0]) for name in tour.regions], restricted)
    if tour.regions == PAPER_TOUR.regions:
        states = [0, 8, 11, 12, 4, 5, 7, 3, 1, 5, 4, 12, 10]  # the paper's
    neighbours = partition.neighbours.tolist()
    moves = [1 + neighbours[a].index(b) for a, b in itertools.pairwise(states)]
    if tour.recurrent:
        run = Run((), tuple(states[:-1]), tuple(moves))
    else:
        run = Run(tuple(states[:-1]), (states[-1],), (*moves, 0))
    flight = spec.flight
    path = build_path(
        partition,
        run,
        start_m=spec.start.position_m if not tour.recurrent else partition.corners_m[states[0]].mean(axis=0),
        speed_m_s=flight.speed_m_s,
        final_stay_s=flight.final_stay_s,
    )
    curve = fit_legs(path.legs, 60, series_of(spec).extension)
    tube_m = flight.disturbance_m_s2 * flight.time_constant_s**2
    certificate = Certificate(
        holds=True,
        reason="every path in the tube satisfies the formula",
        where_s=None,
        where_m=None,
        knots_s=np.array([0.0, path.duration_s]),
        possible=(tuple(states),),
        word=tuple(labelling.label(state) for state in states),
        clearance_m=0.25,
        tube_m=tube_m,
        frequencies=curve.frequencies,
    )
    return FlightPlan(
        spec=spec,
        start_m=spec.start.position_m,
        partition=partition,
        labelling=labelling,
        required=Specification(parse_formula(spec.formula)),
        product_states=partition.size * 3,
        product_states_reachable=partition.size,
        shortest_runs=4,
        best_in_any_order=True,
        run_index=0,
        run=run,
        costs=(float(len(run.prefix)), float(len(run.suffix))),
        path=path,
        stops=(),
        trajectory=trajectory_of(spec, curve, (), path.repeated_leg),
        certificate=certificate,
    )


def flight_of(plan: FlightPlan, *, error_m: FloatArray | None = None, reports: int = 400) -> tuple[bytes, FloatArray]:
    """A record of flying a plan with given errors, shape (reports, 2), and the positions that were reported."""
    duration = plan.trajectory.duration_s
    times = np.linspace(0.0, duration, reports)
    asked, velocity, acceleration = plan.trajectory.state(times)
    phase = np.linspace(0.0, 40.0, reports)
    wave = 0.5 * plan.certificate.tube_m * np.stack((np.sin(phase), np.cos(phase)), axis=-1)
    flown = asked + (wave if error_m is None else error_m)
    height, begin = plan.trajectory.altitude_m, 12.0
    stream = io.BytesIO()
    record = FlightRecord(stream, mission=plan.spec.name)
    record.write("vehicle", 0.5, autopilot="ArduPilot", system_id=1)
    record.write("event", 1.0, name="armed")
    record.write("telemetry", 2.0, position_m=[*asked[0], 0.0], velocity_m_s=[0, 0, 0], attitude_rad=[0, 0, 0])
    for k, t in enumerate(times):
        record.write(
            "setpoint",
            begin + t,
            position_m=[*asked[k], height],
            velocity_m_s=[*velocity[k], 0.0],
            acceleration_m_s2=[*acceleration[k], 0.0],
            yaw_rad=0.0,
            trajectory_s=t,
        )
        attitude = [acceleration[k, 0] / 9.81, -acceleration[k, 1] / 9.81, 0.0]
        record.write(
            "telemetry",
            begin + t,
            position_m=[*flown[k], height],
            velocity_m_s=[*velocity[k], 0.0],
            attitude_rad=attitude,
        )
    for segment in fields_of(plan).segments:
        label = plan.labelling.label(segment.triangle)
        record.write("visit", begin + segment.start_s, triangle=segment.triangle, labels=label)
    record.write("text", begin + duration, severity=4, text="<script>alert('wind')</script>")
    record.write("verdict", begin + duration, achieved=True, reason="the word satisfies the formula")
    return stream.getvalue(), flown


def record_of(plan: FlightPlan) -> Record:
    """The record of a flight of a plan."""
    return parse_record(flight_of(plan)[0])


def _route(
    partition: Partition, goals: Sequence[int], blocked: np.ndarray[tuple[int], np.dtype[np.bool_]]
) -> list[int]:
    route = [goals[0]]
    for goal in goals[1:]:
        came_from: dict[int, int] = {route[-1]: -1}
        queue = deque([route[-1]])
        while queue:
            here = queue.popleft()
            for there in partition.neighbours[here].tolist():
                if there >= 0 and not blocked[there] and there not in came_from:
                    came_from[there] = here
                    queue.append(there)
        leg = [goal]
        while came_from[leg[-1]] >= 0:
            leg.append(came_from[leg[-1]])
        route += leg[-2::-1]
    return route
