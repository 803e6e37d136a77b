"""The least that covering by whole, parallel lanes takes: brute force over headings and rows, without the planner.

The flights that this bounds cover each part of a region by straight lanes of one heading, which lead from one side of
the part to the other, so far as the tube stays inside; they fly from start to home, and see what is in the way. Rows
are as few as leave no more of the part than the mission lets be left, each covering half a spacing to either side.
Headings are tried every few degrees and rows in steps, and of each number of lanes the shortest few: beyond that
nothing is proved, and a plan that mixes headings, or leaves pieces of rows out, may be shorter. Of the lanes' order and
of the sides on which they begin all are tried (Held and Karp, "A dynamic programming approach to sequencing problems",
1962).

Time counts speed and acceleration alone, no jerk. Who flies a lane and then one beside it the other way round needs
``turn_back_s``, or the way at full speed if that is longer.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
import shapely
import shapely.affinity

from tests.bench.shortest_visits import Floats, Ground

_HEADINGS_DEG = np.arange(0.0, 180.0, 2.0)
_PITCHES = np.linspace(0.8, 1.04, 9)  # of the spacing
_SHIFTS = 8
_SLICES = 400  # into which a part is cut to measure what rows cover
_SHORTEST = 0.05  # of the spacing: shorter cuts are no lanes
_PARALLEL = 0.999
_MOST_ROWS = 2  # numbers of rows from the fewest on that are tried
_MOST_LANES = 12  # of which all orders are tried
_KEPT = 2  # the shortest of each number of lanes, that are flown in all orders


def turn_back_s(aside_m: Floats, speed_m_s: float, acceleration_m_s2: float) -> Floats:
    """What turning back onto a lane beside takes at least, beyond both lanes at full speed, shape (...).

    Let u be the speed where one lane ends, and where the other begins: time reversal and mirroring make one turn of two
    different speeds, or of ends that do not lie side by side, another of equal duration, and the mean of both
    accelerations has u for the mean of the speeds. The least time T from (u, 0) to (-u, 0) that leads aside by w has
    the acceleration a (-1, k t) / sqrt(1 + k^2 t^2), t from -T/2 to T/2 (Pontryagin), whence, with z = k T / 2,

        u^2 = w a asinh(z)^2 / (z sqrt(1 + z^2) - asinh(z)),  T = 2 z u / (a asinh(z)),

    and slowing down from the full speed v to u, and up again, costs (v - u)^2 / (a v).
    """
    z = np.geomspace(1e-3, 1e6, 4000)
    arc = np.arcsinh(z)
    aside = np.asarray(aside_m)[..., None]
    u = np.sqrt(aside * acceleration_m_s2 * arc**2 / (z * np.sqrt(1.0 + z**2) - arc))
    lasts = 2.0 * z * u / (acceleration_m_s2 * arc)
    lost = np.maximum(speed_m_s - u, 0.0) ** 2 / (acceleration_m_s2 * speed_m_s)
    return np.asarray((lasts + np.where(u <= speed_m_s, lost, np.inf)).min(axis=-1))


@dataclass(frozen=True, eq=False)
class Rows:
    """Lanes of one heading over one part, shape (n, 2, 2)."""

    lanes_m: Floats

    @cached_property
    def length_m(self) -> float:
        return _length_m(self.lanes_m)


def rows_of(part: shapely.Polygon, spacing_m: float, tube_m: float, share: float) -> Iterator[Rows]:
    """Lanes that cover a part, the shortest of each heading and number; in no order."""
    for heading in _HEADINGS_DEG.tolist():
        turned = shapely.affinity.rotate(part, heading, origin=(0.0, 0.0))
        inside = shapely.buffer(turned, -tube_m)
        left, low, right, high = turned.bounds
        edges = np.linspace(low, high, _SLICES + 1)
        slices = shapely.area(shapely.intersection(turned, shapely.box(left, edges[:-1], right, edges[1:])))
        middles = 0.5 * (edges[1:] + edges[:-1])
        found = 0
        for count in range(1, int(np.ceil((high - low) / spacing_m)) + 2):
            tried = []
            for pitch_m in _PITCHES * spacing_m if count > 1 else (spacing_m,):
                slack_m = high - low - (count - 1) * pitch_m
                for first in low + np.linspace(0.0, 1.0, _SHIFTS + 1) * slack_m if slack_m >= 0.0 else ():
                    heights = first + pitch_m * np.arange(count)
                    near = np.abs(middles[:, None] - heights).min(axis=1) <= 0.5 * spacing_m
                    if slices[near].sum() >= share * part.area:  # else no lanes there would do
                        tried.append(_cut(inside, heights, _SHORTEST * spacing_m))
            for lanes_m in sorted(tried, key=_length_m):
                swath = shapely.buffer(shapely.multilinestrings([*lanes_m]), 0.5 * spacing_m) if len(lanes_m) else None
                if swath is not None and shapely.intersection(turned, swath).area >= share * part.area:
                    turn = np.radians(-heading)
                    rotation = np.array([[np.cos(turn), -np.sin(turn)], [np.sin(turn), np.cos(turn)]])
                    found += 1
                    yield Rows(lanes_m @ rotation.T)
                    break
            if found == _MOST_ROWS:
                break


def _length_m(lanes_m: Floats) -> float:
    return float(np.linalg.norm(lanes_m[:, 1] - lanes_m[:, 0], axis=1).sum())


def _cut(inside: shapely.Geometry, heights: Floats, shortest_m: float) -> Floats:
    """Rows along the x axis, so far as they are inside, shape (n, 2, 2)."""
    left, _, right, _ = inside.bounds
    lines = shapely.linestrings([[(left - 1.0, y), (right + 1.0, y)] for y in heights])
    cuts = shapely.get_parts(shapely.intersection(lines, inside))
    long = cuts[shapely.length(cuts) > shortest_m]
    return np.array([shapely.get_coordinates(cut)[[0, -1]] for cut in long]).reshape(-1, 2, 2)


@dataclass(frozen=True)
class Pace:
    """How fast the vehicle is; without an acceleration, lengths are counted for times."""

    speed_m_s: float = 1.0
    acceleration_m_s2: float = np.inf

    @property
    def stop_s(self) -> float:
        """What a rest costs over flying on, half of it before and half of it after."""
        return self.speed_m_s / self.acceleration_m_s2

    def ways_s(self, lanes_m: Floats, ways_m: Floats) -> Floats:
        """From the end where a lane is left to the end where another is begun, shape (2 n, 2 n).

        Ends 2 i and 2 i + 1 are those of one lane.

        Args:
            lanes_m: Shape (n, 2, 2).
            ways_m: Shape (2 n, 2 n), lengths of ways.
        """
        times = ways_m / self.speed_m_s
        if not np.isfinite(self.acceleration_m_s2):
            return times
        ends = lanes_m.reshape(-1, 2)
        steps = lanes_m[:, 1] - lanes_m[:, 0]
        lengths = np.linalg.norm(steps, axis=1)
        # The heading of the lane that is left at an end, or begun at it: outwards and inwards.
        outwards = (steps / lengths[:, None])[:, None] * np.array([-1.0, 1.0])[:, None]
        outwards = outwards.reshape(-1, 2)
        back = outwards @ -outwards.T < -_PARALLEL
        apart = ends - ends[:, None]
        aside = np.abs(outwards[:, None, 0] * apart[..., 1] - outwards[:, None, 1] * apart[..., 0])
        # On a short lane full speed is not reached: there no time is counted for losing it.
        long = np.repeat(lengths >= self.speed_m_s * self.stop_s, 2)
        turns = turn_back_s(aside, self.speed_m_s, self.acceleration_m_s2)
        return np.asarray(np.where(back & long & long[:, None], np.maximum(times, turns), times))


def through(lanes_s: Floats, ways: Floats, reached: Floats) -> Floats:
    """What it takes at least to have flown all lanes and be at an end of one, shape (2 n,).

    Args:
        lanes_s: Shape (n,), what each lane takes.
        ways: Shape (2 n, 2 n), from where a lane is left to where another is begun.
        reached: Shape (2 n,), what it takes to be where the first lane is begun.
    """
    count = len(lanes_s)
    lane, other = np.arange(2 * count) // 2, np.arange(2 * count) ^ 1
    best = np.full((1 << count, 2 * count), np.inf)
    best[1 << lane, other] = reached + lanes_s[lane]
    for done in range(1, (1 << count) - 1):
        begun = np.flatnonzero((done >> lane) & 1 == 0)
        costs = (best[done][:, None] + ways[:, begun]).min(axis=0) + lanes_s[lane[begun]]
        after = done | 1 << lane[begun]
        best[after, other[begun]] = np.minimum(best[after, other[begun]], costs)
    return np.asarray(best[-1])


@dataclass(frozen=True, eq=False)
class Visit:
    """What is visited: points, or parts to be covered, each by one of some sets of rows.

    Attributes:
        points_m: Shape (k, 2); with no parts.
        parts: For each the rows that would do.
        rest_s: How long the vehicle stays; it stands then.
    """

    points_m: Floats
    parts: Sequence[Sequence[Rows]] = ()
    rest_s: float = 0.0


def choices(visit: Visit) -> list[Floats]:
    """Lanes for all parts of a visit: of one part the shortest of each number; of several, the fewest of each."""
    parts = [sorted(part, key=lambda rows: rows.length_m) for part in visit.parts]
    if len(parts) > 1:
        fewest = [min(part, key=lambda rows: (len(rows.lanes_m), rows.length_m)) for part in parts]
        return [np.concatenate([rows.lanes_m for rows in fewest])]
    return [
        rows.lanes_m
        for number in sorted({len(rows.lanes_m) for rows in parts[0]})
        if number <= _MOST_LANES
        for rows in [rows for rows in parts[0] if len(rows.lanes_m) == number][:_KEPT]
    ]


def in_lanes(ground: Ground, start_m: Floats, visits: Sequence[Visit], pace: Pace) -> float:
    """What a flight from rest through visits, in this order, to rest takes at least."""
    places, reached = start_m[None], np.array([0.5 * pace.stop_s])
    for visit in visits:
        if not visit.parts:
            ways = ground.between(places, visit.points_m) / pace.speed_m_s
            cost = visit.rest_s + pace.stop_s if visit.rest_s > 0.0 and np.isfinite(pace.acceleration_m_s2) else 0.0
            reached = (reached[:, None] + ways).min(axis=0) + cost
            places = visit.points_m
            continue
        found, ends_m = [], []
        for lanes_m in choices(visit):
            ends = lanes_m.reshape(-1, 2)
            ways = pace.ways_s(lanes_m, ground.between(ends, ends))
            to = (reached[:, None] + ground.between(places, ends) / pace.speed_m_s).min(axis=0)
            lasts = np.linalg.norm(lanes_m[:, 1] - lanes_m[:, 0], axis=1) / pace.speed_m_s
            found.append(through(lasts, ways, to))
            ends_m.append(ends)
        places, reached = np.concatenate(ends_m), np.concatenate(found)
    return float(reached.min()) + 0.5 * pace.stop_s
