"""``-``: a mission on standard input is one like any other."""

import io
import json
import sys
from pathlib import Path

import pytest

from mission.cli.flight_folder import begin_folder
from mission.cli.inputs import planned
from mission.clock import WallClock
from mission.plan import plan_to_json
from tests.support.commands import MISSIONS, ran
from tests.support.small_missions import SMALL, plan_of

BROKEN = SMALL.replace("F (goal & F G home)", "F (goal && & F G home)")


def given(text: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(sys, "stdin", io.TextIOWrapper(io.BytesIO(text.encode())))


def test_every_command_takes_it(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    given(SMALL, monkeypatch)
    assert ran(capsys, "check", "-").out.startswith("standard input: sound; ")
    summary = json.loads(ran(capsys, "plan", "-", "--json", "--altitude", "9").out)
    assert summary["name"] == "Small round"
    written = tmp_path / "plan.json"
    written.write_text(plan_to_json(plan_of(SMALL)), encoding="utf-8")
    assert ran(capsys, "verify", str(written), "--mission", "-").code == 0
    exported = str(tmp_path / "small.kml")
    assert ran(capsys, "export", "-", "--to", exported, "--at", "47.4,8.5").code == 0
    assert ran(capsys, "simulate", "-", "--no-pictures").code == 0


def test_its_faults_have_their_place_and_their_line(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    given(BROKEN, monkeypatch)
    for command in (["check", "-"], ["plan", "-"], ["plan", "-", "--altitude", "9"]):
        refused = ran(capsys, *command)
        assert refused.code == 2
        place, excerpt, caret = refused.err.splitlines()[:3]
        assert place.startswith("standard input:9:23: ")
        assert "formula: F (goal && & F G home)" in excerpt
        assert caret.strip().endswith("^")


def test_nothing_on_it_is_said(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    given("", monkeypatch)
    refused = ran(capsys, "check", "-")
    assert (refused.code, refused.out) == (2, "")
    assert refused.err.startswith("standard input:")


def test_files_that_it_names_are_beside_where_the_program_runs(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    for name in ("pairs.hoa", "pairs.yaml"):
        (tmp_path / name).write_bytes((MISSIONS / name).read_bytes())
    given((MISSIONS / "pairs.yaml").read_text(encoding="utf-8"), monkeypatch)
    monkeypatch.chdir(tmp_path)
    assert ran(capsys, "check", "-").code == 0


def test_a_flight_keeps_it_as_it_was(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    given(SMALL, monkeypatch)
    with begin_folder(tmp_path, planned("-"), Path("-"), WallClock()) as folder:
        assert folder.path.name.startswith("mission-")
        assert (folder.path / "mission.yaml").read_text(encoding="utf-8") == SMALL
