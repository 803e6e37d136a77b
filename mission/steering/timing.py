"""The time law s = sigma(t) that flies a curve r(s) within a vehicle's limits, from rest to rest.

Between two stops it is found in three steps:

1. A first guess (``mission.steering.sweeps``) says where the knots are to be, for cells to take about equal times.
2. An interior-point method finds the fastest sigma'^2 at these knots (``mission.steering.pacing``), and a cubic spline
   in time goes through them (``mission.steering.law_fit``): sigma'' is continuous, and linear between knots.
3. What that asks of the vehicle is bounded on every cell (``mission.steering.strain``). Where it is more than a limit,
   as cells have a size, that limit is lowered by as much for another turn. What little is left in the end is taken off
   by flying from stop to stop more slowly: with t -> q t, speed, acceleration and jerk shrink by q, q^2 and q^3.

So the bounds are proved; nothing rests on samples.
"""

import math
from itertools import pairwise
from typing import Final

import numpy as np

from mission.geometry.arrays import FloatArray
from mission.steering.grid import Limits, Slow, beside, grid_of
from mission.steering.joined import Curve, JoinedCurve
from mission.steering.law import TimeLaw, law_from_growths
from mission.steering.law_fit import law_through
from mission.steering.pacing import PacingProblem, fastest_squares
from mission.steering.strain import Strain, strain
from mission.steering.sweeps import FEWEST_CELLS, ceilings_of, guessed

GRAVITY_M_S2 = 9.80665
_CELLS_PER_WAVE: Final = 8
_FEWEST_SAMPLES: Final = 64
_SAME_PLACE: Final = 1e-6
_SAME_KNOT: Final = 1e-9  # of the way between two stops
_QUICKEST_S: Final = 0.15  # in which the acceleration comes up: a larger jerk is not made use of
_TURNS: Final = 3
_NEARLY: Final = 1.001  # of a limit; a law that asks for no more is good
_BEGIN: Final = 0.9
_SLOWER: Final = 0.8
_NEXT: Final = 0.98


def level_acceleration(acceleration_m_s2: float, tilt_rad: float) -> float:
    """The largest horizontal acceleration within both limits: tilted by an angle, level flight has g tan of it."""
    return min(acceleration_m_s2, GRAVITY_M_S2 * math.tan(tilt_rad))


def time_law(
    curve: Curve,
    limits: Limits,
    *,
    fastest: float = math.inf,
    holds: tuple[tuple[float, float], ...] = (),
    slow: tuple[Slow, ...] = (),
) -> TimeLaw:
    """The fastest law within the limits, but for the little that the method leaves.

    Args:
        curve: The smoothed path; where the pieces of one that is joined meet, the vehicle rests for a moment.
        limits: Largest horizontal speed, acceleration (``level_acceleration``) and jerk; of the jerk no more is used
            than brings up the acceleration in 0.15 s.
        fastest: Largest sigma': 1 where the curve's own speed is that to be flown.
        holds: Pairs of a steering time in [0, T] and the seconds to stand still there; at one place the longest counts.
        slow: Where sigma' is to be less than elsewhere, but positive.

    Raises:
        ValueError: A limit that is not positive, a hold outside the curve or of negative or infinite length, or a part
            of the curve with a largest rate that is not positive.
    """
    if not (all(0.0 < limit < math.inf for limit in limits) and fastest > 0.0):
        raise ValueError("limits of speed, acceleration and jerk must be positive")
    joints = curve.joints_s[1:-1].tolist() if isinstance(curve, JoinedCurve) else []
    stops = dict.fromkeys((0.0, *joints, curve.duration_s), 0.0)
    for place, seconds in holds:
        if not (0.0 <= place <= curve.duration_s and 0.0 <= seconds < math.inf):
            raise ValueError("a hold lies on the curve and lasts a finite time")
        # What lies closer together than the law can be resolved is one place.
        near = min(stops, key=lambda stop: abs(stop - place))
        stop = near if abs(near - place) <= _SAME_PLACE * curve.duration_s else place
        stops[stop] = max(stops.get(stop, 0.0), seconds)
    if not all(each.begin_s <= each.end_s and each.rate > 0.0 for each in slow):
        raise ValueError("where the vehicle is slow it goes on nevertheless")
    slow = (*slow, Slow(0.0, curve.duration_s, fastest))
    limits = limits._replace(jerk_m_s3=min(limits.jerk_m_s3, limits.acceleration_m_s2 / _QUICKEST_S))
    places = sorted(stops)
    knots = curve.sampled(max(_FEWEST_SAMPLES, _CELLS_PER_WAVE * curve.frequencies)).knots_s
    laws = []
    for begin, end in pairwise(places):
        own = np.union1d(knots[(knots > begin) & (knots < end)], np.linspace(begin, end, FEWEST_CELLS + 1))
        apart = np.diff(own[:-1]) > _SAME_KNOT * (end - begin)
        own = np.concatenate((own[:1], own[1:-1][apart], own[-1:]))
        laws.append(_between_stops(curve, own, limits, slow))
    return _with_holds(laws, places, [stops[place] for place in places])


