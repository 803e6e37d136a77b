"""Missions with fields to be covered, for plans and flights in tests."""

FIELD_WITH_A_BARN = """
domain:
  boundary: [[0, 0], [150, 0], [150, 100], [0, 100]]
  mesh: {}
regions:
  home: {kind: home, polygon: [[5, 5], [20, 5], [20, 20], [5, 20]]}
  field:
    kind: survey
    polygon: [[40, 20], [130, 20], [140, 90], [100, 90], [95, 60], [60, 60], [55, 90], [30, 90]]
    cover: {spacing_m: 8, heading_deg: 0}
  barn: {kind: restricted, polygon: [[70, 30], [80, 30], [80, 40], [70, 40]]}
mission: {formula: "F (field & F home) & G !barn"}
start: {position_m: [12, 12]}
flight: {disturbance_m_s2: 0.3, speed_m_s: 4}
"""

TWO_FIELDS = """
domain:
  boundary: [[0, 0], [80, 0], [80, 40], [0, 40]]
  mesh: {}
regions:
  home: {kind: home, polygon: [[34, 4], [46, 4], [46, 14], [34, 14]]}
  west: {kind: survey, polygon: [[3, 3], [23, 3], [23, 37], [3, 37]], cover: {spacing_m: 8}}
  east: {kind: survey, polygon: [[57, 3], [77, 3], [77, 37], [57, 37]], cover: {spacing_m: 8}}
mission: {formula: "G F west & G F east", laps: 2}
start: {position_m: [START]}
flight: {disturbance_m_s2: 0.1, speed_m_s: 4}
"""

SMALL_FIELD = """
domain:
  boundary: [[0, 0], [50, 0], [50, 30], [0, 30]]
  mesh: {}
regions:
  home: {kind: home, polygon: [[2, 2], [12, 2], [12, 12], [2, 12]]}
  field:
    kind: survey
    polygon: [[20, 4], [46, 4], [46, 26], [34, 26], [34, 16], [20, 16]]
    cover: {camera: {field_of_view_deg: [60, 45], overlap: 0.5, sidelap: 0.4}}
mission: {formula: F (field & F home)}
start: {position_m: [7, 7]}
flight: {disturbance_m_s2: 0.5, time_constant_s: 1, speed_m_s: 4, altitude_m: 8}
limits: {acceleration_m_s2: 2}
"""
