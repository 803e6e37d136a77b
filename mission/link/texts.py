"""Puts the vehicle's texts together again: long ones arrive in pieces, perhaps twice, out of order or not at all.

https://mavlink.io/en/messages/common.html#STATUSTEXT: pieces of one text share a number that is not 0; a piece that
fills its 50 bytes is followed by another.
"""

import re
from typing import Final, NamedTuple

from mission.link.values import Words
from mission.printable import shows

_PIECE_BYTES: Final = 50
_PATIENCE_S: Final = 1.0
_MOST_PENDING: Final = 8
_MOST_PIECES: Final = 32
_FAILSAFE: Final = re.compile("failsafe|fence|breach", re.IGNORECASE)
_OVER: Final = re.compile("clear|recover|resolved|off$", re.IGNORECASE)
_NOTICE: Final = 5


class Text(NamedTuple):
    """What the vehicle said; severity as in syslog, 0 the gravest."""

    severity: int
    text: str

    @property
    def grave(self) -> bool:
        """Whether it explains what happens: notices, as ArduPilot's of a breached fence, and worse; not chatter."""
        return self.severity <= _NOTICE

    @property
    def tells_failsafe(self) -> bool:
        """Whether it says that the vehicle acts by itself; what is over again is no reason to."""
        return self.grave and bool(_FAILSAFE.search(self.text)) and not _OVER.search(self.text)


class _Pending:
    """A text of which pieces are still on their way."""

    def __init__(self, severity: int, since_s: float) -> None:
        self.severity, self.since_s = severity, since_s
        self.pieces: dict[int, str] = {}

    def whole(self) -> bool:
        last = max(self.pieces)
        return len(self.pieces[last]) < _PIECE_BYTES and len(self.pieces) == last + 1

    def text(self) -> Text:
        last = max(self.pieces)
        return _clean(self.severity, "".join(self.pieces.get(k, "...") for k in range(last + 1)))


class TextAssembler:
    """Takes pieces, gives texts; the time is an argument."""

    def __init__(self) -> None:
        """Start with nothing pending."""
        self._pending: dict[int, _Pending] = {}

    def take(self, words: Words, now_s: float) -> list[Text]:
        """The texts that this message completes: one at most, and those that it pushes out."""
        if words.group == 0:
            return [_clean(words.severity, words.text)]
        if words.piece >= _MOST_PIECES:
            return []
        pending = self._pending.setdefault(words.group, _Pending(words.severity, now_s))
        pending.pieces[words.piece] = words.text
        if pending.whole():
            return [self._pending.pop(words.group).text()]
        if len(self._pending) > _MOST_PENDING:
            return [self._pending.pop(next(iter(self._pending))).text()]
        return []

    def overdue(self, now_s: float) -> list[Text]:
        """Texts whose missing pieces are not waited for any longer, with dots in their places."""
        if not self._pending:
            return []
        late = [group for group, pending in self._pending.items() if now_s - pending.since_s > _PATIENCE_S]
        return [self._pending.pop(group).text() for group in late]


def _clean(severity: int, text: str) -> Text:
    """Without what a terminal would obey: texts come from outside."""
    return Text(severity, "".join(c if shows(c) else " " for c in text).strip())
