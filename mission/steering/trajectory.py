"""The trajectory that the vehicle tracks: curves, each flown by a time law from rest to rest, at one altitude."""

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import pairwise
from typing import Any, NamedTuple, Self

import numpy as np
from numpy.typing import ArrayLike

from mission.geometry.arrays import FloatArray, IntArray
from mission.steering.joined import Curve, JoinedCurve, curve_from_json, joins
from mission.steering.law import TimeLaw

_JUMP = 1e-4  # m/s, or m/s^2: rounding


class Leg(NamedTuple):
    """A curve r(s) with its time law s = sigma(t)."""

    curve: Curve
    law: TimeLaw

    @property
    def duration_s(self) -> float:
        """Time from start to end, stops included."""
        return self.law.duration_s

    def state(self, t_s: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Position r, velocity r' sigma' and acceleration r'' sigma'^2 + r' sigma'' at (P,) times, each (P, 2)."""
        s, rate, growth = self.law.jet(t_s)
        position, slope, bend = self.curve.jet(s)
        rates = rate[:, None]
        return position, slope * rates, bend * rates**2 + slope * growth[:, None]


def _flows(before: Leg, after: Leg) -> bool:
    """Whether velocity and acceleration at the end of one leg are those at the beginning of the next."""
    ends = before.state(np.array([before.duration_s])), after.state(np.zeros(1))
    return all(float(np.abs(end - begin).max()) <= _JUMP for end, begin in zip(*(end[1:] for end in ends), strict=True))


@dataclass(frozen=True, eq=False)
class Trajectory:
    """Analytic position, velocity and acceleration over time, ENU in the domain's frame; at rest after its end.

    The legs follow each other. One of them may be a lap, which ends where it begins and is flown several times. Where
    two legs meet, and between two laps, the vehicle rests for a moment, or flies through where their curves join
    smoothly: position, velocity and acceleration are continuous throughout. The first leg may begin in motion.

    Attributes:
        legs: At least one, each beginning where the one before it ends.
        altitude_m: Height above the take-off point.
        lap: Which leg is the lap; None where none is.
        laps: How often it is flown, at least once; None until somebody says that it is enough (see ``ended_after``).

    Raises:
        ValueError: The legs do not join, or the lap does not close, or there are no laps, or velocity or acceleration
            would jump.
    """

    legs: tuple[Leg, ...]
    altitude_m: float
    lap: int | None = None
    laps: int | None = 1

    def __post_init__(self) -> None:
        curves = self.curve.legs
        if self.lap is not None and not (0 <= self.lap < len(curves) and joins(curves[self.lap], curves[self.lap])):
            raise ValueError("a lap ends where it begins")
        if self.laps is not None and self.laps < 1:
            raise ValueError("a lap is flown once or more")
        followed = [*pairwise(self.legs), *([(self.legs[self.lap],) * 2] if self.lap is not None else [])]
        if self.legs[-1].law.rates[-1] > 0.0 or not all(_flows(before, after) for before, after in followed):
            raise ValueError("velocity and acceleration do not jump")

    @cached_property
    def curve(self) -> JoinedCurve:
        """The path, each leg once."""
        return JoinedCurve(tuple(leg.curve for leg in self.legs))

    @property
    def duration_s(self) -> float:
        """Time from start to end, stops included; infinite where nothing is said of how many laps there are."""
        return float(self._spans_s[-1])

    @property
    def laps_end_s(self) -> float:
        """When the last lap is over; infinite where nobody has said how many there are, 0 where there is none."""
        return 0.0 if self.lap is None else float(self._spans_s[self.lap + 1])

    def position(self, t_s: ArrayLike) -> FloatArray:
        """Position at the times ``t_s`` (P,), shape (P, 2), metres."""
        return self.state(t_s)[0]

    def velocity(self, t_s: ArrayLike) -> FloatArray:
        """Velocity at the times ``t_s`` (P,), shape (P, 2), m/s."""
        return self.state(t_s)[1]

    def acceleration(self, t_s: ArrayLike) -> FloatArray:
        """Acceleration at the times ``t_s`` (P,), shape (P, 2), m/s^2."""
        return self.state(t_s)[2]

    def state(self, t_s: ArrayLike) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Position, velocity and acceleration at the times ``t_s`` (P,), each of shape (P, 2)."""
        which, own_s, _ = self._placed(t_s)
        states = np.empty((3, len(own_s), 2))
        for number in np.unique(which).tolist():
            states[:, which == number] = self.legs[number].state(own_s[which == number])
        return states[0], states[1], states[2]

    def parameter(self, t_s: ArrayLike) -> FloatArray:
        """Where on ``curve`` the vehicle is at the times ``t_s`` (P,), shape (P,)."""
        which, own_s, _ = self._placed(t_s)
        places = np.empty(len(own_s))
        for number in np.unique(which).tolist():
            places[which == number] = self.legs[number].law.parameter(own_s[which == number])
        return np.asarray(places + self.curve.starts_s[which])

    def first_lap_s(self, t_s: float) -> float:
        """A time in a lap as that in the first lap, a time after the laps as after one."""
        if self.lap is None:
            return t_s
        which, own_s, _ = self._placed(t_s)
        return float(self._once_s[which[0]] + own_s[0])

    def time_at(self, s: ArrayLike, *, leaving: bool = False) -> FloatArray:
        """The first time at which each place of the curve (P,) is reached, as if there were one lap, shape (P,).

        With ``leaving`` it is the last time at which the vehicle is there.
        """
        asked = np.atleast_1d(np.asarray(s, dtype=np.float64))
        which = np.clip(np.searchsorted(self.curve.starts_s, asked, side="right") - 1, 0, len(self.legs) - 1)
        times = self._once_s[which]
        for number in np.unique(which).tolist():
            own = which == number
            law, places = self.legs[number].law, asked[own] - self.curve.starts_s[number]
            times[own] += law.left_at(places) if leaving else law.time_at(places)
        return times

    def lap_at(self, t_s: ArrayLike) -> IntArray:
        """Which lap, from 1, is flown at the times ``t_s`` (P,); 0 before and after the laps; shape (P,)."""
        which, _, begun = self._placed(t_s)
        return np.where(which == self.lap, begun + 1, 0) if self.lap is not None else np.zeros_like(which)

    def ended_after(self, t_s: float) -> Self:
        """The same up to the end of the lap that is flown at ``t_s``; then what comes after the laps.

        Before the first lap that one is still flown. After the last one nothing is changed.
        """
        if self.lap is None:
            return self
        first_s, lap_s = float(self._spans_s[self.lap]), self.legs[self.lap].duration_s
        begun = max(1, math.floor((t_s - first_s) / lap_s) + 1)
        return self if self.laps is not None and self.laps <= begun else replace(self, laps=begun)

    @cached_property
    def _once_s(self) -> FloatArray:
        """When each leg would begin if there were one lap, and the end, shape (len(legs) + 1,)."""
        return np.concatenate(([0.0], np.cumsum([leg.duration_s for leg in self.legs])))

    @cached_property
    def _spans_s(self) -> FloatArray:
        """When each leg is begun for the first time, and the end, shape (len(legs) + 1,)."""
        spans = np.array([leg.duration_s for leg in self.legs])
        if self.lap is not None:
            spans[self.lap] *= math.inf if self.laps is None else self.laps
        return np.concatenate(([0.0], np.cumsum(spans)))

    def _placed(self, t_s: ArrayLike) -> tuple[IntArray, FloatArray, IntArray]:
        """At each time (P,) the leg that is flown, the time since it was begun, and how many laps were flown before."""
        times = np.maximum(np.atleast_1d(np.asarray(t_s, dtype=np.float64)), 0.0)
        which = np.clip(np.searchsorted(self._spans_s, times, side="right") - 1, 0, len(self.legs) - 1)
        own_s = times - self._spans_s[which]
        begun = np.zeros_like(which)
        if self.lap is not None:
            lap_s = self.legs[self.lap].duration_s
            laps = np.where(which == self.lap, np.floor(own_s / lap_s), 0.0).astype(np.int64)
            begun = laps if self.laps is None else np.minimum(laps, self.laps - 1)
            own_s = own_s - begun * lap_s
        return which, own_s, begun

    def to_json(self) -> dict[str, Any]:
        """The trajectory as JSON values; ``from_json`` gives it back bit by bit."""
        return {
            "legs": [{"curve": leg.curve.to_json(), "law": leg.law.to_json()} for leg in self.legs],
            "lap": self.lap,
            "laps": self.laps,
            "altitude_m": self.altitude_m,
        }

    @staticmethod
    def from_json(data: Mapping[str, Any]) -> "Trajectory":
        """The trajectory that ``to_json`` wrote; raises KeyError, TypeError or ValueError where it is not one."""
        return Trajectory(
            tuple(Leg(curve_from_json(leg["curve"]), TimeLaw.from_json(leg["law"])) for leg in data["legs"]),
            float(data["altitude_m"]),
            None if data["lap"] is None else int(data["lap"]),
            None if data["laps"] is None else int(data["laps"]),
        )
