"""Where a text fits: the largest box inside a triangle in closed form, and places for names that hide nothing."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import shapely
from shapely.geometry.base import BaseGeometry

from mission.geometry.arrays import BoolArray, FloatArray

GRID = 25
RIM_POINTS, DIRECTIONS = 40, 16
GAPS_EM = (0.5, 1.0, 1.8, 3.0, 4.5)  # between an outline and a name beside it
BOX_MARGIN_EM = (0.25, 0.1)
DEEP = 0.95
LEADER_INTO_SHAPE = 0.3


@dataclass(frozen=True)
class Placed:
    """A text with its centre in the domain's frame (metres) and its size in points.

    Attributes:
        leader_m: Where a thin line from the text ends, for a text that stands beside what it names; None inside.
        size_em: Width and height in units of the font size.
    """

    text: str
    size_pt: float
    x_m: float
    y_m: float
    leader_m: tuple[float, float] | None = None
    size_em: tuple[float, float] = (0.0, 0.0)

    def box(self, em_m: float) -> BaseGeometry:
        """The rectangle that it takes."""
        at = np.array([self.x_m]), np.array([self.y_m])
        return boxes_at(*at, self.size_em, em_m * self.size_pt)[0]


def largest_boxes(corners_m: FloatArray, sizes: FloatArray) -> tuple[FloatArray, FloatArray]:
    """The largest upright box of given proportions inside each triangle.

    A box of width s w and height s h with centre c lies in the triangle where n_j . c + s (|n_jx| w + |n_jy| h) / 2
    <= b_j for its three outward normals n_j. At the largest s all three hold with equality: a linear system in (c, s).

    Args:
        corners_m: Shape (M, 3, 2), counter-clockwise.
        sizes: Shape (M, 2): w and h of each box, any unit.

    Returns:
        Centres, shape (M, 2), in metres; scales s, shape (M,), in metres per unit of ``sizes``.
    """
    normals, offsets = _half_planes(corners_m)
    reach = 0.5 * np.einsum("mjk,mk->mj", np.abs(normals), sizes)
    solution = np.linalg.solve(np.concatenate((normals, reach[..., None]), axis=-1), offsets[..., None])[..., 0]
    return solution[:, :2], solution[:, 2]


def towards_incentres(corners_m: FloatArray, centres_m: FloatArray, boxes_m: FloatArray) -> FloatArray:
    """Move boxes that lie in triangles towards the incentres, as far as they stay inside.

    Args:
        corners_m: Shape (M, 3, 2), counter-clockwise.
        centres_m: Shape (M, 2), centres of the boxes.
        boxes_m: Shape (M, 2), widths and heights.
    """
    normals, offsets = _half_planes(corners_m)
    sides = np.linalg.norm(np.roll(corners_m, -1, axis=1) - np.roll(corners_m, -2, axis=1), axis=-1)
    incentres = np.einsum("mj,mjk->mk", sides, corners_m) / sides.sum(axis=-1, keepdims=True)
    ways = incentres - centres_m
    reach = 0.5 * np.einsum("mjk,mk->mj", np.abs(normals), boxes_m)
    slack = np.maximum(offsets - np.einsum("mjk,mk->mj", normals, centres_m) - reach, 0.0)
    speed = np.einsum("mjk,mk->mj", normals, ways)
    far = np.min(np.where(speed > 0, slack / np.where(speed > 0, speed, 1.0), 1.0), axis=-1)
    moved: FloatArray = centres_m + np.minimum(far, 1.0)[:, None] * ways
    return moved


def centre_of(shape: BaseGeometry) -> tuple[float, float]:
    """A point deep inside a polygon: of those of a fixed grid that are farthest from the edge, the most central."""
    points = _grid(shape)
    inside = shapely.contains_properly(shape, points)
    if not inside.any():
        point = shape.representative_point()
        return float(point.x), float(point.y)
    depth = np.where(inside, shapely.distance(shape.boundary, points), -1.0)
    off_centre = np.where(depth >= DEEP * depth.max(), np.round(shapely.distance(shape.centroid, points), 9), np.inf)
    best = points[int(np.argmin(off_centre))]
    return float(best.x), float(best.y)


def place_names(
    names: Sequence[tuple[str, BaseGeometry, tuple[float, float]]],
    *,
    em_m: float,
    sizes_pt: Sequence[float],
    obstacles: Sequence[BaseGeometry],
    frame: BaseGeometry | None,
    needed: bool = True,
) -> tuple[Placed, ...]:
    """Put each name inside its shape, off the obstacles and the other names; beside it with a leader where it must.

    The same arguments give the same places: candidates are tried in a fixed order, larger text first, nearer to the
    middle of the shape first.

    Args:
        names: Text, shape, and size of the text in em (width, height).
        em_m: Metres in the domain for one point of font size.
        sizes_pt: Font sizes to try, largest first.
        obstacles: What no name may cover.
        frame: Where names may stand beside their shapes; None leaves out what has no room inside.
        needed: Whether a name that has no room beside its shape either is put over it; else it is left out.
    """
    shapes = [shape for _, shape, _ in names]
    taken = list(obstacles)
    placed: dict[int, Placed] = {}
    for index in sorted(range(len(names)), key=lambda i: (shapes[i].area, i)):
        text, shape, size = names[index]
        blocked = shapely.STRtree(taken)
        spot = _inside(shape, size, em_m, sizes_pt, blocked)
        if spot is None:
            if frame is None:
                continue
            others = shapely.STRtree([*taken, *shapes])
            spot = _beside(shape, size, em_m, sizes_pt, blocked=others, frame=frame)
            if spot is None and not needed:
                continue
            spot = spot or _over(shape, sizes_pt)
        x, y, points, leader = spot
        placed[index] = Placed(text, points, x, y, leader, size)
        taken.append(placed[index].box(em_m))
    return tuple(placed[index] for index in sorted(placed))


_Spot = tuple[float, float, float, tuple[float, float] | None]


def _half_planes(corners_m: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Outward unit normals n and offsets b of n . x <= b, one a side, shapes (M, 3, 2) and (M, 3)."""
    edges = np.roll(corners_m, -1, axis=1) - corners_m
    normals = np.stack((edges[..., 1], -edges[..., 0]), axis=-1)
    normals /= np.linalg.norm(normals, axis=-1, keepdims=True)
    return normals, np.einsum("mjk,mjk->mj", normals, corners_m)


