"""Where the tube is: whether the triangles that a plan names for each piece of its curve are all that it may touch.

A patch and the square of the tube round it lie in the convex hull of the control points moved by the square's corners.
What that hull meets is decided by the exact predicates of GEOS. Where a hull meets more than the plan names, its patch
is halved: hulls come as near to the tube as one likes.
"""

from collections.abc import Callable
from typing import Final

import numpy as np
import shapely

from mission.geometry.arrays import BoolArray, FloatArray, IntArray
from mission.geometry.bernstein import undecided
from mission.geometry.location import Locator
from mission.geometry.simplices import Partition
from mission.verify.plans.patches import ROUNDING, Patches

_HONEST: Final = 0.97  # a bound that is told is no farther from the truth
_FEW: Final = 8  # halvings, after which it is not known to be dishonest
Met = tuple[IntArray, IntArray, BoolArray]
"""Pairs of a shape and a triangle that meet, and which shapes (K,) may reach beyond the domain."""

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
        self._locator = Locator(partition)
        self.closed = shapely.union_all(shapely.polygons(partition.corners_m[restricted]))

    def met(self, shapes: np.ndarray) -> Met:
        """What shapes (K,) meet."""
        which, triangles = self._locator.tree.query(shapes, predicate="intersects")
        outside = np.bincount(which, minlength=len(shapes)) == 0
        outside[self._locator.rim.query(shapes, predicate="intersects")[0]] = True
        return which, triangles, outside

    def met_at(self, places_m: FloatArray, half_m: float) -> Met:
        """What is met by squares round places (K, 2)."""
        half = half_m + self.slack_m
        return self.met(shapely.box(*(places_m - half).T, *(places_m + half).T))

    def distances_m(self, shapes: np.ndarray) -> FloatArray:
        """How far shapes (K,) are from what is restricted, shape (K,)."""
        return np.asarray(shapely.distance(shapes, self.closed))


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
    pairs = [piece * ground.size + np.array(named, dtype=np.int64) for piece, named in enumerate(sets)]
    instants, named = np.flatnonzero(np.diff(knots_s) == 0.0), np.unique(np.concatenate(pairs))

    def unnamed(piece: IntArray, which: IntArray, triangles: IntArray, outside: BoolArray) -> BoolArray:
        doubtful = outside.copy()
        doubtful[which[~np.isin(piece[which] * ground.size + triangles, named)]] = True
        return doubtful

    def strays(some: Patches) -> BoolArray:
        piece = np.searchsorted(knots_s, 0.5 * (some.begins_s + some.ends_s), side="right") - 1
        return unnamed(np.clip(piece, 0, len(sets) - 1), *ground.met(hulls(some, half_m)))

    at_instants = ground.met_at(patches.at(knots_s[instants]), half_m + float(patches.off[:, 0].max()))
    if unnamed(instants, *at_instants).any():
        return "may leave the triangles that are named at one of the instants"
    left = undecided(patches.cut(knots_s), strays)
    if not len(left):
        return None
    first = left.taken(np.arange(1))
    _, triangles, outside = ground.met(hulls(first, half_m))
    closed = ground.restricted[triangles].any()
    what = "meet what must not be entered" if closed else "leave the triangles that are named"
    where = "({:.2f}, {:.2f})".format(*first.control_m[0, 0])
    return f"may {'leave the domain' if outside[0] else what} near {where}"


def far_enough(ground: Ground, patches: Patches, claimed_m: float) -> str | None:
    """Whether a curve keeps a distance from what is restricted, and not much more than that; None where it does."""

    def nearer(metres: float) -> Callable[[Patches], BoolArray]:
        return lambda some: ground.distances_m(hulls(some, 0.0)) < metres

    left, honest_m = undecided(patches, nearer(claimed_m)), claimed_m / _HONEST + 1e-5 * patches.size_m
    if len(left):
        reached = ground.distances_m(shapely.points(left.control_m[:, 0])).min()
        return f"is {claimed_m:.9g} m in the plan, and {reached:.9g} m at one place"
    if not len(undecided(patches, nearer(honest_m), _FEW)):
        return f"is {claimed_m:.9g} m in the plan, and more than {honest_m:.9g} m everywhere"
    return None
