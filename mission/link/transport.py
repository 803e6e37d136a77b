"""Links: the only sockets and serial lines of the planner.

Each link reads in a thread of its own, so that what arrives while the flight loop computes is not lost in the
operating system's small buffers and is there without delay when the loop asks. Bytes go out as they are given.
"""

import contextlib
import selectors
import socket
import threading
import time
from collections import deque
from collections.abc import Callable, Mapping
from typing import Final, Protocol

import serial

from mission.errors import LinkError, reason
from mission.link.address import Address, Scheme, parse_address
from mission.link.framing import Stream
from mission.link.peers import Peers

_POLL_S: Final = 0.1
_CONNECT_S: Final = 5.0
_SEND_S: Final = 2.0
_MOST_WAITING: Final = 1 << 16
_DATAGRAM: Final = 65535
_BUFFER: Final = 1 << 20
_STREAMS: Final = (Scheme.TCP_IN, Scheme.TCP_OUT, Scheme.SERIAL)


class Transport(Protocol):
    """Carries bytes to the vehicle and back."""

    def send(self, data: bytes) -> None:
        """Send one or more whole frames; lost without a word where nobody listens yet."""
        ...

    def receive(self, within_s: float) -> list[bytes]:
        """What has arrived, oldest first, waiting at most that long for the first piece; no frame spans two pieces."""
        ...

    def close(self) -> None:
        """Release everything; may be called again."""
        ...


class _Line(Protocol):
    """What differs between the kinds of links."""

    def read(self) -> bytes | None:
        """Wait a moment for bytes; empty where none came, None where the other side has ended the link."""
        ...

    def write(self, data: bytes) -> None: ...

    def close(self) -> None: ...


class LinkTransport:
    """A transport over one line.

    Attributes:
        address: What it is bound to or calls; a listening port that was left open is filled in.
    """

    def __init__(self, line: _Line, address: Address) -> None:
        """Begin to read."""
        self.address = address
        self._line = line
        self._stream = Stream() if address.scheme in _STREAMS else None
        self._waiting: deque[bytes] = deque(maxlen=_MOST_WAITING)  # who reads minutes too late loses the oldest
        self._arrived = threading.Condition()
        self._closing = False
        self._failure = ""
        self._reader = threading.Thread(target=self._read, name=f"link {address}", daemon=True)
        self._reader.start()

    def send(self, data: bytes) -> None:
        """Send bytes.

        Raises:
            LinkError: The link is closed or broken.
        """
        try:
            self._line.write(data)
        except ConnectionRefusedError:
            return  # a datagram to a vehicle that does not listen yet, or no longer: silence will tell
        except (OSError, serial.SerialException) as error:
            raise LinkError(f"cannot send over {self.address}: {reason(error)}") from error

    def receive(self, within_s: float) -> list[bytes]:
        """Take what has arrived.

        Raises:
            LinkError: The link is broken, and all that had arrived before was taken.
        """
        with self._arrived:
            if not self._waiting and not self._failure and within_s > 0.0:
                self._arrived.wait(min(within_s, threading.TIMEOUT_MAX))
            arrived = list(self._waiting)
            self._waiting.clear()
            if not arrived and self._failure:
                raise LinkError(self._failure)
        return arrived

    def close(self) -> None:
        """End the reading thread and release the line."""
        self._closing = True
        self._reader.join(timeout=1.0)
        with contextlib.suppress(OSError, serial.SerialException):
            self._line.close()

    def _read(self) -> None:
        failure = ""
        while not self._closing and not failure:
            data: bytes | None = b""
            try:
                data = self._line.read()
                if data and self._stream is not None:
                    data = self._stream.take(data)
            except ConnectionRefusedError:
                continue  # the answer to a datagram that nobody was there to take
            except (OSError, serial.SerialException) as error:
                failure = f"{self.address} failed: {reason(error)}"
            if data is None:
                failure = f"the other side closed {self.address}"
            if data or failure:
                with self._arrived:
                    self._failure = failure
                    if data:
                        self._waiting.append(data)
                    self._arrived.notify_all()


class _Socket:
    """A socket and the means to wait for it."""

    def __init__(self, link: socket.socket) -> None:
        self.socket = link
        self._selector = selectors.DefaultSelector()
        self._selector.register(link, selectors.EVENT_READ)

    def readable(self) -> bool:
        return bool(self._selector.select(_POLL_S))

    def close(self) -> None:
        self._selector.close()
        self.socket.close()


class _UdpOut:
    """Datagrams to one vehicle, and from it alone."""

    def __init__(self, address: Address) -> None:
        self._socket = _Socket(_udp_socket(address, bound=False))

    def read(self) -> bytes:
        return self._socket.socket.recv(_DATAGRAM) if self._socket.readable() else b""

    def write(self, data: bytes) -> None:
        self._socket.socket.send(data)

    def close(self) -> None:
        self._socket.close()


