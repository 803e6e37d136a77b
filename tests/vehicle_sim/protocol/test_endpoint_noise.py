"""Noise, mutated traffic, hostile numbers: nothing raises, and only valid messages to it move the vehicle."""

import math
from typing import Any

import pytest
from hypothesis import HealthCheck, given
from hypothesis import strategies as st
from pymavlink.dialects.v20 import ardupilotmega as mavlink

from tests.support.drawn_cases import tried
from tests.support.station import Station, endpoint_of
from vehicle_sim.parameters import Flavour
from vehicle_sim.protocol.endpoint import Endpoint

READY = {flavour: Station(endpoint_of(flavour)) for flavour in Flavour}
for _station in READY.values():
    _station.wait_for_position()


def state(endpoint: Endpoint) -> tuple[Any, ...]:
    autopilot, parameters = endpoint.vehicle.autopilot, endpoint.vehicle.parameters
    values = tuple(parameters[name] for name in parameters.names)
    return (autopilot.mode, autopilot.armed, autopilot.home, autopilot.target, endpoint.vehicle.estimate, values)


def requests() -> list[bytes]:
    station = mavlink.MAVLink(None, srcSystem=255, srcComponent=190)
    messages = [
        mavlink.MAVLink_command_long_message(1, 1, 400, 0, 1, *(0,) * 6),
        mavlink.MAVLink_set_mode_message(1, 1, 4),
        mavlink.MAVLink_param_set_message(1, 1, b"FS_GCS_ENABLE", 1.0, 9),
        mavlink.MAVLink_mission_count_message(1, 1, 4, 0),
        mavlink.MAVLink_command_int_message(1, 1, 0, 179, 0, 0, 0, 0, 0, 0, 10_000_000, 10_000_000, 5.0),
    ]
    return [message.pack(station) for message in messages]


@tried(80, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(flavour=st.sampled_from(Flavour), chunks=st.lists(st.binary(max_size=400), max_size=6))
def test_random_bytes_change_nothing(flavour: Flavour, chunks: list[bytes]) -> None:
    endpoint = READY[flavour].endpoint
    before = state(endpoint)
    for chunk in chunks:
        endpoint.receive("station", chunk)
        endpoint.receive("station", b"\xfd" + chunk)
    assert state(endpoint) == before


@tried(150)
@given(
    flavour=st.sampled_from(Flavour),
    frame=st.sampled_from(requests()),
    flips=st.lists(st.tuples(st.integers(0, 60), st.integers(1, 255)), min_size=1, max_size=4),
)
def test_mutated_requests_change_nothing(flavour: Flavour, frame: bytes, flips: list[tuple[int, int]]) -> None:
    mutated = bytearray(frame)
    for place, bits in flips:
        mutated[place % len(mutated)] ^= bits
    if bytes(mutated) == frame:
        return
    endpoint = READY[flavour].endpoint
    before = state(endpoint)
    endpoint.receive("station", bytes(mutated))
    assert state(endpoint) == before


HANDLED = sorted({number for station in READY.values() for number in station.endpoint._handlers})
NUMBERS: dict[str, st.SearchStrategy[Any]] = {
    "float": st.sampled_from([0.0, 1.0, -1.0, 1e30, -1e30, math.nan, math.inf, -math.inf, 16.0, 400.0]),
    "uint8_t": st.sampled_from([0, 1, 2, 3, 4, 6, 254, 255]),
    "int8_t": st.sampled_from([-128, 0, 127]),
    "uint16_t": st.sampled_from([0, 1, 16, 22, 192, 400, 511, 512, 65535]),
    "int16_t": st.sampled_from([-32768, -1, 0, 5, 32767]),
    "uint32_t": st.sampled_from([0, 4, 2**32 - 1]),
    "int32_t": st.sampled_from([-(2**31), 0, 473_977_420, 2**31 - 1]),
    "uint64_t": st.sampled_from([0, 2**64 - 1]),
    "int64_t": st.sampled_from([-(2**63), 0, 2**63 - 1]),
    "uint8_t_mavlink_version": st.just(3),
}


@st.composite
def hostile(draw: st.DrawFn) -> Any:  # noqa: ANN401 - a message of any class
    kind = mavlink.mavlink_map[draw(st.sampled_from(HANDLED))]
    lengths = dict(zip(kind.ordered_fieldnames, kind.array_lengths, strict=True))
    values: list[Any] = []
    for name, sort in zip(kind.fieldnames, kind.fieldtypes, strict=True):
        if name == "target_system":
            values.append(1)
        elif sort == "char":
            values.append(draw(st.sampled_from([b"FS_GCS_ENABLE", b"", b"\xff" * 16, b"_HASH_CHECK", b"NAV_DLL_ACT"])))
        elif lengths[name]:
            values.append(draw(st.lists(NUMBERS[sort], min_size=lengths[name], max_size=lengths[name])))
        else:
            values.append(draw(NUMBERS[sort]))
    return kind(*values)


@pytest.mark.parametrize("flavour", Flavour)
@tried(50, suppress_health_check=list(HealthCheck))
@given(messages=st.lists(hostile(), min_size=1, max_size=6))
def test_no_valid_message_with_hostile_numbers_raises(flavour: Flavour, messages: list[Any]) -> None:
    station = Station(endpoint_of(flavour))
    station.send(*messages)
    station.run(0.05)
    assert all(math.isfinite(value) for value in station.endpoint.vehicle.estimate.position_ned_m)


@pytest.mark.parametrize("flavour", Flavour)
def test_hostile_setpoints_and_places_in_flight(flavour: Flavour) -> None:
    station = Station(endpoint_of(flavour))
    station.take_off()
    for value in (1e30, -1e30, 3e38):
        for mask in (0xDF8, 0xDC7, 0xDC0, 0xC00):
            station.setpoint((value,) * 3, (value,) * 3, (value,) * 3, mask=mask)
            station.run(0.1)
    position = station.endpoint.vehicle.truth.position_ned_m
    assert all(math.isfinite(value) for value in position)
