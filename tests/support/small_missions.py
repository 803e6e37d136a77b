"""Missions of half a minute, for flights in tests."""

from functools import cache

from mission.plan import FlightPlan, plan_mission
from mission.spec.loader import parse_mission

FLOWN_BRISKLY = """\
flight:
  speed_m_s: 4.0
  altitude_m: 6
  final_stay_s: 2
  time_constant_s: 1.0
  disturbance_m_s2: 0.5
limits:
  speed_m_s: 6.0
  acceleration_m_s2: 2.5
  tilt_deg: 25
"""
"""How a small mission is flown."""

SMALL = (
    """\
name: Small round
domain:
  boundary: [[0, 0], [40, 0], [40, 30], [0, 30]]
regions:
  home: {kind: home, polygon: [[4, 4], [14, 4], [14, 12], [4, 12]]}
  goal: {kind: survey, polygon: [[26, 4], [36, 4], [36, 12], [26, 12]], loiter_s: 2}
  pond: {kind: restricted, polygon: [[4, 22], [14, 22], [14, 28], [4, 28]]}
mission:
  formula: F (goal & F G home) & G !pond
start:
  position_m: [9, 8]
"""
    + FLOWN_BRISKLY
)

ROUNDS = """\
name: Small rounds
domain:
  boundary: [[0, 0], [40, 0], [40, 30], [0, 30]]
regions:
  home: {kind: home, polygon: [[4, 4], [14, 4], [14, 12], [4, 12]]}
  east: {kind: survey, polygon: [[26, 4], [36, 4], [36, 12], [26, 12]]}
  north: {kind: survey, polygon: [[26, 20], [36, 20], [36, 27], [26, 27]]}
  pond: {kind: restricted, polygon: [[4, 22], [14, 22], [14, 28], [4, 28]]}
mission:
  formula: G F east & G F north & G !pond
  laps: 2
start:
  position_m: [9, 8]
flight:
  speed_m_s: 5.0
  altitude_m: 5
  final_stay_s: 1
  time_constant_s: 1.0
  disturbance_m_s2: 0.4
limits:
  speed_m_s: 8.0
  acceleration_m_s2: 2.5
  tilt_deg: 25
"""
"""Two places again and again, from and to a third."""

PHOTOGRAPHED = (
    """\
domain:
  boundary: [[0, 0], [60, 0], [60, 40], [0, 40]]
regions:
  home: {kind: home, polygon: [[4, 4], [14, 4], [14, 12], [4, 12]], loiter_s: 1}
  field:
    kind: survey
    polygon: [[26, 6], [54, 6], [54, 34], [26, 34]]
    cover: {camera: {field_of_view_deg: [80, 60], overlap: 0.5, sidelap: 0.1}, heading_deg: 90, share: 0.9}
tasks:
  - visit: [field]
  - avoid: [field]
    weight: 1
mission:
  formula: F (field & F G home)
start:
  position_m: [9, 8]
"""
    + FLOWN_BRISKLY
)
"""A field that is photographed in lanes, and a wish that cannot be met beside it."""

CORRIDOR, FIELDS = "smoothing: corridor\n", "smoothing: {frequencies: auto}\n"
"""Either way to smooth a path, to be added to one of these missions."""


def at_a_place(latitude_deg: float, longitude_deg: float) -> str:
    """The same with the domain's (0, 0) at a place on Earth."""
    return SMALL + f"origin: {{latitude_deg: {latitude_deg}, longitude_deg: {longitude_deg}}}\n"


@cache
def plan_of(text: str) -> FlightPlan:
    """The plan of a mission file; the same one for the same text, as a plan never changes."""
    return plan_mission(parse_mission(text.encode(), "small.yaml"))
