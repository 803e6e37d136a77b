"""The vehicle on the other side of a link: found, identified, listened to, asked, without I/O."""

import math
from collections import deque
from typing import TYPE_CHECKING, Final

from mission.errors import LinkError, MissionError, VehicleError
from mission.link.arrival import Arrival
from mission.link.company import Company
from mission.link.connection import StreamRequests, autopilot_of, is_vehicle
from mission.link.events import Answered, Asked, Event, Identified, Said, VersionTold
from mission.link.identity import LinkOptions
from mission.link.inbox import Inbox
from mission.link.leading import Leader
from mission.link.messages import AUTOPILOT_COMPONENT, Codec, Stream, request_message, vehicle_type_name
from mission.link.parameters import ParameterReading
from mission.link.photography import Photography
from mission.link.pictures import PictureBook
from mission.link.plan_values import Partner, PlanBody
from mission.link.requests import Answer, RequestChannel
from mission.link.services import parameter_request
from mission.link.texts import Text
from mission.link.values import (
    Acknowledgement,
    Body,
    Heartbeat,
    Image,
    LocalPosition,
    LocalSetpoint,
    ParameterValue,
    Ping,
    Received,
    TimeAnswer,
    Version,
)
from mission.link.vehicle_state import HEARTBEATS, VehicleState
from mission.link.watchdog import Watchdog
from mission.plan.photographs import Photographs

if TYPE_CHECKING:
    from mission.link.autopilot import Autopilot
    from mission.link.fence_guard import FenceGuard

_BEAT_S: Final = 1.0
_ASK_AGAIN_S: Final = 2.0
_RENEW_S: Final = 0.5
_READY_FOR_S: Final = 1.0


