"""Attitudes as setpoints: SET_ATTITUDE_TARGET, which is never acknowledged.

ArduPilot takes it in GUIDED only and stops where thrust is left out, where rates are asked for in part, or where the
quaternion is not of unit length; its `thrust` is a climb rate (0.5 keeps the height), or thrust with bit 3 of
GUID_OPTIONS. PX4 takes an attitude, or else roll and pitch rates, or else nothing; left out thrust is none. After
ArduPilot `GCS_MAVLink_Copter.cpp` and PX4 `mavlink_receiver.cpp`.
"""

from math import asin, atan2, isfinite, sqrt
from struct import unpack_from
from typing import TYPE_CHECKING, Final

from vehicle_sim.autopilot.attitude_task import Attitude
from vehicle_sim.autopilot.modes import BY_ATTITUDE
from vehicle_sim.dynamics.hover import MOST_THRUST_M_S2
from vehicle_sim.parameters import Flavour
from vehicle_sim.protocol.dialect import MAGIC_V2, Message, mavlink
from vehicle_sim.protocol.host import Host, Sender

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence

    from vehicle_sim.signals import Vector

_ALL_RATES: Final = 0b111
_ROLL_AND_PITCH: Final = 0b011
_YAW_RATE: Final = mavlink.ATTITUDE_TARGET_TYPEMASK_BODY_YAW_RATE_IGNORE
_THRUST_BODY: Final = 32
"""ATTITUDE_TARGET_TYPEMASK_THRUST_BODY_SET; like the field itself it is younger than the dialect of pymavlink."""
_NO_THRUST: Final = mavlink.ATTITUDE_TARGET_TYPEMASK_THROTTLE_IGNORE
_NO_ATTITUDE: Final = mavlink.ATTITUDE_TARGET_TYPEMASK_ATTITUDE_IGNORE
_UNIT: Final = 1e-3
_WITH_BODY_THRUST: Final = 51


class AttitudeService:
    """Turns attitudes of the wire into the autopilot's."""

    def __init__(self, host: Host) -> None:
        self._host = host
        takes = self._px4 if host.table.flavour is Flavour.PX4 else self._ardupilot
        self.messages: Mapping[int, Callable[[Sender, Message], None]] = {
            mavlink.MAVLINK_MSG_ID_SET_ATTITUDE_TARGET: lambda _sender, message: takes(message)
        }

    def _ardupilot(self, message: Message) -> None:
        autopilot, mask = self._host.vehicle.autopilot, message.type_mask
        if autopilot.mode not in BY_ATTITUDE:
            return
        ignored, q = mask & _ALL_RATES, message.q
        is_unit = abs(sum(part * part for part in q) - 1.0) < _UNIT
        numbers = (message.body_roll_rate, message.body_pitch_rate, message.body_yaw_rate, message.thrust)
        whole = ignored in (0, _ALL_RATES) and all(map(isfinite, numbers))
        if mask & _NO_THRUST or not whole or not (mask & _NO_ATTITUDE or is_unit):
            autopilot.halt()
            return
        attitude = None if mask & _NO_ATTITUDE else _euler(q)
        rates = (message.body_roll_rate, message.body_pitch_rate, message.body_yaw_rate)
        settings, climb_m_s, thrust_m_s2 = autopilot.settings, None, None
        if settings.thrust_climbs:
            stick = 2.0 * _share(message.thrust) - 1.0
            climb_m_s = stick * (settings.climb_m_s if stick > 0.0 else settings.descent_m_s)
        else:
            thrust_m_s2 = _share(message.thrust) * MOST_THRUST_M_S2
        autopilot.attitude(
            Attitude(attitude, None if ignored else rates, turns_on=True, climb_m_s=climb_m_s, thrust_m_s2=thrust_m_s2)
        )

    def _px4(self, message: Message) -> None:
        mask, attitude = message.type_mask, None
        if not mask & _NO_ATTITUDE:
            size = sqrt(sum(part * part for part in message.q))
            if not (isfinite(size) and size > 0.0):
                return  # no attitude at all: the last one holds
            attitude = _euler([part / size for part in message.q])
        elif mask & _ROLL_AND_PITCH:
            return
        yaw_rate = 0.0 if mask & _YAW_RATE else message.body_yaw_rate
        tilting = (0.0, 0.0) if attitude is not None else (message.body_roll_rate, message.body_pitch_rate)
        thrust = 0.0 if mask & _NO_THRUST else message.thrust
        if mask & _THRUST_BODY and attitude is not None:
            thrust = -_body_thrust_down(message)
        if not all(map(isfinite, (*tilting, yaw_rate, thrust))):
            return
        rates = (*tilting, yaw_rate)
        self._host.vehicle.autopilot.attitude(
            Attitude(attitude, rates, turns_on=False, thrust_m_s2=_share(thrust) * MOST_THRUST_M_S2)
        )


def _body_thrust_down(message: Message) -> float:
    """Return the last number of `thrust_body`, an extension behind the 39 bytes that MAVLink 1 knows; 0 without it."""
    frame = bytes(message.get_msgbuf())
    if frame[0] != MAGIC_V2:
        return 0.0
    payload = frame[10 : 10 + frame[1]].ljust(_WITH_BODY_THRUST, b"\0")
    return float(unpack_from("<f", payload, _WITH_BODY_THRUST - 4)[0])


def _share(value: float) -> float:
    return max(0.0, min(value, 1.0))


def _euler(q: "Sequence[float]") -> "Vector":
    """Return roll, pitch and yaw of a unit quaternion w, x, y, z."""
    w, x, y, z = q
    return (
        atan2(2.0 * (w * x + y * z), 1.0 - 2.0 * (x * x + y * y)),
        asin(max(-1.0, min(2.0 * (w * y - z * x), 1.0))),
        atan2(2.0 * (w * z + x * y), 1.0 - 2.0 * (y * y + z * z)),
    )
