"""Drafts are planned before they are written: guesses give way, and what keeps a mission is said in it."""

import re

import numpy as np
import pytest
import yaml

from mission.draft.cameras import agrees, camera_keys
from mission.draft.trials import Trial, draft_that_plans
from mission.interchange.features import Camera, Drawing, Feature, Lanes, Point, Polygon, Role, Spot
from tests.support.usual_cases import sampled


def square(west: float, south: float, side: float) -> tuple[Point, ...]:
    return ((west, south), (west + side, south), (west + side, south + side), (west, south + side))


def tried(*features: Feature, route: tuple[Point, ...] = ()) -> Trial:
    return draft_that_plans([("drawn", Drawing("GeoJSON", features, in_degrees=False, route=route))], "drawn")


def field(shape: Polygon, lanes: Lanes | None = None) -> Feature:
    return Feature("field", (shape,), Role.SURVEY, lanes=lanes)


_EAST: tuple[Point, ...] = ((0, 0), (60, 0), (60, 40), (30.6, 60), (30.6, 80), (60, 100), (60, 140))
HOURGLASS = Polygon((*_EAST, (0, 140), (0, 100), (29.4, 80), (29.4, 60), (0, 40)))
"""Two fields and a neck 1.2 m wide between them, with what is forbidden on both sides of it."""

WALLS = [
    Feature("west", (Polygon(((-30, 41), (0, 41), (29.4, 61), (29.4, 79), (0, 99), (-30, 99))),), Role.RESTRICTED),
    Feature("east", (Polygon(((90, 41), (60, 41), (30.6, 61), (30.6, 79), (60, 99), (90, 99))),), Role.RESTRICTED),
]


def test_a_narrower_tube_is_guessed_where_the_usual_one_does_not_fit() -> None:
    fence = Feature("fence", (Polygon(((-5, -5), (65, -5), (65, 145), (-5, 145))),), Role.BOUNDARY)
    home = Feature("home", (Spot((30, 20), 6.0),), Role.HOME)
    trial = tried(fence, home, field(HOURGLASS), *WALLS)
    assert trial.plan is not None
    assert 0.0 < trial.plan.spec.flight.disturbance_m_s2 <= 0.2
    assert "# The proof allows for a disturbance of " in trial.draft.text
    assert re.search("Otherwise: .*field cannot be covered", " ".join(trial.draft.text.replace("# ", " ").split()))
    assert trial.plan.covers


def test_what_keeps_a_mission_is_in_its_first_lines() -> None:
    # Its lanes are the file's own, so that nothing is left to guess.
    fence = Feature("fence", (Polygon(((-5, -5), (65, -5), (65, 145), (-5, 145))),), Role.BOUNDARY)
    home = Feature("home", (Spot((30, 20), 6.0),), Role.HOME)
    wall = Feature("wall", (Polygon(((-30, 45), (90, 45), (90, 47), (-30, 47))),), Role.RESTRICTED)
    trial = tried(fence, home, field(HOURGLASS, Lanes(10.0)), wall)
    assert trial.plan is None
    assert trial.error is not None
    top = trial.draft.text.split("name:")[0].replace("\n# ", " ")
    assert f"It does not plan as it is: {str(trial.error).splitlines()[0]}" in " ".join(top.split())


@sampled(("side_m", "spacing_m"), [(100.0, 10.0), (1_000.0, 25.0), (4_000.0, 100.0)], [(100.0, 10.0), (1_000.0, 25.0)])
def test_lanes_are_as_far_apart_as_a_large_field_asks(side_m: float, spacing_m: float) -> None:
    trial = tried(field(Polygon(square(0, 0, side_m))))
    assert trial.plan is not None
    (visit,) = trial.plan.covers
    assert visit.spacing_m == spacing_m
    assert len(visit.lanes_m) <= 45


def test_few_waypoints_are_visited_in_their_order_and_many_are_no_region() -> None:
    route = ((0.0, 0.0), (60.0, 0.0), (60.0, 40.0), (0.0, 3.0))
    trial = tried(route=route)
    assert trial.plan is not None
    regions = {region.name: region for region in trial.plan.spec.regions}
    assert list(regions) == ["home", "waypoint_1", "waypoint_2", "waypoint_3", "waypoint_4"]
    # The nearest two are 3 m apart, and no circle reaches the other's.
    assert {region.shape.radius_m for region in list(regions.values())[1:]} == {1.2}  # type: ignore[union-attr]
    assert trial.plan.spec.formula == ("F (waypoint_1 & F (waypoint_2 & F (waypoint_3 & F (waypoint_4 & F G home))))")
    assert not any(region.cover for region in regions.values())
    many = tuple((float(x), float(np.sin(x))) for x in range(30))
    trial = tried(route=many)
    assert trial.plan is not None
    assert [region.name for region in trial.plan.spec.regions] == ["home"]
    assert "the route of 30 waypoints is left out: a way is no region" in trial.draft.text
    trial = tried(field(Polygon(square(0, 0, 40))), route=route)
    assert list(yaml.safe_load(trial.draft.text)["regions"]) == ["home", "field"]


@pytest.mark.parametrize(
    ("camera", "spacing_m", "fits"),
    [
        (Camera(None, (13.2, 8.8), 8.8, 0.75, 0.7), 13.5, True),  # 30 m high: 45 m wide, 30 % of it
        (Camera(None, (13.2, 8.8), 8.8, 0.75, 0.7), 20.0, False),
        (Camera((90.0, 60.0), sidelap=0.5), 30.0, True),
        (Camera((190.0, 60.0), sidelap=0.5), None, False),
        (Camera(None, (13.2, 8.8)), None, False),
    ],
)
def test_a_camera_is_kept_where_its_lanes_are_the_files(camera: Camera, spacing_m: float | None, fits: bool) -> None:  # noqa: FBT001 - a row of the table
    assert agrees(camera, spacing_m, 30.0) is fits
    if fits and spacing_m is not None:
        trial = tried(field(Polygon(square(0, 0, 100)), Lanes(spacing_m, 20.0, camera)))
        assert f"cover: {{camera: {camera_keys(camera)}, heading_deg: 20}}" in " ".join(trial.draft.text.split())
        assert trial.plan is not None
        assert trial.plan.covers[0].spacing_m == pytest.approx(spacing_m)
