"""The time law s = sigma(t) that flies a curve r(s) within a vehicle's limits, from rest to rest or in flight.

Between two stops it is found in three steps:

1. A first guess (``mission.steering.sweeps``) says where the knots are to be, for cells to take about equal times.
2. An interior-point method finds the fastest sigma'^2 at these knots (``mission.steering.pacing``), and a cubic spline
   in time goes through them (``mission.steering.law_fit``): sigma'' is continuous, and linear between knots.
3. What that asks of the vehicle is bounded on every cell (``mission.steering.strain``). Where it is more than a limit,
   as cells have a size, that limit is lowered by as much for another turn. What little is left in the end is taken off
   by flying from stop to stop more slowly: with t -> q t, speed, acceleration and jerk shrink by q, q^2 and q^3. What
   is flown into or out of while moving cannot be slowed down: there the limits are a little lower from the beginning.

So the bounds are proved; nothing rests on samples. Of a way of so many knots that the second step would take too long,
a field of a hundred lanes, it is done for what is not alike (``mission.steering.excerpt``).
"""

import math
from collections.abc import Callable, Sequence
from itertools import pairwise
from typing import Final

import numpy as np

from mission.geometry.arrays import FloatArray
from mission.steering.excerpt import excerpt_of
from mission.steering.grid import Grid, Limits, Slow, beside, grid_of
from mission.steering.joined import Curve, JoinedCurve
from mission.steering.known_laws import KnownLaw, known_law
from mission.steering.law import TimeLaw, law_from_growths
from mission.steering.law_fit import law_through
from mission.steering.pacing import PacingProblem, fastest_squares, led_inside
from mission.steering.strain import Strain, strain
from mission.steering.sweeps import FEWEST_CELLS, ceilings_of, guessed, guessed_in_motion

