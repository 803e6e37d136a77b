"""The receive path with and without signing, a fleet at real time, and UDP at twenty times real time.

Reading is held against pymavlink's parse_buffer, a step of a vehicle against the turns of a plain loop.
"""

import socket
import threading
from contextlib import closing
from time import perf_counter, process_time

import pytest
from pymavlink.dialects.v20 import ardupilotmega as mavlink

from mission.link.messages import Codec
from tests.support.measuring import turn_s
from tests.support.station import Station, endpoint_of
from vehicle_sim.autopilot import LandedState, Mode, Outcome
from vehicle_sim.clock import WallClock
from vehicle_sim.parameters import Flavour
from vehicle_sim.protocol.flavour import Rates
from vehicle_sim.protocol.link import Link
from vehicle_sim.protocol.signing import Signer
from vehicle_sim.server.addresses import parse_address
from vehicle_sim.server.fleet import fleet_of
from vehicle_sim.server.party import Fleet
from vehicle_sim.server.ports import open_port
from vehicle_sim.server.server import Server
from vehicle_sim.vehicle import VehicleConfig

pytestmark = pytest.mark.bench

_MESSAGES = 20_000
_LEAST_SHARE = 0.6
_MOST_TURNS = 15_000
_KEY = bytes(range(32))


def frames(*, signed: bool) -> list[bytes]:
    mav = mavlink.MAVLink(None, srcSystem=255, srcComponent=190)
    if signed:
        mav.signing.secret_key, mav.signing.sign_outgoing, mav.signing.timestamp = _KEY, True, 1
    packed = []
    for number in range(_MESSAGES):
        mav.seq = number % 256
        message = mavlink.MAVLink_set_position_target_local_ned_message(0, 1, 1, 1, 0xC00, *(1.0,) * 9, 0.5, 0.0)
        packed.append(message.pack(mav))
    return packed


@pytest.mark.parametrize("together", [1, 20])
def test_bench_decoding(together: int) -> None:
    for signed in (False, True):
        packed = frames(signed=signed)
        data = [b"".join(packed[i : i + together]) for i in range(0, _MESSAGES, together)]
        best: dict[str, float] = {}
        for _ in range(5):
            link = Link("a", system_id=1, signer=Signer(_KEY if signed else None))
            reader = mavlink.MAVLink(None)
            reader.robust_parsing = True
            reader.signing.secret_key = _KEY if signed else None
            for name, decode in (("ours", link.decode), ("pymavlink's parse_buffer", reader.parse_buffer)):
                begun_s = process_time()
                assert sum(len(decode(piece)) for piece in data) == _MESSAGES
                best[name] = max(best.get(name, 0.0), _MESSAGES / (process_time() - begun_s))
        for name, rate in best.items():
            kind = "signed" if signed else "unsigned"
            print(f"{together:3} in a datagram, {kind:8} {name:24} {rate:9,.0f} messages/s of processor time")
        assert best["ours"] > _LEAST_SHARE * best["pymavlink's parse_buffer"]


@pytest.mark.parametrize("together", [1, 20])
def test_bench_the_planners_reading(together: int) -> None:
    mav = mavlink.MAVLink(None, srcSystem=1, srcComponent=1)
    telemetry = [
        mavlink.MAVLink_local_position_ned_message(1000, 1.5, -2.5, -10.0, 0.5, 0.25, 0.125),
        mavlink.MAVLink_attitude_message(1000, 0.1, 0.2, 0.3, 0.0, 0.0, 0.0),
        mavlink.MAVLink_global_position_int_message(1000, 470000000, 80000000, 90000, 10000, 1, 1, 1, 1),
        mavlink.MAVLink_vfr_hud_message(1.0, 1.0, 90, 50, 10.0, 0.0),
    ]
    packed = [bytes(telemetry[i % 4].pack(mav)) for i in range(_MESSAGES)]
    data = [b"".join(packed[i : i + together]) for i in range(0, _MESSAGES, together)]
    codec, reader = Codec(255, 191), mavlink.MAVLink(None)
    reader.robust_parsing = True
    best: dict[str, float] = {}
    for _ in range(5):
        for name, decode in (("planner", codec.decode), ("pymavlink's parse_buffer", reader.parse_buffer)):
            begun_s = process_time()
            for piece in data:
                decode(piece)
            best[name] = max(best.get(name, 0.0), _MESSAGES / (process_time() - begun_s))
    share = best["planner"] / best["pymavlink's parse_buffer"]
    print(f"{together:3} in a datagram: the planner reads at {share:.2f} times the speed of pymavlink's parse_buffer")
    assert share > _LEAST_SHARE


