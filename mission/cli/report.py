"""``mission report``: write the report and the pictures of a flight folder again."""

from argparse import Namespace
from pathlib import Path

from mission.cli.screen import out
from mission.errors import Fault, SpecError
from mission.plan import FlightPlan, plan_from_json, plan_mission
from mission.report.reading import Record, read_record
from mission.report.record import RECORD_FILE
from mission.report.report import PAGE_FILE, write_report


def run(arguments: Namespace) -> int:
    """Read a flight folder and write its report."""
    folder = Path(arguments.folder)
    write_again(folder, pictures=True)
    out.print(f"report    {folder / PAGE_FILE}", markup=False)
    return 0


def write_again(folder: Path, *, pictures: bool) -> None:
    """Write the report of a flight from its folder alone.

    Raises:
        SpecError: The folder is not one of a flight.
        RecordError: Its record is damaged other than by a cut last line.
        OSError: It cannot be written to.
    """
    try:
        plan = plan_from_json((folder / "plan.json").read_text(encoding="utf-8"))
        mission_text = (folder / "mission.yaml").read_text(encoding="utf-8")
        record = read_record(folder / RECORD_FILE)
    except (OSError, UnicodeDecodeError) as error:
        fault = Fault(0, 0, "", f"this is not the folder of a flight: {error}", "name one that 'mission fly' made")
        raise SpecError((fault,), str(folder)) from error
    write_report(_as_flown(plan, record), record, folder, pictures=pictures, mission_text=mission_text)


def _as_flown(plan: FlightPlan, record: Record) -> FlightPlan:
    """The plan that was flown: one with a place on Earth was made anew where the vehicle stood."""
    starts = [event.values["start_m"] for event in record.events if event.text == "planned"]
    if not starts or tuple(starts[-1]) == plan.start_m:
        return plan
    east, north = starts[-1]
    return plan_mission(plan.spec, start_m=(float(east), float(north)), run=plan.run_index)
