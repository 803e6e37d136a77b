"""The pilot's sticks by MAVLink: MANUAL_CONTROL and RC_CHANNELS_OVERRIDE; and the switch that chooses modes.

https://mavlink.io/en/services/manual_control.html. ArduPilot listens to the one ground station that its parameter
names, PX4 to any.
"""

from collections.abc import Callable, Mapping
from typing import Final

from vehicle_sim.autopilot import Mode
from vehicle_sim.autopilot.hand import Sticks
from vehicle_sim.parameters import Flavour
from vehicle_sim.protocol.data_files import data_file
from vehicle_sim.protocol.dialect import Message, mavlink
from vehicle_sim.protocol.host import Host, Sender

_FULL: Final = 1000
_HALF: Final = 500.0
_UNUSED: Final = 32767
_RELEASED: Final = 0
_AS_BEFORE: Final = 65535
_RELEASED_EXTENSION: Final = 65534
_FIRST_CHANNELS: Final = 8
_CHANNELS: Final = 18

_PX4_MODES: Final[Mapping[int, Mode]] = {
    int(number): Mode[name] for number, name in data_file("modes")["px4_switch"].items()
}
"""The values of PX4's COM_FLTMODE1 to 6; ArduPilot's FLTMODE1 to 6 are the modes' own numbers."""


class StickService:
    """Hands the pilot's sticks to the autopilot."""

    def __init__(self, host: Host) -> None:
        self._host = host
        self._is_px4 = host.table.flavour is Flavour.PX4
        self._modes = _PX4_MODES if self._is_px4 else host.table.modes
        self.messages: Mapping[int, Callable[[Sender, Message], None]] = {
            mavlink.MAVLINK_MSG_ID_MANUAL_CONTROL: self.on_manual_control,
            mavlink.MAVLINK_MSG_ID_RC_CHANNELS_OVERRIDE: self.on_channels,
        }

    def advance(self) -> None:
        """Change the mode where the mode switch has been moved; arm and disarm where the sticks ask for it."""
        autopilot = self._host.vehicle.autopilot
        pilot = autopilot.pilot
        if pilot.switched is not None:
            mode = self._modes.get(pilot.hand.switch_modes[pilot.switched])
            pilot.switched = None
            if mode is not None:
                autopilot.set_mode(mode)
        if pilot.arming is not None:
            change = autopilot.arm if pilot.arming else autopilot.disarm
            pilot.arming = None
            change(by_sticks=True)

    def _is_pilot(self, sender: Sender) -> bool:
        return self._host.vehicle.autopilot.settings.ground_system_id in (None, sender.system_id)

    def on_manual_control(self, sender: Sender, message: Message) -> None:
        """Take the sticks of a joystick: x forward, y right, r clockwise, -1000 to 1000; z up from 0 to 1000.

        ArduPilot puts them in the place of the radio's channels; a stick that is not used stays with the radio.
        """
        targets = (self._host.system_id, 0) if self._is_px4 else (self._host.system_id,)
        if message.target not in targets or not self._is_pilot(sender):
            return
        pilot, now_s = self._host.vehicle.autopilot.pilot, self._host.now_us * 1e-6
        ways = (
            *(None if value == _UNUSED else value / _FULL for value in (message.x, message.y, message.r)),
            None if message.z == _UNUSED else message.z / _HALF - 1.0,
        )
        if self._is_px4:
            x, y, r, climb = (old if way is None else way for way, old in zip(ways, pilot.sticks, strict=True))
            pilot.move(Sticks(x, y, r, climb), now_s)
            return
        for channel, way in zip(pilot.hand.channels, ways, strict=True):
            if way is not None:
                pilot.override(channel.number, channel.pulse_us(way), now_s)

    def on_channels(self, sender: Sender, message: Message) -> None:
        """Put pulse widths in microseconds in the place of the radio's channels.

        65535 leaves a channel as it is; 0 gives one of the first eight back. Of those behind them 0 leaves it as it is,
        because older clients do not send them, and 65534 gives it back.
        """
        if not self._is_pilot(sender):
            return
        pilot, now_s = self._host.vehicle.autopilot.pilot, self._host.now_us * 1e-6
        for number in range(1, _CHANNELS + 1):
            pulse, is_first = getattr(message, f"chan{number}_raw"), number <= _FIRST_CHANNELS
            if pulse == _AS_BEFORE or (pulse == _RELEASED and not is_first):
                continue
            is_released = pulse == (_RELEASED if is_first else _RELEASED_EXTENSION)
            pilot.override(number, None if is_released else pulse, now_s)
