"""Missions in dense towns: many buildings in the way, so that all of the mesh is made by their outlines."""

import numpy as np

PLOT_M, STREET_M = 24.0, 6.0
"""How far buildings are from middle to middle, and how wide the streets between them are at least."""

MOST_PARTS = 1000
"""Of one region."""


def town(buildings_a_side: int, *, seed: int = 1) -> bytes:
    """A mission file: three places are visited in a town of so many rows of buildings, and then home.

    Each building has four to eight corners and stands, turned as it likes, on a plot of its own.
    """
    chance, side = np.random.default_rng(seed), buildings_a_side
    places = {"home": (1, 1), "north": (side // 3, side - 2), "east": (side - 2, side // 3), "middle": (side // 2,) * 2}
    plots = [(column, row) for row in range(side) for column in range(side) if (column, row) not in places.values()]
    parts = []
    for plot in plots:
        corners, turned = int(chance.integers(4, 9)), chance.uniform(0.0, 2.0 * np.pi)
        bearings = turned + (np.arange(corners) + chance.uniform(-0.3, 0.3, corners)) * 2.0 * np.pi / corners
        far = 0.5 * (PLOT_M - STREET_M) * chance.uniform(0.6, 1.0, (corners, 1))
        ring = (np.array(plot) + 0.5) * PLOT_M + far * np.stack((np.cos(bearings), np.sin(bearings)), axis=1)
        parts.append(f"      - polygon: {np.round(ring, 2).tolist()}")
    visited = []
    for name, plot in places.items():
        square = np.array(plot) * PLOT_M + [[4.0, 4.0], [20.0, 4.0], [20.0, 20.0], [4.0, 20.0]]
        visited.append(f"  {name}: {{kind: {'home' if name == 'home' else 'area'}, polygon: {square.tolist()}}}")
    whole = side * PLOT_M
    quarters = [parts[begin : begin + MOST_PARTS] for begin in range(0, len(parts), MOST_PARTS)]
    buildings = [
        line
        for number, quarter in enumerate(quarters)
        for line in (f"  quarter_{number}:", "    kind: restricted", "    polygons:", *quarter)
    ]
    lines = (
        f"name: Town of {len(parts)} buildings",
        "domain:",
        f"  boundary: [[0, 0], [{whole}, 0], [{whole}, {whole}], [0, {whole}]]",
        "regions:",
        *visited,
        *buildings,
        "mission: {formula: F (north & F (middle & F home)) & F east}",
        f"start: {{position_m: [{1.5 * PLOT_M}, {1.5 * PLOT_M}]}}",
        "flight: {speed_m_s: 8, altitude_m: 20, time_constant_s: 1.0, disturbance_m_s2: 0.5}",
        "limits: {speed_m_s: 10}",
        "",
    )
    return "\n".join(lines).encode()
