"""Tracking errors, and how long they have been too large."""

import math

import pytest

from mission.monitor.tracking import TrackingWatch


def test_the_error_is_the_larger_one_of_both_axes() -> None:
    watch = TrackingWatch(0.5)
    watch.observe(0.0, (1.0, 2.0), (1.2, 1.7))
    assert watch.error_m == pytest.approx(0.3)
    watch.observe(1.0, (1.0, 2.0), (1.1, 2.0))
    assert watch.error_m == pytest.approx(0.1)
    assert watch.largest_m == pytest.approx(0.3)


def test_excess_counts_from_the_first_report_outside_without_a_break() -> None:
    watch = TrackingWatch(0.5)
    flown = [(0.0, 0.4, 0.0), (1.0, 0.6, 0.0), (2.5, 0.7, 1.5), (3.0, 0.5, 0.0), (4.0, 0.8, 0.0), (4.5, 0.8, 0.5)]
    for t_s, error_m, excess_s in flown:
        watch.observe(t_s, (error_m, 0.0), (0.0, 0.0))
        assert watch.excess_s == pytest.approx(excess_s)


def test_the_largest_error_of_the_velocity_is_kept() -> None:
    watch = TrackingWatch(0.5)
    watch.observe_velocity((1.0, 2.0), (1.3, 2.1))
    watch.observe_velocity((1.0, 2.0), (1.0, 1.9))
    assert watch.largest_m_s == pytest.approx(0.3)
    watch.observe_velocity((math.nan, 2.0), (1.0, 1.9))
    assert watch.largest_m_s == math.inf


def test_a_position_that_is_no_number_is_an_endless_error() -> None:
    watch = TrackingWatch(0.5)
    watch.observe(0.0, (math.nan, 0.0), (0.0, 0.0))
    watch.observe(3.0, (math.nan, 0.0), (0.0, 0.0))
    assert watch.error_m == math.inf
    assert watch.excess_s == pytest.approx(3.0)
