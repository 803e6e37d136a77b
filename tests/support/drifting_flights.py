"""Plans of missions in which something moves, made as if it stood still, for what watches flights and judges them."""

from dataclasses import replace
from functools import cache

import numpy as np
import shapely
from shapely.affinity import translate

from mission.plan import FlightPlan, plan_mission
from mission.spec.model import MissionSpec, NodesDomain
from mission.spec.moving import displacement_m
from tests.support.drifting_missions import DRIFT, drifting

K = shapely.box(64.0, 12.0, 80.0, 28.0)
"""The region of those missions that drifts, where it begins."""


def still(spec: MissionSpec) -> MissionSpec:
    """A mission in which nothing moves."""
    domain = replace(spec.domain, motions=()) if isinstance(spec.domain, NodesDomain) else spec.domain
    return replace(spec, domain=domain, regions=tuple(replace(region, motion=None) for region in spec.regions))


@cache
def planned_still(formula: str = "F (S1 & F G home)", motion: str = DRIFT, kind: str = "restricted") -> FlightPlan:
    """A plan that does not heed what moves in its mission."""
    spec = drifting(formula, motion, kind)
    return replace(plan_mission(still(spec)), spec=spec)


def k_at(spec: MissionSpec, time_s: float) -> shapely.Geometry:
    """Where K is at a time."""
    (motion,) = (region.motion for region in spec.regions if region.name == "K")
    assert motion is not None
    east, north = displacement_m(motion, np.array([time_s]))[0]
    return translate(K, east, north)


def walked(places: list[tuple[float, float]], speed_m_s: float, step_s: float) -> tuple[np.ndarray, np.ndarray]:
    """Times from 0 and places of who goes straight from place to place."""
    corners = np.array(places)
    lengths = np.concatenate(([0.0], np.cumsum(np.hypot(*np.diff(corners, axis=0).T))))
    times = np.arange(0.0, lengths[-1] / speed_m_s, step_s)
    ways = [np.interp(speed_m_s * times, lengths, axis) for axis in corners.T]
    return times, np.stack(ways, axis=1)
