"""One command at a time: sent, repeated while it is not answered, and its answer kept.

https://mavlink.io/en/services/command.html: a command is answered by COMMAND_ACK; a repetition counts up its
``confirmation`` field. Accepted means heard and meant to be done, no more.
"""

from dataclasses import dataclass
from typing import Final

from mission.link.values import Acknowledgement, Command, Result

ANSWER_WITHIN_S: Final = 0.5
"""Time for one answer, on the faster one of both clocks."""

ATTEMPTS: Final = 6
"""So often a command is sent to a vehicle whose time passes as it does here."""


@dataclass(frozen=True)
class Answer:
    """How a command ended; ``result`` is None where it was never answered."""

    command: Command
    result: Result | None
    asked_s: float


class RequestChannel:
    """Keeps at most one command under way; times are of the clock here.

    Attributes:
        held: Whether the command under way must not be sent now.
        speed: Vehicle seconds in each second here, where that is more than one: a command is repeated as often as the
            vehicle's failsafes, which go by its time, ask for, and is given up by the time here.
    """

    def __init__(self, system_id: int, component_id: int) -> None:
        """Take answers that are addressed to these ids, or to nobody in particular."""
        self._own = (system_id, component_id)
        self.speed = 1.0
        self.held = False
        self._command: Command | None = None
        self._asked_s = 0.0
        self._sent_s = 0.0
        self._attempt = 0
        self._working = False

    @property
    def busy(self) -> bool:
        """Whether a command waits for its answer."""
        return self._command is not None

    @property
    def is_sent(self) -> bool:
        """Whether the command under way was sent."""
        return self._attempt > 0

    def carries(self, command: Command | None) -> bool:
        """Whether this is the command under way."""
        return command is not None and self._command is command

    def ask(self, command: Command, now_s: float) -> None:
        """Begin with a command; one that is under way is forgotten."""
        self._command = command
        self._asked_s = now_s
        self._sent_s = -float("inf")
        self._attempt = 0
        self._working = False

    def forget(self) -> None:
        """Let go of the command under way: what it was for has happened."""
        self._command = None

    def due(self, now_s: float) -> tuple[Command, int] | None:
        """The command to send now, with the number of the attempt; None where there is nothing to send."""
        if self.held or self._command is None or self._attempt >= self._attempts or now_s < self._next_s:
            return None
        attempt, self._attempt = self._attempt, self._attempt + 1
        self._sent_s = now_s
        return self._command, attempt

    def unanswered(self, now_s: float) -> Answer | None:
        """The end of a command that was sent as often as it is worth; None while there is hope."""
        if self._command is None or self._attempt < self._attempts or now_s < self._next_s:
            return None
        return self._ended(None)

    def take(self, acknowledgement: Acknowledgement, now_s: float) -> Answer | None:
        """The answer to the command under way, if this is it."""
        if self._command is None or acknowledgement.command != self._command.number:
            return None
        for own, target in zip(
            self._own, (acknowledgement.target_system, acknowledgement.target_component), strict=True
        ):
            if target not in (0, own):
                return None  # someone else on this link gave the same command
        if acknowledgement.result is Result.IN_PROGRESS:
            self._sent_s, self._working = now_s, True
            return None
        return self._ended(acknowledgement.result)

    def wait_s(self, now_s: float) -> float:
        """How long until there is something to do; infinite where nothing is under way, or it is held."""
        return float("inf") if self._command is None or self.held else max(self._next_s - now_s, 0.0)

    @property
    def _next_s(self) -> float:
        patience = 10.0 if self._working else 1.0
        return self._sent_s + patience * ANSWER_WITHIN_S / self.speed

    @property
    def _attempts(self) -> int:
        return round(ATTEMPTS * self.speed)

    def _ended(self, result: Result | None) -> Answer:
        command = self._command
        if command is None:
            raise RuntimeError("no command is under way")
        self._command = None
        return Answer(command, result, self._asked_s)