class _UdpIn:
    """Datagrams from every vehicle that calls; answers go to all who were heard of late."""

    def __init__(self, address: Address, is_genuine: Callable[[bytes], bool] | None) -> None:
        link = _udp_socket(address, bound=True)
        self.port = int(link.getsockname()[1])
        self._socket = _Socket(link)
        self._peers = Peers(is_genuine)
        self._lock = threading.Lock()

    def read(self) -> bytes:
        if not self._socket.readable():
            return b""
        data, peer = self._socket.socket.recvfrom(_DATAGRAM)
        with self._lock:
            return data if self._peers.take(peer, data, time.monotonic()) else b""

    def write(self, data: bytes) -> None:
        with self._lock:
            peers = self._peers.present(time.monotonic())
        for peer in peers:
            with contextlib.suppress(ConnectionError):
                self._socket.socket.sendto(data, peer)

    def close(self) -> None:
        self._socket.close()


class _TcpOut:
    """A stream to a vehicle that listens."""

    def __init__(self, address: Address) -> None:
        link = socket.create_connection((address.host, address.port), timeout=_CONNECT_S)
        self._socket = _stream(link)

    def read(self) -> bytes | None:
        return _read_stream(self._socket)

    def write(self, data: bytes) -> None:
        self._socket.socket.sendall(data)

    def close(self) -> None:
        self._socket.close()


class _TcpIn:
    """A stream from the first vehicle that calls; what is sent before is lost."""

    def __init__(self, address: Address) -> None:
        family = socket.AF_INET6 if ":" in address.host else socket.AF_INET
        listener = socket.create_server((address.host, address.port), family=family)
        self.port = int(listener.getsockname()[1])
        self._listener = _Socket(listener)
        self._socket: _Socket | None = None

    def read(self) -> bytes | None:
        if self._socket is None:
            if self._listener.readable():
                self._socket = _stream(self._listener.socket.accept()[0])
            return b""
        return _read_stream(self._socket)

    def write(self, data: bytes) -> None:
        if self._socket is not None:
            self._socket.socket.sendall(data)

    def close(self) -> None:
        self._listener.close()
        if self._socket is not None:
            self._socket.close()


class _Serial:
    """A serial line."""

    def __init__(self, address: Address) -> None:
        self._serial = serial.Serial(address.host, address.port, timeout=_POLL_S, write_timeout=_SEND_S)

    def read(self) -> bytes:
        first: bytes = self._serial.read(1)
        return first + self._serial.read(self._serial.in_waiting) if first else b""

    def write(self, data: bytes) -> None:
        self._serial.write(data)

    def close(self) -> None:
        self._serial.close()


_LINES: Final[Mapping[Scheme, Callable[[Address], _Line]]] = {
    Scheme.UDP_OUT: _UdpOut,
    Scheme.TCP_IN: _TcpIn,
    Scheme.TCP_OUT: _TcpOut,
    Scheme.SERIAL: _Serial,
}


def open_transport(address: str, is_genuine: Callable[[bytes], bool] | None = None) -> LinkTransport:
    """Open the link that an address names; see ``parse_address`` for the forms.

    Args:
        address: The link.
        is_genuine: Judges the frames of whoever calls a port that listens for datagrams: only a vehicle of which one
            passes is heard and answered. None lets any vehicle's pass.

    Raises:
        SpecError: The address is none.
        LinkError: It cannot be opened: the port is taken, the host unknown, nobody listens, no such device.
    """
    parsed = parse_address(address)
    try:
        line = _UdpIn(parsed, is_genuine) if parsed.scheme is Scheme.UDP_IN else _LINES[parsed.scheme](parsed)
    except (OSError, serial.SerialException, OverflowError, UnicodeError) as error:
        raise LinkError(f"cannot open {parsed}: {reason(error)}") from error
    if isinstance(line, (_UdpIn, _TcpIn)):
        parsed = Address(parsed.scheme, parsed.host, line.port)
    return LinkTransport(line, parsed)


def _udp_socket(address: Address, *, bound: bool) -> socket.socket:
    family, kind, protocol, _, place = socket.getaddrinfo(address.host, address.port, type=socket.SOCK_DGRAM)[0]
    link = socket.socket(family, kind, protocol)
    try:
        link.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, _BUFFER)
        if bound:
            link.bind(place)
        else:
            link.connect(place)
    except OSError:
        link.close()
        raise
    return link


def _stream(link: socket.socket) -> _Socket:
    link.settimeout(_SEND_S)
    link.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
    return _Socket(link)


def _read_stream(link: _Socket) -> bytes | None:
    """Bytes of a stream; None at its end."""
    if not link.readable():
        return b""
    return link.socket.recv(_DATAGRAM) or None
