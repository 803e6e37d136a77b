"""What to do next from any triangle and any state of the automaton, by the mission of a plan."""

from collections.abc import Sequence
from typing import Final

import numpy as np
import shapely

from mission.geometry.arrays import BoolArray, FloatArray
from mission.geometry.location import OUTSIDE
from mission.geometry.simplices import Partition
from mission.plan.costs import UNIT, transition_weights
from mission.plan.flight_plan import FlightPlan
from mission.plan.homeward import ends_of_flight
from mission.planning.policy import Policy
from mission.planning.transition_system import TransitionSystem
from mission.spec.model import Cost, Flight
from mission.steering.facet_control import stay_equilibria

_LEAST_MARGIN_M: Final = 0.4

_ROOM_M: Final = 5.0
_ROOM_WORTH: Final = 4.0
"""How far off other labels a vehicle stands well, and how many metres of way each metre that lacks is worth."""

_NARROW_WORTH: Final = 4.0
"""How much longer a way past the very corner of something counts than one with room."""

_MOMENTS: Final = 9
"""Where something moves, what is narrow at one of so many moments counts as narrow."""


def margin_m(flight: Flight) -> float:
    """How far a flight by the field keeps from what must not be entered, besides what its speed asks for, metres."""
    return max(flight.tube_m, _LEAST_MARGIN_M)


def policy_of(plan: FlightPlan) -> Policy:
    """What to do next by the mission of a plan, from any triangle and any state of its automaton.

    Costs are metres, whatever the mission counts: of a way through many small triangles no count is fair. A way close
    to what must not be entered counts as longer, and to stop close to another label costs. Where something moves, ways
    are as long as at first, and as close as ever.
    """
    partition = plan.partition
    across = partition.neighbours
    shut = (across == OUTSIDE) | plan.restricted[across]
    moments = _moments(plan)
    lacking = np.maximum(1.0 - _beside(moments, shut) / (2.0 * margin_m(plan.spec.flight)), 0.0)
    weights = transition_weights(partition, Cost.DISTANCE, plan.spec.flight.speed_m_s).astype(np.float64)
    weights[:, 1:] *= 1.0 + _NARROW_WORTH * lacking
    system = TransitionSystem.from_partition(
        partition, plan.labelling, plan.restricted, np.rint(weights).astype(np.int64)
    )
    letters = plan.labelling.letter_of
    borders = shut | (letters[across] != letters[:, None])
    room_m = np.min([_distances(each, borders, stay_equilibria(each)) for each in moments], axis=0)
    shallow = np.maximum(_ROOM_M - room_m, 0.0) * _ROOM_WORTH / UNIT[Cost.DISTANCE][1]
    return Policy(
        system,
        plan.conjunction,
        plan.run.states[0],
        plan.spec.semantics,
        shallow=np.where(plan.restricted, np.inf, shallow),
        homes=ends_of_flight(plan.spec, plan.labelling, plan.restricted, plan.run.states[0]),
        laps=plan.run.recurrent,
    )


def _moments(plan: FlightPlan) -> list[Partition]:
    """The triangles as they are, or at some moments of their motion."""
    if plan.moving is None:
        return [plan.partition]
    return [plan.moving.at(time_s) for time_s in np.linspace(0.0, plan.moving.last_s, _MOMENTS).tolist()]


def _beside(moments: Sequence[Partition], shut: BoolArray) -> FloatArray:
    """How near the middle of each facet (M, 3) comes to one of those that are shut, metres."""
    nearest = []
    for each in moments:
        middles = (np.roll(each.corners_m, -1, axis=1) + np.roll(each.corners_m, -2, axis=1)) / 2.0
        nearest.append(_distances(each, shut, middles.reshape(-1, 2)).reshape(-1, 3))
    return np.asarray(np.min(nearest, axis=0))


def _distances(partition: Partition, facets: BoolArray, points_m: FloatArray) -> FloatArray:
    """Distance of points (P, 2) from the nearest of the facets (M, 3), (P,), metres; infinite where there is none."""
    triangles, numbers = np.nonzero(facets)
    if not len(triangles):
        return np.full(len(points_m), np.inf)
    corners = partition.corners_m
    lines = shapely.linestrings(np.stack((corners[triangles, numbers - 2], corners[triangles, numbers - 1]), axis=1))
    (which, _), distances = shapely.STRtree(lines).query_nearest(
        shapely.points(points_m), return_distance=True, all_matches=False
    )
    found = np.empty(len(points_m))
    found[which] = distances
    return found
