"""Turns of a vehicle in lock-step: taken whole, answered in order, timed by what they tell."""

from collections.abc import Sequence
from typing import Any

import pytest
from pymavlink.dialects.v20 import ardupilotmega as mavlink

from mission.link.identity import LinkOptions
from mission.link.lockstep import STILL_S, LockstepLink
from mission.link.session import Session


class Wire:
    """A transport that gives what it was told, a list for each call, and keeps what is sent."""

    def __init__(self, *batches: Sequence[bytes]) -> None:
        self.batches = list(batches)
        self.sent: list[bytes] = []

    def receive(self, _within_s: float) -> list[bytes]:
        return list(self.batches.pop(0)) if self.batches else []

    def send(self, data: bytes) -> None:
        self.sent.append(data)

    def close(self) -> None: ...


class Wall:
    def __init__(self) -> None:
        self.time_s = 500.0

    def now_s(self) -> float:
        return self.time_s


def packed(*messages: Any, component: int = 1) -> bytes:  # noqa: ANN401 - pymavlink ships no types
    mav = mavlink.MAVLink(None, srcSystem=1, srcComponent=component)
    return b"".join(bytes(message.pack(mav)) for message in messages)


def ping(time_s: float, number: int, *target: int) -> Any:  # noqa: ANN401 - the same
    return mavlink.MAVLink_ping_message(round(time_s * 1e6), number, *(target or (0, 0)))


def position(time_s: float) -> Any:  # noqa: ANN401 - the same
    return mavlink.MAVLink_local_position_ned_message(round(time_s * 1e3), 1, 2, -3, 0, 0, 0)


def heartbeat() -> Any:  # noqa: ANN401 - the same
    return mavlink.MAVLink_heartbeat_message(mavlink.MAV_TYPE_QUADROTOR, mavlink.MAV_AUTOPILOT_PX4, 0, 0, 3, 3)


def test_a_turn_is_taken_whole_and_its_time_is_the_pings() -> None:
    first, second = packed(position(1.00)), packed(position(1.03), ping(1.04, 7))
    wall, wire = Wall(), Wire([], [first], [], [second])
    link = LockstepLink(wire, wall)
    for _ in range(3):
        assert link.receive(0.0) == []
        assert link.now_s() == 0.0
        wall.time_s += 2.0
    assert link.receive(9.0) == [first, second]
    wall.time_s += 2.0
    assert link.now_s() == pytest.approx(1.04, abs=1e-12)


def test_what_is_asked_again_is_no_further_turn() -> None:
    turn = packed(ping(1.0, 7))
    link = LockstepLink(Wire([turn], [turn], [packed(ping(1.0, 8))]), Wall())
    assert link.receive(0.0) == [turn]
    assert link.receive(0.0) == []
    assert len(link.receive(0.0)) == 1


@pytest.mark.parametrize(
    "data",
    [
        packed(ping(1.0, 7, 255, 191)),
        packed(ping(1.0, 7), component=190),
        packed(ping(1.0, 7), position(1.0)),
        packed(ping(1.0, 7))[:-1],
    ],
    ids=["an answer", "a ground station asks", "not the last", "damaged"],
)
def test_other_pings_end_no_turn(data: bytes) -> None:
    link = LockstepLink(Wire([data]), Wall())
    assert link.receive(0.0) == []
    assert link.now_s() == 0.0


def test_a_vehicle_that_hangs_does_not_stop_the_clock_for_ever_and_it_never_runs_backwards() -> None:
    wall, wire = Wall(), Wire([packed(ping(1.0, 1))])
    link = LockstepLink(wire, wall)
    link.receive(0.0)
    wall.time_s += STILL_S
    assert link.now_s() == 1.0
    wall.time_s += 3.0
    assert link.now_s() == pytest.approx(4.0)
    for time_s, number, shown_s in [(1.5, 2, 4.5), (2.5, 3, 5.5), (0.0, 4, 5.5), (1.0, 5, 6.5)]:
        wire.batches.append([packed(ping(time_s, number))])
        link.receive(0.0)
        assert link.now_s() == pytest.approx(shown_s)


def test_every_ping_for_all_is_answered_once_after_what_else_is_sent() -> None:
    session = Session(needs_origin=False, options=LinkOptions())
    session.receive(packed(ping(0.0, 4)), 0.0)  # before it is known that this is a vehicle
    session.receive(packed(ping(0.0, 5, 255, 191), heartbeat(), ping(0.1, 6)), 0.1)
    session.advance(0.1)
    parser = mavlink.MAVLink(None)
    sent = parser.parse_buffer(b"".join(session.outgoing()))
    kinds = [message.get_type() for message in sent]
    assert kinds[-2:] == ["PING", "PING"]
    assert "HEARTBEAT" in kinds[:-2]
    answers = [(m.time_usec, m.seq, m.target_system, m.target_component) for m in sent[-2:]]
    assert answers == [(0, 4, 1, 1), (100_000, 6, 1, 1)]
    assert session.outgoing() == []


def test_nobody_is_no_one_to_answer() -> None:
    session = Session(needs_origin=False, options=LinkOptions())
    nobody = mavlink.MAVLink(None, srcSystem=0, srcComponent=1)
    session.receive(bytes(ping(0.0, 4).pack(nobody)), 0.0)
    assert session.outgoing() == []
