"""Convex cells along a taut path, each wholly free: the corridor that a curve may use.

A cell begins as the rectangle round a straight stretch of the path, and is cut by the nearest border of what is in the
way, again and again, until no border lies in it: between two convex sets, here a stretch and a piece of the border, the
line across the shortest way between them separates them. Where the path touches a border, at its bends, the way has no
length; there the line runs between the stretch and the border, for at a bend of a taut path what is in the way lies
within the angle of the two stretches. At each bend a further cell lies between those of the stretches, bounded by the
line across the bisector of that angle: it holds what both have in common, and more.
"""

from dataclasses import dataclass
from typing import Final

import numpy as np
import shapely

from mission.geometry.arrays import BoolArray, FloatArray, frozen_floats

_STRAIGHT: Final = 1e-3  # of two unit vectors: what is less apart has one direction
_TOUCHING: Final = 1e-7  # of the coordinates: what is nearer than that touches


@dataclass(frozen=True, eq=False)
class Cell:
    """A convex polygon {x : n_i . x <= b_i}.

    Attributes:
        normals: Shape (m, 2), unit vectors.
        offsets_m: Shape (m,).
    """

    normals: FloatArray
    offsets_m: FloatArray

    def __post_init__(self) -> None:
        object.__setattr__(self, "normals", frozen_floats(self.normals))
        object.__setattr__(self, "offsets_m", frozen_floats(self.offsets_m))

    def holds(self, points_m: FloatArray, slack_m: float = 0.0) -> BoolArray:
        """Which points (P, 2) lie in the cell, widened by ``slack_m``, shape (P,)."""
        return np.asarray((points_m @ self.normals.T <= self.offsets_m + slack_m).all(axis=1))


def borders_of(free: shapely.Geometry) -> FloatArray:
    """The edges of an area, shape (E, 2, 2), each with the area on its left."""
    parts = shapely.get_parts(free)
    rings = shapely.get_rings(shapely.orient_polygons(parts[shapely.area(parts) > 0.0]))
    corners, ring = shapely.get_coordinates(rings, return_index=True)
    edges = np.stack((corners[:-1], corners[1:]), axis=1)[ring[:-1] == ring[1:]]
    return np.asfortranarray(edges)  # coordinates of one kind in a row: those near a stretch are looked for often


def cell_round(
    begin_m: FloatArray,
    end_m: FloatArray,
    borders_m: FloatArray,
    reach_m: float,
    *,
    across: FloatArray | None = None,
) -> Cell:
    """A convex cell that holds a straight stretch and none of the borders.

    Args:
        begin_m: Shape (2,), where the stretch begins; the stretch crosses no border.
        end_m: Shape (2,), where it ends; it may be the same.
        borders_m: Shape (E, 2, 2), as ``borders_of`` gives them.
        reach_m: How far the cell extends beyond the stretch, at most.
        across: Of a bend, shape (2,): the cell ends there, with this outward normal.
    """
    along = end_m - begin_m
    length = float(np.hypot(*along))
    direction = along / length if length > 0.0 else np.array([1.0, 0.0])
    side = np.array([-direction[1], direction[0]])
    normals = [direction, -direction, side, -side]
    offsets = [float(max(normal @ begin_m, normal @ end_m)) + reach_m for normal in normals]
    touching = _TOUCHING * (1.0 + float(np.abs(begin_m).max()))
    if across is not None:
        normals.append(across)
        offsets.append(float(across @ begin_m))
    whole = edges = _about(borders_m, begin_m, end_m, 2.0 * reach_m)
    for normal, offset in zip(normals, offsets, strict=True):
        whole, edges = _inside(whole, edges, normal, offset, touching)
    while len(edges):
        on_stretch, on_edge = _nearest(begin_m, end_m, edges)
        nearest = int(np.hypot(*(on_edge - on_stretch).T).argmin())
        start, stop = on_stretch[nearest], on_edge[nearest]
        if (edges[nearest] != whole[nearest]).any():
            # What was cut off of an edge that touches the stretch does not move it away.
            (start,), (stop,) = _nearest(begin_m, end_m, whole[nearest : nearest + 1])
        if np.hypot(*(stop - start)) > touching:
            way = on_edge[nearest] - on_stretch[nearest]
            normal = way / np.hypot(*way)
            offset = float(normal @ on_edge[nearest])
        else:
            normal = _away(side if length > 0.0 else None, np.stack((begin_m, end_m)), whole[nearest], touching)
            offset = float(max(normal @ begin_m, normal @ end_m))
        normals.append(normal)
        offsets.append(offset)
        rest = np.arange(len(edges)) != nearest
        whole, edges = _inside(whole[rest], edges[rest], normal, offset, touching)
    return Cell(np.array(normals), np.array(offsets))


