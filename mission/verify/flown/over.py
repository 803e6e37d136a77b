"""Which triangles a flight was over, report by report, and which it may have been over in between.

Where triangles move, a report is taken back to the point of the fixed triangles of which it is the image then, and the
line to the next one is straight there, as in flight. What else is within reach stays where it is flown: a triangle may
have been entered where the hull of it at all that time has a point in common with the area that is within reach.
Between two instants of the mesh its corners move straight, so no triangle is missed.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
import shapely

from mission.geometry.arrays import FloatArray, IntArray
from mission.geometry.location import Locator
from mission.geometry.moving import MovingPartition, hulls_of
from mission.verify.flown.reach import Reaches


@dataclass(frozen=True, eq=False)
class Over:
    """The triangles under the reports of a flight, in a domain that stands.

    Attributes:
        locator: The domain.
        reaches: The reports, and how far the vehicle may have been off between them.
    """

    locator: Locator
    reaches: Reaches

    @cached_property
    def points_m(self) -> FloatArray:
        """The points of the fixed triangles at which it was, shape (N, 2)."""
        return self.reaches.position_m

    @cached_property
    def at(self) -> IntArray:
        """The triangle of each report, shape (N,); -1 outside the domain."""
        return self.locator.triangle_at(self.points_m)

    def line(self, index: int) -> tuple[tuple[int, float], ...]:
        """The triangles on the straight line from a report to the next, and the shares at which they are entered."""
        begin, end = self.points_m[index : index + 2].tolist()
        return self.locator.crossed(tuple(begin), tuple(end), likely=int(self.at[index]))

    def within(self, index: int) -> IntArray:
        """The triangles that may have been entered after a report and before the next, ascending."""
        return self.locator.meeting(self.reaches.area(index))

    def leaves(self, index: int) -> bool:
        """Whether it may have left the domain meanwhile, if it was inside."""
        return self.locator.leaves(self.reaches.area(index))

    def depth_m(self, triangles: IntArray) -> FloatArray:
        """How deep the line from each report to the next is in a triangle (N - 1,) at least, shape (N - 1,)."""
        begin, end = slice(None, -1), slice(1, None)
        return np.minimum(self._depths_m(triangles, begin), self._depths_m(triangles, end))

    def _depths_m(self, triangles: IntArray, part: slice) -> FloatArray:
        """How deep some reports are in triangles, one each."""
        shares = self.locator.partition.barycentric(triangles, self.points_m[part])
        return np.asarray((shares * self._heights_m(triangles, part)).min(axis=1))

    def _heights_m(self, triangles: IntArray, _part: slice) -> FloatArray:
        """The heights of triangles at those reports, shape (..., 3)."""
        return self.locator.partition.heights_m[triangles]


@dataclass(frozen=True, eq=False)
class MovingOver(Over):
    """The same in a domain that moves.

    Attributes:
        moving: How it moves.
        began_s: From when on, on the clock of the reports.
    """

    moving: MovingPartition
    began_s: float

    @cached_property
    def clock_s(self) -> FloatArray:
        """The time of each report on the clock by which it moves, shape (N,)."""
        return np.maximum(self.reaches.t_s - self.began_s, 0.0)

    @cached_property
    def points_m(self) -> FloatArray:
        """As in ``Over``."""
        return self.moving.pulled_back(self.clock_s, self.reaches.position_m)

    def within(self, index: int) -> IntArray:
        """As in ``Over``."""
        begin_s, end_s = self.clock_s[index : index + 2].tolist()
        instants = self.moving.times_s
        times = np.array([begin_s, *instants[(instants > begin_s) & (instants < end_s)], end_s])
        area = self.reaches.area(index)
        west, south, east, north = area.bounds
        lowest, highest = self._boxes
        near = np.flatnonzero(((lowest <= (east, north)) & (highest >= (west, south))).all(axis=1))
        corners = self.moving.corners_at(np.tile(times, len(near)), np.repeat(near, len(times)))
        swept = hulls_of(corners.reshape(len(near), -1, 2))
        return np.asarray(near[shapely.intersects(swept, area)])

    @cached_property
    def _boxes(self) -> tuple[FloatArray, FloatArray]:
        """The lowest and the highest coordinates of each triangle at any time, shape (M, 2)."""
        corners = self.moving.places_m[:, self.moving.fixed.triangles]
        return corners.min(axis=(0, 2)), corners.max(axis=(0, 2))

    def depth_m(self, triangles: IntArray) -> FloatArray:
        """As in ``Over``: a triangle changes meanwhile by no more than its corners move, and so does how deep it is."""
        moved_m = self.moving.fastest_m_s * np.diff(self.clock_s)
        return super().depth_m(triangles) - 2.0 * moved_m

    def _heights_m(self, triangles: IntArray, part: slice) -> FloatArray:
        """As in ``Over``."""
        corners = self.moving.corners_at(self.clock_s[part], triangles)
        edges = np.roll(corners, -2, axis=1) - np.roll(corners, -1, axis=1)
        doubled = edges[:, 1, 0] * edges[:, 2, 1] - edges[:, 1, 1] * edges[:, 2, 0]
        return np.asarray(doubled[:, None] / np.hypot(edges[..., 0], edges[..., 1]))
