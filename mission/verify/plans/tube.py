"""Where the tube is: whether the triangles that a plan names for each piece of its curve are all that it may touch.

A patch and the square of the tube round it lie in the convex hull of the control points moved by the square's corners.
What that hull meets is decided by the exact predicates of GEOS. Where a hull meets more than the plan names, its patch
is halved: hulls come as near to the tube as one likes.
"""

from typing import Final

import numpy as np
import shapely

from mission.geometry.arrays import BoolArray, FloatArray, IntArray
from mission.geometry.simplices import Partition
from mission.verify.plans.patches import ROUNDING, Patches

_ROUNDS: Final = 40
_CLOSER: Final = 6  # halvings
_MUCH_CLOSER: Final = 10  # more of them, of patches with an end at which the tube meets nothing
_MOST_OPEN: Final = 4096  # patches that are looked into at a time, at least
_TIGHT: Final = 0.98
_HONEST: Final = 0.97  # a bound that is told is no farther from the truth
_CORNERS: Final = np.array([(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)])


class Ground:
    """The triangles of a domain, to be asked what meets them.

    Args:
        partition: The triangles.
        restricted: Shape (M,), those that must not be met.
    """

    def __init__(self, partition: Partition, restricted: BoolArray) -> None:
        self.size, self.restricted = partition.size, restricted
        self.slack_m = ROUNDING * max(1.0, float(np.abs(partition.vertices_m).max()))
        self._triangles = shapely.STRtree(shapely.polygons(partition.corners_m))
        rim, facet = np.nonzero(partition.neighbours < 0)
        ends = np.stack([partition.corners_m[rim, (facet + step) % 3] for step in (1, 2)], axis=1)
        self._rim = shapely.STRtree(shapely.linestrings(ends))
        self._closed = shapely.union_all(shapely.polygons(partition.corners_m[restricted]))

    def met(self, shapes: np.ndarray) -> tuple[IntArray, IntArray, BoolArray]:
        """Pairs of a shape and a triangle that meet, and which shapes (K,) may reach beyond the domain."""
        which, triangles = self._triangles.query(shapes, predicate="intersects")
        outside = np.bincount(which, minlength=len(shapes)) == 0
        outside[self._rim.query(shapes, predicate="intersects")[0]] = True
        return which, triangles, outside

    def distances_m(self, shapes: np.ndarray) -> FloatArray:
        """How far shapes (K,) are from what is restricted, shape (K,)."""
        return np.asarray(shapely.distance(shapes, self._closed))


def hulls(patches: Patches, half_m: float) -> np.ndarray:
    """Convex shapes (K,), each of which holds a patch and the square of a tube round it."""
    half = half_m + patches.off[:, 0] + ROUNDING * patches.size_m
    points = patches.control_m[:, :, None] + half[:, None, None, None] * _CORNERS
    which = np.repeat(np.arange(len(points)), points.shape[1] * 4)
    return np.asarray(shapely.convex_hull(shapely.multipoints(points.reshape(-1, 2), indices=which)))


def stray(ground: Ground, patches: Patches, half_m: float, knots_s: FloatArray, sets: list[list[int]]) -> str | None:
    """Where the tube may meet a triangle that is not named, or leave the domain; None where it surely does not.

    Args:
        ground: The domain.
        patches: The curve.
        half_m: Half width of the tube.
        knots_s: Shape (K + 1,), ends of the pieces, some of which may be instants.
        sets: The triangles that are named for each of the K pieces.
    """
    size = ground.size
    named = np.unique(np.concatenate([k * size + np.array(sets[k], dtype=np.int64) for k in range(len(sets))]))
    instants = np.flatnonzero(np.diff(knots_s) == 0.0)
    points, half = patches.at(knots_s[instants]), half_m + float(patches.off[:, 0].max()) + ground.slack_m
    which, triangles, outside = ground.met(shapely.box(*(points - half).T, *(points + half).T))
    if outside.any() or not np.isin(instants[which] * size + triangles, named).all():
        return "may leave the triangles that are named at one of the instants"
    patches = patches.cut(knots_s)
    most = max(_MOST_OPEN, 2 * len(patches.begins_s))
    for _ in range(_ROUNDS):
        middles = 0.5 * (patches.begins_s + patches.ends_s)
        piece = np.clip(np.searchsorted(knots_s, middles, side="right") - 1, 0, len(sets) - 1)
        which, triangles, doubtful = ground.met(hulls(patches, half_m))
        doubtful[which[~np.isin(piece[which] * size + triangles, named)]] = True
        if not doubtful.any():
            return None
        where, open_piece = patches.taken(np.flatnonzero(doubtful)[:1]), piece[doubtful]
        if doubtful.sum() > most or _surely(ground, patches.taken(doubtful), half_m, open_piece, named):
            break
        patches = patches.taken(doubtful).halves()
    _, met, outside = ground.met(hulls(where, half_m))
    what = "meet what must not be entered" if ground.restricted[met].any() else "leave the triangles that are named"
    east, north = where.control_m[0, 0].tolist()
    return f"may {'leave the domain' if outside[0] else what} near ({east:.2f}, {north:.2f}), {where.begins_s[0]:.2f} s"


