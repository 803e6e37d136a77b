"""An endpoint whose links suffer what the vehicle's faults say: for lock-step and for sockets alike.

The scheduled faults of links act on each direction of each link on its own, in vehicle time. While none acts, packets
pass untouched and undelayed.
"""

from typing import TYPE_CHECKING, Final

from vehicle_sim.faults.line import CLEAR, Line, LineFaults
from vehicle_sim.protocol.dialect import AUTOPILOT_COMPONENT, MAGIC_V2, mavlink
from vehicle_sim.protocol.endpoint import Endpoint
from vehicle_sim.protocol.flavour import Rates
from vehicle_sim.protocol.policy import SigningPolicy

if TYPE_CHECKING:
    from vehicle_sim.faults import ScheduledFault
    from vehicle_sim.parameters import Flavour
    from vehicle_sim.protocol.signing import Signer
    from vehicle_sim.vehicle import Vehicle

_LIKELIHOODS: Final = ("drop", "duplicate", "corrupt", "reorder")


class BadLinksEndpoint(Endpoint):
    """One vehicle on links that lose, delay, reorder, repeat and break packets on schedule."""

    def __init__(
        self,
        vehicle: "Vehicle",
        flavour: "Flavour",
        system_id: int = 1,
        *,
        component_id: int = AUTOPILOT_COMPONENT,
        signer: "Signer | None" = None,
    ) -> None:
        """Speak for `vehicle`, as `Endpoint` does."""
        super().__init__(vehicle, flavour, system_id, component_id=component_id, signer=signer)
        self._link_faults = vehicle.faults.link_faults
        self._made = 0
        self._up: dict[str, Line] = {}
        self._down: dict[str, Line] = {}
        self._peers: set[str] = set()

    def add_link(
        self,
        name: str,
        rates: Rates = Rates.ONBOARD,
        *,
        byte_stream: bool = False,
        signing: SigningPolicy = SigningPolicy.REQUIRED,
        is_secure: bool = False,
    ) -> None:
        """Open a link, as `Endpoint` does."""
        super().add_link(name, rates, byte_stream=byte_stream, signing=signing, is_secure=is_secure)
        seed = self.vehicle.config.seed
        self._up[name], self._down[name] = Line(seed, self._made), Line(seed, self._made + 1)
        self._made += 2

    def remove_link(self, name: str) -> None:
        """Close a link, and lose what is on its way."""
        super().remove_link(name)
        del self._up[name], self._down[name]
        self._peers.discard(name)

    def _faults(self, direction: str) -> LineFaults:
        """Return what is wrong now with the links in one direction, `up` or `down`."""
        worst = CLEAR
        for fault in self._link_faults:
            share = self.vehicle.faults.strength(fault, self.vehicle.time_s) if fault.values[direction] else 0.0
            if share > 0.0:
                worst = worst.joined(_line_faults(fault, share))
        return worst

    def receive(self, link: str, data: bytes) -> int:
        """Take what the peer sent, which the line may change, and return how many valid messages it sent."""
        faults, line = self._faults("up"), self._up[link]
        if (faults is CLEAR and line.is_empty) or _is_ping(data):
            return self._handled(link, data)
        line.put(data, self.now_us, faults)
        count = sum(self._handled(link, packet) for packet in line.take(self.now_us))
        # Whoever opens links for strangers has to know that this is a peer, whatever the line does to its first words.
        return count if count or link in self._peers else _messages_in(data)

    def _handled(self, link: str, data: bytes) -> int:
        count = super().receive(link, data)
        if count:
            self._peers.add(link)
        return count

    def _carried(self, link: str, datagrams: list[bytes]) -> list[bytes]:
        line, faults = self._down[link], self._faults("down")
        if faults is CLEAR and line.is_empty:
            return datagrams
        for datagram in datagrams:
            line.put(datagram, self.now_us, faults)
        return line.take(self.now_us)

    def advance(self) -> None:
        """Step the vehicle once; what has come through to it is handled first."""
        for link, line in self._up.items():
            if not line.is_empty:
                for packet in line.take(self.now_us):
                    self._handled(link, packet)
        super().advance()


def _line_faults(fault: "ScheduledFault", share: float) -> LineFaults:
    values = fault.values
    drop, duplicate, corrupt, reorder = (share * values[name] for name in _LIKELIHOODS)
    return LineFaults(
        drop=drop,
        duplicate=duplicate,
        corrupt=corrupt,
        reorder=reorder,
        delay_s=share * values["delay_s"],
        jitter_s=share * values["jitter_s"],
    )


def _is_ping(data: bytes) -> bool:
    """Whether a datagram begins with a PING, which no fault of the line touches, as ``Endpoint.ping`` has it."""
    number = data[7:10] if data[:1] == bytes((MAGIC_V2,)) else data[5:6]
    return number.rstrip(b"\0") == bytes((mavlink.MAVLINK_MSG_ID_PING,))


def _messages_in(data: bytes) -> int:
    parser = mavlink.MAVLink(None)
    parser.robust_parsing = True
    messages = parser.parse_buffer(data) or []
    return sum(not isinstance(message, mavlink.MAVLink_bad_data | mavlink.MAVLink_unknown) for message in messages)
