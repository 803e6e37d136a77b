"""`mission verify` on plans that are whole, forged or damaged."""

import json
import random
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from mission.cli import main
from tests.support.commands import MISSIONS, ran

Forgery = Callable[[dict[str, Any]], None]
VALUES: tuple[object, ...] = (None, [], {}, -1, 10**30, "x", 1e308, True, [[1]], float("nan"), 0, [1e300, 1e300])


@pytest.fixture(scope="module")
def written(tmp_path_factory: pytest.TempPathFactory) -> str:
    file = tmp_path_factory.mktemp("plan") / "plan.json"
    assert main(["plan", str(MISSIONS / "paper.yaml"), "--json", "--out", str(file)]) == 0
    return file.read_text(encoding="utf-8")


def test_a_plan_is_proved_from_its_file(written: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    file = tmp_path / "plan.json"
    file.write_text(written, encoding="utf-8")
    result = ran(capsys, "verify", str(file))
    assert (result.code, result.err) == (0, "")
    assert result.out.startswith(f"{file}: proved: ")


def move_the_survey(plan: dict[str, Any]) -> None:
    """Label the triangles so that the area to avoid is nowhere."""
    labels = plan["labels"]
    free = labels["letters"].index([])
    labels["letter_of"] = [free if labels["letters"][i] == ["K1"] else i for i in labels["letter_of"]]


def bend_the_path(plan: dict[str, Any]) -> None:
    plan["trajectory"]["legs"][0]["curve"]["coefficients_m"][1] = [9.0, 9.0]


def hurry(plan: dict[str, Any]) -> None:
    """Fly with a vehicle that is slower than the trajectory."""
    plan["mission"]["limits"]["speed_m_s"] = 0.04


def dive(plan: dict[str, Any]) -> None:
    plan["trajectory"]["altitude_m"] = 0.5


@pytest.mark.parametrize(
    ("forgery", "words"),
    [
        (move_the_survey, "`labels.letter_of."),
        (bend_the_path, "may"),
        (hurry, " m/s at "),
        (dive, "`trajectory.altitude_m` is 0.5, and "),
    ],
)
def test_a_forged_plan_is_not_proved(
    forgery: Forgery, words: str, written: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    plan = json.loads(written)
    forgery(plan)
    file = tmp_path / "plan.json"
    file.write_text(json.dumps(plan), encoding="utf-8")
    result = ran(capsys, "verify", str(file))
    assert result.code == 1
    assert result.out.startswith(f"{file}: not proved: ")
    assert words in result.out


def _places(value: object, path: tuple[str | int, ...] = ()) -> list[tuple[str | int, ...]]:
    inner = value.items() if isinstance(value, dict) else enumerate(value[:3]) if isinstance(value, list) else ()
    return [path, *(place for key, part in inner for place in _places(part, (*path, key)))]


@pytest.mark.parametrize("seed", range(30))
def test_a_damaged_plan_never_ends_in_a_traceback(
    seed: int, written: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    chance = random.Random(seed)  # noqa: S311 - which damage, not a secret
    plan = json.loads(written)
    *way, last = chance.choice(_places(plan)[1:])
    part: Any = plan
    for key in way:
        part = part[key]
    part[last] = chance.choice(VALUES)
    file = tmp_path / "plan.json"
    file.write_text(json.dumps(plan), encoding="utf-8")
    result = ran(capsys, "verify", str(file))
    assert result.code in (0, 1, 2)
    assert str(file) in result.out + result.err


@pytest.mark.parametrize("content", ["", "{", "[]", "null", '{"format": 1}', "[" * 100_000, "\x00"])
def test_what_is_no_plan(content: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    file = tmp_path / "plan.json"
    file.write_text(content, encoding="utf-8")
    result = ran(capsys, "verify", str(file))
    assert (result.code, result.out) == (2, "")
    assert result.err.startswith(f"{file}: this is not a plan")
    assert "mission plan --out" in result.err


def test_a_plan_that_cannot_be_read(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "binary.json").write_bytes(b"\xff\xfe")
    for name, words in (("no.json", "no such file"), ("", "is a folder"), ("binary.json", "not text")):
        result = ran(capsys, "verify", str(tmp_path / name))
        assert (result.code, result.out) == (2, "")
        assert result.err.startswith(f"{tmp_path / name}: ")
        assert words in result.err


def test_the_folder_of_a_flight_is_told_what_to_name_in_it(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    refused = ran(capsys, "verify", str(tmp_path))
    assert refused.code == 2
    assert f"{tmp_path}: is a folder, and no plan" in refused.err
    assert f"{tmp_path / 'plan.json'}, or judge the flight in it: mission verify --flight {tmp_path}" in refused.err