def _about(borders_m: FloatArray, begin_m: FloatArray, end_m: FloatArray, reach_m: float) -> FloatArray:
    """The edges in whose boxes something is nearer than that to the box of a stretch: most are far from it."""
    about = np.arange(len(borders_m))
    for axis in (0, 1):
        low, high = min(begin_m[axis], end_m[axis]) - reach_m, max(begin_m[axis], end_m[axis]) + reach_m
        begins, ends = (borders_m[:, end, axis] if axis == 0 else borders_m[about, end, axis] for end in (0, 1))
        about = about[(np.maximum(begins, ends) >= low) & (np.minimum(begins, ends) <= high)]
    return np.ascontiguousarray(borders_m[about])


def _away(side: FloatArray | None, ends_m: FloatArray, edge: FloatArray, touching: float) -> FloatArray:
    """The normal of a line that separates a stretch, with its own normal, from an edge that touches it.

    Where only one end of the stretch touches one of the edge, it is the line in the middle of the angle between both.
    """
    along = edge[1] - edge[0]
    right: FloatArray = np.array([along[1], -along[0]]) / np.hypot(*along)
    if side is None:
        return right
    near = np.hypot(*(edge[:, None] - ends_m[None]).transpose(2, 0, 1)) <= touching  # (edge's end, stretch's end)
    if near.sum() == 1:
        of_edge, of_stretch = np.argwhere(near)[0]
        place = ends_m[of_stretch]
        onward, away = ends_m[1 - of_stretch] - place, edge[1 - of_edge] - place
        between = away / np.hypot(*away) - onward / np.hypot(*onward)
        if np.hypot(*between) > _STRAIGHT:
            return np.asarray(between / np.hypot(*between))
    heights = (edge - ends_m[0]) @ side
    if heights.min() >= -touching and heights.max() > touching:
        return side
    if heights.max() <= touching and heights.min() < -touching:
        return -side
    return right


def _inside(
    whole: FloatArray, edges: FloatArray, normal: FloatArray, offset: float, touching: float
) -> tuple[FloatArray, FloatArray]:
    """The edges (E, 2, 2) that reach deeper than ``touching`` into a half plane, whole and what of them does."""
    heights = edges @ normal - (offset - touching)
    kept = np.minimum(heights[:, 0], heights[:, 1]) < 0.0
    whole, edges, heights = whole[kept], edges[kept], heights[kept]
    crossing = np.maximum(heights[:, 0], heights[:, 1]) > 0.0
    if crossing.any():
        edges = edges.copy()
        low, high = heights[crossing, 0], heights[crossing, 1]
        cut = edges[crossing, 0] + (low / (low - high))[:, None] * (edges[crossing, 1] - edges[crossing, 0])
        ends = edges[crossing]
        ends[low > 0.0, 0] = cut[low > 0.0]
        ends[high > 0.0, 1] = cut[high > 0.0]
        edges[crossing] = ends
    return whole, edges


def _nearest(begin_m: FloatArray, end_m: FloatArray, edges: FloatArray) -> tuple[FloatArray, FloatArray]:
    """The nearest points of a stretch and of each edge (E, 2, 2) that it does not cross, each (E, 2)."""
    ends = np.stack((begin_m, end_m))
    along, legs = end_m - begin_m, edges[:, None, 1] - edges[:, None, 0]
    # Of both ends of each edge the nearest points of the stretch, and of both ends of the stretch those of each edge.
    on_stretch = begin_m + _share(edges - begin_m, along)[..., None] * along
    on_edge = edges[:, None, 0] + _share(ends - edges[:, None, 0], legs)[..., None] * legs
    on_stretch = np.concatenate((on_stretch, np.broadcast_to(ends, edges.shape)), axis=1)
    on_edge = np.concatenate((edges, on_edge), axis=1)
    apart = on_edge - on_stretch
    best = np.sqrt(apart[..., 0] ** 2 + apart[..., 1] ** 2).argmin(axis=1)
    index = np.arange(len(edges))
    return on_stretch[index, best], on_edge[index, best]


def _share(away: FloatArray, along: FloatArray) -> FloatArray:
    """How far along stretches the feet of points lie, from 0 to 1; both as vectors from where the stretches begin."""
    squares = along[..., 0] ** 2 + along[..., 1] ** 2
    far = away[..., 0] * along[..., 0] + away[..., 1] * along[..., 1]
    shares: FloatArray = np.clip(np.divide(far, squares, out=np.zeros_like(far), where=squares > 0.0), 0.0, 1.0)
    return shares
