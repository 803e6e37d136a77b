"""How closely the vehicle follows its trajectory, and for how long it has not."""

import math

from mission.spec.model import Point


class TrackingWatch:
    """Compares reported positions with the trajectory's; times are arguments.

    Args:
        tube_m: Half width of the certified tube on each axis.
    """

    def __init__(self, tube_m: float) -> None:
        self._tube_m = tube_m
        self._beyond_since: float | None = None
        self._now = 0.0
        self.error_m = 0.0
        self.largest_m = 0.0
        self.largest_m_s = 0.0

    def observe(self, t_s: float, position_m: Point, planned_m: Point) -> None:
        """Take a report into account: where the vehicle is, and where it should be, at time ``t_s``."""
        offsets = (position_m[0] - planned_m[0], position_m[1] - planned_m[1])
        self.error_m = max(abs(offset) for offset in offsets) if all(map(math.isfinite, offsets)) else math.inf
        self.largest_m = max(self.largest_m, self.error_m)
        self._now = t_s
        if self.error_m <= self._tube_m:
            self._beyond_since = None
        elif self._beyond_since is None:
            self._beyond_since = t_s

    @property
    def is_within(self) -> bool:
        """Whether the vehicle is inside the tube, by the last report."""
        return self._beyond_since is None

    def rest(self) -> None:
        """No trajectory is flown."""
        self.error_m, self._beyond_since = 0.0, None

    def observe_velocity(self, velocity_m_s: Point, planned_m_s: Point) -> None:
        """Take into account how fast the vehicle is on each axis, and how fast it should be."""
        offsets = [abs(flown - planned) for flown, planned in zip(velocity_m_s, planned_m_s, strict=True)]
        self.largest_m_s = max(self.largest_m_s, *offsets) if all(map(math.isfinite, offsets)) else math.inf

    @property
    def excess_s(self) -> float:
        """How long the error has been beyond the tube without a break, up to the last report; 0 inside."""
        return 0.0 if self._beyond_since is None else self._now - self._beyond_since
