"""How much of a vehicle's limits a time law asks for on a curve: proved bounds on every cell of a grid.

With r = r(sigma(t)):

    velocity      r' sigma'
    acceleration  r'' sigma'^2 + r' sigma''
    jerk          r''' sigma'^3 + 3 r'' sigma' sigma'' + r' sigma'''

The law is cubic in time between its knots, so that the derivatives of sigma have exact bounds on each part of time in
which it has no knot and the vehicle is in one cell; those of the curve's derivatives on a cell are proved. Together
they bound the jerk J. The acceleration within a cell that takes the time d is then no larger than the mean of those
at the cell's ends plus J d / 2, which keeps what lengthwise and crosswise acceleration have to do with each other.
"""

import math
from typing import Final, NamedTuple

import numpy as np

from mission.geometry.arrays import FloatArray
from mission.steering.grid import Grid, Limits
from mission.steering.law import TimeLaw

_ROUNDING: Final = 1.0 + 1e-9


class Strain(NamedTuple):
    """On each cell (n,): bounds of speed, acceleration and jerk, as parts of the limits.

    Attributes:
        speed: Of the rate's, by which speed is limited.
        acceleration: Of the acceleration's.
        jerk: Of the jerk's.
    """

    speed: FloatArray
    acceleration: FloatArray
    jerk: FloatArray

    @property
    def excess(self) -> float:
        """By which factor the law must be slower to keep the limits."""
        acceleration, jerk = float(self.acceleration.max()), float(self.jerk.max())
        return max(float(self.speed.max()), math.sqrt(acceleration), float(np.cbrt(jerk)))


def strain(law: TimeLaw, grid: Grid, limits: Limits) -> Strain:
    """Bound what a law that begins and ends with a grid, and never rests in between, asks of the vehicle."""
    enters = law.time_at(grid.knots_s)
    enters[0], enters[-1] = 0.0, law.duration_s
    enters = np.maximum.accumulate(enters)
    times = np.sort(np.concatenate((enters, law.knots_t_s)))
    middles = 0.5 * (times[:-1] + times[1:])
    cell = np.clip(np.searchsorted(enters, middles, side="right") - 1, 0, len(enters) - 2)
    steps, jerks = np.diff(times), law.jerks[law.piece_at(middles)]
    _, rates, growths = law.jet(times)
    fastest = np.maximum(rates[:-1], rates[1:]) + np.abs(jerks) * steps**2 / 8.0
    steepest = np.maximum(np.abs(growths[:-1]), np.abs(growths[1:]))
    first, second, third = grid.first[cell], grid.second[cell], grid.third[cell]
    bent = second * fastest**2 + first * steepest
    bending = third * fastest**3
    # The curve's first derivatives within a cell differ from those at its beginning by so much.
    width = np.diff(grid.knots_s)[cell]
    least = np.maximum(np.minimum(rates[:-1], rates[1:]) - np.abs(jerks) * steps**2 / 8.0, 0.0)
    turning = np.zeros(len(steps))
    for growth in (growths[:-1], growths[1:]):
        for rate in (least, fastest):
            vectors = 3.0 * grid.bends[cell] * (rate * growth)[:, None] + grid.slopes[cell] * jerks[:, None]
            turning = np.maximum(turning, np.hypot(vectors[:, 0], vectors[:, 1]))
    turning += width * (3.0 * third * fastest * steepest + second * np.abs(jerks))
    jerk = bending + np.minimum(turning, 3.0 * second * fastest * steepest + first * np.abs(jerks))

    def of_cells(values: FloatArray) -> FloatArray:
        found = np.zeros(len(enters) - 1)
        np.maximum.at(found, cell, values)
        return found

    worst = of_cells(jerk)
    _, rate, growth = law.jet(enters)
    vectors = grid.bends * rate[:, None] ** 2 + grid.slopes * growth[:, None]
    sizes = np.hypot(vectors[:, 0], vectors[:, 1])
    mean, slack = 0.5 * (sizes[:-1] + sizes[1:]), 0.5 * worst * np.diff(enters)
    direct = of_cells(bent)
    acceleration = np.minimum(direct, mean + slack)
    return Strain(
        of_cells(fastest) * _ROUNDING / grid.rates,
        acceleration * (_ROUNDING / limits.acceleration_m_s2),
        worst * (_ROUNDING / limits.jerk_m_s3),
    )
