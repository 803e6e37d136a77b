"""An hour of flight in lock-step, by setpoints over a link with all its streams: memory stays where it was."""

import gc
import sys
import time

import pytest
from pymavlink.dialects.v20 import ardupilotmega as mavlink

from tests.support.bare_vehicle import hovering
from vehicle_sim.autopilot import Mode
from vehicle_sim.dynamics.airframe import Dynamics
from vehicle_sim.parameters import Flavour
from vehicle_sim.protocol.endpoint import Endpoint
from vehicle_sim.protocol.flavour import Rates

_LINK = "planner"
_STREAMS_HZ = 50
_MOST_BLOCKS = 300
"""Blocks of memory by which two moments may differ by chance; one kept each ten seconds would be more."""


class _Pilot:
    """Sends heartbeats and setpoints, throws away what comes, and keeps nothing."""

    def __init__(self, flavour: Flavour, dynamics: Dynamics) -> None:
        vehicle = hovering(flavour, dynamics=dynamics, wind_m_s=4.0)
        vehicle.parameters.set("BATT_CAPACITY" if flavour is Flavour.ARDUPILOT else "BAT1_CAPACITY", 100_000)
        self.endpoint = Endpoint(vehicle, flavour)
        self.endpoint.add_link(_LINK, Rates.ONBOARD)
        self._mav = mavlink.MAVLink(None, srcSystem=255, srcComponent=190)
        self._place = vehicle.estimate.position_ned_m
        self._send(mavlink.MAVLink_request_data_stream_message(1, 1, mavlink.MAV_DATA_STREAM_ALL, _STREAMS_HZ, 1))
        self.received = 0
        if flavour is Flavour.PX4:
            self.fly(1.0)
            vehicle.autopilot.set_mode(Mode.GUIDED)

    def _send(self, message: object) -> None:
        self.endpoint.receive(_LINK, message.pack(self._mav))  # type: ignore[attr-defined]
        self._mav.seq = (self._mav.seq + 1) % 256

    def fly(self, seconds: float) -> None:
        north, east, down = self._place
        for step in range(round(seconds * 100)):
            if step % 100 == 0:
                self._send(mavlink.MAVLink_heartbeat_message(6, 8, 0, 0, 4, 3))
            if step % 5 == 0:
                ahead = 5.0 if step // 1000 % 2 else 0.0
                self._send(
                    mavlink.MAVLink_set_position_target_local_ned_message(
                        0, 1, 1, 1, 0xDF8, north + ahead, east, down, *(0.0,) * 8
                    )
                )
            self.endpoint.advance()
            self.received += sum(map(len, self.endpoint.outgoing(_LINK)))


@pytest.mark.long
@pytest.mark.timeout(1800)
@pytest.mark.parametrize("dynamics", list(Dynamics))
@pytest.mark.parametrize("flavour", list(Flavour))
def test_an_hour_in_the_air_leaves_memory_flat(flavour: Flavour, dynamics: Dynamics) -> None:
    pilot = _Pilot(flavour, dynamics)
    pilot.fly(300.0)
    gc.collect()
    early, begun_s = sys.getallocatedblocks(), time.process_time()
    pilot.fly(3300.0)
    gc.collect()
    late, spent_s = sys.getallocatedblocks(), time.process_time() - begun_s
    print(
        f"\n{flavour} {dynamics}: {late - early:+d} blocks of memory after 55 minutes more, {early} before; "
        f"{pilot.received / 1e6:.0f} MB sent; {3300.0 / spent_s:.0f} times real time by processor time"
    )
    assert pilot.endpoint.vehicle.autopilot.mode is Mode.GUIDED
    assert not pilot.endpoint.vehicle.truth.on_ground
    assert abs(late - early) < _MOST_BLOCKS
