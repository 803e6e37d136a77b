"""Missions in which something moves."""

from mission.spec.loader import parse_mission
from mission.spec.model import MissionSpec

DRIFT = "{velocity_m_s: [0, 2], until_s: 20}"

_DRIFTING = """
domain:
  boundary: [[0, 0], [160, 0], [160, 90], [0, 90]]
  mesh: {largest_m: 25}
regions:
  home: {kind: home, polygon: [[6, 38], [20, 38], [20, 52], [6, 52]]}
  S1: {kind: survey, polygon: [[136, 36], [150, 36], [150, 52], [136, 52]]}
  K: {kind: %(kind)s, polygon: [[64, 12], [80, 12], [80, 28], [64, 28]], motion: %(motion)s%(more)s}
mission: {formula: %(formula)s}
start: {position_m: [13, 45]}
flight: {speed_m_s: 4, altitude_m: 20, time_constant_s: 1.0, disturbance_m_s2: 0.5}
limits: {speed_m_s: 8, acceleration_m_s2: 2.5, tilt_deg: 25}
"""

_NODES = """
domain:
  nodes: [[0, 0], [20, 0], [20, 20], [0, 20], [8, 8], [14, 9]]
  motions: [{nodes: %(nodes)s, %(motion)s}]
regions:
  A: {kind: survey, at: [4, 1]}
  B: {kind: home, at: [18, 10]}
mission: {formula: F A & F G B}
start: {position_m: [18, 9]}
flight: {speed_m_s: 1, altitude_m: 20, time_constant_s: 1.0, disturbance_m_s2: 0.01}
"""


def drifting_text(
    formula: str = "F (S1 & F G home)", motion: str = DRIFT, kind: str = "restricted", more: str = ""
) -> str:
    """The file of a mission whose region K moves, on the way from home to S1."""
    return _DRIFTING % {"formula": formula, "motion": motion, "kind": kind, "more": more and f", {more}"}


def drifting(formula: str = "F (S1 & F G home)", motion: str = DRIFT, kind: str = "restricted") -> MissionSpec:
    """That mission."""
    return parse_mission(drifting_text(formula, motion, kind).encode())


def moved_nodes(nodes: str = "[4]", motion: str = "velocity_m_s: [0.1, 0.1], until_s: 20") -> MissionSpec:
    """A mission over six nodes, of which some of the two inner ones, 4 and 5, move."""
    return parse_mission((_NODES % {"nodes": nodes, "motion": motion}).encode())
