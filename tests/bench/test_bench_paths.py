"""How long paths and flights are against lower bounds that know nothing of the planner.

pytest -m bench -n 0 -s tests/bench/test_bench_paths.py
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import permutations
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import shapely
import shapely.affinity
import yaml

from mission.plan import FlightPlan, plan_mission
from mission.spec.loader import load_mission
from mission.spec.model import (
    AreaShape,
    BoundaryDomain,
    CircleShape,
    PointShape,
    PolygonShape,
    PolygonsShape,
    RegionKind,
    StripShape,
    TriangleShape,
)
from tests.bench.shortest_visits import Bound, Ground

MISSIONS = Path(__file__).parents[2] / "missions"
LONGEST, SLOWEST = 1.10, 1.20
HAIR_M = 1e-3


def orders(*names: str, last: str = "", before: tuple[tuple[str, str], ...] = ()) -> list[tuple[str, ...]]:
    """All orders of some visits in which some come before others, one of them last."""
    found = [(*order, last) if last else order for order in permutations(names)]
    return [order for order in found if all(order.index(a) < order.index(b) for a, b in before)]


ADMITTED: dict[str, list[tuple[str, ...]]] = {
    "survey": orders("S1", "S2", "S3", "home", before=(("S1", "S2"), ("S2", "home"))),
    "delivery": [("depot", "clinic", "farm", "base")],
    "inspection": orders("tank", "roof", last="pad"),
    "paper": [("S1", "R")],
    "pairs": [("field", "depot", "field", "depot", "home")],
    "response": [("well", "lab", "pond", "lab"), ("pond", "lab", "well", "lab")],
    "tasks_delivery": [("depot", "clinic", "farm", "base")],
    "tasks_soft": orders("barn", "mast", last="home"),
    "yard": orders("gate", "tank", "crane", "stock", last="office", before=(("gate", "crane"),)),
}
"""What each mission asks to be visited, read from its formula or tasks by a person."""

AS_THE_PAPER_HAS_IT = frozenset({"paper"})
"""Flown by fields in triangles and a Fourier series, over middles of triangles: longer than it need be."""


def shape(region: dict[str, Any], nodes: Sequence[tuple[float, float]] = ()) -> shapely.Geometry:
    if "triangle" in region:
        return shapely.Polygon([nodes[number] for number in region["triangle"]])
    if "line" in region:
        return shapely.LineString(region["line"]).buffer(0.5 * region["width_m"], cap_style="flat", join_style="mitre")
    parts = region.get("polygons", [region])
    return shapely.union_all([shapely.Polygon(part["polygon"], part.get("holes")) for part in parts])


def ground_of(name: str, tube_m: float) -> tuple[Ground, dict[str, Any]]:
    data = yaml.safe_load((MISSIONS / f"{name}.yaml").read_text())
    nodes = data["domain"].get("nodes", ())
    obstacles = [shape(region, nodes) for region in data["regions"].values() if region["kind"] == "restricted"]
    boundary = data["domain"].get("boundary")
    if nodes:
        field = shapely.convex_hull(shapely.MultiPoint(nodes))
    else:
        field = shape(boundary if isinstance(boundary, dict) else {"polygon": boundary})
    # Without any clearance a path could slip through where what is restricted touches the boundary.
    return Ground(field, obstacles, max(tube_m, HAIR_M), apart_m=0.5), data


def bounds(name: str, plan: FlightPlan) -> Iterator[Bound]:
    ground, data = ground_of(name, plan.spec.flight.tube_m)
    nodes = data["domain"].get("nodes", ())
    rims = {
        key: ground.rim(shape(region, nodes))
        for key, region in data["regions"].items()
        if region["kind"] != "restricted"
    }
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
        over += [name] * ((ratios[0] > LONGEST or ratios[1] > SLOWEST) and name not in AS_THE_PAPER_HAS_IT)
        print(
            f"{name:<16}{length:9.2f}{plan.curve.length_m:9.2f}{ratios[0]:7.3f}"
            f"{duration:9.2f}{plan.trajectory.duration_s:9.2f}{ratios[1]:7.3f}"
        )
    assert not over


COVERING: dict[str, tuple[str, ...]] = {
    "farm": ("field", "pad"),
    "orchard": ("rows", "shed"),
    "park": ("meadow", "stage", "car_park"),
    "power_line": ("north", "south", "yard"),
}
"""What missions with lanes ask to be visited or covered, the last of it last."""


def outline(region: AreaShape | TriangleShape | PointShape) -> shapely.Geometry:
    """A region as it is drawn."""
    match region:
        case CircleShape():
            return shapely.Point(region.centre_m).buffer(region.radius_m)
        case StripShape():
            line = shapely.LineString(region.line_m)
            return line.buffer(0.5 * region.width_m, cap_style="flat", join_style="mitre")
        case PolygonsShape():
            return shapely.MultiPolygon([shapely.Polygon(part.corners_m, part.holes_m) for part in region.parts])
        case PolygonShape():
            return shapely.Polygon(region.corners_m, region.holes_m)
    raise ValueError("no outline is drawn")


@dataclass(frozen=True)
class Lanes:
    """What covering takes, without the ways to it.

    Attributes:
        length_m: Of lanes, and from one to the next.
        turns: As often the vehicle turns back.
    """

    length_m: float
    turns: int


def demanded(part: shapely.Polygon, spacing_m: float, share: float) -> Lanes:
    """A bound for any path that covers: by area, and from one end to the other.

    A path of length L has no more than L w + pi w^2 / 4 within w / 2 of it, w being how far lanes are apart.
    """
    swept_m = (share * part.area - np.pi * (0.5 * spacing_m) ** 2) / spacing_m
    corners = shapely.get_coordinates(part)
    across_m = float(np.linalg.norm(corners[:, None] - corners[None], axis=2).max())
    length_m = max(swept_m, across_m - spacing_m)
    return Lanes(length_m, max(0, int(np.ceil(length_m / across_m)) - 1))


def in_one_heading(part: shapely.Polygon, spacing_m: float, tube_m: float) -> Lanes:
    """The shortest whole lanes of one heading, and the steps aside between them; by brute force.

    They begin and end where the tube does not stick out, and the outer ones are half a spacing inside at most.
    """
    best = Lanes(np.inf, 0)
    for heading in np.arange(0.0, 180.0, 2.0):
        turned = shapely.affinity.rotate(part, heading, origin=(0.0, 0.0))
        left, low, right, high = turned.bounds
        count = int(np.ceil((high - low) / spacing_m))
        slack_m, numbers = count * spacing_m - (high - low), np.arange(count)
        # Evenly; or a whole spacing apart, the outer ones well inside.
        tried = [low + (numbers + 0.5) * (high - low) / count]
        asides_m = np.linspace(max(0.0, slack_m - 0.4 * spacing_m), min(slack_m, 0.4 * spacing_m), 9)
        tried += [low + (numbers + 0.5) * spacing_m - aside_m for aside_m in asides_m if slack_m <= 0.8 * spacing_m]
        for heights in tried:
            rows = shapely.linestrings([[(left - 1.0, y), (right + 1.0, y)] for y in heights])
            cuts = shapely.get_parts(shapely.intersection(rows, turned))
            lanes_m = np.maximum(shapely.length(cuts) - 2.0 * tube_m, 0.0).sum()
            length_m = float(lanes_m + max(0.0, np.ptp(heights) - 2.0 * tube_m * (count - 1)))
            if length_m < best.length_m:
                best = Lanes(length_m, len(cuts) - 1)
    return best


@dataclass(frozen=True)
class Covering:
    """What a mission with lanes takes at least, and in lanes of one heading for each part."""

    ways_m: float
    least: Lanes
    headed: Lanes


def covering(name: str, plan: FlightPlan) -> Covering:
    """Ways are counted from one part, with half a spacing all round, to the other, in whatever order."""
    tube_m, domain = plan.spec.flight.tube_m, plan.spec.domain
    assert isinstance(domain, BoundaryDomain)
    shapes = {r.name: outline(r.shape) for r in plan.spec.regions}
    restricted = [shapes[r.name] for r in plan.spec.regions if r.kind is RegionKind.RESTRICTED]
    ground = Ground(outline(domain.boundary), restricted, tube_m, apart_m=2.0)
    covers = {cover.region: cover for cover in plan.covers}
    least, headed, places = [], [], [np.array([plan.start_m])]
    for visited in COVERING[name]:
        cover = covers.get(visited)
        for part in shapely.get_parts(shapes[visited]):
            around = shapely.buffer(part, 0.5 * cover.spacing_m if cover else -tube_m)
            points = shapely.get_coordinates(shapely.segmentize(around.exterior, 2.0))
            places.append(points[shapely.covers(ground.free, shapely.points(points))])
            if cover:
                least.append(demanded(part, cover.spacing_m, cover.planned_share))
                in_lanes = in_one_heading(part, cover.spacing_m, tube_m)
                headed.append(max(in_lanes, least[-1], key=lambda lanes: lanes.length_m))
    sums = (Lanes(sum(each.length_m for each in of), sum(each.turns for each in of)) for of in (least, headed))
    return Covering(ground.connection_m(places), *sums)


@pytest.mark.bench
@pytest.mark.timeout(600)
def test_lanes_against_their_bounds() -> None:
    """Against a bound for any path that covers, and against lanes of one heading; who turns back loses v / a."""
    print(f"\n{'mission':<11}{'ways m':>7}{'':>11}{'lanes m':>8}{'curve m':>9}{'ratio':>7}", end="")
    print(f"{'at least s':>11}{'flight s':>9}{'ratio':>7}")
    for name, visits in COVERING.items():
        plan = plan_mission(load_mission(MISSIONS / f"{name}.yaml"))
        found, flight, limits = covering(name, plan), plan.spec.flight, plan.spec.limits
        speed = min(flight.speed_m_s, limits.speed_m_s)
        holds = [region.loiter_s for region in plan.spec.regions if region.name in visits and region.loiter_s > 0.0]
        for what, lanes in (("at least", found.least), ("one heading", found.headed)):
            length = lanes.length_m + found.ways_m
            rests = 1 + lanes.turns + len(holds)
            duration = length / speed + rests * speed / limits.acceleration_m_s2 + sum(holds)
            ratios = plan.curve.length_m / length, plan.trajectory.duration_s / duration
            print(
                f"{name:<11}{found.ways_m:7.1f}{what:>12}{lanes.length_m:7.1f}{plan.curve.length_m:9.1f}{ratios[0]:7.3f}"
                f"{duration:11.1f}{plan.trajectory.duration_s:9.1f}{ratios[1]:7.3f}"
            )
            assert what != "at least" or min(ratios) >= 1.0


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
