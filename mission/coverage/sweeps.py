"""Lanes of one heading: lines over a part of the ground, cut by its rim, and gathered to cells.

The cells are those of the boustrophedon decomposition (Choset and Pignon, 1997) at the resolution of the lanes: where
a hole or a bay parts a line, or joins two, a cell ends. What lies between two lines and parts neither makes no cell.
"""

from collections.abc import Iterable
from dataclasses import dataclass, replace
from typing import Final

import numpy as np
import shapely
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from mission.coverage.pace import Pace
from mission.geometry.arrays import FloatArray, IntArray

_SHORTEST: Final = 0.02
"""Of the spacing: cuts that are shorter are no lanes."""
_SLANTED: Final = 1.2
"""Spacings between the ends of neighbours, along the rim, from which on the rim there is too far from both."""
_CROSSING: Final = 3.0
_SHIFTS: Final = 65
"""Places that are tried for lines that leave something out."""
_NONE: Final[IntArray] = np.empty(0, dtype=np.int64)
_JUMP: Final = 4.0
"""Spacings by which a cell's rim may go on from one lane to the next, beside twice what it usually does there."""


@dataclass(frozen=True, eq=False)
class Sweep:
    """The lanes of one heading.

    Attributes:
        lanes_m: Shape (n, 2, 2), all in the same direction, ordered by line and along it.
        cell_of: Shape (n,), from 0.
        jumps_m: Shape (J, 2), how far ends of neighbours in a cell, first ends and last ends, lie apart along them.
        jump_of: Shape (J,), the cell of each jump.
        spacing_m: Of the lines, at most.
    """

    lanes_m: FloatArray
    cell_of: IntArray
    jumps_m: FloatArray
    jump_of: IntArray
    spacing_m: float

    @property
    def cells(self) -> int:
        """How many there are."""
        return int(self.cell_of.max(initial=-1)) + 1

    def cell(self, number: int) -> "Sweep":
        """One of them alone."""
        lanes, jumps = self.cell_of == number, self.jump_of == number
        one = replace(self, lanes_m=self.lanes_m[lanes], cell_of=self.cell_of[lanes] - number)
        return replace(one, jumps_m=self.jumps_m[jumps], jump_of=self.jump_of[jumps] - number)

    @staticmethod
    def joined(sweeps: Iterable["Sweep"], spacing_m: float) -> "Sweep":
        """All of some, their cells numbered on."""
        none = Sweep(np.empty((0, 2, 2)), _NONE, np.empty((0, 2)), _NONE, spacing_m)
        found = [none, *sweeps]
        first = np.cumsum([0, *(each.cells for each in found)])
        return Sweep(
            np.concatenate([each.lanes_m for each in found]),
            np.concatenate([each.cell_of + number for each, number in zip(found, first, strict=False)]),
            np.concatenate([each.jumps_m for each in found]),
            np.concatenate([each.jump_of + number for each, number in zip(found, first, strict=False)]),
            spacing_m,
        )

    def guessed_s(self, pace: Pace) -> float:
        """About what it takes to fly: for a choice of headings to try."""
        lengths = np.linalg.norm(self.lanes_m[:, 1] - self.lanes_m[:, 0], axis=1)
        steps = np.hypot(self.jumps_m, self.spacing_m)
        beyond = np.maximum(steps - self.spacing_m * _SLANTED, 0.0)  # of slanted rims, where lanes of their own will be
        slants = self.jumps_m / steps
        turns_s = pace.link_s(steps, slants, -slants).mean(axis=1).sum()
        plain = np.zeros(1)
        turn_s = float(pace.link_s(np.full(1, self.spacing_m), plain, plain)[0])
        way_m = lengths.sum() + _CROSSING * self.spacing_m * self.cells + beyond.sum() / 2.0
        return float(way_m / pace.speed_m_s + turns_s + self.cells * turn_s)


def axes(heading_deg: float) -> FloatArray:
    """Unit vectors along a heading, clockwise from north, and to the left of it; shape (2, 2)."""
    turn = np.radians(heading_deg)
    return np.array([[np.sin(turn), np.cos(turn)], [-np.cos(turn), np.sin(turn)]])


def sweep(
    part: shapely.Polygon, reachable: shapely.Geometry, heading_deg: float, spacing_m: float, left: float = 0.0
) -> Sweep:
    """Lanes over one part of the ground.

    Args:
        part: Polygon where lanes may lie.
        reachable: What they are to cover.
        heading_deg: Clockwise from north.
        spacing_m: At most so far apart.
        left: The share of it that may be left out beside the first line and the last one, if that saves lines.
    """
    frame = axes(heading_deg)
    edges = _edges(part) @ frame.T
    heights = _heights(edges[..., 1], _edges(reachable) @ frame.T, spacing_m, left)
    cuts, line = _cuts(edges, heights)
    long = np.diff(cuts, axis=1)[:, 0] > _SHORTEST * spacing_m
    cuts, line = cuts[long], line[long]
    lanes = np.stack((cuts, np.broadcast_to(heights[line][:, None], cuts.shape)), axis=2) @ frame
    return Sweep(lanes, *_cells(cuts, line, spacing_m), spacing_m)


