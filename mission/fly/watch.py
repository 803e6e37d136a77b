"""Turns what the session tells into the record, the monitor's view of the flight, and progress."""

import math
from bisect import bisect_right
from collections.abc import Iterable
from dataclasses import replace
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from mission.fly.circumstances import FIRMWARE
from mission.fly.listening import Listening
from mission.fly.nearness import Nearness
from mission.fly.recording import RecordWriter, Routine
from mission.fly.result import Progress
from mission.geometry.location import OUTSIDE
from mission.link.events import (
    Anchored,
    Answered,
    Asked,
    Event,
    Held,
    Identified,
    Moved,
    Photographed,
    Said,
    SetpointSent,
    StageEntered,
    VersionTold,
    WentOn,
)
from mission.link.session import Session
from mission.monitor.cadence import CadenceWatch
from mission.monitor.coverage import Covered
from mission.monitor.gaps import GAP_S, Gap, Missing
from mission.monitor.legs import FlightLegs
from mission.monitor.monitor import Monitor
from mission.monitor.stage import WATCHED, Stage
from mission.monitor.tracking import TrackingWatch
from mission.plan import FlightPlan
from mission.plan.closings import ahead, entered
from mission.plan.drifting import Drifting
from mission.report.tracking import Tracking
from mission.spec.air_time import landing_s

if TYPE_CHECKING:
    from mission.spec.model import Point


