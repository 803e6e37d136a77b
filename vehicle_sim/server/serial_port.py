"""A serial line of the vehicle: a device, or a pseudo terminal that clients open like one."""

import os
from collections.abc import Callable, Iterator
from struct import calcsize, unpack
from typing import Final

import serial

from vehicle_sim.errors import ConfigurationError
from vehicle_sim.protocol.flavour import Rates
from vehicle_sim.server.addresses import Address, Scheme
from vehicle_sim.server.party import Party
from vehicle_sim.server.stream_link import StreamLink

_MOST_UNSENT: Final = 4096
"""A line that nobody reads loses what is sent, as a real one does, and does not keep it for who comes later."""


class SerialPort:
    """One line and the link over it."""

    def __init__(self, address: Address, party: Party, rates: Rates, notify: Callable[[str], None]) -> None:
        """Open the device, or make a pseudo terminal; `address` tells its name.

        Raises:
            ConfigurationError: There is no such device, or this system has no pseudo terminals.
        """
        self._notify = notify
        self._device: serial.Serial | None = None
        self._other_end = -1
        if address.scheme is Scheme.PTY:
            self._line, self._other_end = _pseudo_terminal()
            address = address._replace(host=os.ttyname(self._other_end))
        else:
            try:
                self._device = serial.Serial(address.host, address.port, timeout=0.0, write_timeout=0.0)
            except (serial.SerialException, ValueError) as error:
                raise ConfigurationError(f"{address}: {error}") from error
            self._line = self._device.fileno()
        os.set_blocking(self._line, False)
        self.address = address
        self._link: StreamLink | None = StreamLink(
            party,
            str(address),
            address,
            rates,
            receive=lambda most: os.read(self._line, most),
            send=lambda data: os.write(self._line, data),
            close=self._close_line,
            most_unsent=_MOST_UNSENT,
            unread=self._unread,
        )

    def fileno(self) -> int:
        """Return the descriptor that becomes readable."""
        return self._line

    def sockets(self) -> Iterator["SerialPort"]:
        """Return the line while it stands."""
        if self._link is not None:
            yield self

    def read(self, _ready: object) -> None:
        """Handle what has come."""
        if self._link is not None and not self._link.read():
            self._fail()

    def flush(self) -> None:
        """Send what waits."""
        if self._link is not None and not self._link.flush():
            self._fail()

    def _unread(self) -> int:
        """Return how many bytes wait in the system: to leave the device, or for whoever reads the pseudo terminal."""
        if self._device is not None:
            return int(self._device.out_waiting)
        return _readable(self._other_end)

    def _fail(self) -> None:
        self.close()
        self._notify(f"{self.address} has failed")

    def close(self) -> None:
        """Close the line and its link."""
        if self._link is None:
            return
        self._link.close()
        self._link = None

    def _close_line(self) -> None:
        if self._device is not None:
            self._device.close()
            return
        for end in (self._line, self._other_end):
            os.close(end)


def _readable(terminal: int) -> int:
    """Return how many bytes could be read at this end of a pseudo terminal."""
    import fcntl  # noqa: PLC0415 - not on every system
    import termios  # noqa: PLC0415 - the same

    (count,) = unpack("i", fcntl.ioctl(terminal, termios.FIONREAD, bytes(calcsize("i"))))
    return int(count)


def _pseudo_terminal() -> tuple[int, int]:
    """Return our end and the other one, which stays open so that clients may come and go."""
    try:
        import tty  # noqa: PLC0415 - not on every system

        ours, other = os.openpty()
    except (ImportError, AttributeError, OSError) as error:
        raise ConfigurationError(f"pty: there are no pseudo terminals here ({error}); use udpin: or tcpin:") from error
    tty.setraw(other)  # bytes go through as they are
    return ours, other
