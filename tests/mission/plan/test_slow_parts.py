"""Where the file says so, the vehicle is slow wherever its tube may be in a region, and not for long elsewhere."""

import json

import numpy as np
import pytest
import shapely

from mission.geometry.regions import union_of
from mission.spec.document import document_of
from mission.spec.loader import parse_mission
from tests.support.small_missions import ROUNDS, SMALL, plan_of


@pytest.mark.parametrize("text", [SMALL, SMALL + "smoothing: corridor\n", ROUNDS + "smoothing: corridor\n"])
@pytest.mark.parametrize("speed_m_s", [0.7, 2.0])
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


def test_a_mission_keeps_the_speeds_of_its_regions_and_its_jerk() -> None:
    text = SMALL.replace("kind: home,", "kind: home, speed_m_s: 1.5,").replace("tilt_deg", "jerk_m_s3: 2.5\n  tilt_deg")
    spec = parse_mission(text.encode(), "a.yaml")
    assert spec.limits.jerk_m_s3 == 2.5
    assert {region.name: region.speed_m_s for region in spec.regions} == {"home": 1.5, "goal": None, "pond": None}
    again = parse_mission(json.dumps(document_of(spec)).encode(), "b.yaml")
    assert (again.regions, again.limits) == (spec.regions, spec.limits)
