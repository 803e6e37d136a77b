"""What is flown through a corridor: taut lines with what is done at their ends, and the curves along them."""

from collections.abc import Iterator, Sequence
from itertools import accumulate
from typing import NamedTuple

import numpy as np

from mission.geometry.arrays import FloatArray
from mission.steering.bezier import DEGREE, BezierCurve
from mission.steering.corridor import Pace, Way, smooth_ways
from mission.steering.joined import Curve, JoinedCurve, Piece
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
        onward: What is flown before, or the first and second derivative with which the curve begins; None at rest.
    """

    def __init__(
        self,
        pace: Pace,
        to_lap: Sequence[Line],
        lap: Sequence[Line],
        onward: BezierCurve | tuple[FloatArray, FloatArray] | None,
    ) -> None:
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
        for group in groups:
            self._pieces.extend(self._smooth(group, None))
            self._end(group[-1])

    def _fly_through(self, groups: Sequence[Sequence[Line]], last: Sequence[Line], laps: int) -> int:
        self._fly(groups)
        curves = self._smooth(last, len(last) - laps)
        self._pieces.extend(curves)
        return len(self._pieces) - 1

    def _smooth(self, group: Sequence[Line], lap: int | None) -> tuple[Piece, ...]:
        if all(len(line.way.points_m) < 2 for line in group):  # noqa: PLR2004 - a line
            return ()
        onward = None if self._pieces else self._begins
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
    def onward(self) -> tuple[FloatArray, FloatArray] | None:
        """First and second derivative with which laps end that are flown through."""
        if not self._through:
            return None
        _, slope, bend = self._pieces[-1].jet([self._pieces[-1].duration_s])
        return slope[0], bend[0]

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
