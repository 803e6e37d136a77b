"""A flight over MAVLink as a state machine without I/O: bytes and the time go in, bytes and events come out.

CONNECT -> STREAMS -> READY -> STANDBY, then, once ``depart`` is called, the steps of the autopilot's own departure,
SETTLE, FLY, ARRIVE, LAND, TOUCH_DOWN, DISARM -> DONE. Two clocks run: the one here paces repetitions on the link, the
vehicle's own (``vehicle_clock``) paces everything that the vehicle does, the trajectory above all.

Someone who flies the vehicle otherwise, a pilot or a failsafe, is never fought: two heartbeats in another mode end
the session's part at once, and over one alone nothing is commanded.
"""

import math
from typing import Final

from mission.errors import MissionError, VehicleError
from mission.link.contact import Contact
from mission.link.course import Course
from mission.link.ending import Ending
from mission.link.events import Event, Held, StageEntered
from mission.link.frames import Anchor, Anchoring
from mission.link.guidance import Guidance
from mission.link.identity import LinkOptions
from mission.link.itinerary import onward, taken_over, way_out, whole_flight
from mission.link.lead import Lead
from mission.link.leading import Leader
from mission.link.origin_watch import OriginWatch
from mission.link.procedure import Procedure
from mission.link.steps import Scene, Step
from mission.link.takeover import Takeover, how_left
from mission.link.values import Body, Heartbeat, LocalPosition, Origin
from mission.link.vehicle_state import VehicleState
from mission.monitor.stage import Stage
from mission.plan.photographs import Photographs

_LOOK_S: Final = 0.05
_WORDS_S: Final = 10.0
"""Vehicle time: what came before has had its effect."""

_DESCENDING: Final = (Stage.TOUCH_DOWN, Stage.DISARM)
_LANDING: Final = (Stage.LAND, *_DESCENDING)


