"""What must not be entered and moves, on the way of a plan: what a flight that is late would meet, or who stays.

A flight that is late by L is at a place of its trajectory L later, and meets there what is there by then. The way is
cut into short pieces. Each is flown within a square that moves along the chord of the piece, as wide as the tube and as
the largest acceleration can bend the way off that chord; a triangle is meanwhile in the hull of where it is at both
ends, for between two instants of the mesh its corners move straight. Where two hulls meet, the piece is cut shorter, a
few times: no contact is missed, and few are made up. What stands is where the proof has it, however late it is; so does
all after the last instant of the mesh.
"""

import math
from typing import Final

import numpy as np
import shapely

from mission.geometry.arrays import FloatArray, IntArray
from mission.geometry.moving import MovingPartition, hulls_of
from mission.plan.fence import drifts, shunned
from mission.plan.flight_plan import FlightPlan
from mission.plan.time_bounds import FOLLOWED_S
from mission.spec.model import Point

_PIECE_S: Final = 0.1
_MOST_PIECES: Final = 4_000
_CUTS: Final = 3
_PARTS: Final = 4
"""What a piece is cut into."""

_SQUARE: Final = np.array([(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)])


class Drifting:
    """The triangles of a plan that move and that no flight which satisfies it may ever enter.

    Args:
        plan: The plan.
        moving: How its triangles move.
    """

    def __init__(self, plan: FlightPlan, moving: MovingPartition) -> None:
        self._plan, self._moving = plan, moving
        self._shut = np.flatnonzero((plan.restricted | shunned(plan)) & drifts(plan))
        corners = moving.places_m[:, moving.fixed.triangles[self._shut]].reshape(len(moving.times_s), -1, 2)
        self._low, self._high = corners.min(axis=1, initial=np.inf), corners.max(axis=1, initial=-np.inf)
        self._asked: tuple[int, str] = (0, "")
        """How late, in units of ``FOLLOWED_S``, was asked for last, and what was the answer."""

    def ahead(self, flown_s: float, late_s: float) -> str:
        """What a flight is going to meet, by the names of its regions; empty where it meets nothing.

        Args:
            flown_s: How much of the trajectory has been flown.
            late_s: How much longer that has taken; the rest is flown so much later. On time it meets nothing: that is
                proved.
        """
        late = int(max(late_s, 0.0) / FOLLOWED_S)
        if late != self._asked[0]:
            self._asked = late, self._named(self._met_ahead(flown_s, late * FOLLOWED_S)) if late else ""
        return self._asked[1]

    def comes(self, place_m: Point, reach_m: float, clock_s: float) -> tuple[float, str] | None:
        """What comes to where somebody stays, from a time on the clock of the trajectory on, and when.

        Args:
            place_m: The middle of a square.
            reach_m: Half a side of it.
            clock_s: From when on.
        """
        begin, end = np.array([clock_s]), np.array([max(clock_s, self._moving.last_s)])
        place = np.array([place_m])
        _, triangles, times = self._met(place, place, np.array([reach_m]), begin, end)
        if not len(triangles):
            return None
        first = int(np.argmin(times))
        return float(times[first]), self._named(int(triangles[first]))

    def _named(self, triangle: int) -> str:
        return "" if triangle < 0 else ", ".join(sorted(self._plan.labelling.label(triangle)))

    def _met_ahead(self, flown_s: float, late_s: float) -> int:
        """The first triangle that the rest meets if it is flown so much later, or by up to ``FOLLOWED_S`` more."""
        trajectory = self._plan.trajectory
        until_s = min(trajectory.duration_s, self._moving.last_s)
        if not len(self._shut) or flown_s >= until_s:
            return -1
        pieces = min(_MOST_PIECES, 1 + int((until_s - flown_s) / _PIECE_S))
        edges = np.linspace(flown_s, until_s, pieces + 1)
        begins, ends = edges[:-1], edges[1:]
        tube_m = self._plan.certificate.tube_m
        for cut in range(_CUTS + 1):
            bend_m = self._plan.spec.limits.acceleration_m_s2 * (ends - begins) ** 2 / 8.0
            here, there = trajectory.position(begins), trajectory.position(ends)
            rows, triangles, _ = self._met(here, there, tube_m + bend_m, begins + late_s, ends + late_s + FOLLOWED_S)
            if not len(rows) or cut == _CUTS:
                break
            near = np.unique(rows)
            here, begins, ends = here[near], begins[near], ends[near]
            surely, which, _ = self._met(here, here, np.full(len(near), tube_m), begins + late_s, begins + late_s)
            if len(surely):
                rows, triangles = surely, which
                break
            shares = np.arange(_PARTS + 1) / _PARTS
            finer = begins[:, None] + shares * (ends - begins)[:, None]
            begins, ends = finer[:, :-1].ravel(), finer[:, 1:].ravel()
        return int(triangles[np.argmin(rows)]) if len(rows) else -1

    def _met(
        self, here_m: FloatArray, there_m: FloatArray, reach_m: FloatArray, begins_s: FloatArray, ends_s: FloatArray
    ) -> tuple[IntArray, IntArray, FloatArray]:
        """What squares meet that move from places (N, 2) to others, with half sides (N,), in their times (N,).

        Returns:
            For each meeting the number of the square, the triangle, and from when on it may be.
        """
        rows, low_s, high_s = self._parted(begins_s, ends_s)
        after = np.searchsorted(self._moving.times_s, low_s, side="right")
        k, n = after - 1, np.minimum(after, len(self._low) - 1)
        low = np.minimum(here_m, there_m)[rows] - reach_m[rows, None]
        high = np.maximum(here_m, there_m)[rows] + reach_m[rows, None]
        near = (low <= np.maximum(self._high[k], self._high[n])).all(axis=1)
        near &= (high >= np.minimum(self._low[k], self._low[n])).all(axis=1)
        rows, low_s, high_s, low, high = (each[near] for each in (rows, low_s, high_s, low, high))
        which, chosen = np.divmod(np.arange(len(rows) * len(self._shut)), max(1, len(self._shut)))
        triangles = self._shut[chosen]
        corners = np.concatenate([self._moving.corners_at(t[which], triangles) for t in (low_s, high_s)], axis=1)
        close = (low[which] <= corners.max(axis=1)).all(axis=1) & (high[which] >= corners.min(axis=1)).all(axis=1)
        which, triangles, corners = which[close], triangles[close], corners[close]
        own = rows[which]
        squares = np.stack((here_m, there_m), axis=1)[own, :, None] + reach_m[own, None, None, None] * _SQUARE
        meet = shapely.intersects(hulls_of(squares.reshape(len(own), 8, 2)), hulls_of(corners))
        return own[meet], triangles[meet], low_s[which][meet]

    def _parted(self, begins_s: FloatArray, ends_s: FloatArray) -> tuple[IntArray, FloatArray, FloatArray]:
        """Spans of time (N,) cut at the instants of the mesh: which span each part is of, and its ends."""
        instants = self._moving.times_s
        first = np.searchsorted(instants, begins_s, side="right")
        counts = np.maximum(np.searchsorted(instants, ends_s, side="left") - first, 0) + 1
        rows = np.repeat(np.arange(len(counts)), counts)
        number = np.arange(len(rows)) - np.repeat(np.cumsum(counts) - counts, counts)
        between = np.append(instants, math.inf)
        low = np.where(number == 0, begins_s[rows], between[first[rows] + number - 1])
        high = np.where(number == counts[rows] - 1, ends_s[rows], between[first[rows] + number])
        return rows, low, high
