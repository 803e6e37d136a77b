"""What programs do with a plan beside making it: fly it, prove it anew, judge flights by its mission."""

import io
from contextlib import ExitStack
from datetime import UTC, datetime
from pathlib import Path
from typing import TYPE_CHECKING

import yaml

from mission.clock import Clock, TimeOfDay
from mission.fly import FlightOptions, FlightResult, VehicleOptions, fly, home_for
from mission.fly.folder import FlightFolder
from mission.fly.linking import linked
from mission.plan import FlightPlan, plan_to_json
from mission.report.record import FlightRecord
from mission.spec.document import document_of
from mission.spec.model import MissionSpec
from mission.verify.flown.judging import Judged, judged
from mission.verify.flown.reach import FASTEST_M_S
from mission.verify.logs.reading import read_flight
from mission.verify.plans import Claim, claims
from mission.whole_file import write_whole

if TYPE_CHECKING:
    from mission.fly.recording import RecordWriter


def fly_plan(
    plan: FlightPlan,
    address: str | None = None,
    *,
    folder: Path | None = None,
    vehicle: VehicleOptions | None = None,
    options: FlightOptions | None = None,
) -> FlightResult:
    """Fly a plan over MAVLink, to its end.

    Args:
        plan: What to fly. A mission with a place on Earth is planned anew from where the vehicle stands.
        address: Where the vehicle is, such as ``udpin:0.0.0.0:14550``; without one the bundled vehicle is started, and
            lands where the flight is given up.
        folder: Where a folder of the flight goes, as ``mission report`` and ``mission verify --flight`` read it; by
            default nothing is kept.
        vehicle: How the bundled vehicle is started: its seed, its wind, its flavour; at its ``home``, by default, the
            mission's start.
        options: How the flight is conducted; the library's own default sets no geofence.

    Returns:
        The verdict, what was flown, and how closely.

    Raises:
        LinkError: The vehicle could not be found, or was lost.
        VehicleError: It refused, failed, or did not do what it accepted.
        NoPlanError: It stands where this mission cannot be flown from.
        OSError: The folder cannot be written to.
    """
    started = vehicle or VehicleOptions(home=home_for(plan.spec), ground_station=False)
    conducted = options or FlightOptions(land_when_stopped=address is None)
    with ExitStack() as stack:
        running, transport, clock = linked(address or started, conducted.link, stack)
        failure = None if running is None else running.failure
        record: RecordWriter = FlightRecord(io.BytesIO(), mission=plan.spec.name)
        if folder is not None:
            kept = stack.enter_context(_folder(plan, folder, clock))
            record, transport = kept, kept.logged(transport)
        return fly(plan, transport, clock, record, options=conducted, vehicle_failure=failure)


def _folder(plan: FlightPlan, root: Path, clock: Clock) -> FlightFolder:
    """A flight's folder with its mission and its plan."""
    stamp = datetime.now(UTC).strftime("%Y%m%d-%H%M%S")
    folder = FlightFolder.begun(root, "flight", TimeOfDay(clock).us, stamp)
    document = yaml.safe_dump(document_of(plan.spec), sort_keys=False, allow_unicode=True)
    write_whole(folder.path / "mission.yaml", document)
    write_whole(folder.path / "plan.json", plan_to_json(plan))
    return folder


def verify_plan(plan: FlightPlan) -> tuple[Claim, ...]:
    """Judge each claim of a plan by the checker that shares only geometry and automata with the planner.

    Returns:
        A row a claim: its name, what is wrong with it, empty where nothing is, and its figure.

    Raises:
        SpecError: The plan cannot be read back.
    """
    return tuple(claims(plan_to_json(plan)))


def judge_flight(
    log: Path,
    mission: MissionSpec,
    *,
    plan: FlightPlan | None = None,
    system: int | None = None,
    number: int | None = None,
    fastest_m_s: float = FASTEST_M_S,
) -> Judged:
    """Judge any flight of which there is a log, whoever flew it, by a mission.

    Args:
        log: A ``.tlog``, an ArduPilot ``.bin``, a PX4 ``.ulg``, each packed by gzip or not, or a flight's folder.
        mission: What it is judged by.
        plan: A plan of it, for the distance from its path.
        system: The system id of the vehicle, of a ``.tlog`` that has several.
        number: Which flight of the log, from 1; the longest by default.
        fastest_m_s: No vehicle was faster: what bounds where it may have been in gaps.

    Returns:
        The verdict, None where it cannot be told, with the word, violations, doubts, and how near it came.

    Raises:
        OSError: The log cannot be read.
        LogError: It is no log, or has no such flight.
        RecordError: It is a record that is damaged.
    """
    start_m = mission.start.position_m if plan is None else plan.start_m
    flight = read_flight(log, origin=mission.origin, start_m=start_m, system=system, number=number)
    return judged(mission, flight.track, plan=plan, fastest_m_s=fastest_m_s)
