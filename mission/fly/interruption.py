"""Turns the signals that end programs into wishes that the flight loop can grant safely."""

import signal
import threading
from dataclasses import dataclass
from types import FrameType, TracebackType
from typing import Any, Self


@dataclass(frozen=True)
class StopRequest:
    """A wish to end a flight.

    Attributes:
        reason: Why, in plain words.
        after_lap: Whether a flight of laps may first complete the one that it is in, and return.
    """

    reason: str
    after_lap: bool = False


_OF_SIGNALS = 128

INTERRUPTED = StopRequest("interrupted by the user", after_lap=True)


class StopSignals:
    """While entered, SIGINT, SIGTERM and SIGHUP are noted; one that follows an unheeded one interrupts at once.

    Outside the main thread, where signals cannot be handled, nothing is noted; nor is a hang-up that is ignored
    already, as under nohup.
    """

    def __init__(self) -> None:
        """Note nothing yet."""
        self._request: StopRequest | None = None
        self._number = signal.SIGINT
        self._before: dict[signal.Signals, Any] = {}

    def take(self) -> StopRequest | None:
        """The wish that has come since the last call, if one has; whoever takes it heeds it."""
        request, self._request = self._request, None
        return request

    @property
    def exit_code(self) -> int:
        """What a program ends with that the last signal interrupts, as shells have it."""
        return _OF_SIGNALS + self._number

    def __enter__(self) -> Self:
        if threading.current_thread() is threading.main_thread():
            wanted = ("SIGINT", "SIGTERM", "SIGHUP")  # the last is not known everywhere
            for number in [signal.Signals[name] for name in wanted if hasattr(signal, name)]:
                if number.name == "SIGHUP" and signal.getsignal(number) == signal.SIG_IGN:
                    continue
                self._before[number] = signal.signal(number, self._note)
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, at: TracebackType | None) -> None:
        while self._before:
            number, handler = self._before.popitem()
            signal.signal(number, handler)

    def _note(self, number: int, _frame: FrameType | None) -> None:
        self._number = signal.Signals(number)
        if self._request is not None:
            raise KeyboardInterrupt
        interrupted = number == signal.SIGINT
        self._request = INTERRUPTED if interrupted else StopRequest(f"ended by {signal.Signals(number).name}")
