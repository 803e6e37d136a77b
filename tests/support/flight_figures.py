"""How a vehicle flies, in figures: the flights that were flown on ArduCopter and PX4 in their own simulators, here in
lock-step over MAVLink. All is measured by what the vehicle tells of its place and attitude, 50 times a second.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from math import inf, nan, pi, sqrt
from typing import Final

import numpy as np
from pymavlink.dialects.v20 import ardupilotmega as mavlink

from tests.support.station import Station
from vehicle_sim.autopilot import LandedState, Mode
from vehicle_sim.dynamics.airframe import Dynamics
from vehicle_sim.parameters import Flavour
from vehicle_sim.protocol.endpoint import Endpoint
from vehicle_sim.vehicle import AS_THEY_COME, Vehicle

HEIGHT_M: Final = 10.0
_HZ: Final = 50.0
_SEED: Final = 2
_SPEED, _PLACE_AND_SPEED, _ALL = 0xDC7, 0xDC0, 0xC00
_CIRCLE_M, _CIRCLE_M_S = 6.0, 2.1
_STOPPED_M_S: Final = 0.2
_THERE_M: Final = 0.5
_LEFT_AT_10_M: Final = sqrt(10.0 / 60.0)
"""What ArduPilot's simulator leaves of a wind below SIM_WIND_T_ALT."""

_SLOPE_S: Final = 1.0
_DEGREE_M: Final = 111_319.5

Figures = Mapping[str, float]
Triple = tuple[object, object, object]


@dataclass(frozen=True)
class Told:
    """What the vehicle told: times (n,), local NED place and velocity (n, 3), roll, pitch and yaw (n, 3); SI."""

    t_s: np.ndarray
    place_m: np.ndarray
    velocity_m_s: np.ndarray
    attitude_rad: np.ndarray

    @property
    def level_m_s(self) -> np.ndarray:
        """Level speed (n,)."""
        speed: np.ndarray = np.hypot(self.velocity_m_s[:, 0], self.velocity_m_s[:, 1])
        return speed

    @property
    def lean_deg(self) -> np.ndarray:
        """How far it leans (n,)."""
        roll, pitch, _ = self.attitude_rad.T
        lean: np.ndarray = np.degrees(np.arccos(np.cos(roll) * np.cos(pitch)))
        return lean

    def since(self, t_s: float) -> "Told":
        """What it told from then on."""
        return Told(*(column[self.t_s >= t_s] for column in vars(self).values()))

    def first_s(self, holds: np.ndarray) -> float:
        """When something held for the first time; NaN if never."""
        return float(self.t_s[np.argmax(holds)]) if holds.any() else nan


