"""Whether a time law flies its curve within the limits, by bounds for whole intervals of time.

Between its knots sigma'' is linear and sigma' quadratic, so they lie between their values at the ends and the control
points of these. What the curve does meanwhile, its patches say.
"""

from collections.abc import Callable, Mapping
from typing import Any, Final, NamedTuple

import numpy as np

from mission.geometry.arrays import FloatArray
from mission.verify.plans.patches import Patches

_ROUNDING: Final = 1e-6  # of a limit
_SAME: Final = 1e-9  # of a rate, and of places as a part of the whole
_HALVINGS: Final = 16
_MOST_INTERVALS: Final = 1 << 17


class Rest(NamedTuple):
    """A place on the curve at which the vehicle stands still, and for how long."""

    s: float
    seconds: float


class Law:
    """A time law of a plan file; raises KeyError, TypeError or ValueError where it is none."""

    def __init__(self, data: Mapping[str, Any]) -> None:
        keys = ("knots_t_s", "knots_s", "rates", "growths")
        self._t, self._s, self._rates, self._growths = (np.array(data[key], float) for key in keys)
        steps = np.diff(self._t)
        if not (len(self._t) == len(self._s) == len(self._rates) == len(self._growths) > 1 and (steps >= 0.0).all()):
            raise ValueError("a law has knots in the order of time, with a place, a rate and a growth each")
        self._changes = np.divide(np.diff(self._growths), steps, out=np.zeros_like(steps), where=steps > 0.0)
        self.duration_s = float(self._t[-1])

    @property
    def fault(self) -> str | None:
        """What is not as in a law: it begins at 0, and its places and rates are those that it leads to."""
        steps = np.diff(self._t)
        led = self._rates[:-1] + 0.5 * steps * (self._growths[1:] + self._growths[:-1])
        reached = self._s[:-1] + steps * (
            self._rates[:-1] + steps * (2.0 * self._growths[:-1] + self._growths[1:]) / 6.0
        )
        off_s, off = np.abs(self._s[1:] - reached), np.abs(self._rates[1:] - led)
        if self._t[0] != 0.0 or self._s[0] != 0.0:
            return "it does not begin at 0"
        if (np.diff(self._growths)[steps == 0.0] != 0.0).any():
            return "its growth jumps"
        if (self._rates < 0.0).any():
            return f"it runs backwards at {self._t[np.argmin(self._rates)]:.3f} s"
        if off.max() > _SAME * (1.0 + self._rates.max()):
            return f"its growths do not lead to its rates at {self._t[np.argmax(off)]:.3f} s"
        if off_s.max() > _SAME * (1.0 + self._s[-1]):
            return f"its rates do not lead to its places at {self._t[np.argmax(off_s)]:.3f} s"
        return None

    @property
    def ends(self) -> tuple[tuple[float, float], tuple[float, float]]:
        """The rate and its growth where it begins, and where it ends."""
        first, last = ((float(self._rates[i]), float(self._growths[i])) for i in (0, -1))
        return first, last

    @property
    def place_s(self) -> float:
        """Where it ends on the curve."""
        return float(self._s[-1])

    def jet(self, t_s: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Of sigma, value and first two derivatives at times (P,) within the law."""
        piece = np.clip(np.searchsorted(self._t, t_s, side="right") - 1, 0, len(self._t) - 2)
        x, rate, growth, change = t_s - self._t[piece], self._rates[piece], self._growths[piece], self._changes[piece]
        place = self._s[piece] + x * (rate + x * (growth / 2.0 + x * change / 6.0))
        return place, rate + x * (growth + x * change / 2.0), growth + x * change

    def _times(self, s: FloatArray) -> FloatArray:
        """When places on the curve (P,) are reached, shape (P,)."""
        low, high = np.zeros(len(s)), np.full(len(s), self.duration_s)
        for _ in range(60):
            middle = 0.5 * (low + high)
            short = self.jet(middle)[0] < s
            low, high = np.where(short, middle, low), np.where(short, high, middle)
        return high

    def rests(self) -> list[Rest]:
        """Where it stands still, if only for a moment."""
        still = (self._rates[:-1] == 0.0) & (self._rates[1:] == 0.0) & (np.diff(self._s) == 0.0)
        held = [Rest(float(self._s[i]), float(np.diff(self._t)[i])) for i in np.flatnonzero(still).tolist()]
        moments = self._s[(self._rates == 0.0) & (self._growths == 0.0)]
        return [*held, *(Rest(s, 0.0) for s in moments.tolist())]

    def excess(
        self,
        patches: Patches,
        speed_m_s: float,
        acceleration_m_s2: float = np.inf,
        jerk_m_s3: float = np.inf,
        *,
        on_s: tuple[float, float] | None = None,
    ) -> str | None:
        """Where a limit may be exceeded on the curve, or on a stretch of it; None where none is."""
        breaks = np.unique(self._t)
        if on_s is not None:
            begin, end = self._times(np.array(on_s)).tolist()
            breaks = np.unique([begin, *breaks[(breaks > begin) & (breaks < end)], end])
        if len(breaks) < 2:  # noqa: PLR2004 - no time passes
            return None
        limits = np.array([speed_m_s, acceleration_m_s2, jerk_m_s3])
        for _ in range(_HALVINGS):
            bounds, surely = self._bounds(patches, breaks)
            over = (bounds > limits[:, None] * (1.0 + _ROUNDING) + _ROUNDING).any(axis=0)
            if not over.any():
                return None
            if (surely > limits[:, None] * (1.0 + _ROUNDING) + _ROUNDING).any():
                bounds = surely
                break
            if len(breaks) > _MOST_INTERVALS:
                break
            breaks = np.union1d(breaks, 0.5 * (breaks[1:] + breaks[:-1])[over])
        limit, worst = np.unravel_index(np.argmax(bounds / limits[:, None]), bounds.shape)
        most, unit = f"{bounds[limit, worst]:.6g}", ("m/s", "m/s^2", "m/s^3")[limit]
        return f"there may be {most} {unit} at {breaks[worst]:.2f} s, and the limit is {limits[limit]:g}"

    def _bounds(self, patches: Patches, breaks: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Upper bounds of speed, acceleration and jerk between times, (3, K), and what they are where these begin."""
        widths, middles = np.diff(breaks), 0.5 * (breaks[1:] + breaks[:-1])
        inner = middles + np.multiply.outer([-0.25, 0.0, 0.25], widths)
        _, rates, growths = (each.reshape(3, -1) for each in self.jet(inner.ravel()))
        # sigma'' = growth + change x and sigma' = rate + growth x + change x^2 / 2, at most half a width either way.
        half, rate, growth = 0.5 * widths, rates[1], growths[1]
        change = (growths[2] - growths[0]) / half
        ends = np.stack((growth - change * half, growth + change * half))
        bent = 0.5 * change * half**2
        control = np.stack((rate - growth * half + bent, rate - bent, rate + growth * half + bent))
        low, high = np.maximum(control.min(axis=0), 0.0), control.max(axis=0)
        places = np.maximum.accumulate(np.clip(self.jet(breaks)[0], patches.begins_s[0], patches.ends_s[-1]))
        edges, first, second, third, off = patches.derivatives(places)
        begin = np.clip(np.searchsorted(edges, places[:-1], side="right") - 1, 0, len(first) - 1)
        end = np.maximum(np.searchsorted(edges, places[1:], side="left"), begin + 1)
        sides = np.stack((begin, end), axis=1).ravel()

        def over(values: FloatArray) -> FloatArray:
            """The largest of the pieces of each interval."""
            padded = np.concatenate((values, values[-1:]))
            return np.asarray(np.maximum.reduceat(padded, sides, axis=0)[::2])

        steep, bend, twist = (
            over(np.linalg.norm(c, axis=2).max(axis=1) + off[:, order])
            for order, c in enumerate((first, second, third), start=1)
        )
        by_length = bend * high**2 + steep * np.abs(ends).max(axis=0)
        # Each component of r'' sigma'^2 + r' sigma'' lies between sums of products of ends.
        by_sides = []
        for sign in (1.0, -1.0):
            sloped, bent_by = _between(sign * first, off[:, 1], over), _between(sign * second, off[:, 2], over)
            grown = np.max([side * end[:, None] for side in sloped for end in ends], axis=0)
            turned = np.max([bent_by[0] * square[:, None] for square in (low**2, high**2)], axis=0)
            by_sides.append(grown + turned)
        sides_of = np.maximum(*by_sides)
        # Likewise what bends and changes of the rate make of the jerk; the rest is the curve's third derivative.
        turning = np.array([rate * end for rate in (low, high) for end in ends])
        changed = self._changes[np.clip(np.searchsorted(self._t, middles, side="right") - 1, 0, len(self._changes) - 1)]
        shaken = []
        for sign in (1.0, -1.0):
            most, least = _between(sign * first, off[:, 1], over)
            pulled, pushed = _between(sign * second, off[:, 2], over)
            twisted = np.max([3.0 * side * each[:, None] for side in (pulled, pushed) for each in turning], axis=0)
            shaken.append(twisted + np.where(changed[:, None] > 0.0, most, least) * changed[:, None])
        jerks = np.hypot(*np.maximum(np.maximum(*shaken), 0.0).T) + twist * high**3
        by_parts = twist * high**3 + 3.0 * bend * np.abs(turning).max(axis=0) + steep * np.abs(changed)
        by_sides = np.minimum(by_length, np.hypot(*np.maximum(sides_of, 0.0).T))
        bounds = np.stack((steep * high, by_sides, np.minimum(jerks, by_parts)))
        way, turn, pace, growing = first[begin, 0], second[begin, 0], control[0][:, None], ends[0][:, None]
        shake = third[begin, 0] * pace**3 + 3.0 * turn * pace * growing + way * changed[:, None]
        surely = np.stack((way * pace, turn * pace**2 + way * growing, shake))
        return bounds, np.hypot(*surely.transpose(2, 0, 1))


def _between(
    control: FloatArray, off: FloatArray, over: Callable[[FloatArray], FloatArray]
) -> tuple[FloatArray, FloatArray]:
    """Upper and lower bounds of each component of what has these control points, over the pieces of each interval."""
    return over(control.max(axis=1) + off[:, None]), -over((-control).max(axis=1) + off[:, None])
