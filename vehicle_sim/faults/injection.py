"""Failures by command, as PX4 takes them: MAV_CMD_INJECT_FAILURE (420) with FAILURE_UNIT and FAILURE_TYPE.

https://docs.px4.io/main/en/debug/failure_injection.html. Units and types that have no meaning on this vehicle, such as
an airspeed sensor, are not supported, and said so.
"""

from collections.abc import Mapping
from enum import IntEnum
from typing import Final

from vehicle_sim.faults.conditions import ROTORS, Conditions, SensorState


class FailureUnit(IntEnum):
    """What fails; the values are those of FAILURE_UNIT."""

    MAG = 2
    BARO = 3
    GPS = 4
    BATTERY = 100
    MOTOR = 101


class FailureType(IntEnum):
    """How it fails; the values are those of FAILURE_TYPE."""

    OK = 0
    OFF = 1
    STUCK = 2


_STATES: Final[Mapping[FailureType, SensorState]] = {
    FailureType.OFF: SensorState.SILENT,
    FailureType.STUCK: SensorState.STUCK,
}
_FLAT_V: Final = 10.2


class InjectedFailures:
    """The failures that commands have set and not taken back."""

    def __init__(self) -> None:
        """Start with none."""
        self._states: dict[FailureUnit, SensorState] = {}
        self._dead: set[int] = set()
        self._flat = False

    def inject(self, unit: FailureUnit, how: FailureType, instance: int) -> bool:
        """Set or take back a failure of an instance (0: all), and return whether there is such a failure."""
        if unit is FailureUnit.MOTOR:
            return self._stop_motor(how, instance)
        if instance > 1:
            return False
        if unit is FailureUnit.BATTERY:
            self._flat = how is FailureType.OFF or (self._flat and how is not FailureType.OK)
            return how in (FailureType.OK, FailureType.OFF)
        if how is FailureType.OK:
            self._states.pop(unit, None)
        else:
            self._states[unit] = _STATES[how]
        return True

    def _stop_motor(self, how: FailureType, instance: int) -> bool:
        if not 0 <= instance <= ROTORS or how is FailureType.STUCK:
            return False
        rotors = set(range(ROTORS)) if instance == 0 else {instance - 1}
        self._dead = self._dead | rotors if how is FailureType.OFF else self._dead - rotors
        return True

    def apply(self, now: Conditions) -> Conditions:
        """Add the failures to what is wrong already."""
        states = self._states
        now = now._replace(
            compass=states.get(FailureUnit.MAG, now.compass),
            baro=states.get(FailureUnit.BARO, now.baro),
            gps=states.get(FailureUnit.GPS, now.gps),
        )
        if self._flat:
            now = now._replace(resting_v=_FLAT_V)
        if self._dead:
            first, second, third, fourth = (
                0.0 if rotor in self._dead else e for rotor, e in enumerate(now.efficiencies)
            )
            now = now._replace(efficiencies=(first, second, third, fourth))
        return now
