"""Covering a region: the lanes, their order and the ways between them, from shapes."""

from dataclasses import dataclass
from functools import cached_property
from typing import Final

import numpy as np
import shapely
from numpy.typing import ArrayLike

from mission.coverage.coverage import Coverage, Pace
from mission.coverage.flight_line import flight_line
from mission.coverage.headings import candidates
from mission.coverage.rims import needless, rim_lanes
from mission.coverage.sequence import Lanes, sequence
from mission.coverage.sweeps import Sweep, axes, sweep
from mission.coverage.ways import Network
from mission.errors import GeometryError
from mission.geometry.arrays import frozen_floats, frozen_ints

INSET: Final = 1.0 / 400.0
"""Of the spacing: how far within the ground lanes and ways are, between half of it and five halves."""
_EXCESS: Final = INSET / 100.0
TOLERANCE: Final = 0.05
"""Of the spacing: how much farther than half a spacing a place on the ground may be from a lane."""
SPARED: Final = 0.005
"""Of what is to be covered: the share that may be left out beside the ground, between the round ends of lanes."""
MOST_LINES: Final = 2_000
_MOST_TRIED: Final = 4
_NEAR: Final = 1.15
"""Headings are tried in full whose guessed time is at most so many times the least."""
_CLOSE: Final = 1.05
"""The orders of these are improved before the best is taken."""


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

    Raises:
        GeometryError: There is no ground, it is not in free space, there are too many lanes, or no way leads to some.
    """
    origin = np.floor(shapely.get_coordinates(shapely.centroid(ground))[0]) if not ground.is_empty else np.zeros(2)
    region, ground, free = (shapely.transform(shape, lambda xy: xy - origin) for shape in (region, ground, free))
    area = _area(region, ground, free, spacing_m)
    entry = np.asarray(entry_m, dtype=np.float64) - origin
    leave = None if exit_m is None else np.asarray(exit_m, dtype=np.float64) - origin
    if heading_deg is None:
        swept = {heading: _swept(area, heading) for heading in candidates(area.parts)}
        guesses = {
            heading: sum(part.guessed_s(pace, spacing_m) for part in sweeps) for heading, sweeps in swept.items()
        }
        least = min(guesses.values())
        promising = [
            heading for heading in sorted(guesses, key=guesses.__getitem__) if guesses[heading] <= _NEAR * least
        ]
        swept = {heading: swept[heading] for heading in promising[:_MOST_TRIED]}
    else:
        swept = {heading_deg % 180.0: _swept(area, heading_deg)}
    found = []
    for heading, sweeps in swept.items():
        lanes = _complete(area, _joined(sweeps), heading)
        order = sequence(lanes, area.grounds, area.everywhere, entry_m=entry, exit_m=leave, pace=pace)
        found.append((heading, lanes, order))
    least = min(order.duration_s for _, _, order in found)
    close = [(heading, lanes, order.settled()) for heading, lanes, order in found if order.duration_s <= _CLOSE * least]
    heading, lanes, order = min(close, key=lambda one: one[2].duration_s)
    line = flight_line(order, lanes.lanes_m, lanes.cell_of < 0)
    return Coverage(
        heading_deg=heading,
        spacing_m=spacing_m,
        lanes_m=frozen_floats(line.lanes_m + origin),
        cell_of=frozen_ints(lanes.cell_of[order.flights // 2]),
        ways_m=tuple(frozen_floats(way + origin) for way in line.ways_m[1 : len(line.lanes_m)]),
        approach_m=frozen_floats(line.ways_m[0] + origin),
        leaving_m=frozen_floats(np.empty((0, 2)) if leave is None else line.ways_m[-1] + origin),
        exact=order.exact,
        duration_s=pace.duration_s(line.whole_m),
    )


@dataclass(frozen=True, eq=False)
class _Area:
    """The shapes, near their origin.

    Attributes:
        parts: Connected polygons of the ground, a little smaller than given.
        reachable: What is to be covered: the region, within half a spacing of the ground.
        free: A little smaller than given, and the parts.
        spacing_m: Of the lanes.
    """

    parts: tuple[shapely.Polygon, ...]
    reachable: shapely.Geometry
    free: shapely.Geometry
    spacing_m: float

    @cached_property
    def ground(self) -> shapely.Geometry:
        return shapely.MultiPolygon(self.parts)

    @cached_property
    def grounds(self) -> list[Network]:
        return [Network(part, _EXCESS * self.spacing_m) for part in self.parts]

    @cached_property
    def everywhere(self) -> Network:
        return Network(self.free, _EXCESS * self.spacing_m)

    @cached_property
    def reachable_of(self) -> list[shapely.Geometry]:
        return [shapely.intersection(self.reachable, shapely.buffer(part, self.spacing_m / 2.0)) for part in self.parts]


def _area(region: shapely.Geometry, ground: shapely.Geometry, free: shapely.Geometry, spacing_m: float) -> _Area:
    left, low, right, high = shapely.bounds(ground)
    if ground.is_empty or not np.hypot(right - left, high - low) > 0.0:
        raise GeometryError("no lane fits into the region: nothing of it is left by the clearance and the tube")
    if np.hypot(right - left, high - low) > MOST_LINES * spacing_m:
        raise GeometryError(
            f"more than {MOST_LINES} lanes: a spacing of {spacing_m:.4g} m is too narrow for the region"
        )
    outside = shapely.difference(ground, shapely.buffer(free, _EXCESS * spacing_m, join_style="mitre"))
    if not outside.is_empty:
        x, y = shapely.get_coordinates(shapely.point_on_surface(outside))[0]
        raise GeometryError(f"lanes would leave free space near ({x:.2f}, {y:.2f})")
    parts = tuple(shapely.get_parts(_inset(ground, spacing_m)))
    reachable = shapely.intersection(region, shapely.buffer(shapely.MultiPolygon(parts), spacing_m / 2.0))
    return _Area(parts, reachable, shapely.union_all([_inset(free, spacing_m), *parts]), spacing_m)


def _inset(shape: shapely.Geometry, spacing_m: float) -> shapely.Geometry:
    """Each part a little smaller, with fewer corners: what is made in it survives rounding, and arcs are cheap."""
    parts = []
    for part in shapely.get_parts(shape):
        for finer in (1.0, 0.1, 0.01):
            margin = finer * INSET * spacing_m
            smaller = shapely.simplify(shapely.buffer(part, -1.5 * margin, join_style="mitre"), margin)
            if not smaller.is_empty:
                parts.extend(shapely.get_parts(smaller))
                break
    return shapely.MultiPolygon(parts)


def _swept(area: _Area, heading_deg: float) -> tuple[Sweep, ...]:
    """The lanes of a heading on each part."""
    pairs = zip(area.parts, area.reachable_of, strict=True)
    return tuple(sweep(part, reachable, heading_deg, area.spacing_m) for part, reachable in pairs)


def _joined(sweeps: tuple[Sweep, ...]) -> Lanes:
    """The lanes of all parts."""
    count = [len(found.lanes_m) for found in sweeps]
    first = np.cumsum([0] + [found.cell_of.max(initial=-1) + 1 for found in sweeps])[:-1]
    return Lanes(
        np.concatenate([found.lanes_m for found in sweeps]),
        np.concatenate([found.cell_of + begin for found, begin in zip(sweeps, first, strict=True)]),
        np.repeat(np.arange(len(sweeps)), count),
        np.zeros(sum(count), dtype=np.bool_),
    )


def _complete(area: _Area, swept: Lanes, heading_deg: float) -> Lanes:
    """The lanes without those that nobody needs, and with those of their own along rims."""
    kept = ~needless(area.reachable, swept.lanes_m, area.spacing_m)
    more = rim_lanes(
        area.ground,
        area.reachable,
        swept.lanes_m[kept],
        along=axes(heading_deg)[0],
        spacing_m=area.spacing_m,
        tolerance_m=TOLERANCE * area.spacing_m,
        spared=SPARED,
    )
    middles = shapely.points(more.mean(axis=1))[:, None]
    part_of = shapely.distance(middles, np.array(area.parts)).argmin(axis=1)
    _, cell_of = np.unique(swept.cell_of[kept], return_inverse=True)
    order = np.argsort(cell_of, kind="stable")
    return Lanes(
        np.concatenate((swept.lanes_m[kept][order], more)),
        np.concatenate((cell_of[order], np.full(len(more), -1))),
        np.concatenate((swept.part_of[kept][order], part_of)),
        np.concatenate((swept.chained[kept][order], np.zeros(len(more), dtype=np.bool_))),
    )
