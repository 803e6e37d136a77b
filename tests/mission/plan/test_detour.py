"""Where no best run can be proved, a dearer one is flown, and the plan says what it avoids and what that costs."""

import json
from pathlib import Path

import pytest

from mission.cli import main
from mission.errors import NoPlanError
from mission.plan import FlightPlan, plan_from_json, plan_mission, plan_to_json, shortest_runs
from mission.plan.proved_path import PathPlanner
from mission.spec.loader import load_mission
from mission.spec.model import MissionSpec
from tests.support.proofs import untrue

# The short way leads through a gap that is narrower than the tube, between a wall and the border.
GAP = """\
domain:
  nodes: [[0, 0], [40, 0], [40, 30], [0, 30],
    [2, 2], [8, 2], [8, 8], [2, 8],
    [32, 2], [38, 2], [38, 8], [32, 8],
    [18, 0.8], [22, 0.8], [22, 22], [18, 22]]
regions:
  home: {kind: home, polygon: [[2, 2], [8, 2], [8, 8], [2, 8]]}
  field: {kind: survey, polygon: [[32, 2], [38, 2], [38, 8], [32, 8]]}
  wall: {kind: restricted, polygon: [[18, 0.8], [22, 0.8], [22, 22], [18, 22]]}
tasks:
  - visit: [field]
start:
  position_m: [5, 5]
flight: {disturbance_m_s2: 0.5}
smoothing: {frequencies: 128}
search: {cost: transitions}
"""


def _mission(folder: Path, text: str) -> Path:
    written = folder / "gap.yaml"
    written.write_text(text, encoding="utf-8")
    return written


@pytest.fixture(scope="module")
def file(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return _mission(tmp_path_factory.mktemp("gap"), GAP)


@pytest.fixture(scope="module")
def spec(file: Path) -> MissionSpec:
    return load_mission(file)


@pytest.fixture(scope="module")
def plan(spec: MissionSpec) -> FlightPlan:
    return plan_mission(spec)


def test_a_dearer_run_is_flown_where_no_best_one_is_proved(plan: FlightPlan) -> None:
    assert not untrue(plan)
    assert plan.avoidance is not None
    assert set(plan.avoidance.closed).isdisjoint(plan.run.states)
    assert plan.run == shortest_runs(plan)[plan.run_index]
    prefix, suffix = plan.avoidance.best_costs
    assert prefix + suffix < plan.run.cost
    (warning,) = plan.warnings
    assert plan.passed_over[0].reason in warning
    assert warning.endswith(
        f"without {plan.avoidance.listed} and costs {len(plan.run.prefix)} instead of {prefix:g} transitions "
        "up to the loop"
    )


def test_one_that_was_asked_for_is_flown_or_refused(spec: MissionSpec) -> None:
    with pytest.raises(NoPlanError) as refused:
        plan_mission(spec, run=0)
    assert "nor is" not in str(refused.value)


def test_what_was_avoided_is_written_and_planned_again(
    plan: FlightPlan, file: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert plan_from_json(plan_to_json(plan)).avoidance == plan.avoidance
    written = tmp_path / "plan.json"
    assert main(["plan", str(file), "--json", "--out", str(written)]) == 0
    assert plan.avoidance is not None
    printed = json.loads(capsys.readouterr().out)["avoidance"]
    assert [each["triangle"] for each in printed["triangles"]] == list(plan.avoidance.closed)
    assert main(["verify", str(written)]) == 0


def test_the_runs_that_are_listed_are_those_of_the_map_that_is_left(
    plan: FlightPlan, file: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["plan", str(file), "--runs", "3"]) == 0
    assert plan.avoidance is not None
    heading = next(line for line in capsys.readouterr().out.splitlines() if line.startswith("The first"))
    assert heading.endswith(f" without {plan.avoidance.listed}")


def test_where_nothing_is_proved_it_is_refused_after_few_tries(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    tried = []
    smoothed = PathPlanner.smoothed

    def counted(*arguments: object, **options: object) -> object:
        tried.append(1)
        return smoothed(*arguments, **options)  # type: ignore[arg-type]

    monkeypatch.setattr(PathPlanner, "smoothed", counted)
    # A gap at the other end of the wall, too.
    both = load_mission(_mission(tmp_path, GAP.replace("30]", "22.8]")))
    with pytest.raises(NoPlanError, match=r"may leave the domain.*; nor is a dearer one without triangles? \d"):
        plan_mission(both)
    assert len(tried) <= 15
