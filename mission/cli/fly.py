"""``mission fly``: fly a mission, show how it goes, and leave a record, a report and a verdict."""

from argparse import Namespace
from collections.abc import Callable
from contextlib import AbstractContextManager, ExitStack, suppress
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

from mission.cli.busy import doing
from mission.cli.extent import extent, without
from mission.cli.findings import print_departure
from mission.cli.flight_folder import begin_folder
from mission.cli.given import changes_of
from mission.cli.inputs import planned
from mission.cli.live import Display
from mission.cli.mission_input import shown
from mission.cli.narration import Narrated
from mission.cli.report import PLAN_FILE, later_plan_file, write_again
from mission.cli.resume import left_in, reopened
from mission.cli.screen import err, error_values, out, print_error, print_json, print_warnings, reach
from mission.cli.signals import EndingSignals
from mission.cli.vehicle_link import UNHEARD, check_vehicle_options, link_options, link_to, warn
from mission.clock import Clock, WallClock
from mission.errors import LinkError, MissionError, reason
from mission.fly import FlightOptions, FlightResult, Progress, StopSignals, fly
from mission.fly.amendments import AmendmentFolder
from mission.fly.folder import FlightFolder
from mission.fly.planner_process import PlannerProcess
from mission.fly.preflight import Checks, NoGoError, check_forced
from mission.fly.replanner import Replanner, SynchronousReplanner
from mission.fly.resuming import Unfinished
from mission.link.identity import LinkOptions
from mission.plan import FlightPlan, plan_to_json
from mission.printable import printable
from mission.report.pictures import IMAGES_FILE, write_pictures
from mission.report.provenance import note_run
from mission.report.reading import read_record
from mission.report.report import PAGE_FILE
from mission.spec.model import FIELD
from mission.whole_file import write_whole

if TYPE_CHECKING:
    from mission.view.server import PageServer


def run(arguments: Namespace) -> int:
    """Fly, and return the verdict as an exit code, whether or not somebody reads what is said of it."""
    check_vehicle_options(arguments)
    check_forced(arguments.force)
    link = link_options(arguments)
    left = left_in(arguments)
    given = changes_of(arguments)
    plan = planned(arguments.file, arguments.run, given) if left is None else left.legs.legs[0].plan
    with suppress(OSError):
        if left is not None:
            out.print(f"taken up again from {arguments.resume}", markup=False)
        proved = f"proved {reach(plan.certificate.tube_m)}"
        if plan.spec.flight.guidance == FIELD:
            proved = "by the field, without a proof of a tube"
        out.print(f"{printable(plan.spec.name)}: {extent(plan)}, {proved}{without(plan)}", markup=False)
    print_warnings(plan.warnings, shown(arguments.file or arguments.resume))
    with StopSignals() as stop:
        try:
            flight = _flown(arguments, link, plan, left, stop)
        except KeyboardInterrupt:  # what was interrupted has been said
            return stop.exit_code
        hurried = stop.take() is not None
    if link.signatures is not None:
        link.signatures.end()
    reported = _report(
        flight.folder,
        pictures=flight.heard and not arguments.no_pictures,
        form=arguments.format,
        hurried=hurried,
    )
    if arguments.json:
        print_json(_document(flight, plan, reported=reported))
    with suppress(OSError):
        if flight.result is not None:
            _print_verdict(flight.result, flight.folder, flight.elapsed_s, reported=reported)
        else:
            report = f", its report is {flight.folder / PAGE_FILE}" if reported else ""
            err.print(f"the flight is kept in {flight.folder}{report}", markup=False)
    return flight.exit_code


def _document(flight: "_Flown", plan: FlightPlan, *, reported: bool) -> dict[str, object]:
    """What came of a flight, for programs."""
    document = {
        "mission": plan.spec.name,
        "folder": str(flight.folder),
        "report": str(flight.folder / PAGE_FILE) if reported else None,
        **({"exit_code": 0} if flight.failure is None else error_values(flight.failure)),
    }
    result = flight.result
    if result is None:
        return {**document, "achieved": False, "exit_code": flight.exit_code}
    return {
        **document,
        "exit_code": flight.exit_code,
        "vehicle": result.vehicle,
        "duration_s": _duration_s(result),
        "elapsed_s": flight.elapsed_s,
        "tube_m": result.plan.certificate.tube_m,
        **result.values(),
    }


@dataclass(frozen=True)
class _Flown:
    """What there is once a flight is over.

    Attributes:
        folder: Of its files.
        heard: Whether there is a flight to draw.
        exit_code: What the program says of it.
        failure: Why it failed; None where it came to an end.
        result: What it came to; None where it failed, which was told.
        elapsed_s: How long it took on the wall clock; 0 where it failed.
    """

    folder: Path
    heard: bool
    exit_code: int
    failure: MissionError | None = None
    result: FlightResult | None = None
    elapsed_s: float = 0.0


