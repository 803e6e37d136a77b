"""MAVLink 2 signing: what is not rightly signed changes nothing, whatever message it is."""

from hashlib import sha256
from typing import TYPE_CHECKING, Any

import pytest
from hypothesis import given
from hypothesis import strategies as st
from pymavlink.dialects.v20 import ardupilotmega as mavlink

from tests.support.drawn_cases import tried
from tests.support.messages import plain_message
from tests.support.snapshot import snapshot
from tests.support.station import endpoint_of
from vehicle_sim.parameters import Flavour
from vehicle_sim.protocol.dialect import Message
from vehicle_sim.protocol.endpoint import Endpoint
from vehicle_sim.protocol.flavour import Rates
from vehicle_sim.protocol.link import Link
from vehicle_sim.protocol.policy import SigningPolicy
from vehicle_sim.protocol.signing import Signer

if TYPE_CHECKING:
    from collections.abc import Callable

KEY, OTHER = bytes(range(32)), bytes(range(1, 33))
NOW = 40_000_000 * 100_000
MINUTE = 60 * 100_000
HANDLED = sorted({number for flavour in Flavour for number in endpoint_of(flavour)._handlers})


def sender(key: bytes | None, timestamp: int = NOW, *, system: int = 255, component: int = 190) -> Any:  # noqa: ANN401
    mav = mavlink.MAVLink(None, srcSystem=system, srcComponent=component)
    if key is not None:
        mav.signing.secret_key, mav.signing.sign_outgoing = key, True
        mav.signing.timestamp = timestamp
    return mav


def frame_of(message: Message, key: bytes | None, timestamp: int = NOW) -> bytes:
    packed: bytes = message.pack(sender(key, timestamp))
    return packed


def signed_endpoint(
    flavour: Flavour = Flavour.ARDUPILOT, policy: SigningPolicy = SigningPolicy.REQUIRED, *, is_secure: bool = False
) -> Endpoint:
    plain = endpoint_of(flavour)
    endpoint = Endpoint(plain.vehicle, flavour, signer=Signer(KEY, now=lambda: NOW))
    endpoint.add_link("a", Rates.SILENT, signing=policy, is_secure=is_secure)
    endpoint.add_link("b", Rates.SILENT, signing=SigningPolicy.OFF)
    while endpoint.vehicle.autopilot.home is None:
        endpoint.advance()
    for name in ("a", "b"):
        endpoint.outgoing(name)
    return endpoint


READY = {flavour: signed_endpoint(flavour) for flavour in Flavour}


def state(endpoint: Endpoint) -> Any:  # noqa: ANN401
    # The reader's counters are pymavlink's statistics; it holds nothing else.
    return snapshot(endpoint, without=frozenset(("_reader",)))


def test_a_signature_is_what_the_protocol_says() -> None:
    link = Link("a", system_id=1, signer=Signer(KEY, now=lambda: 7), link_id=3)
    link.send(mavlink.MAVLink_heartbeat_message(2, 3, 81, 4, 3, 3))
    (frame,) = link.drain()
    unsigned = bytes.fromhex("fd 09 01 00 00 01 01 00 00 00 04 00 00 00 02 03 51 03 03")
    assert frame[:19] == unsigned
    assert frame[21:28] == bytes((3, 7, 0, 0, 0, 0, 0))
    assert frame[28:] == sha256(KEY + frame[:28]).digest()[:6]
    reader = sender(KEY, 0)
    (message,) = reader.parse_buffer(frame)
    assert message.get_signed()


