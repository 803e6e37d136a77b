"""Plans of flights by the field on maps that move: their run, its path in space, and what moves too fast."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from mission.errors import NoPlanError
from mission.plan import FlightPlan, plan_mission
from mission.plan.carried import carried_path
from mission.plan.definitions import fields_of_run
from mission.plan.policy import policy_of
from mission.spec.model import FIELD, MissionSpec
from tests.support.carried_plans import drifting_by_field
from tests.support.drifting_missions import drifting
from tests.support.drifting_plans import standing


def by_field(spec: MissionSpec, limit_m_s: float = 8.0) -> FlightPlan:
    flight, limits = replace(spec.flight, guidance=FIELD), replace(spec.limits, speed_m_s=limit_m_s)
    return plan_mission(replace(spec, flight=flight, limits=limits))


@cache
def drifting_off() -> FlightPlan:
    return by_field(drifting("F (S1 & F G home) & G !K", "{velocity_m_s: [0, -0.3], until_s: 20}"))


def test_the_path_of_its_fields_goes_through_the_triangles_of_its_run() -> None:
    plan = drifting_off()
    assert plan.certificate.holds
    path = carried_path(plan)
    times = np.linspace(0.0, path.duration_s, 4001)
    position, velocity, _ = path.state(times)
    passed = plan.locator.triangle_at(path.moving.pulled_back(times, position))
    passed = passed[np.flatnonzero(np.append(True, np.diff(passed)))]
    left = iter(plan.run.states)  # one that is passed within a step is not seen
    assert all(triangle in left for triangle in passed.tolist())
    assert len(passed) > 0.8 * len(plan.run.states)
    assert np.linalg.norm(velocity, axis=1).max() <= 8.0
    assert policy_of(plan).possible[:, ~plan.restricted].any(axis=0).all()


def test_what_moves_faster_than_the_vehicle_may_fly_is_refused() -> None:
    moves = "{velocity_m_s: [0, 4.3], from_s: 18, until_s: 28}"
    told = r"triangle \d+, .* too fast: from 18.0 s on its corner that is \(64, 12\) m .* at 4.3 m/s, and .* is 4.2$"
    with pytest.raises(NoPlanError, match=told):
        by_field(drifting("F (K & F G home)", moves, "survey"), limit_m_s=4.2)


def test_each_of_its_fields_tells_what_holds_at_any_time() -> None:
    plan = drifting_off()
    assert plan.moving is not None
    deformed = np.asarray(plan.moving.moves[plan.partition.triangles].any(axis=1))
    fields = fields_of_run(plan)
    assert deformed[[field.triangle for field in fields]].any()
    for field in fields:
        assert field.in_motion is not None
        drawn = min(each.margin_m_s for each in field.conditions)
        if deformed[field.triangle]:
            assert 0.0 < field.in_motion.margin_m_s <= drawn * (1.0 + 1e-9)
        else:
            assert tuple(field.in_motion) == pytest.approx((drawn, plan.spec.flight.speed_m_s))
    assert all(field.in_motion is None for field in fields_of_run(replace(plan, spec=standing(plan.spec))))


def test_ways_that_become_narrow_at_some_time_count_as_longer() -> None:
    """K comes to rest 2 m below the boundary: what leads through there was wide before."""
    plan = drifting_by_field(motion="{velocity_m_s: [0, 2], until_s: 30}")
    assert plan.moving is not None
    drawn, drifts = (
        policy_of(each).moves.system.weights[:, 1:] for each in (replace(plan, spec=standing(plan.spec)), plan)
    )
    assert (drifts >= drawn).all()
    corners = plan.moving.at(30.0).corners_m
    middles = (np.roll(corners, -1, axis=1) + np.roll(corners, -2, axis=1)) / 2.0
    across = plan.partition.neighbours
    above = (np.abs(middles - [72.0, 89.0]) < [8.0, 0.9]).all(axis=2) & (across >= 0)
    above &= ~plan.restricted[across] & ~plan.restricted[:, None]
    assert above.sum() >= 6
    assert (drifts > 1.5 * drawn)[above].all()
