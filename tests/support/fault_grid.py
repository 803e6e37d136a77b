"""Fault x moment x setting x flavour: one flight for each, in lock-step, and where it leaves the vehicle.

A flight without a fault says when each moment comes; the vehicle's time is the same in both, so a fault comes exactly
then. After the flight the vehicle is left alone, as whoever walks away leaves it, and how it ends decides.
"""

import errno
import io
import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from enum import StrEnum
from functools import cache
from typing import Final

from pymavlink.dialects.v20 import ardupilotmega as mavlink

from mission.errors import MissionError
from mission.fly import FlightOptions, fly
from mission.monitor.stage import Stage
from mission.plan import FlightPlan
from mission.report.reading import Record, parse_record
from mission.report.record import FlightRecord
from tests.support.faults import schedule_of
from tests.support.lockstep import LINK, LockstepVehicle, vehicle_of
from tests.support.small_missions import plan_of
from tests.support.station import Station
from vehicle_sim.autopilot import Mode
from vehicle_sim.faults import NO_FAULTS, Schedule
from vehicle_sim.parameters import Flavour

MISSION: Final = """\
name: Everything once
domain:
  boundary: [[0, 0], [60, 0], [60, 40], [0, 40]]
regions:
  home: {kind: home, polygon: [[4, 4], [14, 4], [14, 14], [4, 14]]}
  goal: {kind: survey, polygon: [[44, 4], [54, 4], [54, 14], [44, 14]], loiter_s: 4}
  field:
    kind: survey
    polygon: [[38, 22], [56, 22], [56, 36], [38, 36]]
    cover: {spacing_m: 6, heading_deg: 90, share: 0.9}
  pond: {kind: restricted, polygon: [[24, 14], [30, 14], [30, 26], [24, 26]]}
mission:
  formula: G F goal & G F field & G !pond
  laps: 1
start:
  position_m: [9, 8]
flight:
  speed_m_s: 5.0
  altitude_m: 12
  final_stay_s: 1
  time_constant_s: 1.0
  disturbance_m_s2: 0.5
limits:
  speed_m_s: 6.0
  acceleration_m_s2: 2.5
  tilt_deg: 25
"""
"""A stay, lanes, a lap and a way back."""

ALONE_S: Final = 150.0
"""How long the vehicle is left to itself after the flight: to return, land and disarm from anywhere."""

HOVERS_S: Final = 20.0
HOVERS_M: Final = 1.5
"""A vehicle that stays so near for so long has been left where it is."""


class Moment(StrEnum):
    """When a fault comes."""

    ON_THE_GROUND = "on the ground"
    CLIMBING = "climbing"
    FLYING = "flying"
    HOLDING = "holding"
    COVERING = "covering"
    RETURNING = "returning"
    LANDING = "landing"


class Outcome(StrEnum):
    """Where a flight leaves the vehicle."""

    COMPLETES = "completes"
    HOLDS = "holds"
    RETURNS = "returns"
    LANDS = "lands"
    STAYS = "stays on the ground"
    FLIES_ON = "flies on"


class Fault(StrEnum):
    """What goes wrong."""

    LINK_CUT = "link cut"
    LINK_CUT_BRIEFLY = "link cut for 2 s"
    LINK_LOSES = "link that loses 30 %"
    GPS_LOST = "gps lost"
    GPS_LOST_BRIEFLY = "gps lost for 2 s"
    ESTIMATOR = "estimator misled"
    MOTOR = "weak motor"
    BATTERY = "battery flat"
    FENCE = "fence breached"
    PILOT = "pilot takes over"
    GROUND_STATION = "ground station commands a return"
    KILLED = "planner killed"
    DISK = "disk full"
    CLOCK = "clock jumps"
    REBOOT = "autopilot rebooted"


class Setting(StrEnum):
    """How the flight is conducted."""

    USUAL = "as it comes"
    LANDS = "lands when it is given up"
    WIND = "in 5 m/s of wind"


SCHEDULED: Final[Mapping[Fault, str]] = {
    Fault.LINK_CUT: "link, drop: 1",
    Fault.LINK_CUT_BRIEFLY: "link, drop: 1, for_s: 2",
    Fault.LINK_LOSES: "link, drop: 0.3",
    Fault.GPS_LOST: "gps_loss",
    Fault.GPS_LOST_BRIEFLY: "gps_loss, for_s: 2",
    Fault.ESTIMATOR: "gps_jump, north_m: 20",
    Fault.MOTOR: "motor, ramp_s: 1, rotor: 3, efficiency: 0.8",
    Fault.BATTERY: "battery, voltage_v: 9.6",
}
"""Faults that the vehicle has of its own."""


