"""A long way without what it says twice: bends that are alike are flown alike, and between bends the speed is even.

Far from its bends a straight part is flown at the largest rate, whatever the bends before and after it are like. So a
way falls apart into windows, from the middle of one such part to the middle of the next, with as much of both as it
takes to slow down and to gain speed again. Where knots and bounds of derivatives of two windows are the same but for
rounding, so is the fastest law. A field of a hundred lanes has a few kinds of turns.
"""

from dataclasses import dataclass
from typing import Final

import numpy as np

from mission.geometry.arrays import FloatArray, IntArray
from mission.steering.grid import Grid, Limits, Slow, grid_of
from mission.steering.joined import Curve
from mission.steering.law import TimeLaw, integrated

_STRAIGHT: Final = 1e-12
_SAME: Final = 1e-9  # rounding
_LEAD: Final = 1.7
"""Times the way on which a speed is gained: how far from its ends a straight part is flown at an even rate."""
_LEAD_CELLS: Final = 16
_LEAST: Final = 0.1  # of a lead, what has to lie between two
_ITERATIONS: Final = 6
_FADES_S: Final = 0.5
_DIGITS: Final = 6  # of what windows are told apart by, relative to the largest value there is


@dataclass(frozen=True, eq=False)
class Excerpt:
    """The windows of a way that differ, one after the other.

    Attributes:
        curve: The curve.
        limits: Those of the vehicle.
        slow: Where it is to be slow.
        windows_s: Shape (W, 2), where each window of the way begins and ends; they do not touch.
        kinds: Shape (W,), which of those that differ each is like, in the order of their first.
        knots_s: Shape (n + 1,), knots of the excerpt, from 0.
    """

    curve: Curve
    limits: Limits
    slow: tuple[Slow, ...]
    windows_s: FloatArray
    kinds: IntArray
    knots_s: FloatArray

    @property
    def _own_s(self) -> tuple[FloatArray, FloatArray]:
        """Where each kind begins in the excerpt, and the end of the last one; and how much later on the curve it is."""
        firsts = self.windows_s[np.unique(self.kinds, return_index=True)[1]]
        joints = np.concatenate(([0.0], np.cumsum(firsts[:, 1] - firsts[:, 0])))
        return joints, firsts[:, 0] - joints[:-1]

    def grid(self, places: FloatArray) -> Grid:
        """The excerpt in cells that begin and end at places (n + 1,), and where one kind goes over into the next."""
        joints, later = self._own_s
        own = _apart(np.union1d(places[(places > 0.0) & (places < joints[-1])], joints), joints)
        kind = np.searchsorted(joints, own[:-1], side="right") - 1
        begins, ends = own[:-1] + later[kind], own[1:] + later[kind]
        knots = np.union1d(begins, ends)
        whole = grid_of(self.curve, (knots[0], knots[-1]), knots - knots[0], self.limits, self.slow)
        cells = np.searchsorted(knots, begins)
        at = np.append(cells, len(knots) - 1)
        bounds = (each[cells] for each in (whole.first, whole.second, whole.third, whole.rates))
        return Grid(own, whole.slopes[at], whole.bends[at], *bounds)

    def whole(self, law: TimeLaw, places: FloatArray) -> tuple[TimeLaw, FloatArray]:
        """The law of the way, and knots (m + 1,), from a law of the excerpt and the knots (n + 1,) of a grid of it."""
        joints, _ = self._own_s
        ends_s = law.time_at(joints)
        ends_s[[0, -1]] = 0.0, law.duration_s
        kinds = []
        for begin, end, *span_s in zip(joints, joints[1:], ends_s, ends_s[1:], strict=False):
            inner = (law.knots_t_s > span_s[0] + _SAME) & (law.knots_t_s < span_s[1] - _SAME)
            times = np.concatenate((span_s[:1], law.knots_t_s[inner], span_s[1:]))
            own, rates, growths = law.jet(times)
            own[[0, -1]] = begin, end
            cells = places[(places >= begin) & (places <= end)]
            kinds.append((np.stack((times - span_s[0], own - begin, rates, growths)), cells - begin))
        parts: list[FloatArray] = []
        knots: list[FloatArray] = []
        now_s = 0.0
        for number, ((begin, _), kind) in enumerate(
            zip(self.windows_s - self.windows_s[0, 0], self.kinds, strict=True)
        ):
            part, within = kinds[kind]
            if number:
                between, lasts_s = _even(parts[-1][1:, -1], np.array([begin, *part[2:, 0]]))
                parts.append(between + np.array([[now_s], [0.0], [0.0], [0.0]]))
                now_s += lasts_s
            parts.append(part + np.array([[now_s], [begin], [0.0], [0.0]]))
            knots.append(begin + within)
            now_s += float(part[0, -1])
        return TimeLaw(*np.concatenate(parts, axis=1)), np.concatenate(knots)


