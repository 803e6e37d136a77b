"""How much faster than real time one vehicle with all its default streams runs in lock-step."""

from time import perf_counter

import pytest
from pymavlink.dialects.v20 import ardupilotmega as mavlink

from tests.support.station import Station, endpoint_of
from vehicle_sim.autopilot import Mode
from vehicle_sim.parameters import Flavour
from vehicle_sim.protocol.flavour import Rates

pytestmark = pytest.mark.bench

_SECONDS = 60.0


def seconds_of_wall(station: Station, *, drains: bool = True) -> tuple[float, int]:
    endpoint, datagrams = station.endpoint, 0
    begun_s = perf_counter()
    for _ in range(round(_SECONDS / endpoint.vehicle.config.step_s)):
        endpoint.advance()
        datagrams += len(endpoint.outgoing(station.name)) if drains else 0
    return perf_counter() - begun_s, datagrams


@pytest.mark.parametrize("flavour", Flavour)
@pytest.mark.parametrize("rates", [Rates.SILENT, Rates.GROUND_STATION, Rates.ONBOARD])
def test_bench_lock_step(flavour: Flavour, rates: Rates) -> None:
    station = Station(endpoint_of(flavour), rates=rates)
    station.take_off()
    if flavour is Flavour.ARDUPILOT and rates is not Rates.SILENT:
        hertz = 4 if rates is Rates.GROUND_STATION else 50
        station.send(mavlink.MAVLink_request_data_stream_message(1, 1, mavlink.MAV_DATA_STREAM_ALL, hertz, 1))
    assert station.endpoint.vehicle.autopilot.mode in (Mode.GUIDED, Mode.TAKEOFF, Mode.HOLD)
    streams = station.endpoint._links[station.name].streams
    messages_hz = sum(1e6 / interval_us for interval_us in streams._intervals_us.values())
    wall_s, _datagrams = seconds_of_wall(station)
    print(f"{flavour:9} {rates.name:14} {messages_hz:6.1f} messages/s  {_SECONDS / wall_s:7.1f} times real time")
    assert _SECONDS / wall_s > 20.0


def test_bench_receive() -> None:
    station = Station(endpoint_of(Flavour.ARDUPILOT))
    station.wait_for_position()
    frames = [
        station.packed(mavlink.MAVLink_set_position_target_local_ned_message(0, 1, 1, 1, 0xC00, *(1.0,) * 9, 0.5, 0.0))
        for _ in range(20_000)
    ]
    begun_s = perf_counter()
    for frame in frames:
        station.endpoint.receive(station.name, frame)
    wall_s = perf_counter() - begun_s
    print(f"setpoints received and handed to the autopilot: {len(frames) / wall_s:,.0f} a second")
    assert len(frames) / wall_s > 2_000
