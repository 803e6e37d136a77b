"""A first guess of the fastest law on a grid: one without a limit of jerk, averaged over time.

In it sigma'^2 =: b is piecewise linear in s. Two sweeps, one forwards and one backwards, give the largest b with

    |r'' b + r' b' / 2| <= a    at the end of each cell to which it rises
    |r'| |b'| / 2       <= a    on each cell
    b                   <= d    at each knot

(the numerical integration of time-optimal path parametrisation, after Bobrow, Dubowsky and Gibson, 1985). On each cell
sigma'' = b' / 2 is constant. The average over a window of h seconds about each instant makes sigma'' continuous: on a
straight line, with h the time in which the jerk brings up the acceleration, it is the fastest law of limited jerk where
the largest speed is held for h at least.
"""

import math
from dataclasses import replace
from typing import Final

import numpy as np

from mission.geometry.arrays import FloatArray
from mission.steering.grid import Grid, Limits, beside
from mission.steering.law import TimeLaw, law_from_growths
from mission.steering.stopping import stopping_after

FEWEST_CELLS: Final = 32
"""Of a way from one stop to the next."""

_TINY: Final = 1e-100  # against 0 / 0
_LEAST: Final = 1e-3  # of b, where none goes with the one beside it: it is a guess, and must get on
_SAME_TIME_S: Final = 1e-9  # knots of a law that are closer together are one
_STEP_S: Final = 0.05  # that a cell takes at most where the acceleration changes
_STEPS: Final = 6.0  # cells in which the jerk brings up the acceleration, at least
_GROWING: Final = 0.2  # by how much longer a cell takes than the one before, where it does not
_LONGEST_S: Final = 1.0
_FADED: Final = 0.5
"""Of a way that is begun in motion, the part on which a growth of the rate may fade."""
_FADES: Final = 0.7  # of the jerk, with which a growth fades
_GENTLE: Final = 0.35  # of the limits: a guess that moves at an end must not ask for too much
_ACTIVE: Final = 0.02  # of the acceleration: what counts as none


def guessed(grid: Grid, limits: Limits, ends: tuple[float, float]) -> tuple[TimeLaw, FloatArray]:
    """A first guess of the law, and knots (n + 1,) at which it is after about equal times.

    Where the guess has no acceleration they are farther apart, but no farther than those of the grid.

    Args:
        grid: The curve.
        limits: Those of the vehicle.
        ends: Its rate at both ends. Where one is not 0, the guess is nowhere faster, and does not look at bends.

    Raises:
        ValueError: The way is too short to come to these rates.
    """
    ceilings = ceilings_of(grid)
    shaken = (limits.jerk_m_s3 / np.maximum(beside(grid.third), _TINY)) ** (2.0 / 3.0)
    bent = limits.acceleration_m_s2 / np.maximum(np.hypot(grid.bends[:, 0], grid.bends[:, 1]), _TINY)
    ceilings = np.minimum(np.minimum(ceilings, shaken), bent)
    if any(ends):
        # An even rate at which all of it can be flown, with gentle ramps.
        ceilings = np.full(len(ceilings), max(ends) ** 2)
        grid = replace(grid, bends=np.zeros_like(grid.bends))
    ceilings[[0, -1]] = np.array(ends) ** 2
    window_s = limits.acceleration_m_s2 / limits.jerk_m_s3
    guess = averaged(grid.knots_s, largest_squares(grid, ceilings, limits.acceleration_m_s2), window_s)
    count = max(FEWEST_CELLS, math.ceil(guess.duration_s / min(_STEP_S, window_s / _STEPS)))
    times = np.linspace(0.0, guess.duration_s, count + 1)
    step_s = guess.duration_s / count
    places, rates, growths = guess.jet(times)
    cell = np.clip(np.searchsorted(grid.knots_s, places, side="right") - 1, 0, len(grid.first) - 1)
    asked = grid.second[cell] * rates**2 + grid.first[cell] * np.abs(growths)
    active = np.flatnonzero(asked > _ACTIVE * limits.acceleration_m_s2)
    near = np.concatenate(([0], active, [count]))
    after = near[np.clip(np.searchsorted(near, np.arange(count + 1)), 0, len(near) - 1)]
    before = near[np.clip(np.searchsorted(near, np.arange(count + 1), side="right") - 1, 0, len(near) - 1)]
    away_s = step_s * np.minimum(after - np.arange(count + 1), np.arange(count + 1) - before) - window_s
    resolved_s = np.diff(grid.knots_s)[cell] / np.maximum(rates, _TINY)
    steps = np.clip(step_s + _GROWING * np.minimum(away_s, resolved_s / _GROWING), step_s, max(_LONGEST_S, step_s))
    passed = np.concatenate(([0.0], np.cumsum(0.5 * step_s * (1.0 / steps[1:] + 1.0 / steps[:-1]))))
    cells = max(FEWEST_CELLS, math.ceil(passed[-1]))
    chosen = np.interp(np.linspace(0.0, passed[-1], cells + 1), passed, times)
    found = guess.parameter(chosen)
    found[0], found[-1] = grid.knots_s[0], grid.knots_s[-1]
    return guess, found


