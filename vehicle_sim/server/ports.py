"""Sockets, each with the links of the endpoint that run over it: the only place where bytes enter and leave.

Nothing here waits, and no failure of a peer is an error: who does not listen is not listening yet, who hangs up has
hung up.
"""

import contextlib
import errno
import socket
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Final, Protocol

from vehicle_sim.clock import Clock, WallClock
from vehicle_sim.errors import ConfigurationError
from vehicle_sim.protocol.flavour import Rates
from vehicle_sim.protocol.policy import SigningPolicy
from vehicle_sim.server.addresses import Address, Scheme
from vehicle_sim.server.party import Party
from vehicle_sim.server.serial_port import SerialPort
from vehicle_sim.server.stream_link import StreamLink

Notify = Callable[[str], None]

_DATAGRAM: Final = 65535
_BURST: Final = 64
"""Datagrams taken from one socket before the vehicle's time goes on."""

_MOST_PEERS: Final = 32
_SILENT_S: Final = 10.0
"""Wall time; whoever was heard since then is not dropped for another one."""

_WALL: Final = WallClock()
_BUFFER: Final = 1 << 20
_NOBODY_THERE: Final = frozenset(
    (errno.ECONNREFUSED, errno.ECONNRESET, errno.EHOSTUNREACH, errno.ENETUNREACH, errno.ENETDOWN, errno.EPIPE)
)


class Readable(Protocol):
    """What can be waited for: a socket or a line."""

    def fileno(self) -> int:
        """Return its descriptor."""
        ...


class Port(Protocol):
    """One socket or line, and the links over it."""

    address: Address

    def sockets(self) -> Iterator[Readable]:
        """Return what may become readable."""
        ...

    def read(self, ready: Readable, /) -> None:
        """Hand what has come by `ready` to the endpoint."""
        ...

    def flush(self) -> None:
        """Send what the endpoint has queued for the links of this port."""
        ...

    def close(self) -> None:
        """Close all sockets."""
        ...


def open_port(address: Address, party: Party, rates: Rates, notify: Notify) -> Port:
    """Open a port of any scheme.

    Raises:
        ConfigurationError: The address is not this machine's, is taken, or cannot be resolved.
    """
    kinds: dict[Scheme, Callable[[Address, Party, Rates, Notify], Port]] = {
        Scheme.UDP_IN: UdpListener,
        Scheme.UDP_OUT: UdpSpeaker,
        Scheme.TCP_IN: TcpListener,
        Scheme.TCP_OUT: TcpCaller,
        Scheme.SERIAL: SerialPort,
        Scheme.PTY: SerialPort,
    }
    try:
        return kinds[address.scheme](address, party, rates, notify)
    except OSError as error:
        raise ConfigurationError(f"{address}: {error.strerror or error}") from error


def _resolved(address: Address, kind: socket.SocketKind) -> tuple[socket.AddressFamily, tuple[str, int]]:
    family, _, _, _, where = socket.getaddrinfo(address.host, address.port, type=kind)[0]
    return family, (str(where[0]), int(where[1]))


def _quiet_datagram_socket(family: socket.AddressFamily) -> socket.socket:
    opened = socket.socket(family, socket.SOCK_DGRAM)
    opened.setblocking(False)
    with contextlib.suppress(OSError):  # a smaller buffer than asked for still works
        opened.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, _BUFFER)
    return opened


def _datagrams(source: socket.socket) -> Iterator[tuple[bytes, tuple[str, int]]]:
    """Return the datagrams that wait now, each with its sender."""
    for _ in range(_BURST):
        try:
            data, peer = source.recvfrom(_DATAGRAM)
        except (BlockingIOError, InterruptedError):
            return
        except OSError as error:
            if error.errno not in _NOBODY_THERE:
                raise
            continue  # some systems report here that an earlier datagram found nobody
        yield data, (peer[0], peer[1])


