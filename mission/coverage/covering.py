"""Covering a region: the lanes, their order and the ways between them, from shapes."""

from dataclasses import dataclass
from functools import cached_property
from typing import Final

import numpy as np
import shapely
from numpy.typing import ArrayLike

from mission.coverage.coverage import Coverage, Pace
from mission.coverage.headings import candidates
from mission.coverage.rims import needless, rim_lanes
from mission.coverage.sequence import Lanes, sequence
from mission.coverage.sweeps import axes, sweep
from mission.coverage.ways import Network
from mission.errors import GeometryError
from mission.geometry.arrays import FloatArray, frozen_floats, frozen_ints

INSET: Final = 1.0 / 400.0
"""Of the spacing: how far within the ground lanes and ways are, between half of it and five halves."""
_EXCESS: Final = INSET / 100.0
TOLERANCE: Final = 0.05
"""Of the spacing: how much farther than half a spacing a reachable place may be from a lane."""
MOST_LINES: Final = 2_000
_TRIED: Final = 4


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
    tolerance: float = TOLERANCE,
) -> Coverage:
    """Cover a region by lanes.

    Every place of the region that is within half a spacing of the ground comes within half a spacing of a lane, and the
    tolerance. Ways stay on the ground between lanes on one part of it, and in free space otherwise.

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
        tolerance: Share of the spacing.

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
        tried = sorted(swept, key=lambda heading: _guessed_s(swept[heading], pace, spacing_m))[:_TRIED]
    else:
        swept, tried = {}, [heading_deg % 180.0]
    found = []
    for heading in tried:
        lanes = _complete(area, swept.get(heading) or _swept(area, heading), heading, tolerance * spacing_m)
        found.append(_coverage(area, lanes, heading_deg=heading, entry=entry, leave=leave, pace=pace, origin=origin))
    return min(found, key=lambda coverage: coverage.duration_s)


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


def _swept(area: _Area, heading_deg: float) -> Lanes:
    """The lanes of a heading on all parts."""
    sweeps = [
        sweep(part, reachable, heading_deg, area.spacing_m)
        for part, reachable in zip(area.parts, area.reachable_of, strict=True)
    ]
    count = [len(found.lanes_m) for found in sweeps]
    first = np.cumsum([0] + [found.cell_of.max(initial=-1) + 1 for found in sweeps])[:-1]
    return Lanes(
        np.concatenate([found.lanes_m for found in sweeps]),
        np.concatenate([found.cell_of + begin for found, begin in zip(sweeps, first, strict=True)]),
        np.repeat(np.arange(len(sweeps)), count),
        np.zeros(sum(count), dtype=np.bool_),
    )


def _guessed_s(lanes: Lanes, pace: Pace, spacing_m: float) -> float:
    """About what lanes take: each with a turn and a step to the side, each cell with a way of some lanes' length."""
    lengths = np.linalg.norm(lanes.lanes_m[:, 1] - lanes.lanes_m[:, 0], axis=1)
    turns = len(lengths) * (spacing_m / pace.speed_m_s + pace.speed_m_s / pace.acceleration_m_s2)
    between = (lanes.cell_of.max(initial=-1) + 1) * lengths.mean() / pace.speed_m_s if len(lengths) else 0.0
    return float(lengths.sum() / pace.speed_m_s + turns + between)


def _complete(area: _Area, swept: Lanes, heading_deg: float, tolerance_m: float) -> Lanes:
    """The lanes without those that nobody needs, and with those of their own along rims."""
    kept = ~needless(area.reachable, swept.lanes_m, area.spacing_m)
    more = rim_lanes(
        area.ground,
        area.reachable,
        swept.lanes_m[kept],
        along=axes(heading_deg)[0],
        spacing_m=area.spacing_m,
        tolerance_m=tolerance_m,
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


def _coverage(
    area: _Area,
    lanes: Lanes,
    *,
    heading_deg: float,
    entry: FloatArray,
    leave: FloatArray | None,
    pace: Pace,
    origin: FloatArray,
) -> Coverage:
    order = sequence(lanes, area.grounds, area.everywhere, entry_m=entry, exit_m=leave, pace=pace)
    flights, travel = order.flights, order.travel
    places = 2 * len(lanes.lanes_m)
    begins = [places, *(flights ^ 1)]
    ends = [*flights, *([] if leave is None else [places + 1])]
    lines = [travel.line_m(begin, end) for begin, end in zip(begins, ends, strict=False)]
    flown = np.stack([lanes.lanes_m.reshape(-1, 2)[flights], lanes.lanes_m.reshape(-1, 2)[flights ^ 1]], axis=1)
    whole = [piece for way, lane in zip(lines, flown, strict=False) for piece in (way, lane)]
    if leave is not None:
        whole.append(lines[-1])
    return Coverage(
        heading_deg=heading_deg,
        spacing_m=area.spacing_m,
        lanes_m=frozen_floats(flown + origin),
        cell_of=frozen_ints(lanes.cell_of[flights // 2]),
        ways_m=tuple(frozen_floats(line + origin) for line in lines[1 : len(flown)]),
        approach_m=frozen_floats(lines[0] + origin),
        leaving_m=frozen_floats(np.empty((0, 2)) if leave is None else lines[-1] + origin),
        exact=order.exact,
        duration_s=pace.duration_s(np.concatenate(whole)),
    )
