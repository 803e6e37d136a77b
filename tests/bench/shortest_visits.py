"""Lower bounds of missions: the shortest path that visits what they ask for, and the time on it by the limits alone.

Independent of the planner: a fine visibility graph over the corners of what is in the way and points on the rims of
what is to be visited, each order of visits that a mission admits by itself. What is in the way grows by the clearance,
as a disc and not as the tube's square, and what is visited shrinks by it: both make the bound smaller, not larger.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import combinations, pairwise

import numpy as np
import shapely
from numpy.typing import NDArray
from scipy.sparse.csgraph import dijkstra

Floats = NDArray[np.float64]


@dataclass(frozen=True)
class Bound:
    """A shortest visiting path.

    Attributes:
        legs_m: The length from each visit to the next one.
        order: The names of what is visited.
    """

    legs_m: tuple[float, ...]
    order: tuple[str, ...]

    @property
    def length_m(self) -> float:
        return sum(self.legs_m)

    def duration_s(self, speed_m_s: float, acceleration_m_s2: float, holds_s: dict[str, float]) -> float:
        """The time on it where the vehicle rests only where it holds or turns round, and is slowed by nothing else."""
        rests, since = [], 0.0
        around = ["", *self.order, ""]
        for k, (name, leg_m) in enumerate(zip(self.order, self.legs_m, strict=True), start=1):
            since += leg_m
            # Between two visits of one region the path goes to and fro.
            if holds_s.get(name, 0.0) > 0.0 or around[k - 1] == around[k + 1]:
                rests.append(since)
                since = 0.0
        ways = [*rests, since]
        return sum(holds_s.get(name, 0.0) for name in self.order) + sum(
            _rest_to_rest_s(way, speed_m_s, acceleration_m_s2) for way in ways
        )


def _rest_to_rest_s(way_m: float, speed_m_s: float, acceleration_m_s2: float) -> float:
    ramp_m = speed_m_s**2 / acceleration_m_s2
    if way_m < ramp_m:
        return 2.0 * math.sqrt(way_m / acceleration_m_s2)
    return way_m / speed_m_s + speed_m_s / acceleration_m_s2


class Ground:
    """Where a path may be: a field without what is in the way, with a clearance from all borders.

    Args:
        field: What it must not leave.
        obstacles: What it must not enter.
        clearance_m: From both.
        apart_m: Distance of the points on rims.
    """

    def __init__(
        self, field: shapely.Geometry, obstacles: Sequence[shapely.Geometry], clearance_m: float, apart_m: float
    ) -> None:
        self._clearance_m, self._apart_m = clearance_m, apart_m
        kept = shapely.buffer(field, -clearance_m, join_style="mitre") if clearance_m else field
        grown = [shapely.buffer(shape, clearance_m, quad_segs=4) if clearance_m else shape for shape in obstacles]
        free = kept.difference(shapely.union_all(grown))
        self.corners = np.unique(shapely.get_coordinates(free), axis=0)
        self.free = shapely.buffer(free, 1e-6)
        shapely.prepare(self.free)
        among = self.seen(self.corners, self.corners)
        self._among = dijkstra(np.where(np.isfinite(among), among, 0.0))

    def rim(self, region: shapely.Geometry) -> Floats:
        """Points on the rim of what is left of a region."""
        inside = shapely.buffer(region, -self._clearance_m) if self._clearance_m else region
        points = [
            shapely.get_coordinates(ring.interpolate(np.arange(0.0, ring.length, self._apart_m)))
            for part in shapely.get_parts(inside)
            for ring in (part.exterior,)
        ]
        found = np.concatenate(points)
        return np.asarray(found[shapely.covers(self.free, shapely.points(found))])

    def seen(self, some: Floats, others: Floats) -> Floats:
        """Distances between points that see each other, infinite elsewhere."""
        pairs = np.stack(np.broadcast_arrays(some[:, None], others[None, :]), axis=2)
        lengths = np.linalg.norm(pairs[:, :, 0] - pairs[:, :, 1], axis=-1)
        lines = shapely.linestrings(pairs.reshape(-1, 2, 2))
        return np.where(shapely.covers(self.free, lines).reshape(lengths.shape), lengths, np.inf)

    def between(self, some: Floats, others: Floats) -> Floats:
        """Lengths of shortest ways."""
        over = np.stack([(row[:, None] + self._among).min(axis=0) for row in self.seen(some, self.corners)])
        to = self.seen(self.corners, others)
        around = np.stack([(row[:, None] + to).min(axis=0) for row in over])
        return np.asarray(np.minimum(self.seen(some, others), around))

    def shortest(self, start: Floats, order: Sequence[str], rims: dict[str, Floats]) -> Bound:
        """The shortest path through regions in an order."""
        places, best, steps = start[None], np.zeros(1), []
        for name in order:
            ways = self.between(places, rims[name])
            steps.append((ways, (best[:, None] + ways).argmin(axis=0)))
            best = (best[:, None] + ways).min(axis=0)
            places = rims[name]
        at, legs = int(best.argmin()), []
        for ways, before in reversed(steps):
            legs.append(float(ways[before[at], at]))
            at = int(before[at])
        return Bound(tuple(reversed(legs)), tuple(order))

    def connection_m(self, places: Sequence[Floats]) -> float:
        """How long a path is at least from the first of some sets of points to the last, through all others.

        In whatever order, and each set is left where that is best, wherever it was entered: Held and Karp's programme
        over sets ("A dynamic programming approach to sequencing problems", 1962).
        """
        apart = np.zeros((len(places), len(places)))
        for i, j in combinations(range(len(places)), 2):
            apart[i, j] = apart[j, i] = self.between(places[i], places[j]).min()
        inner = len(places) - 2
        best = np.full((1 << inner, inner), np.inf)
        best[1 << np.arange(inner), np.arange(inner)] = apart[0, 1:-1]
        for done in range(1, 1 << inner):
            for after in (k for k in range(inner) if not done >> k & 1):
                onward = (best[done] + apart[1:-1, 1 + after]).min()
                best[done | 1 << after, after] = min(best[done | 1 << after, after], onward)
        return float((best[-1] + apart[1:-1, -1]).min()) if inner else float(apart[0, -1])

    def tour(self, order: Sequence[str], rims: dict[str, Floats]) -> Bound:
        """The shortest round through regions in an order; its first leg leads from the last region to the first."""
        rounds = [*order, order[0]]
        ways = [self.between(rims[a], rims[b]) for a, b in pairwise(rounds)]
        best: tuple[float, list[float]] = (math.inf, [])
        for first in range(len(rims[order[0]])):
            reached, steps = np.where(np.arange(len(rims[order[0]])) == first, 0.0, np.inf), []
            for way in ways:
                steps.append((reached[:, None] + way).argmin(axis=0))
                reached = (reached[:, None] + way).min(axis=0)
            if reached[first] < best[0]:
                at, legs = first, []
                for way, before in zip(reversed(ways), reversed(steps), strict=True):
                    legs.append(float(way[before[at], at]))
                    at = int(before[at])
                best = float(reached[first]), legs[::-1]
        return Bound(tuple(best[1]), tuple(rounds[1:]))
