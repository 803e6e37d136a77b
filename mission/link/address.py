"""Addresses of links, in the forms that users of MAVProxy and of MAVSDK know."""

import re
from dataclasses import dataclass
from enum import StrEnum

from mission.errors import Fault, SpecError

DEFAULT_BAUD = 57600
_MOST_PORT = 65535
_ANY_HOST = "0.0.0.0"  # noqa: S104 - a ground station listens on every interface unless it is told which

FORMS = (
    "udpin:HOST:PORT (listen), udpout:HOST:PORT (call), tcp:HOST:PORT, tcpin:HOST:PORT, serial:DEVICE:BAUD, "
    "or /dev/ttyACM0:57600; udpin://HOST:PORT and the like work too"
)


class Scheme(StrEnum):
    """How a link comes about."""

    UDP_IN = "udpin"
    UDP_OUT = "udpout"
    TCP_IN = "tcpin"
    TCP_OUT = "tcp"
    SERIAL = "serial"


_SCHEMES = {
    "udp": Scheme.UDP_IN,  # as pymavlink and MAVProxy have it
    "tcpout": Scheme.TCP_OUT,
    **{scheme.value: scheme for scheme in Scheme},
}
_LISTENING = frozenset((Scheme.UDP_IN, Scheme.TCP_IN))
_DEVICE = re.compile(r"(?P<device>/[^:,/][^:,]*|COM[0-9]+)(?:[:,](?P<baud>[0-9]+))?", re.IGNORECASE)
_ENDPOINT = re.compile(r"(?:\[(?P<six>[0-9A-Fa-f:.%\w]+)\]|(?P<host>[^:\[\]/?#]*)):(?P<port>[0-9]{1,5})/?")


@dataclass(frozen=True)
class Address:
    """Where a link listens, whom it calls, or which device it opens.

    Attributes:
        scheme: How it comes about.
        host: Host name or number; the device of a serial line.
        port: Port; the baud rate of a serial line.
    """

    scheme: Scheme
    host: str
    port: int

    def __str__(self) -> str:
        host = f"[{self.host}]" if ":" in self.host else self.host
        return f"{self.scheme.value}:{host}:{self.port}"


def parse_address(text: str) -> Address:
    """Read an address.

    A listening address may leave the host out (every interface) and give port 0 (any free one); a serial line may
    leave the baud rate out.

    Raises:
        SpecError: It is none; the fault's hint lists the forms.
    """
    plain = _DEVICE.fullmatch(text)
    if plain:
        return _serial(text, plain)
    name, colon, rest = text.partition(":")
    scheme = _SCHEMES.get(name.lower()) if colon else None
    if scheme is None:
        raise _fault(text, f"{name!r} is no kind of link" if colon else "it names no kind of link")
    rest = rest.removeprefix("//")
    if scheme is Scheme.SERIAL:
        device = _DEVICE.fullmatch(rest)
        if device is None:
            raise _fault(text, "a serial line is named by its device and baud rate")
        return _serial(text, device)
    return _endpoint(text, scheme, rest)


def _serial(text: str, match: re.Match[str]) -> Address:
    baud = int(match["baud"] or DEFAULT_BAUD)
    if not 0 < baud <= 10_000_000:  # noqa: PLR2004 - beyond any serial line
        raise _fault(text, f"there is no baud rate of {baud}")
    return Address(Scheme.SERIAL, match["device"], baud)


def _endpoint(text: str, scheme: Scheme, rest: str) -> Address:
    match = _ENDPOINT.fullmatch(rest)
    if match is None:
        raise _fault(text, "host and port are missing or malformed")
    host, port = match["six"] or match["host"], int(match["port"])
    if port > _MOST_PORT:
        raise _fault(text, f"there is no port {port}")
    if scheme in _LISTENING:
        return Address(scheme, host or _ANY_HOST, port)
    if not host or not port:
        raise _fault(text, "to call a vehicle, both its host and its port are needed")
    return Address(scheme, host, port)


def _fault(text: str, why: str) -> SpecError:
    return SpecError((Fault(0, 0, "", f"cannot connect to {text!r}: {why}", f"write {FORMS}"),))