GRAVITY_M_S2 = 9.80665
_CELLS_PER_WAVE: Final = 8
_FEWEST_SAMPLES: Final = 64
_FEWEST_CELLS: Final = 256
_TINY: Final = 1e-100  # against 0 / 0
_EVEN: Final = 0.96
_SAME_PLACE: Final = 1e-6
_SAME_KNOT: Final = 1e-9  # of the way between two stops
_QUICKEST_S: Final = 0.15  # in which the acceleration comes up: a larger jerk is not made use of
_TURNS: Final = 3
_MORE_TURNS: Final = 6  # where what exceeds the limits cannot be slowed down
_NEARLY: Final = 1.001  # of a limit: rounding, and more
_GOOD: Final = 1.005  # by what a law is slowed down at most for which another turn is not worth while
_BEGIN: Final = 0.9
_SLOWER: Final = 0.8
_NEXT: Final = 0.98
_BEFORE: Final = 1e-3  # of the first cell
_GENTLE: Final = 0.35  # of the limits: where a first guess must not be slowed down
_SPARE: Final = 0.96  # of the limits, where what exceeds them cannot be slowed down
_MOST_KNOTS: Final = 3_000
"""For which the interior-point method is fast enough, whatever the way is like."""


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
    ends: tuple[float, float] = (0.0, 0.0),
    growth: float | None = None,
    known: Sequence[KnownLaw] = (),
) -> TimeLaw:
    """The fastest law within the limits, but for the little that the method leaves.

    Args:
        curve: The smoothed path; where the pieces of one that is joined do not go over smoothly, the vehicle rests.
        limits: Largest horizontal speed, acceleration (``level_acceleration``) and jerk; of the jerk no more is used
            than brings up the acceleration in 0.15 s.
        fastest: Largest sigma': 1 where the curve's own speed is that to be flown.
        holds: Pairs of a steering time in [0, T] and the seconds to stand still there; at one place the longest counts.
        slow: Where sigma' or the speed are to be less than elsewhere, but positive.
        ends: The rate sigma' with which the curve is begun and ended, where sigma'' = 0; at most the ``even_rate``.
        growth: sigma'' with which it is begun at any rate, in the motion that the vehicle has; None where it has none.
        known: Laws of pieces that may be in the curve: to rest they are flown by these, within the limits.

    Raises:
        ValueError: A limit that is not positive, a hold outside the curve or of negative or infinite length, or a part
            of the curve with a largest rate that is not positive; or there is no law with these rates at the ends.
    """
    if not (all(0.0 < limit < math.inf for limit in limits) and fastest > 0.0):
        raise ValueError("limits of speed, acceleration and jerk must be positive")
    joints = curve.breaks_s.tolist() if isinstance(curve, JoinedCurve) else []
    stops = dict.fromkeys((0.0, *joints, curve.duration_s), 0.0)
    for place, seconds in holds:
        if not (0.0 <= place <= curve.duration_s and 0.0 <= seconds < math.inf):
            raise ValueError("a hold lies on the curve and lasts a finite time")
        # What lies closer together than the law can be resolved is one place.
        near = min(stops, key=lambda stop: abs(stop - place))
        stop = near if abs(near - place) <= _SAME_PLACE * curve.duration_s else place
        stops[stop] = max(stops.get(stop, 0.0), seconds)
    if not all(each.begin_s <= each.end_s and min(each.rate, each.speed_m_s) > 0.0 for each in slow):
        raise ValueError("where the vehicle is slow it goes on nevertheless")
    slow = (*slow, Slow(0.0, curve.duration_s, fastest))
    limits = limits._replace(jerk_m_s3=min(limits.jerk_m_s3, limits.acceleration_m_s2 / _QUICKEST_S))
    places = sorted(stops)
    if any(end > 0.0 and stops[place] > 0.0 for end, place in zip(ends, places[:: len(places) - 1], strict=True)):
        raise ValueError("where the vehicle stands still it does not fly through")
    knots = curve.sampled(max(_FEWEST_SAMPLES, _CELLS_PER_WAVE * curve.frequencies)).knots_s
    laws = []
    for begin, end in pairwise(places):
        at_ends = ends[0] if begin == 0.0 else 0.0, ends[1] if end == curve.duration_s else 0.0
        onward = growth if begin == 0.0 else None
        law = None
        if known and at_ends[1] == 0.0 and (at_ends[0] == 0.0 or onward is not None):
            law = known_law(curve, (begin, end), known, limits, slow, begins=(at_ends[0], onward or 0.0))
        if law is not None:
            laws.append(law)
            continue
        own = np.union1d(knots[(knots > begin) & (knots < end)], np.linspace(begin, end, FEWEST_CELLS + 1))
        apart = np.minimum(np.diff(own[:-1]), end - own[1:-1]) > _SAME_KNOT * (end - begin)
        own = np.concatenate((own[:1], own[1:-1][apart], own[-1:]))
        if onward is not None:
            laws.append(_rolling(curve, own, limits, slow, (*at_ends, onward)))
        else:
            laws.append(_between_stops(curve, own, limits, slow, at_ends))
    return _with_holds(laws, places, [stops[place] for place in places])


def even_rate(curve: Curve, limits: Limits, fastest: float) -> float:
    """A rate at which a whole curve can be flown without a change: the largest one, but for a little."""
    sampled = curve.sampled(max(_FEWEST_CELLS, _CELLS_PER_WAVE * curve.frequencies)).knots_s
    first, second, third = (float(curve.norm_bounds(sampled, order).max()) for order in (1, 2, 3))
    speed, acceleration, jerk = limits
    most = min(fastest, speed / first, math.sqrt(acceleration / max(second, _TINY)), np.cbrt(jerk / max(third, _TINY)))
    return _EVEN * float(most)


def _with_holds(laws: list[TimeLaw], places: list[float], holds_s: list[float]) -> TimeLaw:
    """Laws one after the other, from place to place, standing still at each place for so long."""
    parts = [(np.zeros(1), np.array(places[:1]), laws[0].rates[:1], laws[0].growths[:1])]
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


