"""The planner beside the loop answers as one in the loop does, and its end is told."""

import os
import signal
import time
from collections.abc import Callable
from dataclasses import replace
from threading import Event

import pytest

from mission.fly.planner_process import PlannerProcess
from mission.fly.replanner import PlanAnswer, PlanRequest, answered, goals_of, may_keep
from mission.plan.rest import Rest
from tests.support.small_missions import SMALL, plan_of

WITHIN_S = 200.0


def wait_until(holds: Callable[[], object]) -> None:
    until_s = time.monotonic() + WITHIN_S
    pause = Event()
    while not holds():
        assert time.monotonic() < until_s
        pause.wait(0.01)


def asked_of(planner: PlannerProcess, request: PlanRequest) -> PlanAnswer:
    planner.ask(request)
    heard: list[PlanAnswer] = []

    def hears() -> bool:
        answer = planner.answer()
        if answer is not None:
            heard.append(answer)
        return bool(heard)

    wait_until(hears)
    return heard[0]


def test_it_answers_what_is_asked_and_its_end_is_told() -> None:
    plan = plan_of(SMALL)
    request = PlanRequest(7, plan, Rest((frozenset({"home"}), frozenset()), (18.0, 9.0), flown_s=3.0))
    refused = PlanRequest(8, plan, Rest((frozenset({"home"}),), (9.0, 25.0)))
    too_fast = PlanRequest(9, plan, replace(request.rest, velocity_m_s=(30.0, 0.0)), request.rest)
    planner = PlannerProcess()
    try:
        planner.prepare(plan)
        for foreseen in ((SMALL,), ("no mission: [",), (SMALL, SMALL)):
            for mission in foreseen:
                planner.foresee(mission.encode())
            assert not planner.ready
            wait_until(lambda: planner.ready)
        told, refusal, stopped = (asked_of(planner, each) for each in (request, refused, too_fast))
        few, more, kept_more = (
            planner.takes_about_s(goals, kept=kept) for goals, kept in ((1, False), (3, False), (3, True))
        )
        assert more == pytest.approx(2.0 * few)
        assert more != kept_more  # as they were rehearsed
        assert told.number == request.number
        assert told.text == answered(request).text
        assert not told.stopped
        assert (stopped.stopped, stopped.text) == (True, told.text)
        assert (refusal.number, refusal.plan) == (8, None)
        assert refusal.refusal == answered(refused).refusal != ""
        assert not planner.trouble
        assert planner.process_id is not None
        os.kill(planner.process_id, signal.SIGKILL if hasattr(signal, "SIGKILL") else signal.SIGTERM)
        planner.ask(request)
        wait_until(lambda: planner.trouble)
        assert "planner's process has ended" in planner.trouble
        assert planner.answer() is None
    finally:
        planner.close()


def test_little_is_kept_where_another_thing_is_asked_for_or_it_is_flown_otherwise() -> None:
    spec = plan_of(SMALL).spec
    assert may_keep(spec, None)
    assert may_keep(spec, replace(spec, regions=spec.regions[:2], flight=replace(spec.flight, laps=2)))
    assert not may_keep(spec, replace(spec, formula="F goal"))
    assert not may_keep(spec, replace(spec, flight=replace(spec.flight, speed_m_s=1.0)))


def test_what_is_left_has_fewer_goals() -> None:
    plan = plan_of(SMALL)
    home, none, goal = frozenset({"home"}), frozenset[str](), frozenset({"goal"})
    assert [goals_of(plan, word) for word in ((), (home, none), (home, none, goal))] == [2, 2, 1]
    assert goals_of(plan, (), returns=True) == 1
    assert goals_of(plan, (), replace(plan.spec, formula="F goal & F home & F (goal & F home)")) == 3
    assert goals_of(plan, (home, none, goal), replace(plan.spec, description="another")) == 1


@pytest.mark.parametrize("place", [(9.0, 25.0)])
def test_what_cannot_be_planned_is_refused_in_words(place: tuple[float, float]) -> None:
    refusal = answered(PlanRequest(1, plan_of(SMALL), Rest((frozenset({"home"}),), place)))
    assert refusal.plan is None
    assert "restricted" in refusal.refusal
