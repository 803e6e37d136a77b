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

from dataclasses import dataclass, field
from typing import Final

import numpy as np
from scipy.linalg import solveh_banded

from mission.geometry.arrays import FloatArray

_SHARPEN: Final = 8.0
"""By how much the time weighs more from one round to the next."""
_GAP: Final = 1e-3  # of the time: how far from the least it may stay
_MOST_GAP_S: Final = 0.02
_STEPS: Final = 8  # of Newton's method in a round, at most
_LAST_STEPS: Final = 16
_CENTRED: Final = 0.1  # Newton decrement below which a round is over
_HALVINGS: Final = 30
_ENOUGH: Final = 0.1  # of what the gradient promises
_POWER: Final = 4.0 / 3.0
_NEAR: Final = 0.05


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

    Where an end is no stop, b stays as it is at the inner knot next to it, for sigma'' to vanish at the end.
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

    def slacks(self, inner: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
        """What is left of the three limits; all positive inside."""
        squares = self.squares(inner)
        slope, bend = (_differences(stencil, squares)[:, None] for stencil in self._stencils)
        bends, slopes = self.bends[1:-1], self.slopes[1:-1]
        pulled = bends * inner[:, None] + 0.5 * slopes * slope
        shaken = 1.5 * bends * slope + 0.5 * slopes * bend
        room = self.jerks[1:-1] - self.third[1:-1] * inner**1.5
        return (
            self.ceilings[1:-1] - inner,
            self.accelerations[1:-1] ** 2 - (pulled**2).sum(axis=1),
            np.where(room > 0.0, room**2 - inner * (shaken**2).sum(axis=1), -1.0),
        )

    def barrier(self, inner: FloatArray, weight: float) -> float:
        """The time, weighed, with the logarithmic barrier of the limits; infinite outside of them."""
        if not (inner > 0.0).all():
            return np.inf
        slacks = self.slacks(inner)
        if not all((slack > 0.0).all() for slack in slacks):
            return np.inf
        return weight * self.duration_s(self.squares(inner)) - sum(float(np.log(slack).sum()) for slack in slacks)

    def newton(self, inner: FloatArray, weight: float) -> tuple[FloatArray, float]:
        """Newton's step from a point inside, and what the barrier should lose by it."""
        squares = self.squares(inner)
        slope, bend = (_differences(stencil, squares)[:, None] for stencil in self._stencils)
        bends, slopes = self.bends[1:-1], self.slopes[1:-1]
        count = len(inner)
        # Of each constraint: its value at the knot, and the derivatives by the three values of b, (3, n - 1, 2).
        first, second = (stencil[:, :, None] for stencil in self._stencils)
        own = np.array([0.0, 1.0, 0.0])[:, None]
        pulled = bends * inner[:, None] + 0.5 * slopes * slope
        pulls = 0.5 * slopes * first + own[:, :, None] * bends
        shaken = 1.5 * bends * slope + 0.5 * slopes * bend
        shakes = 1.5 * bends * first + 0.5 * slopes * second
        ceiling, pull_slack, _ = self.slacks(inner)
        room = self.jerks[1:-1] / np.sqrt(inner) - self.third[1:-1] * inner
        lost = -0.5 * self.jerks[1:-1] * inner**-1.5 - self.third[1:-1]
        shake_slack = room**2 - (shaken**2).sum(axis=1)
        by_pull = 2.0 * (pulls * pulled).sum(axis=2) / pull_slack
        by_shake = 2.0 * ((shakes * shaken).sum(axis=2) - own * room * lost) / shake_slack
        local = by_pull + by_shake + own * (1.0 / ceiling - 1.0 / inner)
        blocks = np.einsum("in,jn->ijn", by_pull, by_pull) + np.einsum("in,jn->ijn", by_shake, by_shake)
        blocks += 2.0 * np.einsum("ink,jnk->ijn", pulls, pulls) / pull_slack
        blocks += 2.0 * np.einsum("ink,jnk->ijn", shakes, shakes) / shake_slack
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


def fastest_squares(problem: PacingProblem, inner: FloatArray, *, rough: bool = True) -> FloatArray:
    """Values of b at the inner knots, shape (n - 1,), for which the flight takes little more than the least time.

    Args:
        problem: The limits.
        inner: Shape (n - 1,), values inside of them.
        rough: Whether these are far from the outcome.
    """
    limits = 4.0 * len(inner)
    present_s = problem.duration_s(problem.squares(inner))
    gap_s = min(_GAP * present_s, _MOST_GAP_S)
    weight = limits / (present_s if rough else gap_s * _SHARPEN)
    while True:
        last = limits <= gap_s * weight
        value = problem.barrier(inner, weight)
        for _ in range(_LAST_STEPS if last else _STEPS):
            step, promised = problem.newton(inner, weight)
            size = 1.0
            for _ in range(_HALVINGS):
                tried = problem.barrier(inner + size * step, weight)
                if tried <= value - _ENOUGH * size * promised:
                    break
                size *= 0.5
            else:
                return inner
            inner, value = inner + size * step, tried
            if promised <= _CENTRED:
                break
        if last:
            return inner
        weight *= _SHARPEN


def _differences(stencil: FloatArray, values: FloatArray) -> FloatArray:
    return np.asarray(stencil[0] * values[:-2] + stencil[1] * values[1:-1] + stencil[2] * values[2:])
