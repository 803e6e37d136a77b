"""How long paths and flights are against lower bounds that know nothing of the planner.

pytest -m bench -n 0 -s tests/bench/test_bench_paths.py
"""

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import permutations
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import shapely
import yaml

from mission.plan import FlightPlan, plan_mission
from mission.spec.loader import load_mission
from mission.spec.model import (
    AreaShape,
    BoundaryDomain,
    CircleShape,
    Cost,
    MissionSpec,
    PointShape,
    PolygonShape,
    PolygonsShape,
    RegionKind,
    StripShape,
    TriangleShape,
)
from tests.bench.lane_orders import Least, in_lanes
from tests.bench.least_turns import Pace
from tests.bench.shortest_visits import Bound, Ground
from tests.bench.whole_lanes import Visit, rows_of

MISSIONS = Path(__file__).parents[2] / "missions"
LONGEST, SLOWEST = 1.10, 1.20
G_M_S2 = 9.80665
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

COVERED_IN: dict[str, list[tuple[str, ...]]] = {
    "farm": [("field", "pad")],
    "orchard": [("rows", "shed")],
    "park": orders("meadow", "stage", last="car_park"),
    "power_line": [("north", "south", "yard")],
}
"""The orders that their formulas admit."""


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


@dataclass(frozen=True)
class Covering:
    """What a mission with lanes takes at least.

    Attributes:
        any_m: Whatever path covers.
        any_turns: As often it turns back.
        shortest: In whole lanes of one heading for each part.
        fastest: Likewise; of other lanes, perhaps, than those that are shortest.
    """

    any_m: float
    any_turns: int
    shortest: Least
    fastest: Least


def covering(name: str, plan: FlightPlan) -> Covering:
    """For any path, ways are counted from one part, with half a spacing all round, to the other, in whatever order."""
    tube_m, domain = plan.spec.flight.tube_m, plan.spec.domain
    assert isinstance(domain, BoundaryDomain)
    shapes = {r.name: outline(r.shape) for r in plan.spec.regions}
    kept_m = domain.restricted_clearance_m
    restricted = [
        shapely.buffer(shapes[r.name], kept_m if r.clearance_m is None else r.clearance_m)
        for r in plan.spec.regions
        if r.kind is RegionKind.RESTRICTED
    ]
    ground = Ground(outline(domain.boundary), restricted, tube_m, apart_m=2.0)
    covers = {cover.region: cover for cover in plan.covers}
    loiters_s = {r.name: r.loiter_s for r in plan.spec.regions}
    least, places, visits = [], [np.array([plan.start_m])], {}
    for visited in COVERING[name]:
        cover = covers.get(visited)
        parts = shapely.get_parts(shapely.difference(shapes[visited], shapely.union_all(restricted)))
        for part in parts:
            around = shapely.buffer(part, 0.5 * cover.spacing_m if cover else -tube_m)
            points = shapely.get_coordinates(shapely.segmentize(around.exterior, 2.0))
            places.append(points[shapely.covers(ground.free, shapely.points(points))])
            if cover:
                least.append(demanded(part, cover.spacing_m, cover.share))
        visits[visited] = (
            Visit(np.empty((0, 2)), [[*rows_of(part, cover.spacing_m, tube_m, cover.share)] for part in parts])
            if cover
            else Visit(ground.rim(shapes[visited]), rest_s=loiters_s[visited])
        )
    start_m, orders = np.array(plan.start_m), [[visits[each] for each in order] for order in COVERED_IN[name]]
    found = [[in_lanes(ground, start_m, order, pace) for order in orders] for pace in (Pace(), pace_of(plan.spec))]
    return Covering(
        sum(lanes.length_m for lanes in least) + ground.connection_m(places),
        sum(lanes.turns for lanes in least),
        *(min(flights, key=lambda flight: flight.cost) for flights in found),
    )


def pace_of(spec: MissionSpec) -> Pace:
    """What a mission's limits leave: a vehicle in level flight that leans by an angle has g tan of it."""
    limits = spec.limits
    leaning_m_s2 = G_M_S2 * math.tan(limits.tilt_rad)
    speed_m_s = min(spec.flight.speed_m_s, limits.speed_m_s)
    return Pace(speed_m_s, min(limits.acceleration_m_s2, leaning_m_s2), limits.jerk_m_s3)


def planned(name: str, cost: Cost | None = None) -> FlightPlan:
    """A mission's plan, as its file has it or by a cost of its own."""
    spec = load_mission(MISSIONS / f"{name}.yaml")
    return plan_mission(spec if cost is None else replace(spec, search=replace(spec.search, cost=cost)))


def spent_s(plan: FlightPlan) -> tuple[float, float, float]:
    """What a plan spends in lanes, between those of a visit, and elsewhere."""
    (leg,) = plan.trajectory.legs
    times = [leg.law.time_at(cover.lanes_s.ravel()) for cover in plan.covers]
    in_lanes_s = float(sum(np.diff(each.reshape(-1, 2), axis=1).sum() for each in times))
    between_s = float(sum(each[-1] - each[0] for each in times)) - in_lanes_s
    return in_lanes_s, between_s, plan.trajectory.duration_s - in_lanes_s - between_s


def spent_at_least_s(least: Least, speed_m_s: float) -> tuple[float, float, float]:
    """The same of a bound, where what is lost on a lane counts for the turn."""
    lanes_s = float(sum(np.linalg.norm(np.diff(lanes, axis=1), axis=-1).sum() for lanes in least.lanes_m)) / speed_m_s
    return lanes_s, least.between, least.cost - lanes_s - least.between


@pytest.mark.bench
@pytest.mark.timeout(1200)
def test_lanes_against_their_bounds() -> None:
    """Against a bound for any path that covers, by area, and against whole lanes.

    Who turns back on any path loses v / a. The plan as the file has it, the shortest and the fastest one.
    """
    print(f"\n{'mission':<11}{'plan':>12}{'':>8}{'by area':>9}{'ratio':>7}{'in lanes':>9}{'ratio':>7}", end="")
    print(f"{'':>10}{'lanes s':>8}{'between':>8}{'else':>7}")
    for name, visits in COVERING.items():
        plan = planned(name)
        found, pace = covering(name, plan), pace_of(plan.spec)
        holds = [region.loiter_s for region in plan.spec.regions if region.name in visits and region.loiter_s > 0.0]
        rests = 1 + found.any_turns + len(holds)
        any_s = found.any_m / pace.speed_m_s + rests * pace.speed_m_s / pace.acceleration_m_s2 + sum(holds)
        spent = spent_at_least_s(found.fastest, pace.speed_m_s)
        print(f"{name:<11}{'at least':>12}{'':>50}{spent[0]:8.1f}{spent[1]:8.1f}{spent[2]:7.1f}")
        for by in (None, Cost.DISTANCE, Cost.TIME):
            flown = plan if by is None else planned(name, by)
            spent = spent_s(flown)
            for what, value, least in (
                ("m", flown.curve.length_m, (found.any_m, found.shortest.cost)),
                ("s", flown.trajectory.duration_s, (any_s, found.fastest.cost)),
            ):
                called = "as it is" if by is None else f"by {by}"
                figures = "".join(f"{bound:9.1f}{value / bound:7.3f}" for bound in least)
                shares = f"{spent[0]:18.1f}{spent[1]:8.1f}{spent[2]:7.1f}" if what == "s" else ""
                print(f"{name:<11}{called:>12}{value:7.1f}{what}{figures}{shares}")
                assert value >= least[0]


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
