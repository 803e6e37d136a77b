"""When what is sent arrives, by TIMESYNC over lines that lose, delay, double and mix."""

import random

import pytest
from hypothesis import given
from hypothesis import strategies as st

from mission.link.arrival import ASK_S, Arrival
from mission.link.contact import Contact
from mission.link.identity import LinkOptions
from mission.link.messages import Codec
from mission.link.values import TimeAnswer
from mission.link.vehicle_clock import VehicleClock
from mission.monitor.gaps import GAP_S
from tests.support.drawn_cases import tried
from tests.support.lockstep import LockstepVehicle, vehicle_of

TICK_S = 0.02
BOOTED_S = 40.0
"""What the vehicle's clock is ahead of the clock here."""


class Line:
    """A vehicle behind a line of two ways, in ticks: it tells its time and answers what it is asked."""

    def __init__(self, down_s: float, up_s: float, *, loss: float = 0.0, mixed_s: float = 0.0, seed: int = 1) -> None:
        self.clock = VehicleClock()
        self.arrival = Arrival(self.clock)
        self.down_s, self.up_s, self.speed = down_s, up_s, 1.0
        self._loss, self._mixed_s = loss, mixed_s
        self._draw = random.Random(seed)  # noqa: S311 - a test, not cryptography
        self._up: list[tuple[float, int]] = []
        self._down: list[tuple[float, TimeAnswer | int]] = []
        self._now_s = 0.0

    def _due_s(self, way_s: float) -> float:
        late_s = self._mixed_s * self._draw.random() if self._draw.random() < 0.2 else 0.0
        return self._now_s + way_s + late_s

    def run(self, for_s: float) -> None:
        """Times of the line are the vehicle's, and the vehicle's clock is shown as it comes through."""
        until_s = self._now_s + for_s
        while self._now_s < until_s:
            self._now_s += TICK_S
            boot_s, here_s = BOOTED_S + self._now_s, self._now_s / self.speed
            if self._draw.random() >= self._loss:
                self._down.append((self._due_s(self.down_s), round(1000.0 * boot_s)))
            for _, asked in [each for each in self._up if each[0] <= self._now_s]:
                for _ in range(2):  # answers come twice, or as often as they are not lost
                    if self._draw.random() >= self._loss:
                        answer = TimeAnswer(round(1e9 * boot_s), asked)
                        self._down.append((self._due_s(self.down_s), answer))
            self._up = [each for each in self._up if each[0] > self._now_s]
            for _, heard in sorted((each for each in self._down if each[0] <= self._now_s), key=lambda each: each[0]):
                if isinstance(heard, TimeAnswer):
                    self.arrival.take(heard, here_s)
                else:
                    self.clock.observe(heard, here_s)
            self._down = [each for each in self._down if each[0] > self._now_s]
            stamp = self.arrival.due(here_s)
            if stamp is not None and self._draw.random() >= self._loss:
                self._up.append((self._due_s(self.up_s), stamp))


@tried(25)
@given(
    down_s=st.floats(0.0, 0.6),
    up_s=st.floats(0.0, 0.6),
    loss=st.floats(0.0, 0.4),
    mixed_s=st.floats(0.0, 0.1),
    seed=st.integers(0, 1000),
)
def test_it_is_both_ways_together_whatever_is_lost_doubled_or_mixed(
    down_s: float, up_s: float, loss: float, mixed_s: float, seed: int
) -> None:
    """The clock that is shown goes by the telemetry that comes through fastest, so a mixed way makes no difference."""
    line = Line(down_s, up_s, loss=loss, mixed_s=mixed_s, seed=seed)
    line.run(15.0)
    assert line.arrival.measured_s == pytest.approx(down_s + up_s, abs=0.06)


@pytest.mark.parametrize("speed", [1.0, 20.0])
def test_it_counts_in_the_vehicles_time(speed: float) -> None:
    line = Line(0.3, 0.5)
    line.speed = speed
    line.run(10.0)
    assert line.arrival.measured_s == pytest.approx(0.8, abs=0.05)
    assert line.arrival.largest_s >= line.arrival.measured_s


def test_what_is_reckoned_with_follows_slowly_while_something_moves() -> None:
    line = Line(0.5, 0.5)
    line.run(6.0)
    assert line.arrival.settle() == pytest.approx(1.0, abs=0.05)
    line.down_s = line.up_s = 0.1
    line.run(6.0)
    assert line.arrival.measured_s == pytest.approx(0.2, abs=0.05)
    before = line.arrival.follow(100.0)
    assert line.arrival.follow(100.1) == pytest.approx(before - 0.02, abs=1e-6)
    assert line.arrival.follow(200.0) == pytest.approx(before - 0.02 - 0.2 * GAP_S, abs=1e-6)


def test_answers_to_others_and_requests_of_the_vehicle_count_for_nothing() -> None:
    clock = VehicleClock()
    arrival = Arrival(clock)
    assert arrival.due(0.0) is None
    requests = 0
    for tick in range(100):
        now_s = 0.1 * tick
        clock.observe(round(1000 * (BOOTED_S + now_s)), now_s)
        asked = arrival.due(now_s)
        if asked is not None:
            requests += 1
            arrival.take(TimeAnswer(0, asked + 1), now_s)
            arrival.take(TimeAnswer(round(1e9 * (BOOTED_S + now_s)), asked + 1), now_s)
    assert requests <= 10.0 / ASK_S + 1
    assert arrival.measured_s == 0.0


def test_a_vehicle_whose_two_clocks_differ_is_reckoned_with_by_the_round_trip_at_most() -> None:
    clock = VehicleClock()
    arrival = Arrival(clock)
    asked: list[tuple[float, int]] = []
    for tick in range(200):
        now_s = 0.05 * tick
        clock.observe(round(1000 * (BOOTED_S + now_s)), now_s)
        stamp = arrival.due(now_s)
        if stamp is not None:
            asked.append((now_s, stamp))
        while asked and now_s - asked[0][0] >= 0.4:
            arrival.take(TimeAnswer(round(1e9 * (BOOTED_S + 1000.0 + now_s)), asked.pop(0)[1]), now_s)
    assert arrival.measured_s == pytest.approx(0.4, abs=0.06)


@pytest.mark.parametrize("flavour", ["ardupilot", "px4"])
def test_the_bundled_vehicle_answers_as_both_autopilots_do(flavour: str) -> None:
    vehicle = LockstepVehicle(vehicle_of(flavour))
    contact = Contact(LinkOptions(), needs_origin=False)
    while vehicle.now_s() < 5.0:
        for data in vehicle.receive(0.05):
            for body in contact.receive(data, vehicle.now_s()):
                contact.take(body, vehicle.now_s())
        contact.advance(vehicle.now_s())
        for frame in contact.outgoing():
            vehicle.send(frame)
    assert contact.arrival.largest_s <= 0.05
    codec = Codec(255, 191)
    vehicle.send(codec.time_request(77))
    told = [each.body for data in vehicle.receive(0.05) for each in codec.decode(data)]
    (answer,) = [body for body in told if isinstance(body, TimeAnswer) and body.asked_ns == 77]
    assert answer.told_ns == pytest.approx(1e9 * vehicle.now_s(), abs=0.1e9)
