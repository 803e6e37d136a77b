"""Where the file says so, the vehicle is slow wherever its tube may be in a region, and not for long elsewhere."""

import json
from dataclasses import replace

import numpy as np
import pytest
import shapely

from mission.geometry.regions import union_of
from mission.plan import plan_to_json
from mission.spec.document import document_of
from mission.spec.loader import parse_mission
from mission.verify.plans.flight import limits_kept
from mission.verify.plans.written import Written
from tests.support.small_missions import ROUNDS, SMALL, plan_of


@pytest.mark.parametrize(
    ("text", "speed_m_s"),
    [(SMALL, 0.7), (SMALL + "smoothing: corridor\n", 2.0), (ROUNDS + "smoothing: corridor\n", 1.2)],
)
def test_a_region_with_a_speed_is_flown_at_most_at_that(text: str, speed_m_s: float) -> None:
    plan = plan_of(text.replace("kind: home,", f"kind: home, speed_m_s: {speed_m_s},"))
    home = union_of(plan.partition, plan.labelling.triangles_of("home"))
    t = np.linspace(0.0, plan.trajectory.duration_s, 6001)
    places, velocity, _ = plan.trajectory.state(t)
    speeds = np.hypot(*velocity.T)
    half = plan.spec.flight.tube_m
    squares = shapely.box(*(places - half).T, *(places + half).T)
    inside = shapely.intersects(home, squares)
    assert speeds[inside].max() <= speed_m_s * (1.0 + 1e-9)
    assert speeds[inside].max() >= 0.8 * speed_m_s
    assert speeds[~inside].max() >= 3.0
    assert plan.trajectory.duration_s > plan_of(text).trajectory.duration_s
    # The checker finds so too, and where the mission asked for less.
    data = json.loads(plan_to_json(plan))
    assert limits_kept(Written(data, plan.spec))[0] is None
    asked = [
        replace(region, speed_m_s=0.9 * speed_m_s) if region.name == "home" else region for region in plan.spec.regions
    ]
    slower = Written(data, replace(plan.spec, regions=tuple(asked)))
    assert ("in home" in str(limits_kept(slower)[0])) == (speeds[inside].max() > 0.9 * speed_m_s)


def test_a_mission_keeps_the_speeds_of_its_regions_and_its_jerk() -> None:
    text = SMALL.replace("kind: home,", "kind: home, speed_m_s: 1.5,").replace("tilt_deg", "jerk_m_s3: 2.5\n  tilt_deg")
    spec = parse_mission(text.encode(), "a.yaml")
    assert spec.limits.jerk_m_s3 == 2.5
    assert {region.name: region.speed_m_s for region in spec.regions} == {"home": 1.5, "goal": None, "pond": None}
    again = parse_mission(json.dumps(document_of(spec)).encode(), "b.yaml")
    assert (again.regions, again.limits) == (spec.regions, spec.limits)
