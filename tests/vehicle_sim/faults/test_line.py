"""A bad line does to packets what it says, as often as it says, and the same each time."""

from collections import Counter

import pytest
from hypothesis import given
from hypothesis import strategies as st

from vehicle_sim.faults.line import CLEAR, MOST_WAITING, Line, LineFaults

PACKETS = [number.to_bytes(4, "big") + bytes(16) for number in range(4000)]
LIKELIHOOD = st.floats(0.0, 1.0)


def passed(faults: LineFaults, *, seed: int = 1, number: int = 0, every_us: int = 10_000) -> list[tuple[int, bytes]]:
    """What comes out of a line into which the packets go one by one, with its time."""
    line, out, now_us = Line(seed, number), [], 0
    for packet in PACKETS:
        line.put(packet, now_us, faults)
        now_us += every_us
        out += [(now_us, arrived) for arrived in line.take(now_us)]
    return out + [(now_us, arrived) for arrived in line.take(1 << 60)]


def test_a_clear_line_changes_nothing() -> None:
    assert [packet for _, packet in passed(CLEAR)] == PACKETS


def test_dropped_and_doubled_as_often_as_said() -> None:
    assert len(passed(LineFaults(drop=0.3))) == pytest.approx(0.7 * len(PACKETS), rel=0.04)
    counts = Counter(packet for _, packet in passed(LineFaults(duplicate=0.2)))
    assert set(counts.values()) == {1, 2}
    assert len(counts) == len(PACKETS)
    assert counts.total() == pytest.approx(1.2 * len(PACKETS), rel=0.04)
    assert passed(LineFaults(drop=1.0)) == []


def test_corruption_flips_one_bit() -> None:
    broken = [
        (int.from_bytes(sent) ^ int.from_bytes(packet)).bit_count()
        for sent, (_, packet) in zip(PACKETS, passed(LineFaults(corrupt=0.4)), strict=True)
    ]
    assert set(broken) == {0, 1}
    assert sum(broken) == pytest.approx(0.4 * len(PACKETS), rel=0.06)


def test_jitter_delays_within_its_bounds_and_keeps_the_order() -> None:
    out = passed(LineFaults(delay_s=0.5, jitter_s=0.2))
    assert [packet for _, packet in out] == PACKETS
    lags = [(t - 10_000 * int.from_bytes(packet[:4])) / 1e6 for t, packet in out[: len(out) - 100]]
    assert min(lags) >= 0.5
    assert max(lags) <= 0.71


def test_only_reordered_packets_are_overtaken() -> None:
    out = [packet for _, packet in passed(LineFaults(reorder=0.1))]
    assert sorted(out) == PACKETS
    numbers = [int.from_bytes(packet[:4]) for packet in out]
    late = sum(number < max(numbers[:at], default=-1) for at, number in enumerate(numbers))
    assert late == pytest.approx(0.1 * 0.95 * len(PACKETS), rel=0.2)


@given(drop=LIKELIHOOD, duplicate=LIKELIHOOD, corrupt=LIKELIHOOD, reorder=LIKELIHOOD)
def test_equal_seeds_give_equal_lines_and_two_lines_are_not_alike(
    drop: float, duplicate: float, corrupt: float, reorder: float
) -> None:
    faults = LineFaults(drop=drop, duplicate=duplicate, corrupt=corrupt, reorder=reorder, jitter_s=0.01)

    def first(seed: int, number: int) -> list[bytes]:
        line = Line(seed, number)
        for packet in PACKETS[:100]:
            line.put(packet, 0, faults)
        return line.take(1 << 60)

    assert first(3, 0) == first(3, 0)
    if 0.2 < drop < 0.8:
        assert first(3, 0) != first(3, 1)


def test_what_waits_is_bounded() -> None:
    line = Line(1, 0)
    for _ in range(2 * MOST_WAITING):
        line.put(b"x", 0, LineFaults(delay_s=10.0))
    assert len(line.take(1 << 60)) == MOST_WAITING
