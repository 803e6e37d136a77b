"""The ages of what a flight needs, on two clocks."""

import pytest

from mission.link.values import Body, Estimates, EstimatorReport, Heartbeat, LocalPosition
from mission.link.watchdog import Watchdog

POSITION = LocalPosition(0, (0.0, 0.0, 0.0), (0.0, 0.0, 0.0))
ESTIMATOR = EstimatorReport(Estimates.ATTITUDE)
HEARTBEAT = Heartbeat(2, 3, 0, 4, 4)
ALL: tuple[Body, ...] = (POSITION, ESTIMATOR, HEARTBEAT)


def watched(*, without: type[Body], until_s: float, rate: float = 1.0) -> tuple[Watchdog, list[tuple[float, str]]]:
    """A watch of so many seconds here in which one message never comes, and when it was lost, with the words."""
    watchdog, lost = Watchdog(5.0), []
    for tenth in range(round(until_s * 10.0)):
        now_s = 1000.0 + tenth / 10.0
        for body in ALL:
            if not isinstance(body, without):
                watchdog.take(body, now_s, rate * tenth / 10.0)
        if words := watchdog.lost(now_s, rate * tenth / 10.0):
            lost.append((tenth / 10.0, words))
    return watchdog, lost


@pytest.mark.parametrize(
    ("body", "limit_s", "words"),
    [
        (LocalPosition, 5.0, "the vehicle has not told its position for 5.1 s"),
        (EstimatorReport, 10.0, "the vehicle has not told how well it knows its position for 10.1 s"),
        (Heartbeat, 10.0, "the vehicle has not told its mode for 10.1 s"),
    ],
)
def test_each_need_is_missed_in_its_own_words(body: type[Body], limit_s: float, words: str) -> None:
    _, lost = watched(without=body, until_s=limit_s + 1.0)
    assert lost[0] == (limit_s + 0.1, words)


def test_what_the_vehicle_can_be_asked_for_is_asked_for_first() -> None:
    watchdog = Watchdog(5.0)
    assert watchdog.overdue(0.0, 0.0) == ()
    assert watchdog.overdue(1.0, 0.0) == (LocalPosition,)
    assert watchdog.overdue(4.0, 4.0) == (LocalPosition, EstimatorReport)  # its mode it tells unasked
    watchdog.take(POSITION, 4.0, 4.0)
    assert watchdog.overdue(4.5, 4.5) == (EstimatorReport,)


def test_nothing_is_missed_that_was_due_before_the_first_look() -> None:
    watchdog = Watchdog(5.0)
    for body in ALL:
        watchdog.take(body, 0.0, 0.0)
    assert watchdog.lost(60.0, 60.0) == ""
    assert watchdog.lost(65.0, 60.0) == ""
    assert watchdog.lost(65.1, 60.0) != ""


def test_a_vehicle_whose_time_is_fast_is_missed_by_its_own_time() -> None:
    _, lost = watched(without=LocalPosition, until_s=2.0, rate=20.0)
    assert lost[0][0] == pytest.approx(0.3)


def test_a_vehicle_whose_time_stands_is_missed_by_the_time_here() -> None:
    _, lost = watched(without=LocalPosition, until_s=6.0, rate=0.0)
    assert lost[0][0] == pytest.approx(5.1)


def test_a_vehicle_whose_time_is_slow_is_not_missed_by_the_time_here() -> None:
    watchdog = Watchdog(5.0)
    for second in range(60):
        watchdog.take(POSITION, float(second), 0.02 * second)
        assert watchdog.lost(float(second), 0.02 * second) == ""
