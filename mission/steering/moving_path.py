"""A path of fields through triangles that move (paper, Sec. 4.4): exact in the fixed ones, and carried over by time.

In the fixed triangles the path is that of the fields, exactly; where it is in space at a time is the image of where it
is in the fixed triangle then. Its triangles are those of the run whatever the motion, since the image of a triangle is
the moving one. Position in space is continuous; velocity jumps where one field follows another, and where a vertex
changes its velocity.
"""

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike

from mission.errors import NoPlanError
from mission.geometry.arrays import FloatArray, IntArray, frozen_floats
from mission.geometry.moving import MovingPartition
from mission.steering.flow import flow_with_velocity
from mission.steering.moving_fields import MovingFields
from mission.steering.path import Segment, SteeringPath


@dataclass(frozen=True, eq=False)
class MovingPath:
    """A path in moving triangles, exact at any time.

    Attributes:
        moving: The triangles.
        fixed: The path in the fixed ones, without lanes; its times are those of the motion.

    Raises:
        ValueError: The path has lanes.
    """

    moving: MovingPartition
    fixed: SteeringPath

    def __post_init__(self) -> None:
        if any(segment.lanes is not None for segment in self.fixed.segments):
            raise ValueError("lanes are not flown by fields")

    @property
    def duration_s(self) -> float:
        """From start to end."""
        return self.fixed.duration_s

    @cached_property
    def knots_s(self) -> FloatArray:
        """Where a field follows another one or vertices change their velocities, and both ends; shape (P + 1,)."""
        instants = self.moving.times_s[self.moving.times_s < self.duration_s]
        return frozen_floats(np.union1d(self.fixed.knots_s, instants))

    @cached_property
    def jumps_m_s(self) -> FloatArray:
        """By how much the velocity jumps at each inner knot, shape (P - 1, 2)."""
        inner, after = self.knots_s[1:-1], np.arange(1, len(self.knots_s) - 1)
        return np.asarray(self._on(after, inner)[1] - self._on(after - 1, inner)[1])

    def state(self, t_s: ArrayLike) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Position, velocity and acceleration in space at times (T,), each (T, 2); at a knot, of what follows."""
        times = np.clip(np.atleast_1d(np.asarray(t_s, dtype=np.float64)), 0.0, self.duration_s)
        return self._on(np.searchsorted(self.knots_s[1:-1], times, side="right"), times)

    def triangles_at(self, t_s: ArrayLike) -> IntArray:
        """The triangles in which the path is at times (T,), shape (T,)."""
        index = np.searchsorted(self.fixed.knots_s[1:-1], np.atleast_1d(t_s), side="right")
        return np.array([segment.triangle for segment in self.fixed.segments])[index]

    def _on(self, pieces: IntArray, times: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
        """The state on pieces between knots, their ends included."""
        begins = self.knots_s[pieces]
        F, g, entries, triangles = self._fields
        i = np.searchsorted(self.fixed.knots_s[1:-1], begins, side="right")
        k = np.searchsorted(self.moving.times_s, begins, side="right") - 1
        points, along = flow_with_velocity(F[i], g[i], entries[i], times - self.fixed.knots_s[i])
        bends = (F[i] @ along[..., None])[..., 0]
        partition, own = self.moving.fixed, triangles[i]
        slopes = -partition.normals[own] / partition.heights_m[own][..., None]
        shares = partition.barycentric(own, points)
        rates, bent = (np.einsum("tjx,tx->tj", slopes, each) for each in (along, bends))
        vertices = partition.triangles[own]
        drifts = self.moving.drifts_m_s[k[:, None], vertices]
        since = times - self.moving.times_s[k]
        corners = self.moving.places_m[k[:, None], vertices] + since[:, None, None] * drifts

        def of(weights: FloatArray, vectors: FloatArray) -> FloatArray:
            return np.asarray(np.einsum("tj,tjx->tx", weights, vectors))

        return of(shares, corners), of(rates, corners) + of(shares, drifts), of(bent, corners) + 2.0 * of(rates, drifts)

    @cached_property
    def _fields(self) -> tuple[FloatArray, FloatArray, FloatArray, IntArray]:
        every = self.fixed.segments
        return (
            np.array([segment.F for segment in every]),
            np.array([segment.g for segment in every]),
            np.array([segment.entry_m for segment in every]),
            np.array([segment.triangle for segment in every]),
        )


def within_speed(moving: MovingPartition, path: SteeringPath, limit_m_s: float) -> MovingPath:
    """A path carried over, each of its fields slowed down as far as a limit of speed in space asks for it.

    The way through the fixed triangles stays the same. A field that is slowed down lasts longer, so that it may come
    into times at which its triangle moves faster: it is slowed down for these then, too.

    Args:
        moving: The triangles.
        path: Through the fixed ones, without lanes.
        limit_m_s: The largest speed in space.

    Raises:
        NoPlanError: A corner of a triangle moves with that speed itself while the path is in it.
    """
    segments: list[Segment] = []
    corners = moving.fixed.corners_m[[each.triangle for each in path.segments]]
    velocities = np.array([c @ each.F.T + each.g for c, each in zip(corners, path.segments, strict=True)])
    fields = MovingFields(moving, np.array([each.triangle for each in path.segments]), velocities)
    factors, until_s, start_s = fields.factors(limit_m_s), np.append(moving.times_s[1:], np.inf), 0.0
    for number, each in enumerate(path.segments):
        first = int(np.searchsorted(moving.times_s, start_s, side="right")) - 1
        last, factor = first, float(factors[first, number])
        while factor > 0.0 and until_s[last] < start_s + each.duration_s / factor:
            last += 1
            factor = min(factor, float(factors[last, number]))
        if factor == 0.0:
            raise _too_fast(fields, number, last, limit_m_s)
        slowed = Segment(
            each.triangle,
            each.control,
            frozen_floats(factor * each.F),
            frozen_floats(factor * each.g),
            each.entry_m,
            start_s,
            each.duration_s / factor,
        )
        segments.append(slowed)
        start_s += slowed.duration_s
    return MovingPath(moving, replace(path, segments=tuple(segments)))


def _too_fast(fields: MovingFields, number: int, instant: int, limit_m_s: float) -> NoPlanError:
    """Why a field cannot be flown from an instant on: a corner of its triangle is too fast."""
    moving, triangle = fields.moving, int(fields.triangles[number])
    corner = int(np.argmax(fields.frame_speeds_m_s[instant, number]))
    speed_m_s = float(fields.frame_speeds_m_s[instant, number, corner])
    (x, y), time_s = moving.fixed.corners_m[triangle, corner], float(moving.times_s[instant])
    return NoPlanError(
        f"triangle {triangle}, through which the fields lead then, moves too fast: from {time_s:.1f} s on its corner "
        f"that is ({x:.6g}, {y:.6g}) m at first moves at {speed_m_s:.3g} m/s, and `limits.speed_m_s` is {limit_m_s:.3g}"
    )
