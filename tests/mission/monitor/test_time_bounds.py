"""Bounds in seconds in flight: open with so many seconds left, met, or missed at a time."""

import numpy as np
import pytest

from mission.logic.formula.parser import parse_timed_formula
from mission.monitor.flight import FlightMonitor
from mission.monitor.stage import Stage
from mission.monitor.time_bounds import BoundWatch
from tests.support.timed_missions import timed_plan

HOME, NONE, FAR = frozenset({"home"}), frozenset[str](), frozenset({"far"})


def watch(formula: str) -> BoundWatch:
    return BoundWatch([parse_timed_formula(formula)])


def test_a_deadline_is_open_then_met() -> None:
    seen = watch("F[0,60] far")
    seen.enter(100.0, HOME)
    assert [bound.text(5.0) for bound in seen.now(105.0)] == ["F[0,60] far open, 55 s left"]
    assert [bound.text() for bound in seen.now(105.0)] == ["F[0,60] far open"]
    seen.enter(110.0, NONE)
    assert [bound.text(20.0) for bound in seen.now(120.0)] == ["F[0,60] far open, 40 s left"]
    seen.enter(130.5, FAR)
    assert [bound.text(31.0) for bound in seen.now(131.0)] == ["F[0,60] far met at 30.5 s"]
    assert seen.missed(stays=True) is None


def test_a_deadline_that_goes_by_is_missed_at_its_time() -> None:
    seen = watch("F[0,60] far")
    seen.enter(100.0, HOME)
    assert [bound.text(61.0) for bound in seen.now(161.0)] == ["F[0,60] far missed at 60.0 s"]
    seen.enter(170.0, FAR)
    assert [bound.met for bound in seen.now(171.0)] == [False]
    missed = seen.missed(stays=True)
    assert missed is not None
    assert missed.at_s == 60.0


def test_what_must_last_is_met_when_it_has() -> None:
    seen = watch("G[0,60] !far")
    seen.enter(0.0, HOME)
    assert [bound.text(5.0) for bound in seen.now(5.0)] == ["G[0,60] !far open, 55 s to go"]
    assert [bound.met for bound in seen.now(61.0)] == [True]


def test_what_must_last_is_missed_at_once() -> None:
    seen = watch("G[0,60] !far")
    seen.enter(0.0, HOME)
    seen.enter(30.0, FAR)
    assert [bound.text(30.0) for bound in seen.now(30.0)] == ["G[0,60] !far missed at 30.0 s"]


@pytest.mark.parametrize(("home_s", "missed"), [(50.0, False), (500.0, True)])
def test_after_the_last_lap_nothing_is_due(home_s: float, missed: bool) -> None:  # noqa: FBT001 - what is expected
    seen = watch("G (far -> G F[0,60] far)")
    for t_s, letter in ((0.0, HOME), (20.0, FAR), (25.0, NONE), (20.0 + home_s, FAR), (30.0 + home_s, HOME)):
        seen.enter(t_s, letter)
    seen.now(2000.0)
    assert (seen.missed(stays=False) is not None) is missed


def test_a_flight_that_was_late_has_not_achieved_its_mission() -> None:
    plan = timed_plan("F G home & F[0,60] far & G[0,12] !gate")
    for slower, achieved in ((1.0, True), (4.0, False)):
        flown = FlightMonitor(plan)
        for t_s in np.linspace(0.0, plan.trajectory.duration_s, 400).tolist():
            (x, y) = plan.trajectory.position([t_s])[0].tolist()
            flown.report(Stage.FLY, 100.0 + slower * t_s, (x, y))
        outcome = flown.monitor.outcome(stays=True)
        assert outcome.achieved is achieved
        assert flown.monitor.verdict_at_end(stays=True).achieved
    assert outcome.reason == "F[0,60] far was missed 60.0 s after the trajectory began"
