"""Where a mission is: which item is flown, which act beside it, and which comes next.

Two orders of the same items. ArduPilot (`beside`): navigation follows navigation; whatever stands between two of them
runs one after the other beside the second, and is dropped when that one ends. PX4: strictly one item after the other.
Both follow jumps without stopping at them.
"""

from collections import deque
from collections.abc import Sequence
from typing import Final, NamedTuple

from vehicle_sim.autopilot.mission_items import FOREVER, Kind, MissionItem

MOST_STEPS: Final = 2048
"""A search for the next item that takes more steps than this has met a loop without anything to fly."""

_MOST_BESIDE: Final = 255


class Jump(NamedTuple):
    """A jump that was followed: where it stands, how often it was followed by now, and how often it may be."""

    item: int
    times: int
    repeats: int


class Cursor:
    """A position in a list of items; it knows nothing of time or flight.

    Attributes:
        current: The item that is flown; None before the first and after a restart.
        beside: The items that are to run beside it, in order.
        jumps: The jumps followed on the way to the current item; the last few of them.
    """

    def __init__(self, items: Sequence[MissionItem], *, first: int, beside: bool) -> None:
        """Stand before item `first` of `items`; `beside` chooses ArduPilot's order."""
        self._items = items
        self._first = first
        self._runs_beside = beside
        self._times: dict[int, int] = {}
        self.current: int | None = None
        self.beside: deque[int] = deque(maxlen=_MOST_BESIDE)
        self.jumps: deque[Jump] = deque(maxlen=4)

    def restart(self) -> None:
        """Stand before the first item, with no jump followed yet."""
        self.current = None
        self.beside.clear()
        self.jumps.clear()
        self.forget_jumps()

    def forget_jumps(self) -> None:
        """Count the repetitions of jumps from zero again."""
        self._times.clear()

    def advance(self) -> bool:
        """Go on to the next item that can be flown; False at the end, where the cursor stays at the last one."""
        return self.move_to(self._first if self.current is None else self.current + 1)

    def move_to(self, index: int) -> bool:
        """Go on at `index`, or at the first item after it that can be flown; False if there is none."""
        self.jumps.clear()
        beside: list[int] = []
        found = self._search(index, self._times, beside, self.jumps, skips=self._runs_beside)
        self.beside.clear()
        if found is None:
            return False
        self.beside.extend(beside[:_MOST_BESIDE])
        self.current = found
        return True

    def upcoming(self) -> MissionItem | None:
        """Return the item of navigation after the current one; None if there is none. Nothing moves."""
        index = self._first if self.current is None else self.current + 1
        return self.navigation_from(index)

    def navigation_from(self, index: int) -> MissionItem | None:
        """Return the first item of navigation at `index` or after it, following jumps as they stand now."""
        found = self._search(index, dict(self._times), [], deque(maxlen=0), skips=True)
        return None if found is None else self._items[found]

    def _search(
        self, index: int, times: dict[int, int], beside: list[int], jumps: deque[Jump], *, skips: bool
    ) -> int | None:
        """Return the item to stop at, noting jumps and, where it `skips` what is not navigation, what was skipped."""
        items = self._items
        for _ in range(MOST_STEPS):
            if not self._first <= index < len(items):
                return None
            item = items[index]
            kind = item.kind
            if kind is Kind.JUMP:
                done = times.get(index, 0)
                if item.repeats == FOREVER or done < item.repeats:
                    times[index] = done + 1
                    jumps.append(Jump(index, done + 1, item.repeats))
                    index = item.target
                else:
                    index += 1
            elif skips and kind is not Kind.NAVIGATE:
                beside.append(index)
                index += 1
            else:
                return index
        return None
