"""Covers the regions that ask for it: by lanes where the tube stays inside, flown from and to one place of rest."""

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from itertools import product
from typing import Any, Final

import numpy as np
import shapely

from mission.coverage.coverage import Coverage
from mission.coverage.covering import cover
from mission.coverage.flown import covered_share, swath_of
from mission.coverage.pace import Pace
from mission.errors import GeometryError, NoPlanError
from mission.geometry.arrays import BoolArray, FloatArray, frozen_floats
from mission.geometry.regions import Labelling, union_of
from mission.geometry.simplices import Partition
from mission.plan.reached import nearest_m, reached, shrunk
from mission.spec.camera import spacing_of, trigger_of
from mission.spec.finding import listed
from mission.spec.model import Cost, Cover, MissionSpec, Point, Region
from mission.steering.path import SteeringPath
from mission.steering.rounded import RoundedPolyline
from mission.steering.rounding import rounded_within
from mission.steering.timing import level_acceleration

_ROUNDING: Final = 1.01  # arcs are drawn with chords, which are a little nearer
_ROOM: Final = 1.0 / 20.0
"""How far lanes stay from where the tube would end, of the spacing, so that corners can be rounded there."""
_MOST_ROOM_M: Final = 0.25  # likewise for ways, at most, since passages may be narrow
_STEPS: Final = 1.0 / 30.0  # of the spacing: smaller steps to the side are left out
_LANE_ENDS: Final = (1.0 / 2.0, 1.0 / 3.0)
"""Widest reaches at the end of a lane, of the spacing; for cameras the last."""
SHARE_TO_SPARE: Final = 0.005
"""Of a region, what a flight may leave out that its lanes cover: as much as is usual in wind."""
_ROUND_ENDS: Final = 0.5  # of that: what the round ends of lanes are expected to leave out
_MISSING: Final = 1.5  # times what they leave out beside that, that is asked for in addition
_WAY: Final = 1.0  # widest reach elsewhere, likewise
_SAMPLES: Final = 9  # of a rounded corner


@dataclass(frozen=True, eq=False)
class CoveredVisit:
    """The lanes of one visit, on the planned path.

    Attributes:
        region: Name of the region.
        start_s: Steering time at which the vehicle sets out for the first lane.
        spacing_m: Distance between lanes.
        heading_deg: Of the lanes, clockwise from north.
        lanes_m: Shape (n, 2, 2): lane, begin and end, east and north.
        lanes_s: Shape (n, 2): steering time at which each begins and ends.
        ways_m: Length of the ways between lanes.
        exact: Whether no other order of the lanes' cells takes less time.
        trigger_m: Distance between images in a lane; None where none are taken.
        share: How much of the region must really be covered.
        planned_share: How much of it a flight covers that keeps to the path.
        before: What of it was covered by an earlier plan of the same visit; None where nothing was.
        first_s: Steering time of the first image, where these lanes are the rest of a visit, and the first one may be
            of a lane: its end where none is taken in it. None where that is at its begin.
    """

    region: str
    start_s: float
    spacing_m: float
    heading_deg: float
    lanes_m: FloatArray
    lanes_s: FloatArray
    ways_m: float
    exact: bool
    trigger_m: float | None
    share: float
    planned_share: float
    before: shapely.Geometry | None = None
    first_s: float | None = None

    def __post_init__(self) -> None:
        object.__setattr__(self, "lanes_m", frozen_floats(self.lanes_m))
        object.__setattr__(self, "lanes_s", frozen_floats(self.lanes_s))

    @property
    def imaged_s(self) -> FloatArray:
        """Shape (n, 2): steering time of the first image of each lane that is taken, and of the lane's end."""
        begins, ends = self.lanes_s.T
        return np.stack((np.append(begins[:1] if self.first_s is None else self.first_s, begins[1:]), ends), axis=1)

    @property
    def lanes_length_m(self) -> float:
        """Length of all lanes."""
        return float(np.linalg.norm(self.lanes_m[:, 1] - self.lanes_m[:, 0], axis=1).sum())

    def figures(self) -> dict[str, Any]:
        """What there is to tell of the lanes, as JSON values."""
        return {
            "region": self.region,
            "lanes": len(self.lanes_m),
            "spacing_m": self.spacing_m,
            "heading_deg": self.heading_deg,
            "lanes_length_m": self.lanes_length_m,
            "ways_length_m": self.ways_m,
            "trigger_m": self.trigger_m,
            "exact": self.exact,
            "planned_share": self.planned_share,
        }

    def to_json(self) -> dict[str, Any]:
        """The visit as JSON values; ``from_json`` gives it back bit by bit."""
        return {
            "region": self.region,
            "start_s": self.start_s,
            "spacing_m": self.spacing_m,
            "heading_deg": self.heading_deg,
            "lanes_m": self.lanes_m.tolist(),
            "lanes_s": self.lanes_s.tolist(),
            "ways_m": self.ways_m,
            "exact": self.exact,
            "trigger_m": self.trigger_m,
            "share": self.share,
            "planned_share": self.planned_share,
            "before": None if self.before is None else _rings_of(self.before),
            "first_s": self.first_s,
        }

    @staticmethod
    def from_json(data: Mapping[str, Any]) -> "CoveredVisit":
        """The visit that ``to_json`` wrote; raises KeyError, TypeError or ValueError where it is none."""
        trigger, first = data["trigger_m"], data.get("first_s")
        return CoveredVisit(
            region=str(data["region"]),
            start_s=float(data["start_s"]),
            spacing_m=float(data["spacing_m"]),
            heading_deg=float(data["heading_deg"]),
            lanes_m=np.array(data["lanes_m"], dtype=np.float64).reshape(-1, 2, 2),
            lanes_s=np.array(data["lanes_s"], dtype=np.float64).reshape(-1, 2),
            ways_m=float(data["ways_m"]),
            exact=bool(data["exact"]),
            trigger_m=None if trigger is None else float(trigger),
            share=float(data["share"]),
            planned_share=float(data["planned_share"]),
            before=None if data.get("before") is None else _of_rings(data["before"]),
            first_s=None if first is None else float(first),
        )


