"""Covering a region: the lanes, their order and the ways between them, from shapes."""

from functools import partial
from typing import Final

import numpy as np
import shapely
from numpy.typing import ArrayLike

from mission.coverage.area import Area, area_of
from mission.coverage.cells import cells_swept
from mission.coverage.coverage import Coverage
from mission.coverage.flight_line import flight_line
from mission.coverage.headings import candidates
from mission.coverage.pace import Pace
from mission.coverage.rims import needless, rim_lanes
from mission.coverage.sequence import Lanes, Sequence, sequence
from mission.coverage.sweeps import Sweep, axes, sweep
from mission.geometry.arrays import FloatArray, frozen_floats, frozen_ints

TOLERANCE: Final = 0.05
"""Of the spacing: how much farther than half a spacing a place on the ground may be from a lane."""
SPARED: Final = 0.005
"""Of what is to be covered: the share that may be left out beside the ground, between the round ends of lanes."""
_FEWEST_TRIED: Final = 2
_LANES_TRIED: Final = 250
"""Lanes of all headings that are tried in full: of a field of many lanes fewer headings."""


def cover(
    region: shapely.Geometry,
    ground: shapely.Geometry,
    free: shapely.Geometry,
    *,
    spacing_m: float,
    entry_m: ArrayLike,
    pace: Pace,
    heading_deg: float | None = None,
    exit_m: ArrayLike | None = None,
    share: float = 1.0,
) -> Coverage:
    """Cover a region by lanes.

    Every place of the region that lies on the ground comes within half a spacing of a lane, and the tolerance; of what
    lies beside it, but within half a spacing, all but a small share. Ways between lanes on one part of the ground stay
    on it, and in free space otherwise.

    Args:
        region: Polygon or MultiPolygon to be covered, metres.
        ground: Polygon or MultiPolygon where lanes may lie: the region less clearance and tube.
        free: Polygon or MultiPolygon where ways may lie, less the tube; contains the ground.
        spacing_m: Distance of lanes, positive.
        entry_m: Where the vehicle comes from, shape (2,), in free space.
        pace: How fast the vehicle is.
        heading_deg: Of the lanes, clockwise from north; None for the one that takes least time of those tried: along
            edges of the ground and of its hull, and of a grid.
        exit_m: Where the vehicle goes to, shape (2,); None where it may end anywhere.
        share: Of the region, how much is to be covered: if that saves time, what is more than that is left out.

    Raises:
        GeometryError: There is no ground, it is not in free space, there are too many lanes, or no way leads to some.
    """
    origin = np.floor(shapely.get_coordinates(shapely.centroid(ground))[0]) if not ground.is_empty else np.zeros(2)
    region, ground, free = (shapely.transform(shape, lambda xy: xy - origin) for shape in (region, ground, free))
    area = area_of(region, ground, free, spacing_m)
    entry = area.in_free(np.asarray(entry_m, dtype=np.float64) - origin)
    leave = None if exit_m is None else area.in_free(np.asarray(exit_m, dtype=np.float64) - origin)
    left = max(0.0, float(1.0 - share * shapely.area(region) / shapely.area(area.reachable)))
    found: list[tuple[float, float, Lanes, Sequence]] = []
    least_s, count = np.inf, 0
    for guess_s, heading, sweeps in _options(area, heading_deg, pace, left):
        count += sum(len(part.lanes_m) for part in sweeps)
        if guess_s > least_s or (count > _LANES_TRIED and len(found) >= _FEWEST_TRIED):
            break
        lanes = _complete(area, _joined(area, sweeps), heading, left)
        order = sequence(lanes, area.grounds, area.everywhere, entry_m=entry, exit_m=leave, pace=pace).settled()
        line = flight_line(order, lanes.lanes_m, lanes.cell_of < 0)
        found.append((pace.duration_s(line.whole_m), heading, lanes, order))
        least_s = min(least_s, found[-1][0])
    _, heading, lanes, order = min(found, key=lambda one: one[0])
    order = order.shaken()
    line = flight_line(order, lanes.lanes_m, lanes.cell_of < 0)
    return Coverage(
        heading_deg=heading,
        spacing_m=spacing_m,
        lanes_m=frozen_floats(line.lanes_m + origin),
        cell_of=frozen_ints(lanes.cell_of[order.flights // 2]),
        ways_m=tuple(frozen_floats(way + origin) for way in line.ways_m[1 : len(line.lanes_m)]),
        approach_m=frozen_floats(_ended(line.ways_m[0] + origin, 0, entry_m)),
        leaving_m=frozen_floats(np.empty((0, 2)) if leave is None else _ended(line.ways_m[-1] + origin, -1, exit_m)),
        exact=order.exact,
        duration_s=pace.duration_s(line.whole_m),
        complete=left == 0.0,
    )


def _options(area: Area, heading_deg: float | None, pace: Pace, left: float) -> list[tuple[float, float, list[Sweep]]]:
    """Sweeps of all fields, each with about what it takes and its heading, the least first.

    Of each heading those that cover all, and those that leave out what may be if that saves lines.
    """
    chosen = heading_deg is not None or not area.fields
    headings = candidates(area.parts)
    if chosen:
        headings = (headings[0] if heading_deg is None else heading_deg % 180.0,)
    swept = sweep if chosen else partial(cells_swept, pace=pace)
    found: list[tuple[float, float, list[Sweep]]] = []
    for heading in headings:
        for spared in (0.0, left) if left > 0.0 else (0.0,):
            sweeps = [
                swept(field, reachable, heading, area.spacing_m, left=spared) for _, field, reachable in area.fields
            ]
            guess_s = sum(each.guessed_s(pace) for each in sweeps)
            if guess_s not in [option[0] for option in found]:
                found.append((guess_s, heading, sweeps))
    return sorted(found, key=lambda option: option[0])


def _ended(way: FloatArray, end: int, place_m: ArrayLike | None) -> FloatArray:
    """A way with an end, 0 or -1, put at the place that was asked for, a little beside."""
    ended = way.copy()
    ended[end] = place_m
    return ended


def _joined(area: Area, sweeps: list[Sweep]) -> Lanes:
    """The lanes of all fields and arms: each middle line is a cell that is flown one way or the other."""
    cells = [
        (found.lanes_m[found.cell_of == cell], part, False)
        for (part, _, _), found in zip(area.fields, sweeps, strict=True)
        for cell in range(found.cells)
    ]
    cells += [
        (np.stack((line[:-1], line[1:]), axis=1), part, True)
        for part, found in enumerate(area.arms)
        for arm in found
        for line in arm
    ]
    count = [len(lanes) for lanes, _, _ in cells]
    return Lanes(
        np.concatenate([np.empty((0, 2, 2)), *(lanes for lanes, _, _ in cells)]),
        np.arange(len(cells)).repeat(count),
        np.array([part for _, part, _ in cells], dtype=np.int64).repeat(count),
        np.array([chained for _, _, chained in cells], dtype=np.bool_).repeat(count),
    )


def _complete(area: Area, swept: Lanes, heading_deg: float, left: float) -> Lanes:
    """The lanes without those that nobody needs, and with those of their own along rims."""
    kept = swept.chained | ~needless(area.reachable, swept.lanes_m, area.spacing_m)
    more = rim_lanes(
        area.ground,
        area.reachable,
        swept.lanes_m[kept],
        along=axes(heading_deg)[0],
        spacing_m=area.spacing_m,
        tolerance_m=TOLERANCE * area.spacing_m,
        spared=SPARED,
        left=left,
    )
    middles = shapely.points(more.mean(axis=1))[:, None]
    part_of = shapely.distance(middles, np.array(area.parts)).argmin(axis=1)
    _, cell_of = np.unique(swept.cell_of[kept], return_inverse=True)
    order = np.argsort(cell_of, kind="stable")
    # On a part that has no cell, each lane is one: cells are what ways through free space are found between.
    lonely = ~np.isin(part_of, swept.part_of[kept])
    own = np.where(lonely, cell_of.max(initial=-1) + np.cumsum(lonely), -1)
    return Lanes(
        np.concatenate((swept.lanes_m[kept][order], more)),
        np.concatenate((cell_of[order], own)),
        np.concatenate((swept.part_of[kept][order], part_of)),
        np.concatenate((swept.chained[kept][order], np.zeros(len(more), dtype=np.bool_))),
    )