@pytest.mark.parametrize("flavour", Flavour)
@pytest.mark.parametrize("number", HANDLED)
def test_only_what_is_rightly_signed_changes_anything(flavour: Flavour, number: int) -> None:
    if number not in READY[flavour]._handlers:
        pytest.skip("no message of this flavour")
    changes_key = number == mavlink.MAVLINK_MSG_ID_SETUP_SIGNING
    endpoint, message = signed_endpoint(flavour) if changes_key else READY[flavour], plain_message(number)
    stamp = endpoint.signer.timestamp + 1
    good = frame_of(message, KEY, stamp)
    bad_end = bytearray(good)
    bad_end[-1] ^= 1
    other_link = bytearray(good)
    other_link[-13] ^= 1
    refused = {
        "unsigned": frame_of(message, None),
        "by another key": frame_of(message, OTHER, stamp + 1),
        "by another key, from the future": frame_of(message, OTHER, NOW * 2),
        "with a damaged signature": bytes(bad_end),
        "with another link id": bytes(other_link),
        "too old": frame_of(message, KEY, stamp - MINUTE - 2),
        "cut": good[:-13],
    }
    if number <= 255:
        refused["in MAVLink 1"] = message.pack(sender(None), force_mavlink1=True)
    before = state(endpoint)
    for how, frame in refused.items():
        assert endpoint.receive("a", frame) == 0, how
        assert state(endpoint) == before, how
    called: list[int] = []
    handler = endpoint._handlers[number]

    def spy(*arguments: Any) -> None:  # noqa: ANN401
        called.append(number)
        handler(*arguments)

    endpoint._handlers[number] = spy
    try:
        assert endpoint.receive("a", good) == 1
        assert called == [number]
        after = state(endpoint)
        assert after != before
        assert endpoint.receive("a", good) == 0, "replayed"
        assert endpoint.receive("a", frame_of(message, KEY, stamp - 1)) == 0, "older"
        assert state(endpoint) == after
    finally:
        endpoint._handlers[number] = handler


CHANGES = {
    "mode": mavlink.MAVLink_set_mode_message(1, 1, 4),
    "parameter": mavlink.MAVLink_param_set_message(1, 1, b"FS_GCS_ENABLE", 1.0, 9),
    "home": mavlink.MAVLink_set_home_position_message(
        1, 473_000_000, 85_000_000, 500_000, *(0,) * 3, (1, 0, 0, 0), 0, 0, 0
    ),
    "plan": mavlink.MAVLink_mission_count_message(1, 1, 3, 0),
    "streams": mavlink.MAVLink_request_data_stream_message(1, 1, 0, 4, 1),
}


@pytest.mark.parametrize("what", CHANGES)
def test_what_a_signed_request_changes_an_unsigned_one_does_not(what: str) -> None:
    endpoint = signed_endpoint()
    looks: dict[str, Callable[[], Any]] = {
        "mode": lambda: endpoint.vehicle.autopilot.mode,
        "parameter": lambda: endpoint.vehicle.parameters["FS_GCS_ENABLE"],
        "home": lambda: endpoint.vehicle.autopilot.home,
        "plan": lambda: snapshot(endpoint._plans, without=frozenset(("_host",))),
        "streams": lambda: dict(endpoint._links["a"].streams._intervals_us),
    }
    before = looks[what]()
    endpoint.receive("a", frame_of(CHANGES[what], None))
    endpoint.receive("a", frame_of(CHANGES[what], OTHER))
    assert looks[what]() == before
    endpoint.receive("a", frame_of(CHANGES[what], KEY))
    assert looks[what]() != before


def test_a_stranger_on_a_link_that_requires_signing_is_not_even_learned() -> None:
    endpoint = signed_endpoint()
    endpoint.receive("a", frame_of(plain_message(0), None))
    assert not endpoint._router._routes
    endpoint.receive("b", sender_frame := mavlink.MAVLink_heartbeat_message(6, 8, 0, 0, 4, 3).pack(sender(None)))
    assert endpoint.outgoing("a") == [sender_frame]  # passed on as it came


def test_what_a_radio_says_of_its_link_is_passed_on_to_nobody() -> None:
    endpoint = signed_endpoint(policy=SigningPolicy.ALLOWED)
    frame = mavlink.MAVLink_radio_status_message(1, 1, 1, 1, 1, 0, 0).pack(sender(None, system=51, component=68))
    assert endpoint.receive("a", frame) == 1
    assert endpoint.outgoing("b") == []


