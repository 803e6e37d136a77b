"""The command protocol: COMMAND_LONG, COMMAND_INT and SET_MODE, each answered to its sender.

https://mavlink.io/en/services/command.html. Every handler may be called again with the same request: what is already
so is accepted.
"""

from math import isfinite, isnan, nan, radians
from typing import TYPE_CHECKING, Final, NamedTuple

from vehicle_sim.autopilot import Autopilot, Outcome, Severity, SpeedAxis
from vehicle_sim.geodesy import ned_offset_m
from vehicle_sim.parameters import Flavour
from vehicle_sim.protocol.dialect import Message, mavlink
from vehicle_sim.protocol.host import Host, Sender
from vehicle_sim.protocol.places import AMSL_FRAMES, altitude_m, global_place
from vehicle_sim.protocol.units import whole_number
from vehicle_sim.signals import Geodetic, PartialVector

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

_FORCE: Final = 21196
_NO_PLACE: Final = 2**31 - 1
_CHANGE_MODE: Final = 1
_ONE_CM: Final = 0.01
_SPEED_AXES: Final = {
    0: SpeedAxis.HORIZONTAL,
    1: SpeedAxis.HORIZONTAL,
    2: SpeedAxis.UP,
    3: SpeedAxis.DOWN,
}


class Request(NamedTuple):
    """A command with its seven parameters, whichever message it came in.

    Attributes:
        params: As sent; latitude and longitude (5, 6) in degrees where `frame` is a global one.
        frame: MAV_FRAME of a COMMAND_INT, None of a COMMAND_LONG.
    """

    sender: Sender
    command: int
    params: tuple[float, ...]
    frame: int | None


def _frame(request: Request) -> int:
    return mavlink.MAV_FRAME_GLOBAL if request.frame is None else request.frame


