"""What has arrived and was not looked at yet: where reading falls behind, what is out of date is left out.

Of telemetry that only tells a state, the newest counts, and one that waits is replaced by the next of its kind and
sender: in its place in the queue, for at the end it would be replaced again before its turn comes where more waits than
comes between two of them; but at the end where it carries the vehicle's time, which must not be read out of order.
Nothing is left out of what is counted or told once (heartbeats, texts, answers, requests), nor of the
positions, which the verdict on a flight is drawn from.
"""

from collections import OrderedDict
from typing import Final

from mission.link.framing import Frame
from mission.link.messages import STAMPED, STATES

_MOST: Final = 1 << 15
"""Only what nobody reads for minutes comes to that; then the oldest goes."""


class Inbox:
    """Frames that wait, the oldest first, each with when it came.

    Attributes:
        left_out: How many were replaced by newer ones, or had no room.
    """

    def __init__(self) -> None:
        """Begin empty."""
        self.left_out = 0
        self._waiting: OrderedDict[int, tuple[Frame, float]] = OrderedDict()
        self._newest: dict[tuple[int, bytes], int] = {}
        self._count = 0

    def __len__(self) -> int:
        return len(self._waiting)

    def put(self, frame: Frame, at_s: float) -> None:
        """Let a frame wait that came at a time of the clock here."""
        self._count += 1
        if frame.number in STATES:
            kind = (frame.number, frame.sender)
            older = self._newest.get(kind, 0)
            if older in self._waiting:
                self.left_out += 1
                if frame.number not in STAMPED:
                    self._waiting[older] = (frame, at_s)
                    return
                del self._waiting[older]
            self._newest[kind] = self._count
        self._waiting[self._count] = (frame, at_s)
        if len(self._waiting) > _MOST:
            self.take()
            self.left_out += 1

    def take(self) -> tuple[Frame, float]:
        """The frame that has waited longest, and when it came.

        Raises:
            KeyError: There is none.
        """
        number, (frame, at_s) = self._waiting.popitem(last=False)
        if self._newest.get((frame.number, frame.sender)) == number:
            del self._newest[frame.number, frame.sender]
        return frame, at_s
