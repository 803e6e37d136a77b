"""The mission that the vehicle holds: its items, where it is in them, and what happened that links are to be told.

It outlives the mode that flies it. What becomes of the position when a mission is replaced, resumed or left differs
between the flavours: ArduPilot `AP_Mission.cpp`, PX4 `mission_base.cpp`.
"""

from collections import deque
from enum import Enum, auto
from typing import NamedTuple

from vehicle_sim.autopilot.cursor import Cursor
from vehicle_sim.autopilot.mission_items import Command, MissionItem
from vehicle_sim.parameters import Flavour

_MOST_NEWS = 256


class Progress(Enum):
    """How far a mission has come."""

    NOT_STARTED = auto()
    ACTIVE = auto()
    PAUSED = auto()
    COMPLETE = auto()


class News(NamedTuple):
    """Something to tell: an item was reached, or else has become the current one."""

    item: int
    reached: bool


class Mission:
    """Items and the position in them.

    Attributes:
        items: The items as the ground station numbers them; ArduPilot's item 0 is home and never flown.
        cursor: The position.
        progress: How far it has come.
        running: Whether a mode flies it now.
        revision: Grows when another item is to be flown than before, while the mission is flown.
        replacements: Grows when that is so because the mission was replaced.
        news: What happened and was not told yet, oldest first; its reader pops what it has taken.
    """

    def __init__(self, flavour: Flavour) -> None:
        """Hold no items."""
        self._px4 = flavour is Flavour.PX4
        self._first = 0 if self._px4 else 1
        self.items: tuple[MissionItem, ...] = ()
        self.cursor = self._cursor()
        self.progress = Progress.NOT_STARTED
        self.running = False
        self.revision = 0
        self.replacements = 0
        self.news: deque[News] = deque(maxlen=_MOST_NEWS)
        self._has_reached = False
        self._disarmed_since = False

    def _cursor(self) -> Cursor:
        return Cursor(self.items, first=self._first, beside=not self._px4)

    @property
    def present(self) -> bool:
        """Whether there is anything to fly."""
        return len(self.items) > self._first

    @property
    def current(self) -> int:
        """The index of the current item; 0 before the first."""
        return self.cursor.current or 0

    @property
    def item(self) -> MissionItem | None:
        """The current item; None before the first, and where a replaced mission has no such item any more."""
        index = self.cursor.current
        return None if index is None or index >= len(self.items) else self.items[index]

    def starts_with_takeoff(self, *, restarts: bool) -> bool:
        """Whether what is flown from here on begins by leaving the ground; delays may stand before it."""
        index = None if restarts or self.progress is Progress.COMPLETE else self.cursor.current
        for following in range(self._first if index is None else index, len(self.items)):
            item = self.cursor.navigation_from(following)
            if item is None or item.command is not Command.DELAY:
                return item is not None and item.command is Command.TAKEOFF
        return False

    # From the ground station.

    def load(self, items: tuple[MissionItem, ...], current: int | None = None) -> None:
        """Replace the mission; `current` is the item that was marked as the one to begin at (PX4)."""
        old, was_at = self.items, self.cursor.current
        self.items = items
        self.cursor = self._cursor()
        if self._px4 and not self.running:
            was_at = None
        if current is not None and self._px4:
            was_at = current
        if was_at is not None and items:
            # ArduPilot keeps the number even where it lies beyond the end, and finds out when it goes on.
            self.cursor.current = min(was_at, len(items) - 1) if self._px4 else was_at
        if not self.running:
            self.progress = Progress.NOT_STARTED
            self._has_reached = False
        elif was_at is None or old[was_at : was_at + 2] != items[was_at : was_at + 2]:
            self.revision += 1
            self.replacements += 1
        self.news.append(News(self.current, reached=False))

    def set_current(self, index: int, *, resets_jumps: bool = False) -> bool:
        """Make `index` the item to fly next, or to fly at once; False where there is none to fly."""
        if not 0 <= index < len(self.items) or not self.present:
            return False
        index = max(index, self._first)
        if resets_jumps or (index == self._first and not self._px4):
            self.cursor.restart()
        if not self.cursor.move_to(index):
            return False
        if self.running:
            self.revision += 1
        else:
            self.progress = Progress.PAUSED if self._has_reached else Progress.NOT_STARTED
        self.news.append(News(self.current, reached=False))
        return True

    # From the mode that flies it.

    def begin(self, *, restarts: bool) -> bool:
        """Start or resume; False if there is nothing to fly."""
        cursor, was_at = self.cursor, self.cursor.current
        self.running = True
        at_end = self._disarmed_since and was_at is not None and was_at + 1 == len(self.items)
        over = self.progress is Progress.COMPLETE and (at_end or not self._px4)
        self._disarmed_since = False
        self.progress = Progress.ACTIVE
        if restarts or over or was_at is None or was_at >= len(self.items):
            cursor.restart()
            self._has_reached = False
            found = cursor.advance()
        else:
            found = cursor.move_to(was_at)
        if found:
            self.news.append(News(self.current, reached=False))
        return found

    def reach(self, index: int) -> None:
        """Note that an item has done what it asked for."""
        self._has_reached = True
        self.news.append(News(index, reached=True))

    def advance(self) -> bool:
        """Go on to the next item; False at the end, where the mission is complete."""
        if self.cursor.advance():
            self.news.append(News(self.current, reached=False))
            return True
        return False

    def settle(self) -> bool:
        """Find what is to be flown at or after the current number in a mission that was replaced."""
        index = self.cursor.current
        found = self.cursor.advance() if index is None else self.cursor.move_to(index)
        if found and self.cursor.current != index:
            self.news.append(News(self.current, reached=False))
        return found

    def complete(self) -> None:
        """Note that the mission is at its end."""
        self.progress = Progress.COMPLETE
        self.running = False
        self.cursor.forget_jumps()

    def stop(self) -> None:
        """Note that the mode which flew it was left."""
        self.running = False
        if self.progress is Progress.ACTIVE:
            self.progress = Progress.PAUSED if self._has_reached else Progress.NOT_STARTED

    def disarmed(self) -> None:
        """Note that the motors stopped: ArduPilot begins anew next time, PX4 if it was at its last item."""
        self._disarmed_since = True
        if not self._px4:
            self.stop()
            self.cursor.restart()
