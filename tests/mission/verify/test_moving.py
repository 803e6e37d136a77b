"""Plans beside regions that move: what the checker finds is met in time, and what it does not believe."""

import json
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
import shapely
from hypothesis import given
from hypothesis import strategies as st

from mission.geometry.moving import MovingPartition
from mission.plan import plan_to_json
from mission.spec.domain import build_domain, restricted_triangles
from mission.spec.moving import moving_of
from mission.verify.plans import claims
from mission.verify.plans.motion import Law
from mission.verify.plans.moving import BESIDE_S, Leg, MovingGround, nearer_in_time, stray_in_time
from mission.verify.plans.patches import patches_of
from tests.support.drawn_cases import tried
from tests.support.drifting_missions import drifting
from tests.support.drifting_plans import drifting_plan

Change = Callable[[dict[str, Any]], None]
TURNING = "{waypoints: [[5, 0, 0], [15, 10, 14], [25, -6, 24]]}"
ACROSS = "{velocity_m_s: [0, 2], until_s: 20}"


def ground(motion: str = TURNING) -> MovingGround:
    spec = drifting(motion=motion)
    partition, labelling = build_domain(spec)
    moving = moving_of(spec, partition, labelling)
    assert moving is not None
    return MovingGround(moving, restricted_triangles(spec, labelling))


def met_at_moments(moving: MovingPartition, square: shapely.Polygon, begin_s: float, end_s: float) -> set[int]:
    found = set[int]()
    for time_s in np.linspace(begin_s, end_s, 60):
        triangles = shapely.polygons(moving.at(max(0.0, time_s)).corners_m)
        found |= set(np.flatnonzero(shapely.intersects(triangles, square)).tolist())
    return found


@given(st.floats(4.0, 156.0), st.floats(4.0, 86.0), st.floats(0.1, 3.0), st.floats(-1.0, 30.0), st.floats(0.0, 8.0))
@tried(20)
def test_what_a_square_meets_in_a_time_is_found(x: float, y: float, half: float, begin_s: float, lasts: float) -> None:
    asked, end_s = ground(), begin_s + lasts
    square = shapely.box(x - half, y - half, x + half, y + half)
    which, triangles, outside = asked.met(np.array([square]), np.array([begin_s]), np.array([end_s]))
    sure = met_at_moments(asked.moving, square, begin_s, end_s)
    assert sure <= set(triangles.tolist())
    assert not which.any()
    assert not outside[0]
    if lasts < 1e-3:
        near = met_at_moments(asked.moving, shapely.buffer(square, 0.01), begin_s, end_s)
        assert set(triangles.tolist()) <= near


def test_what_reaches_beyond_the_domain_is_told_and_what_comes_near_is_met() -> None:
    asked, at = ground(), np.zeros(2)
    shapes = shapely.box(np.array([-1.0, 70.0]), 40.0, np.array([1.0, 74.0]), 42.0)
    assert asked.met(shapes, at, at)[2].tolist() == [True, False]
    closed = np.flatnonzero(asked.restricted)
    # K is drawn up to y = 28, and is 14 m farther to the north after 15 s.
    assert not asked.near(shapes[1:], at[:1], at[:1], 11.9).any()
    assert asked.near(shapes[1:], at[:1], at[:1], 12.1).all()
    assert np.isin(closed, asked.met(shapes[1:], at[:1] + 15.0, at[:1] + 15.0)[1]).any()
    for begin_s, comes_by in ((0.0, True), (30.0, False)):
        triangles = asked.met_at(np.array([[71.0, 30.0]]), 0.5, begin_s, np.inf)[1]
        assert bool(asked.restricted[triangles].any()) == comes_by


def waiting(wait_s: float) -> Leg:
    """From (60, 40) to (70, 40) in 10 s, after a wait in the middle."""
    curve = patches_of({"kind": "bezier", "controls_m": [[[60.0, 40.0], [70.0, 40.0]]], "knots_s": [0.0, 10.0]})
    law = {"knots_t_s": [0.0, 2.5, 5.0, 5.0 + wait_s, 7.5 + wait_s, 10.0 + wait_s], "rates": [0, 2, 0, 0, 2, 0]}
    begin = Law(
        {
            **law,
            "knots_s": [0.0, 2.5, 5.0, 5.0, 7.5, 10.0],
            "growths": [0.8, 0.8, -0.8, 0.0, 0.8, -0.8],
        }
    )
    return Leg(curve, begin, 0.0, (0.0,))


