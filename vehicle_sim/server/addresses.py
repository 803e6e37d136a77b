"""Addresses of links, in the form that users of MAVProxy and MAVSDK know: `udpin:HOST:PORT` and its like.

An address may say what its link asks of signatures: `udpin:0.0.0.0:14550,signing=required`.
"""

from enum import StrEnum
from typing import NamedTuple

from vehicle_sim.errors import ConfigurationError
from vehicle_sim.protocol.policy import SigningPolicy

_MOST_PORT = 65535
_DEFAULT_BAUD = 57600
_LOCAL_HOSTS = frozenset(("localhost", "::1"))


class Scheme(StrEnum):
    """How a link comes about."""

    UDP_IN = "udpin"
    UDP_OUT = "udpout"
    TCP_IN = "tcpin"
    TCP_OUT = "tcp"
    SERIAL = "serial"
    PTY = "pty"


LISTENING = frozenset((Scheme.UDP_IN, Scheme.TCP_IN, Scheme.PTY))
"""The schemes that wait to be spoken to."""


class Address(NamedTuple):
    """Where a link listens, or whom it speaks to.

    Attributes:
        scheme: How it comes about.
        host: Host; the device of a serial line or pseudo terminal, empty for one that is to be made.
        port: Port; the baud rate of a serial line, 0 of a pseudo terminal.
        signing: What it asks of signatures; None where the user did not say.
    """

    scheme: Scheme
    host: str
    port: int
    signing: SigningPolicy | None = None

    @property
    def is_local(self) -> bool:
        """Whether what goes over it cannot be heard on a network."""
        return self.scheme in (Scheme.SERIAL, Scheme.PTY) or self.host in _LOCAL_HOSTS or self.host.startswith("127.")

    def shifted(self, ports: int) -> "Address":
        """Return the address so many ports higher; an open port stays open.

        Raises:
            ConfigurationError: There is no such port, or it is a line, of which there is one.
        """
        if not ports or self.scheme is Scheme.PTY or (self.port == 0 and self.scheme in LISTENING):
            return self
        if self.scheme is Scheme.SERIAL:
            raise ConfigurationError(f"{self}: several vehicles cannot have the same line each; write it with --shared")
        if self.port + ports > _MOST_PORT:
            raise ConfigurationError(f"{self}: {ports} ports higher there is none; begin lower")
        return self._replace(port=self.port + ports)

    def __str__(self) -> str:
        host = f"[{self.host}]" if ":" in self.host else self.host
        place = f"{self.scheme}:{host}" if self.scheme is Scheme.PTY else f"{self.scheme}:{host}:{self.port}"
        return place if self.signing is None else f"{place},signing={self.signing}"


def parse_address(text: str) -> Address:
    """Return the address that `text` names; `udpin://HOST:PORT` and a bare `udp:` (which listens) are understood too.

    Raises:
        ConfigurationError: It names none; the message says what to write.
    """
    place, comma, option = text.partition(",")
    signing = _signing(text, option) if comma else None
    scheme_text, _, rest = place.partition(":")
    names = {"udp": Scheme.UDP_IN, "tcpout": Scheme.TCP_OUT, **{str(scheme): scheme for scheme in Scheme}}
    scheme = names.get(scheme_text)
    if scheme is None:
        raise ConfigurationError(f"address {text!r}: begin with udpin:, udpout:, tcpin:, tcp:, serial: or pty:")
    if scheme is Scheme.PTY:
        return Address(scheme, rest, 0, signing)
    if scheme is Scheme.SERIAL:
        return _serial(text, rest)._replace(signing=signing)
    return _endpoint(text, scheme, rest)._replace(signing=signing)


def _signing(text: str, option: str) -> SigningPolicy:
    name, _, value = option.partition("=")
    if name != "signing" or value not in set(SigningPolicy):
        raise ConfigurationError(f"address {text!r}: after the comma goes signing=required, allowed or off")
    return SigningPolicy(value)


def _serial(text: str, rest: str) -> Address:
    device, colon, baud = rest.partition(":")
    if not device or (colon and not (baud.isascii() and baud.isdigit() and int(baud))):
        raise ConfigurationError(f"address {text!r}: write serial:DEVICE:BAUD, for example serial:/dev/ttyUSB0:57600")
    return Address(Scheme.SERIAL, device, int(baud) if colon else _DEFAULT_BAUD)


def _endpoint(text: str, scheme: Scheme, rest: str) -> Address:
    host, _, port_text = rest.removeprefix("//").rpartition(":")
    if not (port_text.isascii() and port_text.isdigit() and int(port_text) <= _MOST_PORT):
        raise ConfigurationError(f"address {text!r}: write {scheme}:HOST:PORT with a port from 0 to {_MOST_PORT}")
    if not host:
        raise ConfigurationError(f"address {text!r}: write {scheme}:HOST:PORT, for example {scheme}:127.0.0.1:14550")
    if int(port_text) == 0 and scheme not in LISTENING:
        raise ConfigurationError(f"address {text!r}: only an address that listens may leave the port open with 0")
    return Address(scheme, host.removeprefix("[").removesuffix("]"), int(port_text))