class KilledError(BaseException):
    """The program is no longer there."""


class FullDisk(io.BytesIO):
    """A file that takes no more from a moment on; once its writer is dead, nothing is written either."""

    full = dead = False

    def write(self, data: bytes, /) -> int:  # type: ignore[override]
        if self.dead:
            raise KilledError
        if self.full:
            raise OSError(errno.ENOSPC, "No space left on device")
        return super().write(data)


@dataclass
class Bench(LockstepVehicle):
    """The vehicle, with what befalls it and this computer at one time of its clock."""

    fault: Fault | None
    at_s: float
    flavour: Flavour
    schedule: Schedule
    wind: bool
    sink: FullDisk = field(default_factory=FullDisk)

    def __post_init__(self) -> None:
        wind_m_s = 5.0 if self.wind else 0.0
        config = vehicle_of(self.flavour.value, wind_m_s=wind_m_s, wind_from_deg=230.0)
        super().__init__(replace(config, faults=self.schedule), at_step=lambda _vehicle: self.look())
        if self.flavour is Flavour.ARDUPILOT:  # as it comes it minds no voltage
            for name, value in (("BATT_CRT_VOLT", 10.5), ("BATT_FS_CRT_ACT", 1.0), ("BATT_LOW_TIMER", 2.0)):
                self.vehicle.parameters.set(name, value)
        self.station = Station(self.endpoint)
        self.happened = self.dead = self.flew = self.hovers = False
        self.modes: list[Mode] = []
        self.ahead_s = 0.0
        self.sticks_s = math.inf

    def now_s(self) -> float:
        return self.vehicle.time_s + self.ahead_s

    def look(self) -> None:
        self.station.collect()
        self.station.heard.clear()
        if self.sticks_s <= self.vehicle.time_s:
            self.move_sticks()
        self.flew |= self.vehicle.autopilot.flying
        mode = self.vehicle.autopilot.mode
        if not self.modes or self.modes[-1] is not mode:
            self.modes.append(mode)
        if not self.happened and self.vehicle.time_s >= self.at_s:
            self.happened = True
            if self.fault in SUDDEN:
                SUDDEN[self.fault](self)

    def send(self, data: bytes) -> None:
        if self.dead:
            raise KilledError
        super().send(data)

    def receive(self, within_s: float) -> list[bytes]:
        if self.dead:
            raise KilledError
        heard = super().receive(within_s)
        if self.dead:
            raise KilledError
        return heard

    def move_sticks(self) -> None:
        """Hold the sticks in the middle from now on, as often as PX4 wants to hear of them."""
        self.station.send(mavlink.MAVLink_manual_control_message(self.endpoint.system_id, 0, 0, 500, 0, 0))
        self.sticks_s = self.vehicle.time_s + 0.2

    def leave_alone(self) -> None:
        """Let the vehicle go on without anybody, until it is disarmed."""
        vehicle = self.vehicle
        until_s = vehicle.time_s + ALONE_S
        place_m, moved_s = vehicle.truth.position_ned_m, vehicle.time_s
        while vehicle.time_s < until_s and vehicle.time_s < moved_s + HOVERS_S and vehicle.autopilot.armed:
            self.endpoint.advance()
            self.endpoint.outgoing(LINK)
            self.look()
            if math.dist(place_m, vehicle.truth.position_ned_m) > HOVERS_M:
                place_m, moved_s = vehicle.truth.position_ned_m, vehicle.time_s
        self.hovers = vehicle.time_s >= moved_s + HOVERS_S and not vehicle.truth.on_ground


def _take_over(bench: Bench) -> None:
    bench.move_sticks()
    bench.station.set_mode(Mode.POSITION)


def _break_fence(bench: Bench) -> None:
    store = bench.vehicle.parameters
    if bench.flavour is Flavour.PX4:
        store.set("GF_MAX_VER_DIST", 10.0)
        return
    for name, value in (("FENCE_ALT_MAX", 10.0), ("FENCE_TYPE", 1.0), ("FENCE_ENABLE", 1.0)):
        store.set(name, value)


def _kill(bench: Bench) -> None:
    bench.dead = bench.sink.dead = True