class Flight:
    """One vehicle and the one who flies it; waits are vehicle time."""

    def __init__(self, flavour: Flavour, dynamics: Dynamics = Dynamics.HOVER, **parameters: float) -> None:
        """Wait until it may be armed, and for five seconds more."""
        self.flavour = flavour
        self.station = Station(
            Endpoint(Vehicle(replace(AS_THEY_COME[flavour], dynamics=dynamics, seed=_SEED)), flavour)
        )
        for message in (mavlink.MAVLINK_MSG_ID_LOCAL_POSITION_NED, mavlink.MAVLINK_MSG_ID_ATTITUDE):
            self.station.command(mavlink.MAV_CMD_SET_MESSAGE_INTERVAL, message, 1e6 / _HZ)
        for name, value in parameters.items():
            self.station.set_parameter(name, value)
        self.station.wait_for_position()
        self.station.run(5.0)
        self.ground_m = float(self.told().place_m[-1, 2])

    @property
    def now_s(self) -> float:
        """Vehicle time."""
        return self.station.endpoint.vehicle.time_s

    def told(self) -> Told:
        """All that it has told."""
        places, attitudes = self.station.of("LOCAL_POSITION_NED"), self.station.of("ATTITUDE")
        count = min(len(places), len(attitudes))
        return Told(
            np.array([m.time_boot_ms for m in places[:count]]) / 1000.0,
            np.array([(m.x, m.y, m.z) for m in places[:count]]),
            np.array([(m.vx, m.vy, m.vz) for m in places[:count]]),
            np.array([(m.roll, m.pitch, m.yaw) for m in attitudes[-count:]]),
        )

    def height_m(self, told: Told) -> np.ndarray:
        """Height above where it stood (n,)."""
        return self.ground_m - told.place_m[:, 2]

    def take_off(self, height_m: float = HEIGHT_M, seconds: float = 30.0) -> float:
        """Arm and take off; return when that was acknowledged."""
        station, home = self.station, self.station.endpoint.vehicle.autopilot.home
        assert home is not None
        assert station.command(mavlink.MAV_CMD_COMPONENT_ARM_DISARM, 1) == mavlink.MAV_RESULT_ACCEPTED
        up_m = height_m + (home.alt_m if station.endpoint.table.takeoff_is_amsl else 0.0)
        assert station.command(mavlink.MAV_CMD_NAV_TAKEOFF, 0, 0, 0, nan, nan, nan, up_m) == 0
        began_s = self.now_s
        station.run(seconds)
        return began_s

    def go(self, north_m: float = 0.0, up_m: float = 0.0, *, yaw_deg: float = nan) -> float:
        """Fly to a place, counted from where it is; return when that was asked for."""
        here = self.station.endpoint.telemetry(mavlink.MAVLINK_MSG_ID_GLOBAL_POSITION_INT)
        assert here is not None
        place = (here.lat + round(north_m / _DEGREE_M * 1e7), here.lon, here.alt / 1000.0 + up_m)
        turn = np.radians(yaw_deg)
        assert self.station.command_int(mavlink.MAV_CMD_DO_REPOSITION, 0, (-1.0, 1.0, 0.0, turn), place) == 0
        return self.now_s

    def stream(self, seconds: float, setpoint: Callable[[float], tuple[object, ...]], mask: int) -> float:
        """Send setpoints at 20 Hz, and see to it that they are flown; return when that began."""
        began_s = self.now_s
        for step in range(round(20.0 * seconds)):
            self.station.setpoint(*setpoint(step / 20.0), mask=mask)  # type: ignore[arg-type]
            if step == 10 and self.flavour is Flavour.PX4:
                self.station.set_mode(Mode.GUIDED)
            self.station.run(0.05)
        return began_s

    def at_speed(self, m_s: float = 5.0) -> None:
        """Come to a steady speed northwards."""
        self.stream(15.0, lambda _t: ((0, 0, 0), (m_s, 0, 0)), _SPEED)


def _slopes(told: Told) -> np.ndarray:
    """Return the change of level speed over a second (n,)."""
    n = round(_SLOPE_S * _HZ)
    slopes: np.ndarray = (told.level_m_s[n:] - told.level_m_s[:-n]) / _SLOPE_S
    return slopes


def taking_off(flavour: Flavour, dynamics: Dynamics) -> Figures:
    """Take off to 10 m."""
    flight = Flight(flavour, dynamics)
    began_s = flight.take_off()
    told = flight.told().since(began_s)
    height = flight.height_m(told)
    return {
        "local z at rest, m": flight.ground_m,
        "take-off to 10 m: to 0.3 m, s": told.first_s(height > 0.3) - began_s,
        "take-off to 10 m: to 9.5 m, s": told.first_s(height > 9.5) - began_s,
        "greatest climb, m/s": float(-told.velocity_m_s[:, 2].min()),
        "settled height, m": float(height[-250:].mean()),
        "overshoot, m": float(height.max() - height[-250:].mean()),
    }


def hovering(flavour: Flavour, dynamics: Dynamics) -> Figures:
    """Hover for 20 s, in calm air and in wind."""
    figures = {}
    winds = {"calm": {}, "8 m/s of wind": {"SIM_WIND_SPD": 8.0 * _LEFT_AT_10_M, "SIM_WIND_TURB": 1.5 * _LEFT_AT_10_M}}
    for name, wind in winds.items():
        flight = Flight(flavour, dynamics, **wind)
        flight.take_off(seconds=40.0)
        began_s = flight.now_s
        flight.station.run(20.0)
        told = flight.told().since(began_s)
        off = told.place_m - told.place_m.mean(axis=0)
        for axis, rms in zip(("north", "east", "down"), np.sqrt((off**2).mean(axis=0)), strict=True):
            figures[f"hover, {name}: rms {axis}, m"] = float(rms)
        if wind:
            figures[f"hover, {name}: farthest, m"] = float(np.hypot(off[:, 0], off[:, 1]).max())
            figures[f"hover, {name}: lean, deg"] = float(told.lean_deg.mean())
    return figures


