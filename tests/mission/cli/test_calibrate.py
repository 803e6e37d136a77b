"""What `mission calibrate` prints, writes and refuses."""

from pathlib import Path
from typing import Any

import pytest

from mission.spec.loader import parse_mission
from tests.support.commands import MISSIONS, ran
from tests.support.lockstep import LockstepVehicle, vehicle_of


@pytest.fixture
def _in_this_process(monkeypatch: pytest.MonkeyPatch) -> None:
    """The vehicle is one of this process, in lock-step."""

    def link_to(*_: Any) -> tuple[None, LockstepVehicle, LockstepVehicle]:  # noqa: ANN401 - whatever it is called with
        vehicle = LockstepVehicle(vehicle_of("ardupilot"))
        return None, vehicle, vehicle

    monkeypatch.setattr("mission.cli.calibrate.link_to", link_to)


@pytest.mark.usefixtures("_in_this_process")
def test_it_says_what_it_measured_and_writes_it(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    file = tmp_path / "tube.yaml"
    result = ran(capsys, "calibrate", "--out", str(file))
    assert result.code == 0
    lines = dict(line.split(maxsplit=1) for line in result.out.splitlines() if not line.startswith(" "))
    assert list(lines) == ["flown", "following", "velocity", "delay", "drag", "wind", "tube", "written"]
    assert "of clearance than the mission's own tube takes" in result.out
    text = file.read_text(encoding="utf-8")
    mission = "domain: {boundary: [[0, 0], [9, 0], [9, 9]]}\nregions: {a: {kind: area, centre: [6, 3], radius_m: 1}}\n"
    spec = parse_mission((mission + 'mission: {formula: "true"}\nstart: {position_m: [6, 3]}\n' + text).encode())
    assert 0.1 < spec.flight.margins.following_m < 1.0
    assert spec.flight.disturbance_m_s2 == 0.0


def test_what_is_there_is_kept(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    file = tmp_path / "tube.yaml"
    file.write_text("mine", encoding="utf-8")
    result = ran(capsys, "calibrate", "--out", str(file))
    assert (result.code, result.out, file.read_text(encoding="utf-8")) == (2, "", "mine")
    assert "--force" in result.err


def test_without_room_nothing_takes_off(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    file = tmp_path / "narrow.yaml"
    text = (MISSIONS / "survey.yaml").read_text(encoding="utf-8")
    file.write_text(text.replace("position_m: [20, 16]", "position_m: [4, 4]"), encoding="utf-8")
    result = ran(capsys, "calibrate", str(file))
    assert (result.code, result.out) == (3, "")
    assert "there is no room for a figure of eight" in result.err


def test_options_of_the_bundled_vehicle_are_not_for_another(capsys: pytest.CaptureFixture[str]) -> None:
    result = ran(capsys, "calibrate", "--connect", "udpout:127.0.0.1:9", "--wind", "3,1")
    assert (result.code, result.out) == (2, "")
