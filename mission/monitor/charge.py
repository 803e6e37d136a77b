"""The charge of the battery in flight: what is left, what the rest and a return take of it, and what follows.

Times are the vehicle's. The mean current is that of the file at first, and from then on what is drawn, in which about a
minute counts; so is the pace at which the trajectory is flown. Between two reports the mean current is taken to flow.

What was drawn so far misleads where wind was with the vehicle, and will be against it. How much work it does against
the air follows from how it leans; what that takes of the charge depends on the vehicle. A multicopter takes 80 to
180 W/kg to hover, and its motors and blades turn 0.6 to 0.9 of what they draw into work: so 1 W/kg more takes between
1/160 and 1/48 of the hovering current, and the less favourable of both is reckoned with.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass
from enum import StrEnum
from typing import Final

from mission.spec.battery import Battery

_COUNTS_S: Final = 60.0
_MAH_PER_A_S: Final = 1.0 / 3.6
_SLOWEST: Final = 0.2
_MOST_PER_W_KG: Final = 1.0 / 48.0
_LEAST_PER_W_KG: Final = 1.0 / 160.0
_MARGIN_S: Final = 1.0
_MARGIN_SHARE: Final = 0.03
"""Of what a return takes: for a current that is not the mean."""


Moments = tuple[float, float, float]
"""Mean of a level velocity, east and north, m/s, and of the square of the speed."""


def share(ahead_w_kg: float, flown_w_kg: float) -> float:
    """The most that so much work against the air may take of the current that another took, as a factor of that.

    With h the hovering current and s what 1 W/kg takes of it, that is h (1 + s w).
    """
    most = _MOST_PER_W_KG if ahead_w_kg >= flown_w_kg else _LEAST_PER_W_KG
    return (1.0 + most * ahead_w_kg) / (1.0 + most * flown_w_kg)


def least_share(flown_w_kg: float) -> float:
    """The least that a flight with the wind may take, likewise."""
    return 1.0 / (1.0 + _MOST_PER_W_KG * flown_w_kg)


class Charge:
    """What a vehicle has told of its charge.

    Attributes:
        current_a: The mean current.
        moments: Mean velocity and mean square of the speed while it flowed.
        capacity_mah: Of a full battery.
        reserve_mah: What is to be left after the landing.
    """

    def __init__(self, battery: Battery, capacity_mah: float) -> None:
        """Nothing was told yet; the capacity is the vehicle's own word, 0 where it has none, unless the file has it."""
        self.current_a = battery.current_a
        self.moments: Moments = (0.0, 0.0, 0.0)
        self.capacity_mah = battery.capacity_mah or capacity_mah
        self.reserve_mah = battery.reserve * self.capacity_mah
        self._pace = 1.0
        self._full_mah: float | None = None
        self._told: tuple[float, float, float | None] | None = None
        """When it was, what was left then, and what had been drawn."""

    def tell(
        self,
        at_s: float,
        consumed_mah: float | None,
        percent: float | None,
        pace: float = 1.0,
        moments: Moments = (0.0, 0.0, 0.0),
    ) -> None:
        """Take a report.

        Args:
            at_s: When.
            consumed_mah: What was drawn so far; None where it is not told.
            percent: What is left, rounded to a whole number; None where it is not told, and then nothing is known.
            pace: Rate at which the trajectory is flown now.
            moments: Since the last report.
        """
        if percent is None or self.capacity_mah <= 0.0:
            return
        left_mah = percent / 100.0 * self.capacity_mah
        if consumed_mah is not None:
            # A per cent is much: what was drawn tells more, unless the vehicle knows of less. Where both agree to a per
            # cent, which autopilots round down or up, the battery was full before.
            one_mah = self.capacity_mah / 100.0
            if self._full_mah is None:
                full_mah = left_mah + consumed_mah
                self._full_mah = self.capacity_mah if abs(full_mah - self.capacity_mah) <= one_mah else full_mah
            left_mah = min(self._full_mah - consumed_mah, left_mah + one_mah)
        if self._told is not None:
            before_s, _, before_mah = self._told
            for_s = at_s - before_s
            if for_s <= 0.0:
                return
            new = -math.expm1(-for_s / _COUNTS_S)
            self._pace += new * (min(max(pace, _SLOWEST), 1.0) - self._pace)
            x, y, square = (kept + new * (now - kept) for kept, now in zip(self.moments, moments, strict=True))
            self.moments = x, y, square
            if consumed_mah is not None and before_mah is not None and consumed_mah >= before_mah:
                self.current_a += new * ((consumed_mah - before_mah) / (_MAH_PER_A_S * for_s) - self.current_a)
        self._told = at_s, left_mah, consumed_mah

    @property
    def is_known(self) -> bool:
        """Whether anything was told."""
        return self._told is not None

    def left_mah(self, at_s: float) -> float:
        """What is left at a time; infinite before anything was told."""
        if self._told is None:
            return math.inf
        told_s, left_mah, _ = self._told
        return max(left_mah - self.charge_mah(at_s - told_s), 0.0)

    def charge_mah(self, duration_s: float) -> float:
        """What so long a flight takes."""
        return self.current_a * duration_s * _MAH_PER_A_S

    def flying_s(self, trajectory_s: float) -> float:
        """How long it takes to fly so much of a trajectory, at the mean pace."""
        return trajectory_s / self._pace

    def spare_s(self, at_s: float, needed_s: float, *, reserve: bool = True) -> float:
        """For how long there is charge beyond so long a flight, and beyond the reserve; negative where it is short."""
        kept_mah = self.reserve_mah if reserve else 0.0
        return (self.left_mah(at_s) - kept_mah) / (self.current_a * _MAH_PER_A_S) - needed_s


class Resolve(StrEnum):
    """What is done about the charge."""

    GO_ON = "go on"
    LOOK_BACK = "find out what a return takes"
    FLY_ON = "fly on while a return suffices"
    RETURN = "return"
    GIVE_UP = "give up"


@dataclass(frozen=True)
class Prospect:
    """For how long there is charge beyond what is ahead, each including the landing, s.

    Attributes:
        rest_s: Beyond the rest of the plan, and the reserve.
        return_s: Beyond a return that is proved, the reserve and a margin; None where none is known.
        straight_s: Beyond the straight way to where the flight may end, with nothing kept: no return takes less.
        fresh: Whether the return begins about here, and not where the vehicle was some time ago.
    """

    rest_s: float
    return_s: float | None
    straight_s: float
    fresh: bool


_TABLE: Final[tuple[tuple[Callable[[Prospect], bool], Resolve], ...]] = (
    (lambda now: now.rest_s >= 0.0, Resolve.GO_ON),
    (lambda now: now.straight_s < 0.0, Resolve.GIVE_UP),
    (lambda now: now.return_s is None, Resolve.LOOK_BACK),
    (lambda now: now.return_s is not None and now.return_s > 0.0, Resolve.FLY_ON),
    (lambda now: not now.fresh, Resolve.LOOK_BACK),
    (lambda _: True, Resolve.RETURN),
)


def resolved(now: Prospect) -> Resolve:
    """What is to be done: the first row that applies."""
    return next(resolve for applies, resolve in _TABLE if applies(now))


def margin_s(return_s: float) -> float:
    """How long before a return of so long a flight no longer suffices it is begun."""
    return _MARGIN_S + _MARGIN_SHARE * return_s