def going(flavour: Flavour, dynamics: Dynamics) -> Figures:
    """Go 80 m, up and down 20 m, and turn."""
    flight = Flight(flavour, dynamics)
    flight.take_off()
    began_s = flight.go(north_m=80.0)
    flight.station.run(40.0)
    told = flight.told().since(began_s)
    gone = told.place_m[:, 0] - told.place_m[0, 0]
    figures = {
        "go 80 m: time, s": told.first_s(gone > 80.0 - _THERE_M) - began_s,
        "go 80 m: top speed, m/s": float(told.level_m_s.max()),
        "go 80 m: acceleration, m/s^2": float(_slopes(told).max()),
        "go 80 m: braking, m/s^2": float(-_slopes(told).min()),
        "go 80 m: overshoot, m": float(gone.max() - gone[-250:].mean()),
    }
    for name, up_m in (("up", 20.0), ("down", -20.0)):
        began_s = flight.go(up_m=up_m)
        flight.station.run(30.0)
        told = flight.told().since(began_s)
        risen = np.abs(told.place_m[:, 2] - told.place_m[0, 2])
        figures[f"{name} 20 m: time, s"] = told.first_s(risen > 20.0 - _THERE_M) - began_s
        figures[f"{name} 20 m: speed, m/s"] = float(np.abs(told.velocity_m_s[:, 2]).max())
    began_s = flight.go(yaw_deg=120.0)
    flight.station.run(15.0)
    yaw = np.unwrap(flight.told().since(began_s).attitude_rad[:, 2])
    figures["yaw: greatest rate, deg/s"] = float(np.degrees(np.abs(yaw[10:] - yaw[:-10]).max() * _HZ / 10.0))
    return figures


def stopping(flavour: Flavour, dynamics: Dynamics) -> Figures:
    """Fly 5 m/s by velocity setpoints, and stop in each way."""
    ways = {"BRAKE or Hold": Mode.BRAKE if flavour is Flavour.ARDUPILOT else Mode.HOLD}
    if flavour is Flavour.ARDUPILOT:
        ways["LOITER"] = Mode.POSITION
    figures = {}
    for name, mode in ways.items():
        flight = Flight(flavour, dynamics)
        flight.take_off()
        flight.at_speed()
        told = flight.told().since(flight.now_s - 3.0)
        figures["5 m/s by setpoints: reached, m/s"] = float(told.level_m_s.mean())
        figures["5 m/s by setpoints: lean, deg"] = float(told.lean_deg.mean())
        began_s = flight.now_s
        assert flight.station.set_mode(mode) == 0
        flight.station.run(15.0)
        told = flight.told().since(began_s)
        slow = np.lib.stride_tricks.sliding_window_view(told.level_m_s, round(_HZ)).max(axis=1) < _STOPPED_M_S
        stopped_s = told.first_s(slow)
        figures[f"{name} from 5 m/s: stop after, s"] = stopped_s - began_s
        figures[f"{name} from 5 m/s: way, m"] = float((told.place_m[:, 0] - told.place_m[0, 0]).max())
    return figures


def returning(flavour: Flavour, dynamics: Dynamics) -> Figures:
    """Return from 43 m away and 8 m high, and land."""
    flight = Flight(flavour, dynamics)
    flight.take_off(8.0, 20.0)
    flight.go(north_m=43.0)
    flight.station.run(25.0)
    began_s = flight.now_s
    assert flight.station.set_mode(Mode.RETURN) == 0
    autopilot = flight.station.endpoint.vehicle.autopilot
    flight.station.wait_until(
        lambda: autopilot.landed_state is LandedState.LANDING and flight.station.height_m() < 0.5, within_s=200.0
    )
    low_s = flight.now_s
    flight.station.wait_until(lambda: not autopilot.armed, within_s=30.0)
    disarmed_s = flight.now_s
    flight.station.run(3.0)
    told = flight.told().since(began_s)
    height = flight.height_m(told)
    figures = {"return: top, m": float(height.max())}
    down = told.since(float(told.t_s[height.argmax()]))
    height = flight.height_m(down)
    for height_m in (14.0, 11.0, 8.0, 4.0, 2.0, 0.5):
        reached = (height < height_m) & (down.velocity_m_s[:, 2] > 0.1)
        at = int(np.argmax(reached))
        figures[f"return: way down at {height_m:g} m, m/s"] = float(down.velocity_m_s[at, 2]) if at else nan
    figures["from 0.5 m to disarmed, s"] = disarmed_s - low_s
    figures["mode afterwards"] = float(flight.station.last("HEARTBEAT").custom_mode)
    return figures


