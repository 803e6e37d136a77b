"""Which corners of free space may be seen from where: cones of sight go on from triangle to triangle, all at once.

The triangles are those of Delaunay between all corners; a cone ends at sides that are edges of rims. An edge that is no
side stops none, and cones are a hair too wide: all that is seen is found, and some that is not (after the expansion of
triangles by Bungiu et al., "Efficient computation of visibility polygons", 2014).
"""

from collections.abc import Iterator, Sequence
from functools import cached_property
from typing import Final, NamedTuple, TypeAlias

import numpy as np
import numpy.typing as npt
from scipy.spatial import Delaunay, cKDTree

from mission.geometry.arrays import BoolArray, FloatArray, IntArray

_AT_ONCE: Final = 16_384
"""Cones that go on together: bounds the memory."""
_NONE: Final = -1
_NOTHING: Final = slice(0, 0)

_Points: TypeAlias = npt.NDArray[np.complex128]
"""Places or directions, x + i y."""


class _Cones(NamedTuple):
    """Cones of sight, each less than a half turn wide.

    Attributes:
        start: The place that each begins at, by its index.
        side: The side of a triangle that it has come to.
        right: The direction of its right end.
        left: The direction of its left end.
    """

    start: IntArray
    side: IntArray
    right: _Points
    left: _Points

    def of(self, some: BoolArray | IntArray | slice) -> "_Cones":
        """Some of them."""
        return _Cones(self.start[some], self.side[some], self.right[some], self.left[some])


