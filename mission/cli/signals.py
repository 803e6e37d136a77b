"""The signals that end programs, outside a flight: what is being done ends at once, without a traceback.

A flight has wishes of its own for them, see ``mission.fly.interruption``.
"""

import os
import signal
import sys
from types import FrameType, TracebackType
from typing import Any, Self

from mission.cli.busy import erase

_OF_SIGNALS = 128
"""A program that a signal ended has this plus the signal's number for its exit code, as shells have it."""


class Signalled(KeyboardInterrupt):
    """A signal came that is to end what is being done.

    Its kind is its own: where a plain KeyboardInterrupt has passed through ``exec``, the interpreter ends by SIGINT,
    whatever the program has made of it.
    """


class EndingSignals:
    """While entered, SIGINT, SIGTERM and SIGHUP interrupt as Ctrl-C does; a second one ends the program on the spot.

    Outside the main thread, where signals cannot be handled, nothing changes; nor does a hang-up that is ignored
    already, as under nohup.
    """

    def __init__(self, *, for_good: bool = False) -> None:
        """Begin with no signal.

        Args:
            for_good: Whether the program ends when this is left: then signals are ignored while the interpreter winds
                up, for by then everything has been done.
        """
        self._for_good = for_good
        self._number = 0
        self._before: dict[int, Any] = {}
        self._hook = sys.unraisablehook

    @property
    def exit_code(self) -> int:
        """What the program ends with after the signal that came; 0 where none has."""
        return _OF_SIGNALS + self._number if self._number else 0

    def __enter__(self) -> Self:
        try:
            for name in ("SIGINT", "SIGTERM", "SIGHUP"):  # the last is not known everywhere
                number = getattr(signal, name, None)
                if number is not None and (name != "SIGHUP" or signal.getsignal(number) != signal.SIG_IGN):
                    self._before[number] = signal.signal(number, self._interrupt)
        except ValueError:  # not the main thread
            return self
        self._hook, sys.unraisablehook = sys.unraisablehook, self._where_nobody_hears
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, at: TracebackType | None) -> None:
        while self._before:
            number, handler = self._before.popitem()
            signal.signal(number, signal.SIG_IGN if self._for_good else handler)
            sys.unraisablehook = self._hook

    def _interrupt(self, number: int, _frame: FrameType | None) -> None:
        if self._number:
            erase()
            os._exit(self.exit_code)
        self._number = number
        raise Signalled

    def _where_nobody_hears(self, unraisable: "sys.UnraisableHookArgs") -> None:
        """Keep the promise where an interruption met code whose exceptions go nowhere, such as a finaliser's."""
        if self._number and unraisable.exc_type is Signalled:
            os._exit(self.exit_code)
        self._hook(unraisable)
