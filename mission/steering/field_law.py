"""The velocity to ask for where a vehicle is: the field to a facet, kept off the facets that must not be crossed.

Inside a triangle the field is the one of ``facet_control``: the vertex velocities, weighed by the barycentric
coordinates of the place (Eq. 16). Its direction is what leads out through the facet, so it is flown at one speed. In a
triangle that moves that is its direction against the frame that moves along (``moving_fields``), of which as much is
flown as makes that speed together with the velocity of the frame; and all distances are kept against what moves. A
vehicle does not take up a velocity at once, and wind pushes it: toward a facet that must not be crossed it is asked
for no more than the speed from which it can brake before a margin, with the way that it makes until it obeys taken
off, and within the margin it is led away.
"""

import math
from dataclasses import dataclass
from functools import cached_property
from typing import Final

import numpy as np

from mission.geometry.arrays import BoolArray, FloatArray, IntArray
from mission.geometry.moving import MovingPartition
from mission.geometry.simplices import Partition
from mission.steering.facet_control import exit_velocities, stay_equilibria

LAG_S: Final = 0.7
"""How long a vehicle keeps its velocity before it obeys."""

_MOST_WALLS: Final = 8
_PASSES: Final = 4
_AWAY_M_S: Final = 0.6
_AWAY_PER_S: Final = 1.0
_CREEP_M_S: Final = 0.4
_HARD_M: Final = 0.1
"""Where a gap is too narrow for the margin, it is passed slowly, at this distance."""


@dataclass(frozen=True, eq=False)
class Frame:
    """Where the vertices of a domain are at a moment, and how fast they move.

    Attributes:
        places_m: Shape (V, 2).
        drifts_m_s: Shape (V, 2).
    """

    places_m: FloatArray
    drifts_m_s: FloatArray


