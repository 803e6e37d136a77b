"""Cells that are swept in directions of their own: a corridor is flown along, whatever the heading of the rest.

Where the lanes of a cell are short and many, as across the sides of a ring, its turns take longer than its lanes. Such
a cell is swept once more along the smallest rectangle around it, and the better sweep is taken; see Huang,
"Optimal line-sweep-based decompositions for coverage algorithms" (2001).
"""

import math
from typing import Final

import numpy as np
import shapely

from mission.coverage.pace import Pace
from mission.coverage.sweeps import Sweep, axes, sweep
from mission.geometry.arrays import FloatArray

_FEWEST: Final = 4
"""Lanes: a cell of fewer has little to gain."""
_ACROSS: Final = 1.5
"""Times as far across its lanes as along them, from which on a cell may be swept otherwise."""
_LITTLE: Final = 1e-6
_BETTER: Final = 0.95
"""Of the time that is guessed: another direction takes at most so much."""


def cells_swept(
    field: shapely.Polygon,
    reachable: shapely.Geometry,
    heading_deg: float,
    spacing_m: float,
    *,
    left: float,
    pace: Pace,
) -> Sweep:
    """Lanes over a field of one heading, and of others in the cells where that takes less time.

    Args:
        field: Polygon where lanes may lie.
        reachable: What they are to cover.
        heading_deg: Clockwise from north.
        spacing_m: At most so far apart.
        left: The share of it that may be left out, if that saves lanes.
        pace: How fast the vehicle is.
    """
    whole = sweep(field, reachable, heading_deg, spacing_m, left)
    lengths = np.linalg.norm(whole.lanes_m[:, 1] - whole.lanes_m[:, 0], axis=1)
    counts = np.bincount(whole.cell_of, minlength=whole.cells)
    means = np.bincount(whole.cell_of, lengths, whole.cells) / np.maximum(counts, 1)
    across = (counts >= _FEWEST) & (counts * spacing_m > _ACROSS * means)
    if not across.any():
        return whole
    cells = []
    for number in range(whole.cells):
        cell = whole.cell(number)
        if across[number]:
            cell = _best(cell, field, reachable, axes(heading_deg), left=left, pace=pace)
        cells.append(cell)
    return Sweep.joined(cells, spacing_m)


def _best(
    cell: Sweep, field: shapely.Polygon, reachable: shapely.Geometry, frame: FloatArray, *, left: float, pace: Pace
) -> Sweep:
    ground, around = _ground(cell, field, reachable, frame)
    sweeps = [sweep(part, around, _heading(ground), cell.spacing_m, left) for part in shapely.get_parts(ground)]
    found = Sweep.joined(sweeps, cell.spacing_m)
    return found if found.guessed_s(pace) < _BETTER * cell.guessed_s(pace) else cell


def _ground(
    cell: Sweep, field: shapely.Polygon, reachable: shapely.Geometry, frame: FloatArray
) -> tuple[shapely.Geometry, shapely.Geometry]:
    """What is a cell's of a field, and of what is to be covered: from half a spacing before its first line on.

    Between its first line and its last, all that is connected with it there.
    """
    # One lane on each line, in their order.
    places, reach, far = cell.lanes_m @ frame.T, cell.spacing_m / 2.0, shapely.length(field)
    (left, low), (right, high) = places[0, 0], places[-1, 1]
    left, right = min(left, right) - far, max(left, right) + far
    parts = shapely.get_parts(shapely.intersection(field, _box(left, low, right, high, frame)))
    # Of lanes on its rim rounding would tell what they meet.
    own = parts[shapely.intersects(parts, shapely.multilinestrings([*cell.lanes_m[1:-1]]))]
    # Pieces overlap, so that they are joined.
    little = _LITTLE * reach
    ends = [
        _box(lane[0, 0], lane[0, 1] + min(side, -little), lane[1, 0], lane[0, 1] + max(side, little), frame)
        for lane, side in ((places[0], -reach), (places[-1], reach))
    ]
    ground = shapely.union_all([*own, *shapely.intersection(field, ends)])
    kept = [part for part in shapely.get_parts(ground) if part.geom_type == "Polygon" and part.area > 0.0]
    # Where the rim of another cell begins there, nothing of it is taken.
    slab = _box(left, low - reach + little, right, high + reach - little, frame)
    around = shapely.intersection(shapely.intersection(reachable, shapely.buffer(ground, reach)), slab)
    return shapely.MultiPolygon(kept), around


def _box(left: float, low: float, right: float, high: float, frame: FloatArray) -> shapely.Polygon:
    corners = np.array([[left, low], [right, low], [right, high], [left, high]])
    return shapely.Polygon(corners @ frame)


def _heading(ground: shapely.Geometry) -> float:
    """Along the smallest rectangle around, clockwise from north."""
    corners = shapely.get_coordinates(shapely.minimum_rotated_rectangle(ground))
    steps = np.diff(corners, axis=0)[:2]
    east, north = steps[np.argmax(np.hypot(*steps.T))].tolist()
    return math.degrees(math.atan2(east, north)) % 180.0
