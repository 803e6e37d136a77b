"""When vehicle time waits: timelines by two clocks of the test."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from vehicle_sim.server.patience import Patience, Source, StreamKind

SETPOINTS = Source("udp", 255, 191, StreamKind.SETPOINT)
HEARTBEATS = Source("udp", 255, 191, StreamKind.HEARTBEAT)
MOST_S = 2.0


def flowing(source: Source, gap_s: float, until_s: float, most_s: float = MOST_S) -> Patience:
    """Let messages come every `gap_s` up to `until_s`, in vehicle time."""
    patience = Patience(most_s)
    for number in range(round(until_s / gap_s) + 1):
        patience.hear(source, number * gap_s)
    return patience


def waits(patience: Patience, vehicle_s: float, now_s: float = 0.0, *, by_setpoints: bool = True) -> bool:
    return patience.waits(vehicle_s, now_s, by_setpoints=by_setpoints)


def test_nothing_is_waited_for_where_nothing_flows() -> None:
    patience = Patience(MOST_S)
    assert not waits(patience, 100.0)
    patience.hear(SETPOINTS, 100.0)
    assert not waits(patience, 200.0)


def test_an_old_setpoint_stops_vehicle_time_until_the_next_one() -> None:
    patience = flowing(SETPOINTS, 0.05, 1.0)
    assert not waits(patience, 1.14)
    assert waits(patience, 1.16, 7.0)
    assert waits(patience, 1.16, 8.0)
    patience.hear(SETPOINTS, 1.16)
    assert not waits(patience, 1.16, 8.1)
    assert patience.waited_s == pytest.approx(1.1)


def test_a_stream_that_has_ended_is_noticed_after_the_bounded_wait_and_costs_no_second_one() -> None:
    patience = flowing(SETPOINTS, 0.05, 1.0)
    assert waits(patience, 1.16, 5.0)
    assert waits(patience, 1.16, 5.0 + MOST_S - 0.01)
    assert not waits(patience, 1.16, 5.0 + MOST_S)
    assert not any(waits(patience, 1.16 + ahead, 7.0 + 0.1 * ahead) for ahead in range(100))


def test_a_stream_that_comes_again_is_waited_for_again() -> None:
    patience = flowing(SETPOINTS, 0.05, 1.0)
    assert waits(patience, 1.16, 0.0)
    assert not waits(patience, 1.16, MOST_S)
    for number in range(4):
        assert not waits(patience, 20.0 + 0.05 * number, 10.0)
        patience.hear(SETPOINTS, 20.0 + 0.05 * number)
    assert waits(patience, 20.8, 11.0)


def test_a_slower_stream_by_vehicle_time_is_learned_from_one_wait() -> None:
    """The sender looks at vehicle time, and sends only once 0.5 s of it have passed."""
    patience, vehicle_s, now_s, sent_s, stood_still = Patience(MOST_S), 0.0, 0.0, 0.0, 0
    for _ in range(20_000):
        now_s += 0.01
        if waits(patience, vehicle_s, now_s):
            stood_still += 1
            continue
        vehicle_s += 0.02
        if vehicle_s - sent_s >= 0.5:
            patience.hear(SETPOINTS, vehicle_s)
            sent_s = vehicle_s
    assert stood_still * 0.01 == pytest.approx(MOST_S, abs=0.1)


def test_setpoints_matter_while_the_vehicle_flies_by_them() -> None:
    patience = flowing(SETPOINTS, 0.05, 1.0)
    assert not waits(patience, 5.0, by_setpoints=False)
    assert waits(patience, 5.0, by_setpoints=True)


def test_heartbeats_by_vehicle_time_matter_in_any_mode() -> None:
    patience = flowing(HEARTBEATS, 1.0, 10.0)
    assert not waits(patience, 11.9, by_setpoints=False)
    assert waits(patience, 12.0, by_setpoints=False)


@pytest.mark.parametrize(("source", "gap_s"), [(HEARTBEATS, 20.0), (SETPOINTS, 10.0), (SETPOINTS, 0.0)])
def test_what_does_not_go_by_vehicle_time_is_no_stream(source: Source, gap_s: float) -> None:
    patience = Patience(MOST_S)
    for number in range(100):
        assert not waits(patience, number * gap_s)
        patience.hear(source, number * gap_s)
    assert not waits(patience, 100 * gap_s + 30.0)


def test_each_of_several_clients_is_waited_for() -> None:
    patience = flowing(SETPOINTS, 0.05, 1.0)
    other = SETPOINTS._replace(link="tcp")
    for number in range(21):
        patience.hear(other, 0.05 * number)
    patience.hear(SETPOINTS, 1.16)
    assert waits(patience, 1.16)
    patience.hear(other, 1.16)
    assert not waits(patience, 1.16)


def test_streams_of_countless_senders_cost_bounded_memory_and_the_live_one_is_kept() -> None:
    patience = flowing(SETPOINTS, 0.05, 1.0)
    for component in range(256):
        patience.hear(SETPOINTS, 1.0 + component * 1e-3)
        patience.hear(SETPOINTS._replace(system_id=1, component_id=component), 0.5)
    assert len(patience._streams) <= 64
    assert waits(patience, 2.0)


@given(
    st.lists(st.tuples(st.booleans(), st.floats(0.0, 0.5), st.floats(0.0, 0.2)), max_size=200),
    st.floats(0.0, 3.0),
)
def test_vehicle_time_never_stands_still_longer_than_it_is_allowed_to(
    turns: list[tuple[bool, float, float]], most_s: float
) -> None:
    patience, vehicle_s, now_s, since_s = Patience(most_s), 0.0, 0.0, None
    for speaks, passed_s, step_s in turns:
        now_s += passed_s
        if speaks:
            patience.hear(SETPOINTS, vehicle_s)
        if waits(patience, vehicle_s, now_s):
            since_s = now_s if since_s is None else since_s
            assert now_s - since_s < most_s
        else:
            since_s = None
            vehicle_s += step_s


def test_no_patience_never_waits() -> None:
    patience = flowing(SETPOINTS, 0.05, 1.0, most_s=0.0)
    assert not waits(patience, 5.0)


@pytest.mark.parametrize("most_s", [-1.0, float("nan")])
def test_patience_is_a_time(most_s: float) -> None:
    with pytest.raises(ValueError, match="patience"):
        Patience(most_s)
