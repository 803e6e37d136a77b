"""When, by what program and from what a flight was made, and the hashes by which its files are known again.

``provenance.json`` in a flight's folder is a list with an object for each program that flew the flight, the first and
those that took it up again. It is no part of the record: that follows from mission, vehicle and seed alone.
"""

import hashlib
import json
import platform
from datetime import UTC, datetime
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from typing import Any, Final

from mission.report.markup import Row, text_of
from mission.whole_file import write_whole

PROVENANCE_FILE: Final = "provenance.json"
_PROGRAM: Final = "ltl-mission"
_LIBRARIES: Final = ("numpy", "scipy", "shapely", "clarabel", "pymavlink")
"""Those on which a plan and a flight depend."""
_MADE_HERE: Final = frozenset({".png", ".svg", ".pdf", ".html", ".csv", ".txt"})
"""What a report writes itself."""
_SUMMARY: Final = "summary.json"
_SAID: Final = (("begun", "Begun"), ("command", "Command"), ("seed", "Seed of the bundled vehicle"), ("program", "By"))


def note_run(folder: Path, command: str, seed: str | None) -> None:
    """Write down that a program flies the flight in a folder from now on.

    Args:
        folder: The flight's.
        command: The command line.
        seed: Of the bundled vehicle; None for another.

    Raises:
        OSError: The folder cannot be written to.
    """
    run = {
        "begun": datetime.now(UTC).isoformat(timespec="seconds"),
        "command": command,
        "seed": seed,
        "program": f"{_PROGRAM} {_version(_PROGRAM)}",
        "python": platform.python_version(),
        "platform": platform.platform(),
        "libraries": {name: _version(name) for name in _LIBRARIES},
    }
    write_whole(folder / PROVENANCE_FILE, json.dumps([*_runs(folder), run], indent=2) + "\n")


def provenance_rows(folder: Path) -> list[Row]:
    """What is known of how a flight was made, and SHA-256 of its files.

    Raises:
        OSError: A file of the folder cannot be read.
    """
    rows: list[Row] = []
    for run in _runs(folder):
        rows += [(title, str(run[name])) for name, title in _SAID if run.get(name) is not None]
        system = [f"Python {run.get('python', '')}", str(run.get("platform", "")), text_of(run.get("libraries", {}))]
        rows.append(("With", "; ".join(system)))
    files = sorted(file for file in folder.iterdir() if file.is_file())
    rows += [
        (f"SHA-256 of {file.name}", hashlib.sha256(file.read_bytes()).hexdigest())
        for file in files
        if file.suffix not in _MADE_HERE and file.name != _SUMMARY
    ]
    return [*rows, ("This report by", f"{_PROGRAM} {_version(_PROGRAM)}, Bokeh {_version('bokeh')}")]


def _runs(folder: Path) -> list[dict[str, Any]]:
    """What was written down; nothing of a file that is damaged."""
    try:
        runs = json.loads((folder / PROVENANCE_FILE).read_bytes())
    except (OSError, ValueError, RecursionError):
        return []
    return [run for run in runs if isinstance(run, dict)] if isinstance(runs, list) else []


def _version(package: str) -> str:
    try:
        return version(package)
    except PackageNotFoundError:  # a checkout that was not installed
        return "of a checkout"