class Sights:
    """What may be seen of the corners of a free space.

    Args:
        corners_m: Shape (K, 2), all corners of its rims.
        following: Shape (K,), the corner at which the edge that begins at each one ends.
        slack_m: How far beyond a corner a line of sight may go.
    """

    def __init__(self, corners_m: FloatArray, following: IntArray, slack_m: float) -> None:
        self._corners_m, self._slack_m = corners_m, slack_m
        self._points, self._following = _complex(corners_m), following
        self._mesh = mesh = Delaunay(corners_m)
        count = len(corners_m)
        # Corners at one place are one vertex.
        vertex = np.arange(count)
        vertex[mesh.coplanar[:, 0]] = mesh.coplanar[:, 2]
        self._vertex, self._corner = vertex, np.argsort(vertex, kind="stable")
        self._first_corner = np.searchsorted(vertex[self._corner], np.arange(count + 1))
        # Side 3 t + k is that of triangle t opposite to its vertex k. It is entered from the side beyond.
        triangles, beside = mesh.simplices.astype(np.int64), mesh.neighbors.astype(np.int64)
        self._opposite = triangles.ravel()
        self._right, self._left = (np.roll(triangles, -turn, axis=1).ravel() for turn in (1, 2))
        rim = np.isin(_keys(self._right, self._left, count), _keys(vertex, vertex[following], count))
        back = (beside[beside] == np.arange(len(triangles))[:, None, None]).argmax(axis=2)
        self._beyond = np.where(rim | (beside.ravel() < 0), _NONE, (3 * beside + back).ravel())
        # Beyond the two other sides of a triangle; turned as from the side entered, its right end is the second one.
        by_side = self._beyond.reshape(-1, 3)
        self._right_beyond, self._left_beyond = (np.roll(by_side, -turn, axis=1).ravel() for turn in (1, 2))
        self._round = np.argsort(self._opposite, kind="stable")
        self._first_round = np.searchsorted(self._opposite[self._round], np.arange(count + 1))

    def from_corners(self, corners: IntArray) -> tuple[IntArray, IntArray]:
        """Pairs of an index into some corners and the number of a corner that may be seen from there; some repeat.

        Only where a path may bend at the first one, whose edges both lie on one side of the way then.
        """
        cones = self._round_vertices(self._vertex[corners])
        cones = _joined([_within(cones, *wedge) for wedge in self._wedges(corners)])
        return self._seen(self._points[corners], cones)

    def from_places(self, places_m: FloatArray) -> tuple[IntArray, IntArray]:
        """Pairs of an index into places, shape (N, 2), in free space and a corner seen there; some repeat."""
        triangle = self._triangle_at(places_m)
        corners = self._opposite.reshape(-1, 3)[triangle]
        apart = np.hypot(*np.moveaxis(self._corners_m[corners] - places_m[:, None], 2, 0))
        here = apart.min(axis=1) <= 0.5 * self._slack_m
        at, other = np.flatnonzero(here), np.flatnonzero(~here)
        places = _complex(places_m)
        first, seen = self._seen(places, self._cones(places, *self._sides_round(places_m, other, triangle[other])))
        corner = corners[at, apart[at].argmin(axis=1)]  # as from there
        second, also = self._seen(self._points[corner], self._round_vertices(corner))
        return np.concatenate((first, at[second], at)), np.concatenate((seen, also, corner))

    def _round_vertices(self, vertex: IntArray) -> _Cones:
        """All round some vertices."""
        start, place = ranges(self._first_round[vertex], self._first_round[vertex + 1])
        return self._cones(self._points[vertex], start, self._round[place])

    def _sides_round(self, places_m: FloatArray, index: IntArray, triangle: IntArray) -> tuple[IntArray, IntArray]:
        """The sides through which places, by their index, look out of a triangle: pairs of an index and a side.

        Of a place on a side, also those of the triangle beyond, whether or not that side is an edge of a rim: on which
        side of it the place is put by rounding tells nothing.
        """
        side = 3 * triangle[:, None] + np.arange(3)
        heights = self._heights(places_m[index], side)
        beside = self._mesh.neighbors.astype(np.int64)
        on, k = np.nonzero((heights <= self._slack_m) & (beside[triangle] >= 0))
        beyond = beside[triangle[on], k]
        pair, turn = np.nonzero(beside[beyond] != triangle[on, None])
        return (
            np.append(np.repeat(index, 3), index[on[pair]]),
            np.append(side.ravel(), 3 * beyond[pair] + turn),
        )

    def _heights(self, places_m: FloatArray, side: IntArray) -> FloatArray:
        """How far places, (N, 2), are inwards of the sides (N, 3) of a triangle each, shape (N, 3)."""
        right, left = self._corners_m[self._right[side]], self._corners_m[self._left[side]]
        x, y = np.moveaxis(left - right, 2, 0)
        to = places_m[:, None] - right
        heights: FloatArray = (x * to[..., 1] - y * to[..., 0]) / np.hypot(x, y)
        return heights

    def _triangle_at(self, places_m: FloatArray) -> IntArray:
        """The triangle that each place lies in, but for rounding."""
        _, nearest = self._tree.query(places_m)
        triangle = self._round[self._first_round[self._vertex[nearest]]] // 3
        open_, beside = np.arange(len(places_m)), self._mesh.neighbors
        for _ in range(len(beside)):
            side = 3 * triangle[open_, None] + np.arange(3)
            heights = self._heights(places_m[open_], side)
            # Towards the place: among triangles of Delaunay that ends.
            beyond = beside[triangle[open_], heights.argmin(axis=1)]
            on = (heights.min(axis=1) < 0.0) & (beyond >= 0)
            open_, beyond = open_[on], beyond[on]
            if not len(open_):
                break
            triangle[open_] = beyond
        return triangle

    @cached_property
    def _tree(self) -> cKDTree:
        return cKDTree(self._corners_m)

    def _wedges(self, corners: IntArray) -> list[tuple[_Points, _Points]]:
        """The right and the left ends of both wedges at each corner in which its edges lie on one side of a way."""
        ahead, back = (self._points[ends[corners]] - self._points[corners] for ends in (self._following, self._before))
        turned = ~_turns_left(ahead, -back)
        right, left = np.where(turned, -back, ahead), np.where(turned, ahead, -back)
        # Wider than cones along the same edges: to see which end is farther out takes more than rounding.
        (right, _), (_, left) = self._beside(right, 2.0), self._beside(left, 2.0)
        return [(right, left), (-right, -left)]

    @cached_property
    def _before(self) -> IntArray:
        """The corner at which the edge begins that ends at each one."""
        before = np.empty_like(self._following)
        before[self._following] = np.arange(len(before))
        return before

    def _cones(self, places: _Points, start: IntArray, side: IntArray) -> _Cones:
        """From places through the whole of sides."""
        right, _ = self._beside(self._points[self._right[side]] - places[start])
        _, left = self._beside(self._points[self._left[side]] - places[start])
        # Of a cone that is wider than a half turn, both halves.
        wide = np.flatnonzero(~_turns_left(right, left))
        ahead = 1j * (self._points[self._right[side]] - self._points[self._left[side]])[wide]
        halves = _Cones(start[wide], side[wide], ahead, left[wide])
        left[wide] = ahead
        return _joined([_Cones(start, side, right, left), halves])

    def _seen(self, places: _Points, cones: _Cones) -> tuple[IntArray, IntArray]:
        """What is seen from places in cones, and the ends of the sides that they begin with."""
        ends = [cones.start * len(self._vertex) + ends[cones.side] for ends in (self._right, self._left)]
        pairs = np.concatenate([*ends, *self._expanded(places, cones)])
        index, vertex = pairs // len(self._vertex), pairs % len(self._vertex)
        pair, place = ranges(self._first_corner[vertex], self._first_corner[vertex + 1])
        return index[pair], self._corner[place]

    def _expanded(self, places: _Points, waiting: _Cones) -> Iterator[IntArray]:
        """Keys of places and vertices that are seen beyond sides."""
        waiting = waiting._replace(side=self._beyond[waiting.side])
        waiting = waiting.of(waiting.side >= 0)
        begun, cones = 0, waiting.of(_NOTHING)
        while len(cones.side) or begun < len(waiting.side):
            room = _AT_ONCE - len(cones.side)
            if room > _AT_ONCE // 4:
                # As cones end, others begin: the few that are long do not go on alone, again and again.
                cones = _joined([cones, waiting.of(slice(begun, begun + room))])
                begun += room
            start, side, right, left = cones
            vertex = self._opposite[side]
            to_right, to_left = self._beside(self._points[vertex] - places[start])
            passes_left, passes_right = _turns_left(right, to_left), _turns_left(to_right, left)
            yield (start * len(self._vertex) + vertex)[passes_left & passes_right]
            # On both sides of the vertex the cones go on.
            on_right, on_left = self._right_beyond[side], self._left_beyond[side]
            first, second = np.flatnonzero(passes_left & (on_right >= 0)), np.flatnonzero(passes_right & (on_left >= 0))
            narrow_right, narrow_left = np.where(passes_left, to_right, right), np.where(passes_right, to_left, left)
            cones = _joined(
                [
                    _Cones(start[first], on_right[first], right[first], narrow_left[first]),
                    _Cones(start[second], on_left[second], narrow_right[second], left[second]),
                ]
            )

    def _beside(self, to: _Points, times: float = 1.0) -> tuple[_Points, _Points]:
        """Ways to places, a little turned: to pass them by the slack, or some times it, on their right and left."""
        aside = to * (1j * times * self._slack_m / np.abs(to))
        return to - aside, to + aside


