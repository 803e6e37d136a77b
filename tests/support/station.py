"""A ground station in lock-step with a vehicle: every wait is vehicle time, nothing sleeps."""

from collections.abc import Callable
from struct import pack, unpack

from pymavlink.dialects.v20 import ardupilotmega as mavlink

from vehicle_sim.autopilot import Mode
from vehicle_sim.dynamics.airframe import Dynamics
from vehicle_sim.parameters import Flavour, ParameterKind
from vehicle_sim.protocol.dialect import Message
from vehicle_sim.protocol.endpoint import Endpoint
from vehicle_sim.protocol.flavour import Rates
from vehicle_sim.vehicle import Vehicle, VehicleConfig


def endpoint_of(flavour: Flavour, *, system_id: int = 1, dynamics: Dynamics = Dynamics.HOVER) -> Endpoint:
    return Endpoint(Vehicle(VehicleConfig(flavour=flavour, dynamics=dynamics)), flavour, system_id)


class Station:
    """A MAVLink peer on a link of its own; `heard` are the messages that came, oldest first."""

    def __init__(
        self,
        endpoint: Endpoint,
        name: str = "station",
        *,
        rates: Rates = Rates.SILENT,
        system_id: int = 255,
        component_id: int = 190,
    ) -> None:
        self.endpoint, self.name = endpoint, name
        self.mav = mavlink.MAVLink(None, srcSystem=system_id, srcComponent=component_id)
        self._parser = mavlink.MAVLink(None)
        self._parser.robust_parsing = True
        self.heard: list[Message] = []
        endpoint.add_link(name, rates)

    def packed(self, message: Message) -> bytes:
        frame: bytes = message.pack(self.mav)
        self.mav.seq = (self.mav.seq + 1) % 256
        return frame

    def send(self, *messages: Message) -> None:
        for message in messages:
            self.endpoint.receive(self.name, self.packed(message))
        self.collect()

    def collect(self) -> None:
        for datagram in self.endpoint.outgoing(self.name):
            self.heard.extend(self._parser.parse_buffer(datagram) or ())

    def run(self, seconds: float) -> None:
        for _ in range(round(seconds / self.endpoint.vehicle.config.step_s)):
            self.endpoint.advance()
            self.collect()

    def wait_until(self, predicate: Callable[[], bool], *, within_s: float) -> None:
        deadline_s = self.endpoint.vehicle.time_s + within_s
        while not predicate():
            last = [message.to_dict() for message in self.heard[-3:]]
            assert self.endpoint.vehicle.time_s < deadline_s, f"not within {within_s} s; last heard {last}"
            self.endpoint.advance()
            self.collect()

    def of(self, kind: str) -> list[Message]:
        return [message for message in self.heard if message.get_type() == kind]

    def last(self, kind: str) -> Message:
        found = self.of(kind)
        assert found, f"no {kind} among {[message.get_type() for message in self.heard]}"
        return found[-1]

    def forget(self) -> None:
        self.heard.clear()

    def texts(self) -> list[str]:
        return [message.text for message in self.of("STATUSTEXT")]

    def command(self, command: int, *params: float, target: int = 1, component: int = 1) -> int:
        """Send COMMAND_LONG and return the result of its acknowledgement, -1 without one."""
        self.heard = [message for message in self.heard if message.get_type() != "COMMAND_ACK"]
        seven = (*params, *(0.0,) * (7 - len(params)))
        self.send(mavlink.MAVLink_command_long_message(target, component, command, 0, *seven))
        return self._result(command)

    def command_int(self, command: int, frame: int, params: tuple[float, ...], place: tuple[int, int, float]) -> int:
        self.heard = [message for message in self.heard if message.get_type() != "COMMAND_ACK"]
        self.send(mavlink.MAVLink_command_int_message(1, 1, frame, command, 0, 0, *params, *place))
        return self._result(command)

    def _result(self, command: int) -> int:
        answers = [message for message in self.of("COMMAND_ACK") if message.command == command]
        return int(answers[-1].result) if answers else -1

    def set_parameter(self, name: str, value: float) -> None:
        """Send PARAM_SET, integers in the way of the flavour, and expect the value in the answer."""
        kind = self.endpoint.vehicle.parameters.definition(name).kind
        wire = float(value)
        if self.endpoint.table.bytewise_parameters and kind is not ParameterKind.REAL32:
            wire = unpack("<f", pack("<i", int(value)))[0]
        self.send(mavlink.MAVLink_param_set_message(1, 1, name.encode(), wire, kind.value))
        assert self.last("PARAM_VALUE").param_id == name
        assert pack("<f", self.last("PARAM_VALUE").param_value) == pack("<f", wire)

    def request(self, message_id: int) -> int:
        return self.command(mavlink.MAV_CMD_REQUEST_MESSAGE, message_id)

    def set_mode(self, mode: Mode) -> int:
        number = self.endpoint.table.custom_modes[mode]
        if self.endpoint.table.flavour is Flavour.PX4:
            return self.command(mavlink.MAV_CMD_DO_SET_MODE, 1, number >> 16 & 0xFF, number >> 24)
        return self.command(mavlink.MAV_CMD_DO_SET_MODE, 1, number)

    def setpoint(
        self,
        position: tuple[float, float, float] = (0, 0, 0),
        velocity: tuple[float, float, float] = (0, 0, 0),
        acceleration: tuple[float, float, float] = (0, 0, 0),
        *,
        mask: int,
        frame: int = mavlink.MAV_FRAME_LOCAL_NED,
        yaw: float = 0.0,
    ) -> None:
        self.send(
            mavlink.MAVLink_set_position_target_local_ned_message(
                0, 1, 1, frame, mask, *position, *velocity, *acceleration, yaw, 0.0
            )
        )

    def wait_for_position(self) -> None:
        self.wait_until(lambda: self.endpoint.vehicle.autopilot.home is not None, within_s=60.0)
        if self.endpoint.table.flavour is Flavour.ARDUPILOT:
            self.set_mode(Mode.GUIDED)
        self.wait_until(lambda: self.endpoint.vehicle.autopilot.ready_to_arm, within_s=60.0)

    def take_off(self, height_m: float = 5.0) -> None:
        """Get into the air in the way of each flavour."""
        self.wait_for_position()
        autopilot = self.endpoint.vehicle.autopilot
        assert self.command(mavlink.MAV_CMD_COMPONENT_ARM_DISARM, 1) == mavlink.MAV_RESULT_ACCEPTED
        self.run(3.0)
        assert autopilot.home is not None
        zero_m = autopilot.home.alt_m if self.endpoint.table.takeoff_is_amsl else 0.0
        result = self.command(mavlink.MAV_CMD_NAV_TAKEOFF, 0, 0, 0, 0, 0, 0, zero_m + height_m)
        assert result == mavlink.MAV_RESULT_ACCEPTED
        self.wait_until(lambda: self.height_m() > height_m - 0.5, within_s=40.0)

    def height_m(self) -> float:
        return -self.endpoint.vehicle.truth.position_ned_m[2]
