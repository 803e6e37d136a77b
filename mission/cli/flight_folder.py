"""What ``mission fly`` lays into a flight's folder before it flies."""

import json
from datetime import UTC, datetime
from pathlib import Path
from typing import Final

from mission.cli.given import Given, text_with
from mission.cli.inputs import unwritable
from mission.cli.mission_input import content_of, stem_of
from mission.cli.report import MISSION_FILE, PLAN_FILE
from mission.clock import Clock, TimeOfDay
from mission.fly.folder import FlightFolder
from mission.plan import FlightPlan, plan_to_json
from mission.spec.drawn_files import drawn_files
from mission.spec.structure import plain_data
from mission.spec.yaml_tree import read_tree
from mission.whole_file import write_whole

WRITTEN_FILE: Final = "mission-as-written.yaml"
OVERRIDES_FILE: Final = "overrides.json"
AUTOMATON_SUFFIX: Final = ".hoa"


def begin_folder(root: Path, plan: FlightPlan, file: Path, clock: Clock, given: Given | None = None) -> FlightFolder:
    """Begin a flight's folder: the mission as it is flown, its plan, and what grows with the flight.

    Where something was given on the command line, the file as its user wrote it and what was given lie beside it.

    Raises:
        SpecError: The folder cannot be written to.
    """
    stamp = datetime.now(UTC).strftime("%Y%m%d-%H%M%S")
    written = content_of(file)
    try:
        folder = FlightFolder.begun(root, stem_of(file), TimeOfDay(clock).us, stamp)
        mission_text = text_with(plan.spec, file, given).encode() if given else written
        write_whole(folder.path / MISSION_FILE, mission_text)
        if given:
            write_whole(folder.path / WRITTEN_FILE, written)
            values = {".".join(key): value for key, value in given.values()}
            write_whole(folder.path / OVERRIDES_FILE, json.dumps(values, indent=2) + "\n")
        write_whole(folder.path / PLAN_FILE, plan_to_json(plan))
        _write_automaton(folder.path, plan)
        _write_drawings(folder.path, mission_text, file.parent)
    except OSError as error:
        raise unwritable("--out", root, error) from error
    return folder


def _write_automaton(folder: Path, plan: FlightPlan) -> None:
    """Lay the mission's automaton beside the copy of the mission, where that will look for it."""
    named = plan.spec.automaton
    if named is not None and named.file == Path(named.file).name and named.file.endswith(AUTOMATON_SUFFIX):
        write_whole(folder / named.file, named.text)


def _write_drawings(folder: Path, mission_text: bytes, beside: Path) -> None:
    """Lay the files that draw regions of the mission beside its copy, too."""
    data, _ = plain_data(read_tree(mission_text.decode("utf-8-sig"))[0])
    for name in drawn_files(data):
        if name == Path(name).name and not (folder / name).exists():
            write_whole(folder / name, (beside / name).read_bytes())