def excerpt_of(curve: Curve, knots: FloatArray, limits: Limits, slow: tuple[Slow, ...]) -> Excerpt:
    """The excerpt of a way from rest to rest that knots of a curve (n + 1,) resolve."""
    grid = grid_of(curve, (float(knots[0]), float(knots[-1])), knots - knots[0], limits, slow)
    straight = grid.second <= _STRAIGHT
    rate = float(grid.rates[straight].max(initial=0.0))
    kept = np.ones(len(knots), dtype=np.bool_)
    ends, leads = [float(knots[0])], []
    for first, last in np.flatnonzero(np.diff(straight, prepend=False, append=False)).reshape(-1, 2).tolist():
        (begin, end), speed_m_s = knots[[first, last]].tolist(), rate * float(grid.first[first])
        gains_s = speed_m_s / limits.acceleration_m_s2 + limits.acceleration_m_s2 / limits.jerk_m_s3
        lead_s = _LEAD * 0.5 * rate * gains_s
        if grid.rates[first:last].min() >= (1.0 - _SAME) * rate and end - begin > (2.0 + _LEAST) * lead_s:
            kept[first + 1 : last] = False
            shares = lead_s * np.arange(1, _LEAD_CELLS + 1) / _LEAD_CELLS
            leads += [begin + shares, end - shares]
            ends += [begin + lead_s, end - lead_s]
    windows = np.append(ends, knots[-1]).reshape(-1, 2)
    fine = np.sort(np.concatenate((knots[kept], *leads)))
    grid = grid_of(curve, (float(fine[0]), float(fine[-1])), fine - fine[0], limits, slow)
    values = np.stack((np.diff(fine), grid.first, grid.second, grid.third, grid.rates), axis=1)
    values /= values.max(axis=0)
    kinds: list[int] = []
    firsts: list[slice] = []
    found: dict[tuple[int | None, bytes], int] = {}
    for number, (first, last) in enumerate(np.searchsorted(fine, windows).tolist()):
        # The way begins and ends at rest, as no other window does.
        at_rest = number if number in {0, len(windows) - 1} else None
        kind = found.setdefault((at_rest, np.round(values[first:last], _DIGITS).tobytes()), len(found))
        if kind == len(firsts):
            firsts.append(slice(first, last))
        kinds.append(kind)
    cells = np.concatenate([np.diff(fine)[each] for each in firsts])
    return Excerpt(curve, limits, slow, windows, np.array(kinds), np.concatenate(([0.0], np.cumsum(cells))))


def _even(before: FloatArray, after: FloatArray) -> tuple[FloatArray, float]:
    """From a place, rate and growth (3,) to others at nearly the same rate: the knots between, (4, 2), and the time.

    What is left of the growths fades first, so that the rate hardly changes.
    """
    (place, rate, growth), (target, last, ends) = before, after
    way = target - place
    lasts_s = 2.0 * way / (rate + last)
    for _ in range(_ITERATIONS):
        fades_s = min(_FADES_S, 0.25 * lasts_s)
        steady = (last - rate - 0.5 * fades_s * (growth + ends)) / (lasts_s - fades_s)
        times = np.array([0.0, fades_s, lasts_s - fades_s, lasts_s])
        growths = np.array([growth, steady, steady, ends])
        rates, passed = integrated(times, growths, rate)
        lasts_s += (way - passed[-1]) / last
    return np.stack((times, place + passed, rates, growths))[:, 1:-1], lasts_s


def _apart(places: FloatArray, joints: FloatArray) -> FloatArray:
    """Places without those that are joints but for rounding; these are among them."""
    nearest = joints[np.clip(np.searchsorted(0.5 * (joints[1:] + joints[:-1]), places), 0, len(joints) - 1)]
    off = np.abs(places - nearest)
    return np.asarray(places[(off == 0.0) | (off > _SAME * joints[-1])])
