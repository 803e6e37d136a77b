"""A vehicle that flies guided for a ground station, and what can go wrong with it, begun and ended on purpose."""

from collections.abc import Callable
from enum import Enum, auto

from pymavlink.dialects.v20 import ardupilotmega as mavlink

from tests.support.station import Station, endpoint_of
from vehicle_sim.autopilot import Mode
from vehicle_sim.parameters import Flavour
from vehicle_sim.sensors import SensorErrors

HEIGHT_M = 12.0
_HEARTBEAT_STEPS, _SETPOINT_STEPS, _STICK_STEPS = 100, 5, 10
_VELOCITY_ONLY, _POSITION_ONLY = 0xDC7, 0xDF8


class Fault(Enum):
    """What can go wrong."""

    SETPOINTS = auto()
    STICKS = auto()
    GROUND = auto()
    BATTERY_LOW = auto()
    BATTERY_CRITICAL = auto()
    BATTERY_EMERGENCY = auto()
    FENCE = auto()
    ESTIMATOR = auto()
    WIND = auto()


class Endangered:
    """A hovering vehicle of either flavour in GUIDED or Offboard; a ground station beats and sends setpoints.

    With `sticks` a pilot is at centred sticks, too.

    `modes` are the modes since the last `forget`, each with the seconds since then.
    """

    def __init__(self, flavour: Flavour, *, sticks: bool = False, **parameters: float) -> None:
        self.station = Station(endpoint_of(flavour))
        self.vehicle = self.station.endpoint.vehicle
        self.beats = self.streams = True
        self.sticks = sticks
        self._errors = self.vehicle._sensors._errors
        self.station.take_off(HEIGHT_M)
        for name, value in parameters.items():
            self.vehicle.parameters.set(name, value)
        north, east, _ = self.vehicle.estimate.position_ned_m
        self._place = (north, east, self.vehicle.autopilot._home_ned_m[2] - HEIGHT_M)
        self.forget()
        self.fly(2.0)
        self.station.set_mode(Mode.GUIDED)
        self.fly(1.0)
        assert self.now() is Mode.GUIDED
        self.forget()

    def forget(self) -> None:
        """Begin to count and to note anew."""
        self._since_s = self.vehicle.time_s
        self.modes: list[tuple[float, Mode]] = []
        self.station.forget()

    def fly(self, seconds: float) -> None:
        vehicle, station = self.vehicle, self.station
        before = vehicle.autopilot.mode
        for _ in range(round(seconds / vehicle.config.step_s)):
            if self.beats and vehicle.steps % _HEARTBEAT_STEPS == 0:
                station.send(mavlink.MAVLink_heartbeat_message(mavlink.MAV_TYPE_GCS, 8, 0, 0, 4, 3))
            if self.sticks and vehicle.steps % _STICK_STEPS == 0:
                self._set(SIM_RC_FAIL=1)  # by joystick alone
                station.send(mavlink.MAVLink_manual_control_message(1, 0, 0, 500, 0, 0))
            if self.streams and vehicle.steps % _SETPOINT_STEPS == 0:
                if vehicle.autopilot.flavour is Flavour.PX4:
                    station.setpoint(self._place, mask=_POSITION_ONLY)
                else:
                    station.setpoint(velocity=(0.0, 0.0, 0.0), mask=_VELOCITY_ONLY)
            station.endpoint.advance()
            if (now := vehicle.autopilot.mode) is not before:
                before = now
                self.modes.append((vehicle.time_s - self._since_s, now))
        station.collect()

    def now(self) -> Mode:
        """The present mode."""
        return self.vehicle.autopilot.mode

    @property
    def system_status(self) -> int:
        """What the last heartbeat said."""
        return int(self.station.last("HEARTBEAT").system_status)

    def begin(self, fault: Fault) -> None:
        _BEGIN[fault](self)

    def end(self, fault: Fault) -> None:
        _END[fault](self)

    def _drain_to(self, share: float) -> None:
        battery = self.vehicle.battery
        capacity = self.vehicle.autopilot.settings.battery_thresholds.capacity_mah
        battery.consumed_mah = max(battery.consumed_mah, (1.0 - share) * capacity)

    def _set(self, **parameters: float) -> None:
        for name, value in parameters.items():
            if name in self.vehicle.parameters:
                self.vehicle.parameters.set(name, value)

    def _stop(self, **what: bool) -> None:
        for name, value in what.items():
            setattr(self, name, value)

    def _blind(self, errors: SensorErrors) -> None:
        self.vehicle._sensors._errors = errors


_BEGIN: dict[Fault, Callable[[Endangered], None]] = {
    Fault.SETPOINTS: lambda one: one._stop(streams=False),
    Fault.STICKS: lambda one: one._stop(sticks=False),
    Fault.GROUND: lambda one: one._stop(beats=False),
    Fault.BATTERY_LOW: lambda one: one._drain_to(0.149),
    Fault.BATTERY_CRITICAL: lambda one: one._drain_to(0.0695),
    Fault.BATTERY_EMERGENCY: lambda one: one._drain_to(0.0495),
    # The ceiling comes down on the vehicle.
    Fault.FENCE: lambda one: one._set(FENCE_ENABLE=1, FENCE_TYPE=1, FENCE_ALT_MAX=10, GF_MAX_VER_DIST=10),
    Fault.ESTIMATOR: lambda one: one._blind(SensorErrors(gps_first_fix_s=1e9)),
    Fault.WIND: lambda one: one._set(SIM_WIND_SPD=14),
}
_END: dict[Fault, Callable[[Endangered], None]] = {
    Fault.SETPOINTS: lambda one: one._stop(streams=True),
    Fault.STICKS: lambda one: one._stop(sticks=True),
    Fault.GROUND: lambda one: one._stop(beats=True),
    Fault.FENCE: lambda one: one._set(FENCE_ALT_MAX=100, GF_MAX_VER_DIST=100),
    Fault.ESTIMATOR: lambda one: one._blind(one._errors),
    Fault.WIND: lambda one: one._set(SIM_WIND_SPD=0),
}
