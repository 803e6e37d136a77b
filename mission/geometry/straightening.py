"""A polyline with fewer corners that stays within a tolerance of it, travelled in one direction.

The method is Ramer's and Douglas and Peucker's: a straight leg from the first point to the last, cut at its worst
point until none is farther off than the tolerance. Their measure, the distance from the leg, says nothing of the order
in which the places are passed: on a leg, a polyline that turns back is near it, too. Here each point of the polyline
is compared with a place on the leg that never goes back, the farthest that a point so far was nearest to. Between two
points both sides move straight on, and the distance between such two is largest at an end. So the figure bounds the
distance of two travellers who both only go forward (Fréchet's), all along, and not only at the points.
"""

from collections.abc import Callable

import numpy as np

from mission.geometry.arrays import FloatArray, IntArray


def straightened(
    points_m: FloatArray, tolerance_m: float, admits: Callable[[FloatArray, FloatArray], bool] = lambda _, __: True
) -> tuple[IntArray, float]:
    """Which points to keep.

    Args:
        points_m: Shape (P, 2), at least two points, in order; they may come back to where they were.
        tolerance_m: How far off both may be of each other; 0 keeps all that is not straight.
        admits: Whether a leg between two of the points that do not follow each other may be, besides; all by default.

    Returns:
        Indices of the points kept, ascending, the first and the last among them; and a bound on the distance of
        travellers along both.
    """
    kept, worst_m = {0, len(points_m) - 1}, 0.0
    pending = [(0, len(points_m) - 1)]
    while pending:
        first, last = pending.pop()
        if last == first + 1:
            continue
        # The ends are on the leg: what is off lies between them.
        apart_m = _apart(points_m[first : last + 1])[1:-1]
        farthest = 1 + int(np.argmax(apart_m))
        if apart_m.max() <= tolerance_m and admits(points_m[first], points_m[last]):
            worst_m = max(worst_m, float(apart_m.max()))
            continue
        kept.add(first + farthest)
        pending += [(first, first + farthest), (first + farthest, last)]
    return np.array(sorted(kept), dtype=np.int64), worst_m


def _apart(points_m: FloatArray) -> FloatArray:
    """How far each point is from its place on the leg from the first point to the last, shape (P,)."""
    leg = points_m[-1] - points_m[0]
    square = float(leg @ leg)
    offsets = points_m - points_m[0]
    nearest = np.clip(offsets @ leg / square, 0.0, 1.0) if square > 0.0 else np.zeros(len(points_m))
    places = np.maximum.accumulate(nearest)
    # Whoever is at the end of the polyline is at the end of the leg, whatever rounding says.
    places[-1] = 1.0
    apart: FloatArray = np.hypot(*(offsets - places[:, None] * leg).T)
    return apart
