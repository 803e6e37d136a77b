"""One flight's parts, and what holds them together: a turn of its loop, its departure, and when it is given up."""

import contextlib
from collections.abc import Callable
from dataclasses import replace
from traceback import format_exception

from mission.clock import Clock, SteadyClock
from mission.errors import FlightError, LinkError, MissionError, NoPlanError, VehicleError
from mission.fly.amending import Amending, Amendments
from mission.fly.by_field import field_orders
from mission.fly.cause import Cause
from mission.fly.circumstances import Circumstances
from mission.fly.conclusion import concluded, joined, shortcomings
from mission.fly.conditions import Conditions
from mission.fly.fencing import guarded, guarded_again, renew
from mission.fly.interruption import INTERRUPTED, StopRequest
from mission.fly.listening import BEHIND_S, Listening
from mission.fly.lookout import Lookout
from mission.fly.news import News
from mission.fly.options import FlightOptions
from mission.fly.placing import anchored_at_start, check_stand, course_of, placed
from mission.fly.preflight import Gate
from mission.fly.recording import Recording
from mission.fly.replanner import Replanner, answered
from mission.fly.replanning import Replanning
from mission.fly.requests import Heeding, Requests
from mission.fly.result import FlightResult, Progress
from mission.fly.resuming import RETURNING, Unfinished, is_still
from mission.fly.retreat import put_back, retreat, speak
from mission.fly.return_in_time import ReturnInTime
from mission.fly.watch import FlightWatch
from mission.link.announcer import Announcer
from mission.link.events import Held, Moved, StageEntered, WentOn
from mission.link.frames import enu_from_ned
from mission.link.session import Session
from mission.link.transport import Transport
from mission.link.vehicle_state import HEARTBEATS
from mission.monitor.stage import Stage
from mission.plan import FlightPlan
from mission.printable import printable
from mission.report.tracking import tracking_of
from mission.spec.model import Point

_COMES_TO_REST_S = 20.0