def _send(through: socket.socket, datagrams: list[bytes], peer: tuple[str, int]) -> None:
    """Send datagrams; what the network does not take at once is lost, as datagrams are."""
    for datagram in datagrams:
        try:
            through.sendto(datagram, peer)
        except (BlockingIOError, InterruptedError):
            return
        except OSError as error:
            if error.errno not in _NOBODY_THERE:
                raise
            return


@dataclass(slots=True)
class _Peer:
    """Whose link it is that has this name, and when a valid message came by it."""

    name: str
    heard_s: float


class UdpListener:
    """Waits for peers; each one that speaks MAVLink is answered on a link of its own.

    Where there are too many, the longest silent one makes room, but nobody who was heard of late: who flies the
    vehicle goes on flying it, however many strangers call.
    """

    def __init__(self, address: Address, party: Party, rates: Rates, notify: Notify, clock: Clock = _WALL) -> None:
        """Bind; port 0 takes a free one, `address` tells which."""
        family, where = _resolved(address, socket.SOCK_DGRAM)
        self._socket = _quiet_datagram_socket(family)
        try:
            self._socket.bind(where)
        except OSError:
            self._socket.close()
            raise
        self.address = address._replace(port=self._socket.getsockname()[1])
        self._party, self._rates, self._notify, self._clock = party, rates, notify, clock
        self._peers: dict[tuple[str, int], _Peer] = {}
        self._refuses = False

    def sockets(self) -> Iterator[Readable]:
        """Return the one socket."""
        yield self._socket

    def read(self, _ready: Readable) -> None:
        """Handle the datagrams that wait; the first valid one of a stranger makes it a peer."""
        for data, peer in _datagrams(self._socket):
            known = self._peers.get(peer)
            if known is not None:
                if self._party.receive(known.name, data):
                    known.heard_s = self._clock.now_s()
                    # The last one heard stands last, so that the first one is the longest silent.
                    self._peers[peer] = self._peers.pop(peer)
            elif self._has_room():
                self._meet(peer, data)

    def _has_room(self) -> bool:
        if len(self._peers) < _MOST_PEERS:
            return True
        longest_silent = next(iter(self._peers.values()))
        if self._clock.now_s() - longest_silent.heard_s >= _SILENT_S:
            return True
        if not self._refuses:
            self._refuses = True
            self._notify(f"{_MOST_PEERS} peers are heard on {self.address}: others are refused")
        return False

    def _meet(self, peer: tuple[str, int], data: bytes) -> None:
        name = f"{self.address} from {peer[0]}:{peer[1]}"
        _open_link(self._party, name, self.address, self._rates)
        if self._party.receive(name, data) == 0:
            self._party.remove_link(name)
            return
        self._refuses = False
        if len(self._peers) >= _MOST_PEERS:
            silent = self._peers.pop(next(iter(self._peers)))
            self._party.remove_link(silent.name)
            self._notify(f"more than {_MOST_PEERS} peers: the longest silent one is dropped, {silent.name}")
        self._peers[peer] = _Peer(name, self._clock.now_s())

    def flush(self) -> None:
        """Send each peer what waits for it."""
        for peer, known in self._peers.items():
            _send(self._socket, self._party.outgoing(known.name), peer)

    def close(self) -> None:
        """Close the socket and the links of all peers."""
        self._socket.close()
        for known in self._peers.values():
            self._party.remove_link(known.name)
        self._peers.clear()


