"""Missions through a passage that winds between two restricted regions, at random from a seed."""

import numpy as np

TUBE_M = 0.5
"""Half the width, on each axis, of the tube that these missions are proved for."""

_MISSION = """\
name: passage
domain:
  boundary: [[0, 0], [120, 0], [120, 80], [0, 80]]
  mesh: {%s}
regions:
  field: {kind: survey, polygon: %s}
  north: {kind: restricted, polygon: %s}
  south: {kind: restricted, polygon: %s}
mission: {formula: F field}
start: {position_m: [8, %s]}
flight: {speed_m_s: 3, disturbance_m_s2: 0.5}
"""


def passage(seed: int, width_m: float, mesh: str = "") -> bytes:
    """A mission file whose only way is a passage 80 m long and so wide from south to north, with two to five bends."""
    chance = np.random.default_rng(seed)
    x = np.sort(np.concatenate(([20.0, 100.0], chance.uniform(24.0, 96.0, chance.integers(2, 6)))))
    y = np.clip(40.0 + np.cumsum(chance.uniform(-9.0, 9.0, len(x))), 15.0, 65.0)
    north, south = (np.stack((x, y + side * width_m / 2.0), axis=1).round(2).tolist() for side in (1, -1))
    around = np.array([[104.0, -4.0], [112.0, -4.0], [112.0, 4.0], [104.0, 4.0]])
    field = (around + np.array([0.0, y[-1]])).round(2).tolist()
    north += [[100, 78], [20, 78]]
    south += [[100, 2], [20, 2]]
    return (_MISSION % (mesh, field, north, south, y[0].round(2))).encode()
