"""The gaps between setpoints, against the sorted list of them."""

import math
from itertools import pairwise

import pytest
from hypothesis import given
from hypothesis import strategies as st

from mission.monitor.cadence import NONE_SENT, Cadence, CadenceWatch, slowed_text

PERIOD_S = 0.02


@given(st.lists(st.floats(1e-3, 2.0), min_size=1, max_size=300))
def test_they_are_those_of_the_sorted_list(gaps_s: list[float]) -> None:
    watch, t_s = CadenceWatch(), 0.0
    watch.note(t_s, None)
    times = [t_s]
    for gap_s in gaps_s:
        t_s += gap_s
        times.append(t_s)
        watch.note(t_s, None)
    found = sorted(b - a for a, b in pairwise(times))
    cadence = watch.cadence
    assert cadence.setpoints == len(times)
    assert cadence.median_gap_s == found[math.ceil(0.5 * len(found)) - 1]
    assert cadence.largest_gap_s == found[-1]
    # By the definition of a quantile, which no rounding of 0.99 times their number can break.
    assert sum(gap_s <= cadence.p99_gap_s for gap_s in found) >= 0.99 * len(found) - 1e-9
    assert sum(gap_s < cadence.p99_gap_s for gap_s in found) <= 0.99 * len(found) + 1e-9


def test_what_a_trajectory_takes_longer_is_counted_but_no_pause_of_it() -> None:
    watch = CadenceWatch()
    watch.note(0.0, None)
    for tick in range(1, 101):
        watch.note(tick * PERIOD_S, 0.5 * tick * PERIOD_S)
    assert watch.cadence.slowed_s == pytest.approx(0.99)
    watch.note(100 * PERIOD_S + 3.0, 50 * PERIOD_S)
    assert watch.cadence.slowed_s == pytest.approx(0.99)
    assert watch.cadence.largest_gap_s == pytest.approx(3.0)


def test_another_trajectory_is_no_slower_one() -> None:
    watch = CadenceWatch()
    for tick in range(100):
        watch.note(tick * PERIOD_S, tick % 50 * PERIOD_S)
    assert watch.cadence.slowed_s == pytest.approx(0.0)


def test_little_is_no_word_worth() -> None:
    assert slowed_text(Cadence(slowed_s=0.4), 1.0) == ""
    assert slowed_text(Cadence(slowed_s=7.0), 0.05) == "the trajectory took 7 s longer, for the vehicle to keep up"
    assert slowed_text(Cadence(slowed_s=7.0), 1.0).endswith(", over a link that takes 1.0 s there and back")
    assert Cadence(900, 0.02, 0.021, 0.1, 0.0).text.endswith("99 % within 21 ms, the longest gap 100 ms")


def test_before_the_first_setpoint_there_is_none() -> None:
    assert CadenceWatch().cadence == NONE_SENT
