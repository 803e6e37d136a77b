"""A session without a time law: what it asks for, and that it waits for a pilot without a word to the vehicle."""

import numpy as np
import pytest

from mission.fly.by_field import field_orders
from mission.link.course import Course
from mission.link.ending import Ending
from mission.link.errand import Errand, Loiter
from mission.link.events import Asked, Held, SetpointSent
from mission.monitor.flight import FlightMonitor
from mission.monitor.laps import RoundCounter
from mission.monitor.monitor import Whereabouts
from mission.monitor.stage import Stage
from mission.plan import FlightPlan
from mission.plan.policy import policy_of
from tests.support.scripted_vehicle import GUIDED, PX4_HOLD, PX4_OFFBOARD, PX4_RTL, RTL, STABILIZE, ScriptedVehicle
from tests.support.sessions import START_M, Driven, Straight
from tests.support.small_missions import SMALL, plan_of

FLAVOURS = pytest.mark.parametrize("flavour", ["ardupilot", "px4"])
GOAL, HOME = frozenset({"goal"}), frozenset({"home"})


@pytest.fixture(scope="module")
def plan() -> FlightPlan:
    return plan_of(SMALL.replace("flight:\n", "flight:\n  guidance: field\n"))


class Piloted(Driven):
    """A vehicle that has begun to fly by the field, and whom a pilot then took for some seconds.

    The scripted vehicle goes to the position that is asked for, which is where it is: so it stays.
    """

    def __init__(self, plan: FlightPlan, flavour: str) -> None:
        self.monitor = FlightMonitor(plan).monitor
        self.monitor.observe(0.0, (START_M[0] - 1.0, START_M[1] - 12.0))
        vehicle = ScriptedVehicle(flavour)
        super().__init__(vehicle, None, lambda: Course(Straight(), 0.5, orders=field_orders(plan, self.monitor)))
        self.until(Stage.FLY)
        self.go_on(2.0)
        vehicle.mode = PX4_HOLD if vehicle.px4 else STABILIZE
        self.go_on(5.0)
        self.since = len(self.events)

    def go_on(self, for_s: float) -> None:
        until_s = self.vehicle.now_s() + for_s
        while self.vehicle.now_s() < until_s and self.session.ending is None:
            self.turn()

    def asked_since(self) -> list[Asked]:
        return [event for event in self.events[self.since :] if isinstance(event, Asked)]


@FLAVOURS
def test_it_waits_for_a_pilot_streaming_on_and_goes_on_when_it_is_handed_back(plan: FlightPlan, flavour: str) -> None:
    held = Piloted(plan, flavour)
    assert held.session.stage is Stage.FLY
    assert "someone else put the vehicle into" in held.session.pilot.words
    held.go_on(15.0)
    assert held.session.ending is None
    assert not held.asked_since()
    sent = [event for event in held.events[held.since :] if isinstance(event, SetpointSent)]
    assert len(sent) > 15 * 10  # without them PX4 would not be put into Offboard again
    held.vehicle.mode = PX4_OFFBOARD if held.vehicle.px4 else GUIDED
    held.go_on(3.0)
    assert not held.session.pilot.words
    assert [bool(event.words) for event in held.events if isinstance(event, Held)] == [True, False]
    assert held.session.stage is Stage.FLY


@FLAVOURS
def test_a_pilot_who_lands_it_has_it(plan: FlightPlan, flavour: str) -> None:
    held = Piloted(plan, flavour)
    held.vehicle.armed = False
    held.go_on(5.0)
    assert held.session.ending is Ending.HANDED_OVER
    assert held.session.ending_reason.endswith("and disarmed it")
    assert not held.asked_since()


@FLAVOURS
def test_a_flight_that_is_given_up_while_a_pilot_flies_leaves_it_to_them(plan: FlightPlan, flavour: str) -> None:
    held = Piloted(plan, flavour)
    held.session.stop("enough", held.vehicle.now_s())
    held.go_on(5.0)
    assert held.session.ending is Ending.HANDED_OVER
    assert not held.asked_since()


@FLAVOURS
def test_a_failsafe_while_a_pilot_flies_ends_it(plan: FlightPlan, flavour: str) -> None:
    held = Piloted(plan, flavour)
    held.vehicle.say("Failsafe activated: Low battery" if held.vehicle.px4 else "Battery Failsafe", 2)
    held.vehicle.mode = PX4_RTL if held.vehicle.px4 else RTL
    held.go_on(5.0)
    assert held.session.ending is Ending.FAILSAFE


def test_who_is_pushed_out_while_loitering_comes_back_for_the_rest(plan: FlightPlan) -> None:
    inside = np.zeros(plan.partition.size, dtype=np.bool_)
    inside[plan.labelling.triangles_of("goal")] = True
    policy = policy_of(plan)
    errand = Errand(policy, [Loiter(inside, 2.0)], laps=0, recurrent=False, final_stay_s=1.0)
    counter = RoundCounter(plan.deterministic)

    def at(triangle: int, t_s: float, *, stands: bool = False, enters: bool = True) -> int | None:
        if enters:
            counter.read(int(plan.labelling.letter_of[triangle]))
        order = errand.order(Whereabouts(triangle, counter.state, counter.due, counter.laps), t_s, stands=stands)
        assert order is not None
        return order.enter

    def led(triangle: int, t_s: float) -> int:
        """Follow the orders until one is to stand, and return where."""
        for _ in range(plan.partition.size):
            following = at(triangle, t_s)
            if following is None:
                return triangle
            triangle = following
        raise AssertionError

    place = led(plan.run.states[0], 0.0)
    assert plan.labelling.label(place) == GOAL
    assert at(place, 1.5, stands=True, enters=False) is None  # half a second is left
    outside = next(
        int(n) for t in np.flatnonzero(inside) for n in plan.partition.neighbours[t] if n >= 0 and not inside[n]
    )
    assert plan.labelling.label(led(outside, 5.0)) == GOAL  # pushed out, and back
    assert not errand.over
    place = led(place, 5.2)
    onward = at(place, 6.0, stands=True, enters=False)
    assert onward is not None
    assert plan.labelling.label(led(onward, 7.0)) == HOME


def test_from_where_the_word_is_spoiled_there_is_no_order(plan: FlightPlan) -> None:
    errand = Errand(policy_of(plan), [], laps=0, recurrent=False, final_stay_s=1.0)
    assert errand.order(Whereabouts(plan.run.states[0], -1, (), 0), 0.0, stands=False) is None
    assert errand.sealed
