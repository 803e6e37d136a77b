"""Commands that rare pages of ground stations send: what to look at, circles, following, tests of motors, servos.

After ArduPilot `GCS_Common.cpp`, `GCS_MAVLink_Copter.cpp`, `motor_test.cpp`, `AP_ServoRelayEvents.cpp`; PX4
`Commander.cpp` and `navigator_main.cpp`. What has no effect here is a row of `data/fixed_answers.json` with the answer
(null: none, for it is left to a module that is not there); commands of no table are not supported by the autopilot.
"""

from math import atan2, cos, isfinite, pi, sin
from typing import TYPE_CHECKING, Final, NamedTuple

from vehicle_sim.autopilot import Outcome, Severity
from vehicle_sim.geodesy import ned_offset_m
from vehicle_sim.parameters import Flavour
from vehicle_sim.protocol.data_files import data_file
from vehicle_sim.protocol.dialect import Message, mavlink
from vehicle_sim.protocol.places import altitude_m, global_place, is_place
from vehicle_sim.protocol.sensing import servo_output_raw
from vehicle_sim.protocol.units import E7
from vehicle_sim.signals import Geodetic, PartialVector

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    from vehicle_sim.protocol.commands import Request
    from vehicle_sim.protocol.host import Host, Sender
    from vehicle_sim.protocol.telemetry import Builder

_ROTORS: Final = 4
_OUTPUTS: Final = 16
_LEAST_US, _MOST_US = 1000, 2000
_PERCENT, _PULSE = 0, 1
_SECOND_US: Final = 1_000_000
_LONGEST_TEST_US: Final = 3_000_000
_FOR_EVER: Final = 1 << 62
_FIRST_FUNCTION: Final = 1101
_CLOSEST_ORBIT_M: Final = 1.0
_STANDS_M_S: Final = 0.5


class _Order(NamedTuple):
    """A pulse that an output gives for a time, in microseconds all."""

    pulse_us: int
    since_us: int
    until_us: int


