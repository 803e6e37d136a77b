"""Where a vehicle may have been between two reports of its position.

Whatever flies with an acceleration of at most a stays, between two places h apart in time, within a h^2 / 8 of where a
straight and steady motion would have it: the error of linear interpolation. Whatever flies at most v fast stays in the
ellipse whose foci are the two places, and whose long axis is v h; half its short axis bounds the way to the straight
line, too. The smaller of the two is the *reach*, and all within the reach of the straight line is where the vehicle may
have been; in long gaps the ellipse alone, where it is smaller.

Of a vehicle that its program left and took up again more is known: nobody led it in between, so that its autopilot
stopped it and held it. It went on as it flew for as far as it takes to notice that and to brake, and came from there to
the place where it was found, or went straight to that: it stayed near the triangle of these three places.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property
from typing import Final

import numpy as np
import shapely

from mission.geometry.arrays import BoolArray, FloatArray
from mission.monitor.gaps import GAP_S
from mission.spec.model import Point

FASTEST_M_S: Final = 20.0
"""Taken for the speed that no vehicle exceeds, where nobody says better."""

ACCELERATION_M_S2: Final = 9.81
"""Taken for the acceleration that none exceeds: that of a multicopter that leans by 45 degrees."""

_LEAST_M: Final = 1e-6
_QUARTER: Final = 16
_OUTSIDE: Final = 1.0 / np.cos(np.pi / 4.0 / _QUARTER)
"""A polygon around a circle has corners so much farther out."""


@dataclass(frozen=True, eq=False)
class Reaches:
    """The times between reports.

    Attributes:
        t_s: Times of the reports, ascending, shape (N,).
        position_m: Where the vehicle was, shape (N, 2).
        fastest_m_s: It flies no faster.
        acceleration_m_s2: Its acceleration is no larger.
        ahead_m: By the numbers of reports after which nobody led it until the next one: how far it may have gone on
            before it came to rest, east and north.
        aside_m: How far it may be from where it is to be then.
    """

    t_s: FloatArray
    position_m: FloatArray
    fastest_m_s: float = FASTEST_M_S
    acceleration_m_s2: float = ACCELERATION_M_S2
    ahead_m: Mapping[int, Point] = field(default_factory=dict)
    aside_m: float = 0.0

    @cached_property
    def gap_s(self) -> FloatArray:
        """Between each report and the next, shape (N - 1,)."""
        gaps: FloatArray = np.diff(self.t_s)
        return gaps

    @cached_property
    def apart_m(self) -> FloatArray:
        """From each report to the next, shape (N - 1,)."""
        apart: FloatArray = np.hypot(*np.diff(self.position_m, axis=0).T)
        return apart

    @cached_property
    def jumps(self) -> BoolArray:
        """Where it came farther than it flies, shape (N - 1,): one of the two positions is wrong."""
        jumps: BoolArray = self.apart_m > self.fastest_m_s * self.gap_s
        return jumps

    @cached_property
    def is_gap(self) -> BoolArray:
        """Where nothing was told for so long that the straight line says little, or it jumped, shape (N - 1,)."""
        gaps: BoolArray = (self.gap_s > GAP_S) | self.jumps
        return gaps

    @cached_property
    def is_open(self) -> BoolArray:
        """The gaps of which nothing more is known, shape (N - 1,)."""
        is_open: BoolArray = self.is_gap.copy()
        is_open[list(self.ahead_m)] = False
        return is_open

    @cached_property
    def _half_short_m(self) -> FloatArray:
        """Half the short axis of the ellipse."""
        squares = (self.fastest_m_s * self.gap_s) ** 2 - self.apart_m**2
        half: FloatArray = np.sqrt(np.maximum(squares, 0.0)) / 2.0
        return half

    @cached_property
    def reach_m(self) -> FloatArray:
        """From the straight line, shape (N - 1,); where it jumped, as far as it jumped."""
        bent = self.acceleration_m_s2 * self.gap_s**2 / 8.0
        reach: FloatArray = np.where(self.jumps, np.maximum(bent, self.apart_m), np.minimum(bent, self._half_short_m))
        for index, ahead_m in self.ahead_m.items():
            reach[index] = np.hypot(*ahead_m) + self.aside_m
        return reach

    @cached_property
    def lines(self) -> "np.ndarray[tuple[int], np.dtype[np.object_]]":
        """The straight lines, shape (N - 1,)."""
        ends = np.stack((self.position_m[:-1], self.position_m[1:]), axis=1)
        return np.asarray(shapely.linestrings(ends))

    def area(self, index: int) -> shapely.Geometry:
        """Where the vehicle may have been after a report and before the next; a polygon around that."""
        reach_m = float(self.reach_m[index])
        half_m = float(self._half_short_m[index])
        begin, end = self.position_m[index], self.position_m[index + 1]
        if index in self.ahead_m:
            places = shapely.MultiPoint([begin, end, begin + self.ahead_m[index]])
            return shapely.buffer(places.convex_hull, max(self.aside_m * _OUTSIDE, _LEAST_M), quad_segs=_QUARTER)
        if reach_m < half_m or self.jumps[index]:
            return shapely.buffer(self.lines[index], max(reach_m * _OUTSIDE, _LEAST_M), quad_segs=_QUARTER)
        middle, along = (begin + end) / 2.0, end - begin
        length = float(np.hypot(*along))
        unit = along / length if length > 0.0 else np.array([1.0, 0.0])
        angles = np.linspace(0.0, 2.0 * np.pi, 4 * _QUARTER, endpoint=False)
        half_long = self.fastest_m_s * self.gap_s[index] / 2.0
        across = np.array([-unit[1], unit[0]])
        rim = np.outer(np.cos(angles) * half_long, unit) + np.outer(np.sin(angles) * half_m, across)
        return shapely.Polygon(middle + _OUTSIDE * rim)
