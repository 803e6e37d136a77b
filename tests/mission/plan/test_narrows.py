"""What clearances close is named, with the largest clearances that leave it open: one centimetre more does not."""

import re

import numpy as np
import pytest

from mission.errors import NoPlanError
from mission.geometry.location import Locator
from mission.plan import formula_of, plan_mission
from mission.planning.product import Product
from mission.planning.recurrence import has_runs
from mission.planning.transition_system import TransitionSystem
from mission.spec.domain import build_domain, restricted_triangles
from mission.spec.loader import parse_mission
from mission.spec.model import MissionSpec
from mission.spec.specification import deterministic_of

SITE = """\
domain:
  boundary: [[0, 0], [80, 0], [80, 40], [0, 40]]
  mesh: {smallest_angle_deg: %g}
  %s
regions:
  home: {kind: home, polygon: [[2, 12], [12, 12], [12, 28], [2, 28]]}
  field: {kind: survey, polygon: [[66, 12], [76, 12], [76, 28], [66, 28]]%s}
  %s
mission: {formula: %s}
start: {position_m: [7, 20]}
"""
SOUTH = "south: {kind: restricted, polygon: [[25, -2], [35, -2], [30.5, %g], [29.5, %g]]%s}"
NORTH = "north: {kind: restricted, polygon: [[29.5, %g], [30.5, %g], [35, 42], [25, 42]]%s}"
WALLS = f"{SOUTH % (15.0, 15.0, '')}\n  {NORTH % (22.5, 22.5, '')}"
VALUE = re.compile(r"([\w.]+): ([\d.]+)")


def site(
    clearances: str, regions: str, *, formula: str = "F field", field: str = "", angle_deg: float = 1.0
) -> MissionSpec:
    tube = "" if "flight:" in regions else "flight: {disturbance_m_s2: 0}\n"
    return parse_mission((SITE % (angle_deg, clearances, field, regions, formula) + tube).encode())


def said(spec: MissionSpec) -> tuple[str, ...]:
    with pytest.raises(NoPlanError) as refused:
        plan_mission(spec)
    assert refused.value.cause == "clearance"
    head, *lines = str(refused.value).splitlines()
    assert head == "there is a plan without clearances, but not with these:"
    return tuple(line.strip() for line in lines)


def is_open(spec: MissionSpec) -> bool:
    """Whether the mission has a run."""
    partition, labelling = build_domain(spec)
    system = TransitionSystem.from_partition(partition, labelling, restricted_triangles(spec, labelling))
    automaton = deterministic_of(formula_of(spec), None, labelling.letters)
    start = int(Locator(partition).triangle_at(np.array([spec.start.position_m]))[0])
    return has_runs(Product(system, automaton, start, spec.semantics))


def values(line: str) -> dict[str, float]:
    """The clearances that a line names, by the last two steps of their keys."""
    named = line.partition("; with ")[2].partition(" at most")[0]
    return {key.removeprefix("domain.").removeprefix("regions."): float(value) for key, value in VALUE.findall(named)}


def test_the_passage_between_two_regions_and_the_clearance_that_leaves_it_open() -> None:
    (line,) = said(site("restricted_clearance_m: 5", WALLS))
    assert line.startswith("south and north are 7.5 m apart near (30, 18.8)")
    assert line.endswith("instead of 5, it is open")
    most = values(line)["restricted_clearance_m"]
    assert 3.72 <= most <= 3.75
    for angle_deg in (1.0, 20.0):
        assert is_open(site(f"restricted_clearance_m: {most}", WALLS, angle_deg=angle_deg))
        assert not is_open(site(f"restricted_clearance_m: {most + 0.01:.2f}", WALLS, angle_deg=angle_deg))


def test_two_regions_with_clearances_of_their_own_are_taken_back_together() -> None:
    walls = f"{SOUTH % (15.0, 15.0, ', clearance_m: %s')}\n  {NORTH % (22.5, 22.5, ', clearance_m: %s')}"
    (line,) = said(site("clearance_m: 1", walls % (8, 4)))
    most = values(line)
    assert set(most) == {"south.clearance_m", "north.clearance_m"}
    assert most["south.clearance_m"] == pytest.approx(2.0 * most["north.clearance_m"], abs=0.02)
    assert 7.45 <= sum(most.values()) <= 7.5
    assert is_open(site("clearance_m: 1", walls % tuple(most.values())))
    assert not is_open(site("clearance_m: 1", walls % tuple(value + 0.01 for value in most.values())))


def test_the_passage_along_the_boundary() -> None:
    wall = SOUTH % (33.0, 33.0, "")
    (line,) = said(site("clearance_m: 3\n  restricted_clearance_m: 6", wall))
    assert line.startswith(
        ("south and the boundary are 7 m apart near (3", "the boundary and south are 7 m apart near (3")
    )
    most = values(line)
    assert 6.95 <= sum(most.values()) <= 7.0
    keys = "clearance_m: %g\n  restricted_clearance_m: %g"
    assert is_open(site(keys % (most["clearance_m"], most["restricted_clearance_m"]), wall))
    assert not is_open(site(keys % (most["clearance_m"] + 0.01, most["restricted_clearance_m"] + 0.01), wall))


def test_a_passage_through_one_region_of_two_parts() -> None:
    gate = (
        "wall: {kind: restricted, polygons: [{polygon: [[25, -2], [35, -2], [30.5, 16], [29.5, 16]]}, "
        "{polygon: [[29.5, 22], [30.5, 22], [35, 42], [25, 42]]}]}"
    )
    (line,) = said(site("restricted_clearance_m: 4", gate))
    assert line.startswith("two sides of wall are 6 m apart near (3")
    most = values(line)["restricted_clearance_m"]
    assert is_open(site(f"restricted_clearance_m: {most}", gate))
    assert not is_open(site(f"restricted_clearance_m: {most + 0.01:.2f}", gate))


