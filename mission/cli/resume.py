"""``mission fly --resume``: a flight's folder as what is left of its flight, and its record to go on with."""

from argparse import Namespace
from pathlib import Path

from mission.cli.given import changes_of
from mission.cli.inputs import bad_file, unwritable
from mission.cli.report import flight_in
from mission.clock import Clock, TimeOfDay
from mission.errors import Fault, RecordError, SpecError
from mission.fly.amendments import amended_file
from mission.fly.folder import FlightFolder
from mission.fly.resuming import Unfinished, unfinished
from mission.report.reading import LEG, Record
from mission.spec.loader import load_mission
from mission.spec.model import MissionSpec


def left_in(arguments: Namespace) -> Unfinished | None:
    """The flight that is to be taken up again; None where a mission file is to be flown from its start.

    Raises:
        SpecError: Options do not go together, or the folder is not one of a flight.
        RecordError: Its flight has come to its end, or never began; or its record is damaged.
    """
    if arguments.resume is None:
        if arguments.file is None:
            hint = "name one, such as missions/survey.yaml, or a flight's folder with `--resume`"
            raise SpecError((Fault(0, 0, "FILE", "no mission file is named", hint),))
        return None
    faults = [
        Fault(0, 0, option, "a flight that is taken up again keeps what it had", "leave it out")
        for option in (*(["--run"] * (arguments.run is not None)), *changes_of(arguments))
    ]
    if arguments.file is not None:
        faults.append(Fault(0, 0, "FILE", "the mission is the one in the folder of the flight", "leave it out"))
    if arguments.connect is None:
        hint = "write where it is heard, such as --connect udpin:0.0.0.0:14550"
        faults.append(Fault(0, 0, "--connect", "a flight is taken up again with the vehicle that is in the air", hint))
    if faults:
        raise SpecError(tuple(faults))
    folder = Path(arguments.resume)
    plan, record, _ = flight_in(folder)
    try:
        return unfinished(plan, record, _amended_last(folder, record))
    except RecordError as error:
        raise RecordError(f"{folder}: {error}", line=error.line) from error


def _amended_last(folder: Path, record: Record) -> MissionSpec | None:
    """The mission as it was amended last in flight; None where it was not, or was not kept."""
    amended = [event.values["number"] for event in record.events if event.text == LEG and event.values.get("amended")]
    file = folder / amended_file(int(amended[-1])) if amended else None
    return load_mission(file) if file is not None and file.is_file() else None


def reopened(folder: Path, record: Record, clock: Clock) -> FlightFolder:
    """The folder of a flight, to go on with.

    Raises:
        SpecError: It cannot be written to, or another program still flies this flight.
        RecordError: Another program has flown it on since it was read.
    """
    try:
        return FlightFolder.reopened(folder, record.mission, TimeOfDay(clock).us, record.size)
    except BlockingIOError as error:
        hint = "end that program first; a flight has one"
        raise bad_file(folder, "another program still flies this flight", hint) from error
    except OSError as error:
        raise unwritable("--resume", folder, error) from error
