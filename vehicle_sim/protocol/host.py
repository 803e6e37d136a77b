"""What a service sees of the endpoint that it is part of."""

from typing import NamedTuple, Protocol

from vehicle_sim.autopilot import Severity
from vehicle_sim.protocol.dialect import Message
from vehicle_sim.protocol.flavour import FlavourTable, Rates
from vehicle_sim.protocol.link import Link
from vehicle_sim.vehicle import Vehicle


class Sender(NamedTuple):
    """Whom a message came from: the link it came by, and its source."""

    link: Link
    system_id: int
    component_id: int


class Host(Protocol):
    """The endpoint, as its services use it."""

    vehicle: Vehicle
    table: FlavourTable
    system_id: int
    component_id: int
    now_us: int
    utc_of_boot_us: int

    def broadcast(self, message: Message) -> None:
        """Send a message of the vehicle on every link."""
        ...

    def say(self, severity: Severity, text: str) -> None:
        """Send a text to every link, in chunks where it is long."""
        ...

    def telemetry(self, message_id: int) -> Message | None:
        """Return a telemetry message as of now; None where the vehicle has nothing to say in it yet.

        Raises:
            KeyError: This autopilot has no such message.
        """
        ...

    def has_telemetry(self, message_id: int) -> bool:
        """Whether this autopilot has a telemetry message."""
        ...

    def reboot_in(self, delay_us: int) -> None:
        """Restart the flight controller after so many microseconds."""
        ...

    def rates_of(self, link: Link) -> Rates:
        """Return what a link is for."""
        ...
