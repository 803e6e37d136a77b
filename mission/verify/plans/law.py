"""Whether a time law flies its curve within the limits, by bounds for whole intervals of time.

A law is the average over a window h of one whose rate is linear between knots: sigma(t) is the integral of that law's
place over the window, by h. Between two of the times t_i and t_i + h, sigma'' is linear and sigma' quadratic, so they
lie between their values at the ends and the control points of these. What the curve does meanwhile, its patches say.
"""

from collections.abc import Mapping
from typing import Any, Final, NamedTuple

import numpy as np

from mission.geometry.arrays import FloatArray
from mission.verify.plans.patches import Patches

_ROUNDING: Final = 1e-6  # of a limit, of a rate, and of places as a part of the whole
_HALVINGS: Final = 16
_MOST_INTERVALS: Final = 1 << 17


class Rest(NamedTuple):
    """A place on the curve at which the vehicle stands still, and for how long."""

    s: float
    seconds: float


class Law:
    """A time law of a plan file; raises KeyError, TypeError or ValueError where it is none."""

    def __init__(self, data: Mapping[str, Any]) -> None:
        self._t, self._s, self._rates = (np.array(data[key], float) for key in ("knots_t_s", "knots_s", "rates"))
        self._window = float(data["window_s"])
        steps = np.diff(self._t)
        if not (len(self._t) == len(self._s) == len(self._rates) > 1 and self._window > 0.0 and (steps >= 0.0).all()):
            raise ValueError("a law has knots in the order of time, with a place and a rate each, and a window")
        self.duration_s = float(self._t[-1]) + self._window
        mean = steps * (self._s[:-1] + steps * (2.0 * self._rates[:-1] + self._rates[1:]) / 6.0)
        self._integral = np.concatenate(([0.0], np.cumsum(mean)))

    @property
    def fault(self) -> str | None:
        """What is not as in a law: it begins and ends at rest, and its places are those that its rates lead to."""
        led = 0.5 * np.diff(self._t) * (self._rates[1:] + self._rates[:-1])
        off = np.abs(np.diff(self._s) - led)
        if self._t[0] != 0.0 or self._s[0] != 0.0 or self._rates[0] != 0.0 or self._rates[-1] != 0.0:
            return "it does not begin at 0 and end at rest"
        if (np.diff(self._rates)[np.diff(self._t) == 0.0] != 0.0).any():
            return "its rate jumps"
        if (self._rates < 0.0).any():
            return f"it runs backwards at {self._t[np.argmin(self._rates)]:.3f} s"
        if off.max() > _ROUNDING * 1e-3 * (1.0 + self._s[-1]):
            return f"its rates do not lead to its places at {self._t[np.argmax(off)]:.3f} s"
        return None

    @property
    def place_s(self) -> float:
        """Where it ends on the curve."""
        return float(self._s[-1])

    def jet(self, t_s: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
        """sigma, sigma' and sigma'' at times (P,) within the law; where sigma'' jumps, that from the right."""
        late, early = self._unaveraged(t_s), self._unaveraged(t_s - self._window)
        place, rate, growth = ((a - b) / self._window for a, b in zip(late, early, strict=True))
        return place, rate, growth

    def rests(self) -> list[Rest]:
        """Where it stands still, if only for a moment."""
        still = np.flatnonzero((self._rates[:-1] == 0.0) & (self._rates[1:] == 0.0) & (np.diff(self._t) > 0.0))
        held = [Rest(float(self._s[i]), float(np.diff(self._t)[i]) - self._window) for i in still.tolist()]
        ends = [Rest(s, 0.0) for s in (0.0, self.place_s)]
        return [*(rest for rest in held if rest.seconds >= -_ROUNDING), *ends]

    def excess(self, patches: Patches, speed_m_s: float, acceleration_m_s2: float) -> str | None:
        """Where a limit may be exceeded on the curve; None where none is."""
        breaks = np.unique(np.concatenate((self._t, self._t + self._window)))
        breaks = breaks[np.concatenate(([True], np.diff(breaks) > 1e-9 * self.duration_s))]
        limits = np.array([speed_m_s, acceleration_m_s2])
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
        most, unit = f"{bounds[limit, worst]:.6g}", ("m/s", "m/s^2")[limit]
        return f"there may be {most} {unit} at {breaks[worst]:.2f} s, and the limit is {limits[limit]:g}"

    def _bounds(self, patches: Patches, breaks: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Upper bounds of speed and acceleration between times, shape (2, K), and what they are where these begin."""
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
        edges, first, second, off = patches.derivatives(places)
        begin = np.clip(np.searchsorted(edges, places[:-1], side="right") - 1, 0, len(first) - 1)
        end = np.maximum(np.searchsorted(edges, places[1:], side="left"), begin + 1)
        sides = np.stack((begin, end), axis=1).ravel()

        def over(values: FloatArray) -> FloatArray:
            """The largest of the pieces of each interval."""
            padded = np.concatenate((values, values[-1:]))
            return np.asarray(np.maximum.reduceat(padded, sides, axis=0)[::2])

        steep, bend = (
            over(np.linalg.norm(c, axis=2).max(axis=1) + o) for c, o in ((first, off[:, 1]), (second, off[:, 2]))
        )
        by_length = bend * high**2 + steep * np.abs(ends).max(axis=0)
        # Each component of r'' sigma'^2 + r' sigma'' lies between sums of products of ends.
        by_sides = []
        for sign in (1.0, -1.0):
            most = [over((sign * c).max(axis=1) + o[:, None]) for c, o in ((first, off[:, 1]), (second, off[:, 2]))]
            least = [-over((-sign * c).max(axis=1) + o[:, None]) for c, o in ((first, off[:, 1]), (second, off[:, 2]))]
            grown = np.max([side * end[:, None] for side in (most[0], least[0]) for end in ends], axis=0)
            turned = np.max([most[1] * square[:, None] for square in (low**2, high**2)], axis=0)
            by_sides.append(grown + turned)
        sides_of = np.maximum(*by_sides)
        bounds = np.stack((steep * high, np.minimum(by_length, np.hypot(*np.maximum(sides_of, 0.0).T))))
        way, turn, pace, growing = first[begin, 0], second[begin, 0], control[0][:, None], ends[0][:, None]
        return bounds, np.hypot(*np.stack((way * pace, turn * pace**2 + way * growing)).transpose(2, 0, 1))

    def _unaveraged(self, t_s: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Integral of the place, place and rate of the law before averaging; at rest outside of its span."""
        piece = np.clip(np.searchsorted(self._t, t_s, side="right") - 1, 0, len(self._t) - 2)
        steps, gains = np.diff(self._t)[piece], np.diff(self._rates)[piece]
        x, s, rate = np.clip(t_s - self._t[piece], 0.0, steps), self._s[piece], self._rates[piece]
        growth = np.divide(gains, steps, out=np.zeros_like(gains), where=steps > 0.0)
        beyond = np.maximum(t_s - self._t[-1], 0.0)
        integral = self._integral[piece] + x * (s + x * (rate / 2.0 + x * growth / 6.0)) + self._s[-1] * beyond
        moves = (t_s > 0.0) & (t_s < self._t[-1])
        return integral, s + x * (rate + x * growth / 2.0), np.where(moves, rate + x * growth, 0.0)
