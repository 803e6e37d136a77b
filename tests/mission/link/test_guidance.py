"""Setpoints along a course whose time goes on only while they are sent."""

import pytest

from mission.link.guidance import Guidance
from mission.monitor.gaps import Gap, Missing, gaps_text
from mission.plan.turning import TURN_RAD_S
from tests.support.sessions import DURATION_S, START_M, anchor_at_start, course

PERIOD_S = 1.0 / 30.0
BEGAN_S = 100.0


def led_until(at_s: float) -> Guidance:
    """A guidance that has sent its setpoints without a break since a second before the trajectory began."""
    guidance = Guidance(course(), anchor_at_start((0.0, 0.0, 0.0)), PERIOD_S)
    for tick in range(-30, round((at_s - BEGAN_S) * 30.0) + 1):
        if tick == 0:
            guidance.begin(BEGAN_S)
        assert guidance.due(BEGAN_S + tick / 30.0) is not None
    return guidance


@pytest.mark.parametrize("gap_s", [0.6, 4.2, 40.0])
def test_after_a_gap_it_goes_on_from_where_the_last_setpoint_stood(gap_s: float) -> None:
    guidance = led_until(BEGAN_S + 5.0)
    stood = guidance.reference(BEGAN_S + 5.0)
    left_s = guidance.left_s(BEGAN_S + 5.0)
    # While nothing is sent, that is where the vehicle should be.
    assert guidance.observe(BEGAN_S + 5.0 + gap_s - 0.05, (0.0, 0.0, 0.0), (0.0, 0.0, 0.0)) == stood
    due = guidance.due(BEGAN_S + 5.0 + gap_s)
    assert due is not None
    reference, _, gap = due
    assert reference == stood
    assert gap is not None
    assert gap.missing is Missing.SETPOINT
    assert gap.from_s == pytest.approx(BEGAN_S + 5.0)
    assert gap.for_s == pytest.approx(gap_s)
    assert guidance.left_s(BEGAN_S + 5.0 + gap_s) == pytest.approx(left_s)
    # What was told late is about then, not about now.
    assert guidance.trajectory_s(BEGAN_S + 5.0 + 0.5 * gap_s) == pytest.approx(5.0)
    assert guidance.trajectory_s(BEGAN_S + 4.9) == pytest.approx(4.9)
    assert guidance.trajectory_s(BEGAN_S + 5.0 + gap_s + 0.3) == pytest.approx(5.3)


def test_gaps_add_up() -> None:
    guidance = led_until(BEGAN_S + 2.0)
    for at_s in (5.0, 7.0, 7.4):
        assert guidance.due(BEGAN_S + at_s) is not None
    assert guidance.trajectory_s(BEGAN_S + 7.4) == pytest.approx(2.4)
    assert guidance.trajectory_s(BEGAN_S + 6.0) == pytest.approx(2.0)


def test_a_short_gap_is_none() -> None:
    guidance = led_until(BEGAN_S + 5.0)
    due = guidance.due(BEGAN_S + 5.4)
    assert due is not None
    assert due[2] is None
    assert guidance.trajectory_s(BEGAN_S + 5.4) == pytest.approx(5.4)


def test_before_the_start_and_after_the_end_nothing_pauses() -> None:
    waiting = Guidance(course(), anchor_at_start((0.0, 0.0, 0.0)), PERIOD_S)
    for at_s in (90.0, 95.0):
        due = waiting.due(at_s)
        assert due is not None
        assert due[2] is None
        assert due[0].position_m[:2] == pytest.approx(START_M)
    waiting.begin(BEGAN_S)
    assert waiting.due(BEGAN_S) is not None
    ended = led_until(BEGAN_S + DURATION_S)
    due = ended.due(BEGAN_S + DURATION_S + 3.0)
    assert due is not None
    assert due[2] is None


def test_the_heading_turns_no_faster_for_a_gap() -> None:
    guidance = led_until(BEGAN_S + 0.5)
    before = guidance.course.heading_rad
    assert guidance.due(BEGAN_S + 8.5) is not None
    assert abs(guidance.course.heading_rad - before) <= 0.5 * TURN_RAD_S


@pytest.mark.parametrize(
    ("gaps", "words"),
    [
        ((), ""),
        ((Gap(Missing.SETPOINT, 1.0, 4.2),), "the trajectory paused for 4.2 s"),
        (
            (Gap(Missing.POSITION, 1.0, 2.0), Gap(Missing.SETPOINT, 1.0, 1.9), Gap(Missing.POSITION, 9.0, 0.7)),
            "where it was is unknown 2 times for up to 2.0 s, the trajectory paused for 1.9 s",
        ),
    ],
)
def test_gaps_in_words(gaps: tuple[Gap, ...], words: str) -> None:
    assert gaps_text(gaps) == words
