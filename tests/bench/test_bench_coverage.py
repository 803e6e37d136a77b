"""What covering costs, and how long lanes and ways come out: fields of a hundred lanes, and a yard of houses."""

from time import process_time

import numpy as np
import pytest
import shapely

from mission.coverage.coverage import Coverage, Pace
from mission.coverage.covering import cover
from tests.support.measuring import TURNS, seconds, turn_s

PACE = Pace(speed_m_s=5.0, acceleration_m_s2=2.5)
MOST_TURNS = 24_000_000
MOST_BETWEEN = 0.25
ASIDE_M = 0.7

LOT = [(0.0, 0.0), (310.0, 25.0), (330.0, 190.0), (110.0, 240.0), (-20.0, 120.0)]
BAYS = [
    (0, 0),
    (60, 90),
    (5, 180),
    (130, 230),
    (170, 130),
    (240, 150),
    (180, 250),
    (330, 210),
    (300, 60),
    (190, 90),
    (150, 0),
]


def yard() -> shapely.Geometry:
    """Houses in rows, each turned a little, in a yard of 100 m."""
    chance = np.random.default_rng(7)
    houses = []
    for number in range(15):
        width, depth = chance.uniform(5.0, 8.0), chance.uniform(8.0, 14.0)
        row, column = divmod(number, 4)
        house = shapely.box(-width / 2.0, -depth / 2.0, width / 2.0, depth / 2.0)
        turn = np.radians(chance.uniform(-15.0, 15.0))
        frame = np.array([[np.cos(turn), -np.sin(turn)], [np.sin(turn), np.cos(turn)]])
        houses.append(
            shapely.transform(house, lambda xy, f=frame, c=column, r=row: xy @ f.T + [14 + 24 * c, 14 + 24 * r])
        )
    return shapely.difference(shapely.box(0.0, 0.0, 100.0, 100.0), shapely.union_all(houses))


FIELDS = {
    "convex, 100 lanes": (shapely.Polygon(LOT), 2.1),
    "bays, 100 lanes": (shapely.Polygon(BAYS), 2.2),
    "convex, 25 lanes": (shapely.Polygon(LOT), 8.4),
    "bays, 25 lanes": (shapely.Polygon(BAYS), 8.8),
    "yard of 15 houses": (yard(), 4.0),
}


def covered(region: shapely.Geometry, spacing_m: float) -> Coverage:
    ground = shapely.buffer(region, -ASIDE_M)
    return cover(region, ground, ground, spacing_m=spacing_m, entry_m=shapely.get_coordinates(ground)[0], pace=PACE)


@pytest.mark.bench
@pytest.mark.timeout(600)
def test_bench_coverage() -> None:
    print(
        f"\n{'field':>18} {'time':>9} {'turns':>7} {'lanes':>5} {'rims':>4} {'cells':>5} {'long':>6} {'ways':>5}   left"
    )
    for name, (region, spacing_m) in FIELDS.items():
        covered(region, spacing_m)
        begun_s = process_time()
        coverage = covered(region, spacing_m)
        took_s = process_time() - begun_s
        turns = took_s / turn_s()
        long = coverage.lanes_length_m / (region.area / spacing_m)
        ways = coverage.ways_length_m / coverage.lanes_length_m
        swath = shapely.union_all(shapely.buffer(shapely.linestrings(coverage.lanes_m), spacing_m / 2.0))
        left = shapely.difference(region, swath).area / region.area
        own = int((coverage.cell_of < 0).sum())
        print(
            f"{name:>18} {seconds(took_s):>9} {turns / TURNS:6.1f}M {len(coverage.lanes_m):5} {own:4}"
            f" {coverage.cell_of.max() + 1:5} {long:6.3f} {ways:5.3f} {left:6.2%}"
        )
        assert ways < MOST_BETWEEN
        if name == "convex, 100 lanes":
            assert turns < MOST_TURNS
        if "convex" in name:
            assert coverage.lanes_length_m < 1.03 * region.area / spacing_m + spacing_m * len(coverage.lanes_m)
