"""Which corners of free space may be seen from where: cones of sight go on from triangle to triangle, all at once.

The triangles are those of Delaunay between all corners; a cone ends at sides that are edges of rims. An edge that is no
side stops none, and cones are a hair too wide: all that is seen is found, and some that is not (after the expansion of
triangles by Bungiu et al., "Efficient computation of visibility polygons", 2014).
"""

from typing import Final

import numpy as np
from scipy.spatial import Delaunay

from mission.geometry.arrays import BoolArray, FloatArray, IntArray

_AT_ONCE: Final = 4096
"""Places that are looked from together: bounds the memory."""


class Sights:
    """What may be seen of the corners of a free space.

    Args:
        corners_m: Shape (K, 2), all corners of its rims.
        following: Shape (K,), the corner at which the edge that begins at each one ends.
        slack_m: How far beyond a corner a line of sight may go.
    """

    def __init__(self, corners_m: FloatArray, following: IntArray, slack_m: float) -> None:
        self._corners_m, self._slack_m = corners_m, slack_m
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
        self._beyond = np.where(rim | (beside.ravel() < 0), -1, (3 * beside + back).ravel())
        self._round = np.argsort(self._opposite, kind="stable")
        self._first_round = np.searchsorted(self._opposite[self._round], np.arange(count + 1))

    def from_corners(self, corners: IntArray) -> tuple[IntArray, IntArray]:
        """Pairs of an index into some corners and the number of a corner that may be seen from there; some repeat."""
        vertex = self._vertex[corners]
        index, place = _ranges(self._first_round[vertex], self._first_round[vertex + 1])
        return self._seen(self._corners_m[vertex], index, self._round[place])

    def from_places(self, places_m: FloatArray) -> tuple[IntArray, IntArray]:
        """Pairs of an index into places, shape (N, 2), in free space and a corner seen there; some repeat."""
        triangle = self._triangle_at(places_m)
        corners = self._opposite.reshape(-1, 3)[triangle]
        apart = np.hypot(*np.moveaxis(self._corners_m[corners] - places_m[:, None], 2, 0))
        here = apart.min(axis=1) <= 0.5 * self._slack_m
        at, other = np.flatnonzero(here), np.flatnonzero(~here)
        first, seen = self._seen(places_m, *self._sides_round(places_m, other, triangle[other]))
        corner = corners[at, apart[at].argmin(axis=1)]  # as from there
        second, also = self.from_corners(corner)
        return np.concatenate((first, at[second], at)), np.concatenate((seen, also, corner))

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
        triangle = np.zeros(len(places_m), dtype=np.int64)
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

    def _seen(self, places_m: FloatArray, index: IntArray, side: IntArray) -> tuple[IntArray, IntArray]:
        """What is seen from places through sides, and their own ends."""
        found = [np.concatenate([index * len(self._vertex) + ends[side] for ends in (self._right, self._left)])]
        for begin in range(0, len(places_m), _AT_ONCE):
            these = (index >= begin) & (index < begin + _AT_ONCE)
            found.extend(self._expanded(places_m, index[these], side[these]))
        pairs = np.concatenate(found)
        index, vertex = pairs // len(self._vertex), pairs % len(self._vertex)
        pair, place = _ranges(self._first_corner[vertex], self._first_corner[vertex + 1])
        return index[pair], self._corner[place]

    def _expanded(self, places_m: FloatArray, index: IntArray, side: IntArray) -> list[IntArray]:
        """Keys of places and vertices that are seen beyond sides."""
        found: list[IntArray] = []
        right, _ = self._beside(places_m[index], self._right[side])
        _, left = self._beside(places_m[index], self._left[side])
        # Of a cone that is wider than a half turn, both halves.
        wide = np.flatnonzero(~_turns_left(right, left))
        along = (self._corners_m[self._right[side]] - self._corners_m[self._left[side]])[wide]
        ahead = np.stack((-along[:, 1], along[:, 0]), axis=1)
        index, side = np.append(index, index[wide]), np.append(side, side[wide])
        right, left = np.concatenate((right, ahead)), np.concatenate((left, left[wide]))
        left[wide] = ahead
        while True:
            side = self._beyond[side]
            open_ = np.flatnonzero(side >= 0)
            if not len(open_):
                return found
            index, side, right, left = index[open_], side[open_], right[open_], left[open_]
            vertex = self._opposite[side]
            to_right, to_left = self._beside(places_m[index], vertex)
            passes_left, passes_right = _turns_left(right, to_left), _turns_left(to_right, left)
            found.append((index * len(self._vertex) + vertex)[passes_left & passes_right])
            # On both sides of the vertex the cones go on; turned as from the side entered, its right end is second.
            triangle, k = side - side % 3, side % 3
            through_right, through_left = triangle + (k + 1) % 3, triangle + (k + 2) % 3
            narrow_left = np.where(passes_right[:, None], to_left, left)
            narrow_right = np.where(passes_left[:, None], to_right, right)
            first, second = np.flatnonzero(passes_left), np.flatnonzero(passes_right)
            index = np.concatenate((index[first], index[second]))
            side = np.concatenate((through_right[first], through_left[second]))
            right, left = (
                np.concatenate((right[first], narrow_right[second])),
                np.concatenate((narrow_left[first], left[second])),
            )

    def _beside(self, places_m: FloatArray, vertex: IntArray) -> tuple[FloatArray, FloatArray]:
        """The directions that pass a vertex by the slack on its right, and on its left."""
        to = self._corners_m[vertex] - places_m
        aside = to * (self._slack_m / np.hypot(*to.T))[:, None]
        aside = np.stack((-aside[:, 1], aside[:, 0]), axis=1)
        return to - aside, to + aside


def _turns_left(one: FloatArray, other: FloatArray) -> BoolArray:
    turned: BoolArray = one[:, 0] * other[:, 1] - one[:, 1] * other[:, 0] >= 0.0
    return turned


def _keys(begins: IntArray, ends: IntArray, count: int) -> IntArray:
    """One number for each pair, the same both ways."""
    keys: IntArray = np.minimum(begins, ends) * np.int64(count) + np.maximum(begins, ends)
    return keys


def _ranges(begins: IntArray, ends: IntArray) -> tuple[IntArray, IntArray]:
    """All numbers from begins on that are less than ends, and of which pair each is."""
    counts = ends - begins
    pair = np.repeat(np.arange(len(counts)), counts)
    return pair, begins[pair] + np.arange(len(pair)) - np.repeat(np.cumsum(counts) - counts, counts)
