"""Coming to rest from a motion on a line, with limits of acceleration and jerk.

The acceleration goes down to the largest brake, stays there, and goes up to nothing at the end: three phases of
constant jerk, of which the one in the middle is left out where the speed is too low for it.
"""

from typing import Final, NamedTuple

import numpy as np

from mission.geometry.arrays import FloatArray
from mission.steering.law import TimeLaw, law_from_growths

_BISECTIONS: Final = 50
_GENTLEST: Final = 1e-3


class Stopping(NamedTuple):
    """How a motion comes to rest.

    Attributes:
        times_s: Shape (4,), of the ends of the phases, from 0.
        accelerations: Shape (4,), then; linear in between, and 0 at the end.
        way: How far it goes on.
    """

    times_s: FloatArray
    accelerations: FloatArray
    way: float

    def law(self, speed: float) -> TimeLaw:
        """The same as a time law, if it begins with this speed."""
        lasts = np.append(True, np.diff(self.times_s) > 0.0)
        return law_from_growths(self.times_s[lasts], self.accelerations[lasts], (speed, 0.0), (0.0, self.way))


def stopping(speed: float, acceleration: float, most: float, jerk: float) -> Stopping:
    """The way to rest from a speed, which is positive, and an acceleration.

    Where the vehicle brakes too hard already for the jerk, more of it is taken.

    Args:
        speed: At the begin.
        acceleration: Likewise.
        most: The largest brake, if it is no larger at the begin.
        jerk: The largest jerk.
    """
    least = max(-acceleration, 0.0)
    most = max(most, least)
    if least > 0.0 and speed < 0.5 * least**2 / jerk:
        jerk = 0.5 * least**2 / speed
    # The speed that is lost while the brake comes up and fades.
    if speed + 0.5 * (acceleration**2 - 2.0 * most**2) / jerk < 0.0:
        most = max(least, float(np.sqrt(0.5 * acceleration**2 + jerk * speed)))
    held = max(0.0, (speed + (0.5 * acceleration**2 - most**2) / jerk) / most) if most > 0.0 else 0.0
    times = np.cumsum([0.0, (acceleration + most) / jerk, held, most / jerk])
    accelerations = np.array([acceleration, -most, -most, 0.0])
    steps = np.diff(times)
    speeds = speed + np.concatenate(([0.0], np.cumsum(0.5 * steps * (accelerations[1:] + accelerations[:-1]))))
    ways = steps * (speeds[:-1] + steps * (2.0 * accelerations[:-1] + accelerations[1:]) / 6.0)
    return Stopping(times, accelerations, float(ways.sum()))


def stopping_after(way: float, speed: float, acceleration: float, most: float, jerk: float) -> Stopping | None:
    """The same with limits that are lower by as much as makes the way so long; None where that is not possible."""
    low, high = _GENTLEST, 1.0
    if not stopping(speed, acceleration, most, jerk).way <= way:
        return None
    if stopping(speed, acceleration, low * most, low * jerk).way < way:
        return None
    for _ in range(_BISECTIONS):
        middle = 0.5 * (low + high)
        short = stopping(speed, acceleration, middle * most, middle * jerk).way < way
        low, high = (low, middle) if short else (middle, high)
    return stopping(speed, acceleration, high * most, high * jerk)
