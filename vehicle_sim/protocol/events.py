"""Events, which PX4 sends beside its texts: EVENT, what was lost of them, and the report of its arming checks.

https://mavlink.io/en/services/events.html; PX4 `mavlink_events.cpp`, `HealthAndArmingChecks/Common.cpp`. A text that an
event says as well ends in a tab, by which ground stations know that they may hide it.
"""

from collections import deque
from typing import TYPE_CHECKING, Final, NamedTuple

from vehicle_sim.autopilot import ArmingReason, Outcome, Severity
from vehicle_sim.parameters import Flavour
from vehicle_sim.protocol.data_files import data_file
from vehicle_sim.protocol.dialect import Message, mavlink
from vehicle_sim.protocol.event_list import event_list
from vehicle_sim.protocol.late_messages import CurrentEventSequence, Event, RequestEvent, ResponseEventError
from vehicle_sim.protocol.streams import NEVER_US

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    from vehicle_sim.protocol.commands import Request
    from vehicle_sim.protocol.host import Host, Sender

KEPT: Final = 20
"""Events that can be asked for again."""

FIRST_SEQUENCE: Final = 65525
"""PX4 begins a little before the count runs over."""

_COUNT: Final = 1 << 16
_SEQUENCE_US: Final = 3_000_000
_REPORT_US: Final = 2_000_000
_RESET: Final = 1
_UNAVAILABLE: Final = 0
_PROTOCOL: Final = 8
"""Level of what is for programs and never shown."""

_ARGUMENTS: Final = 40


class _Check(NamedTuple):
    """How a check that fails is reported: its event, the part of the vehicle that it is about, and how bad it is.

    What `stops` a mode ends it in flight, too. Where its event `names_modes`, the modes count as having a problem.
    """

    event: str
    component: str
    level: int
    stops: bool
    names_modes: bool = True


_CHECKS: Final = {ArmingReason[name]: _Check(*row) for name, row in data_file("arming_checks").items()}
_PRESENT: Final = ("absolute_pressure", "gps", "battery", "magnetometer", "accel", "gyro")

_Failures = dict[_Check, int]


