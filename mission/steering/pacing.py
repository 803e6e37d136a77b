"""The fastest sigma'^2 =: b on a grid within limits of speed, acceleration and jerk, by an interior-point method.

With b' and b'' the derivatives by s, sigma'' = b' / 2 and sigma''' = b'' sqrt(b) / 2, so that

    b                                    <= d
    |r'' b + r' b' / 2|                  <= a
    |3/2 r'' b' + 1/2 r' b''| + |r'''| b <= j / sqrt(b)

bound rate, acceleration and jerk, while the time, the integral of 1 / sqrt(b), is convex in b. Derivatives are
differences over three knots. All but the right side of the third is convex. The tangent of 1 / sqrt(b) at the present b
lies below it: Newton's method on the logarithmic barrier, with that tangent in its place, has convex steps that stay
within the true limits. Each constraint touches three neighbours: a step solves one system of five diagonals.

Next to a stop b grows as the 4/3rd power of the distance from it, which differences resolve badly: there b'' is scaled
so that it is exact for this power.

What comes out is a proposal; ``mission.steering.strain`` bounds what it really asks of the vehicle.
"""

from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Final, NamedTuple

import numpy as np
from scipy.linalg import LinAlgError, solveh_banded

from mission.geometry.arrays import FloatArray

_SHARPEN: Final = 16.0
"""By how much the time weighs more from one round to the next."""
_GAP: Final = 1e-3  # of the time: how far from the least it may stay
_MOST_GAP_S: Final = 0.02
_STEPS: Final = 8  # of Newton's method in a round, at most
_LAST_STEPS: Final = 16
_CENTRED: Final = 0.5  # Newton decrement below which a round is over
_ROUGHLY: Final = 0.1  # of the time: how far a rough guess is from the least, about
_HALVINGS: Final = 30
_ENOUGH: Final = 0.1  # of what the gradient promises
_POWER: Final = 4.0 / 3.0
_LEADS: Final = 8  # times that limits are eased
_EASED: Final = 1.05
_NEAR: Final = 0.05
_OWN: Final = np.array([[0.0], [1.0], [0.0]])  # of three values of b, the one of the knot itself


class _AtKnots(NamedTuple):
    """What limits are made of at inner knots, each axis by itself.

    Attributes:
        bends: Shape (2, n - 1), r''.
        half_slopes: Shape (2, n - 1), r' / 2.
        long_bends: Shape (2, n - 1), 3/2 r''.
        pulls: Shape (2, 3, n - 1), the derivatives of the acceleration by the three values of b about each knot.
        shakes: Shape (2, 3, n - 1), the same of the jerk over sigma'.
        pulled_by: Shape (3, 3, n - 1), the second derivatives of the square of the acceleration.
        shaken_by: Shape (3, 3, n - 1), the same of the jerk over sigma'.
    """

    bends: FloatArray
    half_slopes: FloatArray
    long_bends: FloatArray
    pulls: FloatArray
    shakes: FloatArray
    pulled_by: FloatArray
    shaken_by: FloatArray


class PacingState(NamedTuple):
    """Values of b inside of the limits, and what these make of them, at the inner knots.

    Attributes:
        inner: Shape (n - 1,), b.
        squares: Shape (n + 1,), b at all knots.
        pulled: Shape (2, n - 1), the acceleration.
        shaken: Shape (2, n - 1), the jerk over sigma'.
        slacks: What is left of the three limits.
        duration_s: The time that it takes.
        logarithms: Of the three slacks, summed.
    """

    inner: FloatArray
    squares: FloatArray
    pulled: FloatArray
    shaken: FloatArray
    slacks: tuple[FloatArray, FloatArray, FloatArray]
    duration_s: float
    logarithms: float

    def barrier(self, weight: float) -> float:
        """The time, weighed, with the logarithmic barrier of the limits."""
        return weight * self.duration_s - self.logarithms


