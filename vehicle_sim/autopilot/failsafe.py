"""Failsafes as ordered actions: which one acts, when, and whether a pause for the pilot comes first."""

from collections.abc import Mapping
from typing import Final

from vehicle_sim.autopilot.modes import Failsafe
from vehicle_sim.parameters import Action

_PAUSED: Final = frozenset({Action.RETURN, Action.LAND})


class FailsafeMonitor:
    """Keeps which failures are present and says what is to be done about the worst of them, once.

    A failure acts when it appears. It acts again only after it has gone and come back, so a pilot who changes the
    mode keeps it. A lesser failure never undoes what a worse one has set going.
    """

    def __init__(self) -> None:
        """Start with no failure."""
        self.present = Failsafe.NONE
        self._handled: set[Failsafe] = set()
        self._pending: tuple[float, Failsafe, Action] | None = None

    def overridden(self) -> None:
        """The pilot has chosen a mode: drop an action that has not begun."""
        self._pending = None

    def assess(
        self, now_s: float, active: Mapping[Failsafe, Action], pause_s: float
    ) -> tuple[Failsafe, Action, bool] | None:
        """Return the failure to act on now, its action, and whether it is new; None if there is nothing to do.

        `active` are the failures that are present with the actions set for them; `pause_s` is how long the vehicle
        holds before it returns or lands (then the first answer is to hold, the second the action itself).
        """
        worst_before = max((failsafe.value for failsafe in self._handled if failsafe in active), default=0)
        self._handled &= active.keys()
        self.present = max(active, key=lambda failsafe: failsafe.value, default=Failsafe.NONE)
        if self._pending is not None:
            due_s, failsafe, action = self._pending
            if failsafe not in active:
                self._pending = None
            elif now_s >= due_s:
                self._pending = None
                return failsafe, action, False
        fresh = [failsafe for failsafe in active if failsafe not in self._handled]
        if not fresh:
            return None
        self._handled.update(fresh)
        failsafe = max(fresh, key=lambda one: one.value)
        action = active[failsafe]
        if failsafe.value < worst_before:
            action = Action.NOTHING
        if pause_s > 0.0 and action in _PAUSED:
            self._pending = (now_s + pause_s, failsafe, action)
            return failsafe, Action.HOLD, True
        return failsafe, action, True
