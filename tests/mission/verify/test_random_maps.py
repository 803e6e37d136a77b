"""Missions on maps of chance: each is planned, or refused with a reason, and the checker agrees with every plan."""

import numpy as np
import pytest
import shapely

from mission.errors import NoPlanError, SpecError
from mission.plan import plan_mission, plan_to_json
from mission.steering.rounding import rounded_within
from mission.verify.plans import claims
from tests.support.random_maps import random_mission
from tests.support.small_missions import plan_of

OVERLAPPING = """\
domain: {boundary: [[0, 0], [58, 0], [58, 39], [0, 39]]}
regions:
  a: {kind: area, polygon: [[12.3, 13.9], [14.1, 17.7], [10.7, 19.5], [7.9, 15.8]]}
  b: {kind: area, polygon: [[21.8, 17.3], [14.2, 19.1], [12.9, 10.9], [20.0, 9.6]]}
mission: {formula: F (a & F b)}
start: {position_m: [39.7, 7.8]}
"""
"""The two have so little in common that no tube fits into it: the way leads through it, and no path stays in it."""

ALONG_A_CORNER = """\
domain: {boundary: [[0, 0], [92.1, 0], [92.1, 32.7], [0, 32.7]]}
regions:
  a:
    kind: survey
    cover: {spacing_m: 3.3, heading_deg: 64.39}
    polygon: [[47.2, 26.4], [45.3, 29.8], [41.4, 29.4], [40.4, 25.8], [41.9, 22.4], [45.9, 22.9]]
  b: {kind: area, polygon: [[32.1, 5.8], [34.0, 9.6], [30.3, 10.9], [28.7, 7.9]]}
mission: {formula: F (a & F b)}
start: {position_m: [73.0, 21.3]}
flight: {speed_m_s: 3}
"""
"""Of one of its lanes rounding leaves less than a tenth of a millisecond."""


@pytest.mark.parametrize("seed", [*range(6), *(pytest.param(seed, marks=pytest.mark.long) for seed in range(6, 200))])
def test_a_plan_is_what_the_checker_says_it_is(seed: int) -> None:
    try:
        plan = plan_mission(random_mission(seed))
    except (NoPlanError, SpecError):
        return
    assert [claim for claim in claims(plan_to_json(plan)) if claim.fault] == []


def test_where_the_tube_does_not_fit_is_kept_out_of() -> None:
    plan = plan_of(OVERLAPPING)
    assert not plan.instead
    assert plan.avoidance is not None
    assert {plan.labelling.label(triangle) for triangle in plan.avoidance.closed} == {frozenset("ab")}
    assert "the tube does not fit into a & b" in plan.warnings[-1]
    assert plan.asked_run is None


def test_a_lane_of_a_moment_covers_its_place() -> None:
    plan = plan_of(ALONG_A_CORNER)
    (visit,) = plan.covers
    assert np.diff(visit.lanes_s).min() < 1e-4
    assert [claim for claim in claims(plan_to_json(plan)) if claim.fault] == []


def test_bends_that_nearly_meet_are_a_little_apart() -> None:
    """Of two bends at the second and third corner the first takes half of the way between them, and 1e-6 is left."""
    line = np.array([[0.0, 0.0], [10.0, 0.0], [10.0, 2.0], [20.0, 2.0]])
    widest = np.array([1.0, 1.0, 1.0 - 1e-6, 1.0])
    curve, _ = rounded_within(line, shapely.box(-1, -1, 21, 3), tolerance_m=0.0, widest_m=widest, speed_m_s=1.0)
    lasts_s = np.diff(curve.knots_s)
    assert lasts_s[lasts_s > 0.0].min() > 5e-3
    apart, _ = rounded_within(line, shapely.box(-1, -1, 21, 3), tolerance_m=0.0, widest_m=widest * 1.1, speed_m_s=1.0)
    assert (np.diff(apart.knots_s) == 0.0).any()
