"""What bounds in seconds cost: the time to plan the survey with some of them, beside that without."""

import time
from dataclasses import replace

import pytest

from mission.errors import LateError
from mission.plan import plan_mission
from mission.spec.loader import load_mission
from tests.support.commands import MISSIONS

pytestmark = pytest.mark.bench

CASES = {
    "without": "",
    "three bounds, kept by the best run": " & F[0,60] S1 & F[0,90] S2 & F[0,120] S3",
    "and a region that opens, with a wait": " & F[0,60] S1 & F[0,90] S2 & F[0,120] S3 & G[0,20] !S1",
    "three bounds, kept in another order": " & F[0,25] S3 & F[0,90] S2 & F[0,120] S1",
    "nested": " & G (S1 -> F[0,40] S2) & G (S2 -> G[0,5] !S1)",
    "three bounds, which no flight keeps": " & F[0,14] S1 & F[0,90] S2 & F[0,120] S3",
    "three bounds, which no plan is found to keep": " & F[0,15] S1 & F[0,90] S2 & F[0,120] S3",
}
FLOWN = 3


def test_planning_with_bounds() -> None:
    spec = load_mission(MISSIONS / "survey.yaml")
    print("\n| survey | planned in, s of processor | margins, s |\n|---|---|---|")
    for name, more in CASES.items():
        took, margins = [], "refused"
        for _ in range(FLOWN):
            began = time.process_time()
            try:
                plan = plan_mission(replace(spec, formula=spec.formula + more))
                margins = ", ".join(f"{bound.margin_s:.1f}" for bound in plan.bounds)
            except LateError:
                pass
            took.append(time.process_time() - began)
        print(f"| {name} | {min(took):.2f} | {margins} |")
