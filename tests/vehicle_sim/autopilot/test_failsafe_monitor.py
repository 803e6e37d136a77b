"""The order of failsafes by itself: random failures, pilots and pauses against what must always hold."""

from hypothesis import given
from hypothesis import strategies as st

from vehicle_sim.autopilot import Failsafe
from vehicle_sim.autopilot.failsafe import FailsafeMonitor, Response
from vehicle_sim.parameters import Action

A, B, C = Failsafe.GROUND_LOST, Failsafe.FENCE, Failsafe.BATTERY_CRITICAL
FAILURES = st.dictionaries(
    st.sampled_from([one for one in Failsafe if one is not Failsafe.NONE]),
    st.builds(Response, st.sampled_from(Action), st.booleans(), st.booleans()),
    max_size=4,
)
GRAVE = (Action.RETURN, Action.LAND)


def test_nothing_wrong_nothing_done() -> None:
    decision = FailsafeMonitor().assess(1.0, {}, 5.0)
    assert (decision.action, decision.is_other, decision.appeared, decision.vanished) == (Action.NOTHING, False, (), ())


def test_a_pause_comes_before_a_grave_action_once() -> None:
    monitor = FailsafeMonitor()
    first = {A: Response(Action.RETURN, pauses=True)}
    began = monitor.assess(10.0, first, 5.0)
    assert (began.action, began.pause_s, began.appeared) == (Action.HOLD, 5.0, (A,))
    assert monitor.assess(14.9, first, 5.0).action is Action.HOLD
    assert monitor.assess(15.0, first, 5.0).action is Action.RETURN
    # Who returns already does not stop for the next.
    second = first | {C: Response(Action.LAND, pauses=True)}
    decision = monitor.assess(16.0, second, 5.0)
    assert (decision.action, decision.pause_s, decision.appeared) == (Action.LAND, 0.0, (C,))


def test_a_second_failure_in_the_pause_does_not_make_it_longer() -> None:
    monitor = FailsafeMonitor()
    first = {A: Response(Action.RETURN, pauses=True)}
    monitor.assess(10.0, first, 5.0)
    both = first | {C: Response(Action.LAND, pauses=True)}
    assert monitor.assess(13.0, both, 5.0).action is Action.HOLD
    assert monitor.assess(15.0, both, 5.0).action is Action.LAND


def test_nothing_pauses_before_the_gravest() -> None:
    monitor = FailsafeMonitor()
    assert monitor.assess(0.0, {A: Response(Action.TERMINATE, pauses=True)}, 5.0).action is Action.TERMINATE
    monitor = FailsafeMonitor()
    monitor.assess(0.0, {A: Response(Action.RETURN, pauses=True)}, 5.0)
    both = {A: Response(Action.RETURN, pauses=True), B: Response(Action.DISARM)}
    assert monitor.assess(1.0, both, 5.0).action is Action.DISARM


def test_a_response_ends_as_it_says() -> None:
    for ends, action in ((True, Action.NOTHING), (False, Action.LAND)):
        monitor = FailsafeMonitor()
        monitor.assess(0.0, {A: Response(Action.LAND, ends_with_failure=ends)}, 0.0)
        decision = monitor.assess(1.0, {}, 0.0)
        assert (decision.action, decision.vanished) == (action, (A,))
        monitor.overridden()
        assert monitor.assess(2.0, {}, 0.0).action is Action.NOTHING


def test_a_pilot_takes_over_until_something_else_goes_wrong() -> None:
    monitor = FailsafeMonitor()
    lost = {A: Response(Action.RETURN)}
    monitor.assess(0.0, lost, 0.0)
    monitor.overridden()
    assert monitor.assess(1.0, lost, 0.0).action is Action.NOTHING
    # Gone and come back it is another failure.
    monitor.assess(2.0, {}, 0.0)
    assert monitor.assess(3.0, lost, 0.0).action is Action.RETURN
    monitor.overridden()
    assert monitor.assess(4.0, lost, 0.0).action is Action.NOTHING
    assert monitor.assess(5.0, lost | {B: Response(Action.HOLD)}, 0.0).action is Action.RETURN


def test_what_a_pilot_chose_may_still_be_replaced_by_less() -> None:
    monitor = FailsafeMonitor()
    lost = {A: Response(Action.RETURN)}
    monitor.assess(0.0, lost, 0.0)
    monitor.overridden()
    without = lost | {Failsafe.SETPOINTS_LOST: Response(Action.POSITION, ends_with_failure=True)}
    assert monitor.assess(1.0, without, 0.0).action is Action.POSITION
    assert monitor.assess(2.0, lost, 0.0).action is Action.NOTHING


def test_a_failure_that_has_become_worse_acts_again() -> None:
    monitor = FailsafeMonitor()
    outside = {B: Response(Action.BRAKE)}
    monitor.assess(0.0, outside, 0.0)
    monitor.overridden()
    assert monitor.assess(1.0, outside, 0.0).action is Action.NOTHING
    monitor.renewed(B)
    decision = monitor.assess(2.0, outside, 0.0)
    assert (decision.action, decision.appeared) == (Action.BRAKE, (B,))


@given(failures=st.lists(st.tuples(FAILURES, st.booleans()), max_size=12), pause_s=st.sampled_from([0.0, 2.5]))
def test_what_always_holds(failures: list[tuple[dict[Failsafe, Response], bool]], pause_s: float) -> None:
    monitor = FailsafeMonitor()
    before: frozenset[Failsafe] = frozenset()
    action = Action.NOTHING
    for step, (present, is_overridden) in enumerate(failures):
        if is_overridden:
            monitor.overridden()
        decision = monitor.assess(float(step), present, pause_s)
        assert set(decision.appeared) == present.keys() - before
        assert set(decision.vanished) == before - present.keys()
        assert decision.is_other == (decision.action is not action)
        worst = max((one.action for one in present.values()), default=Action.NOTHING)
        # What is present is never answered by more than it asks for, unless something older still stands.
        if worst >= Action.DISARM:
            assert decision.action >= worst
        fresh = [present[one] for one in decision.appeared]
        if any(one.action >= Action.HOLD for one in fresh) and not monitor.taken_over:
            assert decision.action >= min(worst, Action.HOLD)
        if pause_s == 0.0 and not monitor.taken_over:
            assert decision.action >= worst
        if decision.pause_s > 0.0:
            assert any(one.pauses and one.action in GRAVE for one in fresh)
        before, action = frozenset(present), decision.action


@given(a=st.sampled_from(Action), b=st.sampled_from(Action))
def test_the_order_in_which_two_failures_come_does_not_matter(a: Action, b: Action) -> None:
    one, other = Response(a), Response(b)
    forth, back = FailsafeMonitor(), FailsafeMonitor()
    forth.assess(0.0, {A: one}, 0.0)
    back.assess(0.0, {C: other}, 0.0)
    both = {A: one, C: other}
    assert forth.assess(1.0, both, 0.0).action is back.assess(1.0, both, 0.0).action is max(a, b)
