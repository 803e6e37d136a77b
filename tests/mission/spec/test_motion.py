"""Regions and nodes that move: how they are written, how their mesh goes along, and what is wrong with them."""

import json
import math

import numpy as np
import pytest

from mission.errors import SpecError
from mission.geometry.moving import MovingPartition
from mission.spec.document import document_of
from mission.spec.domain import build_domain
from mission.spec.loader import parse_mission
from mission.spec.model import MissionSpec
from mission.spec.moving import displacement_m, moving_of
from tests.support.drifting_missions import drifting, drifting_text, moved_nodes


def moving(spec: MissionSpec) -> MovingPartition:
    found = moving_of(spec, *build_domain(spec))
    assert found is not None
    return found


@pytest.mark.parametrize(
    ("motion", "times", "offsets"),
    [
        ("{velocity_m_s: [0, 2], until_s: 20}", [0, 5, 20, 30], [(0, 0), (0, 10), (0, 40), (0, 40)]),
        ("{velocity_m_s: [1, -0.5], from_s: 4, until_s: 8}", [0, 4, 6, 9], [(0, 0), (0, 0), (2, -1), (4, -2)]),
        ("{waypoints: [[0, 0, 0], [10, 5, 0], [20, 5, 5]]}", [5, 10, 15, 99], [(2.5, 0), (5, 0), (5, 2.5), (5, 5)]),
        ("{waypoints: [[10, 5, 0]]}", [5, 10, 11], [(2.5, 0), (5, 0), (5, 0)]),
    ],
)
def test_a_region_moves_as_it_says(motion: str, times: list[float], offsets: list[tuple[float, float]]) -> None:
    spec = drifting(motion=motion)
    (region,) = (each for each in spec.regions if each.motion is not None)
    assert region.motion is not None
    assert np.abs(displacement_m(region.motion, np.array(times)) - offsets).max() < 1e-12
    assert parse_mission(json.dumps(document_of(spec)).encode()) == spec
    assert spec.moves


def test_the_vertices_of_a_region_go_with_it_and_those_of_others_stay() -> None:
    spec = drifting()
    partition, labelling = build_domain(spec)
    flown = moving(spec)
    for name, offset in (("K", (0.0, 24.0)), ("S1", (0.0, 0.0)), ("home", (0.0, 0.0))):
        own = partition.triangles[labelling.triangles_of(name)]
        assert np.abs(flown.vertices_at(12.0)[own] - partition.vertices_m[own] - offset).max() < 1e-12
    assert flown.first_flat() is None


def test_a_smooth_motion_has_no_kinks_and_does_not_overshoot() -> None:
    spec = drifting(motion="{waypoints: [[0, 0, 0], [10, 10, 0], [20, 10, 10]], smooth: true}")
    (motion,) = (each.motion for each in spec.regions if each.motion is not None)
    times = np.linspace(0.0, 20.0, 2001)
    places = displacement_m(motion, times)
    turns = np.diff(np.diff(places, axis=0) / np.diff(times)[:, None], axis=0)
    assert np.abs(turns).max() < 0.5  # of 1.5 m/s: without smoothing it has 1 there
    assert places.min() >= 0.0
    assert places.max() < 10.0 + 1e-9


def test_nodes_move_with_their_triangles() -> None:
    flown = moving(moved_nodes())
    assert np.abs(flown.vertices_at(20.0)[4] - (10.0, 10.0)).max() < 1e-12
    assert np.flatnonzero(flown.moves).tolist() == [4, 5]  # the other inner one goes along


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (drifting_text(motion="{velocity_m_s: [0, 2]}"), "velocity_m_s.*until_s"),
        (drifting_text(motion="{velocity_m_s: [0, 2], from_s: 9, until_s: 5}"), "from 9 s until 5 s"),
        (drifting_text(motion="{waypoints: [[4, 0, 0], [4, 1, 1]]}"), "do not ascend"),
        (drifting_text(motion="{waypoints: [[0, 1, 0], [4, 1, 1]]}"), "would have to jump"),
        (drifting_text(motion="{waypoints: [[4, 1, 1]], until_s: 9}"), "until_s"),
        (drifting_text(motion="{velocity_m_s: [0, -2], until_s: 20}"), "folds, or is flatter than 1%"),
        (drifting_text(motion="{velocity_m_s: [-3, 1], until_s: 20}"), "folds, or is flatter than 1%"),
        (drifting_text(more="active_s: [3, 9]"), "is there for a time only, and moves"),
        (drifting_text(kind="survey", more="cover: {spacing_m: 3}"), "is covered lane by lane, and moves"),
        (drifting_text(formula="X S1"), "X counts triangles"),
        (drifting_text().replace("speed_m_s: 4", "replan: true, speed_m_s: 4"), "nothing is planned anew in flight"),
        (f"{drifting_text()}battery: {{current_a: 14.5}}", "a return in time is planned in flight"),
    ],
)
def test_what_cannot_be_is_refused_in_one_line_each(text: str, message: str) -> None:
    with pytest.raises(SpecError, match=message):
        parse_mission(text.encode())


@pytest.mark.parametrize(
    ("nodes", "motion", "message"),
    [
        ("[7]", "velocity_m_s: [0.1, 0], until_s: 9", "there is no node 7"),
        ("[0]", "velocity_m_s: [0.1, 0], until_s: 9", "on the boundary of the domain, which stays"),
        ("[4]", "velocity_m_s: [1, 0], until_s: 20", r"after \d+\.\d s the triangle .* \(nodes .*\) at first folds"),
    ],
)
def test_nodes_that_cannot_move_so_are_refused(nodes: str, motion: str, message: str) -> None:
    with pytest.raises(SpecError, match=message):
        moved_nodes(nodes, motion)


def test_regions_that_touch_move_together_or_not_at_all() -> None:
    touching = "Near: {kind: area, polygon: [[80, 12], [90, 12], [90, 28], [80, 28]]%s}\nmission:"
    text = drifting_text()
    with pytest.raises(SpecError, match="a corner of a region that stays"):
        parse_mission(text.replace("mission:", "  " + touching % "").encode())
    with pytest.raises(SpecError, match="two motions move the point"):
        parse_mission(
            text.replace("mission:", "  " + touching % ", motion: {velocity_m_s: [1, 0], until_s: 9}").encode()
        )
    together = parse_mission(
        text.replace("mission:", "  " + touching % ", motion: {velocity_m_s: [0, 2], until_s: 20}").encode()
    )
    assert math.isclose(moving(together).last_s, 20.0)


def test_by_the_field_a_battery_may_be_said_for_nothing_is_planned_in_flight() -> None:
    text = drifting_text().replace("speed_m_s: 4", "guidance: field, speed_m_s: 4")
    assert parse_mission(f"{text}battery: {{current_a: 14.5}}".encode()).battery is not None
