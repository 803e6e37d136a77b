"""A link over a stream of bytes: a TCP connection or a serial line. What is not taken at once waits in order.

While the line is full, streams wait before they are made: what waited in it for seconds, once it had been made, would
tell of a vehicle that has flown on.
"""

import contextlib
from collections.abc import Callable
from typing import Final

from vehicle_sim.protocol.flavour import Rates
from vehicle_sim.protocol.policy import SigningPolicy
from vehicle_sim.server.addresses import Address
from vehicle_sim.server.party import Party

_CHUNK: Final = 65535
MOST_UNSENT: Final = 1 << 20
_MOST_UNREAD: Final = 1024
"""Bytes, some tens of messages: what an autopilot keeps for a serial line."""


class StreamLink:
    """One stream, read and written without waiting."""

    def __init__(
        self,
        party: Party,
        name: str,
        address: Address,
        rates: Rates,
        *,
        receive: Callable[[int], bytes],
        send: Callable[[bytearray], int],
        close: Callable[[], None],
        most_unsent: int = MOST_UNSENT,
        unread: Callable[[], int] = lambda: 0,
    ) -> None:
        """Open the link.

        Args:
            party: Who speaks over it.
            name: Unique among the links of the party.
            address: Where it belongs to; says what it asks of signatures.
            rates: What is streamed on it unasked.
            receive: Returns at most so many bytes, none at the end of the stream.
            send: Sends some bytes, and returns how many. Both raise BlockingIOError where they would wait.
            close: Closes the stream.
            most_unsent: Bytes that wait for a peer that does not read; whole frames beyond are lost.
            unread: Returns how many bytes the line itself keeps, as far as that can be known.
        """
        self.name = name
        self._party = party
        self._receive, self._send, self._close = receive, send, close
        self._unsent = bytearray()
        self._unread = unread
        self._most_unsent = most_unsent
        signing = address.signing or SigningPolicy.REQUIRED
        party.add_link(name, rates, byte_stream=True, signing=signing, is_secure=address.is_local)

    def read(self) -> bool:
        """Handle what has come; return whether the stream goes on."""
        try:
            data = self._receive(_CHUNK)
        except (BlockingIOError, InterruptedError):
            return True
        except OSError:
            return False
        self._party.receive(self.name, data)
        return bool(data)

    def flush(self) -> bool:
        """Send what can be sent; return whether the stream goes on."""
        for datagram in self._party.outgoing(self.name):
            if len(self._unsent) < self._most_unsent:
                self._unsent += datagram
        try:
            with contextlib.suppress(BlockingIOError, InterruptedError):
                while self._unsent:
                    del self._unsent[: self._send(self._unsent)]
            self._party.note_room(self.name, is_full=bool(self._unsent) or self._unread() > _MOST_UNREAD)
        except OSError:
            return False
        return True

    def close(self) -> None:
        """Close the stream and its link."""
        self._close()
        self._party.remove_link(self.name)
