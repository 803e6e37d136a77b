"""What is handled, what is passed on, and where to."""

from hashlib import sha256

import pytest
from pymavlink.dialects.v20 import ardupilotmega as mavlink

from tests.support.station import Station, endpoint_of
from vehicle_sim.parameters import Flavour
from vehicle_sim.protocol.endpoint import Endpoint
from vehicle_sim.protocol.flavour import Rates
from vehicle_sim.protocol.signing import Signer


@pytest.fixture
def endpoint() -> Endpoint:
    return endpoint_of(Flavour.ARDUPILOT)


def heartbeat() -> object:
    return mavlink.MAVLink_heartbeat_message(6, 8, 0, 0, 4, 3)


def command_to(system: int, component: int) -> object:
    return mavlink.MAVLink_command_long_message(system, component, 31000, 0, *(0,) * 7)


def test_broadcasts_go_everywhere_but_back(endpoint: Endpoint) -> None:
    station, companion = Station(endpoint, "a"), Station(endpoint, "b", system_id=245)
    station.send(heartbeat())
    companion.collect()
    assert [(m.get_srcSystem(), m.get_type()) for m in companion.heard] == [(255, "HEARTBEAT")]
    assert station.heard == []


def test_what_is_addressed_to_one_goes_there_only(endpoint: Endpoint) -> None:
    stations = [Station(endpoint, name, system_id=system) for name, system in (("a", 255), ("b", 245), ("c", 200))]
    for station in stations:
        station.send(heartbeat())
    for station in stations:
        station.collect()
        station.forget()
    stations[0].send(command_to(245, 0))
    for station in stations:
        station.collect()
    assert [len(station.heard) for station in stations] == [0, 1, 0]
    # The frame is passed on as it came: same source, same sequence number.
    assert stations[1].heard[0].get_srcSystem() == 255


def test_messages_to_a_system_that_nobody_heard_go_nowhere(endpoint: Endpoint) -> None:
    station, other = Station(endpoint, "a"), Station(endpoint, "b", system_id=245)
    station.send(command_to(77, 1))
    other.collect()
    assert (station.heard, other.heard) == ([], [])


def test_a_component_of_ours_gets_its_own_messages(endpoint: Endpoint) -> None:
    station = Station(endpoint, "a")
    gimbal = Station(endpoint, "b", system_id=1, component_id=154)
    gimbal.send(heartbeat())
    station.forget()
    station.send(command_to(1, 154))
    gimbal.collect()
    assert [m.get_type() for m in gimbal.heard] == ["COMMAND_LONG"]
    assert not station.of("COMMAND_ACK")
    station.send(command_to(1, 0))
    gimbal.collect()
    assert len(gimbal.of("COMMAND_LONG")) == 2
    assert len(station.of("COMMAND_ACK")) == 1


def test_an_echo_of_the_vehicle_is_dropped(endpoint: Endpoint) -> None:
    station, other = Station(endpoint, "a", system_id=1, component_id=1), Station(endpoint, "b")
    station.send(command_to(1, 1), heartbeat())
    other.collect()
    assert (station.heard, other.heard) == ([], [])


def test_a_source_that_moves_is_followed(endpoint: Endpoint) -> None:
    wanderer, other = Station(endpoint, "a", system_id=245), Station(endpoint, "b")
    wanderer.send(heartbeat())
    moved = Station(endpoint, "c", system_id=245)
    moved.send(heartbeat())
    for station in (wanderer, moved, other):
        station.collect()
        station.forget()
    other.send(command_to(245, 190))
    wanderer.collect()
    moved.collect()
    assert (len(wanderer.heard), len(moved.heard)) == (0, 1)
    endpoint.remove_link("c")
    other.send(command_to(245, 190))
    wanderer.collect()
    assert wanderer.heard == []


def test_mavlink_2_is_not_passed_on_to_a_peer_that_cannot_read_it(endpoint: Endpoint) -> None:
    station, old = Station(endpoint, "a"), Station(endpoint, "b", system_id=245)
    endpoint.receive("b", mavlink.MAVLink_heartbeat_message(6, 8, 0, 0, 4, 3).pack(old.mav, force_mavlink1=True))
    station.send(heartbeat())
    assert endpoint.outgoing("b") == []
    endpoint.advance()
    assert endpoint.outgoing("b")[0][0] == 0xFE


def test_links_are_named_once(endpoint: Endpoint) -> None:
    endpoint.add_link("a")
    with pytest.raises(ValueError, match="already"):
        endpoint.add_link("a")
    with pytest.raises(KeyError):
        endpoint.receive("b", b"")
    with pytest.raises(KeyError):
        endpoint.remove_link("b")


def test_the_endpoint_refuses_what_does_not_fit(endpoint: Endpoint) -> None:
    with pytest.raises(ValueError, match="px4"):
        Endpoint(endpoint.vehicle, Flavour.PX4)
    with pytest.raises(ValueError, match="1 to 255"):
        Endpoint(endpoint.vehicle, Flavour.ARDUPILOT, 0)