class CommandService:
    """Carries commands out and acknowledges them.

    Attributes:
        handlers: What to do with each command, None leaves it unanswered; other services add theirs.
    """

    def __init__(self, host: Host) -> None:
        self._host = host
        self.handlers: dict[int, Callable[[Request], Outcome | int | None]] = {
            mavlink.MAV_CMD_COMPONENT_ARM_DISARM: self._arm_disarm,
            mavlink.MAV_CMD_DO_SET_MODE: self._do_set_mode,
            mavlink.MAV_CMD_NAV_TAKEOFF: self._takeoff,
            mavlink.MAV_CMD_NAV_LAND: lambda _request: self._autopilot.land(),
            mavlink.MAV_CMD_NAV_RETURN_TO_LAUNCH: lambda _request: self._autopilot.return_to_launch(),
            mavlink.MAV_CMD_NAV_LOITER_UNLIM: lambda _request: self._autopilot.hold(),
            mavlink.MAV_CMD_DO_REPOSITION: self._reposition,
            mavlink.MAV_CMD_DO_CHANGE_SPEED: self._change_speed,
            mavlink.MAV_CMD_CONDITION_YAW: self._turn,
            mavlink.MAV_CMD_DO_SET_HOME: self._set_home,
            mavlink.MAV_CMD_DO_PAUSE_CONTINUE: self._pause_continue,
            mavlink.MAV_CMD_DO_FLIGHTTERMINATION: self._terminate,
            mavlink.MAV_CMD_RUN_PREARM_CHECKS: self._run_prearm_checks,
            mavlink.MAV_CMD_PREFLIGHT_REBOOT_SHUTDOWN: self._reboot,
            mavlink.MAV_CMD_DO_SEND_BANNER: self._send_banner,
        }
        self.messages: Mapping[int, Callable[[Sender, Message], None]] = {
            mavlink.MAVLINK_MSG_ID_COMMAND_LONG: self.on_command_long,
            mavlink.MAVLINK_MSG_ID_COMMAND_INT: self.on_command_int,
            mavlink.MAVLINK_MSG_ID_SET_MODE: self.on_set_mode,
        }

    @property
    def _autopilot(self) -> Autopilot:
        return self._host.vehicle.autopilot

    def on_command_long(self, sender: Sender, message: Message) -> None:
        """Carry out a COMMAND_LONG."""
        params = (message.param1, message.param2, message.param3, message.param4)
        self._answer(Request(sender, message.command, (*params, message.param5, message.param6, message.param7), None))

    def on_command_int(self, sender: Sender, message: Message) -> None:
        """Carry out a COMMAND_INT, with latitude and longitude in 1e-7 degrees, or neither."""
        params = (message.param1, message.param2, message.param3, message.param4)
        is_given = (message.x, message.y) != (_NO_PLACE, _NO_PLACE)
        place = (message.x * 1e-7, message.y * 1e-7, message.z) if is_given else (nan, nan, message.z)
        self._answer(Request(sender, message.command, (*params, *place), message.frame))

    def on_set_mode(self, sender: Sender, message: Message) -> None:
        """Carry out SET_MODE, which older ground stations use; acknowledged as each autopilot does it."""
        outcome = self._set_mode(message.base_mode, message.custom_mode)
        is_px4 = self._host.table.flavour is Flavour.PX4
        command = mavlink.MAV_CMD_DO_SET_MODE if is_px4 else mavlink.MAVLINK_MSG_ID_SET_MODE
        self._acknowledge(sender, command, outcome)

    def _answer(self, request: Request) -> None:
        handler = self.handlers.get(request.command)
        result = Outcome.UNSUPPORTED if handler is None else handler(request)
        if result is not None:
            self._acknowledge(request.sender, request.command, result)

    def _acknowledge(self, sender: Sender, command: int, result: int) -> None:
        sender.link.send(
            mavlink.MAVLink_command_ack_message(command, int(result), 0, 0, sender.system_id, sender.component_id)
        )

    def _arm_disarm(self, request: Request) -> Outcome:
        forced = request.params[1] == _FORCE
        if request.params[0] == 1.0:
            return self._autopilot.arm(force=forced)
        if request.params[0] == 0.0:
            return self._autopilot.disarm(force=forced)
        return Outcome.UNSUPPORTED

    def _do_set_mode(self, request: Request) -> Outcome:
        base, main, sub = (whole_number(value) for value in request.params[:3])
        if base is None or main is None:
            return Outcome.DENIED
        if self._host.table.flavour is Flavour.PX4:
            main = main << 16 | (sub or 0) << 24
        return self._set_mode(base, main)

    def _set_mode(self, base: int, number: int) -> Outcome:
        """Enter the mode that `number` stands for; neither autopilot guesses one from `base` alone."""
        if not base & mavlink.MAV_MODE_FLAG_CUSTOM_MODE_ENABLED:
            return Outcome.UNSUPPORTED
        mode = self._host.table.modes.get(number)
        if mode is None:
            if self._host.table.flavour is Flavour.ARDUPILOT:
                self._host.say(Severity.WARNING, f"No such mode {number}")
            return self._host.table.no_mode
        return self._autopilot.set_mode(mode)

    def _takeoff(self, request: Request) -> Outcome:
        height = request.params[6]
        if not isfinite(height):
            return self._autopilot.takeoff(None) if self._host.table.takeoff_is_amsl else Outcome.DENIED
        if self._host.table.takeoff_is_amsl:
            home = self._autopilot.home
            if home is None:
                return Outcome.TEMPORARILY_REJECTED
            height -= home.alt_m
        return self._autopilot.takeoff(height)

    def _reposition(self, request: Request) -> Outcome | int:
        is_px4 = self._host.table.flavour is Flavour.PX4
        if request.frame is None and not is_px4:
            return int(mavlink.MAV_RESULT_COMMAND_INT_ONLY)
        origin = self._host.vehicle.estimate.origin
        lat_deg, lon_deg, height_m = request.params[4:7]
        target: PartialVector | None = None
        if is_px4 and not (isfinite(lat_deg) and isfinite(lon_deg)):
            # So ground stations pause it, change its height or turn it: what is no number stays.
            alt_m = altitude_m(height_m, _frame(request), self._autopilot.home)
            if origin is not None and (alt_m is not None or isnan(height_m)):
                target = (None, None, None if alt_m is None else origin.alt_m - alt_m)
        elif (place := self._place(request)) is not None and origin is not None:
            target = ned_offset_m(origin, place)
        if not is_px4 and request.frame not in AMSL_FRAMES and abs(height_m) < _ONE_CM:
            target = None  # to ArduPilot a height of nothing above home has not been filled in
        if target is None:
            return Outcome.TEMPORARILY_REJECTED if is_px4 and origin is None else Outcome.DENIED
        speed, flags, _radius, yaw = request.params[:4]
        flags_asked = whole_number(flags)
        return self._autopilot.reposition(
            target,
            yaw_rad=yaw if isfinite(yaw) else None,
            speed_m_s=speed if isfinite(speed) and speed > 0.0 else None,
            change_mode=bool((flags_asked or 0) & _CHANGE_MODE),
        )

    def _place(self, request: Request) -> Geodetic | None:
        lat_deg, lon_deg, height_m = request.params[4:7]
        frame = _frame(request)
        estimate = self._host.vehicle.estimate
        if isnan(height_m) and estimate.origin is not None:
            frame, height_m = mavlink.MAV_FRAME_GLOBAL, estimate.origin.alt_m - estimate.position_ned_m[2]
        return global_place(lat_deg, lon_deg, height_m, frame, self._autopilot.home)

    def _change_speed(self, request: Request) -> Outcome:
        axis = _SPEED_AXES.get(int(request.params[0])) if isfinite(request.params[0]) else None
        speed = request.params[1]
        if axis is None or not isfinite(speed) or speed <= 0.0:
            return Outcome.DENIED
        return self._autopilot.change_speed(speed, axis)

    def _turn(self, request: Request) -> Outcome:
        if self._host.table.flavour is Flavour.PX4:
            return Outcome.UNSUPPORTED  # only an item of a mission there
        angle_deg, rate_deg_s, direction, relative = request.params[:4]
        if not (isfinite(angle_deg) and isfinite(rate_deg_s)):
            return Outcome.DENIED
        is_relative = relative == 1.0
        sign = -1.0 if is_relative and direction < 0.0 else 1.0
        rate_rad_s = radians(abs(rate_deg_s)) if rate_deg_s else None
        return self._autopilot.turn(sign * radians(angle_deg), rate_rad_s=rate_rad_s, relative=is_relative)

    def _set_home(self, request: Request) -> Outcome:
        here, lat_deg, lon_deg = request.params[0], *request.params[4:6]
        if self._host.table.flavour is Flavour.PX4:
            is_here = here > 0.5  # noqa: PLR2004 - the command's own threshold between a flag's 0 and 1
        else:
            is_here = here == 1.0 or (lat_deg, lon_deg) == (0.0, 0.0)
            if not is_here and here != 0.0:
                return Outcome.FAILED
        if is_here:
            return self._autopilot.set_home(None)
        place = self._place(request)
        return Outcome.DENIED if place is None else self._autopilot.set_home(place)

    def _pause_continue(self, request: Request) -> Outcome:
        if request.params[0] == 0.0:
            return self._autopilot.pause()
        return self._autopilot.resume() if request.params[0] == 1.0 else Outcome.DENIED

    def _terminate(self, request: Request) -> Outcome:
        if request.params[0] > 0.5:  # noqa: PLR2004 - the command's own threshold between a flag's 0 and 1
            return self._autopilot.terminate()
        return Outcome.UNSUPPORTED if self._host.table.flavour is Flavour.PX4 else Outcome.FAILED

    def _reboot(self, request: Request) -> Outcome:
        """Restart once the acknowledgement is on its way: ArduPilot waits for 0.2 s, PX4 for 0.4 s.

        There is no power to switch off and no boot loader; parameter 1 asks for a restart by 1, for nothing by 0.
        """
        is_px4, action = self._host.table.flavour is Flavour.PX4, request.params[0]
        if is_px4 and action == 0.0:
            return Outcome.ACCEPTED
        if action != 1.0:
            return Outcome.DENIED if is_px4 else Outcome.UNSUPPORTED
        if self._autopilot.armed:
            return self._host.table.no_reboot
        self._host.reboot_in(400_000 if is_px4 else 200_000)
        return Outcome.ACCEPTED

    def _send_banner(self, _request: Request) -> Outcome:
        """Say what the vehicle answers like, in the words that ArduPilot's ground stations look for."""
        if self._host.table.flavour is Flavour.PX4:
            return Outcome.UNSUPPORTED
        version = self._host.table.software_version
        self._host.say(Severity.INFO, f"ArduCopter V{version >> 24}.{version >> 16 & 0xFF}.{version >> 8 & 0xFF}-dev")
        self._host.say(Severity.INFO, "Frame: QUAD")
        return Outcome.ACCEPTED

    def _run_prearm_checks(self, _request: Request) -> Outcome:
        if self._autopilot.armed:
            return Outcome.TEMPORARILY_REJECTED
        for fault in self._autopilot.prearm_faults:
            self._host.say(Severity.CRITICAL, f"PreArm: {fault.text}")
        return Outcome.ACCEPTED