class UdpSpeaker:
    """Speaks to one address from the start, whether anybody listens there or not."""

    def __init__(self, address: Address, party: Party, rates: Rates, _notify: Notify) -> None:
        """Open a link to `address`."""
        family, self._peer = _resolved(address, socket.SOCK_DGRAM)
        self._socket = _quiet_datagram_socket(family)
        if self._peer[0].startswith("127."):
            self._socket.bind(("127.0.0.1", 0))  # what stays on this machine is not reachable from outside
        self.address = address
        self._party, self._name = party, str(address)
        _open_link(party, self._name, address, rates)

    def sockets(self) -> Iterator[Readable]:
        """Return the one socket."""
        yield self._socket

    def read(self, _ready: Readable) -> None:
        """Handle the datagrams that wait, if they come from the host that is spoken to."""
        for data, peer in _datagrams(self._socket):
            if peer[0] == self._peer[0]:
                self._party.receive(self._name, data)

    def flush(self) -> None:
        """Send what waits."""
        _send(self._socket, self._party.outgoing(self._name), self._peer)

    def close(self) -> None:
        """Close the socket and its link."""
        self._socket.close()
        self._party.remove_link(self._name)


def _open_link(party: Party, name: str, address: Address, rates: Rates) -> None:
    """Open a link of datagrams that belongs to an address."""
    signing = address.signing or SigningPolicy.REQUIRED
    party.add_link(name, rates, signing=signing, is_secure=address.is_local)


def _stream(connection: socket.socket, name: str, address: Address, party: Party, rates: Rates) -> StreamLink:
    """Open the link over a connection."""
    connection.setblocking(False)
    connection.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
    return StreamLink(
        party, name, address, rates, receive=connection.recv, send=connection.send, close=connection.close
    )


class TcpListener:
    """A TCP server: each connection is a link."""

    def __init__(self, address: Address, party: Party, rates: Rates, notify: Notify) -> None:
        """Listen; port 0 takes a free one, `address` tells which."""
        family, where = _resolved(address, socket.SOCK_STREAM)
        self._socket = socket.create_server(where, family=family)
        self._socket.setblocking(False)
        self.address = address._replace(port=self._socket.getsockname()[1])
        self._party, self._rates, self._notify = party, rates, notify
        self._links: dict[Readable, StreamLink] = {}

    def sockets(self) -> Iterator[Readable]:
        """Return the listening socket and the connections."""
        yield self._socket
        yield from self._links

    def read(self, ready: Readable) -> None:
        """Accept a connection, or handle what came by one."""
        if ready is self._socket:
            self._accept()
        elif ready in self._links and not self._links[ready].read():
            self._links.pop(ready).close()

    def _accept(self) -> None:
        try:
            connection, peer = self._socket.accept()
        except OSError:
            return  # it has hung up already
        if len(self._links) >= _MOST_PEERS:
            connection.close()
            self._notify(f"more than {_MOST_PEERS} connections to {self.address}: another one is refused")
            return
        name = f"{self.address} from {peer[0]}:{peer[1]}"
        self._links[connection] = _stream(connection, name, self.address, self._party, self._rates)

    def flush(self) -> None:
        """Send each connection what waits for it."""
        for connection, link in list(self._links.items()):
            if not link.flush():
                self._links.pop(connection).close()

    def close(self) -> None:
        """Close all connections and the listening socket."""
        for link in self._links.values():
            link.close()
        self._links.clear()
        self._socket.close()


class TcpCaller:
    """Connects to a TCP server once, at the start."""

    def __init__(self, address: Address, party: Party, rates: Rates, notify: Notify) -> None:
        """Connect to `address`, waiting a few seconds at most."""
        self._connection = socket.create_connection((address.host, address.port), timeout=3.0)
        self.address = address
        self._notify = notify
        self._link: StreamLink | None = _stream(self._connection, str(address), address, party, rates)

    def sockets(self) -> Iterator[Readable]:
        """Return the connection while it stands."""
        if self._link is not None:
            yield self._connection

    def read(self, _ready: Readable) -> None:
        """Handle what has come."""
        if self._link is not None and not self._link.read():
            self._hung_up()

    def flush(self) -> None:
        """Send what waits."""
        if self._link is not None and not self._link.flush():
            self._hung_up()

    def _hung_up(self) -> None:
        self.close()
        self._notify(f"{self.address} hung up")

    def close(self) -> None:
        """Close the connection."""
        if self._link is not None:
            self._link.close()
            self._link = None