def _within(cones: _Cones, right: _Points, left: _Points) -> _Cones:
    """What of cones lies in wedges of the places that they begin at, by their right and their left ends.

    A wedge of more than a half turn takes nothing away.
    """
    right, left = right[cones.start], left[cones.start]
    every = ~_turns_left(right, left)
    from_right = every | (_turns_left(right, cones.right) & _turns_left(cones.right, left))
    to_left = every | (_turns_left(right, cones.left) & _turns_left(cones.left, left))
    meets = from_right | (_turns_left(cones.right, right) & _turns_left(right, cones.left))
    meets &= to_left | (_turns_left(cones.right, left) & _turns_left(left, cones.left))
    right, left = np.where(from_right, cones.right, right), np.where(to_left, cones.left, left)
    return cones._replace(right=right, left=left).of(meets)


def _joined(cones: Sequence[_Cones]) -> _Cones:
    return _Cones(*map(np.concatenate, zip(*cones, strict=True)))


def _complex(points_m: FloatArray) -> _Points:
    points: _Points = np.ascontiguousarray(points_m, dtype=np.float64).view(np.complex128)[:, 0]
    return points


def _turns_left(one: _Points, other: _Points) -> BoolArray:
    turned: BoolArray = (one.conj() * other).imag >= 0.0
    return turned


def _keys(begins: IntArray, ends: IntArray, count: int) -> IntArray:
    """One number for each pair, the same both ways."""
    keys: IntArray = np.minimum(begins, ends) * np.int64(count) + np.maximum(begins, ends)
    return keys


def ranges(begins: IntArray, ends: IntArray) -> tuple[IntArray, IntArray]:
    """All numbers from begins on that are less than ends, and of which pair each is."""
    counts = ends - begins
    pair = np.repeat(np.arange(len(counts)), counts)
    return pair, begins[pair] + np.arange(len(pair)) - np.repeat(np.cumsum(counts) - counts, counts)
