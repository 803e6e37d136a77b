"""Switches the camera's trigger on and off as the trajectory asks, without I/O, beside whatever else is commanded.

A camera that refuses, or is not there, costs pictures and never the flight. A trigger that may be on is switched off as
soon as no stretch is flown, whatever has ended the flight, until that is confirmed or asking is in vain.
"""

import math
from typing import Final

from mission.link.messages import Stream, photograph, photograph_every, set_message_interval, stop_photographing
from mission.link.requests import Answer, RequestChannel
from mission.link.values import Command, Result
from mission.plan.photographs import Photographs

_AGAIN_S: Final = 1.0
"""On the clock here: how soon a refusal that may pass is answered by asking again."""

_PASSING: Final = (Result.TEMPORARILY_REJECTED, Result.FAILED)
_MOST_OFF: Final = 2
"""How often switching off is asked for; each time in as many attempts as any command is worth."""

_ONE: Final = photograph()
_OFF: Final = stop_photographing()
_RATE: Final = set_message_interval(Stream.GPS_RAW_INT, 1.0)
"""What the accuracy of places is told in; without it pictures have none."""


class Photography:
    """The camera of one flight.

    Attributes:
        channel: What carries its commands, and no others.
        stretches: What is photographed of the trajectory.
    """

    def __init__(self, channel: RequestChannel, stretches: tuple[Photographs, ...]) -> None:
        """Photograph these stretches; the trigger is taken to be off."""
        self.channel = channel
        self.stretches = stretches
        self._stretch: Photographs | None = None
        self._due: Command | None = _RATE if stretches else None
        self._again_s = -math.inf
        self._may_be_on = False
        self._offs_left = _MOST_OFF
        self._refusal = ""

    def follow(self, stretches: tuple[Photographs, ...]) -> None:
        """Photograph these stretches from now on, of another trajectory."""
        self.stretches = stretches

    @property
    def unfinished(self) -> bool:
        """Whether the trigger may still be on, and there is hope of switching it off."""
        return self._may_be_on and self._offs_left > 0

    @property
    def trouble(self) -> str:
        """What first went wrong with it, in plain words; empty where nothing did."""
        left_on = "whether the camera's trigger is off is not known" if self._may_be_on and not self._offs_left else ""
        return ", ".join(filter(None, (self._refusal, left_on)))

    def advance(self, trajectory_s: float | None, now_s: float) -> None:
        """Ask for what is due.

        Args:
            trajectory_s: Time on the trajectory; None where it is not flown.
            now_s: The time here.
        """
        stretch = self._stretch_at(trajectory_s)
        if stretch is not self._stretch:
            self._stretch, self._again_s, self._offs_left = stretch, -math.inf, _MOST_OFF
            self._due = _beginning(stretch) if stretch else _OFF if self._may_be_on else None
            self.channel.forget()
        if self._due is not None and not self.channel.busy and now_s >= self._again_s:
            self._may_be_on |= self._due not in (_OFF, _ONE, _RATE)
            self.channel.ask(self._due, now_s)
            self._due = None

    def take(self, answer: Answer, now_s: float) -> None:
        """Take the answer to the last command; what may pass is asked for again."""
        command, result = answer.command, answer.result
        if command == _RATE:
            return
        if result is Result.ACCEPTED:
            self._may_be_on = command not in (_OFF, _ONE)
            return
        if command == _OFF:
            self._offs_left -= 1
            again = self._offs_left > 0
        else:
            self._may_be_on &= result is None  # it was refused, or it may have been heard
            again = result in _PASSING
        if again:
            self._due, self._again_s = command, now_s + _AGAIN_S
        why = "was not answered" if result is None else f"was refused ({result.name.lower().replace('_', ' ')})"
        self._refusal = self._refusal or f"the camera's command to {command.name} {why}"

    def _stretch_at(self, trajectory_s: float | None) -> Photographs | None:
        if trajectory_s is None:
            return None
        return next((each for each in self.stretches if each.begin_s <= trajectory_s < each.end_s), None)


def _beginning(stretch: Photographs) -> Command:
    return _ONE if stretch.distance_m is None else photograph_every(stretch.distance_m)
