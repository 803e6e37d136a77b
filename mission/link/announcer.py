"""What this program tells whoever watches the vehicle, as a computer that belongs to it.

Ground stations leave out what other systems say, and show what any component of the vehicle says. So texts and figures
come from a component of the vehicle's own system (MAV_COMP_ID_PATHPLANNER), which autopilots pass on from link to link.
All of it is sent once a second by the vehicle's clock, at most one text at a time: with five figures 171 bytes a second
and a text of 62 bytes for each 50 letters, of the 5760 that a radio at 57,600 baud carries.
"""

import math
from collections import deque
from collections.abc import Mapping
from enum import IntEnum
from typing import Final

from mission.link.messages import Codec
from mission.link.services import beat_on_board, named_value, text_pieces
from mission.link.signing import Signatures

COMPONENT: Final = 195
"""MAV_COMP_ID_PATHPLANNER."""

_PERIOD_S: Final = 1.0
_LONGEST: Final = 200
_MOST_WAITING: Final = 8


class Severity(IntEnum):
    """Values of MAV_SEVERITY."""

    WARNING = 4
    NOTICE = 5
    INFO = 6


class Announcer:
    """Speaks for one flight."""

    def __init__(self, system_id: int, signatures: Signatures | None) -> None:
        """Speak as a component of the vehicle of that system id."""
        self._codec = Codec(system_id, COMPONENT, signatures)
        self._texts: deque[tuple[Severity, str]] = deque(maxlen=_MOST_WAITING)
        self._next_s = -math.inf
        self._number = 0

    def say(self, text: str, severity: Severity = Severity.INFO) -> None:
        """Let a text be sent in its turn; where too many wait, the oldest is left out."""
        self._texts.append((severity, text if len(text) <= _LONGEST else f"{text[: _LONGEST - 3]}..."))

    def is_due(self, t_s: float) -> bool:
        """Whether something is to be sent at a vehicle time."""
        return t_s >= self._next_s

    def frames(self, t_s: float, values: Mapping[str, float]) -> list[bytes]:
        """The heartbeat, the figures by their names, and the text that has waited longest."""
        self._next_s = t_s + _PERIOD_S
        messages = [beat_on_board(), *(named_value(t_s, name, value) for name, value in values.items())]
        return [*map(self._codec.packed, messages), *self._next_text()]

    def last_frames(self, t_s: float, values: Mapping[str, float]) -> list[bytes]:
        """The figures once more, and all texts that wait."""
        frames = self.frames(t_s, values)
        while self._texts:
            frames += self._next_text()
        return frames

    def _next_text(self) -> list[bytes]:
        if not self._texts:
            return []
        self._number = self._number % 0xFFFF + 1
        severity, text = self._texts.popleft()
        return [self._codec.packed(piece) for piece in text_pieces(severity, text, self._number)]
