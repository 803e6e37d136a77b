"""Flights with a heading of their own, in lock-step: where the vehicle's nose really is."""

import io
import math
from dataclasses import replace
from itertools import product

import numpy as np

from mission.fly import fly
from mission.plan import plan_mission
from mission.report.reading import parse_record
from mission.report.record import FlightRecord
from mission.report.tracking import tracking_of
from mission.spec.heading import Heading, Look
from mission.spec.loader import parse_mission
from tests.support.lockstep import LockstepVehicle, vehicle_of
from tests.support.small_missions import SMALL
from tests.support.usual_cases import sampled
from vehicle_sim.parameters import Flavour

CENTRE_M = np.array([31.0, 8.0])
"""Of the goal."""
TOWARD, FIXED, AHEAD = (
    Heading(Look.TOWARD, region="goal"),
    Heading(Look.FIXED, math.radians(-100.0)),
    Heading(Look.AHEAD),
)


@sampled(
    ("flavour", "heading"),
    product(Flavour, (TOWARD, FIXED, AHEAD)),
    [(Flavour.PX4, TOWARD), (Flavour.ARDUPILOT, FIXED), (Flavour.PX4, AHEAD)],
    ids=lambda case: f"{case[0]}-{case[1].look}",
)
def test_the_nose_is_where_the_mission_says(flavour: str, heading: Heading) -> None:
    spec = parse_mission(SMALL.encode())
    plan = plan_mission(replace(spec, flight=replace(spec.flight, heading=heading)))
    vehicle, sink = LockstepVehicle(vehicle_of(flavour, 4)), io.BytesIO()
    result = fly(plan, vehicle, vehicle, FlightRecord(sink, mission="small"))
    assert result.achieved, result.reason
    assert result.began_s is not None
    tracking = tracking_of(parse_record(sink.getvalue()))
    yaw, place, elapsed = tracking.attitude_rad[:, 2], tracking.position_m, tracking.trajectory_s
    if heading.look is Look.FIXED:
        wanted, counts = np.full(len(yaw), heading.fixed_rad), elapsed > 0.0
    elif heading.look is Look.TOWARD:
        away = CENTRE_M - place
        wanted, counts = np.arctan2(away[:, 0], away[:, 1]), np.hypot(away[:, 0], away[:, 1]) > 2.0
    else:
        velocity = plan.trajectory.velocity(elapsed)
        wanted, counts = np.arctan2(velocity[:, 0], velocity[:, 1]), np.hypot(velocity[:, 0], velocity[:, 1]) > 0.1
    off = np.abs((yaw - wanted + math.pi) % (2.0 * math.pi) - math.pi)
    assert counts.sum() > 50
    assert math.degrees(off[counts].max()) < 8.0
    assert math.degrees(float(np.sqrt((off[counts] ** 2).mean()))) < 3.0
