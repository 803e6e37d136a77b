"""What commands read and write: mission files, plans, and files that a user names; each failure says which."""

import re
from dataclasses import replace
from pathlib import Path

from mission.cli.busy import doing
from mission.cli.changes import LAPS
from mission.cli.given import Given, mission_of
from mission.cli.mission_input import shown
from mission.errors import Fault, SpecError, reason
from mission.plan import FlightPlan, plan_from_json, plan_mission
from mission.whole_file import write_whole

_MOST_OF_A_PLAN = 1 << 28
_BEGINS_PLAN = re.compile(rb'\s*\{\s*"format"\s*:\s*"ltl-mission plan')


def planned(file: str, run: int | None = None, given: Given | None = None) -> FlightPlan:
    """Read a mission file and plan it, with another run and other values than the file's where they are given.

    Raises:
        SpecError: The file has faults, or there is no run of that number, or no lap; its source is the file.
        NoPlanError: There is no plan.
    """
    spec = mission_of(file, given or {})
    try:
        with doing(f"planning {Path(shown(file)).name}"):
            plan = plan_mission(spec, run=run)
    except SpecError as error:
        faults = error.faults
        if run is not None:
            faults = tuple(
                replace(fault, path="--run" if fault.path == "mission.run" else fault.path) for fault in faults
            )
        raise SpecError(faults, shown(file)) from error
    if given and LAPS in given and not plan.run.recurrent:
        hint = "leave `--laps` out, or ask for what recurs, such as G F (a & F b)"
        raise SpecError(
            (Fault(0, 0, "--laps", "this mission has no laps: it ends once it is done", hint),), shown(file)
        )
    return plan


def is_plan(file: Path) -> bool:
    """Whether a file begins as ``mission plan --out`` writes a plan; False where it cannot be read."""
    try:
        with file.open("rb") as stream:
            return bool(_BEGINS_PLAN.match(stream.read(128)))
    except OSError:
        return False


def read_plan(file: Path) -> tuple[FlightPlan, str]:
    """Read a plan that was written to a file, and the text of it.

    Raises:
        SpecError: There is no such plan; its source is the file.
    """
    if file.is_dir():
        hint = f"name the plan in it, {file / 'plan.json'}, or judge the flight in it: mission verify --flight {file}"
        raise bad_file(file, "is a folder, and no plan", hint)
    try:
        with file.open("rb") as stream:
            content = stream.read(_MOST_OF_A_PLAN + 1)
        if len(content) > _MOST_OF_A_PLAN:
            raise bad_file(file, "is too large for a plan", "name a file that 'mission plan --out' wrote")
        text = content.decode("utf-8")
        return plan_from_json(text), text
    except UnicodeDecodeError as error:
        raise bad_file(file, "is not a plan: it is not text", "name a file that 'mission plan --out' wrote") from error
    except OSError as error:
        raise bad_file(
            file, f"cannot be read: {reason(error)}", "name a file that 'mission plan --out' wrote"
        ) from error
    except SpecError as error:
        if error.source:
            raise
        # Lines count in the mission within the plan, which has none of its own.
        raise SpecError(tuple(replace(fault, line=0, column=0) for fault in error.faults), str(file)) from error


def write_named(option: str, file: Path, content: bytes | str) -> None:
    """Write a whole file that an option names.

    Raises:
        SpecError: It cannot be written.
    """
    if not file.name:
        raise SpecError((Fault(0, 0, option, "this names no file", f"write {option} and the name of a file"),))
    try:
        write_whole(file, content)
    except OSError as error:
        raise unwritable(option, file, error) from error


def unwritable(option: str, place: Path, error: OSError | ValueError) -> SpecError:
    """The failure to write where an option says."""
    hint = f"give {option} a place that can be written to"
    return SpecError((Fault(0, 0, option, f"{place} cannot be written: {reason(error)}", hint),))


def bad_file(file: Path, message: str, hint: str) -> SpecError:
    """The failure of a file as a whole."""
    return SpecError((Fault(0, 0, "", message, hint),), str(file))
