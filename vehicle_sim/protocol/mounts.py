"""The mount of the camera: it takes commands as a gimbal does, and looks straight down whatever they say.

ArduPilot `AP_Mount.cpp`; PX4 `input_mavlink.cpp`, whose gimbal manager obeys the one that it was told to alone, and
whose commands nobody answers where there is no gimbal.
"""

from math import isnan
from typing import TYPE_CHECKING, Final

from vehicle_sim.autopilot import Outcome
from vehicle_sim.parameters import Flavour
from vehicle_sim.protocol.dialect import mavlink

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    from vehicle_sim.protocol.commands import Request
    from vehicle_sim.protocol.host import Host

_UNCHANGED, _MYSELF, _RELEASE = -1, -2, -3
_MODES: Final = mavlink.GIMBAL_MANAGER_FLAGS_RETRACT | mavlink.GIMBAL_MANAGER_FLAGS_NEUTRAL


class MountService:
    """Answers what is asked of the mount.

    Attributes:
        commands: What the command service calls for it; None is no answer.
    """

    def __init__(self, host: "Host") -> None:
        self._host = host
        self._in_control = (0, 0)
        known: Mapping[Flavour, Mapping[int, Callable[[Request], Outcome]]] = {
            Flavour.ARDUPILOT: {
                mavlink.MAV_CMD_DO_MOUNT_CONFIGURE: lambda _request: Outcome.ACCEPTED,
                mavlink.MAV_CMD_DO_MOUNT_CONTROL: lambda _request: Outcome.ACCEPTED,
                mavlink.MAV_CMD_DO_GIMBAL_MANAGER_PITCHYAW: self._ardupilot_turn,
            },
            Flavour.PX4: {
                mavlink.MAV_CMD_DO_MOUNT_CONFIGURE: lambda _request: Outcome.ACCEPTED,
                mavlink.MAV_CMD_DO_MOUNT_CONTROL: lambda _request: Outcome.ACCEPTED,
                mavlink.MAV_CMD_DO_GIMBAL_MANAGER_CONFIGURE: self._px4_configure,
                mavlink.MAV_CMD_DO_GIMBAL_MANAGER_PITCHYAW: self._px4_turn,
            },
        }
        self._known = known[host.table.flavour]
        self.commands: Mapping[int, Callable[[Request], Outcome | None]] = dict.fromkeys(self._known, self._answer)

    def _answer(self, request: "Request") -> Outcome | None:
        parameters = self._host.vehicle.parameters
        if self._host.table.flavour is Flavour.PX4:
            return None if parameters["MNT_MODE_IN"] < 0.0 else self._known[request.command](request)
        return self._known[request.command](request) if parameters["MNT1_TYPE"] else Outcome.FAILED

    def _ardupilot_turn(self, request: "Request") -> Outcome:
        """Take both angles, both rates or a mode, of the one mount that there is."""
        params = request.params
        if params[6] not in (0.0, 1.0):
            return Outcome.FAILED
        whole = any(not isnan(first) and not isnan(second) for first, second in (params[0:2], params[2:4]))
        flags = 0 if isnan(params[4]) else int(params[4])
        return Outcome.ACCEPTED if whole or flags & _MODES else Outcome.FAILED

    def _px4_configure(self, request: "Request") -> Outcome:
        """Note who is to be obeyed: a system and a component, or one of their special values."""
        sender = (request.sender.system_id, request.sender.component_id)
        itself = (self._host.system_id, self._host.component_id)
        control = list(self._in_control)
        for place, asked in enumerate(request.params[:2]):
            number = _UNCHANGED if isnan(asked) else round(asked)
            if 0 <= number <= 255:  # noqa: PLR2004 - the ids of MAVLink
                control[place] = number
            elif number == _MYSELF:
                control[place] = itself[place]
            elif number == _RELEASE and control[place] == sender[place]:
                control[place] = 0
        self._in_control = (control[0], control[1])
        return Outcome.ACCEPTED

    def _px4_turn(self, request: "Request") -> Outcome:
        sender = (request.sender.system_id, request.sender.component_id)
        return Outcome.ACCEPTED if sender == self._in_control else Outcome.DENIED
