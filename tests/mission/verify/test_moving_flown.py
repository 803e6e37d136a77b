"""Flights among regions that move, judged from their logs: against polygons, the monitor, and logs with gaps."""

from dataclasses import replace

import numpy as np
import pytest
import shapely
from hypothesis import given
from hypothesis import strategies as st

from mission.monitor.flight import FlightMonitor
from mission.monitor.stage import Stage
from mission.spec.domain import build_domain
from mission.spec.moving import moving_of
from mission.verify.flown.judging import judged
from mission.verify.logs.telemetry import Clock
from mission.verify.logs.track import Track
from tests.support.drawn_cases import tried
from tests.support.drifting_flights import k_at, planned_still, walked
from tests.support.drifting_missions import moved_nodes
from tests.support.gaps import contradictions, kept

PLACES = st.lists(
    st.tuples(st.integers(4, 156), st.integers(4, 86)).map(lambda place: (float(place[0]), float(place[1]))),
    min_size=1,
    max_size=4,
    unique=True,
)
MOTIONS = st.sampled_from(
    (
        "{velocity_m_s: [0, 2], until_s: 20}",
        "{velocity_m_s: [1, 0.5], from_s: 5, until_s: 30}",
        "{waypoints: [[10, 0, 0], [25, 20, 10], [50, -10, 30]], smooth: true}",
    )
)
SPEED_M_S = 8.0
HOME = (13.0, 45.0)


def track_of(places: list[tuple[float, float]], step_s: float = 0.1) -> Track:
    times, ways = walked([HOME, *places, HOME], SPEED_M_S, step_s)
    return Track(100.0 + times, ways, 100.0, True, True, (), Clock.of(()), "as they are")


def apart_m(motion: str, track: Track) -> np.ndarray:
    """How far each report is from K where it is then; negative inside."""
    spec = planned_still(motion=motion).spec
    found = []
    for t, place in zip((track.t_s - 100.0).tolist(), track.position_m, strict=True):
        k, here = k_at(spec, t), shapely.Point(place)
        found.append(k.exterior.distance(here) * (-1.0 if k.contains(here) else 1.0))
    return np.array(found)


@tried(5)
@given(PLACES, MOTIONS)
def test_a_flight_is_judged_by_where_the_region_was(places: list[tuple[float, float]], motion: str) -> None:
    plan, track = planned_still(motion=motion), track_of(places)
    apart = apart_m(motion, track)
    found = judged(plan.spec, track, fastest_m_s=SPEED_M_S + 0.5)
    (near,) = found.nearness
    assert near.least_m == pytest.approx(max(apart.min(), 0.0))
    assert near.surely_m <= near.least_m
    if apart.min() < -0.01:
        assert found.achieved is False
        (first, *_) = found.violations
        assert first.names == ("K",)
        assert first.time_s <= track.t_s[apart < -0.01][0]
    elif apart.min() > 1.5:
        assert not found.violations
        assert not found.doubts
    watch = FlightMonitor(plan)
    for t_s, (east, north) in zip(track.t_s.tolist(), track.position_m.tolist(), strict=True):
        watch.report(Stage.FLY, t_s, (east, north))
    if found.achieved is not None:
        assert found.achieved is watch.monitor.verdict_at_end(stays=True).achieved


@tried(5)
@given(
    PLACES,
    MOTIONS,
    st.sampled_from(("F[0,25] K & F G home", "G !K & F G home", "F (K & F (S1 | home))")),
    st.lists(st.tuples(st.floats(0.0, 0.95), st.floats(0.0, 0.3)), min_size=1, max_size=2),
)
def test_gaps_are_gaps_and_no_guesses(
    places: list[tuple[float, float]], motion: str, formula: str, gaps: list[tuple[float, float]]
) -> None:
    spec = planned_still(f"'{formula}'", motion, "survey").spec
    whole = track_of(places)
    told = judged(spec, kept(whole, gaps), fastest_m_s=SPEED_M_S + 0.5)
    assert not contradictions(told, judged(spec, whole, fastest_m_s=SPEED_M_S + 0.5))


@pytest.mark.parametrize(
    ("places", "moves_from_s", "achieved"),
    [
        ([(150.0, 44.0)], 104.0, None),  # behind K 8.4 s after it was at home; K is on the way after 8 s
        ([(150.0, 48.0)], 104.0, True),  # there it is after 9.3 s
        ([(13.0, 80.0), (150.0, 80.0), (143.0, 44.0), (150.0, 80.0), (13.0, 80.0)], 104.0, True),
        ([(72.0, 60.0), (72.0, 61.0)] * 60, 104.0, False),
    ],
)
def test_where_a_log_does_not_tell_when_the_trajectory_began_what_depends_on_that_is_not_told(
    places: list[tuple[float, float]],
    moves_from_s: float,
    achieved: bool | None,  # noqa: FBT001 - what is expected
) -> None:
    plan = planned_still()
    track = replace(track_of(places, 0.2), moves_from_s=moves_from_s)
    found = judged(plan.spec, track, fastest_m_s=SPEED_M_S + 0.5)
    assert found.achieved is achieved, found.reason
    if achieved is None:
        assert found.reason == "what it met depends on when its trajectory began, which the log does not tell"


def test_a_log_among_nodes_that_move_is_judged_by_their_triangles() -> None:
    """A comes over who stands still."""
    spec, place = moved_nodes(), (10.0, 8.5)
    partition, labelling = build_domain(spec)
    moving = moving_of(spec, partition, labelling)
    assert moving is not None
    times = np.arange(0.0, 20.0, 0.1)
    (a,) = labelling.triangles_of("A").tolist()
    inside = [shapely.Polygon(moving.at(t).corners_m[a]).contains(shapely.Point(place)) for t in times.tolist()]
    track = Track(100.0 + times, np.tile(place, (len(times), 1)), 100.0, True, True, (), Clock.of(()), "as they are")
    first, second = judged(spec, track).word[-2:]
    assert (first.regions, second.regions) == ((), ("A",))
    assert second.t_s - 100.0 == pytest.approx(times[inside][0], abs=0.1)
