"""How the program ends: by signals at any moment, and where its standard streams take nothing."""

import os
import signal
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

from mission.cli import main
from tests.support.commands import MISSIONS, ROOT

PAPER = str(MISSIONS / "paper.yaml")
BROKEN = str(MISSIONS / "broken" / "formula_syntax.yaml")
FULL = Path("/dev/full")

pytestmark = pytest.mark.skipif(os.name != "posix", reason="signals and /dev/full are POSIX")

WHEN_IMPORTED = """
import os, signal, sys
from importlib.abc import MetaPathFinder

_, module, number, *sys.argv[1:] = sys.argv

class Sender(MetaPathFinder):
    def find_spec(self, name, path, target=None):
        if name == module:
            sys.meta_path.remove(self)
            os.kill(os.getpid(), int(number))

signal.signal(signal.SIGHUP, signal.SIG_DFL)  # whoever runs the tests may ignore it
sys.meta_path.insert(0, Sender())
from mission.cli import main
sys.exit(main())
"""
"""Sends a signal to itself where a module, its first argument, is about to be loaded."""


@pytest.fixture
def heeded() -> Iterator[None]:
    """A hang-up counts, whoever runs the tests."""
    before = signal.signal(signal.SIGHUP, signal.SIG_DFL)
    yield
    signal.signal(signal.SIGHUP, before)


def ended_at(module: str, number: signal.Signals, *arguments: str) -> subprocess.CompletedProcess[bytes]:
    return subprocess.run(  # noqa: S603 - this project's own program
        [sys.executable, "-c", WHEN_IMPORTED, module, str(int(number)), *arguments],
        capture_output=True,
        check=False,
        cwd=ROOT,
    )


@pytest.mark.parametrize(
    ("module", "number"),
    [
        ("argparse", signal.SIGINT),
        ("mission.cli.check", signal.SIGHUP),
        ("scipy.sparse.csgraph", signal.SIGTERM),
        ("numpy", signal.SIGINT),
    ],
)
def test_a_signal_ends_the_program_at_once_without_a_traceback(module: str, number: signal.Signals) -> None:
    done = ended_at(module, number, "check", PAPER)
    assert (done.returncode, done.stdout, done.stderr) == (128 + number, b"", b"")


@pytest.mark.usefixtures("heeded")
@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM, signal.SIGHUP])
def test_a_signal_while_planning(number: signal.Signals, monkeypatch: pytest.MonkeyPatch) -> None:
    before = [signal.getsignal(each) for each in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)]
    monkeypatch.setattr("mission.cli.check.planned", lambda _name: signal.raise_signal(number))
    assert main(["check", PAPER]) == 128 + number
    assert [signal.getsignal(each) for each in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)] == before


def test_a_hang_up_that_is_ignored_stays_so(monkeypatch: pytest.MonkeyPatch) -> None:
    before = signal.signal(signal.SIGHUP, signal.SIG_IGN)  # as nohup does it
    try:
        monkeypatch.setattr("mission.cli.check.print_warnings", lambda *_, **__: signal.raise_signal(signal.SIGHUP))
        assert main(["check", PAPER]) == 0
    finally:
        signal.signal(signal.SIGHUP, before)


@pytest.mark.skipif(not FULL.exists(), reason="this system has no device that is always full")
@pytest.mark.parametrize(
    ("arguments", "unbuffered"),
    [(["check", BROKEN], ""), (["check", BROKEN], "1"), (["no-such-command"], ""), ([], "")],
)
def test_an_error_output_that_takes_nothing_leaves_the_exit_code(arguments: list[str], unbuffered: str) -> None:
    with FULL.open("wb") as full:
        done = subprocess.run(  # noqa: S603 - this project's own program
            [sys.executable, "-m", "mission", *arguments],
            stdout=subprocess.DEVNULL,
            stderr=full,
            check=False,
            cwd=ROOT,
            env={**os.environ, "PYTHONUNBUFFERED": unbuffered},
        )
    assert done.returncode == 2


@pytest.mark.skipif(not FULL.exists(), reason="this system has no device that is always full")
@pytest.mark.parametrize("arguments", [["--help"], ["check", PAPER]])
def test_an_output_that_takes_nothing_is_said(arguments: list[str]) -> None:
    with FULL.open("wb") as full:
        done = subprocess.run(  # noqa: S603 - this project's own program
            [sys.executable, "-m", "mission", *arguments], stdout=full, stderr=subprocess.PIPE, check=False, cwd=ROOT
        )
    assert (done.returncode, done.stderr) == (2, b"error: No space left on device\n")


@pytest.mark.parametrize("closed", ["0>&- 1>&- 2>&-", "1>&-"])
def test_streams_that_are_closed_are_like_those_that_nobody_reads(closed: str) -> None:
    command = f"exec {sys.executable} -m mission schema {closed}"
    done = subprocess.run(["/bin/sh", "-c", command], capture_output=True, check=False, cwd=ROOT)  # noqa: S603 - see above
    assert (done.returncode, done.stderr) == (0, b"")