def _flown(
    arguments: Namespace, link: LinkOptions, plan: FlightPlan, left: Unfinished | None, stop: StopSignals
) -> _Flown:
    """Fly, and let go of the vehicle; a failure is told here."""
    with ExitStack() as stack:
        page = stack.enter_context(_page(plan, opens=arguments.open)) if arguments.view or arguments.open else None
        with doing("reaching the vehicle" if arguments.connect else "starting the vehicle"):
            vehicle, transport, clock = link_to(arguments, link, plan.spec, stack)
        if left is None:
            kept = begin_folder(Path(arguments.out), plan, Path(arguments.file), clock, changes_of(arguments))
        else:
            kept = reopened(Path(arguments.resume), left.record, clock)
        folder = stack.enter_context(kept).path
        stack.callback(_tell_losses, kept)
        _note_run(arguments, folder)
        replanner = _replanner(clock, stack, bundled=vehicle is not None)
        with suppress(OSError):
            err.print(f"recorded in {folder}", markup=False)
        display = stack.enter_context(Display(plan))
        wall = WallClock()
        began_s = wall.now_s()
        try:
            result = fly(
                plan,
                kept.logged(transport),
                clock,
                Narrated(kept) if arguments.verbose else kept,
                options=FlightOptions(
                    link=link,
                    land_when_stopped=vehicle is not None,
                    resume_when_handed_back=arguments.resume_when_handed_back,
                    fence=arguments.fence,
                    keep_fence=arguments.keep_fence,
                    checks=Checks(arguments.force, partial(print_departure, bundled=vehicle is not None)),
                ),
                run=arguments.run,
                on_progress=display.show if page is None else _both(display.show, page.feed.show),
                requests=None if page is None else page.feed,
                vehicle_failure=None if vehicle is None else vehicle.failure,
                stop_request=stop.take,
                on_warning=warn,
                replanner=replanner,
                amendments=AmendmentFolder(folder),
                unfinished=left,
                on_plan=lambda number, text: _keep_plan(folder / later_plan_file(number), text),
            )
        except MissionError as failure:
            if page is not None:
                page.say_at_the_end(f"the flight failed: {failure}")
            stack.close()
            if isinstance(failure, NoGoError) and not err.quiet:
                yields = not all(row.firm for row in failure.findings.forbidding)
                way = "; `--force ROW` overrides a row by its name" if yields else ""
                err.print(f"[bold red]no-go:[/] nothing was armed{way}")
            else:
                print_error(failure)
            if isinstance(failure, LinkError) and not display.heard:
                err.print(f"    {UNHEARD}", markup=False)
            return _Flown(folder, display.heard, failure.exit_code, failure)
        except KeyboardInterrupt:
            _keep_pictures(folder)
            err.print(f"interrupted; the record is kept in {folder}", markup=False)
            raise
        elapsed_s = wall.now_s() - began_s
        if page is not None:
            page.say_at_the_end(f"the flight is over: {'' if result.achieved else 'NOT '}ACHIEVED, {result.reason}")
    _keep_plan(folder / PLAN_FILE, plan_to_json(result.plans[0]))
    return _Flown(folder, heard=True, exit_code=result.exit_code, result=result, elapsed_s=elapsed_s)


def _note_run(arguments: Namespace, folder: Path) -> None:
    """Write down by what the flight is flown; without that it is still flown."""
    seed = "1, by default" if arguments.seed is None else str(arguments.seed)
    try:
        note_run(folder, arguments.command_line, None if arguments.connect else seed)
    except OSError as error:
        warn(f"what flies could not be written down: {reason(error)}")


def _page(plan: FlightPlan, *, opens: bool) -> "AbstractContextManager[PageServer]":
    """The page of the flight; what it takes is loaded for those who ask for it."""
    from mission.cli.view import live  # noqa: PLC0415 - see above

    return live(plan, opens=opens)


def _both(one: Callable[[Progress], None], other: Callable[[Progress], None]) -> Callable[[Progress], None]:
    def show(moment: Progress) -> None:
        one(moment)
        other(moment)

    return show


def _replanner(clock: Clock, stack: ExitStack, *, bundled: bool) -> Replanner:
    """What plans in flight: beside the loop; the bundled vehicle waits for it, so that the same seed flies the same."""
    if bundled:
        return SynchronousReplanner(clock.now_s)
    process = PlannerProcess()
    stack.callback(process.close)
    return process