class SpecialCommandService:
    """Answers them, and shows in SERVO_OUTPUT_RAW what they did to outputs.

    Attributes:
        commands: What the command service calls for them; None is no answer.
    """

    def __init__(self, host: "Host") -> None:
        self._host = host
        self._orders: dict[int, _Order] = {}
        flavour = host.table.flavour
        known: Mapping[Flavour, Mapping[int, Callable[[Request], Outcome | int | None]]] = {
            Flavour.ARDUPILOT: {
                mavlink.MAV_CMD_DO_SET_ROI: self._look_at,
                mavlink.MAV_CMD_DO_SET_ROI_LOCATION: self._look_at,
                mavlink.MAV_CMD_DO_SET_ROI_NONE: self._look_ahead,
                mavlink.MAV_CMD_DO_GRIPPER: self._grip,
                mavlink.MAV_CMD_DO_SET_SERVO: self._set_servo,
                mavlink.MAV_CMD_DO_REPEAT_SERVO: self._set_servo,
                mavlink.MAV_CMD_DO_MOTOR_TEST: self._test_motors,
            },
            Flavour.PX4: {
                mavlink.MAV_CMD_DO_ORBIT: self._orbit,
                mavlink.MAV_CMD_DO_CHANGE_ALTITUDE: self._change_altitude,
                mavlink.MAV_CMD_ACTUATOR_TEST: self._test_actuator,
            },
        }
        answers = data_file("fixed_answers")[flavour.value]
        self._fixed = {getattr(mavlink, f"MAV_CMD_{name}"): answer for name, answer in answers.items()}
        self.commands: Mapping[int, Callable[[Request], Outcome | int | None]] = {
            **dict.fromkeys(self._fixed, lambda request: self._fixed[request.command]),
            **known[flavour],
        }
        self.messages: Mapping[int, Callable[[Sender, Message], None]] = (
            {mavlink.MAVLINK_MSG_ID_FOLLOW_TARGET: self.on_target} if flavour is Flavour.PX4 else {}
        )
        self.telemetry: Mapping[int, Builder] = {mavlink.MAVLINK_MSG_ID_SERVO_OUTPUT_RAW: self._outputs}

    # Where to look, and to fly.

    def _look_at(self, request: "Request") -> Outcome:
        lat_deg, lon_deg, height_m = request.params[4:7]
        if not is_place(lat_deg, lon_deg):
            return Outcome.FAILED
        self._host.vehicle.autopilot.look_at(Geodetic(lat_deg, lon_deg, height_m))
        return Outcome.ACCEPTED

    def _look_ahead(self, _request: "Request") -> Outcome:
        self._host.vehicle.autopilot.look_at(None)
        return Outcome.ACCEPTED

    def _orbit(self, request: "Request") -> Outcome:
        """Fly circles: radius (to the left below 0), speed; round a place, at a height, or ahead and at this one."""
        autopilot, origin = self._host.vehicle.autopilot, self._host.vehicle.estimate.origin
        radius_m, speed_m_s = request.params[:2]
        lat_deg, lon_deg, height_m = request.params[4:7]
        centre: PartialVector = (None, None, None)
        if origin is not None:
            frame = mavlink.MAV_FRAME_GLOBAL if request.frame is None else request.frame
            alt_m = altitude_m(height_m, frame, autopilot.home)
            down_m = None if alt_m is None else origin.alt_m - alt_m
            place = global_place(lat_deg, lon_deg, origin.alt_m, mavlink.MAV_FRAME_GLOBAL, None)
            centre = (None, None, down_m) if place is None else (*ned_offset_m(origin, place)[:2], down_m)
        return autopilot.orbit(
            centre,
            radius_m=radius_m if isfinite(radius_m) and abs(radius_m) >= _CLOSEST_ORBIT_M else None,
            speed_m_s=speed_m_s if isfinite(speed_m_s) and speed_m_s > 0.0 else None,
        )

    def _change_altitude(self, request: "Request") -> Outcome:
        autopilot, origin = self._host.vehicle.autopilot, self._host.vehicle.estimate.origin
        frame = request.params[1]
        alt_m = altitude_m(request.params[0], int(frame) if isfinite(frame) else -1, autopilot.home)
        if origin is None or alt_m is None:
            return Outcome.TEMPORARILY_REJECTED
        return autopilot.reposition((None, None, origin.alt_m - alt_m))

    def on_target(self, _sender: "Sender", message: Message) -> None:
        """Follow whoever tells where he is: behind him by his course; from the south while he stands."""
        origin, lat_deg, lon_deg = self._host.vehicle.estimate.origin, message.lat / E7, message.lon / E7
        if origin is None or not is_place(lat_deg, lon_deg):
            return
        north, east, _down = ned_offset_m(origin, Geodetic(lat_deg, lon_deg, origin.alt_m))
        v_north, v_east = message.vel[:2]
        moves = v_north * v_north + v_east * v_east > _STANDS_M_S * _STANDS_M_S
        behind = pi + (atan2(v_east, v_north) if moves else 0.0)
        distance_m = self._host.vehicle.parameters["FLW_TGT_DST"]
        place = (north + distance_m * cos(behind), east + distance_m * sin(behind), None)
        self._host.vehicle.autopilot.follow(place)

    def _grip(self, request: "Request") -> Outcome:
        return Outcome.ACCEPTED if request.params[1] in (0.0, 1.0) else Outcome.FAILED

    # Outputs.

    def _set_servo(self, request: "Request") -> Outcome:
        output, pulse_us = request.params[:2]
        if not (isfinite(output) and isfinite(pulse_us) and 1.0 <= output <= _OUTPUTS):
            return Outcome.FAILED
        if output <= _ROTORS:
            self._host.say(Severity.INFO, f"ServoRelayEvent: Channel {output:.0f} is already in use")
            return Outcome.FAILED
        self._orders[int(output)] = _Order(round(pulse_us), self._host.now_us, _FOR_EVER)
        return Outcome.ACCEPTED

    def _test_motors(self, request: "Request") -> Outcome:
        """Run motors one after another: the first, how the throttle is given, throttle, seconds, how many."""
        if self._host.vehicle.autopilot.flying:
            self._host.say(Severity.CRITICAL, "Motor Test: vehicle not landed")
            return Outcome.FAILED
        first, kind, throttle, seconds, count = request.params[:5]
        if request.frame is not None:
            count *= E7
        if not all(map(isfinite, (first, kind, throttle, seconds, count))) or not 1.0 <= first <= _ROTORS:
            return Outcome.FAILED
        pulse_us = {_PERCENT: _LEAST_US + 10.0 * throttle, _PULSE: throttle}.get(int(kind), 0.0)
        if not _LEAST_US <= pulse_us <= _MOST_US:
            return Outcome.FAILED
        self._host.say(Severity.INFO, "starting motor test")
        lasts_us, start_us = round(max(seconds, 0.0) * _SECOND_US), self._host.now_us
        for place in range(max(round(count), 1)):
            motor = (int(first) - 1 + place) % _ROTORS + 1
            self._orders[motor] = _Order(round(pulse_us), start_us, start_us + lasts_us)
            start_us += lasts_us
        return Outcome.ACCEPTED

    def _test_actuator(self, request: "Request") -> Outcome:
        """Run one motor, PX4's way: a share of the throttle, seconds (0: no more), and its function."""
        vehicle = self._host.vehicle
        share, seconds, function = request.params[0], request.params[1], request.params[4]
        if request.frame is not None:
            function *= E7
        if vehicle.autopilot.armed or not vehicle.parameters["COM_MOT_TEST_EN"]:
            return Outcome.DENIED
        if not isfinite(function):
            return Outcome.UNSUPPORTED
        motor = round(function) - (_FIRST_FUNCTION - 1 if function >= _LEAST_US else 0)
        if not 1 <= motor <= _ROTORS:
            # Functions that no output has are as good as others, in the long form.
            return Outcome.ACCEPTED if function >= _LEAST_US else Outcome.UNSUPPORTED
        lasts_us = min(round(seconds * _SECOND_US), _LONGEST_TEST_US) if isfinite(seconds) else 0
        pulse_us = _LEAST_US + round(1000 * min(max(share, 0.0), 1.0)) if isfinite(share) else _LEAST_US
        self._orders[motor] = _Order(pulse_us, self._host.now_us, self._host.now_us + lasts_us)
        return Outcome.ACCEPTED

    def _outputs(self, host: "Host") -> Message | None:
        message = servo_output_raw(host)
        for output, order in self._orders.items():
            tested = not (output <= _ROTORS and host.vehicle.autopilot.armed)
            if message is not None and tested and order.since_us <= host.now_us < order.until_us:
                setattr(message, f"servo{output}_raw", order.pulse_us)
        return message
