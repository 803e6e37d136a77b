"""Flights by the field among triangles that move: a restricted region drifts into the way, and is gone round."""

import io
from dataclasses import replace
from functools import cache

import numpy as np
import pytest
import shapely

from mission.fly import fly
from mission.fly.result import Progress
from mission.link.ending import Ending
from mission.monitor.stage import Stage
from mission.plan import FlightPlan, plan_mission
from mission.report.record import FlightRecord
from mission.spec.loader import parse_mission
from tests.support.drifting_plans import standing
from tests.support.lockstep import LockstepVehicle, vehicle_of

START_M = (8.0, 18.0)
DRIFTS_INTO_THE_WAY = b"""\
domain:
  boundary: [[0, 0], [56, 0], [56, 36], [0, 36]]
  mesh: {largest_m: 14}
regions:
  home: {kind: home, polygon: [[3, 13], [13, 13], [13, 23], [3, 23]]}
  S1: {kind: survey, polygon: [[43, 13], [53, 13], [53, 23], [43, 23]]}
  K: {kind: restricted, polygon: [[24, 3], [32, 3], [32, 10], [24, 10]], motion: {velocity_m_s: [0, 0.8], until_s: 15}}
mission: {formula: F (S1 & F G home) & G !K}
start: {position_m: [8, 18]}
flight: {guidance: field, speed_m_s: 4, altitude_m: 6, time_constant_s: 1.0, disturbance_m_s2: 0.3, final_stay_s: 1}
limits: {speed_m_s: 6, acceleration_m_s2: 2.5, tilt_deg: 25}
"""


@cache
def plan() -> FlightPlan:
    spec = parse_mission(DRIFTS_INTO_THE_WAY)
    return replace(plan_mission(standing(spec)), spec=spec)


class Flown:
    """A flight in lock-step, and where it truly was."""

    def __init__(self, flavour: str) -> None:
        self.began_s: float | None = None
        self.track: list[tuple[float, float, float]] = []
        self.vehicle = LockstepVehicle(vehicle_of(flavour, drag_per_s=0.1), at_step=self.watch)
        record = FlightRecord(io.BytesIO(), mission="drifting")
        self.result = fly(plan(), self.vehicle, self.vehicle, record, on_progress=self.look)

    def look(self, progress: Progress) -> None:
        if progress.stage is Stage.FLY and self.began_s is None:
            self.began_s = self.vehicle.now_s()

    def watch(self, lockstep: LockstepVehicle) -> None:
        if self.began_s is not None and lockstep.vehicle.steps % 20 == 0:
            north, east, _ = lockstep.vehicle.truth.position_ned_m
            self.track.append((lockstep.now_s() - self.began_s, START_M[0] + east, START_M[1] + north))

    def nearest_m(self, at_s: float | None = None) -> float:
        """How near the flight came to where K was then, or is at some time."""
        moving = plan().moving
        assert moving is not None
        times, *places = np.array(self.track).T
        inside = np.tile(plan().labelling.triangles_of("K"), (len(times), 1))
        corners = [
            moving.corners_at(times if at_s is None else np.full(len(times), at_s), triangles) for triangles in inside.T
        ]
        return float(min(shapely.distance(shapely.polygons(each), shapely.points(*places)).min() for each in corners))


@pytest.mark.parametrize("flavour", ["ardupilot", "px4"])
def test_a_region_that_drifts_into_the_way_is_gone_round(flavour: str) -> None:
    flown = Flown(flavour)
    assert flown.result.ending is Ending.LANDED
    assert flown.result.achieved, flown.result.reason
    assert flown.nearest_m() > 0.3
    assert flown.nearest_m(at_s=15.0) == 0.0  # on the way out it flew where K drifted to later
