"""The vehicle's time between its messages: never backwards, never far ahead, at whatever rate it runs."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from mission.link.vehicle_clock import AHEAD_S, VehicleClock


def test_without_a_time_stamp_there_is_no_time() -> None:
    clock = VehicleClock()
    assert clock.now_s(1.0) is None
    assert math.isinf(clock.local_until(5.0, 1.0))


@pytest.mark.parametrize("rate", [0.1, 1.0, 20.0, 100.0])
def test_it_follows_a_steady_clock_at_any_rate(rate: float) -> None:
    clock = VehicleClock()
    period_s = 0.033 / rate  # a message every 33 ms of vehicle time
    for i in range(400):
        clock.observe(round(5000 + 33 * i), 70.0 + i * period_s)
    between_s = 70.0 + 399.5 * period_s
    assert clock.rate == pytest.approx(rate, rel=0.02)
    assert clock.now_s(between_s) == pytest.approx(5.0 + 0.033 * 399.5, abs=0.005)
    wanted_s = 5.0 + 0.033 * 399.9
    assert clock.local_until(wanted_s, between_s) == pytest.approx(0.4 * period_s, rel=0.1)


def test_a_stopped_vehicle_stops_the_time() -> None:
    clock = VehicleClock()
    for i in range(50):
        clock.observe(20 * i, 0.02 * i)
    assert clock.now_s(1000.0) == pytest.approx(0.98 + AHEAD_S)
    assert math.isinf(clock.local_until(2.0, 1000.0))


def test_late_and_repeated_time_stamps_change_nothing() -> None:
    clock = VehicleClock()
    for i in range(50):
        clock.observe(1000 + 20 * i, 0.02 * i)
    before = clock.now_s(1.0)
    clock.observe(1500, 1.0)
    clock.observe(1980, 1.0)
    assert clock.now_s(1.0) == before
    assert not clock.restarted


def running(clock: VehicleClock, begin_ms: int, local_s: float, seconds: float) -> None:
    """Fifty time stamps a second."""
    for i in range(round(50 * seconds)):
        clock.observe(begin_ms + 20 * i, local_s + 0.02 * i)


def test_a_restart_is_noticed_by_what_goes_on_from_it() -> None:
    clock = VehicleClock()
    running(clock, 60_000, 0.0, 2.0)
    running(clock, 40, 3.0, 0.8)
    before = clock.restarted
    running(clock, 840, 3.8, 0.4)
    assert not before
    assert clock.restarted
    assert clock.now_s(4.2) == pytest.approx(63.2, abs=0.3)  # and the time shown goes on


@pytest.mark.parametrize("off_ms", [-3_500, -60_000, 5_000, 3_600_000])
@pytest.mark.parametrize("packets", [1, 3])
def test_time_stamps_that_nothing_goes_on_from_are_not_believed(off_ms: int, packets: int) -> None:
    clock = VehicleClock()
    running(clock, 100_000, 0.0, 2.0)
    for i in range(packets):
        assert not clock.observe(102_000 + off_ms + 20 * i, 2.0)
    running(clock, 102_020, 2.02, 2.0)
    assert not clock.restarted
    assert clock.newest_s == pytest.approx(104.0)


def test_a_block_of_late_packets_that_comes_at_once_is_no_restart() -> None:
    clock = VehicleClock()
    running(clock, 100_000, 0.0, 5.0)
    for i in range(90):
        assert not clock.observe(100_000 + 20 * i, 5.0 + 0.001 * i)
    running(clock, 105_000, 5.1, 1.0)
    assert not clock.restarted


def test_a_gap_is_time_that_has_passed() -> None:
    clock = VehicleClock()
    running(clock, 100_000, 0.0, 2.0)
    assert clock.observe(106_200, 6.2)
    assert clock.now_s(6.2) == pytest.approx(106.2)


def test_a_clock_that_was_set_is_followed_without_a_leap() -> None:
    clock = VehicleClock()
    running(clock, 100_000, 0.0, 2.0)
    running(clock, 3_702_000, 2.0, 2.0)
    assert not clock.restarted
    assert clock.newest_s == pytest.approx(103.96)
    assert clock.unwrapped_s(3_703_980) == pytest.approx(103.96)


def test_where_the_first_time_stamp_of_all_was_astray_the_others_are_followed() -> None:
    clock = VehicleClock()
    clock.observe(3_700_000, 0.0)
    running(clock, 100_000, 0.02, 3.0)
    assert not clock.restarted
    assert clock.observe(103_000, 3.02)
    assert clock.rate == pytest.approx(1.0, rel=0.02)


def test_32_bits_of_milliseconds_wrap() -> None:
    clock = VehicleClock()
    clock.observe(2**32 - 20, 0.0)
    clock.observe(20, 0.04)
    assert not clock.restarted
    assert clock.newest_s == pytest.approx((2**32 + 20) / 1000.0)
    assert clock.unwrapped_s(10) == pytest.approx((2**32 + 10) / 1000.0)


@given(
    st.lists(
        st.tuples(st.floats(0.0, 0.5), st.integers(-200, 400), st.booleans()),
        min_size=1,
        max_size=80,
    )
)
def test_never_backwards_and_never_far_ahead(moments: list[tuple[float, int, bool]]) -> None:
    clock = VehicleClock()
    local_s, stamp_ms, shown_s = 0.0, 100_000, 0.0
    for pause_s, step_ms, heard in moments:
        local_s += pause_s
        stamp_ms += step_ms
        if heard:
            clock.observe(stamp_ms, local_s)
        now_s = clock.now_s(local_s)
        if now_s is None or clock.newest_s is None:
            continue
        assert now_s >= shown_s
        assert clock.newest_s <= now_s <= clock.newest_s + AHEAD_S + 1e-9
        shown_s = now_s
        wait_s = clock.local_until(now_s + 0.01, local_s)
        if math.isfinite(wait_s):
            assert (clock.now_s(local_s + wait_s) or 0.0) >= now_s + 0.01 - 1e-6
            shown_s = clock.now_s(local_s) or 0.0
