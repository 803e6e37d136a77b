"""Completion of the command line in shells, made from the parser itself."""

import argparse
from collections.abc import Iterator
from typing import Final

import shtab

_FOLDER: Final = "FOLDER"
_FILES: Final = ("FILE", "PLAN", "LOG", "FAULTS", "MISSION.yaml", "PLAN.json", "TUBE.yaml")


def completion(parser: argparse.ArgumentParser, shell: str) -> str:
    """The script that makes a shell complete commands, options, their choices, files and folders."""
    for action in _actions(parser):
        if action.metavar == _FOLDER:
            vars(action)["complete"] = shtab.DIRECTORY
        elif action.metavar in _FILES:
            vars(action)["complete"] = shtab.FILE
    return shtab.complete(parser, shell)


def _actions(parser: argparse.ArgumentParser) -> Iterator[argparse.Action]:
    """All arguments of a parser and of its commands."""
    for action in parser._actions:  # noqa: SLF001 - argparse has no other list of them
        yield action
        if isinstance(action.choices, dict):
            for command in action.choices.values():
                yield from _actions(command)
