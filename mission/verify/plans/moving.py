"""Triangles that move: whether those that a plan names for each piece of its curve are all that the tube may touch.

A part of the curve is flown between two times of its law, a stop included, and the hull of its control points, grown by
the tube, holds the vehicle meanwhile. Between two instants of the mesh the corners of a triangle move straight, so that
the hull of where they are at both ends of a time holds the triangle for all of it. Where these hulls meet and the
triangle is not named, the time is halved, and with it what is flown and what is swept.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final, NamedTuple

import numpy as np
import shapely

from mission.geometry.arrays import BoolArray, FloatArray, IntArray
from mission.geometry.bernstein import Pieces, part, undecided
from mission.geometry.location import Locator
from mission.geometry.moving import MovingPartition
from mission.verify.plans.motion import Law, steps_of
from mission.verify.plans.patches import ROUNDING, Patches
from mission.verify.plans.tube import Met, hulls

BESIDE_S: Final = 0.05
"""So much earlier and later than by the clock of its trajectory a flight may be where it is."""

_SAME: Final = 1e-9


class Leg(NamedTuple):
    """A curve with its time law, and how it is begun.

    Attributes:
        curve: The curve.
        law: Its law.
        start: Where it begins on the curve of its proof.
        begun_s: When it is begun: once, or lap after lap until all triangles stand.
    """

    curve: Patches
    law: Law
    start: float
    begun_s: Sequence[float]


@dataclass(frozen=True, eq=False)
class _Flown(Pieces):
    """Times of a leg, by its own clock, in which a piece of the proof is flown.

    Attributes:
        begun_s: Shape (K,), when the leg is begun.
        piece: Shape (K,), the piece.
    """

    begun_s: FloatArray
    piece: IntArray


class MovingGround:
    """Triangles that move, to be asked what meets them, and when.

    Args:
        moving: The triangles.
        restricted: Shape (M,), those that must not be met.
    """

    def __init__(self, moving: MovingPartition, restricted: BoolArray) -> None:
        self.moving, self.restricted, self.size = moving, restricted, moving.fixed.size
        self.slack_m = ROUNDING * max(1.0, float(np.abs(moving.places_m).max()))
        places = moving.places_m[:, moving.fixed.triangles]  # (T, M, 3, 2)
        low, high = places.min(axis=(0, 2)), places.max(axis=(0, 2))
        self._boxes = shapely.STRtree(shapely.box(*low.T, *high.T))
        self._rim = Locator(moving.fixed).rim

    def met(self, shapes: np.ndarray, begins_s: FloatArray, ends_s: FloatArray) -> Met:
        """What shapes meet.

        Args:
            shapes: Shape (K,), convex.
            begins_s: Shape (K,), from when each is there.
            ends_s: Shape (K,), until when; may be infinite.
        """
        every = np.ones(self.size, dtype=np.bool_)
        found, met = np.divmod(np.unique(self._pairs(shapes, begins_s, ends_s, 0.0, every)), self.size)
        outside = np.bincount(found, minlength=len(shapes)) == 0
        outside[self._rim.query(shapes, predicate="intersects")[0]] = True
        return found, met, outside

    def near(self, shapes: np.ndarray, begins_s: FloatArray, ends_s: FloatArray, within_m: float) -> BoolArray:
        """Which shapes, as in ``met``, come so near to what is restricted, shape (K,)."""
        pairs = self._pairs(shapes, begins_s, ends_s, within_m, self.restricted)
        return np.isin(np.arange(len(shapes)), pairs // self.size)

    def met_at(self, places_m: FloatArray, half_m: float, begin_s: float, end_s: float) -> Met:
        """What is met by squares round places (K, 2), all of them there from one time to another."""
        half = half_m + self.slack_m
        squares = shapely.box(*(places_m - half).T, *(places_m + half).T)
        return self.met(squares, *(np.full(len(squares), each) for each in (begin_s - BESIDE_S, end_s + BESIDE_S)))

    def _pairs(
        self, shapes: np.ndarray, begins_s: FloatArray, ends_s: FloatArray, within_m: float, some: BoolArray
    ) -> IntArray:
        """Pairs of a shape and one of some triangles (M,) that come so near, as numbers, some of them often."""
        low_s, high_s = (np.clip(each, 0.0, self.moving.last_s) for each in (begins_s, ends_s))
        which, low_s, high_s = _between(self.moving.times_s, low_s, high_s)
        rows, triangles = self._boxes.query(shapes[which], predicate="dwithin", distance=within_m)
        rows, triangles = rows[some[triangles]], triangles[some[triangles]]
        corners = [self.moving.corners_at(each[rows], triangles) for each in (low_s, high_s)]
        swept = shapely.convex_hull(shapely.linestrings(np.concatenate(corners, axis=1)))
        near = shapely.dwithin(shapes[which[rows]], swept, within_m)
        return np.asarray(which[rows[near]] * self.size + triangles[near])


def stray_in_time(
    ground: MovingGround, legs: Sequence[Leg], half_m: float, knots_s: FloatArray, sets: list[list[int]]
) -> str | None:
    """As ``tube.stray``, of a curve that is flown by its laws while the triangles move."""
    named = np.concatenate([piece * ground.size + np.array(of, dtype=np.int64) for piece, of in enumerate(sets)])

    for leg in legs:

        def strays(some: _Flown, leg: Leg = leg) -> BoolArray:
            which, triangles, doubtful = ground.met(*_swept(leg, some, half_m))
            doubtful[which[~np.isin(some.piece[which] * ground.size + triangles, named)]] = True
            return doubtful

        left = undecided(_flown(leg, knots_s), strays)
        if len(left):
            first = left.taken(np.arange(1))
            _, triangles, outside = ground.met(*_swept(leg, first, half_m))
            closed = ground.restricted[triangles].any()
            what = "meet what must not be entered" if closed else "leave the triangles that are named"
            return f"may {'leave the domain' if outside[0] else what} {_where(leg, first)}"
    return None


def nearer_in_time(ground: MovingGround, legs: Sequence[Leg], claimed_m: float) -> str | None:
    """Where a curve comes nearer than a distance to what is restricted, wherever that is then; None where nowhere."""
    for leg in legs if claimed_m > 0.0 else ():

        def comes_near(some: _Flown, leg: Leg = leg) -> BoolArray:
            return ground.near(*_swept(leg, some, 0.0), claimed_m)

        left = undecided(_flown(leg, np.array([0.0, np.inf])), comes_near)
        if len(left):
            return f"is {claimed_m:.9g} m in the plan, and less {_where(leg, left.taken(np.arange(1)))}"
    return None


def _flown(leg: Leg, knots_s: FloatArray) -> _Flown:
    """What is flown of a leg: the steps of its law, cut where a piece of the proof ends, and pieces that are instants.

    A stop where two pieces meet is of both.
    """
    own, last_s = knots_s - leg.start, float(leg.curve.ends_s[-1])
    begins, ends = steps_of(leg.curve, leg.law, own)
    instants = own[:-1][np.diff(own) == 0.0]
    moments = leg.law.times_s(instants[(instants >= 0.0) & (instants <= last_s)])
    begins, ends = np.concatenate((begins, moments)), np.concatenate((ends, moments))
    places = [leg.law.jet(each)[0] for each in (begins, ends)]
    slack = np.where(places[0] == places[1], _SAME * knots_s[np.isfinite(knots_s)][-1], 0.0)
    middle = 0.5 * (places[0] + places[1])
    first = np.maximum(np.searchsorted(own, middle - slack) - 1, 0)
    last = np.maximum(np.minimum(np.searchsorted(own, middle + slack, side="right"), len(own) - 1) - 1, first)
    row = np.repeat(np.arange(len(begins)), last - first + 1)
    piece = np.minimum(first[row] + np.arange(len(row)) - np.searchsorted(row, row), len(knots_s) - 2)
    begun = np.array(leg.begun_s)
    times = np.tile(np.arange(len(row)), len(begun))
    row = row[times]
    return _Flown(begins[row], ends[row], np.repeat(begun, len(times) // len(begun)), piece[times])


def _swept(leg: Leg, some: _Flown, half_m: float) -> tuple[np.ndarray, FloatArray, FloatArray]:
    """Shapes (K,) that hold the vehicle in its tube, and from when to when, with what it may be beside its clock."""
    low, high = (leg.law.jet(each)[0] for each in (some.begins_s, some.ends_s))
    on = leg.curve.taken(leg.curve.at_index(0.5 * (low + high)))
    shares = [np.clip((s - on.begins_s) / (on.ends_s - on.begins_s), 0.0, 1.0) for s in (low, high)]
    flown = Patches(low, high, part(on.control_m, *shares), on.off)
    times = some.begun_s + some.begins_s - BESIDE_S, some.begun_s + some.ends_s + BESIDE_S
    return (hulls(flown, half_m), *times)


def _where(leg: Leg, first: _Flown) -> str:
    x, y = leg.curve.at(leg.law.jet(first.begins_s)[0])[0]
    return f"near ({x:.2f}, {y:.2f}) after {float((first.begun_s + first.begins_s)[0]):.2f} s"


def _between(instants_s: FloatArray, low_s: FloatArray, high_s: FloatArray) -> tuple[IntArray, FloatArray, FloatArray]:
    """Times (K,) cut at instants: which of them each part is of, and its ends."""
    first = np.searchsorted(instants_s, low_s, side="right") - 1
    parts = np.maximum(np.searchsorted(instants_s, high_s) - first, 1)
    which = np.repeat(np.arange(len(parts)), parts)
    number = first[which] + np.arange(len(which)) - np.searchsorted(which, which)
    edges = np.append(instants_s, np.inf)
    return which, np.maximum(low_s[which], edges[number]), np.minimum(high_s[which], edges[number + 1])
