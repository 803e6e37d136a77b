"""The pages' commands exist: each is understood by the program that it names, and its files are there."""

import re
import shlex
import tomllib
from collections.abc import Iterator

import pytest
import yaml

from mission.cli.arguments import build_parser, with_negative_pairs
from mission.cli.examples import EXAMPLES
from mission.spec.key_tables import tables
from mission.spec.loader import parse_mission
from tests.support.commands import ROOT
from vehicle_sim.cli import main as vehicle_sim
from vehicle_sim.faults import read_schedule

FRONT = "README.md"
PAGES = {
    name: (ROOT / name).read_text(encoding="utf-8")
    for name in (FRONT, "mission/README.md", "missions/README.md", "vehicle_sim/README.md")
}
LONGEST_FRONT_PAGE = 250
KNOWN = ("mission", "vehicle-sim", "python", "ruff", "mypy", "lint-imports", "mavproxy.py", ".ci/run")


def fenced(language: str) -> list[str]:
    return [
        block
        for page in PAGES.values()
        for block in re.findall(rf"^```{language}\n(.*?)^```", page, flags=re.MULTILINE | re.DOTALL)
    ]


def code() -> Iterator[str]:
    """Every indented or fenced line of code, and every span of it in the text."""
    for page in PAGES.values():
        prose = re.sub(r"^```.*?^```", "", page, flags=re.MULTILINE | re.DOTALL)
        yield from (line.strip() for line in prose.splitlines() if line.startswith("    "))
        yield from (span.replace("\n", " ") for span in re.findall(r"`([^`]+)`", prose))
    for block in fenced("(?:sh|bash|console|shell)?"):
        yield from (line.removeprefix("$ ").strip() for line in block.splitlines())


def commands() -> dict[str, list[str]]:
    """The commands of the pages, each once, by what they are made of."""
    found = {}
    for line in code():
        for part in line.split("&&"):
            try:
                words = shlex.split(part, comments=True)
            except ValueError:  # a formula with an apostrophe is no command
                continue
            if len(words) > 1 and words[0] in KNOWN:
                found[" ".join(words)] = words
    return found


def of(program: str) -> list[list[str]]:
    return [words[1:] for words in commands().values() if words[0] == program]


def test_the_two_commands_stand_in_the_readme() -> None:
    assert "    python -m pip install . && mission fly missions/survey.yaml\n" in PAGES[FRONT]
    assert "    python -m pip install '.[test]' && python -m pytest\n" in PAGES[FRONT]


def test_the_front_page_is_short_and_leads_to_the_others() -> None:
    assert PAGES[FRONT].count("\n") <= LONGEST_FRONT_PAGE
    assert all(f"]({name})" in PAGES[FRONT] for name in PAGES if name != FRONT)


def test_every_key_of_a_mission_file_is_listed_as_the_schema_has_it() -> None:
    assert tables() in PAGES["missions/README.md"], "write what `mission schema --markdown` prints into the page"


@pytest.mark.parametrize("words", of("mission"), ids=" ".join)
def test_a_command_of_mission_is_understood(words: list[str]) -> None:
    if words[0] == "--completion":
        return  # shown by its own tests
    if len(words) == 1:
        assert words[0] in EXAMPLES  # a command that is spoken of
        return
    arguments = build_parser().parse_args(with_negative_pairs(words))
    assert arguments.command is not None
    for word in words:
        if word.startswith("missions/"):
            assert (ROOT / word).is_file()


@pytest.mark.parametrize("words", of("vehicle-sim"), ids=" ".join)
def test_a_command_of_the_vehicle_is_understood(words: list[str], capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit) as end:  # help comes after all else was understood
        vehicle_sim([*words, "--help"])
    assert end.value.code == 0, capsys.readouterr().err


@pytest.mark.parametrize("words", of("python"), ids=" ".join)
def test_a_command_of_python_installs_an_extra_or_runs_the_tests(words: list[str]) -> None:
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
    assert words[0] == "-m"
    if words[1] == "pip":
        assert words[2] == "install"
        extra = re.fullmatch(r"\.(?:\[(\w+)\])?", words[3])
        assert extra
        assert extra[1] is None or extra[1] in project["project"]["optional-dependencies"]
    else:
        assert words[1] == "pytest"
        known = {marker.partition(":")[0] for marker in project["tool"]["pytest"]["ini_options"]["markers"]}
        assert words[2:3] in ([], ["-m"])
        assert set(words[3:4]) <= known


@pytest.mark.parametrize("text", fenced("yaml"))
def test_an_example_in_the_pages_is_sound(text: str) -> None:
    if text.startswith("faults:"):
        assert read_schedule(text.encode()).faults
    else:
        assert parse_mission(text.encode(), "README").regions


@pytest.mark.parametrize("page", PAGES)
def test_names_of_files_are_those_of_the_tree(page: str) -> None:
    for link in re.findall(r"\]\((?!https?:|#)([^)#]+)[^)]*\)", PAGES[page]):
        assert ((ROOT / page).parent / link).exists(), link
    for name in re.findall(r"`(missions/[^\s`]*)`", PAGES[page]):
        assert (ROOT / name).exists(), name


def test_options_that_are_named_in_the_text_exist() -> None:
    helps = build_parser().format_help()
    for action in build_parser()._subparsers._group_actions:  # type: ignore[union-attr]
        for parser in (action.choices or {}).values():  # type: ignore[union-attr]
            helps += parser.format_help()
    for page in PAGES.values():
        for option in re.findall(r"`(--[a-z-]+)", page):
            assert option in helps or option == "--master", option


def test_examples_parse_as_yaml() -> None:
    assert all(isinstance(yaml.safe_load(text), dict) for text in fenced("yaml"))
