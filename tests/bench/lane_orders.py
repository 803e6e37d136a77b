"""The least that a flight takes that covers by whole lanes: brute force over their orders, without the planner.

Such a flight goes from rest through points, or through sets of lanes, one after the other, and sees what is in the way.
Of the lanes' order and of the sides on which they begin all are tried (Held and Karp, "A dynamic programming approach
to sequencing problems", 1962). A lane is flown from end to end, straight, at whatever speed. Ways are counted as the
longer of the shortest way at full speed and what ``least_turns`` proves without obstacles.

That takes long: ways are counted without turns first, and with them only on the best flight, roughly and then finely,
until all of it is known.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import lru_cache
from itertools import pairwise, product

import numpy as np

from tests.bench.least_turns import INTERVALS, NARROW_S, End, Pace, Way, least_s
from tests.bench.shortest_visits import Floats, Ground
from tests.bench.whole_lanes import Visit, choices

_LONGEST_WINDOW_S = 3.0  # on the lane before a turn, and after it; more of it changes nothing
_FARTHEST_M = 24.0  # from a rest, for what it costs: full speed is reached before
_GRID_M = 0.05
_DIGITS = 6  # of angles
_FINENESS = ((8, 0.12), (INTERVALS, NARROW_S))
"""Intervals, and how narrow that of the duration is, with which a way is counted at the first look, at the second."""


@dataclass(frozen=True, eq=False)
class Places:
    """Where a visit begins and ends: at one of some points, or at the ends of lanes, which are flown in any order.

    Attributes:
        at_m: Shape (k, 2); ends 2 i and 2 i + 1 are those of lane i.
        halves_m: Shape (k,), half of the lane that ends there; none for points.
        outwards_rad: Shape (k,), the heading in which it is left there.
        rests: Whether the vehicle comes to rest.
        stays_s: How long.
    """

    at_m: Floats
    halves_m: Floats
    outwards_rad: Floats
    rests: bool = False
    stays_s: float = 0.0

    @staticmethod
    def points(at_m: Floats, *, rests: bool, stays_s: float = 0.0) -> "Places":
        return Places(at_m, np.zeros(len(at_m)), np.zeros(len(at_m)), rests, stays_s)

    @staticmethod
    def lanes(lanes_m: Floats) -> "Places":
        steps = (lanes_m[:, 1] - lanes_m[:, 0]).repeat(2, axis=0) * np.tile([[-1.0], [1.0]], (len(lanes_m), 1))
        return Places(lanes_m.reshape(-1, 2), 0.5 * np.hypot(*steps.T), np.arctan2(steps[:, 1], steps[:, 0]))

    @property
    def are_lanes(self) -> bool:
        return bool(self.halves_m.any())

    def end(self, place: int, pace: Pace, turn_rad: float) -> End:
        """How ways begin or end there, when the lane's heading is turned."""
        if not self.are_lanes:
            return End(rests=self.rests)
        window_s = min(_LONGEST_WINDOW_S, math.floor(self.halves_m[place] / pace.speed_m_s))
        return End(math.remainder(self.outwards_rad[place] + turn_rad, math.tau), window_s)


@lru_cache
def _rests_s(pace: Pace) -> Floats:
    """What is lost by a rest when the vehicle flies straight on for so many metres, from none on."""
    ways = (Way(End(rests=True), End(), (d, d, 0.0, 0.0), pace) for d in np.arange(1.0, _FARTHEST_M + 1.0))
    times = np.array([0.0, *(way.least_s() for way in ways)])
    return np.asarray(np.maximum.accumulate(times - np.arange(len(times)) / pace.speed_m_s))