def falling(flavour: Flavour, dynamics: Dynamics) -> Figures:
    """Disarm by force at 10 m."""
    flight = Flight(flavour, dynamics)
    flight.take_off()
    assert flight.station.command(mavlink.MAV_CMD_COMPONENT_ARM_DISARM, 0, 21196) == 0
    began_s = flight.now_s
    flight.station.run(3.0)
    fast = max(
        (v.vz for v in flight.station.of("LOCAL_POSITION_NED") if v.time_boot_ms / 1000.0 > began_s), default=inf
    )
    return {"forced disarm at 10 m: falls with, m/s": float(fast)}


def circling(flavour: Flavour, dynamics: Dynamics) -> Figures:
    """Fly a circle of 6 m at 2.1 m/s by setpoints."""
    figures = {}
    turn = _CIRCLE_M_S / _CIRCLE_M
    for name, mask in (("position and velocity", _PLACE_AND_SPEED), ("with acceleration", _ALL)):
        flight = Flight(flavour, dynamics)
        flight.take_off()
        north, east, down = (float(x) for x in flight.told().place_m[-1])

        def at(
            t_s: float | np.ndarray, north: float = north, east: float = east, down: float = down
        ) -> tuple[Triple, Triple, Triple]:
            c, s, pull = np.cos(turn * t_s), np.sin(turn * t_s), _CIRCLE_M_S * turn
            return (
                (north - _CIRCLE_M + _CIRCLE_M * c, east + _CIRCLE_M * s, down),
                (-_CIRCLE_M_S * s, _CIRCLE_M_S * c, 0.0),
                (-pull * c, -pull * s, 0.0),
            )

        round_s = 2.0 * pi / turn
        began_s = flight.stream(2.25 * round_s, at, mask)
        told = flight.told().since(began_s + 0.25 * round_s)
        wanted = np.array(at(told.t_s - began_s)[0][:2]).T
        figures[f"6 m circle, {name}: rms, m"] = sqrt(float(((told.place_m[:, :2] - wanted) ** 2).sum(axis=1).mean()))
    return figures


FLIGHTS: Final = (taking_off, hovering, going, stopping, returning, falling, circling)
"""The flights, each of which gives some of the figures."""

Recorded = Mapping[str, float | tuple[float, float]]