@dataclass(frozen=True)
class Passage:
    """Where lanes and ways between them may lead while a region is covered, by numbers of letters.

    Attributes:
        closed: The letters that violate the mission then.
        idle: Those that change nothing of what is yet to be done.
    """

    closed: frozenset[int] = frozenset()
    idle: frozenset[int] = frozenset()


@dataclass(frozen=True, eq=False)
class _Lanes:
    """Lanes as they are flown from one place, when each begins and ends, as in ``CoveredVisit``, and about how long."""

    region: str
    cover: Cover
    coverage: Coverage
    curve: RoundedPolyline
    lanes_s: FloatArray
    share: float
    lasts_s: float


_Through = tuple[Point, Point] | None


@dataclass(frozen=True, eq=False)
class Covering:
    """Covers the regions of one mission; what was found for a place is kept.

    Attributes:
        spec: The mission.
        partition: Its triangles.
        labelling: Their labels.
        restricted: Shape (M,), the triangles that must not be entered.
    """

    spec: MissionSpec
    partition: Partition
    labelling: Labelling
    restricted: BoolArray
    _found: dict[tuple[str, Passage, Point, _Through], _Lanes] = field(default_factory=dict, init=False)

    def lanes(self, region: Region, passage: Passage, place_m: Point, through: _Through = None) -> RoundedPolyline:
        """The curve that covers a region.

        Args:
            region: The region.
            passage: What the mission has against letters at that time.
            place_m: A place inside, at which the curve begins and ends.
            through: Places from and to which the vehicle flies; the curve then begins with the first lane, and ends
                with the last one.

        Raises:
            NoPlanError: No lanes fit, they are too many, or too few of them can be reached.
        """
        key = region.name, passage, place_m, through
        if key not in self._found:
            self._found[key] = self._lanes(*key)
        return self._found[key].curve

    def visit(self, curve: RoundedPolyline, start_s: float) -> CoveredVisit:
        """The lanes of a curve from ``lanes`` that is flown from a steering time on."""
        lanes = next(lanes for lanes in self._found.values() if lanes.curve is curve)
        return self._visit(lanes, start_s)

    def visits(self, path: SteeringPath) -> tuple[CoveredVisit, ...]:
        """The lanes on a path that was built with ``lanes``, in the order of time."""
        of_curve = {id(lanes.curve): lanes for lanes in self._found.values()}
        return tuple(
            self._visit(of_curve[id(segment.lanes)], segment.start_s)
            for segment in path.segments
            if segment.lanes is not None and id(segment.lanes) in of_curve
        )

    def _lanes(self, name: str, passage: Passage, place_m: Point, through: _Through) -> _Lanes:
        region = next(region for region in self.spec.regions if region.name == name)
        asked = region.cover
        if asked is None:
            raise ValueError(f"{region.name} is not to be covered")
        flight = self.spec.flight
        spacing_m = spacing_of(asked, flight.altitude_m)
        inside = np.zeros(len(self.restricted), dtype=np.bool_)
        inside[self.labelling.triangles_of(region.name)] = True
        inside &= ~self.restricted
        area = union_of(self.partition, inside)
        of, letters = self.labelling.letter_of, self.labelling.letters
        entered = inside & ~np.isin(of, list(passage.closed))
        # Ways between lanes lead over what has no other label than the region itself has, and what changes nothing.
        own = set().union(*(letters[i] for i in np.unique(of[entered]).tolist()))
        stays = {each.name for each in self.spec.regions if each.loiter_s > 0.0} - own
        plain = [
            number not in passage.closed and (letter <= own or (number in passage.idle and not letter & stays))
            for number, letter in enumerate(letters)
        ]
        tube_m = _ROUNDING * math.sqrt(2.0) * flight.tube_m
        room_m = _ROOM * spacing_m
        narrow_m = min(room_m, _MOST_ROOM_M)
        free = shrunk(union_of(self.partition, np.array(plain)[of] & ~self.restricted), tube_m)
        ground = shrunk(union_of(self.partition, entered), tube_m + room_m)
        place = shapely.Point(place_m)
        ways = shapely.union_all([shrunk(free, narrow_m), ground, place.buffer(narrow_m).intersection(free)])
        forbidden = sorted(set().union(*(letters[i] for i in np.unique(of[inside & ~entered]).tolist())) - own)
        lost = f"; the lanes keep out of {listed(forbidden)}, as the mission asks then" if forbidden else ""
        ground, ways = reached(region, ground, ways, place, lost)
        entry_m, exit_m = (nearest_m(ways, there) for there in through) if through else (place_m, place_m)
        least = asked.share + SHARE_TO_SPARE
        reaches = _LANE_ENDS if trigger_of(asked, flight.altitude_m) is None else _LANE_ENDS[-1:]

        def planned(share: float, reach: float) -> Coverage:
            try:
                return cover(
                    area,
                    ground,
                    ways,
                    spacing_m=spacing_m,
                    entry_m=entry_m,
                    exit_m=exit_m,
                    pace=self._pace(reach * spacing_m),
                    heading_deg=asked.heading_deg,
                    share=share,
                )
            except GeometryError as error:
                widths = f"lanes {spacing_m:.4g} m apart in a tube of {flight.tube_m:.3g} m on each side"
                message = f"{name} cannot be covered by {widths}: {error}{lost}"
                raise NoPlanError(message, regions=(name,)) from error

        def flown(coverage: Coverage, reach: float) -> _Lanes:
            return self._flown(name, asked, coverage, area, free, reach=reach, alone=through is None)

        wanted, wide = least + _ROUND_ENDS * SHARE_TO_SPARE, reaches[0]
        coverage = planned(wanted, wide)
        found = [flown(coverage, wide)]
        if found[0].share < least:
            # Rounding takes more than expected: ends are less round, or that is asked for as well, whichever is sooner.
            more = planned(min(1.0, wanted + _MISSING * (least - found[0].share)), wide)
            found += [flown(lanes, reach) for lanes, reach in product((coverage, more), reaches)]
        if all(lanes.share < least for lanes in found):
            found.append(flown(planned(1.0, reaches[-1]), reaches[-1]))
        return min(found, key=lambda lanes: (lanes.share < least, lanes.lasts_s))

    def _pace(self, reach_m: float) -> Pace:
        """How fast lanes are flown, with their corners rounded within so much."""
        flight, limits = self.spec.flight, self.spec.limits
        acceleration = level_acceleration(limits.acceleration_m_s2, limits.tilt_rad)
        # By length, turns cost nothing: as if they were flown at full speed.
        by_length = self.spec.search.cost is Cost.DISTANCE
        speed_m_s = min(flight.speed_m_s, limits.speed_m_s)
        return Pace(speed_m_s, math.inf if by_length else acceleration, limits.jerk_m_s3, reach_m)

    def _flown(
        self,
        name: str,
        asked: Cover,
        coverage: Coverage,
        area: shapely.Geometry,
        free: shapely.Geometry,
        *,
        reach: float,
        alone: bool,
    ) -> _Lanes:
        """Lanes rounded within a reach, of the spacing, at their ends; alone, with the ways there and back."""
        flight, spacing_m = self.spec.flight, coverage.spacing_m
        before, after = (coverage.approach_m[:-1], coverage.leaving_m[1:]) if alone else (coverage.line_m[:0],) * 2
        line = np.concatenate((before, coverage.line_m, after))
        # Of each lane the first point of the line; the second is the next one.
        begins = len(before) + np.flatnonzero(coverage.on_lane)
        ends = np.stack((begins, begins + 1), axis=1)
        widest = np.full(len(line), _WAY * spacing_m)
        widest[ends] = reach * spacing_m
        curve, passed_s = rounded_within(
            line, free, tolerance_m=_STEPS * spacing_m, widest_m=widest, speed_m_s=flight.speed_m_s
        )
        share = covered_share(area, swath_along(curve, passed_s[ends], spacing_m))
        beside_m = (
            0.0
            if alone
            else sum(map(shapely.length, map(shapely.linestrings, (coverage.approach_m, coverage.leaving_m))))
        )
        lasts_s = self._pace(reach * spacing_m).duration_s(curve.corners_m, curve.reaches_m)
        lasts_s += beside_m / flight.speed_m_s
        return _Lanes(name, asked, coverage, curve, passed_s[ends], share, lasts_s)

    def _visit(self, lanes: _Lanes, start_s: float) -> CoveredVisit:
        coverage = lanes.coverage
        return CoveredVisit(
            region=lanes.region,
            start_s=start_s,
            spacing_m=coverage.spacing_m,
            heading_deg=coverage.heading_deg,
            lanes_m=coverage.lanes_m,
            lanes_s=start_s + lanes.lanes_s,
            ways_m=coverage.ways_length_m,
            exact=coverage.exact,
            trigger_m=trigger_of(lanes.cover, self.spec.flight.altitude_m),
            share=lanes.cover.share,
            planned_share=lanes.share,
        )


