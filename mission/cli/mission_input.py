"""Mission files as commands are given them: by name, or ``-`` for standard input."""

import sys
from functools import lru_cache
from pathlib import Path
from typing import Final, TextIO

from mission.spec.loader import beside, load_mission, parse_mission
from mission.spec.model import MissionSpec
from mission.spec.yaml_tree import MAX_BYTES

STDIN: Final = "-"
_SHOWN: Final = "standard input"
_STEM: Final = "mission"


def mission_in(file: str) -> MissionSpec:
    """Read a mission; what it names on standard input is beside where the program runs.

    Raises:
        SpecError: If it cannot be read, or with every fault that it has.
    """
    return parse_mission(content_of(Path(file)), _SHOWN, beside(Path(file))) if file == STDIN else load_mission(file)


def content_of(file: Path) -> bytes:
    """The bytes of a mission, also of one that was read before.

    Raises:
        OSError: The file cannot be read.
    """
    return _standard_input(sys.stdin) if str(file) == STDIN else file.read_bytes()


def shown(file: str) -> str:
    """How messages name it."""
    return _SHOWN if file == STDIN else file


def stem_of(file: Path) -> str:
    """What is named after it begins with this."""
    return _STEM if str(file) == STDIN else file.stem


def line_of(source: str, line: int) -> bytes:
    """A line, from 1, of what messages name so; empty where there is none.

    Raises:
        OSError: It cannot be read.
    """
    lines = content_of(Path(STDIN if source == _SHOWN else source)).split(b"\n")
    return lines[line - 1] if line <= len(lines) else b""


@lru_cache(maxsize=1)
def _standard_input(stream: TextIO | None) -> bytes:
    """What is on it, which can be read but once."""
    return b"" if stream is None else stream.buffer.read(MAX_BYTES + 1)
