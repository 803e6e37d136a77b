"""Commands: repeated until answered, so often and no more."""

import math

from mission.link.requests import ANSWER_WITHIN_S, ATTEMPTS, RequestChannel
from mission.link.values import Acknowledgement, Command, Result

ARM = Command("arm", 400, (1.0,))


def answer(result: Result, command: int = 400, target: tuple[int, int] = (255, 191)) -> Acknowledgement:
    return Acknowledgement(command, result, *target)


def test_repeats_until_given_up() -> None:
    channel = RequestChannel(255, 191)
    channel.ask(ARM, 0.0)
    attempts, now = [], 0.0
    while (ended := channel.unanswered(now)) is None:
        due = channel.due(now)
        if due is not None:
            attempts.append(due[1])
        now += channel.wait_s(now)
    assert attempts == list(range(ATTEMPTS))
    assert ended.result is None
    assert now >= ATTEMPTS * ANSWER_WITHIN_S - 1e-9
    assert not channel.busy
    assert math.isinf(channel.wait_s(now))


def test_an_answer_ends_it() -> None:
    channel = RequestChannel(255, 191)
    channel.ask(ARM, 0.0)
    channel.due(0.0)
    ended = channel.take(answer(Result.ACCEPTED), 0.1)
    assert ended is not None
    assert ended.result is Result.ACCEPTED
    assert channel.due(9.0) is None
    assert channel.take(answer(Result.FAILED), 0.2) is None  # a doubled answer


def test_answers_to_others_and_to_other_commands_are_not_ours() -> None:
    channel = RequestChannel(255, 191)
    channel.ask(ARM, 0.0)
    channel.due(0.0)
    assert channel.take(answer(Result.DENIED, target=(255, 190)), 0.1) is None
    assert channel.take(answer(Result.DENIED, target=(7, 191)), 0.1) is None
    assert channel.take(answer(Result.DENIED, command=22), 0.1) is None
    assert channel.busy
    ended = channel.take(answer(Result.DENIED, target=(0, 0)), 0.1)  # MAVLink 1 does not say whom it answers
    assert ended is not None


def test_a_vehicle_that_works_on_it_is_given_time() -> None:
    channel = RequestChannel(255, 191)
    channel.ask(ARM, 0.0)
    channel.due(0.0)
    assert channel.take(answer(Result.IN_PROGRESS), 0.1) is None
    assert channel.due(2.0) is None
    assert channel.busy
    assert channel.take(answer(Result.ACCEPTED), 3.0) is not None


def test_what_has_happened_is_not_asked_for_again() -> None:
    channel = RequestChannel(255, 191)
    channel.ask(ARM, 0.0)
    channel.forget()
    assert channel.due(1.0) is None
    assert channel.unanswered(100.0) is None
