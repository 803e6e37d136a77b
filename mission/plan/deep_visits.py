"""Ways to the roomiest place of a region that a run only touches: a circle's rim has thin triangles.

A run enters some triangle of a region, and its path settles there. Where that is thin, the region may have much more
room farther in: then the path goes on from there on a straight line, comes to rest, and returns. The letters that it
reads on this way are those that the run reads there, or change nothing.
"""

import math
from dataclasses import dataclass, field
from typing import Final

import numpy as np
import shapely
from shapely.ops import polylabel

from mission.geometry.arrays import BoolArray, FloatArray
from mission.geometry.regions import Labelling, union_of
from mission.geometry.simplices import Partition
from mission.plan.covering import Passage
from mission.spec.model import MissionSpec, Point, Region
from mission.steering.rounded import RoundedPolyline

_TUBES: Final = 1.25
"""Deep enough for a visit, of the depth that the tube's corners need; or half of the greatest, if that is less."""

_HALF: Final = 0.5
_TO_LOITER: Final = 0.25
"""Deep enough to loiter, of the greatest depth: somebody who looks round there is to stand inside, not at the rim."""

_TURN: Final = 1.0 / 16.0
"""Reach of the turn at the far end, of the way there; it ends 3/8 of that before the place."""


@dataclass(frozen=True, eq=False)
class DeepVisits:
    """The roomiest places of the regions of one mission.

    Attributes:
        spec: The mission.
        partition: Its triangles.
        labelling: Their labels.
    """

    spec: MissionSpec
    partition: Partition
    labelling: Labelling
    _found: dict[tuple[str, frozenset[int]], tuple[shapely.Geometry, FloatArray, FloatArray]] = field(
        default_factory=dict, init=False
    )

    def deeper(self, region: Region, passage: Passage, triangle: int) -> Point | None:
        """The roomiest place of a region that is seen from where a path settles; None where that is deep enough.

        Args:
            region: The region.
            passage: What the mission has against letters at that time.
            triangle: Of the region, in which the path settles.
        """
        area, places, depths_m = self._places(region, passage, int(self.labelling.letter_of[triangle]))
        here = shapely.Point(self.partition.incentres_m[triangle])
        depth_m = float(shapely.distance(area.boundary, here)) if area.covers(here) else 0.0
        deepest_m = float(depths_m[0])
        enough_m = min(_HALF * deepest_m, _TUBES * math.sqrt(2.0) * self.spec.flight.tube_m)
        if region.loiter_s > 0.0:
            enough_m = max(enough_m, _TO_LOITER * deepest_m)
        if depth_m >= enough_m:
            return None
        ways = shapely.linestrings(np.stack((np.broadcast_to(here.coords[0], places.shape), places), axis=1))
        seen = np.flatnonzero(shapely.covers(area, ways) & (depths_m > 2.0 * depth_m))
        return None if not len(seen) else (float(places[seen[0], 0]), float(places[seen[0], 1]))

    def way(self, place_m: Point, deep_m: Point) -> RoundedPolyline:
        """The curve from a place to another and back."""
        length_m = math.dist(place_m, deep_m)
        return RoundedPolyline(
            np.array([place_m, deep_m, place_m]), np.array([_TURN * length_m]), self.spec.flight.speed_m_s
        )

    def _places(self, region: Region, passage: Passage, letter: int) -> tuple[shapely.Geometry, FloatArray, FloatArray]:
        """Where one may be in a region, and places in it, shape (P, 2), with their depths (P,), the deepest first."""
        stays = {each.name for each in self.spec.regions if each.loiter_s > 0.0}
        own, letters = self.labelling.letters[letter], self.labelling.letters
        plain = {
            number
            for number in passage.idle - passage.closed
            if region.name in letters[number] and not (letters[number] - own) & stays
        } | {letter}
        key = region.name, frozenset(plain)
        if key not in self._found:
            inside: BoolArray = np.zeros(self.partition.size, dtype=np.bool_)
            inside[self.labelling.triangles_of(region.name)] = True
            inside &= np.isin(self.labelling.letter_of, list(plain))
            area = union_of(self.partition, inside)
            parts = [part for part in shapely.get_parts(area) if part.area > 0.0]
            middles = [shapely.get_coordinates(polylabel(part, 0.01 * math.sqrt(part.area)))[0] for part in parts]
            places = np.concatenate((np.array(middles), self.partition.incentres_m[inside]))
            depths_m = shapely.distance(area.boundary, shapely.points(places))
            order = np.argsort(-depths_m, kind="stable")
            shapely.prepare(area)
            self._found[key] = area, places[order], depths_m[order]
        return self._found[key]
