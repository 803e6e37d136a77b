"""Pacing against a clock of the test, and real sockets on loopback with free ports."""

import os
import select
import socket
import tty
from collections import Counter
from collections.abc import Iterator
from contextlib import closing
from typing import TYPE_CHECKING

import pytest
import serial
from hypothesis import given
from hypothesis import strategies as st
from pymavlink.dialects.v20 import ardupilotmega as mavlink

from tests.support.drawn_cases import tried
from tests.support.port_bench import Bench, frame, received, turn_until, udp
from vehicle_sim.clock import WallClock
from vehicle_sim.errors import ConfigurationError
from vehicle_sim.protocol.flavour import Rates
from vehicle_sim.server.addresses import parse_address
from vehicle_sim.server.patience import Patience
from vehicle_sim.server.ports import TcpListener, UdpListener, open_port
from vehicle_sim.server.server import Pacer, Server

if TYPE_CHECKING:
    from vehicle_sim.protocol.endpoint import Endpoint


def test_steps_fall_due_at_their_moments() -> None:
    pacer = Pacer(step_s=0.01, speed=2.0, now_s=100.0)
    assert pacer.due(100.0049) == 0
    assert pacer.wait_s(100.004) == pytest.approx(0.001)
    assert pacer.due(100.0051) == 1
    pacer.made(1)
    assert pacer.due(100.0251) == 4
    pacer.made(4)
    assert pacer.slowed_to is None


@tried(50)
@given(st.lists(st.floats(0.0, 0.05), min_size=1, max_size=200), st.floats(0.1, 50.0))
def test_no_step_is_lost_or_early_while_the_machine_keeps_up(waits: list[float], speed: float) -> None:
    pacer, now_s, made = Pacer(step_s=0.01, speed=speed, now_s=0.0), 0.0, 0
    for wait_s in waits:
        now_s += wait_s
        steps = pacer.due(now_s)
        pacer.made(steps)
        made += steps
        assert made <= now_s * speed / 0.01 + 1e-6
        assert made >= now_s * speed / 0.01 - 1.0 - 1e-6


def test_a_machine_that_is_too_slow_slows_vehicle_time() -> None:
    pacer, now_s, made = Pacer(step_s=0.01, speed=10.0, now_s=0.0), 0.0, 0
    while now_s < 20.0:
        steps = min(pacer.due(now_s), 2)
        pacer.made(steps)
        made += steps
        now_s += 0.005  # two steps cost 5 ms: four times real time and no more
    assert made * 0.01 == pytest.approx(4.0 * now_s, rel=0.02)
    assert pacer.slowed_to == pytest.approx(4.0, rel=0.05)


def test_a_pause_of_the_machine_is_no_reason_to_complain() -> None:
    pacer, now_s = Pacer(step_s=0.01, speed=1.0, now_s=0.0), 0.0
    for second in range(60):
        now_s += 1.5 if second == 0 else 0.09
        pacer.made(pacer.due(now_s))
    assert pacer.slowed_to is None


def test_the_speed_is_positive() -> None:
    with pytest.raises(ValueError, match="positive"):
        Pacer(step_s=0.01, speed=0.0, now_s=0.0)


@pytest.fixture
def bench() -> Iterator[Bench]:
    bench = Bench()
    yield bench
    for port in bench.ports:
        port.close()


def test_udp_peers_are_learned_and_answered_each_for_itself(bench: Bench) -> None:
    port = bench.open("udpin:127.0.0.1:0")
    where = ("127.0.0.1", port.address.port)
    with closing(udp()) as one, closing(udp()) as two:
        for peer in (one, two):
            peer.sendto(frame(), where)
            assert "HEARTBEAT" in turn_until(bench, peer, "TIMESYNC") + turn_until(bench, peer, "HEARTBEAT")


def test_peers_of_both_versions_on_one_port_are_each_answered_in_their_own(bench: Bench) -> None:
    port = bench.open("udpin:127.0.0.1:0")
    where = ("127.0.0.1", port.address.port)
    with closing(udp()) as old, closing(udp()) as new:
        mav = mavlink.MAVLink(None, srcSystem=254, srcComponent=190)
        old.sendto(mavlink.MAVLink_timesync_message(0, 7).pack(mav, force_mavlink1=True), where)
        new.sendto(frame(), where)
        for peer, magic in ((old, 0xFE), (new, 0xFD)):
            starts: set[int] = set()
            for _ in range(2000):
                bench.turn()
                while select.select([peer], [], [], 0.0)[0]:
                    data = peer.recv(65535)
                    starts.add(data[0])
                    assert mavlink.MAVLink(None).parse_buffer(data)
                if starts and bench.endpoint.vehicle.time_s > 2.0:
                    break
            # What one says to all is passed on to the other, in the version that it came in; version 1 is read by all.
            assert starts <= ({magic} if magic == 0xFE else {0xFE, 0xFD})
            assert magic in starts


