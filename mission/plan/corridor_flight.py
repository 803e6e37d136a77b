"""What is flown through a corridor: taut lines with what is done at their ends, and the curves along them."""

from collections.abc import Callable, Iterator, Sequence
from itertools import accumulate
from typing import NamedTuple

import numpy as np

from mission.errors import UnprovedError
from mission.geometry.arrays import FloatArray
from mission.plan.kept import Kept
from mission.steering.bezier import DEGREE, BezierCurve
from mission.steering.corridor import LONGEST, Way, estimated_s, smooth_ways
from mission.steering.joined import Curve, JoinedCurve, Piece
from mission.steering.motion import Motion, Pace
from mission.steering.polyline import Polyline
from mission.steering.rounded import RoundedPolyline


class Line(NamedTuple):
    """A taut line with what is done at its end.

    Attributes:
        way: The line.
        held_s: How long the vehicle loiters at its end; 0 where it does not.
        lanes: The lanes that are flown then.
    """

    way: Way
    held_s: float = 0.0
    lanes: RoundedPolyline | None = None

    @property
    def rests(self) -> bool:
        """Whether the vehicle rests at its end."""
        return rests((self.held_s, self.lanes))


def rests(done: tuple[float, RoundedPolyline | None]) -> bool:
    """Whether the vehicle rests where so long is loitered, or where lanes are flown."""
    held_s, lanes = done
    return held_s > 0.0 or lanes is not None


class Flown:
    """The curves along lines, what they are joined of, and what is done on them.

    Args:
        pace: What the vehicle can do.
        to_lap: The lines that are flown once.
        lap: Those of the lap; it begins at a rest, or has none.
        onward: What is flown before, or the motion with which the curve begins; None at rest.
        kept: What is flown as it was in a plan before.
        begun: Given the first curve from a motion to a rest, before anything else is made.
    """

    def __init__(
        self,
        pace: Pace,
        to_lap: Sequence[Line],
        lap: Sequence[Line],
        onward: BezierCurve | Motion | None,
        kept: Kept,
        *,
        begun: Callable[[Piece], None],
    ) -> None:
        self._kept, self._begun = kept, begun
        self._pace, self._begins = pace, None if isinstance(onward, BezierCurve) else onward
        self._pieces: list[Piece] = [onward] if isinstance(onward, BezierCurve) else []
        self._stops: list[tuple[int, float]] = []  # after so many pieces, seconds
        self._lanes: list[tuple[RoundedPolyline, int]] = []  # with so many pieces before
        through = bool(lap) and not any(line.rests for line in lap)
        lap_from = None
        if through:
            *groups, last = _groups([*to_lap, *lap])
            lap_from = self._fly_through(groups, last, len(lap))
        else:
            self._fly(_groups(to_lap))
            if lap:
                lap_from = len(self._pieces)
                self._fly(_groups(lap))
        if not self._pieces:
            self._pieces.append(_standing(to_lap[-1].way.points_m[-1]))
        self._lap_from, self._through = lap_from, through

    def _fly(self, groups: Sequence[Sequence[Line]]) -> None:
        before: Motion | None = None
        for group in groups:
            lanes = group[-1].lanes
            into = None if lanes is None else _motion(lanes, 0.0)
            starts = not self._pieces
            self._pieces.extend(self._joining(group, before, into))
            if starts and self._pieces and self._begins is not None and into is None:
                self._begun(self._pieces[0])
            self._end(group[-1])
            before = None if lanes is None else _motion(lanes, lanes.duration_s)

    def _joining(self, group: Sequence[Line], before: Motion | None, into: Motion | None) -> tuple[Piece, ...]:
        """The curve along lines from lanes, or to lanes, flown through where that is sooner, with a rest elsewhere."""
        if _stands(group) or (before is None and into is None):
            return self._smooth(group, None)
        found: list[tuple[float, BezierCurve]] = []
        taut_m = sum(float(np.hypot(*np.diff(line.way.points_m, axis=0).T).sum()) for line in group)
        pace, begins = self._pace, None if self._pieces else self._begins
        # A rest costs as well where the lanes begin, or end.
        rest_s = 0.5 * (pace.speed_m_s / pace.acceleration_m_s2 + pace.acceleration_m_s2 / pace.jerk_m_s3)
        for first, last in dict.fromkeys(((1, 1), (1, 0), (0, 1), (0, 0))):
            onward, end = (before if first else None) or begins, into if last else None
            rests = (before is not None and not first) + (into is not None and not last)
            try:
                (curve,) = smooth_ways([line.way for line in group], pace, onward=onward, into=end)
            except UnprovedError:
                continue
            if rests == 0 or curve.length_m <= LONGEST * taut_m or (first, last) == (0, 0):
                found.append((estimated_s(curve, pace, onward, end) + rests * rest_s, curve))
        if not found:
            return self._smooth(group, None)
        return (min(found, key=lambda one: one[0])[1],)

    def _fly_through(self, groups: Sequence[Sequence[Line]], last: Sequence[Line], laps: int) -> int:
        self._fly(groups)
        curves = self._smooth(last, len(last) - laps)
        self._pieces.extend(curves)
        return len(self._pieces) - 1

    def _smooth(self, group: Sequence[Line], lap: int | None) -> tuple[Piece, ...]:
        if _stands(group):
            return ()
        onward = None if self._pieces else self._begins
        known = self._kept.curve(group[0].way.points_m) if onward is None and lap is None and len(group) == 1 else None
        if known is not None:
            return (known,)
        return smooth_ways([line.way for line in group], self._pace, lap=lap, onward=onward)

    def _end(self, line: Line) -> None:
        if line.held_s > 0.0:
            self._stops.append((len(self._pieces), line.held_s))
        if line.lanes is not None:
            self._lanes.append((line.lanes, len(self._pieces)))
            self._pieces.append(line.lanes)

    @property
    def moves(self) -> bool:
        """Whether there is any curve: who begins where the flight may end need not move."""
        return bool(self._pieces)

    @property
    def curve(self) -> JoinedCurve:
        """The whole curve."""
        cut = len(self._pieces) if self._lap_from is None else self._lap_from
        return JoinedCurve(tuple(_joined(part) for part in (self._pieces[:cut], self._pieces[cut:]) if part))

    @property
    def onward(self) -> Motion | None:
        """First and second derivative with which laps end that are flown through."""
        if not self._through:
            return None
        _, slope, bend = self._pieces[-1].jet([self._pieces[-1].duration_s])
        return Motion(slope[0], bend[0])

    @property
    def _ends_s(self) -> list[float]:
        return list(accumulate((piece.duration_s for piece in self._pieces), initial=0.0))

    @property
    def stops(self) -> tuple[tuple[float, float], ...]:
        """Pairs (curve parameter, seconds)."""
        ends_s = self._ends_s
        return tuple((ends_s[count], held_s) for count, held_s in self._stops)

    @property
    def lanes(self) -> Iterator[tuple[RoundedPolyline, float]]:
        """Lanes, and the parameter at which they begin."""
        ends_s = self._ends_s
        return ((lanes, ends_s[count]) for lanes, count in self._lanes)


