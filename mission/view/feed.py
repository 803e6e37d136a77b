"""What passes between a flight and its page: bounded both ways, and neither side ever waits for the other."""

from collections import deque
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Final, TypeVar

from mission.fly.requests import Request
from mission.fly.result import Progress

_Item = TypeVar("_Item")
_MOST_MOMENTS: Final = 256
_MOST_REQUESTS: Final = 8
_MOST_ANSWERS: Final = 32


@dataclass(frozen=True)
class Answer:
    """What came of a request."""

    request: Request
    words: str
    granted: bool


class Feed:
    """Two queues that several threads may use; of what nobody fetches, the oldest is dropped.

    The flight calls ``show``, ``take`` and ``answer``, the page the others.
    """

    def __init__(self) -> None:
        """Begin empty."""
        self._moments: deque[Progress] = deque(maxlen=_MOST_MOMENTS)
        self._requests: deque[Request] = deque()
        self._answers: deque[Answer] = deque(maxlen=_MOST_ANSWERS)

    def show(self, moment: Progress) -> None:
        """Show one moment."""
        self._moments.append(moment)

    def take(self) -> Request | None:
        """The next request, if there is one."""
        return next(_taken(self._requests, 1), None)

    def answer(self, request: Request, words: str, *, granted: bool) -> None:
        """Say what came of one."""
        self._answers.append(Answer(request, words, granted))

    def moments(self) -> list[Progress]:
        """Those that were shown since the last call, oldest first, as far as they were kept."""
        return list(_taken(self._moments, _MOST_MOMENTS))

    def answers(self) -> list[Answer]:
        """Those that were given since the last call."""
        return list(_taken(self._answers, _MOST_ANSWERS))

    def ask(self, request: Request) -> bool:
        """Ask; False where too much that was asked for waits already."""
        if len(self._requests) >= _MOST_REQUESTS:
            return False
        self._requests.append(request)
        return True


def _taken(queue: "deque[_Item]", most: int) -> Iterator[_Item]:
    for _ in range(most):
        try:
            yield queue.popleft()
        except IndexError:
            return
