"""What lies where: the top level, and what a wheel of the two packages holds."""

import fnmatch
import shutil
import subprocess
import tomllib

import pytest

from tests.support.commands import ROOT

TOP = {"pyproject.toml", "README.md", "LICENSE", "mission", "vehicle_sim", "tests", "missions"}
LONGEST_FILE = 400


def tracked() -> list[str]:
    if not (ROOT / ".git").exists() or shutil.which("git") is None:
        pytest.skip("these are the sources without their history, so what belongs to them is not known")
    listed = subprocess.run(["git", "ls-files", "-z"], cwd=ROOT, capture_output=True, text=True, check=True)  # noqa: S607
    return [name for name in listed.stdout.split("\0") if name and (ROOT / name).exists()]


def test_the_top_level_holds_what_a_newcomer_needs_and_no_more() -> None:
    names = {name.partition("/")[0] for name in tracked()}
    assert {name for name in names if not name.startswith(".")} == TOP


def test_files_stay_short() -> None:
    for name in tracked():
        if name.endswith(".py") and name.startswith(("mission/", "vehicle_sim/")):
            assert (ROOT / name).read_bytes().count(b"\n") <= LONGEST_FILE, name


def test_a_wheel_holds_the_two_packages_with_all_their_parts_and_nothing_else() -> None:
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
    wanted = project["tool"]["setuptools"]["packages"]["find"]
    tops = {name for name in ("mission", "vehicle_sim", "missions", "tests") if _is_found(name, wanted)}
    assert tops == {"mission", "vehicle_sim"}
    folders = {file.parent for top in tops for file in (ROOT / top).rglob("*.py")}
    for folder in folders:
        assert (folder / "__init__.py").is_file(), f"{folder} is no package, so it is not in the wheel"
        assert _is_found(".".join(folder.relative_to(ROOT).parts), wanted)


def _is_found(package: str, wanted: dict[str, list[str]]) -> bool:
    """Whether setuptools takes a package by its name."""
    included, excluded = (
        any(fnmatch.fnmatchcase(package, pattern) for pattern in wanted[kind]) for kind in ("include", "exclude")
    )
    return included and not excluded


def test_what_is_no_code_travels_in_the_wheel() -> None:
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
    data = project["tool"]["setuptools"]["package-data"]
    for top in ("mission", "vehicle_sim"):
        others = [name for name in tracked() if name.startswith(f"{top}/") and not name.endswith(".py")]
        for name in others:
            assert any(fnmatch.fnmatch(name.removeprefix(f"{top}/"), pattern) for pattern in data[top]), name


def test_the_programs_exist() -> None:
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    assert project["name"] == "ltl-mission"
    assert project["scripts"] == {"mission": "mission.cli:main", "vehicle-sim": "vehicle_sim.cli:main"}