class Contact:
    """What is known of the other side, and what goes there.

    Attributes:
        options: Ids and patience.
        vehicle: What the vehicle has said.
        autopilot: Which kind it is; None before it was heard.
        waiting_for: What is waited for before the vehicle can be flown, in plain words; empty where nothing is.
        events: What has happened, oldest first; whoever reads it empties it.
        inbox: What has arrived and was not handled yet.
        arrival: When what is sent arrives.
        photography: Switches the camera.
        pictures: What was told of its pictures; None where they do not count.
        parameters: What is asked of its parameters, and what has come.
        company: Which other vehicles were heard.
        fence: Its geofence, where that is to guard the flight: whoever departs says so before.
        late_s: How long what was handled last had waited, on the clock here.
        out: Frames to send, likewise; answers to PINGs come after them.
    """

    def __init__(self, options: LinkOptions, *, needs_origin: bool, aloft: bool = False) -> None:
        """Wait for a vehicle; ``needs_origin``: one that knows where on Earth it is; ``aloft``: one in the air."""
        self.options = options
        self.vehicle = VehicleState()
        self.arrival = Arrival(self.vehicle.clock)
        self.autopilot: Autopilot | None = None
        self.waiting_for = "no heartbeat yet"
        self.events: deque[Event] = deque()
        self.inbox = Inbox()
        self.company = Company()
        self.late_s = 0.0
        self.out: deque[bytes] = deque()
        self._pings: list[tuple[Received, Ping]] = []
        self._needs_origin, self._aloft = needs_origin, aloft
        self._codec = Codec(options.system_id, options.component_id, options.signatures)
        self.channel = RequestChannel(options.system_id, options.component_id)
        self.photography = self._photography(())
        self.pictures: PictureBook | None = None
        self.parameters = ParameterReading()
        self.fence: FenceGuard | None = None
        self._streams: StreamRequests | None = None
        self._system_id = 0
        self._heard_s = -math.inf
        self._began_s: float | None = None
        self._beat_s = self._beat_vehicle_s = -math.inf
        self._ask_again_s = -math.inf
        self._ready_from_s = math.inf
        self._watchdog = Watchdog(options.lost_s)

    def receive(self, data: bytes, now_s: float) -> list[Body]:
        """What the vehicle's autopilot says in these bytes, after all that waits; everyone else is left out.

        Raises:
            VehicleError: It is no vehicle that can be flown from here.
        """
        self.listen(data, now_s)
        said = [self.next(now_s) for _ in range(len(self.inbox))]
        return [body for body in said if body is not None]

    def listen(self, data: bytes, at_s: float) -> None:
        """Let what has arrived wait until it is handled."""
        for frame in self._codec.judged(data):
            self.inbox.put(frame, at_s)

    def next(self, now_s: float) -> Body | None:
        """What the vehicle's autopilot says in the frame that waits longest; None where that is someone else's.

        Raises:
            KeyError: None waits.
            VehicleError: It is no vehicle that can be flown from here.
        """
        frame, came_s = self.inbox.take()
        self.late_s = now_s - came_s
        received = self._codec.read(frame)
        if is_vehicle(received):
            self.company.systems.add(received.system_id)
            if self.autopilot is None and self.options.vehicle_id in (0, received.system_id):
                self._meet(received)
        if isinstance(received.body, Ping):
            self._answer(received, received.body)
        known = self.autopilot is not None and received.system_id == self._system_id
        silent = isinstance(received.body, Heartbeat) and not is_vehicle(received)
        if not known or silent or received.component_id != AUTOPILOT_COMPONENT:
            return None
        self._heard_s = now_s
        self.company.take(received.body)
        if isinstance(received.body, TimeAnswer):
            self.arrival.take(received.body, now_s)
            return None
        return received.body

    def take(self, body: Body, now_s: float) -> Answer | None:
        """Take note of what the vehicle says; returns the answer to the command under way, if this is it."""
        if isinstance(body, Acknowledgement):
            answer = self.channel.take(body, now_s)
            if answer is not None:
                self._note_answer(answer, now_s)
            else:
                self._take_from_camera(self.photography.channel.take(body, now_s), now_s)
            return answer
        if isinstance(body, ParameterValue | PlanBody):
            if isinstance(body, ParameterValue):
                self.parameters.take(body)
            if self.fence is not None:
                self.fence.take(body)
            return None
        if isinstance(body, Image):
            if self.pictures is not None:
                self.pictures.take(body, self._vehicle_s(now_s))
            return None
        self._note_texts(self.vehicle.take(body, now_s), now_s)
        if not isinstance(body, LocalPosition) or body is self.vehicle.position:  # what comes late renews nothing
            self._watchdog.take(body, now_s, self.vehicle.clock.seen_s)
        if isinstance(body, Version):
            self.events.append(VersionTold(".".join(map(str, body.firmware)), body.board))
        return None

    def advance(self, now_s: float) -> Answer | None:
        """Send our heartbeat; returns a command given up for lost.

        Raises:
            LinkError: The vehicle was never heard.
        """
        if self._began_s is None:
            self._began_s = now_s
        self._note_texts(self.vehicle.overdue_texts(now_s), now_s)
        self._beat(now_s)
        if self.autopilot is None:
            if now_s - self._began_s > self.options.connect_s:
                raise LinkError(f"{self._unheard()} within {self.options.connect_s:.0f} s")
            return None
        self.channel.speed = self.photography.channel.speed = max(self.vehicle.clock.rate, 1.0)
        asked_ns = self.arrival.due(now_s)
        if asked_ns is not None:
            self.out.append(self._codec.time_request(asked_ns))
        answer = self.channel.unanswered(now_s)
        if answer is not None:
            self._note_answer(answer, now_s)
        for name in self.parameters.due(now_s):
            self.out.append(self._codec.packed(parameter_request(self._system_id, name)))
        return answer

    def trouble(self, now_s: float, *, departed: bool) -> MissionError | None:
        """Why nobody can go on with this vehicle; None where one can.

        It fell silent, is one of two with one id, was restarted, or, once departed, does not tell what a flight needs.
        """
        if self.autopilot is None:
            return None
        if now_s - self._heard_s > self.options.lost_s:
            return LinkError(f"nothing was heard from the vehicle for {now_s - self._heard_s:.1f} s")
        if self.company.doubled or self.arrival.doubled:
            return VehicleError(
                f"two vehicles with the system id {self._system_id} are heard, and both obey what is told to one: "
                f"give one another id (ArduPilot's MAV_SYSID or SYSID_THISMAV, PX4's MAV_SYS_ID)"
            )
        if self.vehicle.clock.restarted:
            return VehicleError("the vehicle was restarted")
        lost = self._watchdog.lost(now_s, self.vehicle.clock.seen_s) if departed else ""
        return LinkError(f"{lost}, though it was asked to") if lost else None

    def _unheard(self) -> str:
        """Which vehicle was not heard, and what was heard instead."""
        if self.company.systems:
            heard = ", ".join(map(str, sorted(self.company.systems)))
            return f"no vehicle of system id {self.options.vehicle_id} was heard, only of {heard},"
        if self._codec.refused:
            return f"no vehicle was heard that signs with this key, but {self._codec.refused} other packets,"
        return "no vehicle was heard"

    def ask_for_streams(self, now_s: float) -> bool:
        """Go on asking for telemetry, once for each message and again for what does not come; True after once."""
        if self._streams is None or self.channel.busy:
            return False
        command = self._streams.next()
        if command is not None:
            self.channel.ask(command, now_s)
            return False
        if now_s >= self._ask_again_s:
            if math.isfinite(self._ask_again_s):
                if self._watchdog.overdue(now_s, self.vehicle.clock.seen_s):
                    self.vehicle.heard_kinds.clear()  # it has dropped our rates, as where it was restarted
                self._streams.begin_again(self.vehicle.heard_kinds)
            self._ask_again_s = now_s + _ASK_AGAIN_S
        return True

    def ask_for_overdue(self, now_s: float, *, origin: bool = False) -> None:
        """Ask again for what a flight needs and has not come of late, as after a vehicle has dropped our rates.

        Args:
            now_s: The time here.
            origin: Whether the origin of its local frame is to be told again, too.
        """
        overdue = self._watchdog.overdue(now_s, self.vehicle.clock.seen_s)
        if self._streams is None or self.channel.busy or now_s < self._ask_again_s or not (overdue or origin):
            return
        self._ask_again_s = now_s + _RENEW_S
        again = self._streams.renewal(overdue) if overdue else request_message(Stream.GPS_GLOBAL_ORIGIN)
        self.channel.ask(again, now_s)

    def ready(self, now_s: float) -> bool:
        """Whether position and health have been good enough to fly for a while.

        Raises:
            VehicleError: The vehicle is armed already, or is not although it should be in the air, or has not become
                ready in time.
        """
        if self.vehicle.heartbeats_armed >= HEARTBEATS and not self._aloft:
            raise VehicleError("the vehicle is armed already; a mission begins on the ground, with motors off")
        if self.vehicle.heartbeats_disarmed >= HEARTBEATS and self._aloft:
            raise VehicleError("the vehicle's motors are off: its flight is over")
        self.waiting_for = self.vehicle.unready(absolute=self._needs_origin, aloft=self._aloft)
        vehicle_s = self.vehicle.clock.now_s(now_s)
        if self.waiting_for or vehicle_s is None:
            self._ready_from_s = math.inf
            if self._began_s is not None and now_s - self._began_s > self.options.ready_s:
                why = f"the vehicle is not ready after {self.options.ready_s:.0f} s: {self.waiting_for}"
                raise VehicleError(self.explained(why, -math.inf))
            return False
        self._ready_from_s = min(self._ready_from_s, vehicle_s)
        return vehicle_s - self._ready_from_s >= _READY_FOR_S

    def photograph(self, stretches: tuple[Photographs, ...], guidance: Leader | None = None) -> None:
        """Photograph these stretches of the trajectory that is led along; pictures count from now on."""
        self.photography = self._photography(stretches)
        self.pictures = PictureBook(self.vehicle, self.events, guidance)

    def switch_camera(self, trajectory_s: float | None, now_s: float) -> None:
        """Switch the camera's trigger as it should be at a time on the trajectory, None where none is flown."""
        self._take_from_camera(self.photography.channel.unanswered(now_s), now_s)
        self.photography.advance(trajectory_s, now_s)
        self._send_due(self.photography.channel, now_s)
        if self.pictures is not None:
            self.pictures.advance(self._vehicle_s(now_s))

    @property
    def system_id(self) -> int:
        """Of the vehicle; 0 before it was heard."""
        return self._system_id

    @property
    def own(self) -> Partner:
        """Who we are."""
        return Partner(self.options.system_id, self.options.component_id)

    @property
    def unfinished(self) -> bool:
        """Whether something of the vehicle is not as it was before, and there is hope of that."""
        return self.photography.unfinished or (self.fence is not None and self.fence.unfinished)

    def tend_fence(self, now_s: float, *, over: bool) -> None:
        """Go on setting the vehicle's geofence, or putting back what it had, once the flight is over."""
        guard = self.fence
        if guard is None:
            return
        if over:
            guard.put_back()
        self.out.extend(map(self._codec.packed, guard.advance(self._system_id, now_s)))

    def send_command(self, now_s: float) -> None:
        """Send the command under way, if it is due for the first time or again."""
        self._send_due(self.channel, now_s)

    def wait_s(self, now_s: float) -> float:
        """How long until a command is to be sent or given up, on the clock here; infinite where none is under way."""
        fence_s = math.inf if self.fence is None else self.fence.wait_s(now_s)
        return min(self.channel.wait_s(now_s), self.photography.channel.wait_s(now_s), fence_s)

    def arrives_s(self, now_s: float) -> float | None:
        """Vehicle time at which what is sent now arrives; None before the vehicle has told its time."""
        vehicle_s = self.vehicle.clock.now_s(now_s)
        return None if vehicle_s is None else vehicle_s + self.arrival.delay_s

    def _vehicle_s(self, now_s: float) -> float:
        return self.vehicle.clock.now_s(now_s) or 0.0

    def _photography(self, stretches: tuple[Photographs, ...]) -> Photography:
        return Photography(RequestChannel(self.options.system_id, self.options.component_id), stretches)

    def _take_from_camera(self, answer: Answer | None, now_s: float) -> None:
        if answer is not None:
            self._note_answer(answer, now_s)
            self.photography.take(answer, now_s)

    def _send_due(self, channel: RequestChannel, now_s: float) -> None:
        due = channel.due(now_s)
        if due is not None:
            command, attempt = due
            self.out.append(self._codec.command(self._system_id, command, attempt))
            self.events.append(Asked(self.vehicle.clock.now_s(now_s), command.name, attempt))

    def happened(self) -> list[Event]:
        """What has happened since the last call, oldest first."""
        events = list(self.events)
        self.events.clear()
        return events

    def outgoing(self) -> list[bytes]:
        """Frames to send, oldest first; they are forgotten here.

        Answers to PINGs are the last, for they vouch for having handled all before them, and are made last: a signed
        frame that is sent after a later one is refused.
        """
        frames = [*self.out, *(self._codec.answer(asked, ping) for asked, ping in self._pings)]
        self.out.clear()
        self._pings.clear()
        return frames

    def hold_frames(self) -> list[bytes]:
        """The command to hold, beside the command under way."""
        return [] if self.autopilot is None else [self._codec.command(self._system_id, self.autopilot.hold, 0)]

    def send_setpoint(self, setpoint: LocalSetpoint) -> None:
        """Send a setpoint."""
        self.out.append(self._codec.setpoint(self._system_id, setpoint))

    def explained(self, what: str, since_s: float) -> str:
        """``what`` with the vehicle's own words since a vehicle time."""
        words = self.vehicle.words_since(since_s)
        return f"{what}; it says: {words}" if words else what

    def _answer(self, asked: Received, ping: Ping) -> None:
        """Whoever asks all is answered; system 0 is nobody, and an answer to it would ask all again."""
        if ping.target_system == 0 and asked.system_id != 0:
            self._pings.append((asked, ping))

    def _meet(self, received: Received) -> None:
        heartbeat = received.body
        if isinstance(heartbeat, Heartbeat):
            self.autopilot = autopilot_of(heartbeat)
            self._system_id = received.system_id
            self._streams = StreamRequests(self.autopilot)
            self.parameters.begin(self.autopilot.name)
            self.waiting_for = "no telemetry yet"
            kind = vehicle_type_name(heartbeat.vehicle_type)
            self.events.append(Identified(self.autopilot.name, kind, received.system_id))

    def _beat(self, now_s: float) -> None:
        """Our own heartbeat, once a second on either clock: the vehicle counts by its own."""
        vehicle_s = self.vehicle.clock.now_s(now_s)
        if now_s - self._beat_s >= _BEAT_S or (vehicle_s is not None and vehicle_s - self._beat_vehicle_s >= _BEAT_S):
            self._beat_s = now_s
            self._beat_vehicle_s = -math.inf if vehicle_s is None else vehicle_s
            self.out.append(self._codec.heartbeat())

    def _note_answer(self, answer: Answer, now_s: float) -> None:
        result = "no answer" if answer.result is None else answer.result.name.lower().replace("_", " ")
        self.events.append(Answered(self.vehicle.clock.now_s(now_s), answer.command.name, result))

    def _note_texts(self, texts: list[Text], now_s: float) -> None:
        self.events.extend([Said(self.vehicle.clock.now_s(now_s), *text) for text in texts])
