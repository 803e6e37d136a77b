"""The smooth curve through a corridor: convex programmes for its shape, in turn with the times of its pieces.

The corridor is a row of convex cells along a taut path (``cells``), and the curve a spline whose pieces have their
control points in one cell each, so that no piece leaves its cell. Given how long each piece lasts, the spline that
minimises

    integral of |r'|^2 / v^2 + (|r''| / a)^2 + (|r'''| / j)^2

is the solution of a quadratic programme: the first term pulls it taut, the others round it for the speed v, the
acceleration a and the jerk j of the vehicle. How long the pieces should last follows from the shape: as long as a
vehicle takes that slows down in bends. Shape and times are improved in turn, a few times; the curve that is flown
soonest is kept. Any of them is admissible, so that how far this goes is a matter of a few per cent and not of safety.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise, takewhile
from typing import Any, Final, NamedTuple

import clarabel
import numpy as np
import scipy.sparse as sp
import shapely

from mission.errors import UnprovedError
from mission.geometry.arrays import FloatArray, IntArray
from mission.steering.bezier import DEGREE, BezierCurve, gram
from mission.steering.cells import Cell, borders_of, cell_round
from mission.steering.motion import Motion, Pace
from mission.steering.pattern import Pattern

_TURNS: Final = 4  # times that shape and times are improved
_EASES: Final = (0.5, 0.25, 0.12, 0.06)  # parts of the speed for which bends are rounded, until it is short enough
LONGEST: Final = 1.06  # than the taut path: as long as the curve may become
_SAMPLES: Final = 12  # of a piece, where its duration is estimated
_SLOWEST: Final = 0.2  # of the fastest speed: a rest has no effect on the shape beyond that
_SHORTEST: Final = 0.1  # piece, of the time in which the vehicle reaches full speed
_BEND_SHARE: Final = 0.25  # of a stretch, at most, that belongs to the cell of a bend at first
_MOST_PIECES: Final = 4  # of a stretch
_STRAIGHT: Final = 1e-9  # how little a direction changes where there is no bend
_ROUNDS: Final = 100  # of the solver, at most
_POINTS: Final = DEGREE + 1
_UPPER: Final = np.array(np.triu_indices(2 * _POINTS))  # rows and columns of a piece's own block


_AROUND: Final = np.array([[np.cos(angle), np.sin(angle)] for angle in np.arange(8) * np.pi / 4.0])
_THIRD: Final = np.array(
    [[-1.0, 3.0, -3.0, 1.0, 0.0, 0.0], [0.0, -1.0, 3.0, -3.0, 1.0, 0.0], [0.0, 0.0, -1.0, 3.0, -3.0, 1.0]]
)


@dataclass(frozen=True, eq=False)
class Way:
    """A taut way from one event of a flight to the next one.

    Attributes:
        points_m: Shape (n, 2), n >= 1, its corners; it begins where the one before it ends.
        free: The area in which the curve may be on this way.
        target: The area in which the way ends; None where it ends in its last corner.
    """

    points_m: FloatArray
    free: shapely.Geometry
    target: shapely.Geometry | None


class _Piece(NamedTuple):
    """A piece of the curve: its cell, and a guess of how long it lasts."""

    cell: Cell
    lasts_s: float


class _Row(NamedTuple):
    """The pieces of a curve in a row.

    Attributes:
        pieces: In order.
        joints: For numbers of pieces the cells in which these end, beside their own.
        starts: For each way the number of its first piece.
    """

    pieces: list[_Piece]
    joints: dict[int, list[Cell]]
    starts: list[int]


class _Ends(NamedTuple):
    """Where a curve begins and ends, each (2,) or None where it is free, and the derivatives there, or None at rest."""

    start_m: FloatArray
    end_m: FloatArray | None
    onward: Motion | None
    into: Motion | None


class _Shape(NamedTuple):
    """A curve: how much too long it is, how long its flight lasts, its control points, and the times of its pieces."""

    excess_m: float
    total_s: float
    controls_m: FloatArray
    lasts_s: FloatArray

    @property
    def rank(self) -> tuple[float, float]:
        """Less is better."""
        return self.excess_m, self.total_s


def smooth_ways(
    ways: Sequence[Way],
    pace: Pace,
    *,
    lap: int | None = None,
    onward: Motion | None = None,
    into: Motion | None = None,
) -> tuple[BezierCurve, ...]:
    """The smooth curve along taut ways, flown through from the first point to the last.

    Args:
        ways: At least one, at least one of them longer than nothing.
        pace: What the vehicle can do.
        lap: The way with which a lap begins that is flown again and again; it ends where it begins, and goes over into
            itself with continuous acceleration.
        onward: With which the curve begins: those with which one ends that is flown before it.
        into: With which it ends: those with which one begins that is flown after it; not with a lap.

    Returns:
        The curve; where there is a lap that does not begin at once, the way to it and the lap.

    Raises:
        UnprovedError: The corridor is too narrow for a curve.
    """
    row = _row(ways, pace)
    lasts = np.array([piece.lasts_s for piece in row.pieces])
    closing = None if lap is None else row.starts[lap]
    start, end = ways[0].points_m[0], ways[-1].points_m[-1]
    ends = _Ends(start, None if closing is not None else end, onward, into)
    programme = _Programme(row, pace, ends, closing)
    taut_m = sum(float(np.hypot(*np.diff(way.points_m, axis=0).T).sum()) for way in ways)
    best: _Shape | None = None
    for ease in _EASES:
        found = _shaped(programme, np.array([piece.lasts_s for piece in row.pieces]), pace, ease, LONGEST * taut_m)
        if best is None or (found is not None and found.rank < best.rank):
            best = found
        if best is not None and best.excess_m == 0.0:
            break
    if best is None:
        raise UnprovedError("the taut path leaves no room for a smooth curve", counterexample=(), where_s=None)
    controls, lasts = best.controls_m, best.lasts_s
    cuts = sorted({0, *([closing] if closing is not None else []), len(lasts)})
    return tuple(
        BezierCurve(np.concatenate(([0.0], np.cumsum(lasts[first:last]))), controls[first:last])
        for first, last in pairwise(cuts)
    )


def _shaped(programme: "_Programme", lasts_s: FloatArray, pace: Pace, ease: float, longest_m: float) -> _Shape | None:
    """The best curve of a few turns, bends being rounded for a part of the speed; None where there is no curve."""
    best: _Shape | None = None
    shortest_s = _SHORTEST * pace.speed_m_s / pace.acceleration_m_s2
    lasts_s = np.maximum(lasts_s, shortest_s)
    for _ in range(_TURNS):
        controls = programme.solved(lasts_s, ease)
        if controls is None:
            break
        durations, total, length = _flown(controls, lasts_s, pace, programme.ends_m_s)
        shape = _Shape(max(0.0, length - longest_m), total, controls, lasts_s)
        if best is None or shape.rank < best.rank:
            best = shape
        lasts_s = np.maximum(durations, shortest_s)
    return best


def _row(ways: Sequence[Way], pace: Pace) -> _Row:
    """The cells along taut ways, with a guess of how long the pieces in them last."""
    reach = max(2.0 * pace.speed_m_s**2 / pace.acceleration_m_s2, 1e-3)
    row = _Row([], {}, [])
    for way in ways:
        row.starts.append(len(row.pieces))
        borders = borders_of(way.free)
        points = way.points_m[np.append(True, np.any(np.diff(way.points_m, axis=0) != 0.0, axis=1))]
        steps = np.diff(points, axis=0)
        lengths = np.hypot(steps[:, 0], steps[:, 1])
        shares = np.minimum(lengths[:-1], lengths[1:]) * _BEND_SHARE
        left = lengths - np.append(shares, 0.0) - np.append(0.0, shares)
        for number, length in enumerate(lengths.tolist()):
            cell = cell_round(points[number], points[number + 1], borders, reach)
            count = int(np.clip(np.ceil(length / (pace.speed_m_s * 2.0)), 2, _MOST_PIECES))
            row.pieces.extend([_Piece(cell, float(left[number]) / count / pace.speed_m_s)] * count)
            if number + 1 < len(lengths):
                directions = steps[number : number + 2] / lengths[number : number + 2, None]
                inward = directions[1] - directions[0]
                size = float(np.hypot(*inward))
                if size > _STRAIGHT:
                    corner = points[number + 1]
                    bend = cell_round(corner, corner, borders, reach, across=inward / size)
                    row.pieces.extend([_Piece(bend, float(shares[number]) / pace.speed_m_s)] * 2)
        if way.target is not None and row.pieces:
            goal = cell_round(points[-1], points[-1], borders_of(way.target), reach)
            row.joints.setdefault(len(row.pieces) - 1, []).append(goal)
    return row


class _Programme:
    """The quadratic programme of a row of pieces; what does not depend on their durations is built once."""

    def __init__(self, row: _Row, pace: Pace, ends: _Ends, closing: int | None) -> None:
        self._count = len(row.pieces)
        self._pace, self._ends, self._closing = pace, ends, closing
        start_m = ends.start_m
        rows, columns, values, offsets = [], [], [], []
        height = 0
        placed = [(piece.cell, 2 * _POINTS * k + 2 * np.arange(_POINTS)) for k, piece in enumerate(row.pieces)]
        placed += [
            (cell, np.array([2 * _POINTS * k + 2 * DEGREE])) for k, cells in row.joints.items() for cell in cells
        ]
        for cell, firsts in placed:
            sides = len(cell.offsets_m)
            numbers = height + np.arange(len(firsts) * sides).reshape(len(firsts), sides)
            for axis in (0, 1):
                rows.append(numbers.ravel())
                columns.append(np.repeat(firsts + axis, sides))
                values.append(np.tile(cell.normals[:, axis], len(firsts)))
            offsets.append(np.tile(cell.offsets_m, len(firsts)))
            height += len(firsts) * sides
        size = 2 * _POINTS * self._count
        self._sides, places = np.concatenate(values), (np.concatenate(rows), np.concatenate(columns))
        shift = np.tile(start_m, _POINTS * self._count)
        self._limits = np.concatenate(offsets) - sp.csc_matrix((self._sides, places), shape=(height, size)) @ shift
        # Likewise, in eight directions, the control points of the third derivative of the pieces up to the first bend.
        most = np.inf if ends.onward is None else ends.onward.jerk
        straight = sum(1 for _ in takewhile(lambda piece: piece.cell is row.pieces[0].cell, row.pieces))
        first = range(straight if most < np.inf else 0)
        jerks = np.kron(
            np.eye(len(first), self._count), np.einsum("pc,na->pnca", _THIRD, _AROUND).reshape(-1, 2 * _POINTS)
        )
        each, of = np.nonzero(jerks)
        self._sides = np.append(self._sides, jerks[each, of])
        places = np.append(places[0], height + each), np.append(places[1], of)
        self._jerks = np.full((len(first), len(_THIRD) * len(_AROUND)), most / (DEGREE * (DEGREE - 1) * (DEGREE - 2)))
        height += len(jerks)
        joints, joined, _, given = self._joints(np.ones(self._count), 1.0)
        self._matrix = Pattern(
            np.append(joints, places[0] + given.size), np.append(joined, places[1]), (given.size + height, size)
        )
        upper, right = 2 * _POINTS * np.arange(self._count)[:, None] + _UPPER[:, None]
        self._cost = Pattern(upper, right, (size, size))

    @property
    def ends_m_s(self) -> tuple[float, float]:
        """The speeds with which the curve begins and ends."""
        return _speed_m_s(self._ends.onward), _speed_m_s(self._ends.into)

    def solved(self, lasts_s: FloatArray, ease: float) -> FloatArray | None:
        """The control points of the best spline, shape (K, 6, 2), for pieces of these durations; None if there is none.

        Positions are counted from the start, in units of the distance that is flown in a second at full speed.
        """
        unit, pace = self._pace.speed_m_s, self._pace
        weights = [1.0, ease * pace.speed_m_s / pace.acceleration_m_s2, ease * pace.speed_m_s / pace.jerk_m_s3]
        blocks = sum(
            weight**2 * lasts_s[:, None, None] ** (1 - 2 * order) * gram(order)
            for order, weight in enumerate(weights, start=1)
        )
        # The solver's tolerances are absolute: numbers about 1.
        blocks = np.asarray(blocks) / np.median(np.abs(blocks).max(axis=(1, 2)))
        # Both axes cost the same, and neither has to do with the other: zeros, which the solver is given as such.
        cost = self._cost.filled(np.kron(blocks, np.eye(2))[:, *_UPPER])
        _, _, entries, values = self._joints(lasts_s, unit)
        matrix = self._matrix.filled(np.append(entries, self._sides))
        limits = np.append(self._limits, self._jerks * lasts_s[: len(self._jerks), None] ** 3) / unit
        offsets = np.append(values, limits)
        cones = [clarabel.ZeroConeT(values.size), clarabel.NonnegativeConeT(len(limits))]
        solver = clarabel.DefaultSolver(cost, np.zeros(cost.shape[0]), matrix, offsets, cones, _settings())
        solution = solver.solve()
        if str(solution.status) not in ("Solved", "AlmostSolved"):
            return None
        controls = np.array(solution.x).reshape(self._count, _POINTS, 2) * unit + self._ends.start_m
        return self._exactly_joined(controls, lasts_s)

    def _joints(self, lasts_s: FloatArray, unit: float) -> tuple[IntArray, IntArray, FloatArray, FloatArray]:
        """What must be equal: where the curve begins and ends, and up to the second derivative at the joints.

        Returns:
            Rows, columns and values of a matrix's entries, and what each row comes to.
        """
        count = self._count
        pairs = [(k, k + 1) for k in range(count - 1)]
        if self._closing is not None:
            pairs.append((count - 1, self._closing))
        before, after = np.array(pairs, dtype=np.int64).reshape(-1, 2).T
        # r' and r'' of both in units of the shorter piece, for numbers of one size.
        shorter = np.minimum(lasts_s[before], lasts_s[after])
        left, right = shorter / lasts_s[before], shorter / lasts_s[after]
        ends: list[tuple[Any, Any, Any]] = []  # row, piece * 6 + point, value
        number = np.arange(len(before))
        last, first = before * _POINTS + DEGREE, after * _POINTS
        one = np.ones(len(before))
        ends += [(3 * number, last, one), (3 * number, first, -one)]
        ends += [(3 * number + 1, last, left), (3 * number + 1, last - 1, -left)]
        ends += [(3 * number + 1, first + 1, -right), (3 * number + 1, first, right)]
        for point, sign in ((0, 1.0), (1, -2.0), (2, 1.0)):
            ends += [(3 * number + 2, last - point, sign * left**2), (3 * number + 2, first + point, -sign * right**2)]
        given = [(0, [1.0], self._ends.start_m - self._ends.start_m)]
        if self._ends.end_m is not None:
            given.append((count * _POINTS - 1, [1.0], self._ends.end_m - self._ends.start_m))
        if self._ends.onward is not None:
            slope, bend, _ = self._ends.onward
            given.append((0, [-1.0, 1.0], slope * lasts_s[0] / DEGREE))
            given.append((0, [1.0, -2.0, 1.0], bend * lasts_s[0] ** 2 / (DEGREE * (DEGREE - 1))))
        if self._ends.into is not None:
            slope, bend, _ = self._ends.into
            given.append((count * _POINTS - 2, [-1.0, 1.0], slope * lasts_s[-1] / DEGREE))
            given.append((count * _POINTS - 3, [1.0, -2.0, 1.0], bend * lasts_s[-1] ** 2 / (DEGREE * (DEGREE - 1))))
        height = 3 * len(before)
        for row, (point, factors, _) in enumerate(given, start=height):
            ends.append(([row] * len(factors), point + np.arange(len(factors)), factors))
        values = np.concatenate((np.zeros((height, 2)), np.array([value for *_, value in given]) / unit))
        rows, columns, entries = (np.concatenate(part) for part in zip(*ends, strict=True))
        axes = np.arange(2)
        of_both = (2 * rows[:, None] + axes).ravel(), (2 * columns[:, None] + axes).ravel(), np.repeat(entries, 2)
        return *of_both, values.ravel()

    def _exactly_joined(self, controls: FloatArray, lasts_s: FloatArray) -> FloatArray:
        """The same without the jumps that the solver's tolerance left: each piece ends as the next one begins."""
        controls[0, 0] = self._ends.start_m
        if self._ends.onward is not None:
            slope, bend, _ = self._ends.onward
            controls[0, 1] = controls[0, 0] + slope * lasts_s[0] / DEGREE
            controls[0, 2] = 2.0 * controls[0, 1] - controls[0, 0] + bend * lasts_s[0] ** 2 / (DEGREE * (DEGREE - 1))
        if self._ends.end_m is not None:
            controls[-1, -1] = self._ends.end_m
        if self._ends.into is not None:
            slope, bend, _ = self._ends.into
            controls[-1, 4] = controls[-1, 5] - slope * lasts_s[-1] / DEGREE
            controls[-1, 3] = (
                2.0 * controls[-1, 4] - controls[-1, 5] + bend * lasts_s[-1] ** 2 / (DEGREE * (DEGREE - 1))
            )
        pairs = [(k, k + 1) for k in range(self._count - 1)]
        if self._closing is not None:
            pairs.append((self._count - 1, self._closing))
        for before, after in pairs:
            end, begin, ratio = controls[before], controls[after], lasts_s[before] / lasts_s[after]
            slope = (begin[1] - begin[0]) * ratio
            bend = (begin[2] - 2.0 * begin[1] + begin[0]) * ratio**2
            end[5] = begin[0]
            end[4] = end[5] - slope
            end[3] = bend + 2.0 * end[4] - end[5]
        return controls