def _inside(
    shape: BaseGeometry, size: tuple[float, float], em_m: float, sizes_pt: Sequence[float], blocked: shapely.STRtree
) -> _Spot | None:
    middle = centre_of(shape)
    points = shapely.get_coordinates(_grid(shape))
    points = points[np.argsort(np.round(np.hypot(*(points - middle).T), 9), kind="stable")]
    points = np.concatenate(([middle], points))
    for size_pt in sizes_pt:
        boxes = boxes_at(points[:, 0], points[:, 1], size, em_m * size_pt)
        free = shapely.contains_properly(shape, boxes) & ~_hit(blocked, boxes)
        if free.any():
            x, y = points[int(np.argmax(free))]
            return float(x), float(y), size_pt, None
    return None


def _beside(
    shape: BaseGeometry,
    size: tuple[float, float],
    em_m: float,
    sizes_pt: Sequence[float],
    *,
    blocked: shapely.STRtree,
    frame: BaseGeometry,
) -> _Spot | None:
    """The free place nearest to the outline, and of those the one nearest to the middle."""
    middle = np.array(centre_of(shape))
    size_pt = sizes_pt[len(sizes_pt) // 2]
    step = em_m * size_pt
    outlines = [part.exterior for part in shapely.get_parts(shape)]
    along = np.linspace(0.0, 1.0, RIM_POINTS, endpoint=False)
    rim = np.concatenate(
        [shapely.get_coordinates(shapely.line_interpolate_point(each, along, normalized=True)) for each in outlines]
    )
    angles = 2 * np.pi * np.arange(DIRECTIONS) / DIRECTIONS
    directions = np.stack((np.cos(angles), np.sin(angles)), axis=-1)
    # Where the box touches a point of the outline with the side, or the corner, that faces it.
    touching = 0.5 * step * (np.array(size) + BOX_MARGIN_EM) * np.clip(np.sqrt(2.0) * directions, -1.0, 1.0)
    for gap in GAPS_EM:
        points = (rim[:, None] + touching + gap * step * directions).reshape(-1, 2)
        points = points[np.argsort(np.round(np.hypot(*(points - middle).T), 9), kind="stable")]
        boxes = boxes_at(points[:, 0], points[:, 1], size, step)
        free = shapely.contains_properly(frame, boxes) & ~_hit(blocked, boxes)
        if free.any():
            x, y = points[int(np.argmax(free))]
            edge = shapely.get_coordinates(shapely.shortest_line(shapely.Point(x, y), shape))[1]
            into = edge + LEADER_INTO_SHAPE * (middle - edge)
            end_x, end_y = into if shapely.contains(shape, shapely.Point(into)) else edge
            return float(x), float(y), size_pt, (float(end_x), float(end_y))
    return None


def _over(shape: BaseGeometry, sizes_pt: Sequence[float]) -> _Spot:
    x, y = centre_of(shape)
    return x, y, sizes_pt[-1], None


def boxes_at(x: FloatArray, y: FloatArray, size: tuple[float, float], unit_m: float) -> FloatArray:
    """Rectangles around centres, as shapely geometries, a little larger than the text that they stand for."""
    half_width, half_height = (0.5 * unit_m * (side + margin) for side, margin in zip(size, BOX_MARGIN_EM, strict=True))
    boxes: FloatArray = shapely.box(x - half_width, y - half_height, x + half_width, y + half_height)
    return boxes


def _grid(shape: BaseGeometry) -> FloatArray:
    west, south, east, north = shape.bounds
    x, y = np.meshgrid(np.linspace(west, east, GRID), np.linspace(south, north, GRID))
    points: FloatArray = shapely.points(x.ravel(), y.ravel())
    return points


def _hit(blocked: shapely.STRtree, boxes: FloatArray) -> BoolArray:
    """Which boxes meet something in the tree."""
    hits = np.zeros(len(boxes), dtype=np.bool_)
    hits[blocked.query(boxes, predicate="intersects")[0]] = True
    return hits