def _fill_disk(bench: Bench) -> None:
    bench.sink.full = True


def _jump(bench: Bench) -> None:
    bench.ahead_s += 3600.0


def _reboot(bench: Bench) -> None:
    before_s = bench.vehicle.time_s
    bench.endpoint.reboot_in(0)
    bench.endpoint.advance()
    bench.ahead_s += before_s - bench.vehicle.time_s


SUDDEN: Final[Mapping[Fault | None, Callable[[Bench], object]]] = {
    Fault.FENCE: _break_fence,
    Fault.PILOT: _take_over,
    Fault.GROUND_STATION: lambda bench: bench.station.set_mode(Mode.RETURN),
    Fault.KILLED: _kill,
    Fault.DISK: _fill_disk,
    Fault.CLOCK: _jump,
    Fault.REBOOT: _reboot,
}


@dataclass(frozen=True)
class Cell:
    """One flight of the grid."""

    fault: Fault
    moment: Moment
    setting: Setting
    flavour: Flavour


@dataclass(frozen=True)
class Ended:
    """How one flight ended.

    Attributes:
        outcome: Where it left the vehicle.
        armed: Whether the vehicle is still armed.
        words: What the program said last, empty where it could not.
        record: What was written down.
    """

    outcome: Outcome
    armed: bool
    words: str
    record: Record


@cache
def plan() -> FlightPlan:
    return plan_of(MISSION)


def options_of(setting: Setting) -> FlightOptions:
    return FlightOptions(land_when_stopped=setting is Setting.LANDS)


@cache
def moments(flavour: Flavour, *, wind: bool) -> Mapping[Moment, float]:
    """When each moment comes in a flight without a fault: vehicle time."""
    bench = Bench(None, math.inf, flavour, NO_FAULTS, wind=wind)
    result = fly(plan(), bench, bench, FlightRecord(bench.sink, mission="grid"))
    assert result.achieved, result.reason
    stages = {
        entry.values["stage"]: entry.t_s
        for entry in parse_record(bench.sink.getvalue()).events
        if entry.text == "stage"
    }
    flown, trajectory = plan(), plan().trajectory
    (held_from, _), lanes_s = flown.stops[0], flown.covers[0].lanes_s
    began_s = stages[Stage.FLY]
    return {
        Moment.ON_THE_GROUND: stages[Stage.ARM],
        Moment.CLIMBING: stages[Stage.CLIMB] + 3.5,  # which lifts a PX4 off after 2.9 s
        Moment.FLYING: began_s + 3.0,
        Moment.HOLDING: began_s + float(trajectory.time_at(held_from)[0]) + 2.0,
        Moment.COVERING: began_s + float(trajectory.time_at(lanes_s.mean())[0]),
        Moment.RETURNING: began_s + trajectory.laps_end_s + 2.0,
        Moment.LANDING: stages[Stage.TOUCH_DOWN] + 1.0,
    }


def ended(cell: Cell) -> Ended:
    """Fly one cell, and leave the vehicle alone after that."""
    wind = cell.setting is Setting.WIND
    at_s = moments(cell.flavour, wind=wind)[cell.moment]
    text = SCHEDULED.get(cell.fault)
    schedule = NO_FAULTS if text is None else schedule_of(f"{text}, since: boot, at_s: {at_s}")
    bench = Bench(cell.fault, at_s, cell.flavour, schedule, wind=wind)
    achieved, words = False, ""
    try:
        result = fly(plan(), bench, bench, FlightRecord(bench.sink, mission="grid"), options=options_of(cell.setting))
        achieved, words = result.achieved, result.reason
    except MissionError as error:
        words = str(error)
    except KilledError:
        pass
    bench.leave_alone()
    return Ended(_outcome(bench, achieved=achieved), bench.vehicle.autopilot.armed, words, _read(bench))


def _read(bench: Bench) -> Record:
    return parse_record(bench.sink.getvalue())


def _outcome(bench: Bench, *, achieved: bool) -> Outcome:
    vehicle = bench.vehicle
    if achieved:
        return Outcome.COMPLETES
    if not bench.flew:
        return Outcome.STAYS
    if vehicle.autopilot.armed:
        return Outcome.HOLDS if bench.hovers else Outcome.FLIES_ON
    return Outcome.RETURNS if Mode.RETURN in bench.modes else Outcome.LANDS
