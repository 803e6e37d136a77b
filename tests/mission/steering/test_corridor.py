"""Smooth curves through corridors."""

import numpy as np
import pytest
import shapely

from mission.steering.bezier import BezierCurve
from mission.steering.corridor import Way, smooth_ways
from mission.steering.motion import Motion, Pace

PACE = Pace(8.0, 2.5, 5.0)
HALL = (
    shapely.box(0.0, 0.0, 100.0, 60.0)
    .difference(shapely.box(30.0, 0.0, 40.0, 40.0))
    .difference(shapely.box(60.0, 20.0, 70.0, 60.0))
)
TAUT = np.array([[5.0, 5.0], [30.0, 40.0], [40.0, 40.0], [60.0, 20.0], [70.0, 20.0], [95.0, 55.0]])


def length_of(points: np.ndarray) -> float:
    return float(np.linalg.norm(np.diff(points, axis=0), axis=1).sum())


def outside(curve: BezierCurve, area: shapely.Geometry) -> float:
    """How far the curve gets out of an area, by samples."""
    points = shapely.points(curve.position(np.linspace(0.0, curve.duration_s, 4001)))
    return float(shapely.distance(area, points).max())


@pytest.mark.parametrize("speed_m_s", [0.5, 2.0, 8.0, 20.0])
def test_it_stays_in_the_area_and_is_hardly_longer(speed_m_s: float) -> None:
    pace = Pace(speed_m_s, 2.5, 5.0)
    (curve,) = smooth_ways([Way(TAUT, HALL, None)], pace)
    assert curve.position([0.0, curve.duration_s]) == pytest.approx(TAUT[[0, -1]])
    assert outside(curve, HALL) <= 1e-5
    assert length_of(TAUT) - 1e-6 <= curve.length_m <= 1.10 * length_of(TAUT)


def test_slower_vehicles_keep_closer_to_the_taut_path() -> None:
    lengths = [smooth_ways([Way(TAUT, HALL, None)], Pace(v, 2.5, 5.0))[0].length_m for v in (0.5, 4.0, 12.0)]
    assert lengths == sorted(lengths)
    assert lengths[0] <= 1.01 * length_of(TAUT)


def test_what_is_flown_through_is_flown_through_at_one_point_of_the_target() -> None:
    target = shapely.box(75.0, 10.0, 85.0, 20.0)
    area = shapely.box(0.0, 0.0, 100.0, 60.0)
    ways = [
        Way(np.array([[5.0, 50.0], [75.0, 20.0]]), area, target),
        Way(np.array([[75.0, 20.0], [95.0, 55.0]]), area, None),
    ]
    (curve,) = smooth_ways(ways, PACE)
    inside = shapely.distance(target, shapely.points(curve.position(curve.knots_s)))
    assert inside.min() <= 1e-6
    assert curve.length_m <= 1.10 * length_of(np.array([[5.0, 50.0], [75.0, 20.0], [95.0, 55.0]]))


def test_a_lap_goes_over_into_itself_and_the_way_to_it_into_the_lap() -> None:
    area = shapely.box(0.0, 0.0, 60.0, 60.0).difference(shapely.box(20.0, 20.0, 40.0, 40.0))
    ring = np.array([[30.0, 19.0], [40.0, 20.0], [40.0, 40.0], [20.0, 40.0], [20.0, 20.0], [30.0, 19.0]])
    target = shapely.box(28.0, 10.0, 32.0, 19.0)
    ways = [Way(np.array([[2.0, 2.0], [30.0, 19.0]]), area, target), Way(ring, area, target)]
    way, lap = smooth_ways(ways, PACE, lap=1)
    for order in (0, 1, 2):
        end = lap.derivative([lap.duration_s], order)[0]
        assert lap.derivative([0.0], order)[0] == pytest.approx(end, abs=1e-9)
        assert way.derivative([way.duration_s], order)[0] == pytest.approx(end, abs=1e-9)
    assert outside(lap, area) <= 1e-5
    assert way.length_m + lap.length_m <= 1.10 * sum(length_of(each.points_m) for each in ways)


def test_the_same_ways_give_the_same_curve_bit_by_bit() -> None:
    one, two = (smooth_ways([Way(TAUT, HALL, None)], PACE)[0] for _ in range(2))
    assert np.array_equal(one.controls_m, two.controls_m)
    assert np.array_equal(one.knots_s, two.knots_s)


def test_far_from_the_origin_nothing_changes() -> None:
    shift = np.array([500_000.0, 5_000_000.0])
    (near,) = smooth_ways([Way(TAUT, HALL, None)], PACE)
    (far,) = smooth_ways([Way(TAUT + shift, shapely.affinity.translate(HALL, *shift), None)], PACE)
    assert far.length_m == pytest.approx(near.length_m, rel=1e-4)


def test_it_goes_on_as_another_curve_ends() -> None:
    middle = 0.5 * (TAUT[2:3] + TAUT[3:4])
    (first,) = smooth_ways([Way(np.concatenate((TAUT[:3], middle)), HALL, None)], PACE)
    end = [first.duration_s]
    onward = Motion(first.derivative(end, 1)[0], first.derivative(end, 2)[0])
    (second,) = smooth_ways([Way(np.concatenate((middle, TAUT[3:])), HALL, None)], PACE, onward=onward)
    for order in (0, 1, 2):
        assert second.derivative([0.0], order)[0] == pytest.approx(first.derivative(end, order)[0], abs=1e-6)
    assert outside(second, HALL) <= 1e-5


def test_it_ends_as_another_curve_begins() -> None:
    """With the speed and the bend of what is flown next, from rest and from motion, and inside the corridor."""
    into = Motion(np.array([0.0, -2.0]), np.array([0.05, 0.0]))
    onward = Motion(np.array([1.0, 0.5]), np.zeros(2))
    for begins in (None, onward):
        (curve,) = smooth_ways([Way(TAUT, HALL, None)], PACE, onward=begins, into=into)
        end = [curve.duration_s]
        assert curve.position(end)[0] == pytest.approx(TAUT[-1], abs=1e-9)
        for order, value in enumerate((into.slope, into.bend), start=1):
            assert curve.derivative(end, order)[0] == pytest.approx(value, abs=1e-6)
        assert outside(curve, HALL) <= 1e-5


def test_it_bends_at_first_no_more_than_who_cannot_slow_down_at_once_can_fly() -> None:
    most, onward = 3.0, Motion(np.array([3.0, 0.0]), np.zeros(2))
    free, bound = (
        smooth_ways([Way(TAUT, HALL, None)], PACE, onward=onward._replace(jerk=jerk))[0] for jerk in (np.inf, most)
    )
    first = [
        np.hypot(*curve.derivative(np.linspace(0.0, 0.99 * curve.knots_s[1], 20), 3).T).max() for curve in (free, bound)
    ]
    assert first[0] > 2.0 * most
    assert first[1] <= most / np.cos(np.pi / 8.0) + 1e-6
    assert outside(bound, HALL) <= 1e-5
