"""A vehicle in lock-step that is also heard to say what a test puts into its mouth."""

from typing import Any

from pymavlink.dialects.v20 import ardupilotmega as mavlink

from tests.support.lockstep import LockstepVehicle
from vehicle_sim.vehicle import VehicleConfig


class SpokenFor(LockstepVehicle):
    """All that it says is followed by these messages, as if they were its own; they are the newest of their kind.

    Attributes:
        says: What it is made to say.
        heard: What was sent to it, as messages.
    """

    def __init__(self, config: VehicleConfig) -> None:
        super().__init__(config)
        self.says: list[Any] = []
        self.heard: list[Any] = []
        self._mouth = mavlink.MAVLink(None, srcSystem=1, srcComponent=1)
        self._ear = mavlink.MAVLink(None)

    def send(self, data: bytes) -> None:
        self.heard += self._ear.parse_buffer(data) or ()
        super().send(data)

    def receive(self, within_s: float) -> list[bytes]:
        return [*super().receive(within_s), *(bytes(message.pack(self._mouth)) for message in self.says)]
