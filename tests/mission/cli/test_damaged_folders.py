"""Folders of flights whose record or plans are damaged: each is refused in words."""

import json
from pathlib import Path

import pytest

from mission.cli.report import flight_in
from mission.errors import RecordError, SpecError
from mission.plan import FlightPlan, plan_to_json
from mission.report.record import FlightRecord
from tests.support.small_missions import SMALL, plan_of

LEG = {"name": "leg", "number": 2, "reason": "", "laps_before": 0}


@pytest.fixture(scope="module")
def small() -> FlightPlan:
    return plan_of(SMALL)


def folder_of(root: Path, plan: FlightPlan, *events: dict[str, object]) -> Path:
    """A flight's folder with these events in its record."""
    with FlightRecord.in_folder(root, "small") as record:
        for event in events:
            record.write("event", 1.0, **event)
    assert record.folder is not None
    (record.folder / "plan.json").write_text(plan_to_json(plan))
    (record.folder / "mission.yaml").write_text(SMALL)
    return record.folder


def test_a_later_plan_that_is_missing_is_named(small: FlightPlan, tmp_path: Path) -> None:
    with pytest.raises(SpecError, match=r"plan-2\.json is missing"):
        flight_in(folder_of(tmp_path, small, LEG))


@pytest.mark.parametrize(
    "event",
    [
        {"name": "leg"},
        LEG | {"number": 1},
        LEG | {"number": "two"},
        LEG | {"laps_before": [1]},
        {"name": "planned"},
        {"name": "planned", "start_m": [1]},
        {"name": "planned", "start_m": ["x", None]},
    ],
    ids=json.dumps,
)
def test_a_value_that_is_none_is_refused(small: FlightPlan, tmp_path: Path, event: dict[str, object]) -> None:
    with pytest.raises(RecordError):
        flight_in(folder_of(tmp_path, small, event))
