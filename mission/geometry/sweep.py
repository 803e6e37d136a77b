"""What a square sweeps whose centre goes straight from place to place: where a vehicle in a tube may be.

Each step is looked at by itself, first by its bounding box, so that a way of an hour, over the same ground again and
again, is as soon done as its steps are counted.
"""

from typing import Final

import numpy as np
import shapely
from shapely.geometry.base import BaseGeometry

from mission.geometry.arrays import FloatArray

_CORNERS: Final = np.array([(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)])


class SweptSquare:
    """A square with sides along the axes, and where its centre goes."""

    def __init__(self, places_m: FloatArray, half_m: float) -> None:
        """Sweep a square of twice this side along straight steps between places, shape (N, 2), two or more."""
        self._places_m, self._half_m = places_m, half_m
        ends = np.stack([places_m[:-1], places_m[1:]])
        self._low_m, self._high_m = ends.min(axis=0) - half_m, ends.max(axis=0) + half_m

    def meets(self, ground: BaseGeometry) -> bool:
        """Whether anything of it touches a ground."""
        if ground.is_empty:
            return False
        west, south, east, north = ground.bounds
        near = ((self._low_m <= (east, north)) & (self._high_m >= (west, south))).all(axis=1)
        return bool(shapely.intersects(self._steps(near), ground).any())

    def stays_in(self, ground: BaseGeometry) -> bool:
        """Whether all of it is covered by a ground."""
        shapely.prepare(ground)
        boxes = shapely.box(*self._low_m.T, *self._high_m.T)
        return bool(shapely.covers(ground, self._steps(~shapely.covers(ground, boxes))).all())

    def _steps(self, which: np.ndarray[tuple[int], np.dtype[np.bool_]]) -> np.ndarray[tuple[int], np.dtype[np.object_]]:
        """What is swept in some of the steps, each a convex polygon."""
        offsets = self._half_m * _CORNERS
        before, after = (ends[which][:, None, :] + offsets for ends in (self._places_m[:-1], self._places_m[1:]))
        corners = np.concatenate([before, after], axis=1)
        hulls: np.ndarray[tuple[int], np.dtype[np.object_]] = shapely.convex_hull(shapely.multipoints(corners))
        return hulls