def _rings_of(area: shapely.Geometry) -> list[list[list[list[float]]]]:
    """The rings of each polygon of an area, the outer one first."""
    polygons = [part for part in shapely.get_parts(area) if shapely.get_dimensions(part) == 2]  # noqa: PLR2004 - areas
    return [[shapely.get_coordinates(ring).tolist() for ring in shapely.get_rings(part)] for part in polygons]


def _of_rings(parts: list[list[list[list[float]]]]) -> shapely.Geometry:
    """The area of these rings; raises ValueError where it is none."""
    area = shapely.multipolygons([shapely.Polygon(outer, holes) for outer, *holes in parts])
    if not shapely.is_valid(area):
        raise ValueError("what was covered before is no area")
    return area


def swath_along(curve: RoundedPolyline, lanes_s: FloatArray, spacing_m: float) -> shapely.Geometry:
    """What is within half a spacing of a curve where it flies lanes, by the measure of what is flown."""
    # The curve is straight but for its blends, which every other piece is.
    blends = curve.knots_s[1:-1].reshape(-1, 2)
    shares = np.linspace(0.0, 1.0, _SAMPLES)
    knots = np.concatenate((lanes_s.ravel(), (blends[:, :1] + shares * np.diff(blends, axis=1)).ravel()))
    times_s, at = np.unique(knots, return_inverse=True)
    track, (begins, ends) = curve.position(times_s), at[: lanes_s.size].reshape(-1, 2).T.tolist()
    return swath_of((track[begin : end + 1] for begin, end in zip(begins, ends, strict=True)), spacing_m)
