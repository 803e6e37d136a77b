"""What waits to be handled: states are replaced by newer ones, all else is kept, in order."""

import pytest
from pymavlink.dialects.v20 import ardupilotmega as mavlink

from mission.link.framing import Frame, split
from mission.link.inbox import Inbox


def frames(*messages: object, system: int = 1, old: bool = False) -> list[Frame]:
    mav = mavlink.MAVLink(None, srcSystem=system, srcComponent=1)
    return split(b"".join(bytes(message.pack(mav, force_mavlink1=old)) for message in messages))[0]  # type: ignore[attr-defined]


def attitude(time_ms: int) -> object:
    return mavlink.MAVLink_attitude_message(time_ms, 0, 0, 0, 0, 0, 0)


def position(time_ms: int) -> object:
    return mavlink.MAVLink_local_position_ned_message(time_ms, 1, 2, 3, 0, 0, 0)


def text(words: str) -> object:
    return mavlink.MAVLink_statustext_message(4, words.encode())


@pytest.mark.parametrize("old", [False, True])
def test_of_a_state_the_newest_waits_and_all_else_in_order(*, old: bool) -> None:
    inbox = Inbox()
    said = [attitude(1), position(1), text("a"), attitude(2), position(2), text("a"), attitude(3)]
    came = frames(*said, old=old)
    for at_s, frame in enumerate(came):
        inbox.put(frame, float(at_s))
    assert [inbox.take() for _ in range(len(inbox))] == [(came[at], float(at)) for at in (1, 2, 4, 5, 6)]
    assert inbox.left_out == 2


def test_a_state_has_its_turn_however_much_waits() -> None:
    inbox = Inbox()
    handled = []
    for turn in range(100):  # two come and one is handled, so that more and more waits
        for frame in frames(mavlink.MAVLink_estimator_status_message(turn, 0, 0, 0, 0, 0, 0, 0, 0, 0), position(turn)):
            inbox.put(frame, float(turn))
        handled.append(inbox.take()[0].number)
    assert handled.count(mavlink.MAVLINK_MSG_ID_ESTIMATOR_STATUS) > 5


def test_of_each_sender_and_only_what_waits() -> None:
    inbox = Inbox()
    (ours,), (theirs,) = frames(attitude(1)), frames(attitude(1), system=2)
    inbox.put(ours, 0.0)
    inbox.put(theirs, 0.0)
    assert len(inbox) == 2
    assert inbox.take()[0] == ours
    inbox.put(ours, 1.0)
    assert [inbox.take() for _ in range(2)] == [(theirs, 0.0), (ours, 1.0)]
    assert inbox.left_out == 0
    with pytest.raises(KeyError):
        inbox.take()


def test_what_nobody_reads_is_bounded_and_counted(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("mission.link.inbox._MOST", 3)
    inbox = Inbox()
    came = frames(*(position(time_ms) for time_ms in range(5)))
    for frame in came:
        inbox.put(frame, 0.0)
    assert [inbox.take()[0] for _ in range(len(inbox))] == came[2:]
    assert inbox.left_out == 2
