"""``mission check --connect`` and what ``mission fly`` says before it arms, with the vehicle as a process."""

import json
from collections.abc import Iterator
from pathlib import Path

import pytest

from mission.report.reading import read_record
from tests.support.commands import MISSIONS, ran
from tests.support.small_missions import SMALL
from tests.support.vehicle_program import running

SURVEY = str(MISSIONS / "survey.yaml")


@pytest.fixture(scope="module")
def address() -> Iterator[str]:
    """A vehicle that flies more slowly than the mission asks for."""
    slow = ("--flavour", "px4", "--speed", "20", "--listen", "udpin:127.0.0.1:0", "--set", "MPC_XY_VEL_MAX=2")
    with running(*slow) as (_, addresses):
        yield addresses[0].replace("udpin", "udpout")


@pytest.fixture
def file(tmp_path: Path) -> Path:
    path = tmp_path / "small.yaml"
    path.write_text(SMALL)
    return path


def test_go_or_no_go_with_figures_and_what_to_do(address: str, file: Path, capsys: pytest.CaptureFixture[str]) -> None:
    looked = ran(capsys, "check", str(file), "--connect", address)
    assert looked.code == 2  # what the file says of the vehicle is wrong
    lines = looked.out.splitlines()
    assert lines[0].startswith(f"{file}: sound")
    assert lines[-1] == "NO-GO"
    (at,) = (number for number, line in enumerate(lines) if line.startswith("no-go"))
    assert "2 m/s allowed (MPC_XY_VEL_MAX 2)" in lines[at]
    assert lines[at + 1].strip().startswith("set MPC_XY_VEL_MAX to ")
    told = ran(capsys, "check", str(file), "--connect", address, "--json")
    assert told.code == 2
    values = json.loads(told.out)
    assert (values["mission"], values["go"]) == ("Small round", False)
    assert [row["row"] for row in values["rows"] if row["level"] == "no-go"] == ["speed"]


def test_a_flight_is_refused_before_it_arms(address: str, file: Path, capsys: pytest.CaptureFixture[str]) -> None:
    out = file.parent / "flights"
    refused = ran(capsys, "fly", str(file), "--connect", address, "--out", str(out), "--no-pictures")
    assert refused.code == 2
    assert "no-go: nothing was armed; `--force ROW` overrides a row by its name" in refused.err
    assert "MPC_XY_VEL_MAX 2" in refused.err
    (folder,) = out.iterdir()
    record = read_record(folder)
    assert record.verdict is not None
    assert "speed: " in record.verdict["reason"]
    assert "arming" not in {event.text for event in record.events}
    page = (folder / "report.html").read_text()
    assert "Check before the flight: no-go" in page
    assert "MPC_XY_VEL_MAX" in page


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (("fly", SURVEY, "--force", "batery"), "--force: there is no row 'batery'"),
        (("check", SURVEY, SURVEY, "--connect", "udpin:127.0.0.1:0"), "--connect: looks at a vehicle for one mission"),
        (("check", SURVEY, "--system-id", "3"), "--system-id: is for a vehicle"),
        (("check", SURVEY, "--connect", "nonsense"), "it names no kind of link"),
    ],
)
def test_what_does_not_go_together_is_said(
    arguments: tuple[str, ...], words: str, capsys: pytest.CaptureFixture[str]
) -> None:
    result = ran(capsys, *arguments)
    assert (result.code, result.out) == (2, "")
    assert words in result.err