def test_strangers_that_speak_no_mavlink_are_not_answered(bench: Bench) -> None:
    port = bench.open("udpin:127.0.0.1:0")
    with closing(udp()) as stranger, closing(udp()) as peer:
        stranger.sendto(b"GET / HTTP/1.1\r\n\r\n", ("127.0.0.1", port.address.port))
        peer.sendto(frame(), ("127.0.0.1", port.address.port))
        turn_until(bench, peer, "HEARTBEAT")
        assert received(stranger) == []


class _HandClock:
    """Wall time that passes when a test says so."""

    def __init__(self) -> None:
        self.time_s = 0.0

    def now_s(self) -> float:
        return self.time_s


def test_who_flies_the_vehicle_is_answered_however_many_strangers_call(bench: Bench) -> None:
    clock = _HandClock()
    port = UdpListener(parse_address("udpin:127.0.0.1:0"), bench.endpoint, Rates.SILENT, bench.said.append, clock)
    bench.ports.append(port)
    flying, strangers = udp(), [udp() for _ in range(70)]
    there = ("127.0.0.1", port.address.port)
    try:
        for round_of in range(3):
            flying.sendto(frame(), there)
            turn_until(bench, flying, "TIMESYNC")
            for stranger in strangers:
                stranger.sendto(frame(), there)
            for _ in range(5):
                bench.turn()
            clock.time_s += 4.0
            assert len(port._peers) == len(bench.endpoint._links) == 32, round_of
        assert len([said for said in bench.said if "others are refused" in said]) == 1
        # Once strangers are silent, whoever comes gets the place of the longest silent one.
        clock.time_s += 7.0
        flying.sendto(frame(), there)
        turn_until(bench, flying, "TIMESYNC")
        with closing(udp()) as late:
            late.sendto(frame(), there)
            turn_until(bench, late, "TIMESYNC")
        flying.sendto(frame(), there)
        turn_until(bench, flying, "TIMESYNC")
        assert [said for said in bench.said if "longest silent" in said]
        assert len(port._peers) == len(bench.endpoint._links) == 32
    finally:
        for peer in (flying, *strangers):
            peer.close()


def test_a_ground_station_is_spoken_to_before_it_speaks_and_may_be_absent(bench: Bench) -> None:
    with closing(udp()) as gone:
        address = f"udpout:127.0.0.1:{gone.getsockname()[1]}"
    bench.open(address)
    for _ in range(250):
        bench.turn()  # nobody listens: nothing happens
    with closing(socket.socket(socket.AF_INET, socket.SOCK_DGRAM)) as station:
        station.bind(("127.0.0.1", int(address.rpartition(":")[2])))
        turn_until(bench, station, "HEARTBEAT")
        _, vehicle = select.select([], [station], [], 0.0)[:2]
        assert vehicle


def test_a_ground_station_is_heard(bench: Bench) -> None:
    with closing(udp()) as station:
        bench.open(f"udpout:127.0.0.1:{station.getsockname()[1]}")
        bench.endpoint.advance()
        bench.ports[0].flush()
        assert select.select([station], [], [], 5.0)[0]
        _, vehicle = station.recvfrom(65535)
        station.sendto(frame(), vehicle)
        turn_until(bench, station, "TIMESYNC")


def test_tcp_serves_several_and_survives_hang_ups(bench: Bench) -> None:
    port = bench.open("tcpin:127.0.0.1:0")
    assert isinstance(port, TcpListener)
    where = ("127.0.0.1", port.address.port)
    with closing(socket.create_connection(where)) as one, closing(socket.create_connection(where)) as two:
        for byte in frame():
            one.send(bytes([byte]))
        turn_until(bench, one, "TIMESYNC")
        two.close()
        turn_until(bench, one, "HEARTBEAT")
        for _ in range(5000):
            if len(bench.endpoint._links) == 1:
                break
            bench.turn()
        assert len(bench.endpoint._links) == 1


def test_a_tcp_peer_that_never_reads_costs_bounded_memory(bench: Bench) -> None:
    port = bench.open("tcpin:127.0.0.1:0", Rates.SILENT)
    assert isinstance(port, TcpListener)
    with closing(socket.create_connection(("127.0.0.1", port.address.port))) as lazy:
        bench.turn()
        (name,) = bench.endpoint._links
        for _ in range(40):
            for _ in range(5_000):
                bench.endpoint._links[name].forward(frame())
            bench.turn()
        (link,) = port._links.values()
        assert len(link._unsent) < (1 << 20) + 1400
        lazy.close()
        for _ in range(5000):
            if not bench.endpoint._links:
                break
            bench.turn()
        assert not bench.endpoint._links


