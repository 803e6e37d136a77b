"""The camera's trigger as the trajectory asks for it: refusals, silence, and the end of it."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from mission.link.photography import Photography
from mission.link.requests import ATTEMPTS, RequestChannel
from mission.link.values import Acknowledgement, Result
from mission.plan.photographs import Photographs
from tests.support.drawn_cases import tried

SELF = (255, 191)
DISTANCE, DIGICAM, RATE = 206, 203, 511
STRETCHES = (Photographs(10.0, 20.0, 5.0), Photographs(25.0, 26.0, None), Photographs(30.0, 40.0, 8.0))


class Bench:
    """A camera that answers each command as it is told to; None is silence."""

    def __init__(self, *answers: Result | None, stretches: tuple[Photographs, ...] = STRETCHES) -> None:
        self.photography = Photography(RequestChannel(*SELF), stretches)
        self.answers = list(answers)
        self.heard: list[tuple[int, tuple[float, ...]]] = []
        self.is_on = False
        self.now_s = 0.0

    def advance(self, trajectory_s: float | None, seconds: float = 0.0) -> None:
        """Let time pass in steps of 0.05 s; the trajectory stands."""
        photography, channel = self.photography, self.photography.channel
        for _ in range(1 + round(seconds / 0.05)):
            if (answer := channel.unanswered(self.now_s)) is not None:
                photography.take(answer, self.now_s)
            photography.advance(trajectory_s, self.now_s)
            if (due := channel.due(self.now_s)) is not None:
                self._hear(due[0].number, due[0].parameters)
            self.now_s += 0.05

    def _hear(self, number: int, parameters: tuple[float, ...]) -> None:
        self.heard.append((number, parameters))
        result = Result.ACCEPTED if number == RATE or not self.answers else self.answers.pop(0)
        if number == DISTANCE and result is Result.ACCEPTED:
            self.is_on = bool(parameters)
        if result is not None:
            answer = self.photography.channel.take(Acknowledgement(number, result, *SELF), self.now_s)
            assert answer is not None
            self.photography.take(answer, self.now_s)

    def unfinished(self) -> bool:
        return self.photography.unfinished

    @property
    def asked(self) -> list[tuple[int, tuple[float, ...]]]:
        return [each for each in self.heard if each[0] != RATE]


def test_each_stretch_is_switched_on_with_a_picture_and_off_again() -> None:
    bench = Bench()
    for tenths in range(500):
        bench.advance(tenths / 10.0)
    on, one, off = (DISTANCE, (5.0, 0.0, 1.0)), (DIGICAM, (0.0, 0.0, 0.0, 0.0, 1.0)), (DISTANCE, ())
    assert bench.asked == [on, off, one, (DISTANCE, (8.0, 0.0, 1.0)), off]
    assert not bench.unfinished()
    assert bench.photography.trouble == ""


def test_without_stretches_nothing_is_asked() -> None:
    bench = Bench(stretches=())
    bench.advance(15.0, 5.0)
    bench.advance(None, 5.0)
    assert not bench.heard


def test_stretches_that_meet_are_not_switched_off_between() -> None:
    bench = Bench(stretches=(Photographs(1.0, 2.0, 5.0), Photographs(2.0, 3.0, 7.0)))
    for trajectory_s in (1.5, 2.5, 3.5):
        bench.advance(trajectory_s)
    assert [parameters[:1] for _, parameters in bench.asked] == [(5.0,), (7.0,), ()]


@pytest.mark.parametrize("result", [Result.UNSUPPORTED, Result.DENIED])
def test_a_refusal_for_good_is_told_and_the_next_stretch_is_tried(result: Result) -> None:
    bench = Bench(result)
    bench.advance(15.0, 8.0)
    assert len(bench.asked) == 1
    assert not bench.unfinished()
    words = result.name.lower()
    assert bench.photography.trouble == f"the camera's command to photograph every 5 m was refused ({words})"
    bench.advance(22.0, 1.0)
    assert len(bench.asked) == 1  # nothing is on
    bench.advance(32.0, 1.0)
    assert bench.asked[-1] == (DISTANCE, (8.0, 0.0, 1.0))
    assert bench.is_on


def test_a_refusal_that_may_pass_is_asked_again_once_a_second() -> None:
    bench = Bench(Result.TEMPORARILY_REJECTED, Result.FAILED)
    bench.advance(15.0, 3.0)
    assert len(bench.asked) == 3
    assert bench.is_on
    assert "temporarily rejected" in bench.photography.trouble


def test_a_command_without_an_answer_may_have_been_heard_and_is_switched_off() -> None:
    bench = Bench(*[None] * ATTEMPTS)
    bench.advance(15.0, 6.0)
    assert len(bench.asked) == ATTEMPTS
    assert bench.unfinished()
    assert "was not answered" in bench.photography.trouble
    bench.advance(22.0)
    assert bench.asked[-1] == (DISTANCE, ())
    assert not bench.unfinished()


def test_switching_off_is_given_up_in_the_end_and_that_is_said() -> None:
    bench = Bench(Result.ACCEPTED, *[None] * 100)
    bench.advance(15.0)
    assert bench.unfinished()
    bench.advance(None, 3.0)
    assert bench.unfinished()
    bench.advance(None, 10.0)
    assert not bench.unfinished()
    assert len(bench.asked) == 1 + 2 * ATTEMPTS
    assert bench.photography.trouble.endswith("whether the camera's trigger is off is not known")
    bench.advance(32.0, 0.1)  # a camera that comes back is used again
    assert bench.unfinished()


def test_a_flight_that_ends_while_a_stretch_is_being_switched_on_switches_it_off() -> None:
    bench = Bench(None)
    bench.advance(15.0)
    bench.advance(None)
    assert bench.asked == [(DISTANCE, (5.0, 0.0, 1.0)), (DISTANCE, ())]


ANSWERS = st.sampled_from([Result.ACCEPTED, Result.ACCEPTED, Result.TEMPORARILY_REJECTED, Result.DENIED, None])


@tried(60)
@given(
    answers=st.lists(ANSWERS, max_size=12),
    way=st.lists(st.tuples(st.none() | st.floats(0.0, 45.0), st.floats(0.0, 4.0)), max_size=8),
)
def test_whatever_happens_the_trigger_is_off_in_the_end_or_it_is_said_that_it_may_not_be(
    answers: list[Result | None], way: list[tuple[float | None, float]]
) -> None:
    bench = Bench(*answers)
    for trajectory_s, seconds in way:
        bench.advance(trajectory_s, seconds)
    bench.advance(None, 20.0)
    assert not bench.unfinished()
    if bench.is_on:
        assert bench.photography.trouble.endswith("is not known")