def _surely(ground: Ground, patches: Patches, half_m: float, piece: IntArray, named: IntArray) -> bool:
    """Whether the square of the tube certainly meets what is not named, where one of the patches begins."""
    half = half_m - 2.0 * (float(patches.off[:, 0].max()) + ground.slack_m)
    if half <= 0.0:
        return False
    points = patches.control_m[:, 0]
    which, triangles, outside = ground.met(shapely.box(*(points - half).T, *(points + half).T))
    return bool(outside.any() or not np.isin(piece[which] * ground.size + triangles, named).all())


def touching(ground: Ground, patches: Patches, half_m: float, triangles: BoolArray) -> list[tuple[float, float]]:
    """The stretches of a curve outside of which its tube meets none of some triangles, marked in an array (M,)."""
    begins, ends = [np.empty(0)], [np.empty(0)]
    half = half_m + ground.slack_m
    for closer in range(_CLOSER + _MUCH_CLOSER):
        which, met, _ = ground.met(hulls(patches, half_m))
        patches = patches.taken(np.unique(which[triangles[met]]))
        if closer >= _CLOSER:
            places = patches.control_m[:, [0, -1]].reshape(-1, 2)
            which, met, _ = ground.met(shapely.box(*(places - half).T, *(places + half).T))
            touched = np.isin(np.arange(len(places)), which[triangles[met]])
            whole: BoolArray = touched[::2] & touched[1::2]
            begins, ends = [*begins, patches.begins_s[whole]], [*ends, patches.ends_s[whole]]
            patches = patches.taken(~whole)
        if not len(patches.begins_s):
            break
        patches = patches.halves()
    first, last = (np.concatenate(each) for each in ([*begins, patches.begins_s], [*ends, patches.ends_s]))
    order = np.argsort(first)
    first, last = first[order], last[order]
    if not len(first):
        return []
    apart = np.flatnonzero(first[1:] > last[:-1])
    return list(
        zip(first[np.append(0, apart + 1)].tolist(), last[np.append(apart, len(last) - 1)].tolist(), strict=True)
    )


def far_enough(ground: Ground, patches: Patches, claimed_m: float) -> str | None:
    """Whether a curve keeps a distance from what is restricted, and not much more than that; None where it does."""
    reached, open_patches = np.inf, patches
    for _ in range(_ROUNDS):
        lower = ground.distances_m(hulls(open_patches, 0.0))
        reached = min(reached, float(ground.distances_m(shapely.points(open_patches.control_m[:, 0])).min()))
        loose = lower < max(claimed_m, _TIGHT * reached)
        if reached < claimed_m or loose.sum() > _MOST_OPEN:
            return f"is {claimed_m:.9g} m in the plan, and {reached:.9g} m at one place"
        if not loose.any():
            break
        open_patches = open_patches.taken(loose).halves()
    if claimed_m < _HONEST * reached - 1e-5 * patches.size_m:
        return f"is {claimed_m:.9g} m in the plan, and more than {_TIGHT * reached:.9g} m everywhere"
    return None