class Ways:
    """Ways from places to places: what they take at least, without turns until that is asked for.

    Attributes:
        times_s: Shape (k, l); with what is lost on lanes by slowing down in turns.
    """

    def __init__(self, ground: Ground, before: Places, after: Places, pace: Pace) -> None:
        self._before, self._after, self._pace = before, after, pace
        lengths = ground.between(before.at_m, after.at_m)
        self.times_s, self._known = lengths / pace.speed_m_s, np.zeros(lengths.shape, dtype=np.int64)
        if pace.limited:
            # Between two rests half of the way is each one's.
            shared = lengths * (0.5 if before.rests and after.rests else 1.0)
            for one, free in ((before, shared + after.halves_m), (after, shared + before.halves_m[:, None])):
                if one.rests:
                    self.times_s += _rests_s(pace)[np.minimum(free, _FARTHEST_M).astype(np.int64)]

    def learned(self, begin: int, end: int) -> bool:
        """Count a way with its turns, roughly and then finely; whether that was still to be done."""
        before, after, pace = self._before, self._after, self._pace
        level = int(self._known[begin, end])
        if level == len(_FINENESS) or not (pace.limited and (before.are_lanes or after.are_lanes)):
            return False
        begins = [begin] if before.are_lanes else [*range(len(before.at_m))]
        ends = [end] if after.are_lanes else [*range(len(after.at_m))]
        # As if the lane that is left, or else the one that is begun, led east.
        turn = -before.outwards_rad[begin] if before.are_lanes else math.pi - after.outwards_rad[end]
        leave, arrive = before.end(begin, pace, turn), after.end(end, pace, turn + math.pi)
        apart = (after.at_m[ends] - before.at_m[begins][:, None]).reshape(-1, 2)
        x, y = apart @ np.array([math.cos(turn), -math.sin(turn)]), apart @ np.array([math.sin(turn), math.cos(turn)])
        leave, arrive = (replace(each, angle_rad=round(each.angle_rad, _DIGITS)) for each in (leave, arrive))
        if y.mean() < 0.0:
            y, arrive = -y, replace(arrive, angle_rad=-arrive.angle_rad)
        left, right, low, high = (
            _GRID_M * whole(value / _GRID_M)
            for each in (x, y)
            for whole, value in ((math.floor, each.min()), (math.ceil, each.max()))
        )
        least = least_s(Way(leave, arrive, (left, right, low, high), pace, *_FINENESS[level]))
        chosen = np.ix_(begins, ends)
        self.times_s[chosen] = np.maximum(self.times_s[chosen], least)
        self._known[chosen] = level + 1
        return True


def through(lanes_s: Floats, ways: Floats, reached: Floats) -> Floats:
    """What it takes at least to have flown some lanes and be at an end of one of them, shape (2^n, 2 n).

    Args:
        lanes_s: Shape (n,), what each lane takes.
        ways: Shape (2 n, 2 n), from where a lane is left to where another is begun.
        reached: Shape (2 n,), what it takes to be where the first lane is begun.
    """
    count = len(lanes_s)
    lane, other = np.arange(2 * count) // 2, np.arange(2 * count) ^ 1
    best = np.full((1 << count, 2 * count), np.inf)
    best[1 << lane, other] = reached + lanes_s[lane]
    sets = np.arange(1 << count)
    sizes = (sets[:, None] >> np.arange(count) & 1).sum(axis=1)
    for size in range(1, count):
        done = sets[sizes == size]
        costs = (best[done][:, :, None] + ways).min(axis=1) + lanes_s[lane]
        for end in range(2 * count):
            without = (done >> lane[end]) & 1 == 0
            best[done[without] | 1 << lane[end], other[end]] = costs[without, end]
    return best


def ends_before(best: Floats, ways: Floats, last: int) -> list[int]:
    """Where lanes are left, in order, on the flight that leaves the last one there.

    Args:
        best: Of ``through``.
        ways: As there.
        last: The end.
    """
    done, left = len(best) - 1, [last]
    while done != 1 << left[-1] // 2:
        done ^= 1 << left[-1] // 2
        left.append(int((best[done] + ways[:, left[-1] ^ 1]).argmin()))
    return left[::-1]


