"""Polylines at one speed."""

import numpy as np
import pytest

from mission.steering.polyline import Polyline

LINE = Polyline(np.array([[0.0, 0.0], [3.0, 4.0], [3.0, 4.0], [3.0, 14.0]]), 2.5, (1, 3))


def test_it_is_passed_at_its_speed() -> None:
    assert LINE.length_m == pytest.approx(15.0)
    assert LINE.duration_s == pytest.approx(6.0)
    assert LINE.lap_s == (2.0, 6.0)
    assert LINE.position([-1.0, 1.0, 4.0, 9.0]) == pytest.approx(
        np.array([[0.0, 0.0], [1.5, 2.0], [3.0, 9.0], [3.0, 14.0]])
    )
    assert LINE.velocity([1.0, 4.0, 6.0]) == pytest.approx(np.array([[1.5, 2.0], [0.0, 2.5], [0.0, 2.5]]))


def test_a_place_is_a_polyline_too() -> None:
    place = Polyline(np.array([[1.0, 2.0]]), 1.0)
    assert place.duration_s == 0.0
    assert place.position([0.0]) == pytest.approx(np.array([[1.0, 2.0]]))
    assert place.velocity([0.0]) == pytest.approx(np.zeros((1, 2)))


def test_it_comes_back_from_its_file_bit_by_bit() -> None:
    again = Polyline.from_json(LINE.to_json())
    assert np.array_equal(again.points_m, LINE.points_m)
    assert (again.speed_m_s, again.lap) == (LINE.speed_m_s, LINE.lap)


@pytest.mark.parametrize(
    ("points", "speed", "lap"),
    [([], 1.0, None), ([[0.0, np.nan]], 1.0, None), ([[0.0, 0.0]], 0.0, None), ([[0.0, 0.0], [1.0, 0.0]], 1.0, (0, 2))],
)
def test_what_is_none_is_refused(points: list[list[float]], speed: float, lap: tuple[int, int] | None) -> None:
    with pytest.raises(ValueError, match=r"polyline|speed|lap"):
        Polyline(np.array(points), speed, lap)