@dataclass(frozen=True, eq=False)
class FieldLaw:
    """The law of one domain.

    Attributes:
        partition: M triangles, as they are at first.
        speed_m_s: How fast it is flown.
        acceleration_m_s2: How fast the vehicle changes its velocity.
        braking_m_s2: By how much it brakes before what it must not cross, whatever the wind.
        margin_m: How far it keeps from what it must not cross, besides.
        moving: How the triangles move; None where they stand still.
    """

    partition: Partition
    speed_m_s: float
    acceleration_m_s2: float
    braking_m_s2: float
    margin_m: float
    moving: MovingPartition | None = None

    def frame(self, time_s: float) -> Frame:
        """The frame at a time of the motion."""
        if self.moving is None:
            return self._still
        return Frame(self.moving.vertices_at(time_s), self.moving.velocities_at(time_s))

    def leaving(self, triangle: int, facet: int, position_m: FloatArray, frame: Frame) -> FloatArray:
        """The velocity of the field to a facet, shape (2,); beside the triangle as at its nearest coordinates."""
        shares = self._shares(triangle, position_m, frame)
        vertices = self.partition.triangles[triangle]
        field = (self._exit_rates[triangle, facet] @ shares) @ frame.places_m[vertices]
        drift = shares @ frame.drifts_m_s[vertices]
        ahead = float(field @ drift) / float(np.linalg.norm(field))
        spare = self.speed_m_s**2 - float(drift @ drift) + ahead**2
        own = max(math.sqrt(max(spare, 0.0)) - ahead, min(_CREEP_M_S, self.speed_m_s))
        return np.asarray(own * field / np.linalg.norm(field) + drift)

    def drift(self, triangle: int, position_m: FloatArray, frame: Frame) -> FloatArray:
        """How fast the frame moves at a place in a triangle, shape (2,)."""
        shares = self._shares(triangle, position_m, frame)
        return np.asarray(shares @ frame.drifts_m_s[self.partition.triangles[triangle]])

    def stand_m(self, triangle: int, frame: Frame) -> FloatArray:
        """Where the field that stays vanishes against the frame: where a vehicle stands in a triangle, shape (2,)."""
        return np.asarray(self._stands[triangle] @ frame.places_m[self.partition.triangles[triangle]])

    def standing(self, point_m: FloatArray, position_m: FloatArray) -> FloatArray:
        """The velocity toward a point to stand at, from which it can be reached without passing it, shape (2,)."""
        off = point_m - position_m
        distance = float(np.hypot(*off))
        if distance == 0.0:
            return np.zeros(2)
        speed = min(self.speed_m_s, distance / LAG_S, float(np.sqrt(2.0 * self.braking_m_s2 * distance)))
        return np.asarray(speed * off / distance)

    def walls(self, closed: BoolArray) -> IntArray:
        """The facets (M, 3) that are closed by the vertices at their ends, shape (K, 2)."""
        triangles, facets = np.nonzero(closed)
        vertices = self.partition.triangles
        return np.stack((vertices[triangles, facets - 2], vertices[triangles, facets - 1]), axis=1)

    def guarded(
        self,
        wanted_m_s: FloatArray,
        position_m: FloatArray,
        velocity_m_s: FloatArray,
        walls: IntArray,
        *,
        frame: Frame,
        drift_m_s: FloatArray,
    ) -> FloatArray:
        """The velocity nearest to the one that is wanted that keeps off the walls; where it would stop, it creeps on.

        Args:
            wanted_m_s: Shape (2,).
            position_m: Where the vehicle is, shape (2,).
            velocity_m_s: How fast it is, shape (2,).
            walls: As from ``walls``, shape (K, 2).
            frame: Where they are, and how fast they move.
            drift_m_s: How fast the frame moves where the vehicle is, shape (2,): against that it stops, or creeps.
        """
        near = _Walls(frame.places_m[walls], frame.drifts_m_s[walls] - drift_m_s, position_m)
        own, velocity = wanted_m_s - drift_m_s, velocity_m_s - drift_m_s
        kept = self._kept_off(own, velocity, near, self.margin_m)
        speed = float(np.hypot(*own))
        creep = min(_CREEP_M_S, speed)
        if speed > 0.0 and kept @ own / speed < 0.5 * creep:
            slow = self._kept_off(creep * own / speed, velocity, near, _HARD_M)
            kept = slow if slow @ own > kept @ own else kept
        return kept + drift_m_s

    def _kept_off(self, wanted: FloatArray, velocity: FloatArray, walls: "_Walls", margin_m: float) -> FloatArray:
        if not len(walls.distance_m):
            return wanted
        toward, slips = walls.toward, walls.slips_m_s
        room = walls.distance_m - margin_m - LAG_S * np.maximum(toward @ velocity - slips, 0.0)
        most = np.where(
            room > 0.0,
            np.sqrt(2.0 * self.braking_m_s2 * np.maximum(room, 0.0)),
            np.maximum(_AWAY_PER_S * room, -_AWAY_M_S),
        )
        nearest = np.argsort(most + slips - toward @ wanted, kind="stable")[:_MOST_WALLS]
        kept = wanted.copy()
        for _ in range(_PASSES):
            for wall in nearest.tolist():
                excess = float(toward[wall] @ kept) - float(slips[wall]) - max(float(most[wall]), 0.0)
                if excess > 0.0:
                    kept = kept - excess * toward[wall]
        pressing = nearest[most[nearest] < 0.0]
        if len(pressing):
            kept = kept + (most[pressing, None] * toward[pressing]).mean(axis=0)
        return kept

    @cached_property
    def _still(self) -> Frame:
        vertices = self.partition.vertices_m
        return Frame(vertices, np.zeros_like(vertices))

    @cached_property
    def _exit_rates(self) -> FloatArray:
        """(M, 3, 3, 3) as [triangle, facet, coordinate, vertex]: the fields, by the rates of coordinates they make."""
        slopes = -self.partition.normals / self.partition.heights_m[..., None]
        return np.asarray(np.einsum("mjx,mfix->mfji", slopes, exit_velocities(self.partition, 1.0)))

    @cached_property
    def _stands(self) -> FloatArray:
        """(M, 3), in barycentric coordinates."""
        return self.partition.barycentric(np.arange(self.partition.size), stay_equilibria(self.partition))

    def _shares(self, triangle: int, position_m: FloatArray, frame: Frame) -> FloatArray:
        """Barycentric coordinates of a place (3,); of one beside the triangle those of a place in it."""
        corners = frame.places_m[self.partition.triangles[triangle]]
        edges = np.roll(corners, -2, axis=0) - np.roll(corners, -1, axis=0)
        off = position_m - np.roll(corners, -1, axis=0)
        doubled = (edges[:, 0] * off[:, 1] - edges[:, 1] * off[:, 0]).clip(min=0.0)
        return np.asarray(doubled / doubled.sum())


class _Walls:
    """Walls as they are seen from a place.

    Attributes:
        distance_m: Of the nearest point of each, shape (K,).
        toward: The direction to it, shape (K, 2).
        slips_m_s: How fast it recedes, shape (K,).
    """

    def __init__(self, ends_m: FloatArray, drifts_m_s: FloatArray, position_m: FloatArray) -> None:
        along = ends_m[:, 1] - ends_m[:, 0]
        shares = ((position_m - ends_m[:, 0]) * along).sum(axis=1) / (along**2).sum(axis=1)
        shares = shares.clip(0.0, 1.0)[:, None]
        off = ends_m[:, 0] + shares * along - position_m
        self.distance_m = np.linalg.norm(off, axis=1)
        self.toward = off / np.maximum(self.distance_m, 1e-9)[:, None]
        drifts = drifts_m_s[:, 0] + shares * (drifts_m_s[:, 1] - drifts_m_s[:, 0])
        self.slips_m_s = (self.toward * drifts).sum(axis=1)
