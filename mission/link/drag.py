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

import numpy as np

from mission.link.frames import Vector
from mission.monitor.attitude import horizontal_acceleration
from mission.monitor.gaps import GAP_S

MOST_DRAG_PER_S: Final = 2.0

_WINDOW_S: Final = 0.4
_PRIOR: Final = 3.0
"""In (m/s)^2 s: a second at 2 m/s, and one at rest, weigh about as much."""


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
        self._sums = np.zeros((2, 4))

    @property
    def lean_m_s2(self) -> tuple[Vector, float]:
        """What the vehicle leans by the air alone, as an acceleration: that at rest, and its growth by velocity."""
        if self.drag_per_s == 0.0:
            return (0.0, 0.0, 0.0), 0.0
        east, north = (self._sums[:, 1] - self.drag_per_s * self._sums[:, 0]) / self._seconds
        return (float(east), float(north), 0.0), self.drag_per_s

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
        lean = horizontal_acceleration(np.array([attitude_rad]))[0].tolist()
        reports.append((t_s, velocity_m_s[0], velocity_m_s[1], lean[0], lean[1]))
        while len(reports) > 2 and t_s - reports[1][0] >= _WINDOW_S:  # noqa: PLR2004 - a slope needs two
            reports.popleft()
        if t_s - reports[0][0] < _WINDOW_S:
            return
        window = np.array(reports)
        velocity = window[:, 1:3].mean(axis=0)
        braked = window[:, 3:5].mean(axis=0) - (window[-1, 1:3] - window[0, 1:3]) / (t_s - window[0, 0])
        weight_s = t_s - reports[-2][0]
        self._seconds += weight_s
        self._sums += weight_s * np.stack((velocity, braked, velocity**2, velocity * braked), axis=-1)
        v, z, vv, vz = self._sums.T
        varied = float((vv - v**2 / self._seconds).sum())
        together = float((vz - v * z / self._seconds).sum())
        self.drag_per_s = min(max(together / (varied + _PRIOR), 0.0), MOST_DRAG_PER_S)
