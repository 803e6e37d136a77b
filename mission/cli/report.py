"""``mission report``: write the report and the pictures of a flight folder again, or compare several flights."""

from argparse import Namespace
from dataclasses import replace
from pathlib import Path
from typing import Any, Final

from rich.box import SIMPLE_HEAD
from rich.markup import escape
from rich.table import Table

from mission.cli.busy import doing
from mission.cli.inputs import bad_file, read_plan
from mission.cli.screen import out, print_json
from mission.errors import RecordError, reason
from mission.plan import FlightPlan, plan_mission
from mission.printable import printable
from mission.report.comparison import comparison
from mission.report.reading import LaterPlan, Record, read_record
from mission.report.record import RECORD_FILE
from mission.report.report import PAGE_FILE, write_report
from mission.report.summary import summary

MISSION_FILE = "mission.yaml"
PLAN_FILE = "plan.json"
_VERDICTS: Final = {True: "achieved", False: "not achieved", None: "open"}
_HINT = "name a folder that 'mission fly' made, such as flights/survey-20250131-120000"


def run(arguments: Namespace) -> int:
    """Read a flight folder and write its report; of several folders, compare the flights."""
    if len(arguments.folder) > 1:
        return _compare(arguments)
    folder = Path(arguments.folder[0])
    try:
        numbers = write_again(folder, pictures=True, form=arguments.format)
    except OSError as error:
        raise bad_file(folder, f"the report cannot be written: {reason(error)}", "make the folder writable") from error
    if arguments.json:
        print_json({"exit_code": 0, "folder": str(folder), "report": str(folder / PAGE_FILE), **numbers})
    out.print(f"report    {folder / PAGE_FILE}", markup=False)
    for file in sorted(folder.iterdir()) if arguments.verbose else ():
        out.print(f"{file.stat().st_size:>12,}  {file.name}", markup=False)
    return 0


def _compare(arguments: Namespace) -> int:
    """Show flights side by side; nothing is written."""
    with doing("reading the flights"):
        flights = [(folder, *flight_in(Path(folder))[:2]) for folder in arguments.folder]
        rows = comparison([(folder, summary(plan, record)) for folder, plan, record in flights])
    if arguments.json:
        print_json({"exit_code": 0, "flights": rows})
    table = Table(box=SIMPLE_HEAD, show_edge=False, pad_edge=False, padding=(0, 1, 0, 0))
    for name in ("flight", "verdict", "took", "error,\nrms", "error,\nmost", "nearest", "battery"):
        folds = name in ("flight", "nearest")
        table.add_column(name, overflow="fold", no_wrap=not folds, justify="left" if folds else "right")
    for row in rows:
        table.add_row(*map(escape, _cells(row)))
    out.print(table)
    for row in rows if arguments.verbose else ():
        out.print(f"{Path(row['folder']).name}: {row['reason']}", markup=False)
    return 0


def _cells(row: dict[str, Any]) -> tuple[str, ...]:
    """A flight in words, a line for each restricted region."""

    def told(name: str, unit: str, digits: int = 2) -> str:
        return "" if row[name] is None else f"{row[name]:.{digits}f} {unit}"

    near = sorted(row["distance_to_restricted_m"].items(), key=lambda each: each[1])
    charge = row["charge_percent"]
    return (
        printable(Path(row["folder"]).name),
        _VERDICTS[row["achieved"]],
        told("duration_s", "s", 1),
        told("rms_error_m", "m"),
        told("largest_error_m", "m"),
        "\n".join(f"{printable(name)} {distance_m:.2f} m" for name, distance_m in near),
        "" if charge is None else f"{charge[0]:.0f} to {charge[-1]:.0f} %",
    )


def write_again(folder: Path, *, pictures: bool, form: str = "png") -> dict[str, Any]:
    """Write the report of a flight from its folder alone; return its summary.

    Raises:
        SpecError: The folder is not one of a flight.
        RecordError: Its record is damaged other than by a cut last line.
        OSError: It cannot be written to.
    """
    with doing("reading the flight"):
        plan, record, mission_text = flight_in(folder)
    with doing("drawing the report" if pictures else "writing the report"):
        return write_report(plan, record, folder, pictures=pictures, form=form, mission_text=mission_text)


def flight_in(folder: Path) -> tuple[FlightPlan, Record, str]:
    """The plan that was flown first, the record with its later plans, and the mission's text, of a flight's folder.

    Raises:
        SpecError: The folder is not one of a flight.
        RecordError: Its record is damaged other than by a cut last line.
    """
    if not folder.is_dir():
        raise bad_file(folder, "is not a folder" if folder.exists() else "there is no such folder", _HINT)
    missing = [name for name in (PLAN_FILE, MISSION_FILE, RECORD_FILE) if not (folder / name).is_file()]
    if missing:
        raise bad_file(folder, f"this is not the folder of a flight: it has no {', no '.join(missing)}", _HINT)
    plan, _ = read_plan(folder / PLAN_FILE)
    try:
        mission_text = (folder / MISSION_FILE).read_bytes().decode("utf-8-sig", "replace")
        record = read_record(folder / RECORD_FILE)
    except OSError as error:
        raise bad_file(folder, f"the flight cannot be read: {reason(error)}", "see its permissions") from error
    except RecordError as error:
        raise RecordError(f"{folder / RECORD_FILE}: {error}", line=error.line) from error
    record = with_later_plans(record, folder)
    return _as_flown(plan, record), record, mission_text


def with_later_plans(record: Record, folder: Path) -> Record:
    """A record with the plans that were made in flight, from the files beside it.

    Raises:
        SpecError: One is not there, or is no plan.
    """
    missing = [name for _, number, *_ in record.takeovers if not (folder / (name := later_plan_file(number))).exists()]
    if missing:
        hint = "put it back: without it nobody knows what was flown from then on"
        raise bad_file(folder, f"{missing[0]} is missing, a plan that was taken over in flight", hint)
    later = tuple(
        LaterPlan(from_s, read_plan(folder / later_plan_file(number))[0], laps, begun)
        for from_s, number, laps, begun in record.takeovers
    )
    return replace(record, later=later)


def later_plan_file(number: int) -> str:
    """The name of a plan that was made in flight, numbered from 2."""
    return f"plan-{number}.json"


def _as_flown(plan: FlightPlan, record: Record) -> FlightPlan:
    """The plan that was flown: one with a place on Earth was made anew where the vehicle stood."""
    starts = [event.values.get("start_m") or () for event in record.events if event.text == "planned"]
    if not starts:
        return plan
    try:
        east, north = map(float, starts[-1])
    except (TypeError, ValueError, OverflowError) as error:
        raise RecordError("the record does not say where its flight began", line=0) from error
    return plan if (east, north) == plan.start_m else plan_mission(plan.spec, start_m=(east, north), run=plan.asked_run)
