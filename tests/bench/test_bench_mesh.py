"""What a refined mesh costs beside one Delaunay triangulation, and how many triangles it has beside ``triangle``'s.

    python -m pytest -m bench -n 0 -s tests/bench/test_bench_mesh.py

Shewchuk's ``triangle`` (https://www.cs.cmu.edu/~quake/triangle.html) refines by the same method, one vertex after the
other. Its licence keeps it out of what is installed; where it is missing, its rows are left out.
"""

from collections.abc import Iterator
from functools import partial
from importlib import import_module
from importlib.util import find_spec

import numpy as np
import pytest
import shapely
from scipy.spatial import Delaunay

from mission.geometry.arrangement import Arrangement, arranged
from mission.geometry.refinement import refined
from mission.geometry.rings import ring_edges
from tests.support.measuring import Bar, compared, table, within

pytestmark = [pytest.mark.bench, pytest.mark.timeout(600)]

ROUNDS = 5
SIDE_M = 1000.0
SQUARE = np.array([[0.0, 0.0], [SIDE_M, 0.0], [SIDE_M, SIDE_M], [0.0, SIDE_M]])
MOST_DELAUNAYS, MOST_TRIANGLES = 4.0, 1.3


def outlines(count: int, reach_m: tuple[float, float], *, seed: int = 1) -> Arrangement:
    """So many star-shaped outlines with four to eleven corners that keep apart, in a square."""
    chance = np.random.default_rng(seed)
    rings, discs = [SQUARE], np.empty((0, 3))
    while len(rings) <= count:
        radius = chance.uniform(*reach_m)
        centre = chance.uniform(1.2 * radius, SIDE_M - 1.2 * radius, size=2)
        if (np.linalg.norm(discs[:, :2] - centre, axis=1) < discs[:, 2] + radius).any():
            continue
        discs = np.append(discs, [[*centre, radius]], axis=0)
        corners = int(chance.integers(4, 12))
        bearings = (np.arange(corners) + chance.uniform(-0.3, 0.3, corners)) * 2.0 * np.pi / corners
        reach = radius * chance.uniform(0.5, 1.0, (corners, 1))
        rings.append(centre + reach * np.stack((np.cos(bearings), np.sin(bearings)), axis=1))
    return arranged(np.concatenate([ring_edges(ring) for ring in rings]), 0.01)


def of_times() -> Iterator[Bar]:
    for what, arrangement, largest_m in (
        ("200 outlines, no edge above 6 m", outlines(200, (10.0, 30.0)), 6.0),
        ("3,600 outlines, as coarse as they allow", outlines(3600, (2.0, 6.0)), np.inf),
    ):
        mesh = partial(refined, arrangement, shapely.Polygon(SQUARE), largest_m=largest_m)
        found = mesh().partition
        # As many points as the mesh has vertices, at random: those of the mesh itself take scipy up to twice as long.
        points = np.random.default_rng(0).uniform(size=(len(found.vertices_m), 2))
        took = compared(mesh, partial(Delaunay, points), ROUNDS)
        yield within(what, took, MOST_DELAUNAYS, "one Delaunay", f"{found.size:,} triangles")


def of_triangles() -> Iterator[Bar]:
    if find_spec("triangle") is None:
        return
    triangle = import_module("triangle")
    for seed in range(1, 6):
        arrangement = outlines(200, (10.0, 30.0), seed=seed)
        drawing = {"vertices": arrangement.vertices_m, "segments": arrangement.segments}
        theirs = len(triangle.triangulate(drawing, "pq20")["triangles"])
        ours = refined(arrangement, shapely.Polygon(SQUARE)).partition.size
        ratio = ours / theirs
        what = f"triangles of 200 outlines, seed {seed}"
        yield Bar(what, f"within {MOST_TRIANGLES:g} of triangle's", f"{ratio:.3f} ({ours:,})", ratio <= MOST_TRIANGLES)


def test_every_bar_of_a_mesh_is_met() -> None:
    bars = [*of_times(), *of_triangles()]
    print(f"\n{table(bars)}")
    assert not [bar.what for bar in bars if not bar.met]
