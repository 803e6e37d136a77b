"""The program as a process: pipes, streams, what it loads, and that its bytes do not depend on chance."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

from mission.cli import main
from tests.support.commands import MISSIONS, ROOT

PAPER = str(MISSIONS / "paper.yaml")


def program(*arguments: str, **environment: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run(  # noqa: S603 - this project's own program
        [sys.executable, "-m", "mission", *arguments],
        capture_output=True,
        encoding="utf-8",
        check=False,
        cwd=ROOT,
        env={**os.environ, **environment},
    )


def loaded(*arguments: str) -> set[str]:
    """The modules that a command loads."""
    script = (
        "import sys, contextlib, io; from mission.cli import main\n"
        "with contextlib.redirect_stdout(io.StringIO()), contextlib.suppress(SystemExit): main(sys.argv[1:])\n"
        "print(*sys.modules)"
    )
    done = subprocess.run(  # noqa: S603 - this project's own program
        [sys.executable, "-c", script, *arguments], capture_output=True, text=True, check=True, cwd=ROOT
    )
    return set(done.stdout.split())


@pytest.mark.parametrize(
    ("arguments", "likely"), [(["paln", PAPER], "plan"), (["fly", PAPER, "--flavour", "px"], "px4"), (["xyz"], "")]
)
def test_a_slip_of_the_pen_is_told_what_was_meant(
    arguments: list[str], likely: str, capsys: pytest.CaptureFixture[str]
) -> None:
    with pytest.raises(SystemExit, match="2"):
        main(arguments)
    said = capsys.readouterr().err
    assert f"; did you mean {likely}?" in said if likely else "did you mean" not in said


def test_help_loads_no_library() -> None:
    modules = loaded("--help")
    assert "mission.cli" in modules
    assert not modules & {"numpy", "scipy", "rich", "yaml", "jsonschema", "matplotlib", "pymavlink", "mission.plan"}


def test_planning_draws_nothing_and_speaks_to_nobody() -> None:
    modules = loaded("plan", PAPER, "--json")
    assert "scipy" in modules
    assert not modules & {"matplotlib", "pymavlink", "serial", "filterpy"}


def test_a_flight_loads_what_its_page_takes_only_where_that_is_asked_for() -> None:
    modules = loaded("fly", "no-such-mission.yaml")
    assert "mission.fly.loop" in modules
    assert not modules & {"bokeh", "tornado", "mission.view"}


def test_a_plan_is_the_same_bytes_whatever_the_hash_seed(tmp_path: Path) -> None:
    survey = str(MISSIONS / "survey.yaml")
    said = []
    for seed in ("1", "4711"):
        done = program("plan", survey, "--out", str(tmp_path / seed), "--runs", "5", PYTHONHASHSEED=seed)
        assert done.returncode == 0, done.stderr
        said.append(done.stdout.replace(str(tmp_path / seed), ""))
    assert said[0] == said[1]
    assert (tmp_path / "1").read_bytes() == (tmp_path / "4711").read_bytes()


def test_a_reader_that_goes_away_ends_the_program_quietly_after_the_writing(tmp_path: Path) -> None:
    reading, writing = os.pipe()
    os.close(reading)
    try:
        done = subprocess.run(  # noqa: S603 - this project's own program
            [sys.executable, "-m", "mission", "plan", PAPER, "--out", str(tmp_path / "plan.json")],
            stdout=writing,
            stderr=subprocess.PIPE,
            check=False,
            cwd=ROOT,
        )
    finally:
        os.close(writing)
    assert (done.returncode, done.stderr) == (141, b"")
    assert (tmp_path / "plan.json").is_file()


def test_a_full_disk_is_said(tmp_path: Path) -> None:
    full = Path("/dev/full")
    if not full.exists():
        pytest.skip("this system has no device that is always full")
    with full.open("wb") as output:
        done = subprocess.run(
            [sys.executable, "-m", "mission", "schema"],
            stdout=output,
            stderr=subprocess.PIPE,
            check=False,
            cwd=tmp_path,
        )
    assert (done.returncode, done.stderr) == (2, b"error: No space left on device\n")


def test_a_terminal_that_knows_only_ascii(tmp_path: Path) -> None:
    file = tmp_path / "mission.yaml"
    text = Path(PAPER).read_text(encoding="utf-8").replace("The paper's survey", "Überflug")
    file.write_text(text, encoding="utf-8")
    done = program("plan", str(file), PYTHONIOENCODING="ascii", PYTHONUTF8="0")
    assert done.returncode == 0, done.stderr
    assert done.stdout.startswith("?berflug\n")
    assert '"name": "\\u00dcberflug"' in program("plan", str(file), "--json", PYTHONIOENCODING="ascii").stdout


def test_colours_are_for_terminals_alone() -> None:
    broken = str(MISSIONS / "broken" / "formula_syntax.yaml")
    plain = program("check", broken)
    assert "\x1b" not in plain.stderr
    forced = program("check", broken, FORCE_COLOR="1", NO_COLOR="")
    assert "\x1b[1m" in forced.stderr
    assert "\x1b[31m" not in program("check", broken, FORCE_COLOR="1", NO_COLOR="1").stderr
