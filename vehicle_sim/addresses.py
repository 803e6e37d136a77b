"""Addresses of links, in the form that users of MAVProxy and MAVSDK know: `udpin:HOST:PORT` and its like."""

from enum import StrEnum
from typing import NamedTuple

from vehicle_sim.errors import ConfigurationError

_MOST_PORT = 65535


class Scheme(StrEnum):
    """How a link comes about."""

    UDP_IN = "udpin"
    UDP_OUT = "udpout"
    TCP_IN = "tcpin"
    TCP_OUT = "tcp"


LISTENING = frozenset((Scheme.UDP_IN, Scheme.TCP_IN))
"""The schemes that wait to be spoken to."""


class Address(NamedTuple):
    """Where a link listens, or whom it speaks to."""

    scheme: Scheme
    host: str
    port: int

    def __str__(self) -> str:
        host = f"[{self.host}]" if ":" in self.host else self.host
        return f"{self.scheme}:{host}:{self.port}"


def parse_address(text: str) -> Address:
    """Return the address that `text` names; `udpin://HOST:PORT` and a bare `udp:` (which listens) are understood too.

    Raises:
        ConfigurationError: It names none; the message says what to write.
    """
    scheme_text, _, rest = text.partition(":")
    host, _, port_text = rest.removeprefix("//").rpartition(":")
    names = {"udp": Scheme.UDP_IN, "tcpout": Scheme.TCP_OUT, **{str(scheme): scheme for scheme in Scheme}}
    scheme = names.get(scheme_text)
    if scheme is None:
        raise ConfigurationError(f"address {text!r}: begin with udpin:, udpout:, tcpin: or tcp:")
    if not (port_text.isascii() and port_text.isdigit() and int(port_text) <= _MOST_PORT):
        raise ConfigurationError(f"address {text!r}: write {scheme}:HOST:PORT with a port from 0 to {_MOST_PORT}")
    if not host:
        raise ConfigurationError(f"address {text!r}: write {scheme}:HOST:PORT, for example {scheme}:127.0.0.1:14550")
    if int(port_text) == 0 and scheme not in LISTENING:
        raise ConfigurationError(f"address {text!r}: only an address that listens may leave the port open with 0")
    return Address(scheme, host.removeprefix("[").removesuffix("]"), int(port_text))
