"""What one vehicle with all its default streams costs in lock-step, and what it costs to hear a setpoint.

A step is told in turns of a plain loop, a setpoint beside what pymavlink's parse_buffer takes to read it.
"""

from functools import partial

import pytest
from pymavlink.dialects.v20 import ardupilotmega as mavlink

from tests.support.measuring import TURNS, compared, loop
from tests.support.station import Station, endpoint_of
from vehicle_sim.autopilot import Mode
from vehicle_sim.dynamics.airframe import Dynamics
from vehicle_sim.parameters import Flavour
from vehicle_sim.protocol.flavour import Rates

pytestmark = pytest.mark.bench

_STEPS, _ROUNDS = 1000, 6
_MOST_TURNS = 15_000
_LEAST_SHARE = 0.2


def steps(station: Station) -> None:
    for _ in range(_STEPS):
        station.endpoint.advance()
        station.endpoint.outgoing(station.name)


@pytest.mark.parametrize("flavour", Flavour)
@pytest.mark.parametrize("rates", [Rates.SILENT, Rates.GROUND_STATION, Rates.ONBOARD])
@pytest.mark.parametrize("dynamics", Dynamics)
def test_bench_lock_step(flavour: Flavour, rates: Rates, dynamics: Dynamics) -> None:
    station = Station(endpoint_of(flavour, dynamics=dynamics), rates=rates)
    station.take_off()
    if flavour is Flavour.ARDUPILOT and rates is not Rates.SILENT:
        hertz = 4 if rates is Rates.GROUND_STATION else 50
        station.send(mavlink.MAVLink_request_data_stream_message(1, 1, mavlink.MAV_DATA_STREAM_ALL, hertz, 1))
    assert station.endpoint.vehicle.autopilot.mode in (Mode.GUIDED, Mode.TAKEOFF, Mode.HOLD)
    streams = station.endpoint._links[station.name].streams
    messages_hz = sum(1e6 / interval_us for interval_us in streams._intervals_us.values())
    took = compared(partial(steps, station), loop, _ROUNDS)
    turns, real_s = took.units * TURNS / _STEPS, _STEPS * station.endpoint.vehicle.config.step_s
    print(
        f"{flavour:9} {dynamics:9} {rates.name:14} {messages_hz:6.1f} messages/s {turns:7,.0f} turns a step"
        f"{real_s / took.times.processor_s:9.1f} times real time"
    )
    assert turns < _MOST_TURNS


def test_bench_receive() -> None:
    station = Station(endpoint_of(Flavour.ARDUPILOT))
    station.wait_for_position()
    frames = [
        station.packed(mavlink.MAVLink_set_position_target_local_ned_message(0, 1, 1, 1, 0xC00, *(1.0,) * 9, 0.5, 0.0))
        for _ in range(5_000)
    ]
    reader = mavlink.MAVLink(None)

    def receive() -> None:
        for frame in frames:
            station.endpoint.receive(station.name, frame)

    def parse() -> None:
        for frame in frames:
            reader.parse_buffer(frame)

    took = compared(receive, parse, _ROUNDS)
    rate = len(frames) / took.times.processor_s
    print(
        f"setpoints received and handed to the autopilot: {rate:,.0f} a second, {1.0 / took.units:.2f} of the speed at "
        "which pymavlink's parse_buffer reads them"
    )
    assert 1.0 / took.units > _LEAST_SHARE