class EventService:
    """Sends events as PX4 does, keeps the newest, and sends them again on request; ArduPilot has none.

    Attributes:
        next_due_us: Nothing happens by itself before.
    """

    def __init__(self, host: "Host") -> None:
        self._host = host
        self._speaks = host.table.flavour is Flavour.PX4
        self.messages: Mapping[int, Callable[[Sender, Message], None]] = (
            {RequestEvent.id: self.on_request} if self._speaks else {}
        )
        self.commands: Mapping[int, Callable[[Request], Outcome]] = (
            {mavlink.MAV_CMD_RUN_PREARM_CHECKS: self._run_checks} if self._speaks else {}
        )
        self.reboot()

    def reboot(self) -> None:
        """Begin anew."""
        self._sequence = FIRST_SEQUENCE
        self._kept: deque[Message] = deque(maxlen=KEPT)
        self._reported: tuple[_Failures, bool] | None = None
        self._report_due_us = self._sequence_due_us = 0
        self.next_due_us = 0 if self._speaks else NEVER_US
        self._had_ground = False

    def advance(self) -> None:
        """Send what is due: the report where it has changed, or a ground station has come, and the count."""
        now_us = self._host.now_us
        if now_us >= self._report_due_us:
            has_ground, had_ground = self._host.vehicle.autopilot.ground_heard, self._had_ground
            self._had_ground = has_ground
            self._report(always=has_ground and not had_ground)
            self._report_due_us = now_us + _REPORT_US
        if now_us >= self._sequence_due_us:
            self._sequence_due_us = now_us + _SEQUENCE_US
            self._tell_sequence(resets=not self._kept)
        self.next_due_us = min(self._report_due_us, self._sequence_due_us)

    def heard(self, severity: int, text: str) -> str:
        """Send the event that says `text`, if there is one, and return the text as PX4 sends it."""
        text = text.removesuffix("\t")
        found = event_list().find(text) if self._speaks else None
        if found is None:
            return text
        name, arguments = found
        self._send(name, severity, *arguments)
        return f"{text}\t"

    def on_request(self, sender: "Sender", message: Message) -> None:
        """Send events again, from the first to the last that is asked for; of older ones, say which is the oldest."""
        kept = {event.sequence: event for event in self._kept}
        asked = (message.last_sequence - message.first_sequence) % _COUNT + 1
        sequence = message.first_sequence
        while asked:
            event = kept.get(sequence)
            if event is not None:
                sender.link.send(event)
            else:
                oldest = self._kept[0].sequence if self._kept else self._sequence
                who = (sender.system_id, sender.component_id)
                sender.link.send(ResponseEventError(sequence, oldest, *who, _UNAVAILABLE))
            step = max(asked - KEPT, 1)  # what is older than all that is kept is refused once
            sequence, asked = (sequence + step) % _COUNT, asked - step

    def _run_checks(self, _request: "Request") -> Outcome:
        if self._host.vehicle.autopilot.armed:
            return Outcome.TEMPORARILY_REJECTED
        self._report(always=True)
        return Outcome.ACCEPTED

    def _send(self, name: str, level: int, *arguments: float) -> None:
        if not self._kept:
            self._tell_sequence(resets=True)
        definition = event_list().events[name]
        codes = definition.packing.format
        numbers = [value if code == "f" else int(value) for code, value in zip(codes[1:], arguments, strict=True)]
        self._sequence = (self._sequence + 1) % _COUNT
        packed = definition.packing.pack(*numbers).ljust(_ARGUMENTS, b"\0")
        event = Event(
            definition.number, self._host.now_us // 1000, self._sequence, 0, 0, level << 4 | level, tuple(packed)
        )
        self._kept.append(event)
        self._host.broadcast(event)

    def _tell_sequence(self, *, resets: bool) -> None:
        self._host.broadcast(CurrentEventSequence(self._sequence, _RESET if resets else 0))

    def _report(self, *, always: bool) -> None:
        """Send which modes could be armed in, or gone on in, and why not: a summary, each failure, another summary."""
        autopilot, events = self._host.vehicle.autopilot, event_list()
        failures, bits = self._failures(), events.component_bits
        state = (failures, autopilot.armed)
        if state == self._reported and not always:
            return
        self._reported = state
        errors = warnings = cannot_arm = cannot_run = 0
        for check, modes in failures.items():
            bit = bits[check.component]
            errors |= bit if check.level <= Severity.ERROR else 0
            warnings |= bit if check.level == Severity.WARNING else 0
            cannot_arm |= modes
            cannot_run |= modes if check.stops else 0
        everything = sum(self._mode_bits())
        summary = (0, errors, warnings, everything & ~cannot_arm, everything & ~cannot_run)
        self._send("commander_arming_check_summary", _PROTOCOL, *summary)
        for check, modes in failures.items():
            self._send(check.event, check.level, modes * check.names_modes, bits[check.component].bit_length() - 1)
        self._send("commander_health_summary", _PROTOCOL, 0, sum(bits[name] for name in _PRESENT), 0, 0)

    def _mode_bits(self) -> list[int]:
        numbers = self._host.table.custom_modes.values()
        return sorted({bit for number in numbers if (bit := event_list().mode_bits.get(number))})

    def _failures(self) -> _Failures:
        """Return the checks that fail, each with the bits of the modes in which it does.

        That a mode is not for taking off is told of where it is the present one.
        """
        autopilot, failures = self._host.vehicle.autopilot, _Failures()
        for mode, number in self._host.table.custom_modes.items():
            bit = event_list().mode_bits.get(number, 0)
            for fault in autopilot.arming_faults_in(mode) if bit else ():
                if fault.reason is not ArmingReason.MODE or not autopilot.modes[autopilot.mode].armable:
                    check = _CHECKS[fault.reason]
                    failures[check] = failures.get(check, 0) | bit
        return failures
