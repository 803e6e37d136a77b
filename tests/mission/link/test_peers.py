"""Who is answered on a port that anyone may call."""

from typing import Any

from hypothesis import given
from hypothesis import strategies as st
from pymavlink.dialects.v20 import ardupilotmega as mavlink

from mission.link.peers import MOST_PEERS, SILENT_S, Peers
from mission.link.signing import Signatures

_KEY = bytes(range(32))
_VEHICLE = ("127.0.0.1", 14550)


def _beat(component: int = 1, key: bytes | None = None) -> bytes:
    mav = mavlink.MAVLink(None, srcSystem=1, srcComponent=component)
    if key is not None:
        mav.signing.secret_key, mav.signing.sign_outgoing, mav.signing.timestamp = key, True, 10**13
    message: Any = mavlink.MAVLink_heartbeat_message(2, 3, 81, 4, 3, 3)
    return bytes(message.pack(mav))


def _stranger(number: int) -> tuple[object, ...]:
    return ("192.0.2.1", number)


def test_a_vehicle_that_is_heard_is_answered_however_many_strangers_call() -> None:
    peers = Peers()
    for second in range(60):
        assert peers.take(_VEHICLE, _beat(), float(second))
        for number in range(100):
            peers.take(_stranger(100 * second + number), _beat(), second + 0.005 * number)
        present = peers.present(second + 0.6)
        assert _VEHICLE in present
        assert len(present) <= MOST_PEERS


def test_what_speaks_no_mavlink_or_is_no_autopilot_is_neither_heard_nor_answered() -> None:
    peers = Peers()
    assert not peers.take(_stranger(1), b"GET / HTTP/1.1", 0.0)
    assert not peers.take(_stranger(2), _beat(component=190), 0.0)
    assert not peers.take(_stranger(3), _beat()[:-1] + b"?", 0.0)
    assert peers.take(_VEHICLE, b"noise" + _beat(component=190) + _beat(), 0.0)
    assert peers.present(0.0) == (_VEHICLE,)


def test_with_a_key_strangers_take_no_place_before_the_vehicle_comes() -> None:
    peers = Peers(Signatures(_KEY, lambda: 10**13).is_genuine)
    for number in range(100):
        assert not peers.take(_stranger(number), _beat(key=bytes(32) if number % 2 else None), 0.0)
    assert peers.take(_VEHICLE, _beat(key=_KEY), 0.0)


def test_who_has_fallen_silent_makes_room() -> None:
    peers = Peers()
    for number in range(MOST_PEERS):
        assert peers.take(_stranger(number), _beat(), 0.0)
    assert not peers.take(_VEHICLE, _beat(), SILENT_S)
    assert peers.take(_VEHICLE, _beat(), SILENT_S + 0.1)
    assert peers.present(SILENT_S + 0.1) == (_VEHICLE,)


@given(st.lists(st.tuples(st.integers(0, 40), st.floats(0.0, 3.0)), max_size=200))
def test_nobody_is_displaced_before_the_time(calls: list[tuple[int, float]]) -> None:
    peers, heard, now_s = Peers(), dict[int, float](), 0.0
    for number, pause_s in calls:
        now_s += pause_s
        if peers.take(_stranger(number), _beat(), now_s):
            heard[number] = now_s
        due = {_stranger(n) for n, at_s in heard.items() if now_s - at_s <= SILENT_S}
        assert set(peers.present(now_s)) == due
        assert len(due) <= MOST_PEERS
