"""What the commands say of a mission that names an automaton."""

import json
from pathlib import Path

import pytest

from mission.cli.flight_folder import begin_folder
from mission.clock import WallClock
from mission.plan import plan_mission
from mission.report.page import page
from mission.report.summary import summary
from mission.spec.loader import load_mission
from tests.support.commands import MISSIONS, ran

PAIRS = MISSIONS / "pairs.yaml"
HOA = (MISSIONS / "pairs.hoa").read_text(encoding="utf-8")


def beside(folder: Path, mission: str, automaton: str) -> str:
    (folder / "mine.yaml").write_text(mission, encoding="utf-8")
    (folder / "pairs.hoa").write_text(automaton, encoding="utf-8")
    return str(folder / "mine.yaml")


def test_check_and_plan_name_it(capsys: pytest.CaptureFixture[str]) -> None:
    checked = ran(capsys, "check", str(PAIRS))
    assert (checked.code, checked.err) == (0, "")
    assert checked.out.splitlines()[1:] == [
        "  tube  0.8 m per axis: 0.8 m for disturbances of 0.8 m/s²",
        "  automaton  pairs.hoa",
    ]
    shown = ran(capsys, "plan", str(PAIRS))
    assert (shown.code, shown.err) == (0, "")
    assert shown.out.splitlines()[:2] == ["Loads in pairs", "  automaton  pairs.hoa"]
    assert "A  6 states, 14 edges, deterministic" in shown.out


def test_tasks_beside_it_are_shown_with_it(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    file = beside(tmp_path, PAIRS.read_text(encoding="utf-8") + "tasks:\n  - avoid: barn\n", HOA)
    shown = ran(capsys, "plan", file)
    assert shown.out.splitlines()[1:4] == ["  task       avoid barn", "  automaton  pairs.hoa", "  formula    G !barn"]
    assert json.loads(ran(capsys, "plan", file, "--json").out)["formula"] == "automaton pairs.hoa, and G !barn"


def test_a_written_plan_is_verified_without_the_file(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    file = beside(tmp_path, PAIRS.read_text(encoding="utf-8"), HOA)
    plan = tmp_path / "plan.json"
    result = ran(capsys, "plan", file, "--json", "--out", str(plan))
    assert json.loads(result.out)["automaton_file"] == "pairs.hoa"
    (tmp_path / "pairs.hoa").unlink()
    verified = ran(capsys, "verify", str(plan))
    assert (verified.code, verified.err) == (0, "")
    assert "of the trajectory satisfies automaton pairs.hoa\n" in verified.out


def test_an_automaton_without_a_plan_is_a_refusal(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    mission = PAIRS.read_text(encoding="utf-8").replace("depot: {kind: survey", "depot: {kind: restricted")
    file = beside(tmp_path, mission, HOA)
    result = ran(capsys, "plan", file)
    assert (result.code, result.out) == (3, "")
    assert result.err == (
        f"{file}: error: these contradict each other:\n"
        "    automaton pairs.hoa\n    depot is restricted: it is never entered\n"
    )


def test_the_folder_of_a_flight_and_its_report_have_the_automaton(tmp_path: Path) -> None:
    plan = plan_mission(load_mission(PAIRS))
    kept = begin_folder(tmp_path, plan, PAIRS, WallClock())
    kept.close()
    assert load_mission(kept.path / "mission.yaml") == plan.spec
    shown = page(plan, None, summary(plan, None), [])
    assert "<pre>automaton pairs.hoa</pre>" in shown
    assert "<summary>Automaton pairs.hoa</summary><pre>HOA: v1\n" in shown
