"""What turns cost, against closed forms, and against the law by which they are flown."""

from dataclasses import replace

import numpy as np
import pytest

from mission.coverage.pace import Pace
from mission.steering.grid import Limits
from mission.steering.rounded import RoundedPolyline
from mission.steering.timing import time_law

PACE = Pace(speed_m_s=5.0, acceleration_m_s2=2.5, jerk_m_s3=np.inf, reach_m=4.0)
STRAIGHT = np.array([[0.0, 0.0], [100.0, 0.0]])
BENT = np.array([[0.0, 0.0], [50.0, 0.0], [50.0, 50.0]])


def test_without_corners_the_profile_is_the_textbooks() -> None:
    assert PACE.duration_s(STRAIGHT) == pytest.approx(100.0 / 5.0 + 5.0 / 2.5)
    assert replace(PACE, jerk_m_s3=4.0).duration_s(STRAIGHT) == pytest.approx(100.0 / 5.0 + 5.0 / 2.5 + 2.5 / 4.0)
    assert PACE.duration_s(np.array([[0.0, 0.0], [1.0, 0.0]])) == pytest.approx(2.0 * np.sqrt(1.0 / 2.5))
    assert PACE.duration_s(STRAIGHT[:1]) == 0.0


def test_turning_back_means_to_be_slow_and_by_length_turns_cost_nothing() -> None:
    back = np.concatenate((STRAIGHT, STRAIGHT[:1]))
    assert PACE.duration_s(STRAIGHT) + 100.0 / 5.0 < PACE.duration_s(back) < 2.0 * PACE.duration_s(STRAIGHT)
    by_length = replace(PACE, acceleration_m_s2=np.inf)
    assert by_length.duration_s(np.concatenate((BENT, BENT[::-1]))) == pytest.approx(200.0 / 5.0)
    assert PACE.duration_s(BENT) > replace(PACE, reach_m=25.0).duration_s(BENT) > PACE.duration_s(STRAIGHT) - 1e-6
    assert PACE.duration_s(BENT, np.array([1.0])) == pytest.approx(replace(PACE, reach_m=1.0).duration_s(BENT))


@pytest.mark.parametrize("speed_m_s", [5.0, 8.0])
@pytest.mark.parametrize("aside_m", [2.1, 8.4, 20.0])
@pytest.mark.parametrize("ahead", [0.0, 0.5, 2.0])
def test_a_turn_between_lanes_is_flown_in_about_that_time(speed_m_s: float, aside_m: float, ahead: float) -> None:
    off_m = ahead * aside_m / 2.0
    places = np.array([[0.0, 0.0], [60.0 - off_m, 0.0], [60.0 + off_m, aside_m], [0.0, aside_m]])
    pace, reaches = Pace(speed_m_s, 2.5, 4.0, aside_m / 3.0), np.full(2, aside_m / 3.0)
    law = time_law(RoundedPolyline(places, reaches, speed_m_s), Limits(speed_m_s, 2.5, 4.0), fastest=1.0)
    beside_s = 120.0 / speed_m_s + speed_m_s / 2.5 + 2.5 / 4.0
    assert pace.duration_s(places) - beside_s == pytest.approx(law.duration_s - beside_s, rel=0.05)
    steps = np.diff(places, axis=0)
    units = steps / np.hypot(*steps.T)[:, None]
    cosines = (units[:-1] * units[1:]).sum(axis=1)
    link = pace.link_s(np.hypot(*steps[1:2].T), cosines[:1], cosines[1:])
    assert link[0] == pytest.approx(pace.duration_s(places) - beside_s, abs=1e-6)


def test_ways_from_rest_and_from_nowhere() -> None:
    pace = replace(PACE, jerk_m_s3=4.0)
    none = np.full(1, np.nan)
    assert pace.link_s(np.full(1, 100.0), none, none)[0] == pytest.approx(pace.duration_s(STRAIGHT))
    straight_on = pace.link_s(np.full(1, 10.0), np.ones(1), np.ones(1))[0]
    assert straight_on == pytest.approx(10.0 / 5.0)
    assert np.isinf(pace.link_s(np.full(1, np.inf), np.zeros(1), np.zeros(1))[0])
    # Lanes that meet have one corner.
    assert pace.link_s(np.zeros(1), np.ones(1), np.zeros(1))[0] > 0.5