def _tell_losses(kept: FlightFolder) -> None:
    """Say what is missing beside the record; of that the verdict tells."""
    for name, why in kept.incomplete.items():
        warn(f"{name} is not whole: {why}")


def _keep_pictures(folder: Path) -> None:
    """Write down where pictures were taken, of a flight that is left without a report."""
    with suppress(MissionError, OSError):
        write_pictures(read_record(folder).pictures, folder)


def _keep_plan(file: Path, text: str) -> None:
    """What was flown, planned anew where the mission has a place or in flight; without it the flight is still made."""
    try:
        write_whole(file, text)
    except OSError as error:
        warn(f"the plan that is flown could not be written: {reason(error)}")


def _report(folder: Path, *, pictures: bool, form: str, hurried: bool) -> bool:
    """Write the report; a signal, or one that has come already, leaves out the pictures, a second ends the program.

    Returns:
        Whether it is there.
    """
    with EndingSignals():
        try:
            try:
                write_again(folder, pictures=pictures and not hurried, form=form)
            except KeyboardInterrupt:
                hurried = True
                write_again(folder, pictures=False)
        except Exception as error:  # noqa: BLE001 - a flight is not lost for want of a picture of it
            known = isinstance(error, MissionError | OSError)
            why = reason(error) if known else f"an error of this program, {type(error).__name__}: {error}"
            err.print(f"the report could not be written: {why}; try `mission report {folder}`", markup=False)
            return False
    if pictures and hurried:
        err.print(f"the pictures are left out; `mission report {folder}` draws them", markup=False)
    return True


def _print_verdict(result: FlightResult, folder: Path, elapsed_s: float, *, reported: bool) -> None:
    word = " ".join("{" + ",".join(sorted(letter)) + "}" for i, letter in enumerate(result.word) if _new(result, i))
    out.print(f"flown     {_duration_s(result):.0f} s of vehicle time in {elapsed_s:.1f} s", markup=False)
    out.print(f"word      {word}", markup=False)
    out.print(f"tracking  {tracked(result)}", markup=False)
    out.print(f"link      {result.cadence.text}", markup=False)
    if result.behind_s:
        out.print(f"pace      this computer did not keep up: {result.behind_s:.1f} s behind at most", markup=False)
    if result.pictures or result.planned_pictures:
        taken = f"{len(result.pictures)} of {result.planned_pictures} planned"
        out.print(f"photos    {taken}, their places in {folder / IMAGES_FILE}", markup=False)
    if result.plan.run.recurrent:
        asked = result.plan.trajectory.laps
        out.print(f"laps      {result.laps}{'' if asked is None else f' of {asked}'}", markup=False)
    if reported:
        out.print(f"report    {folder / PAGE_FILE}", markup=False)
    colour, name = ("green", "ACHIEVED") if result.achieved else ("red", "NOT ACHIEVED")
    out.print(f"[bold {colour}]{name}[/]  ", end="")
    out.print(f"{result.reason}{without(result.plan)}", markup=False)


def _duration_s(result: FlightResult) -> float:
    """How long the trajectory was flown, by the vehicle's clock."""
    return 0.0 if result.began_s is None or result.ended_s is None else result.ended_s - result.began_s


def tracked(result: FlightResult) -> str:
    """How closely the trajectory was followed, and whether the proof speaks of that."""
    if result.began_s is None:
        return "none: the trajectory was not begun"
    if result.plan.spec.flight.guidance == FIELD:
        return "by the field: no trajectory was followed, and the tube of the proof says nothing of the flight"
    tube_m = result.plan.certificate.tube_m
    followed = f"at most {result.largest_error_m:.2f} m per axis from the trajectory"
    if tube_m > 0.0:
        if result.largest_error_m <= tube_m:
            followed += f", within the {tube_m:g} m per axis of the proof"
        else:
            followed += f", beyond the {tube_m:g} m per axis of the proof for up to {result.beyond_tube_s:.1f} s"
    followed += f" (largest distance {result.largest_distance_m:.2f} m)"
    off_m_s, bound_m_s = result.largest_velocity_error_m_s, result.plan.spec.flight.tube_m_s
    if off_m_s > 0.0:
        followed += f"; at most {off_m_s:.2f} m/s per axis from its velocity"
    if off_m_s > 0.0 and tube_m > 0.0:
        followed += f", {'within' if off_m_s <= bound_m_s else 'beyond'} the {bound_m_s:.2g} m/s that go with the tube"
    return followed


def _new(result: FlightResult, index: int) -> bool:
    return index == 0 or result.word[index] != result.word[index - 1]
