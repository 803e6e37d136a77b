"""The one flight loop: clock, transport, session, plan, monitor and record, in lock-step or in real time alike."""

import math
from collections.abc import Callable

from mission.clock import Clock
from mission.errors import LinkError
from mission.fly.amending import Amendments
from mission.fly.flight import Flight
from mission.fly.interruption import INTERRUPTED, StopRequest
from mission.fly.options import FlightOptions
from mission.fly.recording import Recording, RecordWriter
from mission.fly.replanner import Replanner, SynchronousReplanner
from mission.fly.requests import NoRequests, Requests
from mission.fly.result import FlightResult, Progress
from mission.fly.resuming import Unfinished
from mission.link.transport import Transport
from mission.plan import FlightPlan, plan_mission
from mission.spec.model import MissionSpec, Point

_PROGRESS_S = 0.1


def fly(
    plan: FlightPlan,
    transport: Transport,
    clock: Clock,
    record: RecordWriter,
    *,
    options: FlightOptions | None = None,
    run: int | None = None,
    on_progress: Callable[[Progress], None] | None = None,
    vehicle_failure: Callable[[], str] | None = None,
    stop_request: Callable[[], StopRequest | None] | None = None,
    on_warning: Callable[[str], None] | None = None,
    planner: Callable[[Point], FlightPlan] | None = None,
    replanner: Replanner | None = None,
    on_plan: Callable[[int, str], None] | None = None,
    amendments: Amendments | None = None,
    unfinished: Unfinished | None = None,
    requests: Requests | None = None,
) -> FlightResult:
    """Fly a plan.

    A mission with a place on Earth is planned anew from where the vehicle stands; any other is anchored so that the
    vehicle stands at its start.

    Args:
        plan: What to fly, planned from the mission's own start.
        transport: The link to the vehicle; it is left open.
        clock: Paces repetitions on the link. The trajectory goes by the vehicle's own clock, and so does all else where
            the two run in lock-step (``LockstepLink``).
        record: Where everything is written down as it happens.
        options: How the flight is conducted.
        run: Which of the shortest runs to fly, where it is planned anew; the mission's choice by default.
        on_progress: Called some times a second.
        vehicle_failure: Says why the vehicle can no longer be there, empty while it can.
        stop_request: Gives each wish to end the flight once. Laps are ended first, if the wish allows for it: the
            vehicle completes the one that it is in and returns. The next wish is for giving the flight up, as is the
            first one where no lap is flown; one more interrupts at once, as ``KeyboardInterrupt`` does.
        planner: What plans it anew; that of missions by default.
        replanner: What plans in flight; it is left open. By default, one that stops this loop while it plans.
        on_plan: Given each plan that is taken over in flight, before it is: its number, from 2, and its JSON text.
        amendments: Where changes of the mission come from, while it is flown.
        unfinished: A flight that was left in the air, by this plan at first, to go on with from where the vehicle is.
        requests: Where it is asked from, in flight, to hold, to go on, to return or to land.
        on_warning: Told, in plain words, what went wrong on this side and does not end the flight.

    Whatever else ends the flight, an error of this program too, the vehicle is first told to hold, or to land.

    Raises:
        LinkError: The vehicle could not be found, or was lost; the record is complete up to there.
        VehicleError: It refused, failed, or did not do what it accepted.
        NoGoError: The check before the flight found what forbids it.
        NoPlanError: It stands where this mission cannot be flown from.
        FlightError: It was in flight when something failed here; the cause is chained.
    """
    recording = Recording(record, on_warning or _unsaid)
    flight = Flight(
        plan,
        clock,
        recording,
        options or FlightOptions(),
        planner=planner or _planner_of(plan.spec, run),
        on_plan=on_plan or _unwritten,
        amendments=amendments,
        unfinished=unfinished,
        requests=requests or NoRequests(),
        replanner=replanner or SynchronousReplanner(clock.now_s, 0.0),
    )
    gone = vehicle_failure or _nothing
    try:
        return _loop(flight, transport, on_progress, gone, stop_request or _no_wish)
    except KeyboardInterrupt:
        flight.say_stop(transport)
        raise
    except BaseException as error:
        try:
            failure = flight.failed(error, transport, gone)
        except KeyboardInterrupt:  # that is not waited for
            flight.say_stop(transport, str(error))
            raise
        if failure is error:
            raise
        raise failure from error


def _planner_of(spec: MissionSpec, run: int | None) -> Callable[[Point], FlightPlan]:
    return lambda start_m: plan_mission(spec, start_m=start_m, run=run)


def _nothing() -> str:
    return ""


def _unsaid(_words: str) -> None:
    return


def _unwritten(_number: int, _text: str) -> None:
    return


def _no_wish() -> StopRequest | None:
    return None


def _loop(
    flight: Flight,
    transport: Transport,
    on_progress: Callable[[Progress], None] | None,
    vehicle_failure: Callable[[], str],
    stop_request: Callable[[], StopRequest | None],
) -> FlightResult:
    shown_s = -math.inf
    while True:
        try:
            flight.turn(transport, stop_request)
            if flight.session.ending is not None and not flight.session.contact.unfinished:
                result = flight.result()
                flight.announce_verdict(transport, result.reason, achieved=result.achieved)
                return result
            if failure := vehicle_failure():
                raise LinkError(failure)
            now_s = flight.clock.now_s()
            if on_progress is not None and now_s - shown_s >= _PROGRESS_S:
                shown_s = now_s
                on_progress(flight.progress)
        except KeyboardInterrupt:
            flight.heed(INTERRUPTED)