def unknown_frame(system: int = 245, payload: bytes = b"\x01\x02\x03", *, old: bool = False) -> bytes:
    """Return a frame of a message that the dialect does not know; nobody here can check its checksum."""
    if old:
        return bytes((0xFE, len(payload), 7, system, 190, 222)) + payload + b"\xaa\xbb"
    return bytes((0xFD, len(payload), 0, 0, 7, system, 190)) + (60_123).to_bytes(3, "little") + payload + b"\xaa\xbb"


@pytest.mark.parametrize("old", [False, True])
def test_messages_that_the_dialect_does_not_know_are_passed_on_as_they_came(endpoint: Endpoint, *, old: bool) -> None:
    assert 222 not in mavlink.mavlink_map
    assert 60_123 not in mavlink.mavlink_map
    station, companion = Station(endpoint, "a"), Station(endpoint, "b", system_id=245)
    frame = unknown_frame(old=old)
    endpoint.receive("b", frame)
    assert endpoint.outgoing("a") == []  # its source was never heard in a valid message: it may be noise
    companion.send(heartbeat())
    endpoint.outgoing("a")
    assert endpoint.receive("b", frame) == 0
    assert endpoint.outgoing("a") == [frame]
    assert endpoint.outgoing("b") == []
    endpoint.receive("a", frame)  # from where its source is not
    assert (endpoint.outgoing("a"), endpoint.outgoing("b")) == ([], [])
    station.collect()
    assert station.heard == []


def test_what_is_not_known_hides_nothing_and_is_passed_on_once(endpoint: Endpoint) -> None:
    Station(endpoint, "a")
    companion = Station(endpoint, "b", system_id=245)
    companion.send(heartbeat())
    endpoint.outgoing("a")
    inner = companion.packed(heartbeat())
    nested = unknown_frame(payload=unknown_frame())
    assert endpoint.receive("b", unknown_frame(payload=inner) + nested + inner) == 2
    forwarded = b"".join(endpoint.outgoing("a"))
    assert forwarded.count(unknown_frame(payload=inner)) == 1
    assert forwarded.count(nested) == 1
    assert len(forwarded) == 2 * len(inner) + len(unknown_frame(payload=inner)) + len(nested)


def test_unknown_messages_of_a_link_that_requires_signing_are_signed() -> None:
    key = bytes(range(32))
    plain = endpoint_of(Flavour.ARDUPILOT)
    endpoint = Endpoint(plain.vehicle, Flavour.ARDUPILOT, signer=Signer(key))
    endpoint.add_link("a", Rates.SILENT)
    endpoint.add_link("b", Rates.SILENT)
    mav = mavlink.MAVLink(None, srcSystem=245, srcComponent=190)
    mav.signing.secret_key, mav.signing.sign_outgoing, mav.signing.timestamp = key, True, 5
    endpoint.receive("b", heartbeat().pack(mav))  # type: ignore[attr-defined]
    endpoint.outgoing("a")
    endpoint.receive("b", unknown_frame())
    assert endpoint.outgoing("a") == []
    signed = bytearray(unknown_frame())
    signed[2] = 1
    stamped = bytes(signed) + bytes((0,)) + (9).to_bytes(6, "little")
    frame = stamped + sha256(key + stamped).digest()[:6]
    endpoint.receive("b", frame)
    assert endpoint.outgoing("a") == [frame]
    endpoint.receive("b", frame)
    assert endpoint.outgoing("a") == []  # replayed


def test_a_source_without_a_system_is_nowhere(endpoint: Endpoint) -> None:
    nobody, other = Station(endpoint, "a", system_id=0), Station(endpoint, "b")
    nobody.send(heartbeat())
    other.collect()
    assert [m.get_type() for m in other.heard] == ["HEARTBEAT"]
    assert not endpoint._router._routes


def test_the_component_id_is_the_users_choice() -> None:
    plain = endpoint_of(Flavour.ARDUPILOT)
    endpoint = Endpoint(plain.vehicle, Flavour.ARDUPILOT, 5, component_id=42)
    autopilot = Station(endpoint, "a")
    other = Station(endpoint, "b", system_id=5, component_id=1)
    other.send(heartbeat())
    autopilot.forget()
    autopilot.send(command_to(5, 42))
    assert [(m.get_srcSystem(), m.get_srcComponent()) for m in autopilot.of("COMMAND_ACK")] == [(5, 42)]
    autopilot.forget()
    autopilot.send(command_to(5, 1))
    assert autopilot.of("COMMAND_ACK") == []
    other.collect()
    assert other.of("COMMAND_LONG")
    with pytest.raises(ValueError, match="component id"):
        Endpoint(plain.vehicle, Flavour.ARDUPILOT, component_id=0)
