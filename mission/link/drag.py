"""How much the air brakes the vehicle, by what it leans more than its acceleration needs.

A multicopter whose thrust carries its weight accelerates by g tan(lean), less the drag of the air,

    g tan(lean) - v' = k (v - w)

on each level axis, with the wind w. Over a flight, k is the slope of the left side against the velocity, and what the
wind does is in the means, which are taken off:

    k = cov(v, g tan(lean) - v') / (var(v) + prior).

The prior keeps k at 0 until the velocity has varied enough to tell it.
"""

from collections import deque
from typing import Final

from mission.link.frames import Vector
from mission.monitor.attitude import level_acceleration
from mission.monitor.gaps import GAP_S

MOST_DRAG_PER_S: Final = 2.0

_WINDOW_S: Final = 0.4
_PRIOR: Final = 3.0
"""In (m/s)^2 s: a second at 2 m/s, and one at rest, weigh about as much."""


class _Axis:
    """Integrals over the time of a flight, on one level axis."""

    def __init__(self) -> None:
        """Begin at 0."""
        self.v = self.z = self.vv = self.vz = 0.0

    def add(self, for_s: float, velocity_m_s: float, braked_m_s2: float) -> None:
        """Add a stretch with this velocity and this lean less the acceleration, which is z."""
        self.v += for_s * velocity_m_s
        self.z += for_s * braked_m_s2
        self.vv += for_s * velocity_m_s**2
        self.vz += for_s * (velocity_m_s * braked_m_s2)


class DragEstimate:
    """Level drag over mass, from reports of one flight.

    Attributes:
        drag_per_s: k, from 0 to ``MOST_DRAG_PER_S``.
    """

    def __init__(self) -> None:
        """Know nothing of the vehicle yet."""
        self.drag_per_s = 0.0
        self._reports: deque[tuple[float, float, float, float, float]] = deque()
        self._seconds = 0.0
        self._axes = _Axis(), _Axis()

    @property
    def lean_m_s2(self) -> tuple[Vector, float]:
        """What the vehicle leans by the air alone, as an acceleration: that at rest, and its growth by velocity."""
        if self.drag_per_s == 0.0:
            return (0.0, 0.0, 0.0), 0.0
        east, north = ((axis.z - self.drag_per_s * axis.v) / self._seconds for axis in self._axes)
        return (east, north, 0.0), self.drag_per_s

    def work_w_kg(self, moments: tuple[float, float, float]) -> float:
        """What work the vehicle does against the air, per mass: k |v - w|^2; 0 as long as k is not known.

        Args:
            moments: Mean ENU velocity, m/s, and mean square of the speed.
        """
        (x, y, _), drag_per_s = self.lean_m_s2
        if drag_per_s <= 0.0:
            return 0.0
        east, north, square = moments
        return (x * x + y * y) / drag_per_s + 2.0 * (x * east + y * north) + drag_per_s * square

    def observe(self, t_s: float, velocity_m_s: Vector, attitude_rad: Vector) -> None:
        """Take a report: ENU velocity, and roll, pitch, yaw against NED."""
        reports = self._reports
        if reports and not 0.0 < t_s - reports[-1][0] <= GAP_S:
            reports.clear()
        reports.append((t_s, velocity_m_s[0], velocity_m_s[1], *level_acceleration(*attitude_rad)))
        while len(reports) > 2 and t_s - reports[1][0] >= _WINDOW_S:  # noqa: PLR2004 - a slope needs two
            reports.popleft()
        first_s, *first_m_s = reports[0][:3]
        if t_s - first_s < _WINDOW_S:
            return
        weight_s = t_s - reports[-2][0]
        self._seconds += weight_s
        _, *columns = zip(*reports, strict=True)
        east, north, lean_east, lean_north = (sum(column) / len(reports) for column in columns)
        for axis, mean, lean, last, first in zip(
            self._axes, (east, north), (lean_east, lean_north), velocity_m_s[:2], first_m_s, strict=True
        ):
            axis.add(weight_s, mean, lean - (last - first) / (t_s - first_s))
        varied = sum(axis.vv - axis.v**2 / self._seconds for axis in self._axes)
        together = sum(axis.vz - axis.v * axis.z / self._seconds for axis in self._axes)
        self.drag_per_s = min(max(together / (varied + _PRIOR), 0.0), MOST_DRAG_PER_S)
