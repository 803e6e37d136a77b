"""Links over loopback, on ports that the system chooses."""

import os
import socket
import time

import pytest

from mission.errors import LinkError
from mission.link.messages import Codec
from mission.link.transport import LinkTransport, Transport, open_transport

WITHIN_S = 10.0
BEAT = Codec(1, 1).heartbeat()


def take(link: Transport, size: int) -> bytes:
    """Receive until so many bytes have come."""
    taken = b""
    until = time.monotonic() + WITHIN_S
    while len(taken) < size and time.monotonic() < until:
        taken += b"".join(link.receive(0.5))
    return taken


def pair(listening: str, calling: str) -> tuple[LinkTransport, LinkTransport]:
    listener = open_transport(f"{listening}:127.0.0.1:0")
    caller = open_transport(f"{calling}:127.0.0.1:{listener.address.port}")
    return listener, caller


@pytest.mark.parametrize(("listening", "calling"), [("udpin", "udpout"), ("tcpin", "tcp")])
def test_bytes_go_both_ways(listening: str, calling: str) -> None:
    listener, caller = pair(listening, calling)
    try:
        assert listener.address.port > 0
        caller.send(BEAT)
        assert take(listener, len(BEAT)) == BEAT
        listener.send(b"from the listener")
        assert take(caller, 17) == b"from the listener"
    finally:
        caller.close()
        listener.close()


def test_datagrams_stay_whole_and_in_order() -> None:
    listener, caller = pair("udpin", "udpout")
    try:
        sent = [BEAT + bytes([i]) * (i + 1) for i in range(40)]
        for datagram in sent:
            caller.send(datagram)
        received: list[bytes] = []
        until = time.monotonic() + WITHIN_S
        while len(received) < len(sent) and time.monotonic() < until:
            received += listener.receive(0.5)
        assert received == sent
    finally:
        caller.close()
        listener.close()


@pytest.mark.parametrize("listening", ["udpin", "tcpin"])
def test_before_anyone_has_called_what_is_sent_is_lost_without_a_word(listening: str) -> None:
    link = open_transport(f"{listening}:127.0.0.1:0")
    try:
        link.send(b"hello?")
        assert link.receive(0.0) == []
    finally:
        link.close()


def test_every_caller_of_a_listening_udp_port_is_answered() -> None:
    listener = open_transport("udpin:127.0.0.1:0")
    callers = [open_transport(f"udpout:127.0.0.1:{listener.address.port}") for _ in range(2)]
    try:
        for caller in callers:
            caller.send(BEAT)
        assert take(listener, 2 * len(BEAT)) == 2 * BEAT
        listener.send(b"answer")
        assert [take(caller, 6) for caller in callers] == [b"answer", b"answer"]
    finally:
        for link in (*callers, listener):
            link.close()


def test_a_vehicle_that_does_not_listen_yet_is_no_failure() -> None:
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe:
        probe.bind(("127.0.0.1", 0))
        port = probe.getsockname()[1]
    link = open_transport(f"udpout:127.0.0.1:{port}")
    try:
        for _ in range(5):
            link.send(b"anyone?")
            assert link.receive(0.01) == []
    finally:
        link.close()


def test_the_end_of_a_stream_is_a_link_failure_after_the_last_bytes() -> None:
    with socket.create_server(("127.0.0.1", 0)) as server:
        link = open_transport(f"tcp:127.0.0.1:{server.getsockname()[1]}")
        try:
            connection, _ = server.accept()
            connection.sendall(b"last words")
            connection.close()
            assert take(link, 10) == b"last words"
            with pytest.raises(LinkError, match="closed"):
                take(link, 1)
        finally:
            link.close()


@pytest.mark.parametrize("address", ["udpin:127.0.0.1:0", "tcpin:127.0.0.1:0"])
def test_close_does_not_hang_and_may_be_repeated(address: str) -> None:
    link = open_transport(address)
    began = time.monotonic()
    link.close()
    link.close()
    assert time.monotonic() - began < WITHIN_S


def test_a_closed_link_says_so_when_it_is_used() -> None:
    listener, caller = pair("udpin", "udpout")
    caller.close()
    listener.close()
    with pytest.raises(LinkError, match="cannot send"):
        caller.send(b"x")


def test_a_frame_that_a_stream_delivers_in_two_pieces_is_handed_on_whole() -> None:
    frame = Codec(255, 191).heartbeat()
    with socket.create_server(("127.0.0.1", 0)) as server:
        link = open_transport(f"tcp:127.0.0.1:{server.getsockname()[1]}")
        try:
            connection, _ = server.accept()
            connection.sendall(b"noise" + frame[:5])
            assert take(link, 5) == b"noise"
            connection.sendall(frame[5:])
            assert link.receive(WITHIN_S) == [frame]
            connection.close()
        finally:
            link.close()


def test_a_taken_port_is_a_link_failure() -> None:
    listener = open_transport("udpin:127.0.0.1:0")
    try:
        with pytest.raises(LinkError, match=str(listener.address.port)):
            open_transport(f"udpin:127.0.0.1:{listener.address.port}")
    finally:
        listener.close()


@pytest.mark.parametrize("address", ["udpout:no-such-host.invalid:14550", "serial:/dev/there-is-none:57600"])
def test_what_cannot_be_opened_is_a_link_failure(address: str) -> None:
    with pytest.raises(LinkError, match="cannot open"):
        open_transport(address)


def test_a_refused_connection_is_a_link_failure() -> None:
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        port = probe.getsockname()[1]
    with pytest.raises(LinkError, match="cannot open"):
        open_transport(f"tcp:127.0.0.1:{port}")


@pytest.mark.skipif(not hasattr(os, "openpty"), reason="this system has no pseudo-terminals")
def test_a_serial_line() -> None:
    ours, theirs = os.openpty()
    link = open_transport(f"serial:{os.ttyname(theirs)}:57600")
    try:
        os.write(ours, b"from the vehicle")
        assert take(link, 16) == b"from the vehicle"
        link.send(b"to the vehicle")
        assert os.read(ours, 64) == b"to the vehicle"
    finally:
        link.close()
        os.close(ours)
        os.close(theirs)
