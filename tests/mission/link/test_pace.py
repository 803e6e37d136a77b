"""The trajectory goes on more slowly where the vehicle does not keep up, never backwards and never for nothing."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from mission.link.course import Reference
from mission.link.pace import LEAST_RATE, Pace

PERIOD_S = 1.0 / 30.0
BEGAN_S = 1000.0
TUBE_M = 0.5


def east(speed_m_s: float, gained_m_s2: float = 0.0) -> Reference:
    return Reference((0.0, 0.0, 5.0), (speed_m_s, 0.0, 0.0), (gained_m_s2, 0.0, 0.0))


def begun(tube_m: float = TUBE_M) -> Pace:
    pace = Pace(tube_m)
    pace.begin(BEGAN_S)
    return pace


@given(st.lists(st.tuples(st.floats(0.0, 5.0), st.floats(0.0, 20.0)), max_size=200))
def test_time_never_runs_backwards_nor_faster_than_the_clock(errors: list[tuple[float, float]]) -> None:
    pace, before_s = begun(), 0.0
    for tick, (error_m, speed_m_s) in enumerate(errors):
        at_s = BEGAN_S + tick * PERIOD_S
        pace.adapt(at_s, error_m, 1.0, east(speed_m_s))
        after_s = pace.elapsed_s(at_s + PERIOD_S)
        assert LEAST_RATE * PERIOD_S - 1e-9 <= after_s - before_s <= PERIOD_S + 1e-9
        # What comes on top of the time law's own acceleration is bounded.
        assert abs(pace.beat(at_s).growth_per_s) * speed_m_s <= 1.0 + 1e-9
        before_s = after_s


@given(st.floats(0.0, 0.2), st.floats(0.0, 1000.0))
def test_well_inside_of_the_tube_it_keeps_its_pace_exactly(error_m: float, after_s: float) -> None:
    pace = begun()
    for tick in range(20):
        pace.adapt(BEGAN_S + tick * PERIOD_S, error_m, 1.0, east(4.0))
    assert pace.elapsed_s(BEGAN_S + after_s) == BEGAN_S + after_s - BEGAN_S


def test_without_a_tube_it_keeps_its_pace() -> None:
    pace = begun(0.0)
    pace.adapt(BEGAN_S + 1.0, 10.0, 1.0, east(4.0))
    assert pace.elapsed_s(BEGAN_S + 2.0) == 2.0


def test_it_slows_down_at_the_edge_of_the_tube_and_takes_up_its_pace_again() -> None:
    pace = begun()
    rates = []
    for tick in range(600):
        at_s = BEGAN_S + tick * PERIOD_S
        pace.adapt(at_s, TUBE_M if tick < 300 else 0.0, 1.0, east(2.0))
        rates.append(pace.beat(at_s).rate)
    assert rates[299] == pytest.approx(LEAST_RATE, abs=0.01)
    assert rates[-1] == 1.0
    assert pace.beat(BEGAN_S + 20.0).growth_per_s == 0.0


def test_it_is_no_faster_than_the_vehicle_can_fly_what_comes() -> None:
    """While the trajectory gains speed, the brake holds against that too."""
    pace, speed_m_s = begun(), 0.0
    for tick in range(150):
        speed_m_s = min(0.1 * tick, 8.0)
        pace.adapt(BEGAN_S + tick * PERIOD_S, 0.0, 1.0 if speed_m_s < 4.0 else 4.0 / speed_m_s, east(speed_m_s, 3.0))
        assert pace.beat(BEGAN_S + tick * PERIOD_S).rate * speed_m_s < 5.2
    assert pace.beat(BEGAN_S + 5.0).rate == pytest.approx(0.5, abs=0.01)


def test_a_report_of_a_moment_ago_is_about_the_pace_of_then() -> None:
    pace = begun()
    times = [BEGAN_S + tick * PERIOD_S for tick in range(90)]
    told = []
    for at_s in times:
        pace.adapt(at_s, TUBE_M, 1.0, east(4.0))
        told.append(pace.elapsed_s(at_s))
    assert [pace.elapsed_s(at_s) for at_s in times] == pytest.approx(told, abs=1e-12)


def test_before_the_start_time_is_negative() -> None:
    assert Pace(TUBE_M).elapsed_s(5.0) == -math.inf
    assert begun().elapsed_s(BEGAN_S - 3.0) == -3.0


def test_a_pause_stands_and_what_was_told_late_is_about_then() -> None:
    pace = begun()
    pace.pause(BEGAN_S + 5.0, BEGAN_S + 9.0)
    assert pace.elapsed_s(BEGAN_S + 4.0) == 4.0
    assert pace.elapsed_s(BEGAN_S + 7.0) == 5.0
    assert pace.elapsed_s(BEGAN_S + 9.5) == 5.5
