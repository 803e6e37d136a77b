"""Help and completion: every command has examples that it understands, and shells are given what there is."""

import argparse
import shlex
import subprocess
from pathlib import Path

import pytest

from mission.cli import main
from mission.cli.arguments import build_parser, with_negative_pairs
from mission.cli.examples import EXAMPLES


def commands() -> dict[str, argparse.ArgumentParser]:
    return next(action.choices for action in build_parser()._actions if isinstance(action.choices, dict))


def test_every_command_has_examples() -> None:
    assert set(EXAMPLES) == set(commands())
    for name, parser in commands().items():
        shown = parser.format_help()
        assert parser.description
        assert all(text in shown and words in shown for text, words in EXAMPLES[name])


@pytest.mark.parametrize("text", [text for examples in EXAMPLES.values() for text, _ in examples])
def test_an_example_is_understood(text: str) -> None:
    words = shlex.split(text.replace("|", "&&").replace(" > ", " && "))
    begins = [i + 1 for i, word in enumerate(["&&", *words]) if word == "&&" and words[i : i + 1] == ["mission"]]
    assert begins
    for begin in begins:
        end = words.index("&&", begin) if "&&" in words[begin:] else len(words)
        assert build_parser().parse_args(with_negative_pairs(words[begin:end])).command in EXAMPLES


@pytest.mark.parametrize("shell", ["bash", "zsh"])
def test_a_shell_completes_every_command(shell: str, capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit) as end:
        main(["--completion", shell])
    script = capsys.readouterr().out
    assert end.value.code == 0
    assert all(name in script for name in commands())
    assert "--no-ground-station" in script


def test_bash_completes_commands_options_choices_and_files(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], bash: str
) -> None:
    with pytest.raises(SystemExit):
        main(["--completion", "bash"])
    script = capsys.readouterr().out
    (tmp_path / "farm.yaml").touch()
    (tmp_path / "farms").mkdir()
    asked = {
        "mission pl": "plan",
        "mission fly --flav": "--flavour",
        "mission fly --flavour ": "ardupilot px4",
        "mission check far": "farm.yaml farms",
        "mission report far": "farms",
    }
    empty = ' ""'
    tries = "".join(
        f"COMP_WORDS=({words}{empty * words.endswith(' ')}); COMP_CWORD=$((${{#COMP_WORDS[@]}}-1)); COMPREPLY=()\n"
        '_shtab_mission; echo $(printf "%s\\n" "${COMPREPLY[@]}" | sort)\n'
        for words in asked
    )
    done = subprocess.run(  # noqa: S603 - the script that this project's own program prints
        [bash, "--norc", "-c", script + tries], capture_output=True, text=True, check=False, cwd=tmp_path
    )
    assert done.stdout.splitlines() == list(asked.values()), done.stderr


@pytest.fixture
def bash() -> str:
    for place in ("/bin/bash", "/usr/bin/bash", "/usr/local/bin/bash"):
        if Path(place).is_file():
            return place
    pytest.skip("there is no bash here")
