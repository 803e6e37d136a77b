"""Which modes there are: AVAILABLE_MODES and CURRENT_MODE, https://mavlink.io/en/services/standard_modes.html.

PX4 gives modes that are
standard no name, and marks those advanced that fly neither by hand with height nor with place kept; ArduPilot gives all
of them names, and has no CURRENT_MODE. After PX4 `AVAILABLE_MODES.hpp` and ArduPilot `GCS_MAVLink_Copter.cpp`.
"""

from typing import TYPE_CHECKING, Final

from vehicle_sim.autopilot import Mode, Outcome
from vehicle_sim.parameters import Flavour
from vehicle_sim.protocol.commands import Request
from vehicle_sim.protocol.dialect import Message
from vehicle_sim.protocol.host import Host
from vehicle_sim.protocol.late_messages import AvailableModes, AvailableModesMonitor, CurrentMode
from vehicle_sim.protocol.units import whole_number

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    from vehicle_sim.protocol.telemetry import Builder

_DO_SET_STANDARD_MODE: Final = 262
_ADVANCED: Final = 1
_BY_HAND: Final = frozenset((Mode.ALT_HOLD, Mode.POSITION))
_NON_STANDARD: Final = 0
_STANDARD: Final = {
    Mode.POSITION: 1,
    Mode.CIRCLE: 2,
    Mode.ALT_HOLD: 4,
    Mode.RETURN: 5,
    Mode.AUTO: 6,
    Mode.LAND: 7,
    Mode.TAKEOFF: 8,
}
"""MAV_STANDARD_MODE of PX4's modes."""


class ModeListService:
    """Tells the modes, one by one or all, and the present one."""

    def __init__(self, host: Host) -> None:
        self._host = host
        self._order = sorted(host.table.custom_modes, key=lambda mode: host.table.custom_modes[mode])
        self.requests: Mapping[int, Callable[[Request], Outcome]] = {AvailableModes.id: self._give}
        self.commands: Mapping[int, Callable[[Request], Outcome]] = {_DO_SET_STANDARD_MODE: self._set_standard}
        # The set of modes never changes, so there is nothing to stream of it but that.
        self.telemetry: Mapping[int, Builder] = {
            AvailableModes.id: lambda _host: None,
            **({} if self._is_px4 else {AvailableModesMonitor.id: lambda _host: AvailableModesMonitor(1)}),
            CurrentMode.id: lambda _host: self._current(),
        }

    @property
    def _is_px4(self) -> bool:
        return self._host.table.flavour is Flavour.PX4

    def _give(self, request: Request) -> Outcome:
        """Answer REQUEST_MESSAGE: parameter 2 is the mode's place in the list from 1, or 0 for all."""
        place = whole_number(request.params[1])
        if place is None or place > len(self._order):
            return self._host.table.no_message
        for index in range(1, len(self._order) + 1) if place == 0 else (place,):
            request.sender.link.send(self._entry(index))
        return Outcome.ACCEPTED

    def _entry(self, index: int) -> Message:
        mode = self._order[index - 1]
        standard, properties = self._standard(mode), 0
        if self._is_px4 and mode not in _BY_HAND:
            properties |= _ADVANCED
        return AvailableModes(
            number_modes=len(self._order),
            mode_index=index,
            standard_mode=standard,
            custom_mode=self._host.table.custom_modes[mode],
            properties=properties,
            mode_name="" if standard else self._host.vehicle.autopilot.modes[mode].name,
        )

    def _standard(self, mode: Mode) -> int:
        return _STANDARD.get(mode, _NON_STANDARD) if self._is_px4 else _NON_STANDARD

    def _set_standard(self, request: Request) -> Outcome:
        """Enter the mode of PX4 that a standard one stands for; ArduPilot knows none."""
        if not self._is_px4:
            return Outcome.UNSUPPORTED
        mode = next((mode for mode, standard in _STANDARD.items() if standard == request.params[0]), None)
        return Outcome.FAILED if mode is None else self._host.vehicle.autopilot.set_mode(mode)

    def _current(self) -> Message:
        autopilot, numbers = self._host.vehicle.autopilot, self._host.table.custom_modes
        return CurrentMode(
            standard_mode=self._standard(autopilot.mode),
            custom_mode=numbers[autopilot.mode],
            intended_custom_mode=numbers[autopilot.intended_mode],
        )
