"""Turns the signals that end programs into a wish that the flight loop can grant safely."""

import signal
import threading
from types import FrameType, TracebackType
from typing import Any, Self


class StopSignals:
    """While entered, the first SIGINT, SIGTERM or SIGHUP is noted, and the second one interrupts at once.

    Outside the main thread, where signals cannot be handled, nothing is noted.
    """

    def __init__(self) -> None:
        """Note nothing yet."""
        self._reason = ""
        self._before: dict[signal.Signals, Any] = {}

    def reason(self) -> str:
        """Why to stop, in plain words; empty while there is no reason."""
        return self._reason

    def __enter__(self) -> Self:
        if threading.current_thread() is threading.main_thread():
            wanted = ("SIGINT", "SIGTERM", "SIGHUP")  # the last is not known everywhere
            for number in [signal.Signals[name] for name in wanted if hasattr(signal, name)]:
                self._before[number] = signal.signal(number, self._note)
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, at: TracebackType | None) -> None:
        while self._before:
            number, handler = self._before.popitem()
            signal.signal(number, handler)

    def _note(self, number: int, _frame: FrameType | None) -> None:
        if self._reason:
            raise KeyboardInterrupt
        interrupted = number == signal.SIGINT
        self._reason = "interrupted by the user" if interrupted else f"ended by {signal.Signals(number).name}"
