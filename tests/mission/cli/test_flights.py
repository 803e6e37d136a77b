"""`mission fly` where no flight comes about, and `mission report` on folders of all kinds."""

import contextlib
import io
import json
import shutil
import socket
from pathlib import Path

import pytest

from mission.cli import main
from mission.cli.arguments import build_parser, with_negative_pairs
from mission.link.identity import LinkOptions
from tests.support.commands import MISSIONS, ran

PAPER = str(MISSIONS / "paper.yaml")


@pytest.mark.parametrize("wind", ["-3,1", "-3.5,-1", "-.5,1", "3,1", "4@270"])
def test_wind_of_either_sign_is_understood(wind: str) -> None:
    arguments = build_parser().parse_args(with_negative_pairs(["fly", PAPER, "--wind", wind, "--seed", "1"]))
    assert (arguments.wind, arguments.seed) == (wind, 1)


@pytest.mark.parametrize(
    ("address", "code", "words"),
    [
        ("nonsense", 2, "it names no kind of link"),
        ("", 2, "it names no kind of link"),
        ("udpin:127.0.0.1:99999", 2, "there is no port 99999"),
        ("serial:/dev/no-such-device:57600", 4, "no such file or directory; check the name of the device"),
    ],
)
def test_an_address_that_leads_nowhere_leaves_nothing_behind(
    address: str, code: int, words: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    result = ran(capsys, "fly", PAPER, "--connect", address, "--out", str(tmp_path / "flights"))
    assert result.code == code
    assert result.err.startswith("error: cannot ")
    assert words in result.err
    assert not (tmp_path / "flights").exists()


def test_a_port_that_is_taken(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as other:
        other.bind(("127.0.0.1", 0))
        address = f"udpin:127.0.0.1:{other.getsockname()[1]}"
        result = ran(capsys, "fly", PAPER, "--connect", address, "--out", str(tmp_path / "flights"))
    assert result.code == 4
    assert result.err.startswith(f"error: cannot open {address}: address already in use; another program")
    assert not (tmp_path / "flights").exists()


def test_a_port_where_nobody_listens(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    with socket.socket(socket.AF_INET, socket.SOCK_STREAM) as other:
        other.bind(("127.0.0.1", 0))  # bound and not listening: calls are refused
        address = f"tcp:127.0.0.1:{other.getsockname()[1]}"
        result = ran(capsys, "fly", PAPER, "--connect", address, "--out", str(tmp_path / "flights"))
    assert result.code == 4
    assert "connection refused; start the vehicle or its simulator first" in result.err


@pytest.mark.parametrize(
    "option", [["--seed", "0"], ["--speed", "1"], ["--wind", "0,0"], ["--faults", "f"], ["--no-ground-station"]]
)
def test_options_of_the_bundled_vehicle_are_not_for_others(
    option: list[str], capsys: pytest.CaptureFixture[str]
) -> None:
    result = ran(capsys, "fly", PAPER, "--connect", "udpin:127.0.0.1:0", *option)
    assert (result.code, result.out) == (2, "")
    assert result.err.startswith(f"{option[0]}: is for the bundled vehicle")


def test_a_folder_that_cannot_be_made(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "file").write_text("kept")
    result = ran(capsys, "fly", PAPER, "--connect", "udpin:127.0.0.1:0", "--out", str(tmp_path / "file" / "flights"))
    assert result.code == 2
    assert result.err.startswith(f"--out: {tmp_path / 'file' / 'flights'} cannot be written: not a directory")


@pytest.fixture(scope="module")
def unheard(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, list[str]]:
    """The folder of a flight whose vehicle was never heard, and what was said of it."""
    out, said = tmp_path_factory.mktemp("unheard") / "flights", io.StringIO()
    link = LinkOptions(connect_s=0.2)
    with pytest.MonkeyPatch.context() as patch, contextlib.redirect_stderr(said):
        patch.setattr("mission.cli.vehicle_link.LinkOptions", lambda **_others: link)
        assert main(["fly", PAPER, "--connect", "udpin:127.0.0.1:0", "--out", str(out), "--no-pictures"]) == 4
    (folder,) = out.iterdir()
    return folder, said.getvalue().splitlines()


@pytest.fixture
def silent(unheard: tuple[Path, list[str]], tmp_path: Path) -> Path:
    """A copy of that folder, to be damaged."""
    return shutil.copytree(unheard[0], tmp_path / "flight")


def test_a_vehicle_that_is_never_heard(unheard: tuple[Path, list[str]]) -> None:
    folder, lines = unheard
    assert lines[-3].startswith("error: no vehicle was heard")
    assert lines[-2].startswith("    check that the vehicle or its simulator runs")
    assert lines[-1] == f"the flight is kept in {folder}, its report is {folder / 'report.html'}"


def test_the_folder_of_a_failed_flight_is_whole(silent: Path, capsys: pytest.CaptureFixture[str]) -> None:
    names = ["events.jsonl", "flight.tlog", "mission.yaml", "plan.json", "provenance.json", "record.jsonl"]
    assert sorted(file.name for file in silent.iterdir()) == [*names, "report.html", "summary.json", "verdict.json"]
    assert json.loads((silent / "verdict.json").read_text())["achieved"] is False
    assert (silent / "mission.yaml").read_bytes() == Path(PAPER).read_bytes()
    assert ran(capsys, "verify", str(silent / "plan.json")).code == 0


def test_a_report_is_written_again(silent: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (silent / "report.html").unlink()
    result = ran(capsys, "report", str(silent))
    assert (result.code, result.err) == (0, "")
    assert result.out == f"report    {silent / 'report.html'}\n"
    assert (silent / "report.html").is_file()


def test_a_record_that_was_cut_is_reported(silent: Path, capsys: pytest.CaptureFixture[str]) -> None:
    record = silent / "record.jsonl"
    record.write_bytes(record.read_bytes()[:-9])
    assert ran(capsys, "report", str(silent)).code == 0
    assert json.loads((silent / "summary.json").read_text(encoding="utf-8"))["flown"]["record_is_cut"] is True


@pytest.mark.parametrize(
    ("file", "content", "words"),
    [
        ("record.jsonl", b'{"kind": "header"}\n', "record.jsonl: "),
        ("record.jsonl", b"\xff\xfe\n\n", "record.jsonl: "),
        ("plan.json", b"{}", "plan.json: this is not a plan"),
        ("plan.json", b"\xff", "plan.json: is not a plan"),
        ("plan.json", None, "it has no plan.json"),
        ("record.jsonl", None, "it has no record.jsonl"),
        ("mission.yaml", None, "it has no mission.yaml"),
    ],
)
def test_a_damaged_folder(
    file: str, content: bytes | None, words: str, silent: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    if content is None:
        (silent / file).unlink()
    else:
        (silent / file).write_bytes(content)
    result = ran(capsys, "report", str(silent))
    assert (result.code, result.out) == (2, "")
    assert words in result.err


def test_what_is_no_flight_folder(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "file").write_text("")
    for place, words in (("file", "is not a folder"), ("no", "there is no such folder"), ("", "it has no plan.json")):
        result = ran(capsys, "report", str(tmp_path / place))
        assert (result.code, result.out) == (2, "")
        assert result.err.startswith(f"{tmp_path / place}: ")
        assert words in result.err


def test_a_report_that_cannot_be_written(silent: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (silent / "summary.json").unlink()
    (silent / "summary.json").mkdir()
    result = ran(capsys, "report", str(silent))
    assert result.code == 2
    assert result.err.startswith(f"{silent}: the report cannot be written: is a directory")


def test_flights_are_compared_and_nothing_is_written(
    silent: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    other = shutil.copytree(silent, tmp_path / "other")
    with (other / "record.jsonl").open("a") as record:
        for t_s, percent in ((1.0, 97), (60.0, 54)):
            record.write(json.dumps({"kind": "charge", "t_s": t_s, "percent": percent, "drawn_mah": None}) + "\n")
            place = {"kind": "telemetry", "t_s": t_s, "position_m": [11.0 + t_s / 60.0, 9.5, 5.0]}
            record.write(json.dumps(place) + "\n")
        record.write(json.dumps({"kind": "verdict", "t_s": 61.0, "achieved": True, "reason": "all done"}) + "\n")
    before = {file: file.stat().st_mtime_ns for folder in (silent, other) for file in folder.iterdir()}
    result = ran(capsys, "report", str(silent), str(other), "-v")
    assert (result.code, result.err) == (0, "")
    lines = result.out.splitlines()
    first, second = ([line for line in lines if line.split()[:1] == [name]][-1] for name in ("flight", "other"))
    assert "not achieved" in first
    assert "97 to 54 %" in second
    assert "K1 3.90 m" in second
    assert lines[-1] == "other: all done"
    rows = json.loads(ran(capsys, "report", str(silent), str(other), "--json").out)["flights"]
    assert [row["achieved"] for row in rows] == [False, True]
    assert [row["charge_percent"] for row in rows] == [None, [97.0, 54.0]]
    assert [row["folder"] for row in rows] == [str(silent), str(other)]
    assert {file: file.stat().st_mtime_ns for folder in (silent, other) for file in folder.iterdir()} == before
    assert ran(capsys, "report", str(silent), str(tmp_path / "nowhere")).code == 2