def _settings() -> Any:  # noqa: ANN401 - the solver has no types
    settings = clarabel.DefaultSettings()
    settings.verbose = False
    settings.max_iter = _ROUNDS
    return settings


def _speed_m_s(motion: Motion | None) -> float:
    return 0.0 if motion is None else float(np.hypot(*motion.slope))


def estimated_s(curve: BezierCurve, pace: Pace, onward: Motion | None, into: Motion | None) -> float:
    """About how long a vehicle takes for a curve, from and to these motions."""
    ends_m_s = _speed_m_s(onward), _speed_m_s(into)
    return _flown(curve.controls_m, np.diff(curve.knots_s), pace, ends_m_s)[1]


def _flown(
    controls: FloatArray, lasts_s: FloatArray, pace: Pace, ends_m_s: tuple[float, float]
) -> tuple[FloatArray, float, float]:
    """How long a vehicle takes for each piece, shape (K,), but for standing; for all; the length."""
    curve = BezierCurve(np.concatenate(([0.0], np.cumsum(lasts_s))), controls)
    shares = (np.arange(_SAMPLES) + 0.5) / _SAMPLES
    s = (curve.knots_s[:-1, None] + lasts_s[:, None] * shares).ravel()
    _, slope, bend = curve.jet(s)
    speed = np.maximum(np.hypot(slope[:, 0], slope[:, 1]), 1e-9)
    steps = speed * np.repeat(lasts_s / _SAMPLES, _SAMPLES)
    curvature = np.abs(slope[:, 0] * bend[:, 1] - slope[:, 1] * bend[:, 0]) / speed**3
    squares = np.minimum(pace.speed_m_s**2, pace.acceleration_m_s2 / np.maximum(curvature, 1e-12))
    for order, at_end in ((1, ends_m_s[0] ** 2), (-1, ends_m_s[1] ** 2)):
        values, ways, reached = squares[::order].tolist(), steps[::order].tolist(), at_end
        for i, (value, way) in enumerate(zip(values, ways, strict=True)):
            values[i] = min(value, reached + pace.acceleration_m_s2 * way)
            reached = values[i] + pace.acceleration_m_s2 * way
        squares = np.array(values, dtype=np.float64)[::order]
    total = float((steps / np.sqrt(squares)).sum())
    floored = np.maximum(np.sqrt(squares), _SLOWEST * pace.speed_m_s)
    return (steps / floored).reshape(-1, _SAMPLES).sum(axis=1), total, float(steps.sum())
