"""Outlines that nearly touch: corners of one that lie beside an edge or a corner of another, and not on it.

Between such outlines a mesh has slivers or misses edges, and what is said of those helps nobody. So where one of them
is at fault, the pair is named once, with what makes the two meet: corners moved onto corners of the other, or corners
that the other is given too. The boundary stays where it is, and of two regions the later one moves.
"""

from collections import defaultdict
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Final

import numpy as np
import shapely

from mission.decimals import measure
from mission.geometry.arrays import FloatArray, IntArray
from mission.geometry.rings import ring_edges
from mission.spec.finding import Finding, Path, listed
from mission.spec.scale import pair

NEARNESS: Final = 1e-3
"""Distances below this part of the domain's extent are near, where something is wrong."""

Pair = tuple[int, int]


@dataclass(frozen=True, eq=False)
class Outline:
    """A ring of corners, shape (K, 2), and whose it is; ``region`` is empty for the boundary of the domain."""

    path: Path
    ring_m: FloatArray
    region: str

    @property
    def name(self) -> str:
        """What to call it."""
        return self.region or "the boundary"


@dataclass(frozen=True)
class _Miss:
    """A corner of one outline near another: how far from it, beside which edge, and how far from the edge's begin."""

    corner: int
    edge: int
    along_m: float
    apart_m: float


class NearMisses:
    """All near misses between outlines, the boundary (if there is one) first."""

    def __init__(self, outlines: Sequence[Outline], extent_m: float, tolerance_m: float) -> None:
        self.outlines = outlines
        self.near_m = NEARNESS * extent_m
        self._tolerance_m = tolerance_m

    @cached_property
    def _of(self) -> dict[Pair, list[_Miss]]:
        """The corners of the first that miss the second, by the pair, in their order."""
        if not self.outlines:
            return {}
        lengths = [len(outline.ring_m) for outline in self.outlines]
        owner = np.repeat(np.arange(len(lengths)), lengths)
        number = np.concatenate([np.arange(length) for length in lengths])
        corners = np.concatenate([outline.ring_m for outline in self.outlines])
        lines = shapely.linestrings(np.concatenate([ring_edges(outline.ring_m) for outline in self.outlines]))
        points = shapely.points(corners)
        found, edges = shapely.STRtree(lines).query(points, predicate="dwithin", distance=self.near_m)
        foreign = owner[found] != owner[edges]
        found, edges = found[foreign], edges[foreign]
        beside = shapely.distance(points[found], lines[edges])
        # A corner on an edge is in place, unless a corner of the other is near.
        to_corner = np.linalg.norm(
            corners[found, None] - shapely.get_coordinates(lines[edges]).reshape(-1, 2, 2), axis=2
        )
        apart = np.where(to_corner.min(axis=1) <= self.near_m, to_corner.min(axis=1), beside)
        along = shapely.line_locate_point(lines[edges], points[found])
        misses: dict[Pair, list[_Miss]] = defaultdict(list)
        done: set[Pair] = set()
        for i in np.lexsort((beside, apart, owner[edges], found)).tolist():
            corner, other = int(found[i]), int(owner[edges[i]])
            if (corner, other) not in done and apart[i] > self._tolerance_m:
                miss = _Miss(int(number[corner]), int(number[edges[i]]), float(along[i]), float(apart[i]))
                misses[int(owner[corner]), other].append(miss)
            done.add((corner, other))
        return misses

    @cached_property
    def _places(self) -> tuple[FloatArray, IntArray]:
        """Where the corners that miss lie, shape (N, 2), and the pair that each is of, shape (N, 2)."""
        rows = [(self.outlines[a].ring_m[miss.corner], (a, b)) for (a, b), found in self._of.items() for miss in found]
        return np.array([place for place, _ in rows]).reshape(-1, 2), np.array([of for _, of in rows]).reshape(-1, 2)

    def beside(self, begin_m: FloatArray, end_m: FloatArray) -> set[Pair]:
        """The pairs that miss each other beside a segment, its ends included, lower index first."""
        places, pairs = self._places
        near = shapely.dwithin(shapely.points(places), shapely.LineString((begin_m, end_m)), self.near_m)
        return {(min(of), max(of)) for of in pairs[near].tolist()}

    def findings(self, pairs: Iterable[Pair]) -> list[Finding]:
        """One finding for each pair, of lower index first."""
        return [self._finding(first, later) for first, later in sorted(set(pairs))]

    def _finding(self, first: int, later: int) -> Finding:
        apart = [miss.apart_m for of in ((first, later), (later, first)) for miss in self._of.get(of, ())]
        message = (
            f"{self.outlines[later].name} and {self.outlines[first].name} nearly touch: corners of one lie up to "
            f"{measure(max(apart))} m beside the other, not on it"
        )
        moved = self._moves(first, later)
        steps = [
            f"move corner {corner} of {self.outlines[later].name} to {pair(self.outlines[first].ring_m[to])}"
            for corner, to in sorted(moved.items())
        ]
        steps += self._additions(first, later, set(moved.values()))
        steps += self._additions(later, first, set(moved))
        return Finding(self.outlines[later].path, message, f"make them meet (corners count from 0): {listed(steps)}")

    def _moves(self, first: int, later: int) -> dict[int, int]:
        """Corners of the later one to be moved, and to which corners of the first: the nearest, each once."""
        target, moving = self.outlines[first].ring_m, self.outlines[later].ring_m
        distances = np.linalg.norm(moving[:, None] - target[None], axis=2)
        # Where the two meet already, nothing is moved.
        met, meeting = np.nonzero(distances <= self._tolerance_m)
        near = np.argwhere(distances <= self.near_m)
        moves: dict[int, int] = {}
        for corner, to in sorted(near.tolist(), key=lambda of: float(distances[of[0], of[1]])):
            taken = corner in moves or to in moves.values() or corner in met or to in meeting
            if not taken:
                moves[corner] = to
        return moves

    def _additions(self, of: int, to: int, moved: set[int]) -> list[str]:
        """The corners of one outline that the other is to have too, by the edge that they go into."""
        into: dict[int, list[_Miss]] = defaultdict(list)
        for miss in self._of.get((of, to), ()):
            if miss.corner not in moved:
                into[miss.edge].append(miss)
        corners, ring = self.outlines[of].ring_m, self.outlines[to].ring_m
        name = self.outlines[to].name
        return [
            f"put {', '.join(pair(corners[miss.corner]) for miss in sorted(found, key=lambda miss: miss.along_m))} "
            f"between corners {edge} and {(edge + 1) % len(ring)} of {name}"
            for edge, found in sorted(into.items())
        ]