def test_a_passage_between_corners_that_are_rounded() -> None:
    corners = (
        "south: {kind: restricted, polygon: [[20, -2], [36, -2], [29, 17], [20, 17]]}\n  "
        "north: {kind: restricted, polygon: [[34, 20], [40, 20], [40, 42], [24, 42]]}"
    )
    (line,) = said(site("restricted_clearance_m: 6", corners))
    most = values(line)["restricted_clearance_m"]
    assert 2.75 < most < 2.93  # half the distance of the corners, and 3.6 % less where they face each other
    assert is_open(site(f"restricted_clearance_m: {most}", corners))
    assert not is_open(site(f"restricted_clearance_m: {most + 0.01:.2f}", corners))


def test_passages_that_are_both_needed_are_both_named() -> None:
    second = (
        "east: {kind: restricted, polygon: [[48, -2], [55, -2], [52, 36], [51, 36]], clearance_m: 5}\n  "
        + SOUTH % (15.0, 15.0, ", clearance_m: 4")
        + "\n  "
        + NORTH % (22.5, 22.5, ", clearance_m: 4")
    )
    lines = said(site("restricted_clearance_m: 0", second))
    assert {key for line in lines for key in values(line)} == {
        "south.clearance_m",
        "north.clearance_m",
        "east.clearance_m",
    }


def test_a_region_that_is_taken_away_is_named_with_what_takes_it() -> None:
    beside = "pond: {kind: restricted, centre: [72, 20], radius_m: 4}"
    (line,) = said(site("restricted_clearance_m: 9", beside))
    assert line.startswith("nothing is left of field outside of pond's clearance; with ")
    most = values(line)["restricted_clearance_m"]
    assert is_open(site(f"restricted_clearance_m: {most}", beside))
    assert not is_open(site(f"restricted_clearance_m: {most + 0.01:.2f}", beside))
    (line,) = said(site("clearance_m: 1", SOUTH % (9.0, 9.0, ""), field=", clearance_m: 7"))
    assert line.startswith(
        "nothing is left of field outside of its own clearance; with regions.field.clearance_m: 4.99"
    )


def test_clearances_are_not_blamed_where_another_way_is_open_or_there_is_none_anyway() -> None:
    around = WALLS.replace("-2", "9")
    assert is_open(site("restricted_clearance_m: 4", around))
    assert is_open(site("restricted_clearance_m: 5", WALLS, formula="G home"))
    with pytest.raises(NoPlanError) as refused:
        plan_mission(site("restricted_clearance_m: 5", WALLS, formula="F field & G !field"))
    assert refused.value.cause == "themselves"


TUBE = "\nflight: {disturbance_m_s2: 0.5}"


def test_with_the_clearance_that_is_advised_there_is_room_for_the_tube() -> None:
    """Half of 7.5 m, less the square root of 2 times half a metre."""
    for asked in ("5", "3.5"):  # the first closes the passage, the second leaves half a metre
        with pytest.raises(NoPlanError) as refused:
            plan_mission(site(f"restricted_clearance_m: {asked}", WALLS + TUBE))
        head, line, tube = str(refused.value).splitlines()
        assert head == "there is a plan without clearances, but not with these beside the tube:"
        assert line.strip().startswith("south and north are 7.5 m apart near (30, 18.8)")
        assert line.endswith(f"instead of {asked}, it is open to the tube")
        assert tube.strip() == "the tube of the proof takes up to 0.707 m on each side of the path"
        most = values(line.strip())["restricted_clearance_m"]
        assert 3.02 <= most <= 3.05
    assert not plan_mission(site(f"restricted_clearance_m: {most}", WALLS + TUBE)).instead


def test_a_passage_that_is_too_narrow_for_the_tube_is_named_with_its_width() -> None:
    walls = f"{SOUTH % (18.0, 18.0, '')}\n  {NORTH % (18.9, 18.9, '')}{TUBE}"
    for clearance, beside in (("clearance_m: 0", ""), ("clearance_m: 1", " beside the clearances")):
        with pytest.raises(NoPlanError) as refused:
            plan_mission(site(clearance, walls))
        head, line, _ = str(refused.value).splitlines()
        assert head == "there is a plan without a tube, but not with this one of 0.5 m per axis:"
        assert line.strip().startswith("south and north are 0.9 m apart near (30, 18.4); a tube of 0.3")
        assert line.endswith(f"surely has room there{beside}")
    narrow = walls.replace("disturbance_m_s2: 0.5", "disturbance_m_s2: 0.3")
    assert plan_mission(site("clearance_m: 0", narrow)).certificate.holds


def test_a_clearance_that_closes_what_is_too_narrow_for_the_tube_anyway() -> None:
    walls = f"{SOUTH % (18.0, 18.0, '')}\n  {NORTH % (18.9, 18.9, '')}{TUBE}"
    passage, tube = said(site("restricted_clearance_m: 1", walls))
    assert passage.startswith("south and north are 0.9 m apart near (30, 18.4); with ")
    assert passage.endswith("domain.restricted_clearance_m: 0.44 at most, instead of 1, it is open")
    assert tube == "the tube of the proof needs up to 0.707 m more on each side of the path"


def test_a_start_beside_the_rim_of_a_region_is_no_passage() -> None:
    """The tube reaches out of the region that the flight must begin in, and nothing else is in the way."""
    text = (SITE % (1.0, "clearance_m: 0", "", WALLS + TUBE, "home & F field")).replace("[7, 20]", "[11.9, 20]")
    with pytest.raises(NoPlanError) as refused:
        plan_mission(parse_mission(text.encode()))
    assert "there is a plan without" not in str(refused.value)
