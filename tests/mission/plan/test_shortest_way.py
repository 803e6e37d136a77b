"""Runs of least length: against brute force on visibility graphs, on meshes of any fineness, and proved."""

from dataclasses import replace
from itertools import permutations, product
from pathlib import Path

import numpy as np
import pytest
import shapely

from mission.errors import SpecError
from mission.plan import plan_from_json, plan_mission, plan_to_json
from mission.spec.loader import load_mission, parse_mission
from mission.spec.model import BoundaryDomain, Cost, Refinement, Search
from tests.support.small_missions import ROUNDS, plan_of
from tests.support.usual_cases import sampled
from tests.support.ways import DrawnMap, found, taut_of

MISSIONS = Path(__file__).parents[3] / "missions"
_NEAR = 1.015
"""Ways over crossing points are longer than shortest ones by less than this factor."""


FIELD = DrawnMap(
    shapely.Polygon(
        [(71, 0), (54, 4), (16, 33), (10, 51), (4, 77), (0, 91), (0, 98), (4, 99), (21, 99), (95, 111), (105, 81),
         (88, 76), (90, 71), (57, 63), (66, 24), (118, 35), (117, 41), (130, 45), (135, 9), (107, 3), (105, 12),
         (81, 8)]
    ),
    (),
    (shapely.box(20, 80, 28, 86), shapely.box(88, 96, 94, 102), shapely.box(120, 16, 126, 22),
     shapely.box(18, 50, 24, 56)),
    (64.0, 12.0),
)  # fmt: skip
"""A field that was ploughed around two yards, to the metre."""

FARM = DrawnMap(
    shapely.box(-20, -20, 160, 130),
    (
        shapely.box(60, 68, 98, 105),
        shapely.Polygon([(-20, 64), (40, 66), (40, 70), (-20, 68)]),
        shapely.Polygon([(142, -20), (147, -20), (150, 130), (145, 130)]),
    ),
    (
        shapely.Polygon([(3.5, 76.59), (0.34, 90.84), (4.47, 99.3), (21.36, 99.52), (40, 102.3), (44, 78)]),
        shapely.Polygon([(71.78, 0.0), (54.95, 4.45), (16.07, 33.4), (10.3, 51.32), (56.53, 58), (65.88, 24.16)]),
        shapely.box(110, 90, 120, 100),
    ),
    (100.0, 17.0),
)
"""Two fields beside a house and a power line."""


@pytest.mark.parametrize(
    "drawn", [FIELD, FARM, *map(DrawnMap.random, range(10)), *(DrawnMap.random(seed, 12, 4) for seed in range(4))]
)
def test_the_order_of_visits_is_that_of_a_shortest_way(drawn: DrawnMap) -> None:
    lengths = drawn.lengths_m()
    way = found(drawn.mission())
    least = min(lengths.values())
    assert 0.995 * least <= way.length_m <= _NEAR * least
    assert lengths[tuple(way.visits)] <= _NEAR * least


@pytest.mark.parametrize("seed", [0, 4, 7])
def test_the_order_of_visits_is_best_for_a_vehicle_with_a_tube(seed: int) -> None:
    """All of the tube comes into what is visited: ways are longer, in any order, than those that only touch it."""
    spec = DrawnMap.random(seed, 8, 3).mission()
    flight = replace(spec.flight, disturbance_m_s2=1.0, time_constant_s=1.0)

    def length_m(formula: str) -> float:
        asked = replace(spec, formula=formula, flight=flight)
        return taut_of(found(asked), asked).length_m

    orders = [f"F ({a} & F ({b} & F {c}))" for a, b, c in permutations(["p0", "p1", "p2"])]
    least = min(map(length_m, orders))
    assert length_m("F p0 & F p1 & F p2") <= _NEAR * least


@sampled(
    ("name", "cost"),
    product(["patrol", "inspection", "survey"], [Cost.DISTANCE, Cost.TIME]),
    [("patrol", Cost.TIME), ("inspection", Cost.DISTANCE), ("survey", Cost.TIME)],
)
def test_the_way_does_not_depend_on_the_mesh(name: str, cost: Cost) -> None:
    spec = replace(load_mission(MISSIONS / f"{name}.yaml"), search=Search(cost))
    assert isinstance(spec.domain, BoundaryDomain)
    meshes = [Refinement(20.0, np.inf), Refinement(25.0, 9.0), Refinement(20.0, 4.0)]
    ways = [found(replace(spec, domain=replace(spec.domain, refinement=mesh))) for mesh in meshes]
    assert len({way.partition.size for way in ways}) == len(meshes)
    first = ways[0]
    assert first.best.way is not None
    for way in ways[1:]:
        assert way.best.way is not None
        assert np.array_equal(way.best.way.prefix_m, first.best.way.prefix_m)
        assert np.array_equal(way.best.way.loop_m, first.best.way.loop_m)
        assert way.best.way_costs == first.best.way_costs
        assert way.word == first.word


