"""Options in the place of values in the mission file: what is tried needs no editing. ``given`` reads them."""

import argparse
from collections.abc import Callable
from typing import Any, Final, NamedTuple

from mission.cli.option_values import laps, offset, positive, whole_or_auto

LAPS: Final = "--laps"
SET: Final = "--set"

Key = tuple[str, ...]
"""Of a value in a mission file, with its sections."""


class _Change(NamedTuple):
    """An option that changes a value.

    Attributes:
        key: Where it is in the file.
        read: Makes the value of the text.
        metavar: How the value is shown.
        words: What it is.
        besides: Another key, which has to go.
    """

    key: Key
    read: Callable[[str], Any]
    metavar: str
    words: str
    besides: Key | None = None


CHANGES: Final = {
    "--formula": _Change(
        ("mission", "formula"), str, "FORMULA", "what is asked for, beside its tasks", ("mission", "automaton")
    ),
    "--start": _Change(("start", "position_m"), offset, "EAST,NORTH", "where it begins, as in the file"),
    "--altitude": _Change(("flight", "altitude_m"), positive, "M", "how high it is flown, metres"),
    "--flight-speed": _Change(("flight", "speed_m_s"), positive, "M_S", "how fast where nothing hinders, m/s"),
    "--frequencies": _Change(
        ("smoothing", "frequencies"), whole_or_auto, "N", "of the Fourier series, which this asks for"
    ),
    LAPS: _Change(("mission", "laps"), laps, "N", "how many laps, or until-stopped"),
}
"""Options by their names; of ``plan`` and ``simulate``, which have no other, ``--speed`` is that of the flight, too."""


def add_changes(command: argparse.ArgumentParser, *, speed: bool) -> None:
    """Add the options; ``speed`` is whether ``--speed`` is the flight's."""
    group = command.add_argument_group("instead of what the mission file says")
    for name, change in CHANGES.items():
        names = [name, *(["--speed"] if speed and name == "--flight-speed" else [])]
        group.add_argument(*names, type=change.read, metavar=change.metavar, help=change.words, dest=dest_of(name))
    group.add_argument(
        SET, action="append", default=[], metavar="KEY=VALUE", help="any other value, such as limits.jerk_m_s3=2"
    )


def dest_of(name: str) -> str:
    """Where the parser puts the value of an option."""
    return f"change_{name.removeprefix('--').replace('-', '_')}"
