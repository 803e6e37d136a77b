"""The vehicle's MAVLink side without I/O: bytes of each link in, datagrams of each link out, time by steps.

endpoint.add_link("gcs")
endpoint.receive("gcs", data)     # handled at once; answers wait to be fetched
endpoint.advance()                # one step of the vehicle, and the telemetry that is due then
for datagram in endpoint.outgoing("gcs"): ...
"""

from typing import TYPE_CHECKING

from vehicle_sim.protocol.attitudes import AttitudeService
from vehicle_sim.protocol.calibrations import CalibrationService
from vehicle_sim.protocol.cameras import CameraService
from vehicle_sim.protocol.commands import CommandService
from vehicle_sim.protocol.dialect import AUTOPILOT_COMPONENT, mavlink
from vehicle_sim.protocol.events import EventService
from vehicle_sim.protocol.failures import FailureService
from vehicle_sim.protocol.fences import FenceService
from vehicle_sim.protocol.files import FileService
from vehicle_sim.protocol.flavour import TABLES, FlavourTable, Rates
from vehicle_sim.protocol.flight_log import FlightRecorder
from vehicle_sim.protocol.host import Sender
from vehicle_sim.protocol.key_setup import KeySetupService
from vehicle_sim.protocol.legacy_plans import LegacyPlanService
from vehicle_sim.protocol.link import Link
from vehicle_sim.protocol.log_transfer import LogService
from vehicle_sim.protocol.missions import MissionService
from vehicle_sim.protocol.mode_list import ModeListService
from vehicle_sim.protocol.mounts import MountService
from vehicle_sim.protocol.parameters import ParameterService
from vehicle_sim.protocol.plans import PlanService
from vehicle_sim.protocol.policy import SigningPolicy
from vehicle_sim.protocol.presence import PresenceService
from vehicle_sim.protocol.rates import RateService
from vehicle_sim.protocol.routing import Router
from vehicle_sim.protocol.sensing import UTC_OF_FIRST_BOOT_US
from vehicle_sim.protocol.setpoints import SetpointService
from vehicle_sim.protocol.signing import Signer
from vehicle_sim.protocol.special_commands import SpecialCommandService
from vehicle_sim.protocol.statustext import TextChunker
from vehicle_sim.protocol.sticks import StickService
from vehicle_sim.protocol.streams import NEVER_US
from vehicle_sim.protocol.telemetry import BUILDERS, V1_ALONE, Builder
from vehicle_sim.protocol.terrain import TerrainService
from vehicle_sim.protocol.timesync import TimeService

if TYPE_CHECKING:
    from collections.abc import Callable

    from vehicle_sim.autopilot import Severity
    from vehicle_sim.parameters import Flavour
    from vehicle_sim.protocol.dialect import Message
    from vehicle_sim.vehicle import Vehicle