@pytest.mark.parametrize("flavour", Flavour)
def test_bench_twenty_vehicles(flavour: Flavour) -> None:
    endpoints = fleet_of(VehicleConfig(flavour=flavour), count=20, spacing_m=5.0, system_id=1)
    fleet = Fleet(endpoints)
    fleet.add_link("ground station", Rates.GROUND_STATION)
    mav = mavlink.MAVLink(None, srcSystem=255, srcComponent=190)
    beat = mavlink.MAVLink_heartbeat_message(6, 8, 0, 0, 4, 3)
    if flavour is Flavour.ARDUPILOT:
        fleet.receive("ground station", mavlink.MAVLink_request_data_stream_message(0, 0, 0, 4, 1).pack(mav))
    while not all(endpoint.vehicle.autopilot.ready_to_arm for endpoint in endpoints):
        for endpoint in endpoints:
            if flavour is Flavour.ARDUPILOT:
                endpoint.vehicle.autopilot.set_mode(Mode.GUIDED)
            endpoint.advance()
    for endpoint in endpoints:
        assert endpoint.vehicle.autopilot.arm() is Outcome.ACCEPTED
        assert endpoint.vehicle.autopilot.takeoff(10.0) is Outcome.ACCEPTED
    seconds, sent, loop_s = 30, 0, turn_s()
    begun_s = process_time()
    for _ in range(seconds):
        fleet.receive("ground station", beat.pack(mav))
        for _ in range(100):
            for endpoint in endpoints:
                endpoint.advance()
            sent += sum(map(len, fleet.outgoing("ground station")))
    cost = (process_time() - begun_s) / seconds
    print(
        f"{flavour:9} 20 vehicles flying, on one link: {cost:.2f} s of processor time a second of vehicle time, "
        f"{cost / loop_s / 2000:,.0f} turns a vehicle's step, {sent / seconds / 1000:.0f} kB/s"
    )
    assert all(endpoint.vehicle.autopilot.landed_state is LandedState.IN_AIR for endpoint in endpoints)
    assert cost / loop_s < _MOST_TURNS * 2000


@pytest.mark.parametrize("flavour", Flavour)
def test_bench_udp_at_twenty_times(flavour: Flavour) -> None:
    station = Station(endpoint_of(flavour))
    station.take_off()
    endpoint, said = station.endpoint, list[str]()
    port = open_port(parse_address("udpin:127.0.0.1:0"), endpoint, Rates.ONBOARD, said.append)
    begun_s, from_s = perf_counter(), endpoint.vehicle.time_s
    until_s = from_s + 100.0
    done = threading.Event()
    heard = [0]
    with closing(socket.socket(socket.AF_INET, socket.SOCK_DGRAM)) as peer:
        peer.settimeout(0.2)
        mav = mavlink.MAVLink(None, srcSystem=245, srcComponent=190)
        for message_id in (30, 32, 33):
            ask = mavlink.MAVLink_command_long_message(1, 1, 511, 0, message_id, 20_000, *(0,) * 5)
            peer.sendto(ask.pack(mav), ("127.0.0.1", port.address.port))

        def listen() -> None:
            while not done.is_set():
                try:
                    heard[0] += len(peer.recv(65535))
                except TimeoutError:
                    continue

        listener = threading.Thread(target=listen)
        listener.start()
        loop_s, work_s = turn_s(), process_time()
        server = Server([endpoint], [port], clock=WallClock(), notify=said.append)
        server.run(20.0, lambda: endpoint.vehicle.time_s >= until_s)
        work_s, wall_s = process_time() - work_s, perf_counter() - begun_s
        done.set()
        listener.join()
    port.close()
    print(
        f"{flavour:9} over UDP: {100.0 / wall_s:.1f} times real time of 20 asked for, {100.0 / work_s:.0f} times by "
        f"processor time, {work_s / loop_s / 10_000:,.0f} turns a step, {heard[0] / wall_s / 1000:.0f} kB/s {said}"
    )
    assert work_s / loop_s < _MOST_TURNS * 10_000
