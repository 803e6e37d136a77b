"""The program ``mission`` as a function: arguments in; exit code and what it said out."""

from pathlib import Path
from typing import NamedTuple

import pytest

from mission.cli import main

ROOT = Path(__file__).parents[2]
MISSIONS = ROOT / "missions"


class Ran(NamedTuple):
    """What came of a command."""

    code: int
    out: str
    err: str


def ran(capsys: pytest.CaptureFixture[str], *arguments: str) -> Ran:
    code = main(arguments)
    said = capsys.readouterr()
    return Ran(code, said.out, said.err)
