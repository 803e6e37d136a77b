"""How much commands say, and their documents for programs."""

import json
from pathlib import Path
from typing import Any

import pytest

from mission.cli import fly
from mission.cli.narration import Narrated
from mission.cli.screen import err, out
from mission.errors import LinkError
from mission.plan import plan_to_json
from mission.report.record import FlightRecord
from tests.mission.cli.test_flight_lines import result_of
from tests.support.commands import MISSIONS, Ran, ran
from tests.support.small_missions import SMALL, plan_of

BROKEN = str(MISSIONS / "broken" / "formula_syntax.yaml")


@pytest.fixture
def file(tmp_path: Path) -> Path:
    path = tmp_path / "small.yaml"
    path.write_text(SMALL, encoding="utf-8")
    return path


@pytest.fixture
def written(tmp_path: Path) -> Path:
    path = tmp_path / "plan.json"
    path.write_text(plan_to_json(plan_of(SMALL)), encoding="utf-8")
    return path


@pytest.fixture
def folder(tmp_path: Path, written: Path, file: Path) -> Path:
    """Of a flight that was cut short on the ground."""
    with FlightRecord.in_folder(tmp_path, "small") as record:
        record.write("telemetry", 1.0, position_m=(9.0, 8.0, 0.0), velocity_m_s=(0.0, 0.0, 0.0), attitude_rad=None)
    assert record.folder is not None
    (record.folder / "plan.json").write_bytes(written.read_bytes())
    (record.folder / "mission.yaml").write_bytes(file.read_bytes())
    return record.folder


def flown(file: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], *options: str) -> Ran:
    came = fly._Flown(file.parent, heard=False, exit_code=0, result=result_of(plan_of(SMALL)))
    monkeypatch.setattr(fly, "_flown", lambda *_: came)
    monkeypatch.setattr(fly, "_report", lambda *_, **__: True)
    return ran(capsys, "fly", str(file), *options)


def test_quiet_says_only_what_is_wrong(
    file: Path, written: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    assert ran(capsys, "check", str(file), "-q") == (0, "", "")
    assert ran(capsys, "verify", str(written), "-q") == (0, "", "")
    assert flown(file, monkeypatch, capsys, "-q") == (0, "", "")
    wrong = ran(capsys, "check", str(file), BROKEN, "--quiet")
    assert (wrong.code, wrong.out) == (2, "")
    assert f"{BROKEN}:" in wrong.err
    assert "cannot be flown" not in wrong.err
    assert ran(capsys, "check", str(file)).out  # the next command speaks again
    assert not out.quiet
    assert not err.quiet


def test_check_gives_one_document_for_all_files(file: Path, capsys: pytest.CaptureFixture[str]) -> None:
    told = ran(capsys, "check", str(file), BROKEN, "--json")
    document = json.loads(told.out)
    assert told.code == document["exit_code"] == 2
    sound, broken = document["missions"]
    assert (sound["file"], sound["exit_code"], sound["plan"]["name"]) == (str(file), 0, "Small round")
    assert broken["exit_code"] == 2
    assert broken["faults"][0]["line"] > 0
    assert f"{BROKEN}:" in told.err
    assert "sound" not in told.err


@pytest.mark.parametrize("command", [["check"], ["fly"], ["verify"], ["report"], ["plan"], ["simulate"]])
def test_a_failure_is_a_document_too(command: list[str], tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    told = ran(capsys, *command, str(tmp_path / "nothing"), "--json")
    document = json.loads(told.out)
    failed = document["missions"][0] if command == ["check"] else document
    assert told.code == document["exit_code"] == failed["exit_code"] == 2
    assert failed["error"]
    assert failed["faults"][0]["hint"]


@pytest.mark.parametrize("command", [["verify"], ["report"], ["report", "q" * 300], ["check"], ["fly"]])
def test_what_the_system_refuses_is_a_document_too(command: list[str], capsys: pytest.CaptureFixture[str]) -> None:
    """A name that is longer than any can be."""
    result = ran(capsys, *command, "q" * 300, "--json")
    assert result.code == 2
    told = json.loads(result.out)
    assert told["exit_code"] == 2
    assert "too long" in str(told).lower()
    assert "too long" in result.err.lower()


def test_a_flight_is_a_document(
    file: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    told = flown(file, monkeypatch, capsys, "--json")
    document = json.loads(told.out)
    assert (told.code, told.err) == (0, "")
    assert {key: document[key] for key in ("mission", "exit_code", "achieved", "duration_s")} == {
        "mission": "Small round",
        "exit_code": 0,
        "achieved": True,
        "duration_s": 50.0,
    }
    assert document["word"][-1] == ["home"]
    assert Path(document["report"]).parent == file.parent


def test_a_flight_that_failed_says_why(
    file: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    came = fly._Flown(file.parent, heard=True, exit_code=4, failure=LinkError("the link is lost"))
    monkeypatch.setattr(fly, "_flown", lambda *_: came)
    monkeypatch.setattr(fly, "_report", lambda *_, **__: True)
    told = ran(capsys, "fly", str(file), "--json")
    document = json.loads(told.out)
    assert told.code == document["exit_code"] == 4
    assert (document["achieved"], document["error"]) == (False, "the link is lost")


def test_a_plan_and_a_report_are_documents(written: Path, folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    judged = json.loads(ran(capsys, "verify", str(written), "--json").out)
    assert (judged["exit_code"], judged["proved"]) == (0, True)
    told = ran(capsys, "report", str(folder), "--json")
    document = json.loads(told.out)
    assert (document["exit_code"], document["folder"]) == (0, str(folder))
    assert document["verdict"]["achieved"] is None
    assert Path(document["report"]).is_file()
    assert document["planned"]["triangles"] == plan_of(SMALL).partition.size


def test_verbose_says_more(file: Path, written: Path, capsys: pytest.CaptureFixture[str]) -> None:
    for command, more in ((("check", str(file)), "Mesh "), (("verify", str(written)), "Certificate ")):
        assert more not in ran(capsys, *command).out
        assert more in ran(capsys, *command, "-v").out
    with pytest.raises(SystemExit, match="2"):
        ran(capsys, "check", str(file), "-q", "-v")


def test_a_flight_is_told_as_it_comes_and_recorded_as_before(capsys: pytest.CaptureFixture[str]) -> None:
    class Kept:
        def __init__(self) -> None:
            self.lines: list[tuple[str, float | None, dict[str, Any]]] = []

        def write(self, kind: str, t_s: float | None, **values: object) -> None:
            self.lines.append((kind, t_s, values))

    lines: list[tuple[str, float | None, dict[str, Any]]] = [
        ("event", 12.34, {"name": "command", "command": "arm", "attempt": 1}),
        ("setpoint", 12.4, {"position_m": (1.0, 2.0)}),
        ("text", 12.5, {"severity": 6, "text": "Arming \x1b[2Jmotors"}),
        ("event", None, {"name": "stop", "reason": "x" * 500}),
    ]
    kept = Kept()
    narrated = Narrated(kept)
    for kind, t_s, values in lines:
        narrated.write(kind, t_s, **values)
    assert kept.lines == lines
    said = capsys.readouterr().err.splitlines()
    assert said[0] == "   12.3 s  command: arm, attempt 1"
    assert said[1].endswith(r"severity 6, Arming \x1b[2Jmotors")
    assert said[2].startswith("           stop: reason xxx")
    assert len(said) == 3
    assert max(map(len, said)) < 170
