"""Setpoints between the points of the grid are those of the trajectory itself."""

from typing import Self

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from mission.geometry.arrays import FloatArray
from mission.link.course import Course
from tests.support.sessions import DURATION_S, Straight


class Circle:
    """A circle of 6 m at 2.1 m/s, as both autopilots were observed on."""

    duration_s = 18.0
    altitude_m = 10.0
    laps: int | None = 1
    laps_end_s = 0.0

    def first_lap_s(self, t_s: float) -> float:
        return t_s

    def ended_after(self, _t_s: float) -> Self:
        return self

    def state(self, t_s: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
        rate = 2.1 / 6.0
        angle = rate * t_s[:, None]
        out = np.concatenate((np.cos(angle), np.sin(angle)), axis=1)
        along = np.concatenate((-np.sin(angle), np.cos(angle)), axis=1)
        return 6.0 * out, 6.0 * rate * along, -6.0 * rate**2 * out


@given(st.floats(0.0, 18.0))
def test_between_the_points_of_the_grid(t_s: float) -> None:
    exact = [values[0] for values in Circle().state(np.array([t_s]))]
    reference = Course(Circle(), 0.0).reference(t_s)
    assert reference.position_m == pytest.approx((*exact[0], 10.0), abs=1e-12)
    assert reference.velocity_m_s == pytest.approx((*exact[1], 0.0), abs=1e-9)
    assert reference.acceleration_m_s2 == pytest.approx((*exact[2], 0.0), abs=1e-6)


def test_at_rest_before_the_start_and_after_the_end() -> None:
    course = Course(Straight(), 0.0)
    for t_s, place in ((-5.0, (10.0, 20.0, 5.0)), (DURATION_S, (18.0, 14.0, 5.0)), (1e6, (18.0, 14.0, 5.0))):
        reference = course.reference(t_s)
        assert reference.position_m == pytest.approx(place)
        assert reference.velocity_m_s == pytest.approx((0.0, 0.0, 0.0), abs=1e-9)
        assert reference.acceleration_m_s2 == pytest.approx((0.0, 0.0, 0.0), abs=1e-6)


def test_memory_does_not_grow_with_the_flight() -> None:
    course = Course(Circle(), 0.0)
    for t_s in np.linspace(0.0, 18.0, 500).tolist():
        course.reference(t_s)
    assert len(course._blocks) <= 4


def test_the_heading_turns_the_short_way_and_stays_while_standing() -> None:
    course = Course(Circle(), 3.0)
    reference = course.reference(0.0)  # northwards
    headings = [course.turn(reference, 0.0, 0.1 * i) for i in range(100)]
    assert headings[0] == 3.0
    assert headings == sorted(headings, reverse=True)
    assert headings[-1] == pytest.approx(0.0, abs=1e-9)
    standing = reference._replace(velocity_m_s=(0.0, 0.0, 0.0))
    assert course.turn(standing, 0.0, 60.0) == pytest.approx(0.0, abs=1e-9)


class Rounds:
    """Rounds of 10 s after a way of 5 s, on a line out and back; then 4 s the other way."""

    altitude_m = 10.0

    def __init__(self, laps: int | None) -> None:
        self.laps = laps

    @property
    def laps_end_s(self) -> float:
        return np.inf if self.laps is None else 5.0 + 10.0 * self.laps

    @property
    def duration_s(self) -> float:
        return self.laps_end_s + 4.0

    def first_lap_s(self, t_s: float) -> float:
        return t_s

    def ended_after(self, t_s: float) -> "Rounds":
        return Rounds(max(1, int((t_s - 5.0) // 10.0) + 1))

    def state(self, t_s: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
        place = np.where(t_s < self.laps_end_s, np.abs((t_s % 10.0) - 5.0), self.laps_end_s - t_s)
        return np.stack((place, 0.0 * t_s), axis=-1), np.zeros((len(t_s), 2)), np.zeros((len(t_s), 2))


@pytest.mark.parametrize(("asked_s", "laps"), [(0.0, 1), (14.9, 1), (15.1, 2), (1007.0, 101)])
def test_laps_are_ended_with_the_present_one(asked_s: float, laps: int) -> None:
    course = Course(Rounds(None), 0.0)
    assert course.duration_s == np.inf
    before = course.reference(asked_s)
    ahead = course.reference(7.0 + 10.0 * laps)
    assert course.end_laps(asked_s)
    assert course.laps == laps
    assert course.duration_s == 5.0 + 10.0 * laps + 4.0
    assert course.reference(asked_s) == before
    assert course.reference(7.0 + 10.0 * laps) != ahead  # on the way back, and not on what was looked at before
    assert not course.end_laps(course.duration_s - 1.0)
