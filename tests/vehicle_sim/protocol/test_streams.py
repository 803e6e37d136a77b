"""When messages are due: rates in whole microseconds, phases, and nothing to do while nothing is due."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from tests.support.drawn_cases import tried
from vehicle_sim.protocol.streams import NEVER_US, StreamSchedule


def run(schedule: StreamSchedule, *, from_us: int, until_us: int, step_us: int) -> list[tuple[int, int]]:
    sent = []
    for now_us in range(from_us, until_us, step_us):
        if schedule.next_due_us <= now_us:
            sent += [(now_us, message_id) for message_id in schedule.due(now_us)]
    return sent


def test_an_idle_schedule_is_never_due() -> None:
    assert StreamSchedule().next_due_us == NEVER_US


def test_fifteen_hertz_is_fifteen_hertz() -> None:
    schedule = StreamSchedule()
    schedule.start(30, round(1e6 / 15), 0)
    assert len(run(schedule, from_us=0, until_us=10_000_000, step_us=10_000)) == 150


def test_a_stream_faster_than_the_steps_is_sent_once_a_step() -> None:
    schedule = StreamSchedule()
    schedule.start(30, 1, 0)
    assert run(schedule, from_us=0, until_us=30_000, step_us=10_000) == [(0, 30), (10_000, 30), (20_000, 30)]


def test_an_equal_request_keeps_the_phase() -> None:
    schedule = StreamSchedule()
    schedule.start(30, 100_000, 0)
    assert schedule.due(0) == [30]
    schedule.start(30, 100_000, 50_000)
    assert schedule.next_due_us == 100_000
    schedule.start(30, 20_000, 60_000)
    assert schedule.next_due_us == 60_000
    assert schedule.interval_us(30) == 20_000


def test_stopping_is_idempotent() -> None:
    schedule = StreamSchedule()
    schedule.start(30, 100_000, 0)
    schedule.start(31, 200_000, 0)
    schedule.stop(30)
    schedule.stop(30)
    assert schedule.interval_us(30) is None
    assert run(schedule, from_us=0, until_us=400_000, step_us=10_000) == [(0, 31), (200_000, 31)]
    schedule.clear()
    assert schedule.next_due_us == NEVER_US


def test_an_interval_is_positive() -> None:
    with pytest.raises(ValueError, match="positive"):
        StreamSchedule().start(30, 0, 0)


@tried(60)
@given(
    st.dictionaries(st.integers(0, 20), st.integers(1_000, 2_000_000), min_size=1, max_size=8),
    st.sampled_from([2_500, 10_000, 20_000]),
)
def test_each_stream_has_its_own_rate(intervals: dict[int, int], step_us: int) -> None:
    schedule = StreamSchedule()
    for message_id, interval_us in intervals.items():
        schedule.start(message_id, interval_us, 0)
    span_us = 4_000_000
    sent = [message_id for _, message_id in run(schedule, from_us=0, until_us=span_us, step_us=step_us)]
    for message_id, interval_us in intervals.items():
        # Rounding up to the next step delays each message, but never the ones after it.
        assert abs(sent.count(message_id) - span_us / max(interval_us, step_us)) <= 1
