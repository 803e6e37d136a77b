"""What is flown between two plans: a trajectory that is slowed to rest or taken up again, or a short way.

Each begins with the position, the velocity and the acceleration of what was flown before it, and is at rest at its end
and beyond, or goes on as the trajectory does.
"""

import math
from dataclasses import dataclass, replace
from typing import Final, Self

import numpy as np

from mission.geometry.arrays import FloatArray
from mission.link.course import Flown, Reference
from mission.spec.model import Point

_LEAST_S: Final = 0.5
_LONGEST_S: Final = 60.0
_IN_ALL: Final = 1.4
_LONGER: Final = 1.2
_SAMPLES: Final = 64
_TRIED_S: Final = tuple(_LEAST_S * _LONGER**k for k in range(1 + math.ceil(math.log(_LONGEST_S / _LEAST_S, _LONGER))))
"""In which a trajectory may be retimed."""
_PEAK: Final = 1.5
"""Of the mean slope of a cubic that begins and ends level, its largest."""


@dataclass(frozen=True, eq=False)
class Retimed:
    """A trajectory whose own time s goes at a rate that changes from one value to another within a while, smoothly.

    With u = t / T the rate is r_0 + (r_1 - r_0) (3 u^2 - 2 u^3), so that velocity and acceleration do not jump:
    s = s_0 + T (r_0 u + (r_1 - r_0) (u^3 - u^4 / 2)). Afterwards the rate stays; where it is 0, the vehicle rests.

    Attributes:
        trajectory: Whose path is flown.
        from_s: Its time at the beginning, s_0.
        rates: r_0 and r_1.
        within_s: T.
    """

    trajectory: Flown
    from_s: float
    rates: tuple[float, float]
    within_s: float

    @property
    def duration_s(self) -> float:
        """Time from start to end; infinite where the trajectory has laps that nobody has counted."""
        own_s = self.trajectory.duration_s - float(self.own_s(np.array([self.within_s]))[0])
        return self.within_s + (max(own_s, 0.0) / self.rates[1] if self.rates[1] > 0.0 else 0.0)

    @property
    def altitude_m(self) -> float:
        """Height above the take-off point."""
        return self.trajectory.altitude_m

    @property
    def laps(self) -> int | None:
        """How often the lap of the trajectory is flown."""
        return self.trajectory.laps

    @property
    def laps_end_s(self) -> float:
        """When its last lap is over; infinite where that is not flown."""
        if self.rates[1] == 0.0:
            return 0.0
        own_s = self.trajectory.laps_end_s - float(self.own_s(np.array([self.within_s]))[0])
        return self.within_s + own_s / self.rates[1]

    def own_s(self, t_s: FloatArray) -> FloatArray:
        """The trajectory's time at the times (P,)."""
        first, last = self.rates
        u = np.clip(t_s / self.within_s, 0.0, 1.0)
        changed = self.from_s + self.within_s * (first * u + (last - first) * (u**3 - 0.5 * u**4))
        return np.asarray(changed + last * np.maximum(t_s - self.within_s, 0.0))

    def rate(self, t_s: FloatArray) -> FloatArray:
        """How fast that goes at the times (P,)."""
        first, last = self.rates
        u = np.clip(t_s / self.within_s, 0.0, 1.0)
        return np.asarray(first + (last - first) * (3.0 * u**2 - 2.0 * u**3))

    def growth(self, t_s: FloatArray) -> FloatArray:
        """How fast the rate itself grows at the times (P,)."""
        first, last = self.rates
        u = np.clip(t_s / self.within_s, 0.0, 1.0)
        return np.asarray((last - first) * 6.0 * (u - u**2) / self.within_s)

    def planned_s(self, t_s: float) -> float:
        """The trajectory's time at a time."""
        return float(self.own_s(np.array([t_s]))[0])

    def state(self, t_s: FloatArray, /) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Position, velocity and acceleration at the times (P,), each of shape (P, 2)."""
        rate, growth = self.rate(t_s)[:, None], self.growth(t_s)[:, None]
        position, velocity, acceleration = self.trajectory.state(self.own_s(t_s))
        return position, velocity * rate, acceleration * rate**2 + velocity * growth

    def first_lap_s(self, t_s: float, /) -> float:
        """A time in a lap as that in the first lap, on the trajectory."""
        return self.trajectory.first_lap_s(self.planned_s(t_s))

    def ended_after(self, t_s: float, /) -> Self:
        """The same up to the end of the lap that is flown at a time."""
        return replace(self, trajectory=self.trajectory.ended_after(self.planned_s(t_s)))


def slowed(trajectory: Flown, from_s: float, rate: float, most_m_s2: float) -> Retimed:
    """A trajectory brought to rest along itself, as soon as the acceleration allows for it.

    Args:
        trajectory: What is flown.
        from_s: Its time when that begins.
        rate: How fast that goes then.
        most_m_s2: What may be added along the path; in all it is at most ``_IN_ALL`` times that, but where the
            trajectory's own acceleration is larger.
    """
    return _retimed(trajectory, from_s, (rate, 0.0), most_m_s2)


def taken_up(trajectory: Flown, from_s: float, most_m_s2: float) -> Retimed:
    """A trajectory on which the vehicle rests, flown on from there at its own pace."""
    return _retimed(trajectory, from_s, (0.0, 1.0), most_m_s2)


def _retimed(trajectory: Flown, from_s: float, rates: tuple[float, float], most_m_s2: float) -> Retimed:
    tried = [Retimed(trajectory, from_s, rates, within_s) for within_s in _TRIED_S]
    shares = np.linspace(0.0, 1.0, _SAMPLES)
    # All at once: a trajectory takes about as long for a few times as for many.
    own_s = np.concatenate([each.own_s(shares * each.within_s) for each in tried])
    own = [each.reshape(len(tried), _SAMPLES, 2) for each in trajectory.state(own_s)]
    for found, states in zip(tried, zip(*own, strict=True), strict=True):
        rate, growth = found.rate(shares * found.within_s)[:, None], found.growth(shares * found.within_s)[:, None]
        pulled, added = states[2] * rate**2, states[1] * growth
        allowed = max(_IN_ALL * most_m_s2, float(np.hypot(*states[2].T).max()))
        if np.hypot(*(pulled + added).T).max() <= allowed and np.hypot(*added.T).max() <= most_m_s2:
            return found
    return tried[-1]


@dataclass(frozen=True, eq=False)
class Transfer:
    """From a place and velocity to rest at another place, straight or nearly so, by a polynomial of degree 5.

    Attributes:
        begin: Where it begins, and how.
        end_m: Where it ends, at rest.
        duration_s: From start to end.
    """

    begin: Reference
    end_m: Point
    duration_s: float
    laps: int | None = 1
    laps_end_s: float = 0.0

    @property
    def altitude_m(self) -> float:
        """Height above the take-off point."""
        return self.begin.position_m[2]

    def state(self, t_s: FloatArray, /) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Position, velocity and acceleration at the times (P,), each of shape (P, 2); at rest after the end."""
        span = self.duration_s
        u = np.clip(t_s / span, 0.0, 1.0)[:, None]
        p, v, a = (np.array(vector[:2]) for vector in self.begin)
        c1, c2 = span * v, 0.5 * span**2 * a
        d = np.array(self.end_m) - p - c1 - c2
        w, b = -c1 - 2.0 * c2, -2.0 * c2
        c3, c4, c5 = 10.0 * d - 4.0 * w + 0.5 * b, -15.0 * d + 7.0 * w - b, 6.0 * d - 3.0 * w + 0.5 * b
        return (
            p + u * (c1 + u * (c2 + u * (c3 + u * (c4 + u * c5)))),
            (c1 + u * (2.0 * c2 + u * (3.0 * c3 + u * (4.0 * c4 + u * 5.0 * c5)))) / span,
            (2.0 * c2 + u * (6.0 * c3 + u * (12.0 * c4 + u * 20.0 * c5))) / span**2,
        )

    def first_lap_s(self, t_s: float, /) -> float:
        """The same time: there are no laps."""
        return t_s

    def ended_after(self, _t_s: float, /) -> Self:
        """The same."""
        return self


def stopping_place(begin: Reference, most_m_s2: float) -> Point:
    """Where a vehicle comes to rest that brakes with a share of an acceleration."""
    span = _stopping_s(begin, most_m_s2)
    (x, y, _), (vx, vy, _), _ = begin
    return x + 0.5 * span * vx, y + 0.5 * span * vy


def transfer(begin: Reference, end_m: Point, most_m_s2: float) -> Transfer:
    """The way to rest at a place, as soon as the acceleration allows for it."""
    span = _stopping_s(begin, most_m_s2)
    while True:
        found = Transfer(begin, end_m, span)
        accelerations = found.state(np.linspace(0.0, span, _SAMPLES))[2]
        own = math.hypot(*begin.acceleration_m_s2)
        if float(np.hypot(*accelerations.T).max()) <= max(most_m_s2, own) or span >= _LONGEST_S:
            return found
        span *= _LONGER


def _stopping_s(begin: Reference, most_m_s2: float) -> float:
    return max(_PEAK * math.hypot(*begin.velocity_m_s) / most_m_s2, _LEAST_S)
