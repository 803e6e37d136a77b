"""Virtual environments for clients that cannot live beside each other, made once and kept in pytest's cache folder.

Only wheels are taken: where a version has none for this machine, its tests are skipped with what pip says.
"""

import os
import sqlite3
import subprocess
import sys
from collections.abc import Iterator
from contextlib import closing, contextmanager
from pathlib import Path
from shutil import rmtree

VERSIONS = {3: "mavsdk>=3.17,<4", 4: "mavsdk>=4,<5"}
"""The requirement of each major version."""

_PATIENCE_S = 300.0
_WHOLE = "whole"


class NoWheelError(Exception):
    """There is no wheel of a client for this machine, or none can be had; the text is pip's."""


@contextmanager
def only_one(folder: Path) -> Iterator[None]:
    """Keep other processes out; the lock of a process that dies goes with it."""
    with closing(sqlite3.connect(folder / "lock", timeout=_PATIENCE_S, isolation_level=None)) as lock:
        lock.execute("BEGIN EXCLUSIVE")
        yield


def environment(version: int, kept: Path, run: Path) -> Path:
    """Return the Python of an environment with a version of MAVSDK.

    Args:
        version: The major version.
        kept: Folder for environments, kept from one run of the tests to the next.
        run: Folder of this run, shared by its processes: what failed once is not tried again in the same run.

    Raises:
        NoWheelError: There is no wheel.
    """
    place = kept / f"mavsdk{version}-{sys.implementation.cache_tag}"
    refusal = run / f"{place.name}.refused"
    with only_one(kept):
        if refusal.exists():
            raise NoWheelError(refusal.read_text(encoding="utf-8"))
        if not _is_whole(place):
            try:
                _make(place, VERSIONS[version])
            except NoWheelError as error:
                refusal.write_text(str(error), encoding="utf-8")
                raise
    return _python(place)


def _make(place: Path, requirement: str) -> None:
    rmtree(place, ignore_errors=True)
    subprocess.run([sys.executable, "-m", "venv", place], check=True, stdin=subprocess.DEVNULL)
    options = ("--quiet", "--disable-pip-version-check", "--only-binary", ":all:")
    installed = subprocess.run(
        [_python(place), "-m", "pip", "install", *options, requirement],
        capture_output=True,
        check=False,
        stdin=subprocess.DEVNULL,
        text=True,
    )
    if installed.returncode:
        last = installed.stderr.strip().splitlines()[-1:]
        raise NoWheelError(f"{requirement}: {' '.join(last)}")
    (place / _WHOLE).write_text(_base(), encoding="utf-8")


def _is_whole(place: Path) -> bool:
    """Whether an environment was made to its end, by the Python that is there now."""
    mark = place / _WHOLE
    return mark.exists() and mark.read_text(encoding="utf-8") == _base()


def _base() -> str:
    return f"{sys.base_prefix} {sys.version}"


def _python(place: Path) -> Path:
    return place / ("Scripts" if os.name == "nt" else "bin") / "python"
