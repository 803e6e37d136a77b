"""Cells of a grid that lie as a whole in what is in the way: ways through them are not free, and that is told at once.

Among very many obstacles most straight ways between corners are not free. A few samples of a way tell that, if of every
cell it is known whether it is solid: none of the rims comes into it, and its middle lies in a hole of free space.
"""

from typing import Final

import numpy as np

from mission.geometry.arrays import BoolArray, FloatArray, IntArray

_SIDE: Final = 0.15
"""Of the cells, as a part of the length whose square has one edge of rims."""
_SAMPLES: Final = (3, 8, 40)
"""Of a way; the more are taken of those only in which the fewer are not solid."""
_NONE: Final = -1
_IN_HOLE: Final = 2
"""Rings around a place in a hole: that of free space, and the hole's own."""


class SolidCells:
    """The solid cells of a free space.

    Args:
        begins_m: Shape (E, 2), where the edges of its rims begin.
        ends_m: Shape (E, 2), where they end.
        ring: Shape (E,), the ring of each edge.
        is_hole: Whether each ring is that of a hole.
    """

    def __init__(self, begins_m: FloatArray, ends_m: FloatArray, ring: IntArray, is_hole: BoolArray) -> None:
        low, high = begins_m.min(axis=0), begins_m.max(axis=0)
        self._side_m = max(_SIDE * float(np.sqrt((high - low).prod() / len(begins_m))), 1e-6)
        self._origin_m = low - self._side_m  # one more all round
        columns, rows = (np.ceil((high - low) / self._side_m).astype(np.int64) + 3).tolist()
        begins, ends = ((points - self._origin_m) / self._side_m for points in (begins_m, ends_m))
        around, hole = _rings_around(begins, ends, ring, is_hole, (rows, columns))
        solid = (around == _IN_HOLE) & ~_crossed(begins, ends, (rows, columns))
        self._ring = np.where(solid, hole, _NONE)

    def met(self, begins_m: FloatArray, ends_m: FloatArray) -> tuple[IntArray, IntArray]:
        """Of straight ways between free places, shapes (N, 2), those that are seen to be not free, and a ring of each.

        Returns:
            The numbers of ways, ascending, and of rings; ways that are not among them may not be free either.
        """
        begins, ends = ((points - self._origin_m) / self._side_m for points in (begins_m, ends_m))
        ring = np.full(len(begins), _NONE, dtype=np.int64)
        for count in _SAMPLES:
            open_ = np.flatnonzero(ring == _NONE)
            shares = ((np.arange(count) + 0.5) / count)[:, None]
            cells = (begins[open_, None] + shares * (ends - begins)[open_, None]).astype(np.int64)
            ring[open_] = self._ring[cells[..., 1], cells[..., 0]].max(axis=1)
        met = np.flatnonzero(ring != _NONE)
        return met, ring[met]


def _rings_around(
    begins: FloatArray, ends: FloatArray, ring: IntArray, is_hole: BoolArray, shape: tuple[int, int]
) -> tuple[IntArray, IntArray]:
    """How many rings are around the middle of each cell, and which hole's, if there is one; in units of cells."""
    # An edge crosses the middles of the rows from ``first`` on: there one comes into its ring, or out of it.
    first, last = (np.ceil(each(begins[:, 1], ends[:, 1]) - 0.5).astype(np.int64) for each in (np.minimum, np.maximum))
    counts = last - first
    edge = np.repeat(np.arange(len(counts)), counts)
    row = first[edge] + np.arange(len(edge)) - np.repeat(np.cumsum(counts) - counts, counts)
    steps = ends - begins
    x = begins[edge, 0] + (row + 0.5 - begins[edge, 1]) * (steps[edge, 0] / steps[edge, 1])
    order = np.lexsort((x, ring[edge], row))
    row, x, ring = row[order], x[order], ring[edge][order]
    column = np.ceil(x - 0.5).astype(np.int64)
    sign = np.where(np.arange(len(row)) % 2 == 0, 1, -1)  # a ring is left as often in a row as it is entered
    around, hole = np.zeros(shape, dtype=np.int64), np.zeros(shape, dtype=np.int64)
    np.add.at(around, (row, column), sign)
    np.add.at(hole, (row, column), sign * np.where(is_hole[ring], ring, 0))
    return around.cumsum(axis=1), hole.cumsum(axis=1)


def _crossed(begins: FloatArray, ends: FloatArray, shape: tuple[int, int]) -> BoolArray:
    """The cells into which an edge comes, and some beside them; in units of cells."""
    counts = np.ceil(2.0 * np.abs(ends - begins).max(axis=1)).astype(np.int64) + 1
    edge = np.repeat(np.arange(len(counts)), counts)
    number = np.arange(len(edge)) - np.repeat(np.cumsum(counts) - counts, counts)
    share = number / np.maximum(counts - 1, 1)[edge]
    # Half a cell apart at most: what lies between two of them lies beside the cell of one.
    column, row = (begins[edge] + share[:, None] * (ends - begins)[edge]).astype(np.int64).T
    crossed = np.zeros(shape, dtype=np.bool_)
    for up in (-1, 0, 1):
        for right in (-1, 0, 1):
            crossed[row + up, column + right] = True
    return crossed
