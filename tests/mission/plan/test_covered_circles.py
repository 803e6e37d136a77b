"""Circles that are covered: with a restricted circle in them, clipped by the boundary, small beside the tube."""

import numpy as np
import pytest
import shapely

from mission.plan import plan_from_json, plan_to_json
from tests.support.small_missions import plan_of

CIRCLE = """\
domain:
  boundary: [[0, 0], [140, 0], [140, 100], [0, 100]]
regions:
  home: {{kind: home, polygon: [[5, 5], [20, 5], [20, 20], [5, 20]]}}
  field: {{kind: survey, centre: {centre}, radius_m: {radius}, cover: {{spacing_m: {spacing}}}{clearance}}}
  pond: {{kind: restricted, centre: [85, 45], radius_m: {pond}, clearance_m: 2}}
mission: {{formula: F field & F G home}}
start: {{position_m: [12, 12]}}
flight: {{disturbance_m_s2: {tube}, speed_m_s: 5}}
"""


@pytest.mark.parametrize(
    ("circle", "pond", "spacing", "tube", "clearance"),
    [
        ((90.0, 50.0, 40.0), 6.0, 10.0, 0.8, 0.0),
        ((90.0, 50.0, 40.0), 6.0, 10.0, 0.0, 3.0),
        ((120.0, 80.0, 40.0), 6.0, 8.0, 0.4, 0.0),  # the boundary cuts it off
        ((40.0, 60.0, 6.0), 1.0, 4.0, 0.5, 0.0),
        ((40.0, 60.0, 5.0), 1.0, 12.0, 1.0, 0.0),  # one lane is enough
    ],
)
def test_a_circle_is_covered_inside_of_it_by_the_tube(
    circle: tuple[float, float, float], pond: float, spacing: float, tube: float, clearance: float
) -> None:
    centre, radius = circle[:2], circle[2]
    kept_in = f", clearance_m: {clearance}" if clearance else ""
    plan = plan_of(
        CIRCLE.format(centre=list(centre), radius=radius, pond=pond, spacing=spacing, tube=tube, clearance=kept_in)
    )
    assert plan.certificate.holds
    (visit,) = plan.covers
    disc = shapely.Point(centre).buffer(radius - clearance, quad_segs=64)
    lanes = shapely.linestrings(visit.lanes_m)
    assert shapely.within(lanes, disc.buffer(-tube)).all()
    water = shapely.Point(85, 45).buffer(pond + 2.0, quad_segs=64)
    assert shapely.distance(lanes, water).min() > tube
    # By the exact circle, where the plan has a polygon in it, and by the flown curve's own places.
    begin_s, end_s = visit.lanes_s.min(), visit.lanes_s.max()
    curve = shapely.LineString(plan.curve.position(np.linspace(begin_s, end_s, 20_000)))
    wanted = disc.difference(water).intersection(shapely.box(0, 0, 140, 100))
    assert wanted.intersection(curve.buffer(0.5 * spacing)).area > 0.97 * wanted.area
    assert visit.planned_share >= 0.98
    again = plan_from_json(plan_to_json(plan))
    assert np.array_equal(again.covers[0].lanes_m, visit.lanes_m)