class Session:
    """One flight.

    Attributes:
        contact: The vehicle on the other side.
        stage: Where the flight is.
        ending: How it ended; None while it lasts.
        ending_reason: Why, in plain words.
        lead: What leads the vehicle, once it departs.
        pilot: Whether somebody else flies it and is waited for.
    """

    def __init__(
        self,
        *,
        needs_origin: bool,
        options: LinkOptions | None = None,
        land_when_stopped: bool = False,
        waits_for_pilot: bool = False,
        aloft: bool = False,
    ) -> None:
        """Wait for a vehicle.

        Args:
            needs_origin: Whether the mission lies at a place on Earth, so that the vehicle must know where it is.
            options: Ids and patience.
            land_when_stopped: Whether a flight that is given up in the air ends with a landing on the spot.
            waits_for_pilot: Whether a pilot who takes the vehicle from its trajectory may hand it back.
            aloft: Whether it is one in the air, that is taken over there.
        """
        self.contact = Contact(options or LinkOptions(), needs_origin=needs_origin, aloft=aloft)
        self.stage = Stage.CONNECT
        self.ending: Ending | None = None
        self.ending_reason = ""
        self.pilot = Takeover()
        self.lead = Lead(self.contact.vehicle, self.contact.options.setpoint_s, self.contact.arrival)
        self._origin = OriginWatch(None)
        self._procedure = self._procedure_of()
        self._disarmed_from_s = math.inf
        self._land_when_stopped, self._waits_for_pilot = land_when_stopped, waits_for_pilot
        self._outcome: tuple[Ending, str] = (Ending.LANDED, "the vehicle has landed")
        self._failure: MissionError | None = None
        self._failing_from_s = math.inf

    # What the flight loop calls.

    @property
    def vehicle(self) -> VehicleState:
        """What the vehicle has said."""
        return self.contact.vehicle

    @property
    def waiting_for(self) -> str:
        """What is waited for before the vehicle can be flown, in plain words; empty where nothing is."""
        return self.contact.waiting_for if self.stage in (Stage.CONNECT, Stage.STREAMS, Stage.READY) else ""

    @property
    def guidance(self) -> Leader | None:
        """What leads the vehicle; None before it is armed."""
        return self.lead.guidance

    def receive(self, data: bytes, now_s: float) -> None:
        """Take what has arrived, and all that waits.

        Raises:
            VehicleError: It is no vehicle that can be flown from here, or moved its origin in flight.
        """
        for body in self.contact.receive(data, now_s):
            self._take(body, now_s)

    def hear(self, now_s: float) -> None:
        """Handle the message that has waited longest, as ``receive`` does all."""
        if (body := self.contact.next(now_s)) is not None:
            self._take(body, now_s)

    def advance(self, now_s: float) -> None:
        """Do what is due.

        Raises:
            LinkError: The vehicle is not there, or has fallen silent, or does not answer.
            VehicleError: It refused, or did not do what it accepted, or is in no state to be flown.

        A vehicle in the air is told to hold, or to land, before anything is raised.
        """
        self.tend(now_s)
        if self.stage is Stage.DONE and self._failure is not None:
            raise self._failure
        if self.stage is Stage.DONE:
            return
        vehicle_s = self.vehicle.clock.now_s(now_s)
        answer = self.contact.advance(now_s)
        if answer is not None and vehicle_s is not None:
            self._procedure.take(answer, vehicle_s, now_s)
        if self._failure is None and (trouble := self.contact.trouble(now_s, departed=self.departed)) is not None:
            if self.stage in _DESCENDING:
                raise trouble  # it lands without us
            self.give_up(trouble, now_s)
        if self.stage is Stage.CONNECT and self.contact.autopilot is not None:
            self._enter(Stage.STREAMS, vehicle_s)
        if self.stage in (Stage.STREAMS, Stage.READY):
            self._prepare(vehicle_s, now_s)
        elif self.stage is not Stage.STANDBY and vehicle_s is not None:
            self._proceed(vehicle_s, now_s)
        self._procedure.weigh(self.vehicle, now_s)
        self.contact.send_command(now_s)

    def tend(self, now_s: float, *, over: bool = False) -> None:
        """Switch the camera as the trajectory asks, set the geofence, and put both back once the flight is over."""
        self.contact.tend_fence(now_s, over=over or self.stage is Stage.DONE)
        photographs = self.stage is Stage.FLY and self.contact.photography.stretches
        flown_s = self.vehicle.clock.now_s(now_s) if photographs else None
        self.contact.switch_camera(None if flown_s is None else self.lead.photographed_s(flown_s), now_s)

    def depart(self, course: Course, tie: Anchoring | Anchor, photographs: tuple[Photographs, ...] = ()) -> None:
        """Fly: from STANDBY to the ground again, with pictures in these stretches of the trajectory.

        ``tie`` ties the domain to the ground that the vehicle takes off from, or took off from, if it is in the air.

        Raises:
            RuntimeError: The session is not standing by.
        """
        kind = self.contact.autopilot
        if self.stage is not Stage.STANDBY or kind is None:
            raise RuntimeError(f"cannot depart while {self.stage}")
        steps = whole_flight(kind, course, self.contact.fence)
        if isinstance(tie, Anchor):
            self._note(self.lead.take_over(course, tie))
            steps = taken_over(kind, course)
        else:
            self.lead.depart(course, tie)
        self._origin = OriginWatch(self.vehicle.origin)
        self.contact.photograph(photographs, self.guidance)
        self._procedure = self._procedure_of(*steps)
        self._enter(steps[0].stage, self.vehicle.clock.newest_s)

    @property
    def redirectable(self) -> bool:
        """Whether another course can be taken over: while the trajectory is flown, and nobody else flies."""
        return self.stage is Stage.FLY and self._failure is None and not self.pilot.words

    def redirect(self, course: Course, at_s: float, photographs: tuple[Photographs, ...] | None = None) -> None:
        """Fly another course from a vehicle time on.

        Args:
            course: Begins as was promised for then (``Guidance.promise``).
            at_s: Vehicle time, now or soon.
            photographs: What is photographed of it; None for what was to be.

        Raises:
            RuntimeError: No trajectory is flown.
        """
        kind, guidance = self.contact.autopilot, self.guidance
        if not self.redirectable or kind is None or not isinstance(guidance, Guidance):
            raise RuntimeError(f"no other course can be flown while {self.stage}")
        guidance.redirect(course, at_s)
        self.lead.course = course
        self._procedure.replace(onward(kind, course), at_s)
        if photographs is not None:
            self.contact.photography.follow(photographs)

    def stop(self, reason: str, now_s: float, *, lands: bool = False) -> None:
        """Give the mission up: hold, and land on the spot if wanted; on the ground, disarm. A landing goes on."""
        if self.stage is Stage.DONE or self.stage in _LANDING:
            return
        self._land_when_stopped |= lands
        goes_on = self._retreat(now_s)
        self._outcome = (Ending.HANDED_OVER if self.pilot.words else Ending.STOPPED, reason)
        if not goes_on:
            self._end(*self._outcome)

    def give_up(self, error: MissionError, now_s: float) -> None:
        """Let ``advance`` raise ``error``, but not before the vehicle has been told to hold, to land or to disarm.

        Raises:
            MissionError: ``error`` where nothing has to be told, or the one that was on its way when this one came.
        """
        if self._failure is not None:
            raise self._failure
        if not self._retreat(now_s):
            raise error
        self._failure, self._failing_from_s = error, now_s

    def leave(self, error: MissionError, now_s: float) -> None:
        """Give up unless that has been done; a landing goes on.

        Raises:
            MissionError: As in ``give_up``.
        """
        if self._failure is None and self.stage not in (*_LANDING, Stage.DONE):
            self.give_up(error, now_s)

    def last_words(self) -> list[bytes]:
        """The command to hold as a frame for a vehicle that flies, where nothing else works any more."""
        flies = self.departed and self.vehicle.armed
        return self.contact.hold_frames() if flies and self._procedure.allows(self.vehicle.mode) else []

    @property
    def departed(self) -> bool:
        """Whether the vehicle has been asked to fly."""
        return self.lead.course is not None

    @property
    def left(self) -> str:
        """How a vehicle with running motors is left, in plain words; empty where it is none, or somebody else's."""
        kind = self.contact.autopilot
        if self.ending is not None and self._failure is not None:
            return self.ending_reason
        if kind is None or not self.departed or self.stage is Stage.DONE:
            return ""
        return how_left(kind, self.vehicle, self.stage)

    def end_laps(self, now_s: float) -> bool:
        """Let the present lap be the last one; then the vehicle returns and lands. False where no lap is flown now."""
        vehicle_s = self.vehicle.clock.now_s(now_s)
        if self.stage is not Stage.FLY or self.guidance is None or vehicle_s is None:
            return False
        return self.guidance.end_laps(vehicle_s)

    def outgoing(self) -> list[bytes]:
        """Frames to send, oldest first; they are forgotten here."""
        return self.contact.outgoing()

    def events(self) -> list[Event]:
        """What has happened since the last call, oldest first."""
        return self.contact.happened()

    def wait_s(self, now_s: float) -> float:
        """How long to wait for messages before ``advance`` is due again, on the clock here."""
        waits = [_LOOK_S, self.contact.wait_s(now_s)]
        step = self._procedure.step
        if self.guidance is not None and step is not None and step.streaming:
            waits.append(self.vehicle.clock.local_until(self.guidance.next_s, now_s))
        return max(min(waits), 0.0)

    # Messages.

    def _take(self, body: Body, now_s: float) -> None:
        position_before_s = self.vehicle.position_at_s
        answer = self.contact.take(body, now_s)
        vehicle_s = self.vehicle.clock.now_s(now_s)
        if self.stage is Stage.DONE:
            return
        if answer is not None and vehicle_s is not None:
            self._procedure.take(answer, vehicle_s, now_s)
        if isinstance(body, LocalPosition):
            if self.vehicle.position_at_s > position_before_s:
                moved = self.lead.moved(body)
                if moved is not None:
                    self._note(moved)
        elif isinstance(body, Heartbeat):
            self._look_who_flies(body, vehicle_s, now_s)
        elif isinstance(body, Origin):
            self._check_origin(body, now_s)

    def _look_who_flies(self, heartbeat: Heartbeat, vehicle_s: float | None, now_s: float) -> None:
        if heartbeat.armed:
            self._disarmed_from_s = math.inf
        elif vehicle_s is not None:
            self._disarmed_from_s = min(self._disarmed_from_s, vehicle_s)
        step, kind, since_s = self._procedure.step, self.contact.autopilot, self.vehicle.clock.ago_s(now_s, _WORDS_S)
        end = self.pilot.look(heartbeat, step, kind, self.vehicle, since_s, self.lead.by_field or self._waits_for_pilot)
        if self.pilot.changed and end is None:
            self._note(Held(vehicle_s, self.pilot.words))
        if end is not None:
            self._end(end[0], self.contact.explained(end[1], since_s))

    def _check_origin(self, origin: Origin, now_s: float) -> None:
        if self.lead.ground_down_m is None or self.stage in _LANDING or self._failure is not None:
            return
        if self._origin.moved(origin, now_s):
            self.give_up(VehicleError("the vehicle moved the origin of its local frame in flight"), now_s)

    # The way.

    def _prepare(self, vehicle_s: float | None, now_s: float) -> None:
        if self.contact.ask_for_streams(now_s) and self.stage is Stage.STREAMS:
            self._enter(Stage.READY, vehicle_s)
        if self.stage is Stage.READY and self.contact.ready(now_s):
            self.contact.channel.forget()
            self._enter(Stage.STANDBY, vehicle_s)

    def _proceed(self, vehicle_s: float, now_s: float) -> None:
        self._take_ground()
        self._take_steps(vehicle_s, now_s)
        if self._failure is not None and self._stands_still(now_s):
            raise self._failure
        step = self._procedure.step
        if step is not None and step.armed and not self.vehicle.armed:
            what = f"the vehicle disarmed itself while {step.stage}"
            self.give_up(VehicleError(self.contact.explained(what, self.vehicle.clock.ago_s(now_s, _WORDS_S))), now_s)
        if step is None:
            if self._failure is not None:
                raise self._failure
            ending, reason = self._outcome
            kept = ending is Ending.STOPPED and self.vehicle.armed
            self._end(ending, f"{reason}; {self.left}" if kept else reason)
            return
        if step.stage is not self.stage:
            if step.stage is Stage.FLY and self.guidance is not None:
                self.guidance.begin(vehicle_s)
            self._enter(step.stage, vehicle_s)
        if step.streaming and (due := self.lead.due(vehicle_s)) is not None:
            self.contact.send_setpoint(due[0])
            self._note(due[1])
        if self._failure is None:
            self.contact.ask_for_overdue(now_s, origin=self._origin.doubts)

    def _take_steps(self, vehicle_s: float, now_s: float) -> None:
        if self.pilot.words:
            return  # whoever flies the vehicle is told nothing
        try:
            self._procedure.advance(lambda in_step_s: self._scene(vehicle_s, in_step_s), vehicle_s, now_s)
        except MissionError as error:
            self.give_up(error, now_s)

    def _take_ground(self) -> None:
        anchored = self.lead.take_ground()
        if anchored is not None:
            if self.contact.pictures is not None:
                self.contact.pictures.guidance = self.guidance
            self._note(anchored)

    def _scene(self, vehicle_s: float, in_step_s: float) -> Scene:
        return self.lead.scene(vehicle_s, in_step_s, max(vehicle_s - self._disarmed_from_s, 0.0))

    # Ends.

    def _procedure_of(self, *steps: Step) -> Procedure:
        self.contact.channel.forget()
        return Procedure(steps, self.contact.channel, self.vehicle.words_since, self._note)

    def _retreat(self, now_s: float) -> bool:
        """Take the way out: hold (and land) in the air, disarm on the ground; False where there is nothing to do."""
        kind, vehicle_s = self.contact.autopilot, self.vehicle.clock.now_s(now_s)
        motors = self.vehicle.armed or self.stage is Stage.ARM
        if kind is None or vehicle_s is None or not self.departed or self.pilot.words or not motors:
            return False
        if self.guidance is not None:
            self.guidance.end(vehicle_s)
        scene = self._scene(vehicle_s, 0.0)
        self._procedure = self._procedure_of(*way_out(kind, scene, self._procedure.step, lands=self._land_when_stopped))
        return True

    def _stands_still(self, now_s: float) -> bool:
        """Whether the way out cannot end by the vehicle's time, because that stands still."""
        return min(now_s - self._failing_from_s, now_s - self.vehicle.clock.heard_s) > 2.0 * self.contact.options.lost_s

    def _end(self, ending: Ending, reason: str) -> None:
        self.ending, self.ending_reason = ending, reason
        self._procedure = self._procedure_of()
        self._enter(Stage.DONE, self.vehicle.clock.newest_s)

    def _enter(self, stage: Stage, vehicle_s: float | None) -> None:
        self.stage = stage
        self._note(StageEntered(vehicle_s, stage))

    def _note(self, event: Event) -> None:
        self.contact.events.append(event)