class Flight:
    """One flight's parts, and what holds them together."""

    def __init__(
        self,
        plan: FlightPlan,
        clock: Clock,
        record: Recording,
        options: FlightOptions,
        *,
        planner: Callable[[Point], FlightPlan],
        replanner: Replanner,
        on_plan: Callable[[int, str], None],
        amendments: Amendments | None,
        unfinished: Unfinished | None,
        requests: Requests,
    ) -> None:
        self.plan, self.record, self.options = plan, record, options
        self.clock = SteadyClock(clock)
        link = options.link
        if unfinished is not None and not link.vehicle_id:
            link = replace(link, vehicle_id=unfinished.system_id)
        self.session = Session(
            needs_origin=plan.spec.origin is not None or options.fence,
            options=link,
            land_when_stopped=options.land_when_stopped,
            waits_for_pilot=options.resume_when_handed_back,
            aloft=unfinished is not None,
        )
        self._unfinished = unfinished
        self.gate = Gate(self.session.contact, options.checks)
        self.watch = FlightWatch(plan, record, record_all=options.record_all)
        self.interrupted = False
        self._given_up = False
        self._planner, self._replanner, self._on_plan = planner, replanner, on_plan
        self._amendments, self._requests = amendments, requests
        self._replanning, self._in_time, self._amending, self._heeding = self._replans()
        self._lookout = Lookout(options.stray_m)
        self.listening = Listening(self.session, self.clock)
        self._circumstances = Circumstances(self.session, self.listening, self.clock, record)
        self._conditions = Conditions(self.session, record)
        self._news: News | None = None
        self._told: tuple[str, ...] = ()
        self._moves_since_s: float | None = None
        self._fenced = plan

    @property
    def newest_s(self) -> float | None:
        """The vehicle's time."""
        return self.session.vehicle.clock.newest_s

    @property
    def behind_s(self) -> float:
        """How far the flight was behind what the vehicle said, at most; 0 where it kept up."""
        largest_s = self.listening.largest_behind_s
        return largest_s if largest_s > BEHIND_S else 0.0

    @property
    def remarks(self) -> str:
        """What was lost of the record, and what the flight was made against; empty where nothing was."""
        return joined(self._in_time.text or self.watch.legs.undone, self.record.lost_text, self.gate.forced_text)

    def turn(self, transport: Transport, stop_request: Callable[[], StopRequest | None]) -> None:
        """One turn of the loop: listen, think, speak."""
        session = self.session
        if self.listening.turn(transport):
            if self._unfinished is not None:
                self._unfinished.check_whose(session.contact)
            session.advance(self.clock.now_s())
            self.take_events()
            self._circumstances.turn()
            self._conditions.turn()
            self.renew_fence()
            if session.stage is Stage.STANDBY and self._unfinished is not None:
                self._take_up_at_rest(self._unfinished)
            elif session.stage is Stage.STANDBY and self.gate.open:
                self.gate.judge(self.plan, self.options.link, self.record, fenced=self.options.fence)
                self.depart()
            self.look_after()
            if self._amending is not None:
                self._amending.turn(self.clock.now_s())
            for part in (self._replanning, self._in_time):
                if reason := part.turn(self.clock.now_s()):
                    self.stop(reason)
        self._heeding.turn(self.clock.now_s())
        if request := stop_request():
            self.heed(request)
        for frame in (*self.announcements(), *session.outgoing()):
            transport.send(frame)

    def announcements(self) -> list[bytes]:
        """What ground stations are told now, once the vehicle is known that passes it on."""
        contact, t_s = self.session.contact, self.session.vehicle.clock.now_s(self.clock.now_s())
        if contact.autopilot is None or t_s is None:
            return []
        if self._news is None:
            announcer = Announcer(contact.system_id, self.options.link.signatures)
            self._news = News(announcer, printable(self.plan.spec.name))
        return self._news.frames(t_s, self.progress, self._state) if self._news.announcer.is_due(t_s) else []

    def announce_verdict(self, transport: Transport, verdict: str, *, achieved: bool) -> None:
        """Tell ground stations how it ended, as far as the link still carries that."""
        t_s = self.newest_s
        with contextlib.suppress(Exception):
            if self._news is not None and t_s is not None:
                frames = self._news.last_frames(t_s, self.progress, self._state, verdict, achieved=achieved)
                for frame in frames:
                    transport.send(frame)

    @property
    def progress(self) -> Progress:
        """Where the flight is now."""
        progress = self.watch.progress(self.session, self.listening)
        return replace(progress, told=self._told, held=self._replanning.held)

    @property
    def _state(self) -> int:
        """Of the mission's automaton; -1 where it is in none."""
        place = self.watch.monitor.whereabouts
        return -1 if place is None else place.state

    def renew_fence(self) -> None:
        """Let the geofence follow where the mission was amended; the rest of one keeps within what there is."""
        guard, plan, guidance = self.session.contact.fence, self.watch.plan, self.session.guidance
        if guard is None or guidance is None or plan is self._fenced:
            return
        plans, self._fenced = (self._fenced, plan), plan
        renew(guard, plans, guidance.anchor.origin_ned_m[:2], self.session.contact, self.record)

    def take_events(self) -> None:
        """Pass on what the session has to tell."""
        for event in self.session.events():
            self.watch.take(event)
            if isinstance(event, Held) and event.words:
                self._told += (f"{event.words}: waiting until it is handed back",)
            if isinstance(event, WentOn):
                self.record.warn(f"{event.words}; the flight goes on")

    def depart(self) -> None:
        """Plan for where the vehicle stands, and go."""
        vehicle, spec = self.session.vehicle, self.plan.spec
        if spec.origin is None:
            anchoring = anchored_at_start(self.plan.start_m)
        else:
            stands_m, anchoring = placed(spec.origin, vehicle)
            check_stand(self.plan, stands_m)
            self.plan = self._planner(stands_m)
            name = self.watch.vehicle
            self.watch = FlightWatch(self.plan, self.record, record_all=self.options.record_all)
            self.watch.vehicle = name
            self._replanning, self._in_time, self._amending, self._heeding = self._replans()
        self.record.write(
            "event",
            self.newest_s,
            name="planned",
            start_m=self.plan.start_m,
            run=self.plan.run.states,
            duration_s=self.plan.trajectory.duration_s,
            tube_m=self.plan.certificate.tube_m,
        )
        heading = 0.0 if vehicle.attitude is None else vehicle.attitude.angles_rad[2]
        course = course_of(self.plan, heading, field_orders(self.plan, self.watch.monitor))
        contact = self.session.contact
        self._fenced = self.plan
        if self.options.fence:
            contact.fence, anchoring = guarded(self.plan, anchoring, contact, keep=self.options.keep_fence)
        replans = spec.flight.replan or spec.battery is not None or self.options.resume_when_handed_back
        if replans or self._amendments is not None:
            self._replanner.prepare(self.plan)
        self.session.depart(course, anchoring, self.plan.photographs)
        self.listening.excuse()

    def _has_come_to_rest(self) -> bool:
        """Whether a vehicle that was left hovers, or has had the time for it: autopilots miss setpoints for seconds."""
        vehicle, now_s = self.session.vehicle, self.newest_s
        if now_s is None or vehicle.position is None or is_still(vehicle.position):
            return True
        if self._moves_since_s is None:
            self._moves_since_s = now_s
            self.say("the vehicle moves still: waiting until it hovers")
        return now_s - self._moves_since_s >= _COMES_TO_REST_S

    def _take_up_at_rest(self, left: Unfinished) -> None:
        """Go on with a flight from where the vehicle hovers, once it does.

        Raises:
            VehicleError: It is no vehicle that this flight can go on with.
            NoPlanError: What was not done cannot be done from there.
        """
        if not self._has_come_to_rest():
            return
        session, vehicle, kind = self.session, self.session.vehicle, self.session.contact.autopilot
        if kind is None or vehicle.position is None:
            raise VehicleError("the vehicle has not told where it is")
        now, anchor = left.legs.now.plan, left.checked(vehicle, kind)
        at_s, attitude = vehicle.position_at_s, vehicle.attitude
        place_m = anchor.to_domain(vehicle.position.position_ned_m)
        velocity_m_s = enu_from_ned(vehicle.position.velocity_ned_m_s)
        angles_rad = None if attitude is None else attitude.angles_rad
        check_stand(now, place_m[:2])
        # The way from where it was heard last counts as flown.
        self.watch.take(StageEntered(at_s, Stage.FLY))
        pictures = [each.number for each in left.record.pictures]
        self.watch.take_up(left.legs, left.began_s, left.last_s, pictures, tracking_of(left.record))
        self.watch.take(Moved(at_s, place_m, velocity_m_s, angles_rad, place_m, velocity_m_s, None))
        answer = answered(left.request(place_m[:2]))
        if answer.plan is None:
            raise NoPlanError(answer.refusal)
        self.plan, self._fenced = answer.plan, now
        self._replanning, self._in_time, self._amending, self._heeding = self._replans()
        laps, due = left.laps
        before = laps + int(due is not None), due is not None
        again = Cause(f"taken up again after {at_s - left.last_s:.0f} s", taken_up=True)
        self._replanning.fly_next(answer.plan, answer.text, at_s, again, before)
        self._replanner.prepare(answer.plan)
        self._guard_again(left)
        if session.contact.fence is not None:
            session.contact.fence.confirm()
        course = course_of(answer.plan, 0.0 if angles_rad is None else angles_rad[2], None)
        session.depart(course, anchor, answer.plan.photographs)
        self.listening.excuse()

    def _guard_again(self, left: Unfinished) -> None:
        """Let the vehicle have the fence back that it had before a flight, once that is over."""
        contact, now, keep = self.session.contact, left.legs.now.plan, self.options.keep_fence
        contact.fence = contact.fence or guarded_again(left.record.events, now, contact, keep=keep)

    def _replans(self) -> tuple[Replanning, ReturnInTime, Amending | None, Heeding]:
        """What replans this flight, brings it home in time, amends its mission, and grants what is asked of it."""
        parts = self.session, self.watch, self.record
        replanning = Replanning(*parts, self._replanner, (self._on_plan, self.say))
        in_time = ReturnInTime(*parts, replanning, replanner=self._replanner, say=self.say)
        heeding = Heeding(*parts, replanning, self._requests, say=self.say, land=self.land)
        if self._amendments is None:
            return replanning, in_time, None, heeding
        mission = self.watch.plan.spec if self._unfinished is None else self._unfinished.mission
        amending = Amending(self.session, self.watch, replanning, self._amendments, mission)
        return replanning, in_time, amending, heeding

    def say(self, text: str) -> None:
        """Tell whoever watches the vehicle, or this flight, what is intended."""
        self.record.write("event", self.newest_s, name="intention", reason=text)
        self._told += (text,)
        if self._news is not None:
            self._news.say(text)

    def look_after(self) -> None:
        """Give the flight up where going on would be wrong."""
        if reason := self._lookout.reason(self.session, self.watch):
            self.stop(reason)

    def heed(self, request: StopRequest) -> None:
        """Grant a wish to end the flight.

        Raises:
            KeyboardInterrupt: The flight has been given up already, at an earlier wish.
        """
        if self._given_up:
            raise KeyboardInterrupt
        self.interrupted = True
        if request.after_lap and not self.watch.returning and self.session.end_laps(self.clock.now_s()):
            self.watch.returning = True
            self.record.write("event", self.newest_s, name=RETURNING, reason=request.reason)
        else:
            self.stop(request.reason)
            self._given_up = True

    def land(self, reason: str) -> None:
        """Land on the spot, because the user wants it, even if the flight has been given up already."""
        self.interrupted = True
        self.record.write("event", self.newest_s, name="stop", reason=reason)
        self.session.stop(reason, self.clock.now_s(), lands=True)

    def stop(self, reason: str) -> None:
        """Give the flight up, once; the vehicle does not hold where what must not be entered will come."""
        if not self._given_up and self.session.ending is None:
            coming = self.watch.coming(self.newest_s)
            reason = joined(reason, coming and f"{coming}: it lands")
            self.record.write("event", self.newest_s, name="stop", reason=reason)
            self.session.stop(reason, self.clock.now_s(), lands=bool(coming))

    def result(self) -> FlightResult:
        """The verdict on the flight, written down.

        Raises:
            VehicleError: A failsafe of the vehicle ended the flight.
        """
        self.take_events()
        result = concluded(
            self.session,
            self.watch,
            remarks=self.remarks,
            interrupted=self.interrupted,
            behind_s=self.behind_s,
        )
        self.record.write("verdict", self.newest_s, **result.values(), **self.watch.legs.now.judged.known())
        return result

    def say_stop(self, transport: Transport, why: str = INTERRUPTED.reason) -> None:
        """Tell the vehicle to stop, without waiting for it; how it is left is said, as far as that is known."""
        with contextlib.suppress(Exception):
            self.interrupted = True
            self.stop(INTERRUPTED.reason)
        with contextlib.suppress(Exception):
            speak(self.session, transport, self.clock)
        fence, words = self.session.contact.fence, [self.session.left]
        if fence is not None and fence.unfinished:
            words += ["the geofence of this flight stays on the vehicle; what was there before is in the record"]
        for each in filter(None, words):
            self.record.warn(each)
        with contextlib.suppress(Exception):
            reason = joined(why, "its end was not waited for", *words, self.remarks)
            self.record.write("verdict", self.newest_s, achieved=False, reason=reason, ending="left", interrupted=True)

    def failed(self, error: BaseException, transport: Transport, gone: Callable[[], str]) -> BaseException:
        """What the flight fails with, once the vehicle was told to hold, or to land; how it is left is part of it."""
        why = error
        if not isinstance(why, MissionError):
            why = FlightError(f"{type(error).__name__}: {error}")
            with contextlib.suppress(Exception):
                self.record.write("event", self.newest_s, name="failure", traceback=format_exception(error))
        left = ""
        if not gone():
            with contextlib.suppress(Exception):
                if self.watch.coming(self.newest_s):
                    self.stop(str(why))
            retreat(self.session, transport, self.clock, why, gone=gone, turned=self._take_what_can_be_taken)
            left = self.session.left
            if self._unfinished is not None and self.session.vehicle.heartbeats_disarmed >= HEARTBEATS:
                with contextlib.suppress(VehicleError):  # another vehicle keeps what it has
                    self._unfinished.check_whose(self.session.contact)
                    self._guard_again(self._unfinished)
                if self.session.contact.unfinished:
                    self.record.warn("the vehicle gets back the geofence that it had before the flight")
            put_back(self.session, transport, self.clock, gone)
        self._take_what_can_be_taken()
        reason = joined(str(why), left, *shortcomings(self.session, self.watch, self.remarks))
        with contextlib.suppress(Exception):
            self.record.write(
                "verdict", self.newest_s, achieved=False, reason=reason, ending="failed", behind_s=self.behind_s
            )
        if not gone():
            self.announce_verdict(transport, reason, achieved=False)
        if isinstance(error, (LinkError, VehicleError)):
            return type(error)(reason)
        return FlightError(reason) if self.session.departed else error

    def _take_what_can_be_taken(self) -> None:
        """Pass on what the session has to tell, although this may be what has failed."""
        with contextlib.suppress(Exception):
            for event in self.session.events():
                with contextlib.suppress(Exception):
                    self.watch.take(event)
