"""How long paths and flights are against lower bounds that know nothing of the planner.

pytest -m bench -n 0 -s tests/bench/test_bench_paths.py
"""

from collections.abc import Iterator
from itertools import permutations
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import shapely
import yaml

from mission.plan import FlightPlan, plan_mission
from mission.spec.loader import load_mission
from tests.bench.shortest_visits import Bound, Ground

MISSIONS = Path(__file__).parents[2] / "missions"
LONGEST, SLOWEST = 1.10, 1.20


def orders(*names: str, last: str = "", before: tuple[tuple[str, str], ...] = ()) -> list[tuple[str, ...]]:
    """All orders of some visits in which some come before others, one of them last."""
    found = [(*order, last) if last else order for order in permutations(names)]
    return [order for order in found if all(order.index(a) < order.index(b) for a, b in before)]


ADMITTED: dict[str, list[tuple[str, ...]]] = {
    "survey": orders("S1", "S2", "S3", "home", before=(("S1", "S2"), ("S2", "home"))),
    "delivery": [("depot", "clinic", "farm", "base")],
    "inspection": orders("tank", "roof", last="pad"),
    "pairs": [("field", "depot", "field", "depot", "home")],
    "response": [("well", "lab", "pond", "lab"), ("pond", "lab", "well", "lab")],
    "tasks_delivery": [("depot", "clinic", "farm", "base")],
    "tasks_soft": orders("barn", "mast", last="home"),
    "yard": orders("gate", "tank", "crane", "stock", last="office", before=(("gate", "crane"),)),
}
"""What each mission asks to be visited, read from its formula or tasks by a person."""


def shape(region: dict[str, Any]) -> shapely.Geometry:
    if "line" in region:
        return shapely.LineString(region["line"]).buffer(0.5 * region["width_m"], cap_style="flat", join_style="mitre")
    parts = region.get("polygons", [region])
    return shapely.union_all([shapely.Polygon(part["polygon"], part.get("holes")) for part in parts])


def ground_of(name: str, tube_m: float) -> tuple[Ground, dict[str, Any]]:
    data = yaml.safe_load((MISSIONS / f"{name}.yaml").read_text())
    obstacles = [shape(region) for region in data["regions"].values() if region["kind"] == "restricted"]
    boundary = data["domain"]["boundary"]
    field = shape(boundary if isinstance(boundary, dict) else {"polygon": boundary})
    return Ground(field, obstacles, tube_m, apart_m=0.5), data


def bounds(name: str, plan: FlightPlan) -> Iterator[Bound]:
    ground, data = ground_of(name, plan.spec.flight.tube_m)
    rims = {key: ground.rim(shape(region)) for key, region in data["regions"].items() if region["kind"] != "restricted"}
    for order in ADMITTED[name]:
        yield ground.shortest(np.array(plan.start_m), order, rims)


@pytest.mark.bench
@pytest.mark.timeout(600)
def test_paths_and_flights_against_their_bounds() -> None:
    print(f"\n{'mission':<16}{'bound m':>9}{'curve m':>9}{'ratio':>7}{'bound s':>9}{'flight s':>9}{'ratio':>7}")
    over = []
    for name in ADMITTED:
        plan = plan_mission(load_mission(MISSIONS / f"{name}.yaml"))
        flight, limits = plan.spec.flight, plan.spec.limits
        found = list(bounds(name, plan))
        holds = {region.name: region.loiter_s for region in plan.spec.regions}
        speed = min(flight.speed_m_s, limits.speed_m_s)
        length = min(bound.length_m for bound in found)
        duration = min(bound.duration_s(speed, limits.acceleration_m_s2, holds) for bound in found)
        ratios = plan.curve.length_m / length, plan.trajectory.duration_s / duration
        over += [name] * (ratios[0] > LONGEST or ratios[1] > SLOWEST)
        print(
            f"{name:<16}{length:9.2f}{plan.curve.length_m:9.2f}{ratios[0]:7.3f}"
            f"{duration:9.2f}{plan.trajectory.duration_s:9.2f}{ratios[1]:7.3f}"
        )
    assert not over


@pytest.mark.bench
@pytest.mark.timeout(600)
def test_laps_against_their_bound() -> None:
    plan = plan_mission(load_mission(MISSIONS / "patrol.yaml"))
    ground, data = ground_of("patrol", plan.spec.flight.tube_m)
    rims = {key: ground.rim(shape(data["regions"][key])) for key in ("west", "north", "east")}
    bound = ground.tour(("west", "north", "east"), rims)
    assert plan.trajectory.lap is not None
    lap = plan.trajectory.legs[plan.trajectory.lap]
    fastest_s = bound.length_m / min(plan.spec.flight.speed_m_s, plan.spec.limits.speed_m_s)
    print(f"\na lap of the patrol: {lap.curve.length_m:.2f} m against {bound.length_m:.2f} m at least, ", end="")
    print(f"{lap.duration_s:.2f} s against {fastest_s:.2f} s")
    assert lap.curve.length_m <= LONGEST * bound.length_m
    assert lap.duration_s <= SLOWEST * fastest_s
