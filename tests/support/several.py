"""Vehicles in lock-step on one link, each of which hears all that is sent."""

from dataclasses import replace

from tests.support.lockstep import LINK, vehicle_of
from vehicle_sim.protocol.endpoint import Endpoint
from vehicle_sim.vehicle import Vehicle


class Several:
    """Transport and clock in one, as one vehicle is."""

    def __init__(self, *vehicles: tuple[str, int, float]) -> None:
        """Begin with vehicles: of a flavour, with a system id, that were started so many seconds ago."""
        self.endpoints: list[Endpoint] = []
        for number, (flavour, system_id, ago_s) in enumerate(vehicles):
            config = replace(vehicle_of(flavour, seed=number), home_lat_deg=47.0 + 0.001 * number)
            endpoint = Endpoint(Vehicle(config), config.flavour, system_id=system_id)
            endpoint.add_link(LINK)
            for _ in range(round(ago_s / config.step_s)):
                endpoint.advance()
                endpoint.outgoing(LINK)
            self.endpoints.append(endpoint)
        self._step_s, self._steps = config.step_s, 0

    def now_s(self) -> float:
        return self._steps * self._step_s

    def send(self, data: bytes) -> None:
        for endpoint in self.endpoints:
            endpoint.receive(LINK, data)

    def receive(self, within_s: float) -> list[bytes]:
        until_s = self.now_s() + within_s
        while not (said := [data for endpoint in self.endpoints for data in endpoint.outgoing(LINK)]):
            for endpoint in self.endpoints:
                endpoint.advance()
            self._steps += 1
            if self.now_s() >= until_s:
                break
        return said

    def close(self) -> None:
        """Nothing to release."""

    @property
    def armed(self) -> bool:
        return any(endpoint.vehicle.autopilot.armed for endpoint in self.endpoints)
