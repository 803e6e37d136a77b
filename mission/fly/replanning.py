"""Another plan in flight: when one is asked for, how the vehicle waits for it, and when it is taken over.

What is asked for is the rest of the mission from where the new plan will begin, with the word that will have been
spelled there: in motion, or where that is not possible, at rest where the old plan is slowed down to from there. Up to
its answer the old plan is flown, where that is safe; otherwise the vehicle slows down at once, and the new plan may
begin while it does. An answer that comes too late, or finds the automaton in another state than it was made for, is
asked for again, some times; then the vehicle holds until there is one.
"""

import math
from collections.abc import Callable, Iterator
from dataclasses import replace
from itertools import count
from typing import Final

import numpy as np

from mission.fly.approach import Approach, along, aside, in_flight, standing, way_of
from mission.fly.cause import Asked, Cause, Entry
from mission.fly.placing import bounds_of, course_of
from mission.fly.recording import RecordWriter
from mission.fly.replanner import PlanRequest, Replanner, expected_s
from mission.fly.watch import FlightWatch
from mission.geometry.arrays import FloatArray
from mission.link.course import Course, Reference
from mission.link.guidance import Guidance
from mission.link.halting import taken_up
from mission.link.session import Session
from mission.monitor.stage import Stage
from mission.plan import FlightPlan
from mission.plan.rest import Rest

_LEFT_FOR_S: Final = 0.2
"""So long the vehicle has been out of its tube before a plan is asked for."""

_AHEAD_S: Final = 0.03
"""Beyond the time that planning takes: for what is on its way."""

_SOONEST_S: Final = 0.05
_LATER_S: Final = 0.2
_ROLLS_M_S: Final = 0.1
"""Who is slower than that, and not at rest, comes to rest first: no path leads on from next to no motion."""

_STANDS: Final = 1e-6
_FOLLOWED_M: Final = 0.5
_REST: Final = (0.0, 0.0, 0.0)
_AGAIN_S: Final = 1.0
"""So long after there was no plan one is asked for again, if the vehicle is still out of its tube."""

_MOST_TRIES: Final = 3
_LONGEST_S: Final = 60.0
"""On the clock here: how long a plan is waited for."""

_FORESEEN_S: Final = 3600.0
_FORESEEN_STEP_S: Final = 0.25

_CALM_SHARE: Final = 0.5
_CALM_M_S: Final = 0.5
_CALM_FOR_S: Final = 0.5
_RESTLESS_S: Final = 60.0