def _between_stops(
    curve: Curve, knots: FloatArray, limits: Limits, slow: tuple[Slow, ...], ends: tuple[float, float]
) -> TimeLaw:
    """The law from one stop, or end of the curve, to the next, with these rates there; its knots count from the first.

    Raises:
        ValueError: None was found with these rates.
    """
    span_s = float(knots[0]), float(knots[-1])

    def grid_at(places: FloatArray) -> Grid:
        return grid_of(curve, span_s, places, limits, slow)

    if len(knots) <= _MOST_KNOTS or any(ends):
        return _fastest(grid_at, knots - span_s[0], limits, ends, _MORE_TURNS if any(ends) else _TURNS)[0]
    excerpt = excerpt_of(curve, knots, limits, slow)
    law, places = excerpt.whole(*_fastest(excerpt.grid, excerpt.knots_s, limits, ends, _MORE_TURNS))
    return _at_most(law, strain(law, grid_at(places), limits).excess)


def _fastest(
    grid_at: Callable[[FloatArray], Grid], knots: FloatArray, limits: Limits, ends: tuple[float, float], turns: int
) -> tuple[TimeLaw, FloatArray]:
    """The law of ``_between_stops`` from grids at knots (n + 1,), after some turns, and the knots of its last grid."""
    moving = any(ends)
    gently = limits._replace(acceleration_m_s2=_GENTLE * limits.acceleration_m_s2, jerk_m_s3=_GENTLE * limits.jerk_m_s3)
    guess, places = guessed(grid_at(knots).firm(limits), gently if moving else limits, ends)
    grid = grid_at(places)
    places, firm = grid.knots_s, grid.firm(limits)
    spare = _SPARE if moving else 1.0
    ceilings = ceilings_of(grid) * (_NEARLY**-2 if moving else 1.0)
    _slow_at_rests(ceilings, firm, spare * limits.jerk_m_s3, ends)
    squares_at_ends = ends[0] ** 2, ends[1] ** 2
    accelerations = np.full(len(places), spare * limits.acceleration_m_s2)
    jerks = np.full(len(places), spare * limits.jerk_m_s3)
    start = guess.jet(guess.time_at(places))[1][1:-1] ** 2
    start[[0, -1]] = [end**2 if end > 0.0 else b for end, b in zip(ends, start[[0, -1]].tolist(), strict=True)]
    inner = start if moving else _BEGIN * np.minimum(start, ceilings[1:-1])
    # A guess that moves at an end is slow all over: to stop there is better.
    laws = [] if moving else [_slowed(guess, strain(guess, grid, limits), moving=False)]
    sharply, beyond = (2.0, 1.005) if moving else (1.0, 1.0)
    for turn in range(turns):
        problem = PacingProblem(
            places, firm.slopes, firm.bends, beside(grid.third), squares_at_ends, ceilings, accelerations, jerks
        )
        while (state := problem.state(inner)) is None and not moving:
            inner = inner * (_SLOWER if turn == 0 else _NEXT)
        if state is None:
            break
        squares = fastest_squares(problem, state, rough=turn == 0 or moving)
        law = law_through(places, np.sqrt(squares), problem.growths(squares))
        if law is None:
            inner = squares[1:-1]
            continue
        found = strain(law, grid, limits)
        laws.append(_slowed(law, found, moving=moving))
        if found.excess <= (1.0 if moving else _GOOD):
            break
        ceilings, accelerations, jerks = _lowered((ceilings, accelerations, jerks), found, beyond, sharply)
        inner = start if moving else squares[1:-1]
    kept = [law for law in laws if law is not None]
    if not kept:
        raise ValueError(f"no law begins and ends at the rates {ends[0]:.3g} and {ends[1]:.3g}")
    return min(kept, key=lambda law: law.duration_s), places


def _slow_at_rests(ceilings: FloatArray, firm: Grid, jerk_m_s3: float, ends: tuple[float, float]) -> None:
    """Lower b next to where the vehicle rests.

    From rest, with the largest jerk, sigma' is (9/2 j)^(1/3) times the distance to the power 2/3.
    """
    for knot, cell, end in ((1, 0, ends[0]), (-2, -1, ends[1])):
        if end == 0.0:
            jerk, away = jerk_m_s3 / float(firm.first[cell]), float(firm.knots_s[knot] - firm.knots_s[cell])
            ceilings[knot] = min(ceilings[knot], float(np.cbrt(4.5 * jerk * away**2)) ** 2)


