"""Calibrations, as ground stations watch them: they go through their texts and end well, whatever the sensors are.

Nothing is wrong with these sensors, and nothing is changed: an invisible hand turns the vehicle where that is asked.
The texts stand in `data/calibrations.json`, with the parameter and its value that ask for each, and the answer. After
PX4 `Commander.cpp`, `calibration_messages.h`; ArduPilot `GCS_Common.cpp`, `AP_AccelCal.cpp`, `AP_Compass`.
"""

from collections import deque
from typing import TYPE_CHECKING, Final

from vehicle_sim.autopilot import Outcome, Severity
from vehicle_sim.parameters import Flavour
from vehicle_sim.protocol.data_files import data_file
from vehicle_sim.protocol.dialect import Message, mavlink
from vehicle_sim.protocol.streams import NEVER_US

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    from vehicle_sim.protocol.commands import Request
    from vehicle_sim.protocol.host import Host, Sender

_SECOND_US: Final = 1_000_000
_TEXT_US: Final = 250_000
_ASKED_FOR_S: Final = 60
_FULL_ACCELEROMETERS: Final = 1
_ONE_COMPASS: Final = 1
_SUCCESS: Final = mavlink.ACCELCAL_VEHICLE_POS_SUCCESS


class CalibrationService:
    """Runs one calibration at a time.

    Attributes:
        next_due_us: Nothing happens by itself before.
    """

    def __init__(self, host: "Host") -> None:
        self._host = host
        self._is_px4 = host.table.flavour is Flavour.PX4
        self._rows = data_file("calibrations")[host.table.flavour.value]
        self._sides = data_file("calibrations")["sides"]
        self._side = 0
        self._script: deque[tuple[int, str | Message]] = deque()
        self._compass_done_us = NEVER_US
        self.next_due_us = NEVER_US
        own: Mapping[int, Callable[[Request], Outcome]] = {
            mavlink.MAV_CMD_ACCELCAL_VEHICLE_POS: lambda request: self._next_side(int(request.params[0])),
            mavlink.MAV_CMD_DO_START_MAG_CAL: self._start_compass,
            mavlink.MAV_CMD_DO_ACCEPT_MAG_CAL: self._accept_compass,
            mavlink.MAV_CMD_DO_CANCEL_MAG_CAL: self._cancel_compass,
        }
        self.commands = {mavlink.MAV_CMD_PREFLIGHT_CALIBRATION: self._calibrate, **({} if self._is_px4 else own)}
        self.messages: Mapping[int, Callable[[Sender, Message], None]] = (
            {} if self._is_px4 else {mavlink.MAVLINK_MSG_ID_COMMAND_ACK: self.on_ack}
        )

    def advance(self) -> None:
        """Say and send what is due."""
        while self._script and self._script[0][0] <= self._host.now_us:
            _due_us, said = self._script.popleft()
            if isinstance(said, str):
                self._host.say(Severity.INFO, said)
            else:
                self._host.broadcast(said)
        self.next_due_us = self._script[0][0] if self._script else NEVER_US

    def _play(self, script: "list[tuple[int, str | Message]]") -> None:
        self._script = deque((self._host.now_us + after_us, said) for after_us, said in script)
        self.next_due_us = self._host.now_us

    def _calibrate(self, request: "Request") -> Outcome:
        """Begin what the first parameter that is known asks for; without any, PX4 ends what is under way."""
        params, armed = request.params, self._host.vehicle.autopilot.armed
        if armed and not self._is_px4:
            self._host.say(Severity.WARNING, "Disarm to allow calibration")
            return Outcome.FAILED
        if self._is_px4 and not any(params):
            self._play([(0, "[cal] calibration cancelled")] if self._script else [])
            return Outcome.ACCEPTED
        if armed or (self._is_px4 and self._script):
            return Outcome.TEMPORARILY_REJECTED
        if not self._is_px4 and params[4] == _FULL_ACCELEROMETERS:
            self._side = 0
            return self._next_side(0)
        for place, value, answer, texts in self._rows:
            if params[place] == value:
                self._play([(number * _TEXT_US, text) for number, text in enumerate(texts)])
                return Outcome(answer)
        return Outcome.UNSUPPORTED

    # ArduPilot's accelerometers: the vehicle asks for side after side, and is told when it lies there.

    def on_ack(self, _sender: "Sender", _message: Message) -> None:
        """Take the acknowledgement of older ground stations for the key that is to be pressed."""
        if self._side:
            self._next_side(self._side)

    def _next_side(self, side: int) -> Outcome:
        if side != self._side:
            return Outcome.FAILED
        self._side = (self._side + 1) % (len(self._sides) + 1)
        position = self._side or _SUCCESS
        words = (
            f"Place vehicle {self._sides[self._side - 1]} and press any key."
            if self._side
            else "Calibration successful"
        )
        ask = mavlink.MAVLink_command_long_message(0, 0, mavlink.MAV_CMD_ACCELCAL_VEHICLE_POS, 0, position, *(0.0,) * 6)
        self._play([(0, words), *((second * _SECOND_US, ask) for second in range(_ASKED_FOR_S if self._side else 1))])
        return Outcome.ACCEPTED

    # ArduPilot's compass.

    def _start_compass(self, request: "Request") -> Outcome:
        if self._host.vehicle.autopilot.armed:
            self._host.say(Severity.NOTICE, "Disarm to allow compass calibration")
            return Outcome.FAILED
        saves = int(request.params[2] == 1.0)
        running, mask = mavlink.MAG_CAL_RUNNING_STEP_TWO, (255,) * 10
        script: list[tuple[int, str | Message]] = [
            (
                tenth * _SECOND_US,
                mavlink.MAVLink_mag_cal_progress_message(0, _ONE_COMPASS, running, 1, 10 * tenth, mask, 0.0, 0.0, 0.0),
            )
            for tenth in range(11)
        ]
        self._compass_done_us = self._host.now_us + script[-1][0]
        numbers = (5.0, 0.0, 0.0, 0.0, 1.0, 1.0, 1.0, 0.0, 0.0, 0.0)
        report = mavlink.MAVLink_mag_cal_report_message(0, _ONE_COMPASS, mavlink.MAG_CAL_SUCCESS, saves, *numbers)
        self._play([*script, *((script[-1][0] + second * _SECOND_US, report) for second in range(1 if saves else 20))])
        return Outcome.ACCEPTED

    def _accept_compass(self, _request: "Request") -> Outcome:
        if self._host.now_us < self._compass_done_us:
            return Outcome.FAILED
        return self._cancel_compass(_request)

    def _cancel_compass(self, _request: "Request") -> Outcome:
        self._compass_done_us = NEVER_US
        self._play([])
        return Outcome.ACCEPTED