class Endpoint:
    """One vehicle on any number of links.

    Attributes:
        vehicle: What flies; `advance` steps it, nothing else does.
        table: What tells its flavour from others.
        system_id: Its MAVLink system id.
        component_id: The component id of the autopilot in it.
        signer: Holds its key, if it has one.
        key_setup: Takes another key from a ground station.
        recorder: Writes the log of each armed period.
        now_us: Vehicle time since boot, in microseconds.
        utc_of_boot_us: When that was by the satellites' clock, in microseconds since 1970.
        on_message: Called with each message for the vehicle, and the name of its link, before it is handled.
    """

    def __init__(
        self,
        vehicle: "Vehicle",
        flavour: "Flavour",
        system_id: int = 1,
        *,
        component_id: int = AUTOPILOT_COMPONENT,
        signer: Signer | None = None,
    ) -> None:
        """Speak for `vehicle`; the flavour is the one that the vehicle was made with.

        Raises:
            ValueError: The flavour is another one than the vehicle's, or an id is not in 1 to 255.
        """
        if flavour is not vehicle.autopilot.flavour:
            raise ValueError(f"the vehicle answers like {vehicle.autopilot.flavour}, not like {flavour}")
        if not 0 < system_id <= 255:  # noqa: PLR2004 - a byte; 0 means all systems
            raise ValueError(f"a system id lies in 1 to 255, {system_id} does not")
        if not 0 < component_id <= 255:  # noqa: PLR2004 - the same
            raise ValueError(f"a component id lies in 1 to 255, {component_id} does not")
        self.vehicle = vehicle
        self.table: FlavourTable = TABLES[flavour]
        vehicle.parameters.set(self.table.system_id_parameter, system_id)
        self.system_id, self.component_id = system_id, component_id
        self.signer = Signer() if signer is None else signer
        self.utc_of_boot_us = UTC_OF_FIRST_BOOT_US
        self._step_us = round(vehicle.config.step_s * 1e6)
        self.now_us = vehicle.steps * self._step_us
        self.on_message: Callable[[str, Message], None] | None = None
        self._links: dict[str, Link] = {}
        self._purposes: dict[Link, Rates] = {}
        self._router = Router(system_id, component_id)
        self._links_opened = 0
        self._chunker = TextChunker()
        self._built: dict[int, Message | None] = {}
        self._reboot_due_us = NEVER_US
        commands, mode_list, fences = CommandService(self), ModeListService(self), FenceService(self)
        self._rates = RateService(self)
        self._parameters = ParameterService(self)
        self._plans = PlanService(self)
        self._missions = MissionService(self, self._plans.store)
        self._plans.keepers.update(fences.keepers)
        self._plans.keepers.update(self._missions.keepers)
        self._presence = PresenceService(self)
        self.recorder = FlightRecorder(self)
        self._log_transfer = LogService(self, self.recorder)
        self._files = FileService(self, self.recorder)
        self._rates.requests.update(mode_list.requests)
        self.key_setup = KeySetupService(self, self.signer)
        self._events = EventService(self)
        self._cameras = CameraService(self)
        self._sticks = StickService(self)
        calibrations = CalibrationService(self)
        self._with_partners = (self._parameters, self._plans, self._log_transfer, self._files)
        self._timed = (self._events, calibrations, self._plans)
        self._handlers: dict[int, Callable[[Sender, Message], None]] = {}
        builders: dict[int, Builder] = dict(BUILDERS)
        for service in (
            *(commands, mode_list, fences, calibrations, self._rates, self._presence, self._missions, self._events),
            *(self.key_setup, self._cameras, *self._with_partners),
            *(SetpointService(self), AttitudeService(self), self._sticks, TimeService(self)),
            *(FailureService(self), MountService(self), SpecialCommandService(self)),
            *(LegacyPlanService(self), TerrainService(self)),
        ):
            commands.handlers.update(getattr(service, "commands", {}))
            self._handlers.update(getattr(service, "messages", {}))
            builders.update(getattr(service, "telemetry", {}))
        self._builders = {
            message_id: build for message_id, build in builders.items() if message_id not in self.table.absent_messages
        }

    # Links.

    def add_link(
        self,
        name: str,
        rates: Rates = Rates.ONBOARD,
        *,
        byte_stream: bool = False,
        signing: SigningPolicy = SigningPolicy.REQUIRED,
        is_secure: bool = False,
    ) -> None:
        """Open a link.

        Args:
            name: Unique among the open links.
            rates: What is streamed on it unasked.
            byte_stream: Whether a frame may be split between two receptions (TCP, serial).
            signing: What it asks of signatures, while there is a key.
            is_secure: Whether it does not leave the machine, so that a key may be given over it.

        Raises:
            ValueError: There is a link of this name.
        """
        if name in self._links:
            raise ValueError(f"there is a link {name!r} already")
        link = Link(
            name,
            system_id=self.system_id,
            component_id=self.component_id,
            byte_stream=byte_stream,
            signer=self.signer,
            signing=signing,
            link_id=self._links_opened & 0xFF,
            is_secure=is_secure,
        )
        self._links_opened += 1
        self._links[name] = link
        self._purposes[link] = rates
        self._rates.start_defaults(link)

    def remove_link(self, name: str) -> None:
        """Close a link and forget its peer.

        Raises:
            KeyError: There is no such link.
        """
        link = self._links.pop(name)
        del self._purposes[link]
        self._router.forget(link)
        for service in self._with_partners:
            service.forget(link)

    def receive(self, link: str, data: bytes) -> int:
        """Handle what came by a link and return how many valid messages it held.

        What is not a valid MAVLink message to the vehicle changes nothing.

        Raises:
            KeyError: There is no such link.
        """
        came_by = self._links[link]
        messages = came_by.decode(data)
        for message in messages:
            decision = self._router.decide(message, came_by, tuple(self._links.values()))
            for other in decision.forward_to:
                other.forward(bytes(message.get_msgbuf()))
            if not decision.is_ours:
                continue
            if self.on_message is not None:
                self.on_message(link, message)
            handler = self._handlers.get(message.get_msgId())
            if handler is not None:
                self._built.clear()
                handler(Sender(came_by, message.get_srcSystem(), message.get_srcComponent()), message)
        if came_by.unknown:
            self._pass_on_unknown(came_by)
        return len(messages)

    def _pass_on_unknown(self, came_by: Link) -> None:
        for frame in came_by.unknown:
            for other in self._router.ways_of_unknown(frame, came_by, tuple(self._links.values())):
                other.forward(frame)
        came_by.unknown.clear()

    def outgoing(self, link: str) -> list[bytes]:
        """Return the datagrams that wait to be sent by a link, oldest first, and forget them.

        Raises:
            KeyError: There is no such link.
        """
        speaker = self._links[link]
        return speaker.closed(self._carried(link, speaker.drain()))

    def note_room(self, link: str, *, is_full: bool) -> None:
        """Note whether the line of a link takes more for now.

        While it does not, streams wait as those of autopilots do, each for its next message: a line that is too slow
        for all of them carries each more seldom, none too late, and none for ever.

        Raises:
            KeyError: There is no such link.
        """
        self._links[link].is_full = is_full

    def _carried(self, _link: str, datagrams: list[bytes]) -> list[bytes]:
        """What a line makes of datagrams: here nothing."""
        return datagrams

    @property
    def flight_links(self) -> list[str]:
        """The links of those who may fly the vehicle, and not only watch it as a ground station does."""
        return [link.name for link, rates in self._purposes.items() if rates is Rates.ONBOARD]

    def tells_position(self, link: str) -> bool:
        """Whether a report of the local position waits to be sent by a link.

        Raises:
            KeyError: There is no such link.
        """
        return self._links[link].tells_position

    def ping(self, link: str, number: int) -> None:
        """Ask the peer of a link to answer all that it is told until then: with a PING, the last message of it.

        No fault of the line touches this: it is about the program at the other end. Its time is that of the vehicle.

        Raises:
            KeyError: There is no such link.
        """
        self._links[link].send_last(mavlink.MAVLink_ping_message(self.now_us, number, 0, 0))

    def advance(self) -> None:
        """Step the vehicle once and queue what is due then."""
        if self.now_us >= self._reboot_due_us:
            self._reboot()
        vehicle = self.vehicle
        vehicle.step()
        now_us = self.now_us = vehicle.steps * self._step_us
        self._built.clear()
        if vehicle.autopilot.armed and not self.recorder.is_recording:
            self.recorder.begin()
        texts = vehicle.autopilot.texts
        while texts:
            self.say(*texts.popleft())
        if vehicle.autopilot.mission.news:
            self._missions.report()
        self._presence.advance()
        self._sticks.advance()
        if vehicle.camera is not None and vehicle.camera.news:
            self._tell_pictures()
        for link in self._links.values():
            if link.streams.next_due_us <= now_us and not link.is_full:
                self._stream(link)
        self.recorder.advance()
        self._go_on_sending()

    def _stream(self, link: Link) -> None:
        for message_id in link.streams.due(self.now_us):
            if message_id in self.table.told_on_change or (message_id in V1_ALONE and not link.speaks_v1):
                continue
            if (message := self.telemetry(message_id)) is not None:
                link.send(message)

    def _tell_pictures(self) -> None:
        for message in self._cameras.news():
            self.recorder.take(message)
            for link in self._links.values():
                if self.table.tells_pictures or link.streams.interval_us(message.get_msgId()) is not None:
                    link.send(message)

    def _go_on_sending(self) -> None:
        """Send the next part of what is long, and what is due."""
        if self._parameters.is_listing:
            self._parameters.advance()
        if self._log_transfer.is_sending:
            self._log_transfer.advance()
        if self._files.is_sending:
            self._files.advance()
        for service in self._timed:
            if service.next_due_us <= self.now_us:
                service.advance()

    def _reboot(self) -> None:
        """Begin anew: streams as by default, no transfer under way, and the system id that the parameter names."""
        self._reboot_due_us = NEVER_US
        self.utc_of_boot_us += self.now_us
        self.recorder.finish()
        self._parameters.reboot()
        self.vehicle.reboot()
        self.now_us = 0
        self.system_id = int(self.vehicle.parameters[self.table.system_id_parameter])
        self._router = Router(self.system_id, self.component_id)
        self._presence.reboot()
        self._cameras.reboot()
        self._events.reboot()
        for link in self._links.values():
            link.speak_for(self.system_id)
            for service in self._with_partners:
                service.forget(link)
            self._rates.start_defaults(link)

    # What the services use.

    def reboot_in(self, delay_us: int) -> None:
        """Restart the flight controller after so many microseconds; a restart that is due already is not put off."""
        self._reboot_due_us = min(self._reboot_due_us, self.now_us + delay_us)

    def broadcast(self, message: "Message") -> None:
        """Send a message of the vehicle on every link."""
        for link in self._links.values():
            link.send(message)

    def say(self, severity: "Severity", text: str) -> None:
        """Send a text to every link, in chunks where it is long."""
        for message in self._chunker.messages(severity, self._events.heard(severity, text)):
            self.recorder.take(message)
            self.broadcast(message)

    def telemetry(self, message_id: int) -> "Message | None":
        """Return a telemetry message as of now; None where the vehicle has nothing to say in it yet.

        Raises:
            KeyError: This autopilot has no such message.
        """
        built = self._built
        if message_id not in built:
            built[message_id] = self._builders[message_id](self)
        return built[message_id]

    def has_telemetry(self, message_id: int) -> bool:
        """Whether this autopilot has a telemetry message."""
        return message_id in self._builders

    def rates_of(self, link: Link) -> Rates:
        """Return what a link is for."""
        return self._purposes[link]
