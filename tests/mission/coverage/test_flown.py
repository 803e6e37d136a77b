"""What a flight has covered, beside areas known by hand."""

import numpy as np
import pytest
import shapely

from mission.coverage.flown import ARC_ERROR, covered_share, on_lanes, swath, uncovered

REGION = shapely.box(0.0, 0.0, 100.0, 40.0)
LANES = np.array([[[-5.0, 5.0], [105.0, 5.0]], [[105.0, 15.0], [-5.0, 15.0]]])


def along(*corners: tuple[float, float], step_m: float = 0.5) -> np.ndarray:
    found: np.ndarray = shapely.get_coordinates(shapely.segmentize(shapely.LineString(corners), step_m))
    return found


def test_two_of_four_lanes_cover_a_half() -> None:
    flown = along((-5.0, 5.0), (105.0, 5.0), (105.0, 15.0), (-5.0, 15.0))
    band = swath(flown, np.linspace(0.0, 60.0, len(flown)), spacing_m=10.0, longest_gap_s=1.0)
    assert covered_share(REGION, band) == pytest.approx(0.5, abs=5.0 * ARC_ERROR * 100.0 / REGION.area)
    assert uncovered(REGION, band).bounds == pytest.approx((0.0, 20.0, 100.0, 40.0), abs=0.01)


def test_ends_are_round() -> None:
    band = swath(np.array([[50.0, 20.0], [60.0, 20.0]]), np.array([0.0, 1.0]), spacing_m=10.0, longest_gap_s=2.0)
    assert covered_share(REGION, band) * REGION.area == pytest.approx(100.0 + 25.0 * np.pi, rel=2.0 * ARC_ERROR)


def test_a_gap_in_time_is_not_joined() -> None:
    flown, times = np.array([[20.0, 20.0], [80.0, 20.0]]), np.array([0.0, 3.0])
    joined, apart = (swath(flown, times, spacing_m=10.0, longest_gap_s=gap) for gap in (3.0, 2.9))
    assert covered_share(REGION, joined) * REGION.area == pytest.approx(600.0 + 25.0 * np.pi, rel=2.0 * ARC_ERROR)
    assert covered_share(REGION, apart) * REGION.area == pytest.approx(50.0 * np.pi, rel=2.0 * ARC_ERROR)


def test_only_what_counts_is_counted() -> None:
    flown = along((0.0, 5.0), (100.0, 5.0), (100.0, 35.0), (0.0, 35.0))
    counts = on_lanes(flown, LANES, 1.0)
    assert counts[0]
    assert not counts[-1]
    band = swath(flown, np.linspace(0.0, 60.0, len(flown)), spacing_m=10.0, longest_gap_s=1.0, counts=counts)
    assert covered_share(REGION, band) == pytest.approx(0.25, abs=0.02)
    assert not band.intersects(shapely.Point(50.0, 35.0))


def test_nothing_flown_covers_nothing() -> None:
    band = swath(np.empty((0, 2)), np.empty(0), spacing_m=10.0, longest_gap_s=1.0)
    assert covered_share(REGION, band) == 0.0
    assert uncovered(REGION, band).equals(REGION)
