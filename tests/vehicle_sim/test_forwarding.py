"""Messages between the links of a vehicle, over real sockets and a real line."""

import os
import select
import socket
from contextlib import closing

import pytest
import serial
from pymavlink.dialects.v20 import ardupilotmega as mavlink

from tests.support.port_bench import Bench, udp
from vehicle_sim.protocol.dialect import Message


class Peer:
    """A MAVLink component; `heard` says what it was sent, and by whom."""

    def __init__(self, system: int, component: int) -> None:
        self.mav = mavlink.MAVLink(None, srcSystem=system, srcComponent=component)
        self.parser = mavlink.MAVLink(None)
        self.parser.robust_parsing = True
        self.heard: list[tuple[str, int]] = []

    def packed(self, message: Message) -> bytes:
        frame: bytes = message.pack(self.mav)
        self.mav.seq = (self.mav.seq + 1) % 256
        return frame

    def take(self, data: bytes) -> None:
        self.heard += [(m.get_type(), m.get_srcSystem()) for m in self.parser.parse_buffer(data) or ()]


@pytest.mark.skipif(not hasattr(os, "openpty"), reason="this system has no pseudo terminals")
def test_a_ground_station_a_companion_and_a_radio_talk_over_the_vehicle() -> None:
    bench = Bench()
    tcp, datagrams, line = (bench.open(text) for text in ("tcpin:127.0.0.1:0", "udpin:127.0.0.1:0", "pty:"))
    station, companion, tablet = Peer(255, 190), Peer(245, 191), Peer(254, 190)
    where = ("127.0.0.1", datagrams.address.port)
    with (
        closing(socket.create_connection(("127.0.0.1", tcp.address.port))) as stream,
        closing(udp()) as socket_,
        closing(serial.Serial(line.address.host, 57600, timeout=0.0)) as radio,
    ):
        beat = mavlink.MAVLink_heartbeat_message(6, 8, 0, 0, 4, 3)
        stream.sendall(station.packed(beat))
        socket_.sendto(companion.packed(beat), where)
        radio.write(tablet.packed(beat))

        def turn(times: int) -> None:
            for _ in range(times):
                bench.turn()
                if select.select([stream], [], [], 0.0)[0]:
                    station.take(stream.recv(65535))
                while select.select([socket_], [], [], 0.0)[0]:
                    companion.take(socket_.recv(65535))
                tablet.take(radio.read(65535))

        turn(50)
        for peer in (station, companion, tablet):
            peer.heard.clear()
        # To one: there only. To all, and from the vehicle itself: everywhere but back.
        stream.sendall(station.packed(mavlink.MAVLink_param_request_list_message(245, 191)))
        socket_.sendto(companion.packed(mavlink.MAVLink_statustext_message(6, b"here", 0, 0)), where)
        radio.write(tablet.packed(mavlink.MAVLink_command_long_message(1, 1, 31000, 0, *(0,) * 7)))
        for _ in range(100):
            turn(10)
            if ("COMMAND_ACK", 1) in tablet.heard and ("PARAM_REQUEST_LIST", 255) in companion.heard:
                break
        turn(10)
    for port in bench.ports:
        port.close()
    foreign = {id(peer): {h for h in peer.heard if h[0] != "HEARTBEAT"} for peer in (station, companion, tablet)}
    assert foreign[id(station)] == {("STATUSTEXT", 245)}
    assert foreign[id(companion)] == {("PARAM_REQUEST_LIST", 255)}
    assert foreign[id(tablet)] == {("STATUSTEXT", 245), ("COMMAND_ACK", 1)}
    assert not bench.endpoint._links
