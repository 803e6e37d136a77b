"""The vehicle in this process: a transport whose waiting is what makes the vehicle's time pass."""

from collections.abc import Callable
from dataclasses import replace

from vehicle_sim.parameters import Flavour
from vehicle_sim.protocol.bad_links import BadLinksEndpoint
from vehicle_sim.protocol.endpoint import Endpoint
from vehicle_sim.vehicle import AS_THEY_COME, Vehicle, VehicleConfig

LINK = "planner"


class LockstepVehicle:
    """Transport and clock in one: time is the vehicle's, and goes on only while the planner waits for messages.

    ``at_step`` is called after each step of the vehicle, for faults on time.
    """

    def __init__(self, config: VehicleConfig, at_step: Callable[["LockstepVehicle"], None] | None = None) -> None:
        self.vehicle = Vehicle(config)
        kind = BadLinksEndpoint if self.vehicle.faults.link_faults else Endpoint
        self.endpoint = kind(self.vehicle, config.flavour)
        self.endpoint.add_link(LINK)
        self._at_step = at_step
        self.sent = 0

    def now_s(self) -> float:
        return self.vehicle.time_s

    def send(self, data: bytes) -> None:
        self.sent += 1
        self.endpoint.receive(LINK, data)

    def receive(self, within_s: float) -> list[bytes]:
        waiting = self.endpoint.outgoing(LINK)
        until_s = self.vehicle.time_s + within_s
        while not waiting:
            self.endpoint.advance()
            if self._at_step is not None:
                self._at_step(self)
            waiting = self.endpoint.outgoing(LINK)
            if self.vehicle.time_s >= until_s:
                break
        return waiting

    def close(self) -> None:
        """Nothing to release."""


def vehicle_of(flavour: str, seed: int = 1, **config: float) -> VehicleConfig:
    """A vehicle without much drag, whichever autopilot's."""
    return VehicleConfig(flavour=Flavour(flavour), seed=seed, **config)  # type: ignore[arg-type]


def as_it_comes(flavour: str, seed: int = 1, **config: float) -> VehicleConfig:
    """The vehicle that a flavour comes with."""
    return replace(AS_THEY_COME[Flavour(flavour)], seed=seed, **config)  # type: ignore[arg-type]
