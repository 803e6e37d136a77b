"""Missions as a ground station writes them, and a station that flies them in lock-step."""

from dataclasses import dataclass, field
from math import nan

from pymavlink.dialects.v20 import ardupilotmega as mavlink

from tests.support.station import Station, endpoint_of
from vehicle_sim.geodesy import geodetic_at
from vehicle_sim.parameters import Flavour
from vehicle_sim.protocol.dialect import Message

RELATIVE, MISSION_FRAME = mavlink.MAV_FRAME_GLOBAL_RELATIVE_ALT_INT, mavlink.MAV_FRAME_MISSION
TAKEOFF, WAYPOINT = mavlink.MAV_CMD_NAV_TAKEOFF, mavlink.MAV_CMD_NAV_WAYPOINT
LAND, RETURN = mavlink.MAV_CMD_NAV_LAND, mavlink.MAV_CMD_NAV_RETURN_TO_LAUNCH
UNLIMITED, TIME, TURNS = (
    mavlink.MAV_CMD_NAV_LOITER_UNLIM,
    mavlink.MAV_CMD_NAV_LOITER_TIME,
    mavlink.MAV_CMD_NAV_LOITER_TURNS,
)
DELAY, SPEED, JUMP = mavlink.MAV_CMD_NAV_DELAY, mavlink.MAV_CMD_DO_CHANGE_SPEED, mavlink.MAV_CMD_DO_JUMP
WAIT, YAW = mavlink.MAV_CMD_CONDITION_DELAY, mavlink.MAV_CMD_CONDITION_YAW


@dataclass(frozen=True)
class Step:
    """One item before it has a number: metres north and east of home (None: no place), height above home."""

    command: int
    params: tuple[float, float, float, float] = (0.0, 0.0, 0.0, 0.0)
    at: tuple[float, float] | None = None
    up: float = 10.0
    autocontinue: int = 1


def waypoint(north: float, east: float, up: float = 10.0, *, hold_s: float = 0.0) -> Step:
    return Step(WAYPOINT, (hold_s, 0.0, 0.0, nan), (north, east), up)


def takeoff(up: float = 10.0) -> Step:
    return Step(TAKEOFF, (0.0, 0.0, 0.0, nan), (0.0, 0.0), up)


def land(north: float, east: float) -> Step:
    return Step(LAND, (0.0, 0.0, 0.0, nan), (north, east), 0.0)


@dataclass
class Pilot:
    """A ground station with a vehicle that knows where it is; `first` is the number of the first item that is flown."""

    flavour: Flavour
    station: Station = field(init=False)

    def __post_init__(self) -> None:
        self.station = Station(endpoint_of(self.flavour))
        self.station.wait_for_position()
        self.autopilot = self.station.endpoint.vehicle.autopilot
        self.first = 1 if self.flavour is Flavour.ARDUPILOT else 0

    def items(self, steps: list[Step], *, marked: int | None = None) -> list[Message]:
        """Return the messages; ArduPilot's begin with the item that stands for home."""
        home = self.autopilot.home
        assert home is not None
        steps = [Step(WAYPOINT, at=(0.0, 0.0), up=0.0)] * self.first + steps
        messages = []
        for seq, step in enumerate(steps):
            x = y = 0
            if step.at is not None:
                place = geodetic_at(home, (*step.at, 0.0))
                x, y = round(place.lat_deg * 1e7), round(place.lon_deg * 1e7)
            frame = MISSION_FRAME if step.at is None else RELATIVE
            up = 0.0 if step.at is None else step.up
            messages.append(
                mavlink.MAVLink_mission_item_int_message(
                    1, 1, seq, frame, step.command, int(seq == marked), step.autocontinue, *step.params, x, y, up, 0
                )
            )
        return messages

    def upload(self, steps: list[Step], *, marked: int | None = None) -> int:
        """Upload a mission and return the result of the whole."""
        messages = self.items(steps, marked=marked)
        self.station.send(mavlink.MAVLink_mission_count_message(1, 1, len(messages), 0))
        for message in messages:
            self.station.send(message)
        return int(self.station.last("MISSION_ACK").type)

    def start(self) -> None:
        """Fly the mission from the ground, as each flavour wants it."""
        if self.flavour is Flavour.ARDUPILOT:
            assert self.station.command(mavlink.MAV_CMD_COMPONENT_ARM_DISARM, 1) == mavlink.MAV_RESULT_ACCEPTED
        assert self.station.command(mavlink.MAV_CMD_MISSION_START) == mavlink.MAV_RESULT_ACCEPTED

    def fly(self, steps: list[Step]) -> None:
        """Upload and start."""
        assert self.upload(steps) == mavlink.MAV_MISSION_ACCEPTED
        self.start()

    def said(self) -> list[str]:
        """Return the texts heard so far; those of requests come with the next step."""
        self.station.run(0.01)
        return self.station.texts()

    def reached(self) -> list[int]:
        """Return the items reached, in steps: the first that is flown is 0."""
        return [message.seq - self.first for message in self.station.of("MISSION_ITEM_REACHED")]

    def until_reached(self, step: int, *, within_s: float = 90.0) -> None:
        self.station.wait_until(lambda: step in self.reached(), within_s=within_s)

    def place(self) -> tuple[float, float, float]:
        """Return where the vehicle truly is: north, east, up of home."""
        north, east, down = self.station.endpoint.vehicle.truth.position_ned_m
        return north, east, -down

    def speed(self) -> float:
        north, east, _ = self.station.endpoint.vehicle.truth.velocity_ned_m_s
        return float((north**2 + east**2) ** 0.5)
