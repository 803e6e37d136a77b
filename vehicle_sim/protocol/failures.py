"""Failure injection by command: MAV_CMD_INJECT_FAILURE, which only PX4 has, and only where SYS_FAILURE_EN allows it.

https://docs.px4.io/main/en/debug/failure_injection.html. Where it is not allowed, PX4's receiver denies it.
"""

from typing import TYPE_CHECKING

from vehicle_sim.autopilot import Outcome
from vehicle_sim.faults import FailureType, FailureUnit
from vehicle_sim.parameters import Flavour
from vehicle_sim.protocol.dialect import mavlink
from vehicle_sim.protocol.units import whole_number

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    from vehicle_sim.protocol.commands import Request
    from vehicle_sim.protocol.host import Host


class FailureService:
    """Sets failures and takes them back.

    Attributes:
        commands: What the command service calls for them; none on ArduPilot, which does not know the command.
    """

    def __init__(self, host: "Host") -> None:
        self._host = host
        is_px4 = host.table.flavour is Flavour.PX4
        self.commands: Mapping[int, Callable[[Request], Outcome]] = (
            {mavlink.MAV_CMD_INJECT_FAILURE: self._inject} if is_px4 else {}
        )

    def _inject(self, request: "Request") -> Outcome:
        vehicle = self._host.vehicle
        if not vehicle.parameters["SYS_FAILURE_EN"]:
            return Outcome.DENIED
        unit, how, instance = (whole_number(value) for value in request.params[:3])
        if unit is None or how is None or instance is None:
            return Outcome.UNSUPPORTED
        try:
            known = vehicle.faults.inject(FailureUnit(unit), FailureType(how), instance)
        except ValueError:  # a unit or a type that this vehicle has not
            known = False
        return Outcome.ACCEPTED if known else Outcome.UNSUPPORTED
