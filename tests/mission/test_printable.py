"""Text from outside: what shows stays, what does not is told by its code."""

import unicodedata

import pytest
from hypothesis import given
from hypothesis import strategies as st

from mission.link.texts import TextAssembler
from mission.link.values import Words
from mission.printable import printable, shows


@pytest.mark.parametrize(
    ("text", "shown"),
    [
        ("Überflug über S1", "Überflug über S1"),
        ("\x1b[31mred\x07", "\\x1b[31mred\\x07"),
        ("K1\u202egpj.exe", "K1\\u202egpj.exe"),
        ("\u2066S1\u2069", "\\u2066S1\\u2069"),
        ("S\u200b1", "S\\u200b1"),
        ("S1\ufe0f", "S1\\ufe0f"),
        ("a\u3164b", "a\\u3164b"),
        ("tag\U000e0041", "tag\\U000e0041"),
        ("one\ntwo", "one\\ntwo"),
        ("half \ud800", "half \\ud800"),
    ],
)
def test_what_does_not_show_is_told_by_its_code(text: str, shown: str) -> None:
    assert printable(text) == shown


def test_line_ends_stay_where_they_are_meant() -> None:
    assert printable("one\n\ttwo\x1b", keep="\n\t") == "one\n\ttwo\\x1b"


@given(st.text())
def test_nothing_is_left_that_a_terminal_obeys(text: str) -> None:
    shown = printable(text)
    assert all(unicodedata.category(c)[0] != "C" and shows(c) for c in shown)
    assert shown.isprintable()
    assert printable(shown) == shown


def test_what_a_vehicle_says_is_no_exception() -> None:
    (said,) = TextAssembler().take(Words(2, "PreArm\u202e: \u2800ok\x1b[2J", 0, 0), 0.0)
    assert said.text == "PreArm :  ok [2J"
