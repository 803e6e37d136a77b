"""Vehicle time in lock-step: who flies has had a turn before the next one begins."""

import pytest
from pymavlink.dialects.v20 import ardupilotmega as mavlink

from tests.support.faults import schedule_of
from tests.support.station import Station, endpoint_of
from vehicle_sim.parameters import Flavour
from vehicle_sim.protocol.bad_links import BadLinksEndpoint
from vehicle_sim.protocol.dialect import Message
from vehicle_sim.protocol.endpoint import Endpoint
from vehicle_sim.protocol.flavour import Rates
from vehicle_sim.server.lockstep import MOST_S, Lockstep
from vehicle_sim.server.server import Server
from vehicle_sim.vehicle import Vehicle, VehicleConfig


class Flight:
    """A vehicle in lock-step with one client, and a wall clock that is turned by hand."""

    def __init__(self, endpoint: Endpoint) -> None:
        self.said: list[str] = []
        self.lockstep = Lockstep([endpoint], self.said.append)
        self.endpoint = endpoint
        self.client = Station(endpoint, "client", rates=Rates.ONBOARD)
        self.now_s = 1000.0

    def asked(self) -> Message:
        """The PING for all with which ends what has come since the last call."""
        self.client.forget()
        self.client.collect()
        ping = self.client.heard[-1]
        assert (ping.get_type(), ping.target_system, ping.target_component) == ("PING", 0, 0)
        return ping

    def answer(self, ping: Message) -> None:
        self.client.send(mavlink.MAVLink_ping_message(ping.time_usec, ping.seq, 1, 1))

    def turn(self) -> int:
        """Steps made, as the server makes them, until the vehicle waits."""
        made = 0
        while not self.lockstep.waits(self.now_s):
            self.endpoint.advance()
            made += 1
            if self.lockstep.made():
                self.lockstep.waits(self.now_s)
                break
        return made


@pytest.fixture(params=list(Flavour))
def flight(request: pytest.FixtureRequest) -> Flight:
    return Flight(endpoint_of(request.param))


def test_vehicle_time_stands_at_zero_until_a_client_has_answered(flight: Flight) -> None:
    for _ in range(100):
        flight.now_s += 10.0
        assert flight.turn() == 0
    ping = flight.asked()
    assert (ping.time_usec, ping.get_srcComponent()) == (0, 1)
    assert not flight.lockstep.begun
    flight.answer(ping)
    assert 1 <= flight.turn() <= 4


def test_no_turn_is_longer_than_a_setpoints_period_and_none_begins_unanswered(flight: Flight) -> None:
    flight.turn()
    for _ in range(200):
        before_us = flight.endpoint.now_us
        ping = flight.asked()
        assert ping.time_usec == before_us
        assert flight.turn() == 0
        flight.answer(ping)
        assert 1 <= flight.turn() <= 4
        assert 0 < flight.endpoint.now_us - before_us <= 40_000


def test_an_older_answer_counts_for_nothing_and_a_ping_is_repeated(flight: Flight) -> None:
    flight.turn()
    first = flight.asked()
    flight.answer(first)
    flight.turn()
    second = flight.asked()
    flight.answer(first)
    flight.now_s += 1.1
    assert flight.turn() == 0
    again = flight.asked()
    assert (again.seq, again.time_usec) == (second.seq, second.time_usec)
    flight.answer(again)
    assert flight.turn() > 0


def test_who_never_answers_is_not_waited_for_while_another_does(flight: Flight) -> None:
    Station(flight.endpoint, "mute", rates=Rates.ONBOARD)
    Station(flight.endpoint, "ground station", rates=Rates.GROUND_STATION)
    flight.turn()
    for _ in range(20):
        flight.answer(flight.asked())
        assert flight.turn() > 0


def test_a_client_that_is_gone_is_told_and_one_that_comes_back_is_waited_for(flight: Flight) -> None:
    flight.turn()
    flight.answer(flight.asked())
    flight.turn()
    flight.now_s += MOST_S - 0.1
    assert flight.turn() == 0
    assert flight.said == []
    flight.now_s += 0.2
    assert flight.turn() > 0
    (said,) = flight.said
    assert "no answer for 30 s by client" in said
    for _ in range(20):
        assert flight.turn() > 0
    flight.answer(flight.asked())
    assert flight.turn() > 0
    assert flight.turn() == 0
    assert len(flight.said) == 1


def test_a_link_that_is_closed_is_waited_for_no_more(flight: Flight) -> None:
    flight.turn()
    flight.answer(flight.asked())
    flight.turn()
    assert flight.turn() == 0
    flight.endpoint.remove_link("client")
    assert flight.turn() > 0


def test_faults_of_the_line_do_not_touch_it() -> None:
    vehicle = Vehicle(VehicleConfig(faults=schedule_of("link, drop: 0.5, delay_s: 0.5, corrupt: 0.5")))
    flight = Flight(BadLinksEndpoint(vehicle, Flavour.ARDUPILOT))
    flight.turn()
    for _ in range(100):
        ping = flight.asked()
        flight.answer(ping)
        assert flight.turn() > 0


def test_patience_and_lock_step_exclude_each_other() -> None:
    from vehicle_sim.clock import WallClock  # noqa: PLC0415 - for this mistake alone
    from vehicle_sim.server.patience import Patience  # noqa: PLC0415 - the same

    endpoint = endpoint_of(Flavour.ARDUPILOT)
    with pytest.raises(ValueError, match="patient"):
        Server(
            [endpoint],
            [],
            clock=WallClock(),
            notify=print,
            patience=[Patience(1.0)],
            lockstep=Lockstep([endpoint], print),
        )