@pytest.mark.parametrize(
    ("policy", "heard"),
    [
        (SigningPolicy.REQUIRED, [0, 0, 1, 0]),
        (SigningPolicy.ALLOWED, [1, 0, 1, 1]),
        (SigningPolicy.OFF, [1, 1, 1, 1]),
    ],
)
def test_policies(policy: SigningPolicy, heard: list[int]) -> None:
    endpoint = signed_endpoint(policy=policy)
    timesync = mavlink.MAVLink_timesync_message(0, 7)
    frames = [
        frame_of(timesync, None),
        frame_of(timesync, OTHER),
        frame_of(timesync, KEY),
        timesync.pack(sender(None), force_mavlink1=True),
    ]
    assert [endpoint.receive("a", frame) for frame in frames] == heard
    answers = b"".join(endpoint.outgoing("a"))
    assert len(answers) > 0
    assert (answers[2] & 1 == 1) == (policy is not SigningPolicy.OFF)


def test_mavlink_1_is_answered_where_signing_allows_it_and_never_where_it_is_required() -> None:
    beat = mavlink.MAVLink_timesync_message(0, 7)
    for policy, magic in ((SigningPolicy.ALLOWED, 0xFE), (SigningPolicy.OFF, 0xFE)):
        endpoint = signed_endpoint(policy=policy)
        endpoint.receive("a", beat.pack(sender(None), force_mavlink1=True))
        assert endpoint.outgoing("a")[0][0] == magic
    signer = Signer()
    link = Link("a", system_id=1, signer=signer)
    link.decode(beat.pack(sender(None), force_mavlink1=True))
    assert link.speaks_v1
    signer.install(KEY)
    link.send(beat)
    (frame,) = link.drain()
    assert (frame[0], frame[2] & 1) == (0xFD, 1)


def test_timestamps_rise_over_all_links_and_never_fall_behind_the_clock() -> None:
    now = [100]
    signer = Signer(KEY, now=lambda: now[0])
    assert [signer.next_timestamp() for _ in range(3)] == [100, 101, 102]
    now[0] = 1000
    assert signer.next_timestamp() == 1000
    now[0] = 5  # a clock that is set back
    assert signer.next_timestamp() == 1001
    frame = frame_of(plain_message(0), KEY, 5000)
    assert signer.accepts(frame)
    assert signer.next_timestamp() == 5001


def test_what_is_sent_last_is_signed_last() -> None:
    link = Link("a", system_id=1, signer=Signer(KEY))
    link.send_last(mavlink.MAVLink_ping_message(1_000_000, 7, 0, 0))
    link.send(mavlink.MAVLink_system_time_message(0, 1000))
    (datagram,) = link.closed(link.drain())
    heard = Link("b", system_id=255, signer=Signer(KEY)).decode(datagram)
    assert [message.get_type() for message in heard] == ["SYSTEM_TIME", "PING"]


def test_no_timestamp_is_given_before_it_is_reserved_and_none_twice_over_restarts() -> None:
    kept = [0]
    given: list[int] = []
    for _ in range(3):
        signer = Signer(KEY, now=lambda: 50, timestamp=kept[0], on_reserve=lambda stamp: kept.__setitem__(0, stamp))
        for _ in range(5):
            given.append(signer.next_timestamp())
            assert given[-1] <= kept[0]
    assert given == sorted(set(given))


def test_a_forged_frame_from_the_future_locks_nobody_out() -> None:
    signer = Signer(KEY, now=lambda: NOW)
    assert not signer.accepts(frame_of(plain_message(0), OTHER, 2 * NOW))
    assert signer.accepts(frame_of(plain_message(0), KEY, NOW + 1))


def test_streams_are_told_apart_by_system_component_and_link() -> None:
    signer = Signer(KEY, now=lambda: NOW)
    for system, component, link in ((255, 190, 0), (254, 190, 0), (255, 191, 0), (255, 190, 1)):
        mav = sender(KEY, NOW, system=system, component=component)
        mav.signing.link_id = link
        frame = plain_message(0).pack(mav)
        assert signer.accepts(frame)
        assert not signer.accepts(frame)


