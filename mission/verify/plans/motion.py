"""How a curve is flown: its time law s = sigma(t), and the motion r(sigma(t)) that both make.

Between its knots a law is a cubic polynomial of time, and a curve is a polynomial of degree 7 on each of its patches.
So where neither changes, the motion is a polynomial of time, and so are its velocity r' sigma', its acceleration
r'' sigma'^2 + r' sigma'', and its jerk r''' sigma'^3 + 3 r'' sigma' sigma'' + r' sigma'''.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Final

import numpy as np

from mission.geometry.arrays import FloatArray
from mission.geometry.bernstein import Pieces, composed, times, undecided
from mission.verify.plans.patches import Patches

_ROUNDING: Final = 1e-6  # of a limit
_SAME: Final = 1e-9  # of a rate, and of places as a part of the whole
_HALVINGS: Final = 16
_UNITS: Final = ("m/s", "m/s^2", "m/s^3")


class Law:
    """A time law of a plan file; raises KeyError, TypeError or ValueError where it is none.

    Attributes:
        knots_t_s: Shape (K,), its knots in time.
        knots_s: Shape (K,), where they are on the curve.
        duration_s: How long it lasts.
        place_s: Where it ends on the curve.
        ends: The rate and its growth where it begins, and where it ends.
    """

    def __init__(self, data: Mapping[str, Any]) -> None:
        keys = ("knots_t_s", "knots_s", "rates", "growths")
        self.knots_t_s, self.knots_s, self._rates, self._growths = (np.array(data[key], float) for key in keys)
        steps = np.diff(self.knots_t_s)
        if not (
            len(steps) + 1 == len(self.knots_s) == len(self._rates) == len(self._growths) > 1 and (steps >= 0.0).all()
        ):
            raise ValueError("a law has knots in the order of time, with a place, a rate and a growth each")
        self._changes = np.divide(np.diff(self._growths), steps, out=np.zeros_like(steps), where=steps > 0.0)
        self.duration_s, self.place_s = float(self.knots_t_s[-1]), float(self.knots_s[-1])
        self.ends = tuple((float(self._rates[i]), float(self._growths[i])) for i in (0, -1))

    @property
    def fault(self) -> str | None:
        """What is not as in a law: it begins at 0, and its places and rates are those that it leads to."""
        t, rates, (before, after) = self.knots_t_s, self._rates, (self._growths[:-1], self._growths[1:])
        steps = np.diff(t)
        # A quadratic polynomial on 0 <= u <= 1 is nowhere negative where this is not, nor its ends.
        dips = rates[:-1] + 0.5 * steps * before + np.sqrt(np.maximum(rates[:-1] * rates[1:], 0.0))
        led = rates[:-1] + 0.5 * steps * (after + before)
        reached = self.knots_s[:-1] + steps * (rates[:-1] + steps * (2.0 * before + after) / 6.0)
        rows = {
            "it does not begin at 0": np.abs([t[0], self.knots_s[0]]) > 0.0,
            "its growth jumps": (steps == 0.0) & (after != before),
            "it runs backwards": (rates[:-1] < 0.0) | (rates[1:] < 0.0) | (dips < -_SAME * (1.0 + rates.max())),
            "its growths do not lead to its rates": np.abs(rates[1:] - led) > _SAME * (1.0 + rates.max()),
            "its rates do not lead to its places": np.abs(self.knots_s[1:] - reached)
            > _SAME * (1.0 + self.knots_s[-1]),
        }
        return next((f"{what}, at {t[np.argmax(wrong)]:.3f} s" for what, wrong in rows.items() if wrong.any()), None)

    def jet(self, t_s: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray]:
        """Of sigma, value and first three derivatives at times (P,) within the law."""
        piece = np.clip(np.searchsorted(self.knots_t_s, t_s, side="right") - 1, 0, len(self._changes) - 1)
        x, rate, growth, change = (
            t_s - self.knots_t_s[piece],
            *(each[piece] for each in (self._rates, self._growths, self._changes)),
        )
        place = self.knots_s[piece] + x * (rate + x * (growth / 2.0 + x * change / 6.0))
        return place, rate + x * (growth + x * change / 2.0), growth + x * change, change

    def times_s(self, s: FloatArray, *, leaving: bool = False) -> FloatArray:
        """When places on the curve (P,) are reached, or left, shape (P,)."""
        low, high = np.zeros(len(s)), np.full(len(s), self.duration_s)
        for _ in range(60):
            middle = 0.5 * (low + high)
            place = self.jet(middle)[0]
            short = place <= s if leaving else place < s
            low, high = np.where(short, middle, low), np.where(short, high, middle)
        return high

    def rests(self) -> list[tuple[float, float]]:
        """Where on the curve it stands still, if only for a moment, and for how long."""
        lasts = np.diff(self.knots_t_s)
        still = (self._rates[:-1] == 0.0) & (self._rates[1:] == 0.0) & (np.diff(self.knots_s) == 0.0)
        moments = self.knots_s[(self._rates == 0.0) & (self._growths == 0.0)]
        return [
            *zip(self.knots_s[:-1][still].tolist(), lasts[still].tolist(), strict=True),
            *((s, 0.0) for s in moments),
        ]


@dataclass(frozen=True, eq=False)
class Motion(Pieces):
    """K polynomials of time that follow each other.

    Attributes:
        middles: Shape (K,), a parameter of the curve in each.
        place: Control points, shape (K, 22, 2), metres.
        velocity: Of its first derivative, (K, 21, 2).
        acceleration: Of its second, (K, 20, 2).
        jerk: Of its third, (K, 19, 2).
        off: Shape (K, 3), how far these three may be from those of the curve.
    """

    middles: FloatArray
    place: FloatArray
    velocity: FloatArray
    acceleration: FloatArray
    jerk: FloatArray
    off: FloatArray


def steps_of(curve: Patches, law: Law, breaks: FloatArray | None = None) -> tuple[FloatArray, FloatArray]:
    """Times between which neither a law nor its curve changes, (K,) both; cut at some parameters of the curve, too."""
    cuts, knots = np.concatenate((curve.begins_s[1:], [] if breaks is None else breaks)), law.knots_s
    # At a knot but for rounding is at the knot.
    after = np.clip(np.searchsorted(knots, cuts), 1, len(knots) - 1)
    off = np.minimum(np.abs(cuts - knots[after - 1]), np.abs(cuts - knots[after]))
    inner = cuts[(cuts > 0.0) & (cuts < law.place_s) & (off > _SAME * law.place_s)]
    edges = np.unique(np.concatenate((law.knots_t_s, law.times_s(inner))))
    return edges[:-1], edges[1:]


def motion_of(curve: Patches, law: Law, breaks: FloatArray | None = None) -> Motion:
    """The motion along a curve by its law; cut at some parameters of the curve, too."""
    begins, ends = steps_of(curve, law, breaks)
    lasts = ends - begins
    middles, _, _, change = law.jet(0.5 * (begins + ends))
    (s0, r0, g0, _), (s1, r1, g1, _) = law.jet(begins), law.jet(ends)
    on = curve.taken(curve.at_index(middles))
    s = np.stack((s0, s0 + lasts * r0 / 3.0, s1 - lasts * r1 / 3.0, s1), axis=1)
    u = ((s - on.begins_s[:, None]) / (on.ends_s - on.begins_s)[:, None])[..., None]
    rate, growth = np.stack((r0, r0 + 0.5 * lasts * g0, r1), axis=1)[..., None], np.stack((g0, g1), axis=1)[..., None]
    first, second, third = (composed(on.derivative(order), u) for order in (1, 2, 3))
    square = times(rate, rate)
    most, grown = np.abs(rate[..., 0]).max(axis=1), np.abs(growth[..., 0]).max(axis=1)
    _, one, two, three = on.off.T
    off = (
        one * most,
        two * most**2 + one * grown,
        three * most**3 + 3.0 * two * most * grown + one * np.abs(change),
    )
    velocity = times(first, rate)
    led = np.cumsum(velocity, axis=1) * (lasts / velocity.shape[1])[:, None, None]
    return Motion(
        begins,
        ends,
        middles,
        place=curve.at(s0)[:, None] + np.concatenate((np.zeros((len(lasts), 1, 2)), led), axis=1),
        velocity=velocity,
        acceleration=times(second, square) + times(first, growth),
        jerk=times(third, times(square, rate))
        + 3.0 * times(second, times(rate, growth))
        + first * change[:, None, None],
        off=np.stack(off, axis=1),
    )


def excess(motion: Motion, limits: Sequence[float]) -> str | None:
    """Where a limit of speed, acceleration or jerk may be exceeded; None where none is."""
    asked = np.array(limits)
    allowed = asked * (1.0 + _ROUNDING) + _ROUNDING

    def bounds(some: Motion) -> FloatArray:
        of = (some.velocity, some.acceleration, some.jerk)
        return np.stack([np.hypot(*control.T).max(axis=0, initial=0.0) for control in of], axis=1) + some.off

    left = undecided(motion, lambda some: np.asarray((bounds(some) > allowed).any(axis=1)), _HALVINGS)
    if not len(left):
        return None
    shares = bounds(left) / asked
    worst, limit = np.unravel_index(np.argmax(shares), shares.shape)
    most, at = f"{bounds(left)[worst, limit]:.6g} {_UNITS[limit]}", f"{left.begins_s[worst]:.2f} s"
    return f"there may be {most} at {at}, and the limit is {float(asked[limit]):g}"
