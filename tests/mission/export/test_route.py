"""The path on straight legs: how far off they are, where they stop, and that they fly the mission."""

from dataclasses import replace

import numpy as np
import pytest
import shapely

from mission.errors import SpecError
from mission.export.placed_plan import placed_plan
from mission.export.route import LEAST_TOLERANCE_M, route_of, usual_tolerance
from mission.export.uploads import autopilot_plan
from mission.geometry.geodesy import LatLon
from mission.interchange.autopilot_plan import Command
from mission.plan import FlightPlan
from tests.support.small_missions import ROUNDS, SMALL, plan_of
from tests.support.steered_plans import BY_FIELDS

PLACE = LatLon(47.0, 8.0)


@pytest.fixture(scope="module")
def plan() -> FlightPlan:
    return plan_of(SMALL)


@pytest.mark.parametrize("tolerance_m", [LEAST_TOLERANCE_M, 0.2, 2.0])
def test_path_and_legs_are_never_farther_apart_than_told(plan: FlightPlan, tolerance_m: float) -> None:
    route = route_of(plan, tolerance_m)
    assert route.deviation_m <= tolerance_m
    legs = shapely.LineString([waypoint.place_m for waypoint in route.once])
    path = plan.curve.position(np.linspace(0.0, plan.curve.duration_s, 50_001))
    assert shapely.distance(legs, shapely.points(path)).max() <= route.deviation_m
    between = shapely.get_coordinates(shapely.segmentize(legs, 0.05))
    assert shapely.distance(shapely.LineString(path), shapely.points(between)).max() <= route.deviation_m + 1e-3


def test_fewer_legs_are_needed_where_more_is_allowed() -> None:
    plan = plan_of(SMALL + BY_FIELDS)  # which wander
    counts = [len(route_of(plan, tolerance_m).once) for tolerance_m in (0.01, 0.1, 1.0)]
    assert counts == sorted(counts, reverse=True)
    assert counts[0] > 2 * counts[2]


def test_the_usual_tolerance_leaves_half_the_tube(plan: FlightPlan) -> None:
    assert usual_tolerance(plan) == 0.2
    narrow = replace(plan, certificate=replace(plan.certificate, tube_m=0.1))
    assert usual_tolerance(narrow) == pytest.approx(0.05)
    assert usual_tolerance(replace(plan, certificate=replace(plan.certificate, tube_m=0.0))) == 0.2


def test_the_vehicle_stops_where_the_plan_stops(plan: FlightPlan) -> None:
    ((s, seconds),) = plan.stops
    (stop,) = [waypoint for waypoint in route_of(plan, 1.0).once if waypoint.hold_s]
    assert stop.hold_s == seconds == 2.0
    assert stop.place_m == pytest.approx(tuple(plan.curve.position([s])[0]), abs=1e-9)


def test_laps_are_parts_that_close() -> None:
    plan = plan_of(ROUNDS)
    route = route_of(plan, 0.2)
    assert (len(route.parts), route.lap, route.laps) == (3, 1, 2)
    way, lap, back = route.parts
    assert way[-1].place_m == pytest.approx(lap[0].place_m, abs=1e-9)
    assert lap[0].place_m == pytest.approx(lap[-1].place_m, abs=1e-9)
    assert lap[-1].place_m == pytest.approx(back[0].place_m, abs=1e-9)


def test_legs_that_do_not_fly_the_mission_are_refused() -> None:
    """So coarse that one leg is left: from the start to the end, and nothing is visited."""
    plan = plan_of(SMALL.replace(", loiter_s: 2", ""))
    with pytest.raises(SpecError, match="within 100 m of the path do not fly the mission: the word") as refusal:
        placed_plan(plan, PLACE, 100.0)
    (fault,) = refusal.value.faults
    assert fault.path == "--tolerance"


def test_what_the_legs_spell_is_the_word_of_the_plan(plan: FlightPlan) -> None:
    placed = placed_plan(plan, PLACE, 0.2)
    assert placed.word == plan.certificate.word
    assert placed.word_text == "{home} {} {goal} {} {home}"
    assert placed.clearance_m > plan.certificate.tube_m


def test_the_vehicle_stops_where_it_would_cut_off_more_of_a_corner_than_the_tube_has_left() -> None:
    placed = placed_plan(plan_of(ROUNDS), PLACE, 0.2)
    items = [item for item in autopilot_plan(placed, "ardupilot").items if item.command is Command.WAYPOINT]
    route = placed.route
    waypoints = [waypoint for part in route.parts for waypoint in part[1:]]
    legs = np.diff([route.once[0].place_m, *(waypoint.place_m for waypoint in waypoints)], axis=0)
    ends = np.cumsum([len(part) - 1 for part in route.parts]) - 1
    for i, item in enumerate(items):
        if i in ends:
            assert item.params[0] == 1.0
            continue
        a, b = legs[i], legs[i + 1]
        turn = np.arccos(np.clip(a @ b / np.hypot(*a) / np.hypot(*b), -1.0, 1.0))
        reach = min(2.0, 0.5 * np.hypot(*a), 0.5 * np.hypot(*b))
        # An arc that touches both legs has its centre on the bisector of the corner.
        radius = reach / np.tan(0.5 * turn) if turn > 0.0 else 0.0
        cut = np.hypot(reach, radius) - radius if turn > 0.0 else 0.0
        assert item.params[0] == (1.0 if cut > 0.4 - route.deviation_m else 0.0)
    assert sum(item.params[0] for item in items) > len(ends)
