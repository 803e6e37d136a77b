"""Missions in dense towns: many buildings in the way, so that all of the mesh is made by outlines."""

from math import cos, pi, sin
from random import Random

STREET_M, PLOT_M = 6.0, 24.0


def town(buildings_a_side: int, *, seed: int = 1, streets_m: float = STREET_M) -> str:
    """A mission file: three places are visited in a town of so many rows of buildings, and then home.

    Each building has four to eight corners, stands within a plot of its own, and is turned as it likes.
    """
    chance, side = Random(seed), buildings_a_side
    whole, reach = side * PLOT_M, 0.5 * (PLOT_M - streets_m)
    squares = {"home": (1, 1), "north": (side // 3, side - 2), "east": (side - 2, side // 3), "middle": (side // 2,) * 2}
    parts = []
    for row in range(side):
        for column in range(side):
            if (column, row) in squares.values():
                continue
            x, y = (column + 0.5) * PLOT_M, (row + 0.5) * PLOT_M
            corners, turned = chance.randint(4, 8), chance.uniform(0.0, 2.0 * pi)
            ring = []
            for corner in range(corners):
                bearing = turned + (corner + chance.uniform(-0.3, 0.3)) * 2.0 * pi / corners
                far = reach * chance.uniform(0.6, 1.0)
                ring.append([round(x + far * cos(bearing), 2), round(y + far * sin(bearing), 2)])
            parts.append(f"      - polygon: {ring}")
    visited = []
    for name, (column, row) in squares.items():
        x, y = column * PLOT_M + 4.0, row * PLOT_M + 4.0
        box = [[x, y], [x + 16.0, y], [x + 16.0, y + 16.0], [x, y + 16.0]]
        visited.append(f"  {name}: {{kind: {'home' if name == 'home' else 'area'}, polygon: {box}}}")
    return "\n".join(
        (
            f"name: Town of {len(parts)} buildings",
            "domain:",
            f"  boundary: [[0, 0], [{whole}, 0], [{whole}, {whole}], [0, {whole}]]",
            "regions:",
            *visited,
            "  buildings:",
            "    kind: restricted",
            "    polygons:",
            *parts,
            "mission: {formula: F (north & F (middle & F home)) & F east & G !buildings}",
            f"start: {{position_m: [{1.5 * PLOT_M}, {1.5 * PLOT_M}]}}",
            "flight: {speed_m_s: 8, altitude_m: 20, time_constant_s: 1.0, disturbance_m_s2: 0.5}",
            "limits: {speed_m_s: 10}",
            "",
        )
    )
