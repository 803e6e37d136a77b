"""Where the first of the shortest runs cannot be proved, another one is flown, and the plan says so."""

import json
from collections.abc import Callable, Iterator
from dataclasses import replace
from itertools import islice
from pathlib import Path

import pytest

from mission.cli import main
from mission.errors import NoPlanError
from mission.plan import FlightPlan, plan_from_json, plan_mission, plan_to_json, shortest_runs
from mission.plan import proved_run as module
from mission.plan.proved_run import spread_from
from mission.spec.loader import load_mission
from mission.spec.model import MissionSpec
from tests.support.proofs import untrue
from tests.support.steered_plans import BY_FIELDS

# Some of the shortest runs squeeze past a region between it and the border.
NARROW = (
    """\
domain:
  nodes: [[0, 0], [32, 0], [32, 48], [0, 48],
    [2, 2], [12, 2], [12, 12], [2, 12],
    [2, 16], [14, 16], [14, 28], [2, 28],
    [18, 16], [30, 16], [30, 28], [18, 28],
    [2, 32], [14, 32], [14, 44], [2, 44],
    [18, 32], [30, 32], [30, 44], [18, 44]]
regions:
  home: {kind: home, polygon: [[2, 2], [12, 2], [12, 12], [2, 12]]}
  south: {kind: survey, polygon: [[2, 16], [14, 16], [14, 28], [2, 28]]}
  east: {kind: survey, polygon: [[18, 16], [30, 16], [30, 28], [18, 28]]}
  west: {kind: survey, polygon: [[2, 32], [14, 32], [14, 44], [2, 44]]}
  north: {kind: survey, polygon: [[18, 32], [30, 32], [30, 44], [18, 44]]}
tasks:
  - strict_ordered_visit: [west, south, north, east]
start:
  position_m: [5, 5]
flight: {disturbance_m_s2: 0.3}
"""
    + BY_FIELDS
)


@pytest.fixture(scope="module")
def file(tmp_path_factory: pytest.TempPathFactory) -> Path:
    written = tmp_path_factory.mktemp("narrow") / "narrow.yaml"
    written.write_text(NARROW, encoding="utf-8")
    return written


@pytest.fixture(scope="module")
def spec(file: Path) -> MissionSpec:
    return load_mission(file)


@pytest.fixture(scope="module")
def squeezing(spec: MissionSpec) -> tuple[int, int]:
    """Two runs that squeeze past and are not proved; no order of the search is relied on."""
    plan = plan_mission(spec)
    partition = plan.partition
    gap = partition.vertices_m[partition.triangles].mean(axis=1)[:, 0] < 2.0
    through = [number for number, run in enumerate(shortest_runs(plan)) if gap[list(run.states)].any()]
    assert len(through) < plan.shortest_runs
    one, other = islice((number for number in reversed(through) if not _proved(spec, number)), 2)
    return one, other


def _proved(spec: MissionSpec, number: int) -> bool:
    try:
        return plan_mission(spec, run=number).certificate.holds
    except NoPlanError:
        return False


def _first_of(numbers: tuple[int, ...]) -> Callable[[int], int]:
    return lambda number: numbers.index(number) if number in numbers else len(numbers)


@pytest.fixture(scope="module", autouse=True)
def squeezing_first(squeezing: tuple[int, int]) -> Iterator[None]:
    with pytest.MonkeyPatch.context() as patched:
        patched.setattr(
            module,
            "spread_from",
            lambda index, count: iter(sorted(range(count), key=_first_of(squeezing)) if index == 0 else (index,)),
        )
        yield


@pytest.fixture(scope="module")
def plan(spec: MissionSpec, squeezing_first: None) -> FlightPlan:  # noqa: ARG001 - it has effect
    return plan_mission(spec)


def test_another_run_is_flown_where_the_first_is_not_proved(plan: FlightPlan, squeezing: tuple[int, int]) -> None:
    assert not untrue(plan)
    runs = shortest_runs(plan)
    assert plan.run_index not in squeezing
    assert plan.run == runs[plan.run_index]
    # The other that squeezes past is left for last.
    assert [run.index for run in plan.passed_over] == [squeezing[0]]
    assert "may spell the word home" in plan.passed_over[0].reason
    (warning,) = plan.warnings
    assert warning.startswith(f"run {plan.run_index} of the {runs.count} shortest is flown; run {squeezing[0]} was")
    assert plan.passed_over[0].reason in warning


def test_a_run_that_was_asked_for_is_flown_or_refused(
    plan: FlightPlan, spec: MissionSpec, squeezing: tuple[int, int]
) -> None:
    assert plan_mission(spec, run=plan.run_index).passed_over == ()
    with pytest.raises(NoPlanError, match="no smoothing with up to 1024 frequencies"):
        plan_mission(spec, run=squeezing[-1])
    with pytest.raises(NoPlanError, match="no smoothing with up to 1024 frequencies"):
        plan_mission(replace(spec, run=squeezing[-1]))


def test_what_was_passed_over_is_written_and_proved_again(
    plan: FlightPlan, file: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    again = plan_from_json(plan_to_json(plan))
    assert again.passed_over == plan.passed_over
    assert again.asked_run is None
    assert replace(plan, passed_over=()).asked_run == (plan.run_index or None)
    written = tmp_path / "plan.json"
    assert main(["plan", str(file), "--json", "--out", str(written)]) == 0
    printed = json.loads(capsys.readouterr().out)
    assert [run["index"] for run in printed["runs_passed_over"]] == [run.index for run in plan.passed_over]
    assert main(["verify", str(written)]) == 0


def test_where_none_is_proved_the_first_says_why(spec: MissionSpec, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(module, "MOST_OTHERS", 2)
    wide = replace(spec, flight=replace(spec.flight, disturbance_m_s2=1.9))
    with pytest.raises(NoPlanError, match=r"no smoothing.*; nor is any of 2 others of the \d+ runs that are as short"):
        plan_mission(wide)


@pytest.mark.parametrize(("index", "count"), [(0, 1), (0, 2), (3, 7), (5, 64), (0, 100)])
def test_numbers_are_spread_and_each_comes_once(index: int, count: int) -> None:
    numbers = list(spread_from(index, count))
    assert numbers[0] == index
    assert sorted(numbers) == list(range(count))
    assert numbers[1:2] == [(index + count // 2) % count][: count - 1]


def test_numbers_are_spread_over_any_count() -> None:
    assert list(islice(spread_from(0, 10**30), 4)) == [0, 10**30 // 2, 10**30 // 4, 3 * 10**30 // 4]
