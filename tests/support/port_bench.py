"""One vehicle over real sockets on loopback, turned by hand: a look at the sockets, a step, and what is due is sent."""

import select
import socket

from pymavlink.dialects.v20 import ardupilotmega as mavlink

from tests.support.station import endpoint_of
from vehicle_sim.parameters import Flavour
from vehicle_sim.protocol.flavour import Rates
from vehicle_sim.server.addresses import parse_address
from vehicle_sim.server.ports import Port, open_port


class Bench:
    """A server that is stopped by a predicate, and what it said."""

    def __init__(self, flavour: Flavour = Flavour.ARDUPILOT) -> None:
        self.endpoint = endpoint_of(flavour)
        self.said: list[str] = []
        self.ports: list[Port] = []

    def open(self, text: str, rates: Rates = Rates.SILENT) -> Port:
        port = open_port(parse_address(text), self.endpoint, rates, self.said.append)
        self.ports.append(port)
        return port

    def turn(self) -> None:
        """Take one look at the sockets, make one step, send."""
        sources = {source: port for port in self.ports for source in port.sockets()}
        for source in select.select(list(sources), [], [], 0.001)[0]:
            sources[source].read(source)
        self.endpoint.advance()
        for port in self.ports:
            port.flush()


def frame(system: int = 255) -> bytes:
    mav = mavlink.MAVLink(None, srcSystem=system, srcComponent=190)
    packed: bytes = mavlink.MAVLink_timesync_message(0, 7).pack(mav)
    return packed


def received(source: socket.socket) -> list[str]:
    parser = mavlink.MAVLink(None)
    parser.robust_parsing = True
    kinds: list[str] = []
    while select.select([source], [], [], 0.0)[0]:
        data = source.recv(65535)
        if not data:
            return [*kinds, "END"]
        kinds += [message.get_type() for message in parser.parse_buffer(data) or ()]
    return kinds


def turn_until(bench: Bench, source: socket.socket, wanted: str) -> list[str]:
    kinds: list[str] = []
    for _ in range(5000):
        bench.turn()
        kinds += received(source)
        if wanted in kinds:
            return kinds
    raise AssertionError(f"no {wanted} among {kinds}")


def udp() -> socket.socket:
    opened = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
    opened.bind(("127.0.0.1", 0))
    return opened