class FlightWatch:
    """Watches one flight, by one plan or several.

    Attributes:
        legs: What of the flight counts, by the plans that are flown.
        tracking: The distance from the trajectory.
        largest_distance_m: Largest horizontal distance from the trajectory.
        beyond_tube_s: Longest time without a break that the vehicle was beyond the certified tube.
        began_s: Vehicle time at which the trajectory began; None before.
        vehicle: Name of the autopilot; empty before it is known.
        gaps: Where nothing was known of the position, or the trajectory paused, from its start on.
        cadence: How regularly setpoints were sent.
        pictures: The numbers of the pictures that were told of.
        returning: Whether the vehicle was asked to return after the lap that it was in.
        place_m: Where the vehicle is, by its last report, ENU in the domain.
        velocity_m_s: How fast.
        altitude_m: How high; None before a report.
    """

    def __init__(self, plan: FlightPlan, record: RecordWriter, *, record_all: bool = False) -> None:
        """Watch from the ground; ``record_all``: write down each report and setpoint whole."""
        self.legs = FlightLegs(plan)
        self.tracking = TrackingWatch(plan.certificate.tube_m)
        self.largest_distance_m = 0.0
        self.beyond_tube_s = 0.0
        self.began_s: float | None = None
        self.vehicle = ""
        self.returning = False
        self.place_m = plan.start_m
        self.velocity_m_s: Point = (0.0, 0.0)
        self.altitude_m: float | None = None
        self.gaps: list[Gap] = []
        self.cadence = CadenceWatch()
        self.pictures: list[int] = []
        self._told_s = math.inf
        self._record, self._routine = record, Routine(record, everything=record_all)
        self._nearness = Nearness()
        self._stage = Stage.CONNECT
        self._written = (0, 0, 0)
        """Which leg was written last, and how many of its visits and violations."""
        self._trajectory = plan.trajectory

    def take_up(
        self, legs: FlightLegs, began_s: float, last_s: float, pictures: Iterable[int], tracked: Tracking
    ) -> None:
        """Go on with a flight that was left.

        Args:
            legs: What of it counts.
            began_s: Vehicle time at which its trajectory began.
            last_s: Vehicle time of its last report.
            pictures: The numbers of those that were told of.
            tracked: How well its trajectory was followed.
        """
        self.pictures.extend(pictures)
        self.tracking.largest_m = float(np.abs(tracked.error_m).max(initial=0.0))
        self.tracking.largest_m_s = float(np.nanmax(np.abs(tracked.velocity_error_m_s), initial=0.0))
        self.largest_distance_m = float(tracked.distance_m.max(initial=0.0))
        self.legs, self._trajectory = legs, legs.now.plan.trajectory
        self._written = (len(legs.legs) - 1, len(self.monitor.visits), len(self.monitor.violations))
        self.began_s, self._told_s = began_s, last_s

    @property
    def plan(self) -> FlightPlan:
        """What is flown."""
        return self.legs.now.plan

    @property
    def monitor(self) -> Monitor:
        """The word of the present leg."""
        return self.legs.now.judged.monitor

    def take_over(
        self,
        plan: FlightPlan,
        at_s: float,
        laps_before: int,
        *,
        begun: bool,
        returns: bool = False,
        fresh: bool = False,
        amended: bool = False,
    ) -> None:
        """Let another plan be flown from a vehicle time on, after so many laps (``FlightLegs.take_over``)."""
        self.legs.take_over(plan, at_s, laps_before, begun=begun, returns=returns, fresh=fresh, amended=amended)

    def take(self, event: Event) -> None:
        """Write an event down and draw the consequences."""
        if isinstance(event, Moved):
            self._moved(event)
        elif isinstance(event, SetpointSent):
            self.cadence.note(event.t_s, event.trajectory_s)
            if event.gap is not None:
                self._note_gap(event.gap)
            self._routine.sent(event)
        elif isinstance(event, Photographed):
            self._photographed(event)
        elif isinstance(event, StageEntered):
            self._stage = event.stage
            self._routine.settle()
            if event.stage is Stage.FLY:
                self.began_s = event.t_s
            self._record.write("event", event.t_s, name="stage", stage=event.stage)
        else:
            self._write_down(event)

    def progress(self, session: Session, listening: Listening) -> Progress:
        """Where the flight is now."""
        guidance, newest_s = session.guidance, session.vehicle.clock.newest_s
        flown_s = 0.0 if guidance is None or newest_s is None else guidance.flown_s(newest_s)
        laps = self.plan.trajectory.laps if guidance is None else guidance.course.laps
        if self._trajectory.legs is not self.plan.trajectory.legs or laps != self._trajectory.laps:
            self._trajectory = replace(self.plan.trajectory, laps=laps)
        since_s = 0.0 if self.began_s is None or newest_s is None else max(0.0, newest_s - self.began_s)
        counted, place = self.monitor.progress, float(self._trajectory.parameter(flown_s)[0])
        leg_starts_s = self.plan.leg_starts_s
        return Progress(
            stage=session.stage,
            waiting_for=session.waiting_for,
            t_s=newest_s,
            trajectory_s=flown_s,
            duration_s=self._trajectory.duration_s,
            leg=max(bisect_right(leg_starts_s, place) - 1, 0),
            legs=len(leg_starts_s),
            done=counted.done,
            total=counted.total,
            awaited=counted.awaited,
            laps=self.monitor.laps,
            laps_asked=self._trajectory.laps,
            returning=self.returning or 0.0 < self._trajectory.laps_end_s <= flown_s,
            verdict=self.monitor.verdict,
            behind_s=listening.behind_s if listening.is_behind else 0.0,
            altitude_m=self.altitude_m,
            speed_m_s=None if self.altitude_m is None else math.hypot(*self.velocity_m_s),
            error_m=self.tracking.error_m if session.stage is Stage.FLY else None,
            battery_percent=None if session.vehicle.battery is None else session.vehicle.battery.percent,
            nearest=None if self.altitude_m is None else self._nearness.of(self.plan, self.place_m, since_s),
            plan=self.plan,
            place_m=None if self.altitude_m is None else self.place_m,
            heading_rad=None if session.vehicle.attitude is None else session.vehicle.attitude.angles_rad[2],
            word=self.monitor.word,
            bounds=self.legs.bounds,
            since_s=since_s,
        )

    def covered(self, laps: int | None) -> tuple[Covered, ...]:
        """What was covered, of so many laps."""
        return self.legs.covered(laps)

    def violation(self) -> str:
        """What has happened that must not, in plain words; empty where nothing has."""
        violations = self.legs.violations
        if not violations:
            return ""
        first = violations[0]
        names = f" {', '.join(first.names)}" if first.names else ""
        return f"the vehicle {first.kind}{names}"

    def closing(self, now_s: float, flown_s: float, *, waits: bool = False) -> str:
        """What comes of restricted regions that are there for a time only, or move; empty where nothing does.

        Args:
            now_s: The vehicle's time.
            flown_s: How much of the trajectory has been flown by then.
            waits: Whether the vehicle waits where it is.
        """
        late_s = 0.0 if self.began_s is None else max(0.0, now_s - self.began_s - flown_s)
        if name := entered(self.plan.closings, (each.formula for each in self.monitor.bounds if each.met is False)):
            return f"the vehicle was in {name}"
        if name := ahead(self.plan.closings, flown_s, late_s):
            return f"the flight is {late_s:.1f} s late and would come into {name}"
        if waits:
            return "the vehicle cannot wait on" if self.coming(now_s, soon=True) else ""
        if self._drifting is not None and (name := self._drifting.ahead(flown_s, late_s)):
            return f"the flight is {late_s:.1f} s late and would come into {name}, which moves"
        return ""

    def coming(self, now_s: float | None, *, soon: bool = False) -> str:
        """What moves and comes to where the vehicle would hold on its way, in plain words; empty where nothing does.

        Args:
            now_s: The vehicle's time; None before it is known.
            soon: Whether only that counts which comes while a landing may last.
        """
        if self._drifting is None or self.began_s is None or now_s is None or self._stage is not Stage.FLY:
            return ""
        braking_m = math.hypot(*self.velocity_m_s) ** 2 / (2.0 * self.plan.spec.limits.acceleration_m_s2)
        clock_s = max(0.0, now_s - self.began_s)
        found = self._drifting.comes(self.place_m, self.plan.certificate.tube_m + braking_m, clock_s)
        until_s = landing_s(self.plan.spec.flight.altitude_m) if soon else math.inf
        if found is None or found[0] - clock_s > until_s:
            return ""
        return f"{found[1]} moves to where the vehicle would hold, in {found[0] - clock_s:.0f} s"

    @cached_property
    def _drifting(self) -> Drifting | None:
        """What moves and must not be entered; such a mission is flown by one plan alone."""
        plan = self.legs.legs[0].plan
        return None if plan.moving is None else Drifting(plan, plan.moving)

    def _moved(self, event: Moved) -> None:
        event = self._routine.moved(event)
        place = (event.position_m[0], event.position_m[1])
        leg = self.legs.now
        self.legs.report(self._stage, event.t_s, place, event.trajectory_s)
        if leg is not self.legs.now:
            self.tracking.rest()
        self.place_m, self.velocity_m_s = place, (event.velocity_m_s[0], event.velocity_m_s[1])
        self.altitude_m = event.position_m[2]
        if event.trajectory_s is None:
            self.tracking.rest()
        else:
            planned = (event.planned_m[0], event.planned_m[1])
            self.tracking.observe(event.t_s, place, planned)
            self.tracking.observe_velocity(event.velocity_m_s[:2], event.planned_m_s[:2])
            self.largest_distance_m = max(self.largest_distance_m, math.dist(place, planned))
            self.beyond_tube_s = max(self.beyond_tube_s, self.tracking.excess_s)
            self.legs.now.keep(event.trajectory_s, in_tube=self.tracking.is_within)
        if self.began_s is not None:
            gap_s = event.t_s - self._told_s
            if gap_s > GAP_S and self._stage in WATCHED:
                self._note_gap(Gap(Missing.POSITION, self._told_s, gap_s))
            self._told_s = event.t_s
        self._write_visits(event.t_s)

    def _photographed(self, event: Photographed) -> None:
        self.pictures.append(event.number)
        latitude_deg, longitude_deg, altitude_amsl_m = event.place or (None, None, None)
        level_m, height_m = event.accuracy_m or (None, None)
        self._record.write(
            "image",
            event.t_s,
            number=event.number,
            utc_us=event.utc_us,
            latitude_deg=latitude_deg,
            longitude_deg=longitude_deg,
            altitude_amsl_m=altitude_amsl_m,
            position_m=event.position_m,
            attitude_rad=event.attitude_rad,
            accuracy_m=level_m,
            height_accuracy_m=height_m,
            trajectory_s=event.trajectory_s,
        )

    def _note_gap(self, gap: Gap) -> None:
        self.gaps.append(gap)
        self._record.write(
            "event", gap.from_s + gap.for_s, name="gap", missing=gap.missing, from_s=gap.from_s, for_s=gap.for_s
        )

    def _write_visits(self, t_s: float) -> None:
        for leg in self.legs.legs[self._written[0] :]:
            visits, violations = leg.judged.monitor.visits, leg.judged.monitor.violations
            for violation in violations[self._written[2] :]:
                self._record.write(
                    "event",
                    violation.time_s,
                    name="violation",
                    violation=violation.kind,
                    names=violation.names,
                    position_m=violation.position_m,
                )
                if not violation.names:
                    self._record.write("visit", t_s, triangle=OUTSIDE, labels=())
            for visit in visits[self._written[1] :]:
                labels = leg.plan.labelling.label(visit.triangle)
                self._record.write("visit", visit.entered_s, triangle=visit.triangle, labels=labels)
            counted = len(visits), len(violations)
            self._written = (len(self.legs.legs) - 1, *counted) if leg is self.legs.now else (0, 0, 0)

    def _write_down(self, event: Event) -> None:
        if isinstance(event, Said):
            self._record.write("text", event.t_s, severity=event.severity, text=event.text)
        elif isinstance(event, Asked):
            self._record.write("event", event.t_s, name="command", command=event.command, attempt=event.attempt)
        elif isinstance(event, Answered):
            self._record.write("event", event.t_s, name="answer", command=event.command, result=event.result)
        elif isinstance(event, Held):
            name = "held by a pilot" if event.words else "handed back"
            self._record.write("event", event.t_s, name=name, reason=event.words)
        elif isinstance(event, WentOn):
            self._record.write("event", event.t_s, name="went on", reason=event.words)
        elif isinstance(event, Anchored):
            self._record.write("event", event.t_s, name="anchored", origin_ned_m=event.origin_ned_m)
        elif isinstance(event, VersionTold):
            self._record.write("event", None, name=FIRMWARE, firmware=event.firmware, board=event.board)
        elif isinstance(event, Identified):
            self.vehicle = event.autopilot
            self._record.write(
                "vehicle",
                None,
                autopilot=event.autopilot,
                vehicle_type=event.vehicle_type,
                system_id=event.system_id,
            )
