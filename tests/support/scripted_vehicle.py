"""A vehicle that does what a script says: the habits of ArduPilot and PX4, and the faults of links and vehicles.

It shares no code with the bundled vehicle: what it does was written down from the observations of both autopilots.
Transport and clock in one; its time passes only while someone waits for messages.
"""

import math
import random
from collections import Counter
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

from pymavlink.dialects.v20 import ardupilotmega as mavlink

STEP_S = 0.02
_PLACED = (32, 33, 49)  # not before it knows where it is
GROUND_STATION = (255, 190)
ACCEPTED, REJECTED, FAILED = 0, 1, 4
ARM, TAKEOFF, LAND, SET_MODE, REQUEST = 400, 22, 21, 176, 512
ORIGIN = 49
GUIDED, BRAKE, AP_LAND, RTL, STABILIZE = 4, 17, 9, 6, 0
PX4_OFFBOARD, PX4_HOLD, PX4_TAKEOFF, PX4_LAND, PX4_RTL = 0x60000, 0x3040000, 0x2040000, 0x6040000, 0x5040000


@dataclass
class Script:
    """What this vehicle does otherwise than a good one; counts say how often."""

    origin_at_s: float = 1.0
    home_alt_m: float = 100.0
    deaf_to: Counter[int] = field(default_factory=Counter)
    silent_about: Counter[int] = field(default_factory=Counter)
    refuses: dict[int, tuple[int, int, str]] = field(default_factory=dict)  # command: times, result, words
    ignores: Counter[int] = field(default_factory=Counter)  # accepted, not done
    on_request_only: frozenset[int] = frozenset()  # messages that an accepted rate does not bring
    lose: float = 0.0
    double: float = 0.0
    shuffle: bool = False
    second_station: bool = False
    other_vehicle: bool = False
    autopilot: int | None = None
    vehicle_type: int = mavlink.MAV_TYPE_QUADROTOR
    armed_at_start: bool = False
    at: dict[float, Callable[["ScriptedVehicle"], None]] = field(default_factory=dict)