def _lowered(
    limits: tuple[FloatArray, FloatArray, FloatArray], found: Strain, beyond: float, sharply: float
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Limits at knots, lower by as much as was asked for too much."""
    ceilings, accelerations, jerks = limits
    return (
        ceilings / beside(np.maximum(found.speed, 1.0)) ** (2.0 * sharply),
        accelerations / _near(np.where(found.acceleration > 1.0, beyond * found.acceleration, 1.0)) ** sharply,
        jerks / _near(np.where(found.jerk > 1.0, beyond * found.jerk, 1.0)) ** sharply,
    )


def _rolling(
    curve: Curve, knots: FloatArray, limits: Limits, slow: tuple[Slow, ...], motion: tuple[float, float, float]
) -> TimeLaw:
    """The law to the first stop from a beginning in motion, with a rate, the rate at its end, and a growth at first.

    A knot close before the first one has the b of a law that had this growth before, so that what the jerk makes of it
    is limited like everywhere.

    Raises:
        ValueError: None was found.
    """
    ends, growth = motion[:2], motion[2]
    span_s = float(knots[0]), float(knots[-1])
    rough = grid_of(curve, span_s, knots - span_s[0], limits, slow).firm(limits)
    places, start = guessed_in_motion(rough, limits, ends, growth)
    grid = grid_of(curve, span_s, places, limits, slow)
    firm = grid.firm(limits)
    before = _BEFORE * places[1]
    square = ends[0] ** 2
    at_ends = square - 2.0 * growth * before, ends[1] ** 2

    def since(values: FloatArray) -> FloatArray:
        return np.concatenate((values[:1], values))

    accelerations, jerks = (np.full(len(places), _SPARE * each) for each in limits[1:])
    lower = ceilings_of(grid), accelerations, jerks
    _slow_at_rests(lower[0], firm, _SPARE * limits.jerk_m_s3, ends)
    if ends[1] > 0.0:
        start[-1] = ends[1] ** 2
    start = np.concatenate(([square], start))
    for _ in range(_MORE_TURNS):
        ceilings, accelerations, jerks = (since(each) for each in lower)
        ceilings[:2] = np.maximum(ceilings[:2], _NEARLY * square)
        problem = PacingProblem(
            np.concatenate(([-before], places)),
            since(firm.slopes),
            since(firm.bends),
            since(beside(grid.third)),
            at_ends,
            ceilings,
            accelerations,
            jerks,
        )
        state = led_inside(problem, start)
        if state is None:
            break
        squares = fastest_squares(problem, state)
        law = law_through(places, np.sqrt(squares[1:]), problem.growths(squares)[1:], growth)
        if law is None:
            break
        found = strain(law, grid, limits)
        if found.excess <= 1.0:
            return law
        lower = _lowered(lower, found, 1.005, 2.0)
    raise ValueError(f"no law begins at the rate {ends[0]:.3g} with a growth of {growth:.3g}")


def _slowed(law: TimeLaw, found: Strain, *, moving: bool) -> TimeLaw | None:
    """The law as slow as the limits want it; one that moves at an end must not change: None where it is too fast."""
    slower = max(1.0, found.excess)
    if moving:
        return law if slower == 1.0 else None
    return _at_most(law, slower)


def _at_most(law: TimeLaw, excess: float) -> TimeLaw:
    """A law from rest to rest, slower by as much as it exceeds the limits."""
    slower = max(1.0, excess)
    ends_s = float(law.knots_s[0]), float(law.knots_s[-1])
    return law_from_growths(law.knots_t_s * slower, law.growths / slower**2, (0.0, 0.0), ends_s)


def _near(values: FloatArray) -> FloatArray:
    """Of values on cells (n,), the largest of those that meet at each knot or a neighbour of it, shape (n + 1,)."""
    at = beside(values)
    return np.asarray(np.maximum(at, np.maximum(np.append(at[1:], 0.0), np.append(0.0, at[:-1]))))