def _stands(group: Sequence[Line]) -> bool:
    return all(len(line.way.points_m) < 2 for line in group)  # noqa: PLR2004 - a line


def _motion(lanes: RoundedPolyline, s: float) -> Motion:
    """With which lanes are begun, or ended."""
    _, slope, bend = lanes.jet([s])
    return Motion(slope[0], bend[0])


def _standing(place_m: FloatArray) -> BezierCurve:
    """The curve of who stays where the flight begins."""
    return BezierCurve(np.array([0.0, 1.0]), np.broadcast_to(place_m, (1, DEGREE + 1, 2)))


def _groups(lines: Sequence[Line]) -> list[list[Line]]:
    """Lines from rest to rest."""
    groups: list[list[Line]] = [[]]
    for line in lines:
        groups[-1].append(line)
        if line.rests:
            groups.append([])
    return groups if groups[-1] or len(groups) == 1 else groups[:-1]


def _joined(pieces: Sequence[Piece]) -> Curve:
    return pieces[0] if len(pieces) == 1 else JoinedCurve(tuple(pieces))


def planned_along(to_lap: Sequence[Line], lap: Sequence[Line], speed_m_s: float) -> Polyline:
    """All lines and lanes as one polyline."""
    parts: list[FloatArray] = []
    begins: list[int] = []
    for line in (*to_lap, *lap):
        begins.append(max(0, sum(map(len, parts)) - 1))
        parts.append(line.way.points_m)
        if line.lanes is not None:
            parts.append(line.lanes.corners_m)
    points = np.concatenate(parts)
    return Polyline(points, speed_m_s, (begins[len(to_lap)], len(points) - 1) if lap else None)
