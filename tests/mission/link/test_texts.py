"""Texts in pieces."""

from hypothesis import given
from hypothesis import strategies as st

from mission.link.texts import Text, TextAssembler
from mission.link.values import LocalPosition, Words
from mission.link.vehicle_state import VehicleState

LONG = "PreArm: a sentence that is a good deal longer than the fifty bytes that one message can hold, twice over"


def pieces(text: str, group: int = 5, severity: int = 2) -> list[Words]:
    return [Words(severity, text[i : i + 50], group, i // 50) for i in range(0, len(text) + 1, 50)]


def test_a_short_text_is_there_at_once() -> None:
    assert TextAssembler().take(Words(6, "Arming motors", 0, 0), 0.0) == [Text(6, "Arming motors")]


@given(st.permutations(pieces(LONG)))
def test_pieces_in_any_order_make_one_text(order: list[Words]) -> None:
    assembler = TextAssembler()
    said = [text for words in order for text in assembler.take(words, 0.0)]
    assert said == [Text(2, LONG)]


def test_a_piece_that_comes_twice_counts_once() -> None:
    assembler = TextAssembler()
    first, *rest = pieces(LONG)
    said = [text for words in (first, first, *rest) for text in assembler.take(words, 0.0)]
    assert said == [Text(2, LONG)]


def test_a_text_that_fills_its_last_piece_ends_with_an_empty_one() -> None:
    assembler = TextAssembler()
    text = "x" * 100
    assert [said for words in pieces(text) for said in assembler.take(words, 0.0)] == [Text(2, text)]


def test_a_lost_piece_is_not_waited_for_for_ever() -> None:
    assembler = TextAssembler()
    first, _, last = pieces(LONG)
    assert assembler.take(first, 0.0) == []
    assert assembler.take(last, 0.1) == []
    assert assembler.overdue(0.5) == []
    assert assembler.overdue(2.0) == [Text(2, LONG[:50] + "..." + LONG[100:])]
    assert assembler.overdue(9.0) == []


def test_what_a_terminal_would_obey_is_taken_out() -> None:
    (text,) = TextAssembler().take(Words(2, "Preflight\x1b[2J Fail\t", 0, 0), 0.0)
    assert text.text == "Preflight [2J Fail"


@given(st.lists(st.builds(Words, st.integers(0, 7), st.text(max_size=50), st.integers(0, 40), st.integers(0, 255))))
def test_memory_is_bounded_whatever_comes(stream: list[Words]) -> None:
    assembler = TextAssembler()
    for i, words in enumerate(stream):
        assembler.take(words, 0.01 * i)
    assert len(assembler._pending) <= 9


def test_how_long_ago_something_was_said_goes_by_the_vehicles_clock() -> None:
    state = VehicleState()
    for i in range(200):  # at twenty times real time, 40 s of the vehicle are two here
        state.take(LocalPosition(200 * i, (0.0, 0.0, 0.0), (0.0, 0.0, 0.0)), 0.01 * i)
        if i == 100:
            state.take(Words(4, "GCS Failsafe", 0, 0), 0.01 * i)
    assert state.words_since(19.9) == "GCS Failsafe"
    assert state.told_failsafe_since(19.9)
    assert not state.words_since(20.5)
    assert not state.told_failsafe_since(20.5)
