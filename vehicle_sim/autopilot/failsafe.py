"""Failsafes as ordered actions: which one acts, when it ends, and whether a pause for the pilot comes first.

Each failure that appears adds its response to those that stand; the gravest action of them is carried out. A response
ends with its failure, or stands until the pilot chooses a mode. A pilot who chooses a mode while a failsafe flies takes
over: nothing acts any more until another failure appears. Before a graver action than to hold, the vehicle may hold for
a while, in which the pilot can choose; with termination nobody can. Modelled on PX4's failsafe framework; ArduPilot's
rules are the case without pauses in which only the pilot ends a response.
"""

from collections.abc import Mapping
from math import inf
from typing import Final, NamedTuple

from vehicle_sim.autopilot.modes import Failsafe
from vehicle_sim.parameters import Action

_PAUSED: Final = frozenset({Action.RETURN, Action.LAND})


class Response(NamedTuple):
    """What is set for a failure.

    Attributes:
        action: What to do.
        ends_with_failure: Whether it is over when the failure is, else when the pilot chooses a mode.
        pauses: Whether a hold may come first.
    """

    action: Action
    ends_with_failure: bool = False
    pauses: bool = False


class Decision(NamedTuple):
    """What is to be done now.

    Attributes:
        action: The gravest action that stands, NOTHING when the pilot flies.
        is_other: Whether it is another one than before.
        appeared: Failures that are new, worst first.
        vanished: Failures that are over.
        pause_s: The length of a pause that begins now, else 0.
    """

    action: Action
    is_other: bool
    appeared: tuple[Failsafe, ...]
    vanished: tuple[Failsafe, ...]
    pause_s: float


QUIET: Final = Decision(Action.NOTHING, is_other=False, appeared=(), vanished=(), pause_s=0.0)
"""Nothing is wrong, and nothing was."""


class FailsafeMonitor:
    """Keeps which failures are present and which responses stand."""

    def __init__(self) -> None:
        """Start with no failure."""
        self.active: frozenset[Failsafe] = frozenset()
        self.action = Action.NOTHING
        self.taken_over = False
        self._standing: dict[Failsafe, Response] = {}
        self._pause_ends_s = -inf

    @property
    def present(self) -> Failsafe:
        """The worst failure that is present."""
        return max(self.active, key=lambda failsafe: failsafe.value, default=Failsafe.NONE)

    @property
    def is_quiet(self) -> bool:
        """Whether nothing is wrong, nothing stands, and nothing was done last."""
        return not (self.active or self._standing or self.action)

    def overridden(self) -> None:
        """Note that the pilot has chosen a mode."""
        self._standing = {failsafe: one for failsafe, one in self._standing.items() if failsafe in self.active}
        self.taken_over = self.action >= Action.HOLD or self.taken_over
        self._pause_ends_s = -inf

    def renewed(self, failsafe: Failsafe) -> None:
        """Note that a failure has become worse and counts as a new one."""
        self._standing.pop(failsafe, None)
        self.active -= {failsafe}

    def disarmed(self) -> None:
        """Forget the responses: nothing flies."""
        self._standing.clear()
        self.active = frozenset()
        self.action = Action.NOTHING
        self.taken_over = False
        self._pause_ends_s = -inf

    def assess(self, now_s: float, failures: Mapping[Failsafe, Response], pause_s: float) -> Decision:
        """Return what is to be done about `failures`, those that are present now.

        `pause_s` is how long a hold before a graver action lasts.
        """
        standing = self._standing
        before, self.active = self.active, frozenset(failures)
        vanished = before - self.active
        for failsafe in vanished:
            if failsafe in standing and (standing[failsafe].ends_with_failure or self.taken_over):
                del standing[failsafe]
        began_s = 0.0
        appeared = sorted(self.active - before, key=lambda failsafe: -failsafe.value)
        for failsafe in self.active:
            response = failures[failsafe]
            if failsafe not in standing and response.action >= Action.HOLD:
                self.taken_over = False
                pauses = response.pauses and response.action in _PAUSED and self.action <= Action.HOLD
                if pauses and pause_s > 0.0 and now_s >= self._pause_ends_s:
                    self._pause_ends_s, began_s = now_s + pause_s, pause_s
            standing[failsafe] = response
        actions = [response.action for response in standing.values()]
        if self.taken_over:
            # What the pilot chose may need a lesser mode in its place; nothing can be taken over from the gravest.
            actions = [action for action in actions if not Action.HOLD <= action < Action.DISARM]
        worst = max(actions, default=Action.NOTHING)
        if now_s < self._pause_ends_s and worst in _PAUSED:
            worst = Action.HOLD
        self.taken_over = self.taken_over and bool(standing)
        is_other, self.action = worst is not self.action, worst
        return Decision(worst, is_other, tuple(appeared), tuple(sorted(vanished, key=lambda one: -one.value)), began_s)
