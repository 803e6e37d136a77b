"""The pilot's sticks by MAVLink: MANUAL_CONTROL, and RC_CHANNELS_OVERRIDE as ArduPilot takes it.

https://mavlink.io/en/services/manual_control.html. ArduPilot listens to the one ground station that its parameter
names, PX4 to any.
"""

from typing import TYPE_CHECKING, Final

from vehicle_sim.autopilot.hand import Sticks
from vehicle_sim.parameters import Flavour
from vehicle_sim.protocol.dialect import Message, mavlink
from vehicle_sim.protocol.host import Host, Sender

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

_FULL: Final = 1000
_HALF: Final = 500.0
_UNUSED: Final = 32767
_MIDDLE_US: Final = 1500
_RELEASED: Final = 0
_AS_BEFORE: Final = 65535
_CHANNELS: Final = (("RCMAP_PITCH", -1.0), ("RCMAP_ROLL", 1.0), ("RCMAP_YAW", 1.0), ("RCMAP_THROTTLE", 1.0))
"""The channel of each stick and its sign, in the order of `Sticks`: pitch is low for forward."""


class StickService:
    """Hands the pilot's sticks to the autopilot."""

    def __init__(self, host: Host) -> None:
        self._host = host
        self.messages: Mapping[int, Callable[[Sender, Message], None]] = {
            mavlink.MAVLINK_MSG_ID_MANUAL_CONTROL: self.on_manual_control,
            mavlink.MAVLINK_MSG_ID_RC_CHANNELS_OVERRIDE: self.on_channels,
        }

    def _is_pilot(self, sender: Sender) -> bool:
        return self._host.vehicle.autopilot.settings.ground_system_id in (None, sender.system_id)

    def on_manual_control(self, sender: Sender, message: Message) -> None:
        """Take the sticks of a joystick: x forward, y right, r clockwise, -1000 to 1000; z up from 0 to 1000."""
        is_px4 = self._host.table.flavour is Flavour.PX4
        targets = (self._host.system_id, 0) if is_px4 else (self._host.system_id,)
        if message.target not in targets or not self._is_pilot(sender):
            return
        before = self._host.vehicle.autopilot.pilot.sticks
        x, y, r = (
            old if value == _UNUSED else value / _FULL
            for value, old in zip((message.x, message.y, message.r), before, strict=False)
        )
        climb = before.climb if message.z == _UNUSED else message.z / _HALF - 1.0
        self._move(Sticks(x, y, r, climb))

    def on_channels(self, sender: Sender, message: Message) -> None:
        """Take pulse widths in microseconds by channel: 0 gives a channel back, 65535 leaves it as it is."""
        if self._host.table.flavour is Flavour.PX4 or not self._is_pilot(sender):
            return
        parameters, pilot = self._host.vehicle.parameters, self._host.vehicle.autopilot.pilot
        values: list[float] = []
        released = 0
        for (name, sign), before in zip(_CHANNELS, pilot.sticks, strict=True):
            pulse = getattr(message, f"chan{int(parameters[name])}_raw")
            released += pulse == _RELEASED
            if pulse == _RELEASED:
                values.append(0.0)
            else:
                values.append(before if pulse == _AS_BEFORE else sign * (pulse - _MIDDLE_US) / _HALF)
        if released == len(_CHANNELS):
            pilot.leave()
        else:
            forward, right, turn, climb = values
            self._move(Sticks(forward, right, turn, climb))

    def _move(self, sticks: Sticks) -> None:
        self._host.vehicle.autopilot.pilot.move(sticks, self._host.now_us * 1e-6)