@pytest.mark.skipif(not hasattr(os, "openpty"), reason="this system has no pseudo terminals")
def test_a_pseudo_terminal_is_a_serial_line_whose_clients_come_and_go(bench: Bench) -> None:
    port = bench.open("pty:")
    assert port.address.host.startswith("/dev/")
    for _ in range(1000):
        bench.turn()  # nobody reads: what is sent is lost, and little is kept
    for _ in range(2):
        with serial.Serial(port.address.host, 57600, timeout=0.0) as client:
            client.write(frame())
            parser, kinds = mavlink.MAVLink(None), set[str]()
            parser.robust_parsing = True
            for _ in range(5000):
                bench.turn()
                kinds |= {message.get_type() for message in parser.parse_buffer(client.read(4096)) or ()}
                if {"TIMESYNC", "HEARTBEAT"} <= kinds:
                    break
            assert {"TIMESYNC", "HEARTBEAT"} <= kinds
    port.close()
    assert not bench.endpoint._links
    assert not list(port.sockets())


@pytest.mark.skipif(not hasattr(os, "openpty"), reason="this system has no pseudo terminals")
def test_a_line_that_is_read_too_slowly_carries_each_stream_and_none_late(bench: Bench) -> None:
    port = bench.open("pty:")
    (link,) = bench.endpoint._links.values()
    link.streams.start(mavlink.MAVLINK_MSG_ID_ATTITUDE, 10_000, 0)
    link.streams.start(mavlink.MAVLINK_MSG_ID_ATTITUDE_QUATERNION, 10_000, 0)
    link.streams.start(mavlink.MAVLINK_MSG_ID_EKF_STATUS_REPORT, 500_000, 0)
    heard, late_us = Counter[str](), 0
    parser = mavlink.MAVLink(None)
    parser.robust_parsing = True
    with serial.Serial(port.address.host, 57600, timeout=0.0) as client:
        for _ in range(1_000):  # ten seconds, in which a fifth of what is asked for can be read
            bench.turn()
            for message in parser.parse_buffer(client.read(16)) or ():
                heard[message.get_type()] += 1
                late_us = max(late_us, bench.endpoint.now_us - 1_000 * getattr(message, "time_boot_ms", 1 << 32))
    assert late_us < 2_000_000
    assert 8 <= heard["EKF_STATUS_REPORT"] <= 20
    assert 100 < heard["ATTITUDE"] < 500
    assert heard["ATTITUDE_QUATERNION"] == pytest.approx(heard["ATTITUDE"], abs=5)


@pytest.mark.skipif(not hasattr(os, "openpty"), reason="this system has no pseudo terminals")
def test_a_serial_device_is_spoken_to_and_its_loss_is_told(bench: Bench) -> None:
    ours, theirs = os.openpty()
    tty.setraw(theirs)
    bench.open(f"serial:{os.ttyname(theirs)}:57600")
    os.close(theirs)
    os.write(ours, frame())
    heard = b""
    parser = mavlink.MAVLink(None)
    for _ in range(2000):
        bench.turn()
        if select.select([ours], [], [], 0.0)[0]:
            heard = os.read(ours, 4096)
            break
    assert "TIMESYNC" in {message.get_type() for message in parser.parse_buffer(heard)}
    os.close(ours)
    for _ in range(2000):
        if bench.said:
            break
        bench.turn()
    assert "has failed" in bench.said[0]
    assert not bench.endpoint._links


def test_tcp_out_calls_and_says_when_the_other_end_hangs_up(bench: Bench) -> None:
    with closing(socket.create_server(("127.0.0.1", 0))) as server:
        bench.open(f"tcp:127.0.0.1:{server.getsockname()[1]}")
        connection, _ = server.accept()
        with closing(connection):
            turn_until(bench, connection, "HEARTBEAT")
        for _ in range(5000):
            if bench.said:
                break
            bench.turn()
        assert any("hung up" in said for said in bench.said)
        assert not list(bench.ports[0].sockets())


def test_addresses_that_cannot_be_had_are_named(bench: Bench) -> None:
    taken = bench.open("udpin:127.0.0.1:0").address
    listening = bench.open("tcpin:127.0.0.1:0").address
    for address in (taken, listening):
        with pytest.raises(ConfigurationError, match=str(address.port)):
            open_port(address, bench.endpoint, Rates.SILENT, bench.said.append)
    with pytest.raises(ConfigurationError, match="no-such-host"):
        open_port(parse_address("udpin:no-such-host.invalid:5"), bench.endpoint, Rates.SILENT, bench.said.append)