def test_a_stop_that_takes_long_is_worth_a_detour_by_time_alone() -> None:
    text = """\
domain:
  boundary: [[0, 0], [60, 0], [60, 40], [0, 40]]
regions:
  slow: {kind: survey, polygon: [[28, 0], [32, 0], [32, 30], [28, 30]], loiter_s: 60}
  goal: {kind: survey, polygon: [[50, 2], [58, 2], [58, 10], [50, 10]]}
mission:
  formula: F goal
start:
  position_m: [5, 5]
flight: {speed_m_s: 2}
search: {cost: COST}
"""
    straight, around = (found(parse_mission(text.replace("COST", cost).encode())) for cost in ("distance", "time"))
    assert straight.visits == ["slow", "goal"]
    assert around.visits == ["goal"]
    assert straight.length_m < 1.01 * 45.0
    shortest_m = np.hypot(23.0, 25.0) + 4.0 + np.hypot(18.0, 20.0)  # over the corners of `slow`
    assert shortest_m / 2.0 < around.length_m < _NEAR * shortest_m / 2.0


def test_a_formula_that_counts_triangles_is_met_by_a_run_of_the_mesh() -> None:
    text = "home: {kind: home, polygon: [[2, 2], [18, 2], [18, 18], [2, 18]]}"
    spec = parse_mission(
        f"domain:\n  boundary: [[0, 0], [60, 0], [60, 20], [0, 20]]\nregions:\n  {text}\n"
        "mission:\n  formula: X X !home & F G home\nstart:\n  position_m: [30, 10]\nsearch: {cost: distance}\n".encode()
    )
    way = found(spec)
    states = way.best.runs[0].states
    assert "home" not in way.labelling.label((*states, states[-1])[2])


def test_a_plan_keeps_its_way() -> None:
    spec = replace(load_mission(MISSIONS / "survey.yaml"), search=Search(Cost.DISTANCE))
    plan = plan_mission(spec)
    again = plan_from_json(plan_to_json(plan))
    assert plan.way is not None
    assert again.way is not None
    assert np.array_equal(again.way.prefix_m, plan.way.prefix_m)
    assert again.costs == plan.costs
    assert plan.certificate.holds
    assert plan.shortest_runs == 1


def test_the_way_back_from_laps_goes_straight_home() -> None:
    mesh = "  mesh: {largest_m: 3}\nregions:\n"
    plan = plan_of(ROUNDS.replace("regions:\n", mesh) + "smoothing: {frequencies: auto}\n")
    assert plan.way is not None
    assert plan.homeward is not None
    back = shapely.shortest_line(shapely.Point(plan.way.loop_m[-1]), plan.area_of("home"))
    assert not shapely.intersects(back, plan.area_of("pond"))
    run = plan.homeward.run
    off = shapely.distance(shapely.polygons(plan.partition.corners_m[list(run.states)]), back)
    assert off.max() < 0.75
    assert "home" in plan.labelling.label(run.suffix[0])


def test_there_is_room_for_the_tube_beside_what_the_formula_forbids() -> None:
    """Through a gap of 1.5 m the way is shorter; the tube is 1 m to each side."""
    text = """\
domain:
  boundary: [[0, 0], [60, 0], [60, 40], [0, 40]]
regions:
  road: {kind: area, polygon: [[28, 0], [32, 0], [32, 20], [28, 20]]}
  wall: {kind: KIND, polygon: [[28, 21.5], [32, 21.5], [32, 34], [28, 34]]}
  goal: {kind: survey, polygon: [[50, 16], [58, 16], [58, 24], [50, 24]]}
mission:
  formula: F goal & G !road & G !wall
start:
  position_m: [5, 20]
flight: {disturbance_m_s2: TUBE, time_constant_s: 1}
search: {cost: distance}
"""
    lengths = {}
    for tube in ("0.5", "1"):
        for kind in ("area", "restricted"):
            way = found(parse_mission(text.replace("TUBE", tube).replace("KIND", kind).encode()))
            lengths[tube, kind] = way.length_m
    assert lengths["0.5", "area"] == lengths["0.5", "restricted"] < 46.0
    assert lengths["1", "area"] == lengths["1", "restricted"] > 50.0


def test_by_distance_there_is_one_run_to_ask_for() -> None:
    spec = replace(load_mission(MISSIONS / "paper.yaml"), search=Search(Cost.DISTANCE))
    with pytest.raises(SpecError, match="there is no run 1 among the shortest") as refused:
        plan_mission(spec, run=1)
    (fault,) = refused.value.faults
    assert fault.hint == "by distance there is one run, number 0; by `search: {cost: transitions}` there are more"
