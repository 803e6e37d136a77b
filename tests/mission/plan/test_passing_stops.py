"""Stops where the way leads through a region to loiter in, though the mission does not need the visit."""

import pytest

from mission.plan import plan_to_json
from mission.verify.plans import claims
from tests.support.small_missions import FIELDS, FLOWN_BRISKLY, plan_of

THROUGH = """\
domain:
  boundary: [[0, 0], [90, 0], [90, 30], [0, 30]]
regions:
  home: {{kind: home, polygon: [[4, 10], [16, 10], [16, 20], [4, 20]], loiter_s: 1}}
  gate: {{kind: survey, polygon: [[28, 0], [44, 0], [44, 30], [28, 30]], loiter_s: 2}}
  goal: {{kind: survey, polygon: [[70, 10], [84, 10], [84, 20], [70, 20]]}}
mission:
  formula: {formula}
  laps: 2
start:
  position_m: [10, 15]
"""


@pytest.mark.parametrize(
    ("formula", "stays"),
    [
        ("F goal", [2.0]),  # the gate is on the way, and no part of the formula
        ("F (gate xor goal) & F G home", [2.0, 1.0]),  # either will do: no region is common to all places that are good
        ("F (goal & F G home)", [2.0, 2.0, 1.0]),
        ("G F goal & G F home", [2.0, 2.0, 1.0]),
    ],
)
def test_each_visit_has_a_stop_whatever_it_is_good_for(formula: str, stays: list[float]) -> None:
    plan = plan_of(THROUGH.format(formula=formula) + FLOWN_BRISKLY)
    assert not plan.instead
    assert [seconds for _, seconds in plan.stops] == stays
    assert [claim.fault for claim in claims(plan_to_json(plan), "plan.json") if claim.fault] == []


def test_fields_stop_there_as_well() -> None:
    plan = plan_of(THROUGH.format(formula="F goal") + FLOWN_BRISKLY + FIELDS)
    assert [seconds for _, seconds in plan.stops] == [2.0]
    assert [claim.fault for claim in claims(plan_to_json(plan), "plan.json") if claim.fault] == []
