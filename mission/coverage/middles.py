"""Middle lines of narrow regions: roads, strips, rows, which one lane covers from side to side.

The middle line is the medial axis: the edges of the Voronoi diagram of points along the rim that lie inside (Brandt and
Algazi, 1992). Its branches into corners are cut off, what is left is straightened within a tolerance and lengthened to
the rim at its ends.
"""

from collections import defaultdict
from itertools import pairwise
from typing import Final

import numpy as np
import shapely
from scipy.spatial import Voronoi

from mission.geometry.arrays import FloatArray, IntArray

_FINE: Final = 3.0
"""Points along the rim for each width."""
_MOST_POINTS: Final = 4_000
_BRANCH: Final = 0.8
"""Of the spacing: a branch that is shorter leads into a corner."""
_BENT: Final = 0.05
"""Of the spacing, and half of a quarter of the width: how far a lane may be from the middle line."""
_LONG: Final = 2.0
"""Spacings: the length from which on what is narrow is an arm, flown along its middle."""
_SLACK: Final = 1e-3


def arms(part: shapely.Polygon, region: shapely.Geometry, spacing_m: float) -> shapely.Geometry:
    """What of a part of the ground lies where the region is narrower than the spacing, if it is two spacings long.

    Args:
        part: Where lanes may lie.
        region: What is to be covered.
        spacing_m: Distance of lanes.
    """
    reach = spacing_m / 2.0
    wide = shapely.buffer(shapely.buffer(region, -reach), reach * (1.0 + _SLACK))
    narrow = shapely.get_parts(shapely.difference(part, wide))
    narrow = narrow[shapely.area(narrow) > 0.0]
    return shapely.MultiPolygon([arm for arm in narrow if shapely.area(arm) > _LONG * _width(arm) * spacing_m])


def middle_lines(arm: shapely.Polygon, spacing_m: float) -> list[FloatArray]:
    """The middle lines of an arm, polylines of shape (k, 2) that meet at their ends."""
    width = _width(arm)
    step = max(width / _FINE, shapely.length(arm) / _MOST_POINTS)
    diagram = Voronoi(np.unique(shapely.get_coordinates(shapely.segmentize(arm, step)), axis=0))
    ends = np.array(diagram.ridge_vertices)
    inside = np.append(shapely.contains_xy(arm, *diagram.vertices.T), False)
    chains = _chains(diagram.vertices, ends[inside[ends].all(axis=1)], _BRANCH * spacing_m)
    bent = min(_BENT * spacing_m, width / 8.0)
    joints = [tuple(chain[end]) for chain in chains for end in (0, -1)]
    lines = []
    for chain in chains:
        line = shapely.get_coordinates(shapely.simplify(shapely.linestrings(chain), bent))
        for _ in range(2):
            line = line[::-1]
            if joints.count((line[-1, 0], line[-1, 1])) == 1:
                line[-1] = _lengthened(line[-2:], arm)
        lines.append(line)
    return lines


def _width(arm: shapely.Polygon) -> float:
    """About how wide it is: as a strip of its area and circumference."""
    return float(2.0 * shapely.area(arm) / shapely.length(arm))


def _chains(vertices: FloatArray, edges: IntArray, shortest_m: float) -> list[FloatArray]:
    """Lines between the ends and forks of a graph, without the short ones that end in nothing; shapes (k, 2)."""
    beside: dict[int, set[int]] = defaultdict(set)
    for begin, end in edges.tolist():
        beside[begin].add(end)
        beside[end].add(begin)
    met = {node: len(others) for node, others in beside.items()}
    for chain in _walked(beside):
        fewest, most = sorted((met[chain[0]], met[chain[-1]]))
        if fewest == 1 and most > 2 and _length(vertices[chain]) < shortest_m:  # noqa: PLR2004 - a fork has three
            for begin, end in pairwise(chain):
                beside[begin].discard(end)
                beside[end].discard(begin)
    return [vertices[chain] for chain in _walked(beside)]


def _walked(beside: dict[int, set[int]]) -> list[list[int]]:
    """Each edge of a graph once, in chains from where it ends or forks to the next such place, then rings."""
    left = {node: set(others) for node, others in beside.items()}
    ends = [node for node in sorted(beside) if len(beside[node]) not in (0, 2)]
    chains = []
    for start in ends + sorted(beside):
        while left[start]:
            chain = [start]
            while left[chain[-1]] and (len(chain) == 1 or len(beside[chain[-1]]) == 2):  # noqa: PLR2004 - it goes on
                following = min(left[chain[-1]])
                left[chain[-1]].discard(following)
                left[following].discard(chain[-1])
                chain.append(following)
            chains.append(chain)
    return chains


def _length(line: FloatArray) -> float:
    return float(np.linalg.norm(np.diff(line, axis=0), axis=1).sum())


def _lengthened(piece: FloatArray, arm: shapely.Polygon) -> FloatArray:
    """Where a straight piece inside of an arm meets the rim when it goes on."""
    step = piece[1] - piece[0]
    far = piece[1] + step / np.linalg.norm(step) * shapely.length(arm)
    ahead = shapely.get_parts(shapely.intersection(shapely.linestrings([piece[1], far]), arm))
    nearest = ahead[np.argmin(shapely.distance(ahead, shapely.points(piece[1])))]
    met: FloatArray = shapely.get_coordinates(nearest)[-1]
    # Not onto the rim: there rounding would tell whether it is inside.
    inside: FloatArray = met - _SLACK * (met - piece[1])
    return inside
