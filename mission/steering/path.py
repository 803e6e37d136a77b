"""The planned path: a run of triangles, steered through by one affine field in each (paper, Sec. 4.1.2)."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import groupby, pairwise
from types import MappingProxyType
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from mission.geometry.arrays import FloatArray, frozen_floats
from mission.geometry.simplices import Partition
from mission.planning.run import Run
from mission.spec.model import Point
from mission.steering.facet_control import affine_fields, exit_velocities, stay_velocities
from mission.steering.flow import exit_time, flow_with_velocity, settling_time
from mission.steering.rounded import RoundedPolyline

_NODES = 24  # Gauss-Legendre nodes a panel of the arc length
_SETTLED = 0.25  # how near the equilibrium of u_0 a visit goes, in radii of the inscribed circle
_PANEL = 1.0  # largest change of a field over half a panel, |F| times time
_SAME_PLACE_M = 1e-3  # a flight that starts so near to its lap starts in it


LanesFrom = Callable[[Point], RoundedPolyline]
"""From a place to a curve that begins and ends there."""

LanesIn = Mapping[int, Sequence[LanesFrom]]


@dataclass(frozen=True, eq=False)
class Segment:
    """One triangle of the path.

    Attributes:
        triangle: Index in the partition.
        control: The paper's u_j, 0 (stay) to 3.
        F: Shape (2, 2), 1/s, and ``g``, shape (2,), m/s: the field u = F x + g.
        g: See ``F``.
        entry_m: Where the path enters.
        start_s: When it enters, steering time.
        duration_s: How long it takes.
        lanes: Where a region is covered: a curve that is flown from here and back to here, from rest to rest, in the
            place of a field (which vanishes).
    """

    triangle: int
    control: int
    F: FloatArray
    g: FloatArray
    entry_m: tuple[float, float]
    start_s: float
    duration_s: float
    lanes: RoundedPolyline | None = None


@dataclass(frozen=True, eq=False)
class SteeringPath:
    """A continuous path, exact at any time.

    Attributes:
        segments: In order of time, the first at 0, each beginning where the one before it ends.
        lap: Of a recurrent run, the index of the first segment of the lap and of the one after it; the lap ends where
            it begins. None where the run ends in a stay.
    """

    segments: tuple[Segment, ...]
    lap: tuple[int, int] | None = None

    @property
    def duration_s(self) -> float:
        """Steering time from start to end."""
        return float(self.knots_s[-1])

    @property
    def lap_s(self) -> tuple[float, float] | None:
        """When the lap of a recurrent run begins and ends."""
        return None if self.lap is None else (float(self.knots_s[self.lap[0]]), float(self.knots_s[self.lap[1]]))

    @property
    def legs(self) -> tuple["SteeringPath", ...]:
        """What is flown from rest to rest: the way to the lap, the lap, and what comes after it; each from time 0.

        A path that ends in a stay is one leg. Where a flight starts in the place in which the lap begins, the lap is
        the first leg.
        """
        cuts = sorted({0, *(self.lap or ()), len(self.segments)})
        return tuple(SteeringPath(_from_zero(self.segments[a:b])) for a, b in pairwise(cuts))

    @property
    def repeated_leg(self) -> int | None:
        """Which of the legs is the lap."""
        return None if self.lap is None else min(self.lap[0], 1)

    @property
    def parts(self) -> "tuple[SteeringPath | RoundedPolyline, ...]":
        """What fields steer, from rest to rest, and the lanes in between; each from time 0."""
        groups = groupby(self.segments, key=lambda segment: segment.lanes)
        return tuple(lanes or SteeringPath(_from_zero(tuple(part))) for lanes, part in groups)

    def then(self, onward: "SteeringPath") -> "SteeringPath":
        """This path with another one after it, which begins where this one ends."""
        later = (replace(each, start_s=each.start_s + self.duration_s) for each in onward.segments)
        return SteeringPath((*self.segments, *later), self.lap)

    @cached_property
    def knots_s(self) -> FloatArray:
        """Starts of the segments and the end, shape (len(segments) + 1,)."""
        last = self.segments[-1]
        return frozen_floats([*(segment.start_s for segment in self.segments), last.start_s + last.duration_s])

    @cached_property
    def _fields(self) -> tuple[FloatArray, FloatArray, FloatArray]:
        return (
            np.array([segment.F for segment in self.segments]),
            np.array([segment.g for segment in self.segments]),
            np.array([segment.entry_m for segment in self.segments]),
        )

    def state(self, t_s: ArrayLike) -> tuple[FloatArray, FloatArray]:
        """Position and velocity at the times ``t_s`` (T,), both (T, 2); at a knot, of the later segment."""
        times = np.clip(np.atleast_1d(np.asarray(t_s, dtype=np.float64)), 0.0, self.duration_s)
        index = np.clip(np.searchsorted(self.knots_s, times, side="right") - 1, 0, len(self.segments) - 1)
        F, g, entries = self._fields
        elapsed = times - self.knots_s[index]
        position, velocity = flow_with_velocity(F[index], g[index], entries[index], elapsed)
        for number in np.unique(index).tolist():
            lanes = self.segments[number].lanes
            if lanes is not None:
                position[index == number], velocity[index == number], _ = lanes.jet(elapsed[index == number])
        return position, velocity

    def position(self, t_s: ArrayLike) -> FloatArray:
        """Position at the times ``t_s`` (T,), shape (T, 2), metres."""
        return self.state(t_s)[0]

    def velocity(self, t_s: ArrayLike) -> FloatArray:
        """Velocity at the times ``t_s`` (T,), shape (T, 2), m/s."""
        return self.state(t_s)[1]

    @cached_property
    def length_m(self) -> float:
        """Arc length: where fields steer, by Gauss-Legendre panels short against the rate of each."""
        covered_m = sum(segment.lanes.length_m for segment in self.segments if segment.lanes is not None)
        durations = np.diff(self.knots_s)
        rates = np.array([np.linalg.norm(segment.F) for segment in self.segments])
        counts = np.maximum(1, np.ceil(rates * durations / (2.0 * _PANEL))).astype(np.int64)
        nodes, weights = np.polynomial.legendre.leggauss(_NODES)
        index = np.repeat(np.arange(len(counts)), counts)
        place = np.arange(len(index)) - np.repeat(np.cumsum(counts) - counts, counts)
        widths = (durations / counts)[index]
        offsets = (place[:, None] + 0.5 * (nodes + 1.0)) * widths[:, None]
        F, g, entries = self._fields
        index = np.repeat(index, _NODES)
        _, velocity = flow_with_velocity(F[index], g[index], entries[index], offsets.ravel())
        speeds = np.hypot(velocity[:, 0], velocity[:, 1]).reshape(-1, _NODES)
        return covered_m + float((speeds @ weights * (0.5 * widths)).sum())


def build_path(
    partition: Partition,
    run: Run,
    *,
    start_m: Sequence[float],
    speed_m_s: float,
    final_stay_s: float,
    settle_in: frozenset[int] = frozenset(),
    lanes_in: LanesIn = MappingProxyType({}),
) -> SteeringPath:
    """Steer through the triangles of a run.

    A run whose loop is a stay ends with ``final_stay_s`` under u_0. A recurrent run flies to its loop and once round
    it. That lap can be repeated as it is, for it begins and ends in one point, the equilibrium of u_0 in the triangle
    where the loop begins: the path settles there, and goes the last bit straight on, at the reference speed, since u_0
    would take for ever. A stay inside the run takes ``final_stay_s`` too: in a run, u_0 is a transition like any other.

    Args:
        partition: The triangles.
        run: A run that begins in the triangle of ``start_m``.
        start_m: Where the path begins, in the closed first triangle.
        speed_m_s: Reference speed c, positive.
        final_stay_s: Duration of a stay, positive.
        settle_in: Indices into ``run.states`` at which u_0 is applied first, until the path has come close to its
            equilibrium, and the run's control then: a visit that does more than cut a corner. The triangles that the
            path runs through are the same.
        lanes_in: Indices into ``run.states`` at which the path comes to rest first, in the equilibrium of u_0, to fly
            curves that begin and end there, which are made for that place.

    Raises:
        ValueError: If an argument is out of range.
    """
    if not (speed_m_s > 0.0 and final_stay_s > 0.0):
        raise ValueError("speed and stay must be positive")
    steps = _Steps(partition, run, speed_m_s, final_stay_s, _Visits(settle_in, lanes_in))
    segments: list[Segment] = []
    entry = np.array(start_m, dtype=np.float64)
    loop, end = len(run.prefix), len(run.states)
    for index in range(loop):
        entry = steps.append(segments, index, entry)
    if not run.recurrent:
        entry = steps.cover(segments, loop, entry)
        steps.stay(segments, run.suffix[0], entry)
        return SteeringPath(tuple(segments))
    entry = steps.come_to_rest(segments, run.suffix[0], entry)
    first = len(segments)
    for index in range(loop, end):
        entry = steps.append(segments, index, entry)
    steps.come_to_rest(segments, run.suffix[0], entry)
    return SteeringPath(tuple(segments), (first, len(segments)))


def _from_zero(segments: tuple[Segment, ...]) -> tuple[Segment, ...]:
    return tuple(replace(segment, start_s=segment.start_s - segments[0].start_s) for segment in segments)


class _Visits(NamedTuple):
    """What the path does at some states of a run beside going through, as in ``build_path``."""

    settle_in: frozenset[int]
    lanes_in: LanesIn


class _Steps:
    """The fields of the triangles that a run passes, and how the path goes on with each."""

    def __init__(self, partition: Partition, run: Run, speed_m_s: float, final_stay_s: float, visits: _Visits) -> None:
        passed = sorted(set(run.states))
        part = Partition(partition.vertices_m, partition.triangles[passed], np.full((len(passed), 3), -1))
        velocities = np.concatenate(
            (stay_velocities(part, speed_m_s)[:, None], exit_velocities(part, speed_m_s)), axis=1
        )  # (n, control, vertex, xy)
        self._F, self._g = affine_fields(part.corners_m[:, None], velocities)
        self._place = {triangle: i for i, triangle in enumerate(passed)}
        self._part, self._run, self._stay_s, self._visits = part, run, final_stay_s, visits
        self._speed_m_s = speed_m_s

    def append(self, segments: list[Segment], index: int, entry: FloatArray) -> FloatArray:
        """Go through the ``index``-th state of the run; return where the path leaves it."""
        triangle, control = self._run.states[index], self._run.controls[index]
        i = self._place[triangle]
        if index in self._visits.lanes_in:
            entry = self.cover(segments, index, entry)
        elif index in self._visits.settle_in:
            entry = self._settle(segments, triangle, entry)
        if control == 0:
            return self.stay(segments, triangle, entry)
        time, leaving = exit_time(self._F[i, control], self._g[i, control], self._part.corners_m[i], control - 1, entry)
        self._follow(segments, triangle, control, entry, time)
        return leaving

    def cover(self, segments: list[Segment], index: int, entry: FloatArray) -> FloatArray:
        """Come to rest in the ``index``-th state of the run and fly its lanes, if it has some; return where that is."""
        triangle = self._run.states[index]
        for lanes_of in self._visits.lanes_in.get(index, ()):
            entry = self.come_to_rest(segments, triangle, entry)
            place = (float(entry[0]), float(entry[1]))
            lanes = lanes_of(place)
            still = frozen_floats(np.zeros((2, 2))), frozen_floats(np.zeros(2))
            begins_s = segments[-1].start_s + segments[-1].duration_s if segments else 0.0
            segments.append(Segment(triangle, 0, *still, place, begins_s, lanes.duration_s, lanes))
        return entry

    def stay(self, segments: list[Segment], triangle: int, entry: FloatArray) -> FloatArray:
        """Apply u_0 for the time of a stay; return where the path is then."""
        return self._follow(segments, triangle, 0, entry, self._stay_s)

    def come_to_rest(self, segments: list[Segment], triangle: int, entry: FloatArray) -> FloatArray:
        """Go to the equilibrium of u_0, near it on a straight line; return it."""
        i = self._place[triangle]
        rest: FloatArray = -np.linalg.solve(self._F[i, 0], self._g[i, 0])
        entry = self._settle(segments, triangle, entry)
        left_m = float(np.hypot(*(rest - entry)))
        if left_m > (0.0 if segments else _SAME_PLACE_M):
            straight = frozen_floats(self._speed_m_s * (rest - entry) / left_m)
            still = frozen_floats(np.zeros((2, 2)))
            self._extend(segments, triangle, 0, (still, straight), entry=entry, duration_s=left_m / self._speed_m_s)
        return rest

    def _settle(self, segments: list[Segment], triangle: int, entry: FloatArray) -> FloatArray:
        """Apply u_0 until its equilibrium is near."""
        i = self._place[triangle]
        near = _SETTLED * float(self._part.inradii_m[i])
        return self._follow(segments, triangle, 0, entry, settling_time(self._F[i, 0], self._g[i, 0], entry, near))

    def _follow(
        self, segments: list[Segment], triangle: int, control: int, entry: FloatArray, duration_s: float
    ) -> FloatArray:
        i = self._place[triangle]
        field = frozen_floats(self._F[i, control]), frozen_floats(self._g[i, control])
        return self._extend(segments, triangle, control, field, entry=entry, duration_s=duration_s)

    def _extend(
        self,
        segments: list[Segment],
        triangle: int,
        control: int,
        field: tuple[FloatArray, FloatArray],
        *,
        entry: FloatArray,
        duration_s: float,
    ) -> FloatArray:
        """Follow a field for a while; return where the path is then."""
        if duration_s > 0.0:
            start_s = segments[-1].start_s + segments[-1].duration_s if segments else 0.0
            place = (float(entry[0]), float(entry[1]))
            segments.append(Segment(triangle, control, *field, place, start_s, duration_s))
        return np.asarray(flow_with_velocity(*field, entry, duration_s)[0][0])
