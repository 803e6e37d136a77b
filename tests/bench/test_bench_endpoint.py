"""How much faster than real time one vehicle with all its default streams runs in lock-step, by processor time."""

from time import process_time

import pytest
from pymavlink.dialects.v20 import ardupilotmega as mavlink

from tests.support.station import Station, endpoint_of
from vehicle_sim.autopilot import Mode
from vehicle_sim.dynamics.airframe import Dynamics
from vehicle_sim.parameters import Flavour
from vehicle_sim.protocol.flavour import Rates

pytestmark = pytest.mark.bench

_SECONDS = 60.0


def seconds_of_work(station: Station, *, drains: bool = True) -> tuple[float, int]:
    endpoint, datagrams = station.endpoint, 0
    begun_s = process_time()
    for _ in range(round(_SECONDS / endpoint.vehicle.config.step_s)):
        endpoint.advance()
        datagrams += len(endpoint.outgoing(station.name)) if drains else 0
    return process_time() - begun_s, datagrams


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
    work_s, _datagrams = seconds_of_work(station)
    print(
        f"{flavour:9} {dynamics:9} {rates.name:14} {messages_hz:6.1f} messages/s"
        f"{_SECONDS / work_s:9.1f} times real time"
    )
    assert _SECONDS / work_s > 20.0


def test_bench_receive() -> None:
    station = Station(endpoint_of(Flavour.ARDUPILOT))
    station.wait_for_position()
    frames = [
        station.packed(mavlink.MAVLink_set_position_target_local_ned_message(0, 1, 1, 1, 0xC00, *(1.0,) * 9, 0.5, 0.0))
        for _ in range(20_000)
    ]
    begun_s = process_time()
    for frame in frames:
        station.endpoint.receive(station.name, frame)
    work_s = process_time() - begun_s
    print(f"setpoints received and handed to the autopilot: {len(frames) / work_s:,.0f} a second")
    assert len(frames) / work_s > 2_000