class Replanning:
    """What becomes of a flight that does not go as planned.

    Attributes:
        plans: How many plans were flown so far.
        replanner: Who plans.
        held: Whether the vehicle waits on its plan because it was asked to; it goes on only when that is asked for, or
            by another plan.
    """

    def __init__(
        self,
        session: Session,
        watch: FlightWatch,
        record: RecordWriter,
        replanner: Replanner,
        told: tuple[Callable[[int, str], None], Callable[[str], None]],
    ) -> None:
        """Replan nothing yet.

        Args:
            session: The flight.
            watch: What is known of it.
            record: Where it is written down.
            replanner: Who plans.
            told: Given each plan that is taken over, its number and its text; and what is intended, in plain words.
        """
        self.plans = len(watch.legs.legs)
        self._on_plan, self._say = told
        self._piloted = False
        self._session, self._watch, self._record, self.replanner = session, watch, record, replanner
        self._cause: Cause | None = None
        self._asked: Asked | None = None
        self._numbers = count(1)
        self._tries, self._late_s = 0, 0.0
        self._calm_from_s = math.inf
        self._excused_s = -math.inf
        self._laps: int | None = watch.plan.trajectory.laps
        self.held = False

    @property
    def busy(self) -> bool:
        """Whether a plan is waited for."""
        return self._cause is not None

    def turn(self, now_s: float) -> str:
        """Do what is due; says why the flight cannot go on, empty where it can.

        Args:
            now_s: The time here.
        """
        session = self._session
        # The earliest moment for which something else can still be asked.
        vehicle_s, guidance = session.contact.arrives_s(now_s), session.guidance
        if isinstance(guidance, Guidance) and vehicle_s is not None and session.stage is Stage.FLY:
            self._wait_for_pilot(guidance, vehicle_s)
        if vehicle_s is None or not isinstance(guidance, Guidance) or not session.redirectable:
            if self._cause is not None:
                self._end("no trajectory is flown any more" if session.stage is not Stage.FLY else session.pilot.words)
            return ""
        if self._cause is None and self._left_tube and vehicle_s >= self._excused_s:
            self.begin(Cause(f"the vehicle was {self._watch.tracking.error_m:.2f} m off, out of its tube"))
        if self._cause is None:
            self._laps = guidance.course.laps
            return ""
        if self._asked is None:
            if self.replanner.ready or not self._may_wait(self._cause, guidance, vehicle_s):
                self._ask(self._cause, guidance, vehicle_s, now_s)
            return ""
        if self._asked.plan is None and (why := self._hear(self._asked, guidance, vehicle_s, now_s)):
            return why
        if self._asked is None or self._asked.plan is None or self._asked.entry is None:
            return ""
        return self._arrive(self._cause, self._asked, self._asked.plan, self._asked.entry, (guidance, vehicle_s))

    def begin(self, cause: Cause) -> None:
        """Ask for a plan at the next turn, whatever was asked for before."""
        self._cause, self._asked, self._tries, self._late_s = cause, None, 0, 0.0
        self._record.write("event", self._session.vehicle.clock.newest_s, name="replanning", reason=cause.reason)

    def _wait_for_pilot(self, guidance: Guidance, vehicle_s: float) -> None:
        """While a pilot flies, ask for where the vehicle is; once it is handed back, come to rest and go on from there.

        An autopilot takes setpoints back only while they are sent.
        """
        flown, self._piloted = self._piloted, bool(self._session.pilot.words)
        bounds = bounds_of(self._watch.plan)
        if self._piloted:
            here = self._state(0.0)
            course, (x, y) = guidance.course_at(vehicle_s), self._watch.place_m
            at_x, at_y, _ = course.reference(course.duration_s).position_m
            if course.planned or math.hypot(x - at_x, y - at_y) > _FOLLOWED_M:
                at_rest = here._replace(velocity_m_s=_REST)
                standing_by = aside(at_rest, bounds, vehicle_s, (x, y))
                if standing_by.course is not None:
                    guidance.redirect(standing_by.course, vehicle_s)
        elif flown:
            self._say("handed back: planning from here")
            approach = aside(self._state(_SOONEST_S), bounds, vehicle_s + _SOONEST_S)
            if approach.course is not None:
                self._session.redirect(approach.course, approach.from_s)
            self.begin(Cause("the pilot has handed the vehicle back"))

    @property
    def _left_tube(self) -> bool:
        replans = self._watch.plan.spec.flight.replan and not self.held
        return replans and self._watch.tracking.excess_s >= _LEFT_FOR_S

    def _ask(self, cause: Cause, guidance: Guidance, vehicle_s: float, now_s: float) -> None:
        """Ask for the rest of the mission from where a new plan can begin."""
        watch, leg = self._watch, self._watch.legs.now
        entries = tuple(self._entry(cause, *each) for each in self._approaches(cause, guidance, vehicle_s))
        self._asked = Asked(next(self._numbers), entries, (vehicle_s, now_s))
        amended = cause.amended
        if leg.plan.run.recurrent and amended is None and self._laps is not None:
            amended = replace(leg.plan.spec, flight=replace(leg.plan.spec.flight, laps=self._laps))
        rest, stopped = entries[0].rest, entries[1].rest if entries[1:] else None
        self.replanner.ask(PlanRequest(self._asked.number, watch.plan, rest, stopped, amended, cause.returns))

    def _approaches(self, cause: Cause, guidance: Guidance, vehicle_s: float) -> Iterator[tuple[Approach, bool]]:
        """How a new plan may be come to, and whether that is flown already; what is flown at once begins here."""
        watch, session = self._watch, self._session
        # What is flown then may have been asked for in this very turn.
        coming_s = vehicle_s + _SOONEST_S
        expects_s = expected_s(self.replanner, watch.plan, watch.monitor.word, cause)
        takes_s = max(session.vehicle.clock.rate, 1.0) * expects_s
        at_s = vehicle_s + max(takes_s, self._late_s) + _AHEAD_S
        coming, outside = guidance.course_at(coming_s), watch.tracking.excess_s > 0.0
        if outside and not coming.waits:
            holds = (
                cause.holds or cause.waits or self._tries >= _MOST_TRIES or not watch.legs.now.is_clear(watch.place_m)
            )
            begin_s = coming_s if holds else at_s
            approach = aside(self._state(begin_s - vehicle_s), bounds_of(watch.plan), begin_s)
            if holds and approach.course is not None:
                session.redirect(approach.course, approach.from_s)
            yield approach, holds
            return
        if coming.waits:
            stop, begun = standing(coming, coming_s, guidance.pace_at(coming_s)[0]), True
        else:
            stop, begun = along(guidance, at_s, vehicle_s), False
            if self._tries >= _MOST_TRIES or not self._spares(cause, way_of(guidance, stop, vehicle_s)):
                stop, begun = along(guidance, coming_s, vehicle_s), True
                if stop.course is not None:
                    session.redirect(stop.course, stop.from_s)
        if stop.flown_s is not None and not outside:
            rolling = in_flight(guidance, at_s, vehicle_s)
            speed_m_s = math.hypot(*rolling.begin.velocity_m_s)
            if speed_m_s >= _ROLLS_M_S or (speed_m_s <= _STANDS and not begun):
                yield rolling, False
        yield stop, begun

    @staticmethod
    def _spares(cause: Cause, places_m: FloatArray) -> bool:
        """Whether the vehicle may go somewhere before there is another plan."""
        if not (cause.holds or cause.waits):
            return True
        return cause.spares is not None and cause.spares(places_m)

    def _may_wait(self, cause: Cause, guidance: Guidance, vehicle_s: float) -> bool:
        """Whether the vehicle may go on as it does until a little later, and come to rest then."""
        stop = along(guidance, vehicle_s + _LATER_S, vehicle_s)
        return self._watch.tracking.excess_s <= 0.0 and self._spares(cause, way_of(guidance, stop, vehicle_s))

    def _entry(self, cause: Cause, approach: Approach, begun: bool) -> Entry:  # noqa: FBT001 - as it comes
        watch, leg = self._watch, self._watch.legs.now
        foreseen = watch.monitor.foreseen((watch.place_m, *approach.through_m))
        flown_s = leg.in_tube_until_s if leg.has_left_tube or approach.flown_s is None else approach.flown_s
        laps, due = leg.laps_at(foreseen, flown_s)
        under_way = due is not None and not (cause.fresh or cause.returns)  # a return completes none
        (x, y, _), (vx, vy, _), (ax, ay, _) = approach.begin
        return Entry(
            approach,
            begun,
            foreseen,
            (laps + int(under_way), under_way),
            Rest(foreseen.word, (x, y), (vx, vy), (ax, ay), flown_s=flown_s, laps=laps - leg.laps_before, due=due),
        )

    def _state(self, ahead_s: float) -> Reference:
        """Where the vehicle will be so long after what is sent now arrives, by its last report."""
        ahead_s += self._session.contact.arrival.delay_s
        (x, y), (vx, vy) = self._watch.place_m, self._watch.velocity_m_s
        altitude_m = self._watch.plan.trajectory.altitude_m
        return Reference((x + ahead_s * vx, y + ahead_s * vy, altitude_m), (vx, vy, 0.0), (0.0, 0.0, 0.0))

    def _hear(self, asked: Asked, guidance: Guidance, vehicle_s: float, now_s: float) -> str:
        """Listen for the answer, and hold where what is flown meanwhile is no longer safe."""
        answer, stop = self.replanner.answer(), asked.stop
        if answer is None or answer.number != asked.number:
            if not stop.begun and stop.aside and not self._watch.legs.now.is_clear(self._watch.place_m):
                self._asked, self._tries = None, _MOST_TRIES
            elif not stop.begun and self._must_stop(stop, vehicle_s):
                self._slow_down(asked)
            overdue = now_s - asked.asked_s[1] > _LONGEST_S
            why = f"there was no plan within {_LONGEST_S:.0f} s" if overdue else self.replanner.trouble
            return self._refused(why, guidance, vehicle_s) if why else ""
        if answer.plan is None:
            return self._refused(answer.refusal, guidance, vehicle_s)
        entry = stop if answer.stopped else asked.entries[0]
        if entry.aside and not entry.begun:
            end_m = entry.approach.begin.position_m[:2]
            approach = aside(self._state(0.0), bounds_of(self._watch.plan), vehicle_s, end_m)
            entry = replace(entry, approach=approach)
        elif not entry.begun and vehicle_s >= entry.approach.from_s:
            self._late_s = (1 + self._tries) * (vehicle_s - asked.asked_s[0])
            return self._again("the plan came too late")
        if not entry.begun and entry.approach.course is not None:
            self._session.redirect(entry.approach.course, entry.approach.from_s)
        asked.plan, asked.text, asked.entry = answer.plan, answer.text, entry
        return ""

    def _must_stop(self, stop: Entry, vehicle_s: float) -> bool:
        """Whether the plan that is flown must be left now, with another one or without."""
        must = self._cause is not None and (self._cause.holds or self._cause.waits)
        return must and vehicle_s >= stop.approach.from_s - _SOONEST_S

    def _slow_down(self, asked: Asked) -> None:
        """Come to rest; a plan that begins in motion may yet take the place of that, while there is time."""
        stop = asked.stop
        if stop.approach.course is not None:
            self._session.redirect(stop.approach.course, stop.approach.from_s)
        asked.entries = (*asked.entries[:-1], replace(stop, begun=True))

    def _arrive(self, cause: Cause, asked: Asked, plan: FlightPlan, entry: Entry, at: tuple[Guidance, float]) -> str:
        """Fly the new plan, once the vehicle is where it begins."""
        approach, (guidance, vehicle_s) = entry.approach, at
        if vehicle_s < approach.until_s - _SOONEST_S:
            return ""
        if entry.aside and not self._is_calm(approach, vehicle_s):
            restless = vehicle_s - approach.until_s > _RESTLESS_S
            return self._refused("the vehicle does not come to rest", guidance, vehicle_s) if restless else ""
        if not entry.foreseen.agrees(self._watch.monitor.known):
            if self._tries >= 2 * _MOST_TRIES:
                why = "each time that there was a plan, another word had been spelled"
                return self._refused(why, guidance, vehicle_s)
            return self._again("another word was spelled meanwhile")
        at_s = approach.until_s if entry.rest.begins.moves else max(approach.until_s, vehicle_s)
        self._session.redirect(course_of(plan, 0.0, None), at_s, plan.photographs)
        self.fly_next(plan, asked.text, at_s, cause, entry.laps_before)
        self._end("")
        return ""

    def fly_next(self, plan: FlightPlan, text: str, at_s: float, cause: Cause, before: tuple[int, bool]) -> None:
        """Let another plan, in JSON this text, count as flown from a vehicle time on, after laps as ``laps_before``."""
        laps_before, begun = before
        why = {"amended": cause.amended is not None, "returns": cause.returns, "fresh": cause.fresh}
        self.plans += 1
        self._on_plan(self.plans, text)
        if cause.keep is not None:
            cause.keep(self.plans)
        self._record.write(
            "event",
            at_s,
            name="leg",
            number=self.plans,
            reason=cause.reason,
            **why,
            taken_up=cause.taken_up,
            start_m=plan.start_m,
            laps_before=laps_before,
            begun=begun,
            duration_s=plan.trajectory.duration_s,
        )
        self.held = False
        onward = next((letter for letter in plan.certificate.word[1:] if letter), frozenset({"its end"}))
        self._say(f"going on from here to {', '.join(sorted(onward))}")
        self._watch.take_over(plan, at_s, laps_before, begun=begun, **why)

    def _is_calm(self, approach: Approach, vehicle_s: float) -> bool:
        """Whether the vehicle has stood for a while where the new plan begins."""
        off_m = max(abs(a - b) for a, b in zip(self._watch.place_m, approach.begin.position_m, strict=False))
        calm = off_m <= _CALM_SHARE * self._watch.plan.certificate.tube_m
        calm &= math.hypot(*self._watch.velocity_m_s) <= _CALM_M_S
        self._calm_from_s = min(self._calm_from_s, vehicle_s) if calm else math.inf
        return vehicle_s - self._calm_from_s >= _CALM_FOR_S

    def _again(self, why: str) -> str:
        self._tries, self._asked = self._tries + 1, None
        self._record.write("event", self._session.vehicle.clock.newest_s, name="asked again", reason=why)
        return ""

    def _refused(self, why: str, guidance: Guidance, vehicle_s: float) -> str:
        """There is no plan: the flight ends; or who asked is told, and the old plan is flown on if it may be."""
        cause, waits = self._cause, guidance.course_at(vehicle_s).waits
        self._end(why)
        if cause is None or cause.told is None:
            if not waits and self._still_leads_on(guidance, vehicle_s):
                self._excused_s = vehicle_s + _AGAIN_S
                return ""
            return f"{'' if cause is None else cause.reason}, and there is no plan from there: {why}"
        if cause.holds:
            self.hold(guidance, vehicle_s)
        elif not self.held:
            self.go_on(guidance, vehicle_s + _SOONEST_S)  # by then it is flown, whatever was asked for last
        return ""

    def _still_leads_on(self, guidance: Guidance, vehicle_s: float) -> bool:
        """Whether the plan that is flown still leads to where it was to, although the vehicle is off it."""
        (from_s, _), course = guidance.pace_at(vehicle_s), guidance.course_at(vehicle_s)
        until_s = min(course.duration_s, from_s + _FORESEEN_S)
        times = np.linspace(from_s, until_s, 2 + int((until_s - from_s) / _FORESEEN_STEP_S))
        ahead = course.trajectory.state(times)[0].tolist()
        return self._watch.legs.now.leads_on((self._watch.place_m, *((x, y) for x, y in ahead)))

    def hold(self, guidance: Guidance, vehicle_s: float) -> None:
        """Slow the plan that is flown to rest, unless the vehicle waits already."""
        if not guidance.course_at(vehicle_s + _SOONEST_S).waits:
            approach = along(guidance, vehicle_s + _SOONEST_S, vehicle_s)
            if approach.course is not None:
                self._session.redirect(approach.course, approach.from_s)

    def go_on(self, guidance: Guidance, vehicle_s: float) -> str:
        """Fly the plan on that was slowed to rest; says why not, in plain words, empty where it is."""
        course = guidance.course_at(vehicle_s)
        approach = standing(course, vehicle_s, guidance.pace_at(vehicle_s)[0])
        if not course.waits:
            return "nothing waits: the plan is flown on as it is"
        if approach.flown_s is None:
            return "the vehicle waits off its plan, which does not lead on from there"
        plan = self._watch.plan
        trajectory = plan.trajectory if course.laps is None else replace(plan.trajectory, laps=course.laps)
        onward = taken_up(trajectory, approach.flown_s, course.bounds.acceleration_m_s2)
        bounds, nose = bounds_of(plan), course.nose
        self._session.redirect(
            Course(onward, 0.0, bounds, nose, planned_s=onward.planned_s), max(approach.until_s, vehicle_s)
        )
        self.held = False
        return ""

    def _end(self, why: str) -> None:
        """Nothing is waited for any more; say why there was no plan, or that there was one."""
        cause, self._cause, self._asked = self._cause, None, None
        if why:
            self._record.write("event", self._session.vehicle.clock.newest_s, name="no plan", reason=why)
        if cause is not None and cause.told is not None:
            cause.told(why)
