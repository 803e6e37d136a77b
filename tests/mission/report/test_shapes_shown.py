"""Holes, parts, circles and clearances on maps: outlines as they are drawn, and where their clearances end."""

from functools import cache

import numpy as np
import pytest
import shapely
from matplotlib.collections import LineCollection
from matplotlib.colors import to_hex
from matplotlib.patches import PathPatch

from mission.plan import FlightPlan, plan_from_json, plan_mission, plan_to_json
from mission.report.figures.chart import chart_of
from mission.report.figures.paths import flown_path
from mission.report.page import page
from mission.report.palette import KIND_COLOUR
from mission.report.summary import summary
from mission.spec.loader import parse_mission
from mission.spec.model import RegionKind
from tests.support.drawn_plans import record_of
from tests.support.proofs import untrue

YARD = b"""\
domain:
  boundary: {polygon: [[0, 0], [80, 0], [80, 50], [0, 50]], holes: [[[30, 20], [34, 20], [34, 30], [30, 30]]]}
  clearance_m: 1
  restricted_clearance_m: 2
regions:
  home: {kind: home, polygon: [[5, 5], [15, 5], [15, 15], [5, 15]], clearance_m: 0.5}
  rows: {kind: survey, polygons: [{polygon: [[50, 20], [70, 20], [70, 26], [50, 26]]},
    {polygon: [[50, 30], [70, 30], [70, 40], [50, 40]], holes: [[[54, 33], [58, 33], [58, 37], [54, 37]]]}]}
  pond: {kind: restricted, centre: [42, 40], radius_m: 4}
  road: {kind: restricted, line: [[40, -5], [44, 12]], width_m: 3, clearance_m: 0}
  lawn: {kind: area, polygon: [[20, 35], [30, 35], [30, 55], [20, 55]]}
mission: {formula: F rows & F lawn}
start: {position_m: [10, 10]}
flight: {disturbance_m_s2: 0.3}
smoothing: {frequencies: auto}
"""


@cache
def plan() -> FlightPlan:
    return plan_mission(parse_mission(YARD))


def test_maps_show_outlines_as_they_are_drawn_and_where_clearances_end() -> None:
    chart = chart_of(plan())
    figure = flown_path(plan(), record_of(plan()))
    axes = figure.axes[0]
    patches = {patch.get_gid(): patch for patch in axes.patches if isinstance(patch, PathPatch)}
    assert chart.shapes["rows"].area == 320.0 - 16.0
    assert chart.shapes["lawn"].area == 150.0
    assert len(patches["region:rows"].get_path().to_polygons()) == 3
    assert to_hex(patches["region:lawn"].get_edgecolor()).upper() == KIND_COLOUR[RegionKind.AREA]
    assert len(set(KIND_COLOUR.values())) == len(RegionKind)
    margins = {colour: (ground, rim) for _, colour, ground, rim in chart.margins}
    assert set(margins) == {"#000000", KIND_COLOUR[RegionKind.HOME], KIND_COLOUR[RegionKind.RESTRICTED]}
    ground, rim = margins[KIND_COLOUR[RegionKind.RESTRICTED]]
    assert shapely.distance(rim, chart.shapes["pond"]) == pytest.approx(2.0, rel=1e-3)
    assert ground.area == pytest.approx(np.pi * (36.0 - 16.0), rel=0.03)
    dashed = [each for each in axes.collections if isinstance(each, LineCollection) and each.get_gid() == "margin"]
    assert len(dashed) == 3
    assert "clearance" in [text.get_text() for legend in figure.legends for text in legend.get_texts()]


def test_the_page_says_the_clearances_and_how_near_to_the_outlines_was_flown() -> None:
    record = record_of(plan())
    numbers = summary(plan(), record)
    assert numbers["planned"]["clearances_m"] == {"boundary": 1.0, "home": 0.5, "pond": 2.0}
    assert numbers["flown"]["distance_to_restricted_m"]["pond"] > 2.0
    shown = page(plan(), record, numbers, [])
    assert "boundary 1 m, home 0.5 m, pond 2 m" in shown
    assert "to be kept: 2 m" in shown


def test_a_plan_with_such_shapes_is_read_back_and_proved_again() -> None:
    again = plan_from_json(plan_to_json(plan()))
    assert (again.spec.domain, again.spec.regions) == (plan().spec.domain, plan().spec.regions)
    assert not untrue(again)