@dataclass(frozen=True)
class Least:
    """What a flight takes at least, and the one that would take that.

    Attributes:
        cost: Seconds; metres where paces have no limits.
        lanes_m: For each visit that covers its lanes, shape (n, 2, 2), in the order flown.
        between: What ways between lanes of one visit take, with their turns.
    """

    cost: float
    lanes_m: tuple[Floats, ...]
    between: float


class _Stage:
    """One set of places, and the flights through it."""

    def __init__(self, places: Places, ground: Ground, pace: Pace) -> None:
        self.places, self._pace = places, pace
        self.inner = Ways(ground, places, places, pace) if places.are_lanes else None
        self._made: tuple[bytes, Floats] | None = None

    def left(self, reached: Floats) -> Floats:
        """When each place is left at the earliest; shape (k,)."""
        return reached + self.places.stays_s if self.inner is None else self._table(reached)[-1]

    def ends(self, reached: Floats, last: int) -> list[int]:
        """Where lanes are left, or just the place."""
        return [last] if self.inner is None else ends_before(self._table(reached), self.inner.times_s, last)

    def _table(self, reached: Floats) -> Floats:
        assert self.inner is not None
        told = reached.tobytes() + self.inner.times_s.tobytes()
        if self._made is None or self._made[0] != told:
            lanes_s = 2.0 * self.places.halves_m[::2] / self._pace.speed_m_s
            self._made = told, through(lanes_s, self.inner.times_s, reached)
        return self._made[1]


def in_lanes(ground: Ground, start_m: Floats, visits: Sequence[Visit], pace: Pace) -> Least:
    """What a flight from rest through visits, in this order, to rest takes at least."""
    layers = [[_Stage(Places.points(start_m[None], rests=True), ground, pace)]]
    for number, visit in enumerate(visits):
        sets = [Places.lanes(lanes_m) for lanes_m in choices(visit)] if visit.parts else []
        rests = visit.rest_s > 0.0 or number == len(visits) - 1
        sets = sets or [Places.points(visit.points_m, rests=rests, stays_s=visit.rest_s if pace.limited else 0.0)]
        layers.append([_Stage(places, ground, pace) for places in sets])
    links = {
        (one, other): Ways(ground, one.places, other.places, pace)
        for before, after in pairwise(layers)
        for one, other in product(before, after)
    }
    while True:
        reached = {layers[0][0]: np.zeros(1)}
        for before, after in pairwise(layers):
            for other in after:
                times = [(one.left(reached[one])[:, None] + links[one, other].times_s).min(axis=0) for one in before]
                reached[other] = np.min(times, axis=0)
        least, fresh = _flown(layers, links, reached)
        if not fresh:
            return least


def _flown(
    layers: list[list[_Stage]], links: dict[tuple[_Stage, _Stage], Ways], reached: dict[_Stage, Floats]
) -> tuple[Least, bool]:
    """The best flight, of which every way is learned; and whether one was not known yet."""
    stage = min(layers[-1], key=lambda each: each.left(reached[each]).min())
    place = int(stage.left(reached[stage]).argmin())
    cost, fresh = float(stage.left(reached[stage]).min()), False
    lanes, between = [], 0.0
    for layer in (*reversed(layers[:-1]), None):
        ends = stage.ends(reached[stage], place)
        first = ends[0]
        if stage.inner is not None:
            first = ends[0] ^ 1
            lanes.append(stage.places.at_m[np.array([[end ^ 1, end] for end in ends])])
            for end, other in reversed([*pairwise(ends)]):
                between += float(stage.inner.times_s[end, other ^ 1])
                fresh |= stage.inner.learned(end, other ^ 1)
        if layer is None:
            break
        times = [one.left(reached[one]) + links[one, stage].times_s[:, first] for one in layer]
        which = int(np.argmin([each.min() for each in times]))
        place = int(times[which].argmin())
        fresh |= links[layer[which], stage].learned(place, first)
        stage = layer[which]
    return Least(cost, tuple(lanes[::-1]), between), fresh