def _with_holds(laws: list[TimeLaw], places: list[float], holds_s: list[float]) -> TimeLaw:
    """Laws one after the other, from place to place, standing still at each place for so long."""
    parts = [(np.zeros(1), np.array(places[:1]), np.zeros(1), np.zeros(1))]
    now_s = 0.0
    for law, begin, end, hold_s in zip((None, *laws), (0.0, *places[:-1]), places, holds_s, strict=True):
        if law is not None:
            # The first knot is the last one before.
            parts.append(
                (now_s + law.knots_t_s[1:], np.minimum(begin + law.knots_s[1:], end), law.rates[1:], law.growths[1:])
            )
            parts[-1][1][-1] = end
            now_s += law.duration_s
        if hold_s > 0.0:
            now_s += hold_s
            parts.append((np.array([now_s]), np.array([end]), np.zeros(1), np.zeros(1)))
    return TimeLaw(*(np.concatenate(values) for values in zip(*parts, strict=True)))


def _between_stops(curve: Curve, knots: FloatArray, limits: Limits, slow: tuple[Slow, ...]) -> TimeLaw:
    """The law from rest at the first knot to rest at the last one; its knots are counted from the first."""
    span_s = float(knots[0]), float(knots[-1])
    guess, places = guessed(grid_of(curve, span_s, knots - span_s[0], limits, slow).firm(limits), limits)
    grid = grid_of(curve, span_s, places, limits, slow)
    firm = grid.firm(limits)
    ceilings = ceilings_of(grid)
    # From rest, with the largest jerk, sigma' is (9/2 j)^(1/3) times the distance to the power 2/3.
    for knot, cell in ((1, 0), (-2, -1)):
        jerk = limits.jerk_m_s3 / float(firm.first[cell])
        ceilings[knot] = min(ceilings[knot], float(np.cbrt(4.5 * jerk * (places[knot] - places[cell]) ** 2)) ** 2)
    accelerations, jerks = (np.full(len(places), limit) for limit in (limits.acceleration_m_s2, limits.jerk_m_s3))
    inner = _BEGIN * np.minimum(guess.jet(guess.time_at(places))[1] ** 2, ceilings)[1:-1]
    best = _slowed(guess, strain(guess, grid, limits))
    for turn in range(_TURNS):
        problem = PacingProblem(
            places, firm.slopes, firm.bends, beside(grid.third), (0.0, 0.0), ceilings, accelerations, jerks
        )
        while problem.barrier(inner, 0.0) == math.inf:
            inner = inner * (_SLOWER if turn == 0 else _NEXT)
        inner = fastest_squares(problem, inner, rough=turn == 0)
        law = law_through(places, np.sqrt(problem.squares(inner)), problem.growths(problem.squares(inner)))
        if law is None:
            continue
        found = strain(law, grid, limits)
        best = min(best, _slowed(law, found), key=lambda each: each.duration_s)
        if _excess(found) <= _NEARLY:
            break
        accelerations = accelerations / _near(np.maximum(found.acceleration, 1.0))
        jerks = jerks / _near(np.maximum(found.jerk, 1.0))
        ceilings = ceilings / beside(np.maximum(found.speed, 1.0)) ** 2
    return best


def _slowed(law: TimeLaw, found: Strain) -> TimeLaw:
    """The law as slow as the limits want it."""
    slower = max(1.0, _excess(found))
    ends_s = float(law.knots_s[0]), float(law.knots_s[-1])
    return law_from_growths(law.knots_t_s * slower, law.growths / slower**2, (0.0, 0.0), ends_s)


def _near(values: FloatArray) -> FloatArray:
    """Of values on cells (n,), the largest of those that meet at each knot or a neighbour of it, shape (n + 1,)."""
    at = beside(values)
    return np.asarray(np.maximum(at, np.maximum(np.append(at[1:], 0.0), np.append(0.0, at[:-1]))))


def _excess(found: Strain) -> float:
    """By which factor a law must be slower to keep the limits."""
    return max(
        float(found.speed.max()),
        math.sqrt(float(found.acceleration.max())),
        float(np.cbrt(found.jerk.max())),
    )
