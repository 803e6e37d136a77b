"""One packet that contradicts the others ends no flight, and nothing that is no number leads the vehicle."""

import math
from collections.abc import Callable
from itertools import pairwise
from typing import Any

import pytest
from pymavlink.dialects.v20 import ardupilotmega as mavlink

from mission.errors import VehicleError
from mission.link.ending import Ending
from mission.link.events import Moved, SetpointSent
from mission.link.identity import LinkOptions
from mission.link.session import Session
from mission.monitor.stage import Stage
from tests.support.scripted_vehicle import Script, ScriptedVehicle
from tests.support.sessions import Driven

_HOUR_MS = 3_600_000
_NAN = math.nan
_STAGES = [Stage.READY, Stage.CLIMB, Stage.FLY, Stage.TOUCH_DOWN]


def _position(at_ms: int) -> Any:  # noqa: ANN401 - pymavlink ships no types
    return mavlink.MAVLink_local_position_ned_message(at_ms, 900.0, 900.0, -90.0, 9.0, 9.0, 9.0)


def _global_position(at_ms: int) -> Any:  # noqa: ANN401 - the same
    return mavlink.MAVLink_global_position_int_message(at_ms, 1, 1, 1, 1, 0, 0, 0, 0)


def _attitude(at_ms: int, yaw_rad: float = 1.0) -> Any:  # noqa: ANN401 - the same
    return mavlink.MAVLink_attitude_message(at_ms, yaw_rad, yaw_rad, yaw_rad, 0.0, 0.0, 0.0)


def _beat(vehicle: ScriptedVehicle, *, armed: bool) -> Any:  # noqa: ANN401 - the same
    autopilot, base = (12, 29) if vehicle.px4 else (3, 81)
    return mavlink.MAVLink_heartbeat_message(2, autopilot, base | (128 if armed else 0), vehicle.mode, 4, 3)


_ODD: dict[str, Callable[[ScriptedVehicle], Any]] = {
    "a position 3.5 s late": lambda v: _position((v.time_boot_ms - 3500) % 2**32),
    "an attitude from before the last start": lambda v: _attitude((v.time_boot_ms - 900_000) % 2**32),
    "a position an hour ahead": lambda v: _position(v.time_boot_ms + _HOUR_MS),
    "a global position an hour ahead": lambda v: _global_position(v.time_boot_ms + _HOUR_MS),
    "an attitude an hour ahead": lambda v: _attitude(v.time_boot_ms + _HOUR_MS),
    "an attitude that is no number": lambda v: _attitude(v.time_boot_ms, _NAN),
    "a position that is no number": lambda v: mavlink.MAVLink_local_position_ned_message(
        v.time_boot_ms, *[_NAN, math.inf, _NAN] * 2
    ),
    "an origin elsewhere": lambda _: mavlink.MAVLink_gps_global_origin_message(480_000_000, 80_000_000, 0),
    "a heartbeat of a vehicle that flies": lambda v: _beat(v, armed=True),
    "a heartbeat of a disarmed vehicle": lambda v: _beat(v, armed=False),
}


@pytest.mark.parametrize("flavour", ["ardupilot", "px4"])
@pytest.mark.parametrize("twice", [False, True])
def test_no_odd_packet_changes_anything(flavour: str, twice: bool) -> None:  # noqa: FBT001 - a test's parameter
    vehicle = ScriptedVehicle(flavour, Script(double=1.0 if twice else 0.0))
    driven = Driven(vehicle)
    for stage in _STAGES:
        driven.until(stage)
        for packet in _ODD.values():
            for _ in range(10):
                driven.turn()
            vehicle.slip_in(packet(vehicle))
    driven.fly()
    assert driven.session.ending is Ending.LANDED
    assert not vehicle.armed
    places = [event.position_m for event in driven.events if isinstance(event, Moved)]
    assert max(math.dist(a, b) for a, b in pairwise(places)) < 2.0
    for setpoint in vehicle.setpoints:
        assert all(map(math.isfinite, (setpoint.x, setpoint.y, setpoint.z, setpoint.vx, setpoint.vy, setpoint.yaw)))
    sent = [event.t_s for event in driven.events if isinstance(event, SetpointSent)]
    assert max(b - a for a, b in pairwise(sent)) < 0.3


@pytest.mark.parametrize(
    ("message", "words"),
    [(_attitude, "its attitude is no number"), (_position, "its local position is no number")],
)
def test_a_vehicle_whose_estimates_stay_no_numbers_is_not_flown(message: Any, words: str) -> None:  # noqa: ANN401 - either
    class Garbled(ScriptedVehicle):
        def _emit(self, sent: Any) -> None:  # noqa: ANN401 - pymavlink ships no types
            if sent.get_msgId() == message(0).get_msgId():
                for name in {"roll", "pitch", "yaw", "x", "y", "vz"} & set(sent.get_fieldnames()):
                    setattr(sent, name, _NAN)
            super()._emit(sent)

    vehicle = Garbled("px4")
    driven = Driven(vehicle, Session(needs_origin=False, options=LinkOptions(ready_s=15.0)))
    with pytest.raises(VehicleError, match=f"not ready after 15 s: {words}"):
        driven.fly()
    assert not vehicle.setpoints
