"""Taut paths: the shortest polylines from target to target, each through a free space of its own.

Every target is a closed area; to touch its rim is to be there. The places at which a shortest path meets the rims are
found over samples of these, all stages at once, then over ever finer samples round the best ones, and at last exactly:
between fixed bends, the sum of two distances over a straight rim is least where the reflected line crosses it.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Final, TypeAlias

import numpy as np
import shapely

from mission.geometry.arrays import FloatArray
from mission.steering.free_space import FreeSpace
from mission.steering.layered_paths import Chain, LayeredPaths, NoWayError

_PLACES: Final = 40
"""Places on the rim of a target at most, its corners not counted."""
_APART: Final = 0.04
"""How far apart they need not be nearer, as a part of how far it is to other targets: what is lost is of its square."""
_MOST_CORNERS: Final = 60
_WINDOW: Final = 2
"""Finer places on each side of the best one."""
_FINER: Final = 3.0
_FINEST: Final = 0.2
"""Distance of the finest places, as a part of that of the first ones."""
_SWEEPS: Final = 200
_POLISHES: Final = 4


@dataclass(frozen=True, eq=False)
class Stretch:
    """What the next part of a path must do.

    Attributes:
        free: Where it may be: Polygon or MultiPolygon, metres.
        target: Where it ends: a closed area in ``free``, or a point.
        restart_m: Where the next one begins, shape (2,); None where that is where this one ends.
    """

    free: shapely.Geometry
    target: shapely.Geometry
    restart_m: FloatArray | None = None


@dataclass(frozen=True, eq=False)
class TautLine:
    """A part of a taut path.

    Attributes:
        points_m: Shape (n, 2), n >= 1; a single point where the target is reached without a move.
        free: Where it may be.
        stage: The stretch whose target it ends in, as an index into those that were given.
    """

    points_m: FloatArray
    free: shapely.Geometry
    stage: int

    @property
    def length_m(self) -> float:
        """Its length."""
        return float(np.hypot(*np.diff(self.points_m, axis=0).T).sum())


@dataclass(frozen=True, eq=False)
class TautPath:
    """A taut path.

    Attributes:
        lines: One for each stretch in the order in which they are flown; before a lap, one that leads to its begin.
        lap: The first line of the lap, which ends with the last one, where it begins; None without one.
    """

    lines: tuple[TautLine, ...]
    lap: int | None = None

    @property
    def length_m(self) -> float:
        """The length of all lines, each once."""
        return sum(line.length_m for line in self.lines)


Spaces: TypeAlias = dict[int, tuple[FreeSpace, shapely.Geometry]]
"""Free spaces by the identity of their geometries, for searches to share what they have seen."""


def taut_path(
    start_m: FloatArray,
    stretches: Sequence[Stretch],
    *,
    lap: int | None = None,
    entries: Sequence[int] = (),
    spaces: Spaces | None = None,
) -> TautPath:
    """The shortest path from a place to the targets of stretches in their order.

    Of a lap, the round is made shortest, and then the way to it.

    Args:
        start_m: Shape (2,).
        stretches: At least one.
        lap: The first stretch of those, to the last one, that are repeated; None where none are.
        entries: Stretches of the lap with which it may begin; by default with ``lap``.
        spaces: Those that are known already, to which others are added.

    Raises:
        NoWayError: There is no such path.
    """
    search = _Search({} if spaces is None else spaces)
    start = np.asarray(start_m, dtype=np.float64).reshape(2)
    if lap is None:
        return TautPath(tuple(search.lines(start, list(enumerate(stretches)))))
    round_ = search.round(list(enumerate(stretches))[lap:])
    best: tuple[float, list[TautLine], int] | None = None
    blocked: NoWayError | None = None
    for entry in entries or (lap,):
        begin = round_[entry - lap]
        last = entry - 1 if entry > lap else len(stretches) - 1
        approach = Stretch(begin.free, shapely.Point(begin.points_m[0]))
        try:
            lines = search.lines(start, [*enumerate(stretches[:lap]), (last, approach)])
        except NoWayError as error:
            blocked = error
            continue
        length = sum(line.length_m for line in lines)
        if best is None or length < best[0] - search.rounding(length):
            best = length, lines, entry - lap
    if best is None:
        raise blocked or NoWayError(lap, "no way leads to the lap")
    _, lines, first = best
    return TautPath((*lines, *round_[first:], *round_[:first]), len(lines))


class _Search:
    """Searches that share their free spaces."""

    def __init__(self, spaces: Spaces) -> None:
        self._spaces = spaces

    @staticmethod
    def rounding(length_m: float) -> float:
        return 1e-9 * length_m

    def lines(self, start_m: FloatArray, stretches: list[tuple[int, Stretch]]) -> list[TautLine]:
        """The lines of stretches that are flown once, with their numbers."""
        found: list[TautLine] = []
        begin = 0
        for index, (_, stretch) in enumerate(stretches):
            if stretch.restart_m is None and index < len(stretches) - 1:
                continue
            found.extend(self._open(start_m, stretches[begin : index + 1]))
            begin = index + 1
            if stretch.restart_m is not None:
                start_m = np.asarray(stretch.restart_m, dtype=np.float64).reshape(2)
        return found

    def round(self, stretches: list[tuple[int, Stretch]]) -> list[TautLine]:
        """The lines of stretches that are flown again and again."""
        cuts = [index for index, (_, stretch) in enumerate(stretches) if stretch.restart_m is not None]
        if cuts:
            cut, restart = cuts[-1] + 1, stretches[cuts[-1]][1].restart_m
            found = self.lines(np.asarray(restart, dtype=np.float64), [*stretches[cut:], *stretches[:cut]])
            return [*found[len(stretches) - cut :], *found[: len(stretches) - cut]]
        # Cut at the smallest target, of which the fewest places must be tried.
        cut = 1 + min(range(len(stretches)), key=lambda index: float(shapely.length(stretches[index][1].target)))
        turned = [*stretches[cut:], *stretches[:cut]]
        found = self._solved(_Layers(None, [stretch.target for _, stretch in turned]), turned)
        return [*found[len(stretches) - cut :], *found[: len(stretches) - cut]]

    def _open(self, start_m: FloatArray, stretches: list[tuple[int, Stretch]]) -> list[TautLine]:
        return self._solved(_Layers(start_m, [stretch.target for _, stretch in stretches]), stretches)

    def _solved(self, layers: "_Layers", stretches: list[tuple[int, Stretch]]) -> list[TautLine]:
        for number, each in stretches:
            if shapely.is_empty(each.free) or shapely.is_empty(each.target):
                raise NoWayError(number, "there is no place that it could be reached at")
        try:
            paths = LayeredPaths([self._space(each.free) for _, each in stretches], cyclic=layers.cyclic)
            places, share = layers.first(), 1.0
            chain = paths.shortest(places)
            while share > _FINEST:
                # A path that is better than the best one so far is near one over these places.
                paths.forget_beyond(chain.length_m + 1.4 * share * layers.steps_m, places)
                share /= _FINER
                places = layers.near(_passed(places, chain), share)
                chain = paths.shortest(places)
            for _ in range(_POLISHES):
                polished = layers.polished(chain.lines)
                found = paths.shortest([point[None] for point in polished])
                gained = chain.length_m - found.length_m
                if gained < 0.0:
                    break
                chain = found
                if gained <= self.rounding(chain.length_m):
                    break
        except NoWayError as error:
            raise NoWayError(stretches[error.stage][0], str(error)) from error
        return [
            TautLine(_distinct(line), stretch.free, number)
            for line, (number, stretch) in zip(chain.lines, stretches, strict=True)
        ]

    def _space(self, free: shapely.Geometry) -> FreeSpace:
        if id(free) not in self._spaces:
            self._spaces[id(free)] = FreeSpace(free), free
        return self._spaces[id(free)][0]


class _Layers:
    """The places of each layer: a start, if there is one, then the rims of targets.

    Args:
        start_m: Shape (2,); None where the path is a round, which then begins at the last target.
        targets: Areas or points.
    """

    def __init__(self, start_m: FloatArray | None, targets: list[shapely.Geometry]) -> None:
        self._start_m, self._targets = start_m, targets
        self.cyclic = start_m is None
        others = [targets[-1] if start_m is None else shapely.Point(start_m), *targets]
        apart = [float(shapely.distance(one, other)) for one, other in pairwise(others)]
        after = [*apart[1:], apart[0] if start_m is None else np.inf]
        self._rims = [_Rim(target, min(near)) for target, *near in zip(targets, apart, after, strict=True)]
        self.steps_m = sum(rim.step_m for rim in self._rims)

    def first(self) -> list[FloatArray]:
        """Places all round the rims."""
        return self._layered([rim.places() for rim in self._rims])

    def near(self, points: list[FloatArray], share: float) -> list[FloatArray]:
        """Places round one of each layer, ``points`` in the order of the layers, by a share of the first distance."""
        return self._layered(
            [
                np.concatenate((point[None], rim.around(point, share * rim.step_m)))
                for point, rim in zip(points[1:], self._rims, strict=True)
            ]
        )

    def _layered(self, own: list[FloatArray]) -> list[FloatArray]:
        """With the places of the layer before that lie in a target: there, nothing is left to do."""
        if self.cyclic:
            closing = np.concatenate((own[-1], self._rims[-1].those_inside(own[-2]))) if len(own) > 1 else own[-1]
            layers = [closing]
        else:
            layers = [np.asarray(self._start_m)[None]]
        for rim, places in zip(self._rims, own, strict=True):
            layers.append(np.concatenate((places, rim.those_inside(layers[-1]))))
        if self.cyclic:
            layers[-1] = layers[0]
        return layers

    def polished(self, lines: Sequence[FloatArray]) -> list[FloatArray]:
        """Where the layers are passed best while the bends between them stay; shape (2,) for each layer."""
        points = [lines[0][0], *(line[-1] for line in lines)]
        bends = [line[1:-1] for line in lines]
        count = len(lines)
        for _ in range(_SWEEPS):
            moved = 0.0
            for k in range(1, count + 1):
                before = bends[k - 1][-1] if len(bends[k - 1]) else points[k - 1]
                if k < count:
                    after = bends[k][0] if len(bends[k]) else points[k + 1]
                elif self.cyclic:
                    after = bends[0][0] if len(bends[0]) else points[1]
                else:
                    after = None
                better = self._rims[k - 1].best(points[k], before, after)
                moved = max(moved, float(np.abs(better - points[k]).max()))
                points[k] = better
                if self.cyclic and k == count:
                    points[0] = better
            if moved <= 1e-12 * (1.0 + float(np.abs(points[0]).max())):
                break
        return points


class _Rim:
    """The rim of a target, or a point.

    Args:
        target: Area or point.
        apart_m: How far it is from the targets before and after it.
    """

    def __init__(self, target: shapely.Geometry, apart_m: float) -> None:
        self._target = target
        self._is_point = shapely.get_dimensions(target) == 0
        rings = (
            []
            if self._is_point
            else [shapely.get_coordinates(ring) for ring in shapely.get_rings(shapely.get_parts(target))]
        )
        self._rings = rings
        self._measures = [np.append(0.0, np.cumsum(np.hypot(*np.diff(ring, axis=0).T))) for ring in rings]
        total = sum(float(measure[-1]) for measure in self._measures)
        self.step_m = min(max(total / _PLACES, _APART * apart_m), total)
        self._edges = np.concatenate([np.stack((r[:-1], r[1:]), axis=1) for r in rings]) if rings else None
        bounds = np.abs(np.array(shapely.bounds(target))).max()
        self._hair_m = max(1e-8, 1e-9 * float(bounds))

    def places(self) -> FloatArray:
        """Places all round, and the corners."""
        if self._is_point:
            point: FloatArray = shapely.get_coordinates(self._target)[:1]
            return point
        found = []
        for ring, measure in zip(self._rings, self._measures, strict=True):
            count = max(4, int(np.ceil(measure[-1] / self.step_m)))
            found.append(_at(ring, measure, np.arange(count) * measure[-1] / count))
            if len(ring) <= _MOST_CORNERS:
                found.append(ring[:-1])
        return np.concatenate(found)

    def around(self, point: FloatArray, step_m: float) -> FloatArray:
        """Places on the rim on both sides of one near it, and the corners among them."""
        if self._is_point:
            return np.empty((0, 2))
        found = []
        for ring, measure in zip(self._rings, self._measures, strict=True):
            line = shapely.LineString(ring)
            if line.distance(shapely.Point(point)) > self._hair_m:
                continue
            middle, reach = float(line.project(shapely.Point(point))), _WINDOW * step_m
            s = middle + np.arange(-_WINDOW, _WINDOW + 1) * step_m
            found.append(_at(ring, measure, np.mod(s, measure[-1])))
            away = np.abs(np.mod(measure[:-1] - middle + 0.5 * measure[-1], measure[-1]) - 0.5 * measure[-1])
            found.append(ring[:-1][away <= reach])
        return np.concatenate(found) if found else np.empty((0, 2))

    def those_inside(self, places: FloatArray) -> FloatArray:
        """Those of some places that lie in the target."""
        inside: FloatArray = places[shapely.dwithin(self._target, shapely.points(places), self._hair_m)]
        return inside

    def best(self, point: FloatArray, before: FloatArray, after: FloatArray | None) -> FloatArray:
        """Where on the edges of the rim at a place the way between two others is shortest."""
        if self._edges is None or (before == point).all():
            return point
        begins, ends = self._edges[:, 0], self._edges[:, 1]
        along = ends - begins
        squares = (along**2).sum(axis=1)
        share = np.clip(((point - begins) * along).sum(axis=1) / squares, 0.0, 1.0)
        near = np.hypot(*(begins + share[:, None] * along - point).T) <= self._hair_m
        if not near.any():
            return point
        begins, along, squares = begins[near], along[near], squares[near]
        across = np.stack((-along[:, 1], along[:, 0]), axis=1)
        first = ((before - begins) * across).sum(axis=1)
        at_first = ((before - begins) * along).sum(axis=1) / squares
        if after is None:
            share = at_first
        else:
            second = ((after - begins) * across).sum(axis=1)
            at_second = ((after - begins) * along).sum(axis=1) / squares
            weights = np.abs(first) + np.abs(second)
            share = np.where(
                weights > 0.0,
                (np.abs(second) * at_first + np.abs(first) * at_second) / np.maximum(weights, 1e-300),
                0.0,
            )
        places = np.concatenate((begins + np.clip(share, 0.0, 1.0)[:, None] * along, point[None]))
        lengths = np.hypot(*(places - before).T)
        if after is not None:
            lengths = lengths + np.hypot(*(places - after).T)
        found: FloatArray = places[int(np.argmin(lengths))] if lengths.min() < lengths[-1] else point
        return found


def _at(ring: FloatArray, measure: FloatArray, s: FloatArray) -> FloatArray:
    return np.stack([np.interp(s, measure, ring[:, axis]) for axis in (0, 1)], axis=1)


def _passed(places: list[FloatArray], chain: Chain) -> list[FloatArray]:
    return [layer[place] for layer, place in zip(places, chain.places, strict=True)]


def _distinct(line: FloatArray) -> FloatArray:
    """A line without points that repeat the one before."""
    kept = np.append(True, np.hypot(*np.diff(line, axis=0).T) > 0.0)
    distinct: FloatArray = line[kept]
    return distinct
