"""The battery: charge drained by the power flown, and a voltage that sags under current."""

from enum import IntEnum
from typing import Final

from vehicle_sim.parameters import BatteryThresholds

_CELLS: Final = 3
_FULL_CELL_V: Final = 4.2
_FLAT_CELL_V: Final = 3.4
_INTERNAL_OHM: Final = 0.02
_ELECTRONICS_W: Final = 6.0


class BatteryLevel(IntEnum):
    """How urgent the state of the battery is."""

    OK = 0
    LOW = 1
    CRITICAL = 2
    EMERGENCY = 3


class Battery:
    """Three lithium cells in series, with an open-circuit voltage that falls linearly with the charge drawn."""

    def __init__(self) -> None:
        """Start full and at rest."""
        self.remaining = 1.0
        self.consumed_mah = 0.0
        self.current_a = 0.0
        self.voltage_v = _CELLS * _FULL_CELL_V
        self.level = BatteryLevel.OK
        self._below_low_s = 0.0
        self._below_critical_s = 0.0

    def drain(self, motors_w: float, duration_s: float, thresholds: BatteryThresholds) -> None:
        """Draw `motors_w` of power for the motors, and what else runs, for `duration_s`, and judge what is left."""
        self.current_a = (_ELECTRONICS_W + motors_w) / max(self.voltage_v, 1.0)
        self.consumed_mah += self.current_a * duration_s / 3.6
        self.judge(thresholds, duration_s)

    def judge(self, thresholds: BatteryThresholds, duration_s: float = 0.0) -> None:
        """Judge by `thresholds` the charge, and a voltage that has stood for `duration_s`.

        The level never improves in flight: a sagging voltage that recovers is still a tired battery.
        """
        self.remaining = max(1.0 - self.consumed_mah / thresholds.capacity_mah, 0.0)
        cell_v = _FLAT_CELL_V + (_FULL_CELL_V - _FLAT_CELL_V) * self.remaining
        self.voltage_v = max(_CELLS * cell_v - self.current_a * _INTERNAL_OHM, 0.0)
        self.level = max(self.level, self._level(duration_s, thresholds))

    def rest_at(self, voltage_v: float, capacity_mah: float) -> None:
        """Hold from now on the charge at which the battery rests at `voltage_v`."""
        cell_v = voltage_v / _CELLS
        self.remaining = min(max((cell_v - _FLAT_CELL_V) / (_FULL_CELL_V - _FLAT_CELL_V), 0.0), 1.0)
        self.consumed_mah = (1.0 - self.remaining) * capacity_mah

    def _level(self, duration_s: float, thresholds: BatteryThresholds) -> BatteryLevel:
        self._below_low_s = self._below_low_s + duration_s if self.voltage_v < thresholds.low_v else 0.0
        self._below_critical_s = self._below_critical_s + duration_s if self.voltage_v < thresholds.critical_v else 0.0
        if self.remaining < thresholds.emergency_share:
            return BatteryLevel.EMERGENCY
        sagged = thresholds.critical_v > 0.0 and self._below_critical_s > thresholds.voltage_time_s
        if sagged or self.remaining < thresholds.critical_share:
            return BatteryLevel.CRITICAL
        sagged = thresholds.low_v > 0.0 and self._below_low_s > thresholds.voltage_time_s
        if sagged or self.remaining < thresholds.low_share:
            return BatteryLevel.LOW
        return BatteryLevel.OK
