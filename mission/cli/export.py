"""``mission export``: a plan in the files of other programs."""

from argparse import Namespace
from pathlib import Path

from mission.cli.inputs import bad_file, is_plan, planned, read_plan, write_named
from mission.cli.screen import out, print_warnings
from mission.decimals import count, decimal, measure
from mission.errors import Fault, SpecError
from mission.export.files import FENCED, UPLOADED, WRITERS
from mission.export.placed_plan import PlacedPlan, placed_plan
from mission.export.route import LEAST_TOLERANCE_M, usual_tolerance
from mission.export.uploads import autopilot_plan
from mission.geometry.geodesy import LatLon
from mission.interchange.autopilot_plan import EVER_AGAIN, AutopilotPlan, Command
from mission.plan import FlightPlan
from mission.printable import printable
from mission.spec.heading import heading_text

_MANY_ITEMS = 700
"""What an autopilot with little memory keeps; ArduPilot's boards without a card have room for about so many."""


def run(arguments: Namespace) -> int:
    """Plan where that is not done yet, write the file whole, and say what is in it."""
    file = Path(arguments.to)
    writer = WRITERS.get(file.suffix.lower())
    if writer is None:
        raise _fault("--to", f"{file.name!r} ends in none of {', '.join(WRITERS)}", "the ending says what to write")
    if file.exists() and not arguments.force:
        raise _fault("--to", f"{file} exists", "name another file, or give `--force` to write over it")
    given = Path(arguments.plan)
    plan = read_plan(given)[0] if is_plan(given) else planned(arguments.plan)
    tolerance_m = usual_tolerance(plan) if arguments.tolerance is None else arguments.tolerance
    if tolerance_m < LEAST_TOLERANCE_M:
        raise _fault(
            "--tolerance", f"{decimal(tolerance_m)} m is finer than autopilots keep places", "0.01 is the least"
        )
    placed = placed_plan(plan, _origin(plan, arguments), tolerance_m)
    write_named("--to", file, writer(placed, plan.spec.name, arguments.flavour))
    _say(placed, file, arguments.flavour)
    return 0


def _origin(plan: FlightPlan, arguments: Namespace) -> LatLon:
    """Where the domain lies."""
    origin = plan.spec.origin
    if origin is not None and arguments.at is not None:
        place = f"{decimal(origin.latitude_deg)}, {decimal(origin.longitude_deg)}"
        raise _fault("--at", f"the mission has its place, its (0, 0) is at {place}", "leave `--at` out")
    if origin is None and arguments.at is None:
        hint = "give latitude and longitude of its (0, 0) with `--at LAT,LON`, or write them as `origin` into the file"
        raise bad_file(Path(arguments.plan), "the mission has no place on Earth", hint)
    return origin or arguments.at


def _fault(option: str, message: str, hint: str) -> SpecError:
    return SpecError((Fault(0, 0, option, message, hint),))


def _say(placed: PlacedPlan, file: Path, firmware: str) -> None:
    """What was written, in figures."""
    route, tube_m = placed.route, placed.plan.certificate.tube_m
    _print(f"Exported       {printable(str(file))}")
    _print(
        f"Path           {count(len(route.once) - 1, 'straight leg')}, "
        f"at most {measure(route.deviation_m)} m from the smooth path"
    )
    if route.deviation_m < tube_m:
        _print(f"               {measure(tube_m - route.deviation_m)} m per axis of the proved tube are left")
    _print(f"               they spell {placed.word_text}{', the lap once' if route.lap is not None else ''}")
    warnings = []
    if route.deviation_m > tube_m:
        warnings.append(
            f"the legs may leave the proved tube, {tube_m:g} m per axis: that they violate nothing was seen for a "
            f"vehicle exactly on them"
        )
    if file.suffix.lower() in UPLOADED:
        upload = autopilot_plan(placed, firmware)
        _say_uploaded(placed, upload, fenced=file.suffix.lower() == FENCED)
        if len(upload.items) > _MANY_ITEMS:
            warnings.append(
                f"not every autopilot keeps more than {_MANY_ITEMS} items; a larger `--tolerance` makes fewer"
            )
    print_warnings(tuple(warnings))


def _say_uploaded(placed: PlacedPlan, upload: AutopilotPlan, *, fenced: bool) -> None:
    home, stops = upload.home, [item.params[0] for item in upload.items if item.command is Command.WAYPOINT]
    held = f", {count(sum(map(bool, stops)), 'stop')} of {sum(stops):g} s in all"
    _print(f"Mission        {count(len(upload.items), 'item')}, {upload.speed_m_s:g} m/s over ground{held}")
    for number, item in enumerate(upload.items, start=1):
        if item.command is Command.JUMP:
            again = int(item.params[1])
            laps = f"until item {number + 1} is chosen" if again == EVER_AGAIN else count(again + 1, "time")
            _print(f"               from item {item.params[0] + 1:.0f} the lap, {laps}")
    slow = {item.params[1] for item in upload.items if item.command is Command.CHANGE_SPEED} - {upload.speed_m_s}
    if slow:
        _print(f"               {', '.join(f'{each:g}' for each in sorted(slow))} m/s where regions ask for it")
    if heading := heading_text(placed.plan.spec.flight.heading):
        _print(f"               the nose {heading}")
    lanes = sum(item.command is Command.TRIGGER_CAMERA and item.params[0] > 0.0 for item in upload.items)
    if lanes:
        _print(f"               images by distance in {count(lanes, 'lane')}")
    if fenced:
        areas = count(len(upload.fence) - 1, "area")
        _print(f"Fence          {areas} to stay out of; the legs keep {measure(placed.clearance_m)} m from it")
        _print(f"Rally points   {len(upload.rally):,}")
    else:
        _print("Fence          none, a table has only the items; a .plan has it")
    _print(f"Take-off       {home.latitude_deg:.7f}, {home.longitude_deg:.7f}: there the vehicle is to stand")


def _print(line: str) -> None:
    out.print(line, markup=False, highlight=False)
