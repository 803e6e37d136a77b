"""Who is spoken to over a port: one vehicle, or several that share the link."""

from collections.abc import Sequence
from typing import Protocol

from vehicle_sim.protocol.endpoint import Endpoint
from vehicle_sim.protocol.flavour import Rates
from vehicle_sim.protocol.policy import SigningPolicy


class Party(Protocol):
    """What a port needs of the endpoint behind it."""

    def add_link(
        self,
        name: str,
        rates: Rates = Rates.ONBOARD,
        *,
        byte_stream: bool = False,
        signing: SigningPolicy = SigningPolicy.REQUIRED,
        is_secure: bool = False,
    ) -> None:
        """Open a link."""
        ...

    def remove_link(self, name: str) -> None:
        """Close a link and forget its peer."""
        ...

    def receive(self, link: str, data: bytes) -> int:
        """Handle what came by a link and return how many valid messages it held."""
        ...

    def outgoing(self, link: str) -> list[bytes]:
        """Return the datagrams that wait to be sent by a link, oldest first, and forget them."""
        ...

    def note_room(self, link: str, *, is_full: bool) -> None:
        """Note whether the line of a link takes more for now."""
        ...


class Fleet:
    """Several vehicles on links that all of them share: each hears everything, and takes what is for it."""

    def __init__(self, endpoints: Sequence[Endpoint]) -> None:
        """Speak for vehicles of different system ids."""
        self._endpoints = tuple(endpoints)

    def add_link(
        self,
        name: str,
        rates: Rates = Rates.ONBOARD,
        *,
        byte_stream: bool = False,
        signing: SigningPolicy = SigningPolicy.REQUIRED,
        is_secure: bool = False,
    ) -> None:
        """Open a link of each."""
        for endpoint in self._endpoints:
            endpoint.add_link(name, rates, byte_stream=byte_stream, signing=signing, is_secure=is_secure)

    def remove_link(self, name: str) -> None:
        """Close the link of each."""
        for endpoint in self._endpoints:
            endpoint.remove_link(name)

    def receive(self, link: str, data: bytes) -> int:
        """Let each handle what came; return how many valid messages it held."""
        return max(endpoint.receive(link, data) for endpoint in self._endpoints)

    def outgoing(self, link: str) -> list[bytes]:
        """Return what each of them has to send."""
        return [datagram for endpoint in self._endpoints for datagram in endpoint.outgoing(link)]

    def note_room(self, link: str, *, is_full: bool) -> None:
        """Let each know whether the line takes more."""
        for endpoint in self._endpoints:
            endpoint.note_room(link, is_full=is_full)
