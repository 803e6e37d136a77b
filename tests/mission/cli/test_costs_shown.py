"""What `mission plan` says of the cost that the search minimised."""

import json
from pathlib import Path

import pytest

from mission.plan.costs import MEASURED
from mission.spec.model import Cost
from tests.support.commands import ran
from tests.support.small_missions import SMALL


@pytest.mark.parametrize("cost", list(Cost))
def test_a_plan_says_what_its_cost_measures(cost: Cost, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """The path that is flown is another figure, which stands above."""
    file = tmp_path / "small.yaml"
    file.write_text(f"{SMALL}search: {{cost: {cost}}}\n", encoding="utf-8")
    assert json.loads(ran(capsys, "plan", str(file), "--json").out)["cost_measures"] == MEASURED[cost]
    shown = " ".join(ran(capsys, "plan", str(file)).out.split())
    assert shown.index("Path ") < shown.index("Best runs ")
    assert (f"({MEASURED[cost]}; what is flown is the path above)" in shown) == (cost is not Cost.TRANSITIONS)
