"""Plans beside regions that move, whose triangles are named by looking at many moments."""

from dataclasses import replace
from functools import cache
from itertools import groupby, pairwise

import numpy as np
import shapely

from mission.geometry.moving import MovingPartition
from mission.plan import FlightPlan, plan_mission
from mission.planning.run import Run
from mission.spec.model import MissionSpec
from tests.support.drifting_missions import drifting

_SLOW = "{velocity_m_s: [0, 0.5], until_s: 20}"
_BESIDE_S = 0.05
_MORE_M = 0.02


def standing(spec: MissionSpec) -> MissionSpec:
    """The mission with everything where it is drawn."""
    return replace(spec, regions=tuple(replace(region, motion=None) for region in spec.regions))


@cache
def drifting_plan(motion: str = _SLOW, formula: str = "F (S1 & F G home)") -> FlightPlan:
    """The plan of the mission in which K stands, said to be one in which it moves."""
    return moved(plan_mission(standing(drifting(formula))), drifting(formula, motion))


def moved(plan: FlightPlan, spec: MissionSpec) -> FlightPlan:
    """A plan with the mission in which something moves, and with what is then met, as far as many moments tell."""
    plan = replace(plan, spec=spec)
    assert plan.moving is not None
    knots, flown = plan.certificate.knots_s, plan.trajectory
    sets, half_m, least_m = [], plan.certificate.tube_m + _MORE_M, np.inf
    for begin, end in zip(knots[:-1].tolist(), knots[1:].tolist(), strict=True):
        reached, left = float(flown.time_at(begin)[0]), float(flown.time_at(end, leaving=True)[0])
        times = np.unique(np.clip([reached - _BESIDE_S, *np.linspace(reached, left, 5), left + _BESIDE_S], 0.0, None))
        met = set[int]()
        for place, time_s in zip(flown.position(np.clip(times, reached, left)), times.tolist(), strict=True):
            triangles = shapely.polygons(plan.moving.at(time_s).corners_m)
            square = shapely.box(*(place - half_m), *(place + half_m))
            met |= set(np.flatnonzero(shapely.intersects(triangles, square)).tolist())
            least_m = min(least_m, shapely.distance(triangles[plan.restricted], shapely.Point(place)).min())
        sets.append(tuple(sorted(met)))
    certificate = replace(plan.certificate, possible=tuple(sets), clearance_m=0.99 * float(least_m))
    return replace(plan, certificate=certificate, run=_run(plan, plan.moving))


def _run(plan: FlightPlan, moving: MovingPartition) -> Run:
    """The triangles that the vehicle is in, one after the other."""
    times = np.linspace(0.0, plan.trajectory.duration_s, 1601)
    points = moving.pulled_back(times, plan.trajectory.position(times))
    places = [(float(x), float(y)) for x, y in points]
    passed = [triangle for p, q in pairwise(places) for triangle, _ in plan.locator.crossed(p, q)]
    states = [triangle for triangle, _ in groupby(passed)]
    across = moving.fixed.neighbours.tolist()
    controls = [1 + across[here].index(there) for here, there in pairwise(states)]
    return Run(tuple(states[:-1]), tuple(states[-1:]), (*controls, 0))
