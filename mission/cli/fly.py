"""``mission fly``: fly a mission, show how it goes, and leave a record, a report and a verdict."""

from argparse import Namespace
from contextlib import ExitStack
from datetime import UTC, datetime
from pathlib import Path

from mission.cli.live import Display
from mission.cli.report import write_again
from mission.cli.screen import err, out
from mission.clock import WallClock
from mission.errors import Fault, MissionError, SpecError
from mission.fly import BundledVehicle, FlightOptions, FlightResult, StopSignals, VehicleOptions, fly, home_for
from mission.link.address import parse_address
from mission.link.transport import open_transport
from mission.plan import FlightPlan, plan_mission, plan_to_json
from mission.report.files import write_whole
from mission.report.record import FlightRecord
from mission.spec.loader import load_mission

MISSION_FILE = "mission.yaml"
PLAN_FILE = "plan.json"
_OF_THE_BUNDLED_VEHICLE = ("speed", "seed", "wind", "flavour", "no_ground_station")


def run(arguments: Namespace) -> int:
    """Fly, and return the verdict as an exit code."""
    _check_options(arguments)
    file = Path(arguments.file)
    plan = plan_mission(load_mission(file), run=arguments.run)
    out.print(
        f"{plan.spec.name}: {plan.path.length_m:.0f} m, {plan.trajectory.duration_s:.0f} s, proved within "
        f"{plan.certificate.tube_m:g} m of the smoothed path",
        markup=False,
    )
    record = _begin_record(Path(arguments.out), plan, file)
    folder = record.folder or Path(arguments.out)
    with StopSignals() as stop:
        try:
            with record:
                result = _fly(arguments, plan, record, stop)
            write_whole(folder / PLAN_FILE, plan_to_json(result.plan))
        except MissionError:
            err.print(f"the flight has failed; its record is kept in {folder}", markup=False)
            _report(folder, pictures=not arguments.no_pictures)
            raise
        _report(folder, pictures=not arguments.no_pictures)
    _print_verdict(result, folder)
    return result.exit_code


def _check_options(arguments: Namespace) -> None:
    if arguments.connect is None:
        return
    parse_address(arguments.connect)
    given = [name for name in _OF_THE_BUNDLED_VEHICLE if getattr(arguments, name)]
    if given:
        names = ", ".join("--" + name.replace("_", "-") for name in given)
        hint = f"leave out --connect to fly the bundled vehicle, or leave out {names}"
        raise SpecError((Fault(0, 0, names, "is for the bundled vehicle, not for one at an address", hint),))


def _begin_record(root: Path, plan: FlightPlan, file: Path) -> FlightRecord:
    stamp = datetime.now(UTC).strftime("%Y%m%d-%H%M%S")
    try:
        record = FlightRecord.in_folder(root, file.stem, stamp)
        folder = record.folder or root
        write_whole(folder / MISSION_FILE, file.read_bytes())
        write_whole(folder / PLAN_FILE, plan_to_json(plan))
    except OSError as error:
        fault = Fault(0, 0, "--out", f"no flight folder can be made: {error}", "name a folder that can be written to")
        raise SpecError((fault,), str(root)) from error
    return record


def _fly(arguments: Namespace, plan: FlightPlan, record: FlightRecord, stop: StopSignals) -> FlightResult:
    with ExitStack() as stack:
        address, vehicle = arguments.connect, None
        if address is None:
            vehicle = stack.enter_context(BundledVehicle(_vehicle_options(arguments, plan)))
            address = vehicle.address
        transport = open_transport(address)
        stack.callback(transport.close)
        display = stack.enter_context(Display(plan))
        return fly(
            plan,
            transport,
            WallClock(),
            record,
            options=FlightOptions(land_when_stopped=vehicle is not None),
            run=arguments.run,
            on_progress=display.show,
            vehicle_failure=None if vehicle is None else vehicle.failure,
            stop_reason=stop.reason,
        )


def _vehicle_options(arguments: Namespace, plan: FlightPlan) -> VehicleOptions:
    default = VehicleOptions()
    return VehicleOptions(
        speed=arguments.speed or default.speed,
        seed=arguments.seed,
        wind=arguments.wind,
        flavour=arguments.flavour,
        home=home_for(plan.spec),
        ground_station=not arguments.no_ground_station,
    )


def _report(folder: Path, *, pictures: bool) -> None:
    """A flight is not lost for want of a picture of it."""
    try:
        write_again(folder, pictures=pictures)
    except (MissionError, OSError) as error:
        err.print(f"the report could not be written: {error}; try `mission report {folder}`", markup=False)


def _print_verdict(result: FlightResult, folder: Path) -> None:
    flown = 0.0 if result.began_s is None or result.ended_s is None else result.ended_s - result.began_s
    word = " ".join("{" + ",".join(sorted(letter)) + "}" for i, letter in enumerate(result.word) if _new(result, i))
    out.print(f"flown     {flown:.0f} s of vehicle time in {result.elapsed_s:.1f} s", markup=False)
    out.print(f"word      {word}", markup=False)
    out.print(f"tracking  at most {result.largest_distance_m:.2f} m from the trajectory", markup=False)
    if result.plan.run.recurrent:
        out.print(f"laps      {result.laps} of {result.plan.spec.flight.laps}", markup=False)
    out.print(f"report    {folder / 'report.html'}", markup=False)
    colour, name = ("green", "ACHIEVED") if result.achieved else ("red", "NOT ACHIEVED")
    out.print(f"[bold {colour}]{name}[/]  ", end="")
    out.print(result.reason, markup=False)


def _new(result: FlightResult, index: int) -> bool:
    return index == 0 or result.word[index] != result.word[index - 1]