@dataclass(frozen=True, eq=False)
class PacingProblem:
    """Limits at the inner knots of a grid from one stop to the next; n + 1 knots, n - 1 inner ones.

    Attributes:
        knots_s: Shape (n + 1,), ascending.
        slopes: Shape (n + 1, 2), r' there.
        bends: Shape (n + 1, 2), r'' there.
        third: Shape (n + 1,), a bound of |r'''| about each knot.
        ends: b at both ends, 0 at a stop.
        ceilings: Shape (n + 1,), d.
        accelerations: Shape (n + 1,), a.
        jerks: Shape (n + 1,), j.

    Where an end is no stop, b stays as it is at the inner knot next to it, for sigma'' at the end to be what it is.
    """

    knots_s: FloatArray
    slopes: FloatArray
    bends: FloatArray
    third: FloatArray
    ends: tuple[float, float]
    ceilings: FloatArray
    accelerations: FloatArray
    jerks: FloatArray
    _stencils: tuple[FloatArray, FloatArray] = field(init=False)

    def __post_init__(self) -> None:
        before, after = np.diff(self.knots_s)[:-1], np.diff(self.knots_s)[1:]
        both = before + after
        first = np.stack((-after / (before * both), (after - before) / (before * after), before / (after * both)))
        second = np.stack((2.0 / (before * both), -2.0 / (before * after), 2.0 / (after * both)))
        scale = np.ones(len(both))
        for stop, at_rest in zip(self.knots_s[[0, -1]], (end == 0.0 for end in self.ends), strict=True):
            if at_rest:
                away = np.abs(self.knots_s - stop)
                power = away**_POWER
                found = second[0] * power[:-2] + second[1] * power[1:-1] + second[2] * power[2:]
                exact = _POWER * (_POWER - 1.0) * away[1:-1] ** (_POWER - 2.0)
                # Farther away differences are exact enough, but for what rounding leaves of them.
                scale *= np.divide(exact, found, out=np.ones_like(exact), where=both > _NEAR * away[1:-1])
        object.__setattr__(self, "_stencils", (first, second * scale))

    def squares(self, inner: FloatArray) -> FloatArray:
        """All knots' b, from those at the inner ones."""
        return np.concatenate(([self.ends[0]], inner, [self.ends[1]]))

    def growths(self, squares: FloatArray) -> FloatArray:
        """The second derivative of sigma at the inner knots."""
        return np.asarray(0.5 * _differences(self._stencils[0], squares))

    def duration_s(self, squares: FloatArray) -> float:
        """The time that it takes, sigma'' being constant on each cell."""
        roots = np.sqrt(squares)
        return float((2.0 * np.diff(self.knots_s) / (roots[1:] + roots[:-1])).sum())

    @cached_property
    def _at_knots(self) -> _AtKnots:
        """What does not depend on b; of each constraint the derivatives by the three values of b."""
        bends, half_slopes = self.bends[1:-1].T.copy(), 0.5 * self.slopes[1:-1].T
        long_bends = 1.5 * bends
        first, second = self._stencils
        pulls = half_slopes[:, None] * first + _OWN * bends[:, None]
        shakes = long_bends[:, None] * first + half_slopes[:, None] * second
        by_axes = (2.0 * np.einsum("kin,kjn->ijn", each, each) for each in (pulls, shakes))
        return _AtKnots(bends, half_slopes, long_bends, pulls, shakes, *by_axes)

    def _strained(self, squares: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Acceleration, and jerk over sigma', at the inner knots: shape (2, n - 1) each."""
        slope, bend = (_differences(stencil, squares) for stencil in self._stencils)
        at = self._at_knots
        return at.bends * squares[1:-1] + at.half_slopes * slope, at.long_bends * slope + at.half_slopes * bend

    def _slacks(
        self, inner: FloatArray, pulled: FloatArray, shaken: FloatArray
    ) -> tuple[FloatArray, FloatArray, FloatArray]:
        """What is left of the three limits; all positive inside."""
        room = self.jerks[1:-1] - self.third[1:-1] * inner**1.5
        return (
            self.ceilings[1:-1] - inner,
            self.accelerations[1:-1] ** 2 - _squared(pulled),
            np.where(room > 0.0, room**2 - inner * _squared(shaken), -1.0),
        )

    def eased(self, inner: FloatArray) -> "PacingProblem":
        """The same with limits that are no less than what these b ask for, and a little more."""
        pulled, shaken = self._strained(self.squares(inner))
        asked = inner, np.hypot(*pulled), np.hypot(*shaken) * np.sqrt(inner) + self.third[1:-1] * inner**1.5
        limits = (self.ceilings, self.accelerations, self.jerks)
        ceilings, accelerations, jerks = (
            np.maximum(limit, np.pad(_EASED * each, 1)) for limit, each in zip(limits, asked, strict=True)
        )
        return replace(self, ceilings=ceilings, accelerations=accelerations, jerks=jerks)

    def state(self, inner: FloatArray) -> PacingState | None:
        """What values of b (n - 1,) come to; None outside of the limits."""
        if not (inner > 0.0).all():
            return None
        squares = self.squares(inner)
        pulled, shaken = self._strained(squares)
        slacks = self._slacks(inner, pulled, shaken)
        if not all((slack > 0.0).all() for slack in slacks):
            return None
        logarithms = sum(float(np.log(slack).sum()) for slack in slacks)
        return PacingState(inner, squares, pulled, shaken, slacks, self.duration_s(squares), logarithms)

    def newton(self, state: PacingState, weight: float) -> tuple[FloatArray, float]:
        """Newton's step from a state, and what the barrier should lose by it."""
        inner, squares, pulled, shaken, (ceiling, pull_slack, _), *_ = state
        at, count = self._at_knots, len(inner)
        room = self.jerks[1:-1] / np.sqrt(inner) - self.third[1:-1] * inner
        lost = -0.5 * self.jerks[1:-1] * inner**-1.5 - self.third[1:-1]
        shake_slack = room**2 - _squared(shaken)
        pulling, shaking = (by[0] * now[0] + by[1] * now[1] for by, now in ((at.pulls, pulled), (at.shakes, shaken)))
        by_pull = 2.0 * pulling / pull_slack
        by_shake = 2.0 * (shaking - _OWN * room * lost) / shake_slack
        local = by_pull + by_shake + _OWN * (1.0 / ceiling - 1.0 / inner)
        blocks = by_pull[:, None] * by_pull + by_shake[:, None] * by_shake
        blocks += at.pulled_by / pull_slack
        blocks += at.shaken_by / shake_slack
        blocks[1, 1] += 1.0 / ceiling**2 + 1.0 / inner**2 - 2.0 * lost**2 / shake_slack
        gradient, bands = np.zeros(count + 2), np.zeros((3, count + 2))
        for i in range(3):
            gradient[i : i + count] += local[i]
            for j in range(i + 1):
                bands[i - j, j : j + count] += blocks[i, j]
        self._add_time(squares, weight, gradient, bands)
        gradient, bands = gradient[1:-1], bands[:, 1:-1].copy()
        for knot in (knot for knot, end in zip((0, count - 1), self.ends, strict=True) if end > 0.0):
            gradient[knot], bands[:, knot] = 0.0, (1.0, 0.0, 0.0)
            for below in (1, 2):
                if knot >= below:
                    bands[below, knot - below] = 0.0
        step = solveh_banded(bands, -gradient, lower=True, check_finite=False)
        return step, float(-gradient @ step)

    def _add_time(self, squares: FloatArray, weight: float, gradient: FloatArray, bands: FloatArray) -> None:
        """Add the derivatives of the time."""
        roots = np.sqrt(squares)
        sums, widths = roots[1:] + roots[:-1], 2.0 * weight * np.diff(self.knots_s)
        each = np.divide(0.5, roots, out=np.zeros_like(roots), where=roots > 0.0)
        curved = np.divide(each, 2.0 * squares, out=np.zeros_like(roots), where=squares > 0.0)
        for side in (slice(None, -1), slice(1, None)):
            gradient[side] -= widths * each[side] / sums**2
            bands[0, side] += widths * (2.0 * each[side] ** 2 / sums**3 + curved[side] / sums**2)
        bands[1, :-1] += widths * 2.0 * each[:-1] * each[1:] / sums**3


def led_inside(problem: PacingProblem, inner: FloatArray) -> PacingState | None:
    """A state inside of the limits; from values of b at the inner knots, shape (n - 1,), that need not be.

    The limits are eased until the values are inside, which are then brought far inside of these; and so on until no
    limit is eased any more.

    Returns:
        None where that does not come to an end.
    """
    for _ in range(_LEADS):
        state = problem.state(inner)
        if state is not None:
            return state
        eased = problem.eased(inner)
        state = eased.state(inner)
        for _ in range(_STEPS):
            moved = None if state is None else _stepped(eased, state, 0.0)
            if moved is None:
                break
            state, promised = moved
            inner = state.inner
            if promised <= _CENTRED:
                break
    return None


def _stepped(problem: PacingProblem, state: PacingState, weight: float) -> tuple[PacingState, float] | None:
    """A damped step of Newton's method: where it leads, and what it promised to be lost of the barrier.

    None where nothing is lost by any, or rounding has left the step's equations no solution.
    """
    try:
        step, promised = problem.newton(state, weight)
    except LinAlgError:
        return None
    value, size = state.barrier(weight), 1.0
    for _ in range(_HALVINGS):
        tried = problem.state(state.inner + size * step)
        if tried is not None and tried.barrier(weight) <= value - _ENOUGH * size * promised:
            return tried, promised
        size *= 0.5
    return None


def fastest_squares(problem: PacingProblem, state: PacingState, *, rough: bool = True) -> FloatArray:
    """Values of b at all knots, shape (n + 1,), for which the flight takes little more than the least time.

    Args:
        problem: The limits.
        state: Inside of them.
        rough: Whether it is far from the outcome.
    """
    limits = 4.0 * len(state.inner)
    present_s = state.duration_s
    gap_s = min(_GAP * present_s, _MOST_GAP_S)
    weight = limits / (_ROUGHLY * present_s if rough else gap_s * _SHARPEN)
    while True:
        last = limits <= gap_s * weight
        for _ in range(_LAST_STEPS if last else _STEPS):
            moved = _stepped(problem, state, weight)
            if moved is None:
                return state.squares
            state, promised = moved
            if promised <= _CENTRED:
                break
        if last:
            return state.squares
        weight *= _SHARPEN


def _squared(vectors: FloatArray) -> FloatArray:
    """The square of the length of vectors (2, n)."""
    return np.asarray(vectors[0] ** 2 + vectors[1] ** 2)


def _differences(stencil: FloatArray, values: FloatArray) -> FloatArray:
    return np.asarray(stencil[0] * values[:-2] + stencil[1] * values[1:-1] + stencil[2] * values[2:])