def test_a_new_stream_may_be_a_minute_late_and_no_more() -> None:
    for late, accepted in ((MINUTE, True), (MINUTE + 1, False)):
        assert Signer(KEY, now=lambda: NOW).accepts(frame_of(plain_message(0), KEY, NOW - late)) is accepted


def test_the_memory_of_streams_is_bounded_and_forgets_none() -> None:
    signer = Signer(KEY, now=lambda: NOW)
    frames = [plain_message(0).pack(sender(KEY, NOW, system=1 + i % 250, component=1 + i // 250)) for i in range(300)]
    assert sum(signer.accepts(frame) for frame in frames) == 256
    assert not any(signer.accepts(frame) for frame in frames)


@tried(200)
@given(st.integers(0, 8 * 34 - 1))
def test_a_flipped_bit_anywhere_makes_a_signed_frame_worthless(bit: int) -> None:
    frame = bytearray(frame_of(mavlink.MAVLink_heartbeat_message(6, 8, 0, 0, 4, 3), KEY))
    assert len(frame) == 34
    frame[bit // 8] ^= 1 << bit % 8
    link = Link("a", system_id=1, signer=Signer(KEY, now=lambda: NOW))
    assert link.decode(bytes(frame)) == []
    assert link.unknown == []


def setup_signing(key: bytes, *, system: int = 1, component: int = 1, timestamp: int = NOW) -> Message:
    return mavlink.MAVLink_setup_signing_message(system, component, list(key), timestamp)


def test_a_key_is_given_over_a_secure_line_only_to_one_and_on_the_ground() -> None:
    for is_secure, message, taken in (
        (True, setup_signing(OTHER), True),
        (True, setup_signing(OTHER, component=0), True),
        (True, setup_signing(OTHER, system=0), False),
        (True, setup_signing(OTHER, system=2), False),
        (True, setup_signing(OTHER, component=7), False),
        (True, setup_signing(bytes(32)), False),
        (False, setup_signing(OTHER), False),
    ):
        endpoint = endpoint_of(Flavour.ARDUPILOT)
        kept: list[bytes | None] = []
        endpoint.key_setup.on_key = kept.append
        endpoint.add_link("a", is_secure=is_secure)
        endpoint.add_link("b", Rates.SILENT)
        endpoint.receive("a", frame_of(message, None))
        assert (endpoint.signer.key == OTHER) == taken
        assert kept == ([OTHER] if taken else [])
        assert endpoint.outgoing("b") == []  # keys go nowhere else
    endpoint = endpoint_of(Flavour.ARDUPILOT)
    endpoint.add_link("a", is_secure=True)
    while not endpoint.vehicle.autopilot.armed:
        endpoint.advance()
        endpoint.vehicle.autopilot.arm(force=True)
    assert endpoint.vehicle.autopilot.armed
    endpoint.receive("a", frame_of(setup_signing(OTHER), None))
    assert endpoint.signer.key is None


def test_a_key_is_replaced_and_removed_by_who_holds_it() -> None:
    endpoint = signed_endpoint()
    endpoint.receive("a", frame_of(setup_signing(OTHER), None))
    keys = [endpoint.signer.key]
    endpoint.receive("a", frame_of(setup_signing(OTHER), KEY))
    keys.append(endpoint.signer.key)
    later = endpoint.signer.timestamp + 10  # each frame that was sent has its own
    assert endpoint.receive("a", frame_of(plain_message(0), KEY, later)) == 0
    endpoint.receive("a", frame_of(setup_signing(bytes(32), timestamp=0), OTHER, later))
    assert [*keys, endpoint.signer.key] == [KEY, OTHER, None]
    assert endpoint.receive("a", frame_of(plain_message(0), None)) == 1


def test_a_key_has_32_bytes() -> None:
    with pytest.raises(ValueError, match="32"):
        Signer(b"short")
