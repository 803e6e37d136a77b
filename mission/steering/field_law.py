"""The velocity to ask for where a vehicle is: the field to a facet, kept off the facets that must not be crossed.

Inside a triangle the field is the one of ``facet_control``: the vertex velocities, weighed by the barycentric
coordinates of the place (Eq. 16). Its direction is what leads out through the facet, so it is flown at one speed. A
vehicle does not take up a velocity at once, and wind pushes it: toward a facet that must not be crossed it is asked
for no more than the speed from which it can brake before a margin, with the way that it makes until it obeys taken
off, and within the margin it is led away.
"""

from dataclasses import dataclass
from functools import cached_property
from typing import Final

import numpy as np

from mission.geometry.arrays import BoolArray, FloatArray
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
class FieldLaw:
    """The law of one domain.

    Attributes:
        partition: M triangles.
        speed_m_s: How fast it is flown.
        acceleration_m_s2: How fast the vehicle changes its velocity.
        braking_m_s2: By how much it brakes before what it must not cross, whatever the wind.
        margin_m: How far it keeps from what it must not cross, besides.
    """

    partition: Partition
    speed_m_s: float
    acceleration_m_s2: float
    braking_m_s2: float
    margin_m: float

    @cached_property
    def _exits(self) -> FloatArray:
        return exit_velocities(self.partition, 1.0)

    @cached_property
    def stands_m(self) -> FloatArray:
        """Where the field that stays vanishes, shape (M, 2): where a vehicle stands that stays in a triangle."""
        return stay_equilibria(self.partition)

    def leaving(self, triangle: int, facet: int, position_m: FloatArray) -> FloatArray:
        """The velocity of the field to a facet, shape (2,); beside the triangle as at its nearest coordinates."""
        shares = self.partition.barycentric(np.array([triangle]), position_m[None])[0].clip(min=0.0)
        field = shares @ self._exits[triangle, facet]
        return np.asarray(self.speed_m_s * field / np.linalg.norm(field))

    def standing(self, point_m: FloatArray, position_m: FloatArray) -> FloatArray:
        """The velocity toward a point to stand at, from which it can be reached without passing it, shape (2,)."""
        off = point_m - position_m
        distance = float(np.hypot(*off))
        if distance == 0.0:
            return np.zeros(2)
        speed = min(self.speed_m_s, distance / LAG_S, float(np.sqrt(2.0 * self.braking_m_s2 * distance)))
        return np.asarray(speed * off / distance)

    def walls(self, closed: BoolArray) -> FloatArray:
        """The facets (M, 3) that are closed as segments, shape (K, 2, 2), metres."""
        triangles, facets = np.nonzero(closed)
        corners = self.partition.corners_m
        return np.stack((corners[triangles, facets - 2], corners[triangles, facets - 1]), axis=1)

    def guarded(
        self, wanted_m_s: FloatArray, position_m: FloatArray, velocity_m_s: FloatArray, walls_m: FloatArray
    ) -> FloatArray:
        """The velocity nearest to the one that is wanted that keeps off the walls; where it would stop, it creeps on.

        Args:
            wanted_m_s: Shape (2,).
            position_m: Where the vehicle is, shape (2,).
            velocity_m_s: How fast it is, shape (2,).
            walls_m: Segments, shape (K, 2, 2).
        """
        kept = self._kept_off(wanted_m_s, position_m, velocity_m_s, walls_m, self.margin_m)
        speed = float(np.hypot(*wanted_m_s))
        creep = min(_CREEP_M_S, speed)
        if speed == 0.0 or kept @ wanted_m_s / speed >= 0.5 * creep:
            return kept
        slow = self._kept_off(creep * wanted_m_s / speed, position_m, velocity_m_s, walls_m, _HARD_M)
        return slow if slow @ wanted_m_s > kept @ wanted_m_s else kept

    def _kept_off(
        self, wanted: FloatArray, position: FloatArray, velocity: FloatArray, walls: FloatArray, margin_m: float
    ) -> FloatArray:
        if not len(walls):
            return wanted
        along = walls[:, 1] - walls[:, 0]
        shares = ((position - walls[:, 0]) * along).sum(axis=1) / (along**2).sum(axis=1)
        off = walls[:, 0] + shares.clip(0.0, 1.0)[:, None] * along - position
        distance = np.linalg.norm(off, axis=1)
        toward = off / np.maximum(distance, 1e-9)[:, None]
        room = distance - margin_m - LAG_S * np.maximum(toward @ velocity, 0.0)
        most = np.where(
            room > 0.0,
            np.sqrt(2.0 * self.braking_m_s2 * np.maximum(room, 0.0)),
            np.maximum(_AWAY_PER_S * room, -_AWAY_M_S),
        )
        nearest = np.argsort(most - toward @ wanted, kind="stable")[:_MOST_WALLS]
        kept = wanted.copy()
        for _ in range(_PASSES):
            for wall in nearest.tolist():
                excess = float(toward[wall] @ kept) - max(float(most[wall]), 0.0)
                if excess > 0.0:
                    kept = kept - excess * toward[wall]
        pressing = nearest[most[nearest] < 0.0]
        if len(pressing):
            kept = kept + (most[pressing, None] * toward[pressing]).mean(axis=0)
        return kept
