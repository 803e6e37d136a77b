"""What is left of a plan: its ways from rest to rest are flown as they were, where they still may be."""

from dataclasses import replace

import numpy as np
import pytest
import shapely

from mission.plan import FlightPlan
from mission.plan.rest import Rest, plan_rest
from mission.spec.amendment import amended
from mission.steering.known_laws import KnownLaw, laws_of
from tests.support.small_missions import SMALL, plan_of

OF_THE_WAY = 0.02
LONGER = 1.002


@pytest.fixture(scope="module")
def small() -> FlightPlan:
    return plan_of(SMALL)


def ways(plan: FlightPlan) -> list[KnownLaw]:
    return [way for leg in plan.trajectory.legs for way in laws_of(leg.curve, leg.law)]


def left(plan: FlightPlan, at_s: float) -> Rest:
    (x, y), (vx, vy), (ax, ay) = (each[0].tolist() for each in plan.trajectory.state(at_s))
    return Rest((frozenset({"home"}), frozenset()), (x, y), (vx, vy), (ax, ay), flown_s=at_s)


def kept(before: FlightPlan, after: FlightPlan) -> list[KnownLaw]:
    """The ways of a plan whose curves are those of the plan before."""
    curves = [way.piece for way in ways(before)]
    return [way for way in ways(after) if any(way.piece is curve for curve in curves)]


@pytest.mark.parametrize("at_s", [2.4, 3.0])
def test_all_ways_but_the_one_to_the_next_rest_are_kept(small: FlightPlan, at_s: float) -> None:
    rest = plan_rest(small, left(small, at_s))
    [way] = kept(small, rest)
    [before] = [each.law for each in ways(small) if each.piece is way.piece]
    assert way.law.duration_s == pytest.approx(before.duration_s, abs=1e-9)
    assert rest.certificate.holds
    fresh, left_s = plan_rest(_other(small), left(small, at_s), small.spec), small.trajectory.duration_s - at_s
    assert kept(small, fresh) == []
    assert rest.trajectory.curve.length_m <= LONGER * fresh.trajectory.curve.length_m
    assert abs(rest.trajectory.duration_s - left_s) <= OF_THE_WAY * left_s


def _other(plan: FlightPlan) -> FlightPlan:
    """The same plan of a mission that was flown otherwise, of which nothing is kept."""
    limits = replace(plan.spec.limits, jerk_m_s3=0.999 * plan.spec.limits.jerk_m_s3)
    return replace(plan, spec=replace(plan.spec, limits=limits))


def test_what_now_leads_through_a_restricted_region_is_not_kept(small: FlightPlan) -> None:
    rest = left(small, 2.4)
    beside = amended(small.spec, ["restrict popped [[30, 20], [34, 20], [34, 24], [30, 24]]"], rest.place_m)
    across = amended(small.spec, ["restrict popped [[21, 3], [23, 3], [23, 7.6], [21, 7.6]]"], rest.place_m)
    assert len(kept(small, plan_rest(small, rest, beside))) == 1
    around = plan_rest(small, rest, across)
    assert around.certificate.holds
    popped = shapely.box(21.0, 3.0, 23.0, 7.6)
    for way in ways(around):
        line = way.piece.position(np.linspace(0.0, way.piece.duration_s, 200))
        assert all(popped.distance(shapely.Point(point)) > 0.0 for point in line)


def test_a_law_that_asks_for_too_much_is_made_again(small: FlightPlan) -> None:
    limits = replace(small.spec.limits, acceleration_m_s2=0.7 * small.spec.limits.acceleration_m_s2)
    gentle = replace(small.spec, limits=limits)
    at_rest = replace(left(small, 0.0), velocity_m_s=(0.0, 0.0), acceleration_m_s2=(0.0, 0.0), word=())
    assert kept(small, plan_rest(small, at_rest, gentle)) == []
