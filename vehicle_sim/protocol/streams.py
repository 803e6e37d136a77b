"""When which message is due on a link.

Time is counted in whole microseconds of vehicle time, so a rate of 15 Hz stays one. The heap makes a step on which
nothing is due cost one comparison, however many streams there are.
"""

from heapq import heappop, heappush
from typing import Final

NEVER_US: Final = 1 << 62


class StreamSchedule:
    """The streams of one link: an interval for each message, and the moment at which the next one is due.

    Attributes:
        next_due_us: No stream is due before; `NEVER_US` without streams.
    """

    def __init__(self) -> None:
        self._intervals_us: dict[int, int] = {}
        self._due: list[tuple[int, int, int]] = []
        self._fresh: set[int] = set()
        self.next_due_us = NEVER_US

    def interval_us(self, message_id: int) -> int | None:
        """Return the interval of a stream, None for a message that is not streamed."""
        return self._intervals_us.get(message_id)

    def start(self, message_id: int, interval_us: int, now_us: int) -> None:
        """Stream a message from now on; an equal stream that already runs keeps its phase.

        Raises:
            ValueError: The interval is not positive.
        """
        if interval_us <= 0:
            raise ValueError("the interval of a stream is positive")
        if self._intervals_us.get(message_id) == interval_us:
            return
        self.stop(message_id)
        self._intervals_us[message_id] = interval_us
        self._fresh.add(message_id)
        heappush(self._due, (now_us, message_id, interval_us))
        self.next_due_us = self._due[0][0]

    def stop(self, message_id: int) -> None:
        """Stop a stream; one that does not run is stopped already."""
        if self._intervals_us.pop(message_id, None) is not None:
            self._fresh.discard(message_id)
            self._due = sorted(entry for entry in self._due if entry[1] != message_id)
            self.next_due_us = self._due[0][0] if self._due else NEVER_US

    def clear(self) -> None:
        """Stop all streams."""
        self._intervals_us.clear()
        self._fresh.clear()
        self._due.clear()
        self.next_due_us = NEVER_US

    def due(self, now_us: int) -> list[int]:
        """Return the ids of the messages that are due, in order of their moments, and plan the next of each.

        A stream faster than the caller is sent once a call and does not catch up.
        """
        ready = []
        queue = self._due
        while queue and queue[0][0] <= now_us:
            due_us, message_id, interval_us = heappop(queue)
            if message_id in self._fresh:
                self._fresh.discard(message_id)
                due_us = now_us  # the first one sets the phase
            following_us = due_us + interval_us
            if following_us <= now_us:
                following_us = now_us + interval_us
            heappush(queue, (following_us, message_id, interval_us))
            ready.append(message_id)
        self.next_due_us = queue[0][0] if queue else NEVER_US
        return ready