def test_a_vehicle_that_waits_meets_what_comes_by_meanwhile() -> None:
    asked, knots = ground(ACROSS), np.array([0.0, 5.0, 5.0, 10.0])
    every, closed = list(range(asked.size)), set(np.flatnonzero(asked.restricted).tolist())
    free = [t for t in every if t not in closed]
    # K comes to y = 40 after 6 s, where x is 64 to 80; it has gone by after 14 s.
    assert stray_in_time(asked, [waiting(4.0)], 0.1, knots[:2] * 2.0, [every]) is None
    assert stray_in_time(asked, [waiting(0.5)], 0.1, knots, [free, free, every]) is None
    assert stray_in_time(asked, [waiting(0.5)], 0.1, knots, [every, every, free]) is not None
    for piece in (0, 1):  # a wait where pieces meet is of each of them
        sets = [free if k == piece else every for k in range(3)]
        fault = stray_in_time(asked, [waiting(4.0)], 0.1, knots, sets)
        assert fault is not None
        assert "must not be entered" in fault
    later = waiting(0.5)._replace(begun_s=(0.0, 40.0))
    assert stray_in_time(asked, [later], 0.1, knots, [free, free, free]) is not None
    assert stray_in_time(asked, [later._replace(begun_s=(40.0,))], 0.1, knots, [free, free, free]) is None


def test_a_distance_is_kept_only_where_it_is_at_all_times() -> None:
    asked, leg = ground("{velocity_m_s: [0, 0.5], until_s: 8}"), waiting(0.5)
    # K ends at y = 28 + 4, and the path is at y = 40.
    assert nearer_in_time(asked, [leg], 7.999) is None
    fault = nearer_in_time(asked, [leg], 8.1)
    assert fault is not None
    assert fault.startswith("is 8.1 m in the plan, and less near (")
    assert nearer_in_time(ground("{velocity_m_s: [0, 0.5], from_s: 11, until_s: 30}"), [leg], 11.9) is None
    assert BESIDE_S < 0.1


def told(change: Change, row: str = "") -> str | None:
    """What is wrong in a row of the table, or in any, of a plan that was changed."""
    document = json.loads(plan_to_json(drifting_plan()))
    change(document)
    return next((each.fault for each in claims(json.dumps(document)) if each.fault and row in {"", each.name}), None)


def motion(rows: list[list[float]]) -> Change:
    return lambda plan: plan["mission"]["regions"]["K"].update(motion={"waypoints": rows})


def fewer(plan: dict[str, Any]) -> None:
    """Without a triangle that is met only where it is then."""
    possible = plan["certificate"]["possible"]
    first = next(k for k, named in enumerate(possible) if 5 < k < len(possible) - 5 and len(named) > 2)
    possible[first] = possible[first][1:]


def later(plan: dict[str, Any]) -> None:
    """All of it three seconds later, after a wait where it begins."""
    (leg,) = plan["trajectory"]["legs"]
    law = leg["law"]
    law["knots_t_s"] = [0.0, 30.0, *[30.0 + t for t in law["knots_t_s"][1:]]]
    for key in ("knots_s", "rates", "growths"):
        law[key] = [law[key][0], *law[key]]


def test_a_plan_beside_what_moves_is_true() -> None:
    assert told(lambda _: None) is None


@pytest.mark.parametrize(
    ("change", "row", "words"),
    [
        (motion([[20, 0, 40]]), "figures", "m in the plan, and less near ("),
        (motion([[60, 0, 12]]), "tube", "may leave the triangles that are named near ("),
        (fewer, "tube", "may leave the triangles that are named near ("),
        (later, "tube", "may leave the triangles that are named near ("),
    ],
)
def test_what_is_not_so_in_time_is_told(change: Change, row: str, words: str) -> None:
    assert words in (told(change, row) or "")
