"""The time from arming to landing in flight: open, met, missed, and the verdict that follows."""

import pytest

from mission.monitor.air_time import AirWatch
from mission.monitor.monitor import Outcome
from mission.monitor.stage import Stage

WELL = Outcome(achieved=True, reason="as it should be")


def watch(*reports: tuple[float, Stage], longest_s: float | None = 60.0) -> AirWatch:
    seen = AirWatch(longest_s)
    seen.report(None, 1.0)
    for t_s, stage in reports:
        seen.report(stage, t_s)
    return seen


UP = ((5.0, Stage.ARM), (100.0, Stage.TAKE_OFF), (110.0, Stage.FLY))


def texts(seen: AirWatch, now_s: float | None) -> list[str]:
    return [bound.text(now_s) for bound in seen.now]


def test_it_is_open_from_arming_on_with_the_seconds_that_are_left() -> None:
    assert texts(watch(*UP[:1]), 0.0) == ["flight.longest_s: 60 open"]
    assert texts(watch(*UP, (130.0, Stage.FLY)), 20.0) == ["flight.longest_s: 60 open, 30 s left"]


@pytest.mark.parametrize(
    ("reports", "text", "reason"),
    [
        (((155.0, Stage.TOUCH_DOWN), (159.0, Stage.DISARM), (190.0, Stage.DONE)), "met", WELL.reason),
        (
            ((155.0, Stage.LAND), (161.5, Stage.TOUCH_DOWN)),
            "missed",
            "flight.longest_s: 60 was missed: from arming to landing were 61.5 s",
        ),
    ],
)
def test_landing_settles_it_and_so_does_being_late(
    reports: tuple[tuple[float, Stage], ...], text: str, reason: str
) -> None:
    seen = watch(*UP, *reports)
    assert texts(seen, 70.0) == [f"flight.longest_s: 60 {text}"]
    assert seen.judged(WELL) == Outcome(text == "met", reason)
    wrong = Outcome(achieved=False, reason="something else")
    assert seen.judged(wrong) is wrong


def test_nothing_is_said_where_nothing_is_asked_for() -> None:
    seen = watch(*UP, (900.0, Stage.FLY), longest_s=None)
    assert not seen.now
    assert seen.judged(WELL) is WELL
