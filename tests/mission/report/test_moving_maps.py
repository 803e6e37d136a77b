"""Maps on pages of missions in which something moves: what the script is told, and how near a flight came."""

from dataclasses import replace

import numpy as np
import pytest
import shapely

from mission.plan import plan_mission
from mission.report.figures.moments import flown_moments
from mission.report.interactive.embedding import moving_of
from mission.report.interactive.of_flight import flown_of, scene_of
from mission.report.moving import distances_at
from mission.report.summary import summary
from mission.report.tracking import nearest_to
from mission.spec.loader import parse_mission
from mission.view.drawing import figures
from mission.view.moments import Narrator
from mission.view.replaying import planned
from tests.support.drawn_plans import PAPER_TOUR, plan_of
from tests.support.drifting_flights import still
from tests.support.drifting_plans import drifting_plan, drifting_record


def test_the_places_of_what_moves_are_told_at_each_instant() -> None:
    plan = drifting_plan()
    scene = scene_of(plan, None)
    told = moving_of(scene)
    assert (told["times"][0], told["times"][-1]) == (0.0, 20.0)
    (k,) = (number for number, area in enumerate(scene.areas) if area.later)
    assert scene.areas[k].name == "K"
    begin, *_, end = told["sources"][f"area {k}"]
    assert np.allclose(np.array(end["ys"]) - np.array(begin["ys"]), 10.0)
    assert begin["xs"] == end["xs"]
    first, *_, last = told["sources"]["names"]
    assert np.subtract(last["y"], first["y"]).tolist() == [10.0 * (number == k) for number in range(len(scene.areas))]


def test_a_mission_that_stands_is_told_of_nothing_that_moves() -> None:
    plan = plan_of(PAPER_TOUR)
    assert moving_of(scene_of(plan, None)) == {}
    assert "moving" not in figures(plan)


def test_the_page_that_shows_a_flight_has_the_mesh_of_each_moment_and_its_clock() -> None:
    plan = drifting_plan()
    assert plan.moving is not None
    told = figures(plan)["moving"]
    for time_s, frame in zip(told["times"], told["sources"]["mesh"], strict=True):
        ends = np.stack([frame["x0"], frame["y0"]], axis=1)
        apart = shapely.distance(shapely.points(ends), shapely.MultiPoint(plan.moving.vertices_at(time_s)))
        assert apart.max() < 1e-3
    assert "fields of the run" not in figures(plan)["layers"]
    narrator = Narrator(plan)
    moments = [narrator.moment(progress) for progress in planned(plan)]
    assert all(moment["clock"] == pytest.approx(moment["t"], abs=0.011) for moment in moments)


def test_a_flight_is_as_near_to_what_moves_as_it_was_at_the_time() -> None:
    plan = drifting_plan()
    record = drifting_record(plan)
    ends, metres = nearest_to(plan, record)["K"]
    # K is up to y = 38 when the vehicle comes back along y = 45.
    assert metres == pytest.approx(7.0, abs=0.02)
    assert ends[1, 1] == pytest.approx(38.0, abs=0.02)
    numbers = summary(plan, record)
    assert numbers["flown"]["distance_to_restricted_m"] == {"K": metres}
    flown, timeline = flown_of(plan, record)
    assert timeline.begun_s == 12.0
    times = np.clip(flown.t_s - 12.0, 0.0, None)
    for t_s, place, near in zip(times, flown.position_m, flown.columns["nearness"], strict=True):
        k = shapely.box(64, 12 + min(10.0, 0.5 * t_s), 80, 28 + min(10.0, 0.5 * t_s))
        assert near == pytest.approx(k.distance(shapely.Point(place)), abs=1e-6)
    assert len(flown_moments(plan, record).axes) == 7


def test_triangles_of_nodes_that_move_are_measured_to_where_they_are() -> None:
    text = """
domain:
  nodes: [[0, 0], [20, 0], [20, 20], [0, 20], [8, 8], [14, 9]]
  motions: [{nodes: [4], velocity_m_s: [0.1, 0.0], until_s: 20}]
regions:
  A: {kind: restricted, at: [1, 9]}
  B: {kind: home, at: [18, 10]}
mission: {formula: F G B}
start: {position_m: [14, 3]}
flight: {speed_m_s: 1, altitude_m: 20, time_constant_s: 1.0, disturbance_m_s2: 0.01}
"""

    spec = parse_mission(text.encode())
    plan = replace(plan_mission(still(spec)), spec=spec)
    (own,) = (area for area in scene_of(plan, None).areas if area.name == "A")
    assert len(own.later) > 1
    places = np.array([[12.0, 8.0], [12.0, 8.0]])
    near = distances_at(plan, "A", own.shape, np.array([0.0, 20.0]), places)
    assert near.tolist() == pytest.approx([4.0, 2.0])