def guessed_in_motion(
    grid: Grid, limits: Limits, ends: tuple[float, float], growth: float
) -> tuple[FloatArray, FloatArray]:
    """A first guess of a law that moves at an end: knots (n + 1,), and b between them, (n - 1,).

    Args:
        grid: The curve.
        limits: Those of the vehicle.
        ends: The law's rate at both ends.
        growth: Its sigma'' at the begin.

    Raises:
        ValueError: The way is too short to come to these rates.
    """
    first, way = float(grid.first[0]), float(grid.knots_s[-1])
    most, jerk = limits.acceleration_m_s2 / first, limits.jerk_m_s3 / first
    stop = stopping_after(way, ends[0], growth, most, jerk) if ends[1] == 0.0 else None
    if stop is not None and -float(stop.accelerations.min()) > _GENTLE * most:
        law = stop.law(ends[0])
        times = np.linspace(0.0, law.duration_s, max(FEWEST_CELLS, math.ceil(law.duration_s / _STEP_S)) + 1)
        places, rates, _ = law.jet(times)
        places[-1] = way
        return places, rates[1:-1] ** 2
    fades_s = abs(growth) / (_FADES * jerk)
    settled = ends[0] + 0.5 * growth * fades_s
    if settled <= 0.0 or fades_s * (ends[0] + growth * fades_s / 3.0) > _FADED * way:
        raise ValueError("the way is too short to come to these rates")
    gently = limits._replace(acceleration_m_s2=_GENTLE * limits.acceleration_m_s2, jerk_m_s3=_GENTLE * limits.jerk_m_s3)
    guess, places = guessed(grid, gently, (settled, ends[1]))
    return places, _with_ramp(places, guess.jet(guess.time_at(places))[1], fades_s, ends[0], growth)


def _with_ramp(places: FloatArray, rates: FloatArray, fades_s: float, begins: float, growth: float) -> FloatArray:
    """The b between places (n + 1,) at these rates but for the beginning, where a growth of the rate fades."""
    shares = np.linspace(0.0, 1.0, FEWEST_CELLS + 1)
    times = fades_s * shares
    fading = times * (begins + growth * times * (0.5 - shares / 6.0))
    ramp = np.interp(places, fading, begins + growth * times * (1.0 - 0.5 * shares))
    return np.asarray(np.where(places < fading[-1], ramp, rates)[1:-1] ** 2)


def ceilings_of(grid: Grid) -> FloatArray:
    """The largest sigma'^2 at the knots, shape (n + 1,), by the limit of speed."""
    return np.asarray(beside(-grid.rates) ** 2)


def largest_squares(grid: Grid, ceilings: FloatArray, acceleration_m_s2: float) -> FloatArray:
    """The largest b at the knots, shape (n + 1,).

    Args:
        grid: The curve.
        ceilings: Shape (n + 1,), d at each knot.
        acceleration_m_s2: Largest acceleration, a.
    """
    widths = np.diff(grid.knots_s)
    rises = 2.0 * acceleration_m_s2 * widths / np.maximum(grid.first, _TINY)
    squares = ceilings
    for order in (1, -1):
        # b at the end of a cell for b at its beginning: |(r'' + w) b - w b_0| = a with w = r' / (2 ds).
        ends = (slice(1, None), slice(None, -1))[order < 0]
        bends, toward = grid.bends[ends], order * grid.slopes[ends] / (2.0 * widths[:, None])
        sums = bends + toward
        norms = np.maximum((sums**2).sum(axis=1), _TINY)
        shares = (sums * toward).sum(axis=1) / norms
        crosses = ((bends[:, 0] * toward[:, 1] - bends[:, 1] * toward[:, 0]) / norms) ** 2
        reach = acceleration_m_s2**2 / norms
        values = squares[::order].tolist()
        cells = zip(*(each[::order].tolist() for each in (shares, crosses, reach, rises)), strict=True)
        b = values[0]
        for i, (share, cross, most, rise) in enumerate(cells, start=1):
            b = min(values[i], b + rise, share * b + math.sqrt(max(0.0, most - cross * b * b)))
            b = values[i] = max(b, _LEAST * values[i])
        squares = np.array(values, dtype=np.float64)[::order]
    return squares


def averaged(knots_s: FloatArray, squares: FloatArray, window_s: float) -> TimeLaw:
    """The moving average of the law with these b at these places; it rests, or holds its rate, beyond both ends.

    At an end at which it rests it begins, or stops, half a window before, or after, the one that is averaged. At one at
    which it moves it begins there, and needs b to be constant for half a window's time, for its sigma'' to vanish.
    """
    rates = np.sqrt(squares)
    times = np.concatenate(([0.0], np.cumsum(2.0 * np.diff(knots_s) / (rates[:-1] + rates[1:]))))
    half = 0.5 * window_s
    begin = 0.0 if rates[0] > 0.0 else -half
    end = float(times[-1]) + (0.0 if rates[-1] > 0.0 else half)
    inner = np.concatenate((times - half, times + half))
    inner = np.sort(inner[(inner > begin) & (inner < end)])
    knots = np.concatenate(([begin], inner, [end]))
    kept = np.concatenate(([True], np.diff(knots[:-1]) > _SAME_TIME_S, [True]))
    knots = knots[kept]
    growths = (np.interp(knots + half, times, rates) - np.interp(knots - half, times, rates)) / window_s
    growths[[0, -1]] = 0.0
    return law_from_growths(
        knots - begin, growths, (float(rates[0]), float(rates[-1])), (float(knots_s[0]), float(knots_s[-1]))
    )
