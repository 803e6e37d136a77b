"""The monitor on missions in which regions move, against the polygons where they are at each time."""

import numpy as np
import shapely
from hypothesis import assume, given
from hypothesis import strategies as st

from mission.monitor.flight import FlightMonitor
from mission.monitor.legs import FlightLegs
from mission.monitor.monitor import ViolationKind
from mission.monitor.stage import Stage
from tests.support.drawn_cases import tried
from tests.support.drifting_flights import K, k_at, planned_still, walked

PLACES = st.tuples(st.integers(2, 158), st.integers(2, 88)).map(lambda place: (float(place[0]), float(place[1])))
MOTIONS = st.sampled_from(
    (
        "{velocity_m_s: [0, 2], until_s: 20}",
        "{velocity_m_s: [1, 0.5], from_s: 5, until_s: 30}",
        "{waypoints: [[10, 0, 0], [25, 20, 10], [50, -10, 30]]}",
    )
)
NEAR_M = 0.5


@tried(12)
@given(st.lists(PLACES, min_size=2, max_size=4, unique=True), MOTIONS, st.sampled_from((4.0, 9.0)))
def test_a_region_that_moves_is_entered_where_it_is(
    places: list[tuple[float, float]], motion: str, speed_m_s: float
) -> None:
    """Reports ten times a second; what passes so near that this makes the difference is another matter."""
    plan = planned_still(motion=motion)
    times, ways = walked([(13.0, 45.0), *places], speed_m_s, 0.1)
    assume(len(times) > 1)
    depths = []
    for t, place in zip(times.tolist(), ways, strict=True):
        k, here = k_at(plan.spec, t), shapely.Point(place)
        depths.append(k.exterior.distance(here) * (1.0 if k.contains(here) else -1.0))
    assume(abs(max(depths)) > NEAR_M)
    watch = FlightMonitor(plan)
    for t, (x, y) in zip(times.tolist(), ways.tolist(), strict=True):
        watch.report(Stage.FLY, 100.0 + t, (x, y))
    violations = watch.monitor.violations
    assert bool(violations) is (max(depths) > 0.0)
    if violations:
        (first, *_) = violations
        assert (first.kind, first.names) == (ViolationKind.ENTERED_RESTRICTED, ("K",))
        entered_s = float(times[np.array(depths) > 0.0][0])
        assert abs(first.time_s - 100.0 - entered_s) <= 0.25
        assert k_at(plan.spec, first.time_s - 100.0).exterior.distance(shapely.Point(first.position_m)) < NEAR_M


@tried(8)
@given(st.lists(PLACES, min_size=1, max_size=3, unique=True), MOTIONS)
def test_bounds_in_seconds_and_words_are_of_where_the_region_is(places: list[tuple[float, float]], motion: str) -> None:
    plan = planned_still("'F[0,30] K & F G home'", motion, "survey")
    times, ways = walked([(13.0, 45.0), *places, (72.0, 40.0)], 6.0, 0.1)
    inside = [bool(k_at(plan.spec, t).contains(shapely.Point(way))) for t, way in zip(times, ways, strict=True)]
    met_s = times[inside]
    assume(not len(met_s) or abs(met_s[0] - 30.0) > 0.5)
    lengths = [shapely.Point(way).distance(k_at(plan.spec, t).exterior) for t, way in zip(times, ways, strict=True)]
    assume(len(met_s) or min(lengths) > NEAR_M)
    assume(not len(met_s) or max(d for d, within in zip(lengths, inside, strict=True) if within) > NEAR_M)
    watch = FlightMonitor(plan)
    for t, (x, y) in zip(times.tolist(), ways.tolist(), strict=True):
        watch.report(Stage.FLY, t, (x, y))
    (bound,) = watch.monitor.bounds
    soon = len(met_s) and met_s[0] < 30.0
    assert bound.met is (True if soon else False if times[-1] > 30.0 else None)
    assert any("K" in letter for letter in watch.monitor.word) is bool(len(met_s))


def test_before_the_trajectory_begins_all_stands_where_it_begins_and_afterwards_it_goes_on() -> None:
    plan = planned_still()
    watch = FlightMonitor(plan)
    beside, inside = (72.0, 32.0), (72.0, 20.0)
    watch.report(Stage.CLIMB, 10.0, beside)
    watch.report(Stage.SETTLE, 60.0, beside)
    assert not watch.monitor.violations
    watch.report(Stage.FLY, 61.0, beside)
    assert watch.monitor.meeting(shapely.Point(inside)).size
    assert plan.restricted[watch.monitor.meeting(shapely.Point(inside))].all()
    watch.report(Stage.LAND, 64.0, beside)  # where it comes in the end
    (violation,) = watch.monitor.violations
    assert 62.5 < violation.time_s < 64.0
    watch = FlightMonitor(plan)
    watch.report(Stage.CLIMB, 10.0, inside)
    (violation,) = watch.monitor.violations
    assert violation.position_m == inside
    assert K.contains(shapely.Point(inside))


def test_what_is_clear_is_of_where_the_region_is_now() -> None:
    legs = FlightLegs(planned_still())
    for t in (0.0, 10.0, 25.0):
        legs.report(Stage.FLY, t, (13.0, 45.0))
        assert legs.now.is_clear((72.0, 20.0)) is (t > 0.0)
        assert legs.now.is_clear((72.0, 60.0)) is (t < 20.0)