class ScriptedVehicle:
    """One vehicle of a flavour, "ardupilot" or "px4"."""

    def __init__(self, flavour: str, script: Script | None = None, seed: int = 1) -> None:
        self.px4 = flavour == "px4"
        self.script = script or Script()
        self.steps = 0
        self.mode = PX4_HOLD if self.px4 else STABILIZE
        self.armed = self.script.armed_at_start
        self.position = [3.0, -2.0, -0.5]  # relative to an estimator's origin that is nowhere near home
        self.velocity = [0.0, 0.0, 0.0]
        self.ground = self.position[2]
        self.target: tuple[float, float, float] | None = None
        self.origin = [47.0, 8.0]
        self.failsafe = False
        self.gone = False
        self.booted_s = 0.0
        self.setpoints: list[Any] = []
        self.setpoint_times: list[float] = []
        self.commands: list[Any] = []
        self.heartbeats = 0
        self._random = random.Random(seed)  # noqa: S311 - faults, not secrets
        self._streams: dict[int, float] = {}
        self._last: dict[int, float] = {}
        self._out: list[bytes] = []
        self._mav = mavlink.MAVLink(None, srcSystem=1, srcComponent=1)
        self._foreign = mavlink.MAVLink(None, srcSystem=GROUND_STATION[0], srcComponent=GROUND_STATION[1])
        self._other = mavlink.MAVLink(None, srcSystem=9, srcComponent=1)
        self._ours = mavlink.MAVLink(None)
        self._ours.robust_parsing = True

    # Transport and clock.

    def now_s(self) -> float:
        return self.steps * STEP_S

    def close(self) -> None:
        """Nothing to release."""

    def receive(self, within_s: float) -> list[bytes]:
        until = self.now_s() + within_s
        while True:
            self._step()
            if self._out or self.now_s() >= until:
                break
        taken, self._out = self._out, []
        if self.script.shuffle:
            self._random.shuffle(taken)
        return taken

    def send(self, data: bytes) -> None:
        for message in self._ours.parse_buffer(data) or ():
            if self._random.random() >= self.script.lose and not self.gone:
                self._take(message)

    # What a test can do to it.

    def say(self, text: str, severity: int = 4) -> None:
        data = text.encode()
        if len(data) <= 50:
            self._emit(mavlink.MAVLink_statustext_message(severity, data))
            return
        for number in range(len(data) // 50 + 1):
            piece = data[50 * number : 50 * number + 50]
            self._emit(mavlink.MAVLink_statustext_message(severity, piece, 7, number))

    def slip_in(self, message: Any) -> None:  # noqa: ANN401 - pymavlink ships no types
        """Send one packet that does not fit the others."""
        self._emit(message)

    @property
    def time_boot_ms(self) -> int:
        return round((self.now_s() - self.booted_s) * 1000)

    @property
    def height_m(self) -> float:
        return self.ground - self.position[2]

    # Behaviour.

    def _step(self) -> None:
        self.steps += 1
        for moment, act in list(self.script.at.items()):
            if self.now_s() >= moment:
                del self.script.at[moment]
                act(self)
        self._move()
        self._report()

    def _move(self) -> None:
        if not self.armed:
            self.velocity = [0.0, 0.0, 0.0]
            return
        if self.mode in (AP_LAND, PX4_LAND, RTL, PX4_RTL):
            goal = (self.position[0], self.position[1], self.ground)
            if self.height_m < 0.02:
                self.armed = False
        elif self.target is not None:
            goal = self.target
        else:
            return
        landing = goal[2] == self.ground
        for axis in range(3):
            most = 1.0 if landing else 8.0
            rate = max(-most, min(most, 4.0 * (goal[axis] - self.position[axis])))
            self.velocity[axis] = rate
            self.position[axis] += rate * STEP_S
        if self.mode == PX4_TAKEOFF and abs(goal[2] - self.position[2]) < 0.05:
            self.mode = PX4_HOLD

    def _report(self) -> None:
        if self.gone:
            return
        now, ms = self.now_s(), self.time_boot_ms
        located = now >= self.script.origin_at_s
        if self._due(0, 1.0):
            self._emit(self._heartbeat())
            if self.script.second_station:
                self._emit_foreign()
            if self.script.other_vehicle:
                other = mavlink.MAVLink_heartbeat_message(2, 3, 209, GUIDED, 4, 3)
                self._push(other.pack(self._other))
                far = mavlink.MAVLink_local_position_ned_message(ms + 9000, 500.0, 500.0, -500.0, 9.0, 9.0, 9.0)
                self._push(far.pack(self._other))
        messages = self._messages()
        for number, period in self._streams.items():
            if number in messages and (located or number not in _PLACED) and self._due(number, period):
                self._emit(messages[number]())

    def _messages(self) -> dict[int, Callable[[], Any]]:
        ms, located = self.time_boot_ms, self.now_s() >= self.script.origin_at_s
        flags = 0x33F if located else 0x81
        if self.px4 and self.velocity == [0.0, 0.0, 0.0]:
            flags |= 0x80  # PX4 calls that a constant position, however good it is
        landed = 1 if self.height_m < 0.1 else 2
        flying = {AP_LAND: 4, PX4_LAND: 4, PX4_TAKEOFF: 3}.get(self.mode, 2)
        north, east, _ = self.position
        place = (
            round((self.origin[0] + north / 111_194.93) * 1e7),
            round((self.origin[1] + east / (111_319.49 * math.cos(math.radians(self.origin[0])))) * 1e7),
        )
        above = self.height_m + 0.0
        return {
            32: lambda: mavlink.MAVLink_local_position_ned_message(ms, *self.position, *self.velocity),
            33: lambda: mavlink.MAVLink_global_position_int_message(
                ms, *place, round((self.script.home_alt_m + above) * 1000), round(above * 1000), 0, 0, 0, 0
            ),
            30: lambda: mavlink.MAVLink_attitude_message(ms, 0.0, 0.0, 0.5, 0.0, 0.0, 0.0),
            1: lambda: mavlink.MAVLink_sys_status_message(
                0x10000027, 0x10000027, 0x10000027 if located else 0x7, 0, 12000, 100, 90, 0, 0, 0, 0, 0, 0
            ),
            193: lambda: mavlink.MAVLink_ekf_status_report_message(flags, 0, 0, 0, 0, 0),
            230: lambda: mavlink.MAVLink_estimator_status_message(0, flags, 0, 0, 0, 0, 0, 0, 0, 0),
            245: lambda: mavlink.MAVLink_extended_sys_state_message(0, landed if landed == 1 else flying),
            49: lambda: mavlink.MAVLink_gps_global_origin_message(
                round(self.origin[0] * 1e7), round(self.origin[1] * 1e7), 90_000
            ),
        }

    def _heartbeat(self) -> Any:  # noqa: ANN401 - pymavlink ships no types
        base = (29 if self.px4 else 81) | (128 if self.armed else 0)
        autopilot = self.script.autopilot if self.script.autopilot is not None else (12 if self.px4 else 3)
        status = 5 if self.failsafe else (4 if self.armed else 3)
        return mavlink.MAVLink_heartbeat_message(self.script.vehicle_type, autopilot, base, self.mode, status, 3)

    def _due(self, number: int, period: float) -> bool:
        if self.now_s() - self._last.get(number, -1e9) < period - 1e-9:
            return False
        self._last[number] = self.now_s()
        return True

    def _take(self, message: Any) -> None:  # noqa: ANN401 - the same
        kind = message.get_type()
        if kind == "HEARTBEAT":
            self.heartbeats += 1
        elif kind == "SET_POSITION_TARGET_LOCAL_NED":
            self.setpoints.append(message)
            self.setpoint_times.append(self.now_s())
            if self.armed and self.mode in (GUIDED, PX4_OFFBOARD):
                self.target = (message.x, message.y, message.z)
        elif kind == "COMMAND_LONG" and message.target_system == 1:
            self.commands.append(message)
            self._command(message)

    def _command(self, message: Any) -> None:  # noqa: ANN401 - the same
        number, script = message.command, self.script
        if script.deaf_to[number] > 0:
            script.deaf_to[number] -= 1
            return
        result, words = ACCEPTED, ""
        if number in script.refuses:
            times, result, words = script.refuses[number]
            if times > 0:
                script.refuses[number] = (times - 1, result, words)
                self._answer(message, result)
                self.say(words, 2)
                return
        if script.ignores[number] > 0:
            script.ignores[number] -= 1
        else:
            result = self._obey(message)
        if script.silent_about[number] > 0:
            script.silent_about[number] -= 1
            return
        self._answer(message, result)

    def _obey(self, message: Any) -> int:  # noqa: ANN401 - the same
        number = message.command
        if number == 511:
            known = 193 if not self.px4 else 230
            if int(message.param1) in (193, 230) and int(message.param1) != known:
                return FAILED
            if int(message.param1) not in self.script.on_request_only:
                self._streams[int(message.param1)] = message.param2 / 1e6
        elif number == SET_MODE:
            return self._set_mode(message)
        elif number == ARM:
            self.armed = message.param1 == 1
        elif number == TAKEOFF:
            return self._take_off(message)
        elif number == LAND:
            self.mode = PX4_LAND if self.px4 else AP_LAND
        elif number == 512:
            return self._send_once(int(message.param1))
        else:
            return 3
        return ACCEPTED

    def _send_once(self, number: int) -> int:
        messages = self._messages()
        if number in _PLACED and self.now_s() < self.script.origin_at_s:
            return FAILED
        if number in messages:
            self._emit(messages[number]())
        return ACCEPTED

    def _set_mode(self, message: Any) -> int:  # noqa: ANN401 - the same
        if not self.px4:
            self.mode = int(message.param2)
            self.target = (self.position[0], self.position[1], self.position[2]) if self.armed else None
            return ACCEPTED
        mode = int(message.param2) << 16 | int(message.param3) << 24
        fresh = bool(self.setpoint_times) and self.now_s() - self.setpoint_times[-1] < 1.0
        if mode == PX4_OFFBOARD and not fresh:
            self.say("Switching to Offboard is currently not available", 2)
            return ACCEPTED  # and nothing happens
        self.mode = mode
        return ACCEPTED

    def _take_off(self, message: Any) -> int:  # noqa: ANN401 - the same
        if self.px4:
            self.mode = PX4_TAKEOFF
            height = message.param7 - self.script.home_alt_m
        elif not self.armed or self.mode != GUIDED:
            return FAILED
        else:
            height = message.param7
        self.target = (self.position[0], self.position[1], self.ground - height)
        return ACCEPTED

    # The wire.

    def _answer(self, message: Any, result: int) -> None:  # noqa: ANN401 - the same
        to = (message.get_srcSystem(), message.get_srcComponent())
        self._emit(mavlink.MAVLink_command_ack_message(message.command, result, 0, 0, *to))

    def _emit(self, message: Any) -> None:  # noqa: ANN401 - the same
        frame = message.pack(self._mav)
        self._mav.seq = (self._mav.seq + 1) & 0xFF
        if self._random.random() >= self.script.lose:
            self._push(frame)
        if self._random.random() < self.script.double:
            self._push(frame)

    def _push(self, frame: bytes) -> None:
        self._out.append(bytes(frame))

    def _emit_foreign(self) -> None:
        """A ground station on the same link: its heartbeat, and the answers to its own commands."""
        self._push(mavlink.MAVLink_heartbeat_message(6, 8, 0, 0, 4, 3).pack(self._foreign))
        for command in (ARM, SET_MODE, TAKEOFF, LAND, 511):
            self._push(mavlink.MAVLink_command_ack_message(command, 2, 0, 0, *GROUND_STATION).pack(self._mav))


class DistantVehicle(ScriptedVehicle):
    """The same at the other end of a long way: each packet takes a time."""

    def __init__(self, flavour: str, delay_s: float, script: Script | None = None) -> None:
        super().__init__(flavour, script)
        self._delay_s = delay_s
        self._there: list[tuple[float, bytes]] = []
        self._back: list[tuple[float, bytes]] = []

    def send(self, data: bytes) -> None:
        self._there.append((self.now_s() + self._delay_s, data))

    def receive(self, within_s: float) -> list[bytes]:
        until_s = self.now_s() + within_s
        while True:
            for data in self._arrived(self._there):
                super().send(data)
            self._back += [(self.now_s() + self._delay_s, data) for data in super().receive(0.0)]
            arrived = self._arrived(self._back)
            if arrived or self.now_s() >= until_s:
                return arrived

    def _arrived(self, way: list[tuple[float, bytes]]) -> list[bytes]:
        arrived = [data for due_s, data in way if due_s <= self.now_s()]
        del way[: len(arrived)]
        return arrived