def _edges(area: shapely.Geometry) -> FloatArray:
    """Of all rings of polygons, shape (E, 2, 2), the area on their left."""
    rings = shapely.get_rings(shapely.get_parts(shapely.orient_polygons(area, exterior_cw=False)))
    corners = [shapely.get_coordinates(ring) for ring in rings]
    return np.concatenate([np.stack((ring[:-1], ring[1:]), axis=1) for ring in corners])


def _heights(rim: FloatArray, wanted: FloatArray, spacing_m: float, left: float) -> FloatArray:
    """Where lines lie across the heading: evenly, the outermost half a spacing inside of what they are to cover.

    If fewer lines that are a spacing apart leave no more than they may, those are taken that leave least.

    Args:
        rim: Edges of the ground, shape (E, 2): across the heading.
        wanted: Edges of what is to be covered, shape (F, 2, 2): along the heading, and across.
        spacing_m: At most so far apart.
        left: The share of what is to be covered that may be left out.
    """
    low, high = rim.min(), rim.max()
    margin = min(1e-6 * spacing_m, (high - low) / 4.0)  # a line along the uppermost edge would cut nothing
    low, high = low + margin, high - margin
    bottom, top = wanted[..., 1].min(), wanted[..., 1].max()
    first, last = max(low, bottom + spacing_m / 2.0), min(high, top - spacing_m / 2.0)
    if first >= last:
        return np.array([np.clip((first + last) / 2.0, low, high)])
    whole = float(_area_below(wanted, np.array([top]))[0])
    heights = np.linspace(first, last, 1 + int(np.ceil((last - first) / spacing_m - 1e-9)))
    for count in range(len(heights) - 1, 0, -1):
        # Beside each other, their swaths begin anywhere between the two rims of what is to be covered.
        most = min(top - count * spacing_m, high - (count - 0.5) * spacing_m)
        begins = np.linspace(max(bottom, low - spacing_m / 2.0), most, _SHIFTS)
        beyond = _area_below(wanted, begins) - _area_below(wanted, begins + count * spacing_m)
        best = int(beyond.argmin())
        if begins[0] > most or beyond[best] > left * whole - whole:
            break
        heights = begins[best] + (np.arange(count) + 0.5) * spacing_m
    return heights


def _area_below(edges: FloatArray, heights: FloatArray) -> FloatArray:
    """The area of polygons below heights, shape (H,); of their edges, shape (E, 2, 2), the area lies on the left."""
    (begin_u, begin_v), (end_u, end_v) = edges[:, 0].T, edges[:, 1].T
    rise = end_v - begin_v
    low, at_low = np.minimum(begin_v, end_v), np.where(rise > 0.0, begin_u, end_u)
    high_less_low = np.where(rise > 0.0, end_u - begin_u, begin_u - end_u)
    share = np.clip((heights[:, None] - low) / np.where(rise == 0.0, 1.0, np.abs(rise)), 0.0, 1.0)
    area: FloatArray = (share * (at_low + 0.5 * share * high_less_low)) @ rise
    return area


def _cuts(edges: FloatArray, heights: FloatArray) -> tuple[FloatArray, IntArray]:
    """Where lines run inside, begin and end along them, shape (n, 2); and the number of the line, shape (n,)."""
    low, high = edges[..., 1].min(axis=1), edges[..., 1].max(axis=1)
    # Each edge without its upper end: a line through a corner then crosses an even number of them.
    line, edge = np.nonzero((low <= heights[:, None]) & (heights[:, None] < high))
    (begin_u, begin_v), (end_u, end_v) = edges[edge, 0].T, edges[edge, 1].T
    along = begin_u + (heights[line] - begin_v) / (end_v - begin_v) * (end_u - begin_u)
    order = np.lexsort((along, line))
    return along[order].reshape(-1, 2), line[order][::2].astype(np.int64)


def _cells(cuts: FloatArray, line: IntArray, spacing_m: float) -> tuple[IntArray, FloatArray, IntArray]:
    """Number cells: chains of lanes of which each meets one on the next line only, and that one no other; and jumps.

    Returns:
        Of each lane its cell, and of each jump how far both ends lie apart, and its cell.
    """
    count = len(cuts)
    begins, ends = cuts.T
    meets = (line[:, None] + 1 == line) & (begins[:, None] < ends) & (begins < ends[:, None])
    single = meets & (meets.sum(axis=1) == 1)[:, None] & (meets.sum(axis=0) == 1)
    lower, upper = np.nonzero(single)
    jumps = np.abs(cuts[upper] - cuts[lower])
    usual = np.median(jumps.max(axis=1)) if len(jumps) else 0.0
    smooth = jumps.max(axis=1) <= max(_JUMP * spacing_m, 2.0 * usual)
    lower, upper = lower[smooth], upper[smooth]
    links = coo_array((np.ones(len(lower)), (lower, upper)), shape=(count, count))
    _, cell_of = connected_components(links, directed=False)
    return cell_of.astype(np.int64), jumps[smooth], cell_of[lower].astype(np.int64)