def test_the_server_flies_at_speed_and_answers(bench: Bench) -> None:
    port = bench.open("udpin:127.0.0.1:0")
    server = Server([bench.endpoint], bench.ports, clock=WallClock(), notify=bench.said.append)
    with closing(udp()) as peer:
        peer.sendto(frame(), ("127.0.0.1", port.address.port))
        server.run(50.0, lambda: bench.endpoint.vehicle.time_s >= 5.0)
        kinds = received(peer)
    assert 4 <= kinds.count("HEARTBEAT") <= 6
    assert "TIMESYNC" in kinds
    port.close()
    assert not bench.endpoint._links


def test_a_vehicle_that_is_served_restarts_on_request_and_its_peers_keep_their_links(bench: Bench) -> None:
    port = bench.open("udpin:127.0.0.1:0")
    endpoint = bench.endpoint
    server = Server([endpoint], bench.ports, clock=WallClock(), notify=bench.said.append)
    with closing(udp()) as peer:
        peer.sendto(frame(), ("127.0.0.1", port.address.port))
        server.run(50.0, lambda: endpoint.vehicle.time_s >= 3.0)
        reboot = mavlink.MAVLink_command_long_message(1, 1, mavlink.MAV_CMD_PREFLIGHT_REBOOT_SHUTDOWN, 0, 1, *(0,) * 6)
        peer.sendto(
            reboot.pack(mavlink.MAVLink(None, srcSystem=255, srcComponent=190)), ("127.0.0.1", port.address.port)
        )
        server.run(50.0, lambda: endpoint.vehicle.time_s < 3.0)
        assert "COMMAND_ACK" in received(peer)
        server.run(50.0, lambda: endpoint.vehicle.time_s >= 3.5)
        assert 2 <= received(peer).count("HEARTBEAT") <= 4
    assert bench.said == []


class SlowClock:
    """A clock on which everything takes long: each look at it costs 50 ms."""

    def __init__(self) -> None:
        self.time_s = 0.0

    def now_s(self) -> float:
        self.time_s += 0.05
        return self.time_s


def test_the_server_says_once_that_it_cannot_keep_up(bench: Bench) -> None:
    clock = SlowClock()
    Server([bench.endpoint], [], clock=clock, notify=bench.said.append).run(10.0, lambda: clock.time_s > 20.0)
    (said,) = bench.said
    assert "cannot keep up 10 times real time" in said
    # Two looks at the clock and two steps of 10 ms in each turn.
    assert bench.endpoint.vehicle.time_s == pytest.approx(20.0 * 0.02 / 0.1, rel=0.05)


class StubbornClock:
    """A clock that goes on by 0.2 ms at each look, and a client that falls silent after so much vehicle time."""

    def __init__(self, endpoint: "Endpoint", silent_from_s: float) -> None:
        self.time_s = 0.0
        self._endpoint, self._silent_from_s, self._next_s = endpoint, silent_from_s, 0.0
        endpoint.add_link("client", Rates.SILENT)

    def now_s(self) -> float:
        self.time_s += 0.0002
        if self._next_s <= self._endpoint.vehicle.time_s < self._silent_from_s:
            self._next_s += 1.0
            beat = mavlink.MAVLink_heartbeat_message(mavlink.MAV_TYPE_GCS, 8, 0, 0, 4, 3)
            self._endpoint.receive("client", beat.pack(mavlink.MAVLink(None, srcSystem=255, srcComponent=190)))
        return self.time_s


@pytest.mark.parametrize(("speed", "most_s"), [(20.0, 0.0), (20.0, 3.0), (1.0, 3.0)])
def test_vehicle_time_waits_once_for_a_client_that_has_died(
    bench: Bench, monkeypatch: pytest.MonkeyPatch, speed: float, most_s: float
) -> None:
    monkeypatch.setattr(select, "select", lambda *_: ([], [], []))
    clock = StubbornClock(bench.endpoint, silent_from_s=6.5)
    patience = [Patience(most_s)] if most_s else []
    server = Server([bench.endpoint], [], clock=clock, notify=bench.said.append, patience=patience)
    server.run(speed, lambda: bench.endpoint.vehicle.time_s >= 20.0)
    waited_s = most_s if speed > 1.0 else 0.0
    assert clock.time_s == pytest.approx(20.0 / speed + waited_s, abs=0.02)
    assert any("waiting for clients" in said for said in bench.said) == (waited_s > 0.0)
