"""Whole, parallel lanes that cover what is to be covered: brute force over headings and rows, without the planner.

Lanes of one heading lead from one side of a part to the other, so far as the tube stays inside. Rows are as few as
leave no more of the part than the mission lets be left, each covering half a spacing to either side. Headings are tried
every few degrees and rows in steps, and of each number of lanes the shortest few: beyond that nothing is proved, and a
plan that mixes headings, leaves pieces of rows out, or rounds the ends of lanes off, may be shorter.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
import shapely
import shapely.affinity

from tests.bench.shortest_visits import Floats

_HEADINGS_DEG = np.arange(0.0, 180.0, 2.0)
_PITCHES = np.linspace(0.8, 1.04, 9)  # of the spacing
_SHIFTS = 8
_SLICES = 400  # into which a part is cut to measure what rows cover
_SHORTEST = 0.05  # of the spacing: shorter cuts are no lanes
_PARALLEL = 0.999
_MOST_ROWS = 2  # numbers of rows from the fewest on that are tried
_MOST_LANES = 12  # of which all orders are tried
_KEPT = 2  # the shortest of each number of lanes, that are flown in all orders


@dataclass(frozen=True, eq=False)
class Rows:
    """Lanes of one heading over one part, shape (n, 2, 2)."""

    lanes_m: Floats

    @cached_property
    def length_m(self) -> float:
        return _length_m(self.lanes_m)


def rows_of(part: shapely.Polygon, spacing_m: float, tube_m: float, share: float) -> Iterator[Rows]:
    """Lanes that cover a part, the shortest of each heading and number; in no order."""
    for heading in _HEADINGS_DEG.tolist():
        turned = shapely.affinity.rotate(part, heading, origin=(0.0, 0.0))
        inside = shapely.buffer(turned, -tube_m)
        left, low, right, high = turned.bounds
        edges = np.linspace(low, high, _SLICES + 1)
        slices = shapely.area(shapely.intersection(turned, shapely.box(left, edges[:-1], right, edges[1:])))
        middles = 0.5 * (edges[1:] + edges[:-1])
        found = 0
        for count in range(1, int(np.ceil((high - low) / spacing_m)) + 2):
            tried = []
            for pitch_m in _PITCHES * spacing_m if count > 1 else (spacing_m,):
                slack_m = high - low - (count - 1) * pitch_m
                for first in low + np.linspace(0.0, 1.0, _SHIFTS + 1) * slack_m if slack_m >= 0.0 else ():
                    heights = first + pitch_m * np.arange(count)
                    near = np.abs(middles[:, None] - heights).min(axis=1) <= 0.5 * spacing_m
                    if slices[near].sum() >= share * part.area:  # else no lanes there would do
                        tried.append(_cut(inside, heights, _SHORTEST * spacing_m))
            for lanes_m in sorted(tried, key=_length_m):
                swath = shapely.buffer(shapely.multilinestrings([*lanes_m]), 0.5 * spacing_m) if len(lanes_m) else None
                if swath is not None and shapely.intersection(turned, swath).area >= share * part.area:
                    turn = np.radians(-heading)
                    rotation = np.array([[np.cos(turn), -np.sin(turn)], [np.sin(turn), np.cos(turn)]])
                    found += 1
                    yield Rows(lanes_m @ rotation.T)
                    break
            if found == _MOST_ROWS:
                break


def _length_m(lanes_m: Floats) -> float:
    return float(np.linalg.norm(lanes_m[:, 1] - lanes_m[:, 0], axis=1).sum())


def _cut(inside: shapely.Geometry, heights: Floats, shortest_m: float) -> Floats:
    """Rows along the x axis, so far as they are inside, shape (n, 2, 2)."""
    left, _, right, _ = inside.bounds
    lines = shapely.linestrings([[(left - 1.0, y), (right + 1.0, y)] for y in heights])
    cuts = shapely.get_parts(shapely.intersection(lines, inside))
    long = cuts[shapely.length(cuts) > shortest_m]
    return np.array([shapely.get_coordinates(cut)[[0, -1]] for cut in long]).reshape(-1, 2, 2)


@dataclass(frozen=True, eq=False)
class Visit:
    """What is visited: points, or parts to be covered, each by one of some sets of rows.

    Attributes:
        points_m: Shape (k, 2); with no parts.
        parts: For each the rows that would do.
        rest_s: How long the vehicle stays; it stands then.
    """

    points_m: Floats
    parts: Sequence[Sequence[Rows]] = ()
    rest_s: float = 0.0


def choices(visit: Visit) -> list[Floats]:
    """Lanes for all parts of a visit: of one part the shortest of each number; of several, the fewest of each."""
    parts = [sorted(part, key=lambda rows: rows.length_m) for part in visit.parts]
    if len(parts) > 1:
        fewest = [min(part, key=lambda rows: (len(rows.lanes_m), rows.length_m)) for part in parts]
        return [np.concatenate([rows.lanes_m for rows in fewest])]
    return [
        rows.lanes_m
        for number in sorted({len(rows.lanes_m) for rows in parts[0]})
        if number <= _MOST_LANES
        for rows in [rows for rows in parts[0] if len(rows.lanes_m) == number][:_KEPT]
    ]