RECORDED: Final[Mapping[Flavour, Recorded]] = {
    Flavour.ARDUPILOT: {
        "local z at rest, m": 0.01,
        "take-off to 10 m: to 0.3 m, s": 4.1,
        "take-off to 10 m: to 9.5 m, s": 9.4,
        "greatest climb, m/s": 2.5,
        "settled height, m": 10.0,
        "hover, calm: rms north, m": 0.008,
        "hover, calm: rms east, m": 0.009,
        "hover, calm: rms down, m": 0.001,
        "hover, 8 m/s of wind: rms north, m": 0.01,
        "hover, 8 m/s of wind: rms east, m": 0.01,
        "hover, 8 m/s of wind: farthest, m": 0.03,
        "hover, 8 m/s of wind: lean, deg": 7.2,
        "go 80 m: time, s": 13.5,
        "go 80 m: top speed, m/s": 10.0,
        "go 80 m: acceleration, m/s^2": 2.7,
        "go 80 m: braking, m/s^2": 1.9,
        "go 80 m: overshoot, m": 0.77,
        "up 20 m: time, s": 10.2,
        "up 20 m: speed, m/s": 2.55,
        "down 20 m: time, s": 14.2,
        "down 20 m: speed, m/s": 1.56,
        "5 m/s by setpoints: reached, m/s": 5.06,
        "5 m/s by setpoints: lean, deg": 11.9,
        "BRAKE or Hold from 5 m/s: stop after, s": 5.0,
        "BRAKE or Hold from 5 m/s: way, m": 9.1,
        "LOITER from 5 m/s: stop after, s": 2.3,
        "LOITER from 5 m/s: way, m": 6.3,
        "return: way down at 11 m, m/s": 1.3,
        "return: way down at 8 m, m/s": 0.5,
        "return: way down at 4 m, m/s": 0.5,
        "return: way down at 2 m, m/s": 0.5,
        "return: way down at 0.5 m, m/s": 0.5,
        "from 0.5 m to disarmed, s": 2.4,
        "mode afterwards": 6,
        "forced disarm at 10 m: falls with, m/s": 12.16,
        "6 m circle, position and velocity: rms, m": (0.57, 0.61),
        "6 m circle, with acceleration: rms, m": (0.23, 0.26),
    },
    Flavour.PX4: {
        "local z at rest, m": -0.02,
        "take-off to 10 m: to 0.3 m, s": 4.6,
        "take-off to 10 m: to 9.5 m, s": 12.3,
        "greatest climb, m/s": 1.5,
        "settled height, m": 10.16,
        "overshoot, m": 0.35,
        "hover, calm: rms north, m": 0.16,
        "hover, calm: rms east, m": 0.20,
        "hover, calm: rms down, m": 0.10,
        "go 80 m: time, s": 22.3,
        "go 80 m: top speed, m/s": 4.8,
        "go 80 m: acceleration, m/s^2": 1.9,
        "go 80 m: braking, m/s^2": 1.35,
        "go 80 m: overshoot, m": 0.9,
        "up 20 m: time, s": 9.9,
        "up 20 m: speed, m/s": 2.87,
        "down 20 m: time, s": 14.2,
        "down 20 m: speed, m/s": 1.68,
        "5 m/s by setpoints: reached, m/s": 4.56,
        "5 m/s by setpoints: lean, deg": 23.8,
        "BRAKE or Hold from 5 m/s: stop after, s": 4.5,
        "BRAKE or Hold from 5 m/s: way, m": 7.5,
        "yaw: greatest rate, deg/s": 63.0,
        "return: top, m": 30.2,
        "return: way down at 14 m, m/s": 1.57,
        "return: way down at 8 m, m/s": 1.27,
        "return: way down at 4 m, m/s": 0.51,
        "return: way down at 2 m, m/s": 0.43,
        "return: way down at 0.5 m, m/s": 0.30,
        "from 0.5 m to disarmed, s": 4.7,
        "mode afterwards": 0x3040000,
        "6 m circle, position and velocity: rms, m": (1.27, 1.68),
        "6 m circle, with acceleration: rms, m": (1.09, 1.66),
    },
}
"""ArduCopter 4.7 and PX4 1.17 (SIH quadrotor) in their own simulators with the parameters that they come with."""

APART: Final[Mapping[Flavour, Mapping[str, str]]] = {
    Flavour.ARDUPILOT: {
        "local z at rest, m": "both within 2 cm",
        "hover, calm: rms north, m": "both within 1 cm",
        "hover, calm: rms east, m": "both within 1 cm",
        "hover, calm: rms down, m": "both within 1 cm",
        "hover, 8 m/s of wind: rms north, m": "both within 4 cm: gusts last for 3 s here",
        "hover, 8 m/s of wind: rms east, m": "both within 4 cm: gusts last for 3 s here",
        "hover, 8 m/s of wind: farthest, m": "both within 10 cm: gusts last for 3 s here",
        "go 80 m: overshoot, m": "the observer of disturbances is faster than an integral",
        "LOITER from 5 m/s: stop after, s": "the last decimetres are slower",
        "from 0.5 m to disarmed, s": "the throttle falls at once",
    },
    Flavour.PX4: {
        "local z at rest, m": "both within 15 cm",
        "go 80 m: overshoot, m": "between 0.9 and 1.5 m, by what the noise has made of the hover before",
        "overshoot, m": "nothing is learnt before the ground is left",
        "hover, calm: rms north, m": "a planned flight with more noise leaves its tube",
        "hover, calm: rms east, m": "a planned flight with more noise leaves its tube",
        "hover, calm: rms down, m": "the same noise moves it",
    },
}
"""Rows that are not within 20 %, and why not."""


def ratio(ours: float, recorded: float | tuple[float, float]) -> float:
    """Return ours over what was recorded; of a range, over its nearer end."""
    low, high = recorded if isinstance(recorded, tuple) else (recorded, recorded)
    return ours / low if ours < low else ours / high if ours > high else 1.0


def is_near(ours: float, recorded: float | tuple[float, float]) -> bool:
    """Whether the row is within 20 %."""
    return 0.8 <= ratio(ours, recorded) <= 1.2
