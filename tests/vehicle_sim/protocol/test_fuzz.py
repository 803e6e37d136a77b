"""Traffic of the worst kind: no exception, no change by what is not for the vehicle, and memory flat."""

import gc
import math
import tracemalloc
from typing import Any

import pytest

from tests.support.snapshot import snapshot
from tests.support.station import Station, endpoint_of
from tests.support.traffic import Traffic, holds_a_message
from vehicle_sim.parameters import Flavour
from vehicle_sim.protocol.flavour import Rates
from vehicle_sim.protocol.policy import SigningPolicy

_BATCH = 8
_STEPS = 5
_LINKS = ("station", "stream", "companion")
# What a parser may keep: the statistics of pymavlink's reader, the beginning of a frame, and what was passed on unread.
_PARSING = frozenset(("_reader", "_rest", "_filling", "_waiting", "unknown"))

_ELSEWHERE = _PARSING | {"_host", "link", "_link", "_listing"}  # the list that is under way on each link


class Campaign:
    """A flying vehicle on three links, under fire."""

    def __init__(self, flavour: Flavour, seed: int) -> None:
        self.endpoint = endpoint_of(flavour)
        station = Station(self.endpoint)
        station.take_off()
        self.endpoint.add_link("stream", Rates.GROUND_STATION, byte_stream=True)
        self.endpoint.add_link("companion", Rates.ONBOARD)
        self.traffic = Traffic(seed, sorted(self.endpoint._handlers))
        self.sent = self.judged = 0

    def fire(self, until: int) -> None:
        while self.sent < until:
            for turn, link in enumerate(_LINKS):
                self.broken(link)
                self.to_others(link)
                self.wild(link)
                if turn == 0:
                    self.advance()

    def state(self) -> Any:  # noqa: ANN401
        return snapshot(self.endpoint, without=_PARSING)

    def receive(self, link: str, piece: bytes) -> None:
        self.sent += len(piece)
        self.endpoint.receive(link, piece)

    def broken(self, link: str) -> None:
        """What is no message changes nothing at all."""
        rest = self.endpoint._links[link]._rest
        pieces = [self.traffic.broken() for _ in range(_BATCH)]
        one_of_them_is = holds_a_message(rest + b"".join(pieces)) or any(map(holds_a_message, pieces))
        before = self.state()
        for piece in pieces:
            self.receive(link, piece)
        if not one_of_them_is:
            self.judged += 1
            assert self.state() == before

    def to_others(self, link: str) -> None:
        """A valid message to another system changes nothing of the vehicle; only who is where is learned from it."""
        if self.endpoint._links[link]._rest:
            return
        endpoint = self.endpoint
        of_it = (endpoint.vehicle, endpoint._parameters, endpoint._plans, endpoint._rates, endpoint._presence)
        before = snapshot(of_it, without=_ELSEWHERE)
        for _ in range(_BATCH):
            self.receive(link, self.traffic.message(77))
        assert snapshot(of_it, without=_ELSEWHERE) == before

    def wild(self, link: str) -> None:
        """A valid message with wild values may change much, and breaks nothing."""
        for _ in range(_BATCH):
            self.receive(link, self.traffic.message(None) if self.sent % 2 else self.traffic.message(1))

    def advance(self) -> None:
        for _ in range(_STEPS):
            self.endpoint.advance()
        for link in _LINKS:
            self.endpoint.outgoing(link)
        vehicle = self.endpoint.vehicle
        values = (*vehicle.estimate.position_ned_m, *vehicle.truth.position_ned_m, *vehicle.truth.velocity_ned_m_s)
        assert all(math.isfinite(value) for value in values)


def campaign(flavour: Flavour, seed: int, size: int) -> None:
    """Send so many bytes; the memory held after the first third is all that is ever held, within 256 KiB."""
    fight = Campaign(flavour, seed)
    tracemalloc.start()
    try:
        fight.fire(size // 3)
        gc.collect()
        held = tracemalloc.get_traced_memory()[0]
        fight.fire(size)
        gc.collect()
        grown = tracemalloc.get_traced_memory()[0] - held
    finally:
        tracemalloc.stop()
    assert fight.judged > size / 20_000
    assert grown < 1 << 18, f"{grown} bytes more"


@pytest.mark.parametrize("size", [10_000, pytest.param(60_000, marks=pytest.mark.long)])
@pytest.mark.parametrize("flavour", Flavour)
def test_a_skirmish(flavour: Flavour, size: int) -> None:
    campaign(flavour, seed=1, size=size)


@pytest.mark.long
@pytest.mark.timeout(3000)
@pytest.mark.parametrize("seed", range(5))
@pytest.mark.parametrize("flavour", Flavour)
def test_a_campaign_of_ten_million_bytes(flavour: Flavour, seed: int) -> None:
    campaign(flavour, seed=100 + seed, size=1_000_000)


@pytest.mark.parametrize("flavour", Flavour)
def test_without_the_key_no_traffic_changes_anything(flavour: Flavour) -> None:
    endpoint = endpoint_of(flavour)
    endpoint.signer.install(bytes(range(32)))
    for link in _LINKS:
        endpoint.add_link(link, Rates.SILENT, byte_stream=link == "stream", signing=SigningPolicy.REQUIRED)
    traffic = Traffic(3, sorted(set(endpoint._handlers)))
    before = snapshot(endpoint, without=_PARSING)
    for _ in range(400):
        for link in _LINKS:
            for piece in (traffic.message(None), traffic.message(1), traffic.broken()):
                endpoint.receive(link, piece)
    assert snapshot(endpoint, without=_PARSING) == before
