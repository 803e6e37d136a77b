"""Plain scalars: decimal numbers are numbers, true and false are truth, and YAML's surprises are told."""

import pytest

from mission.spec.scalars import Oddity, number_hint, plain_value


@pytest.mark.parametrize(
    ("text", "value"),
    [
        ("0", 0),
        ("-17", -17),
        ("+3", 3),
        ("1.5", 1.5),
        (".5", 0.5),
        ("5.", 5.0),
        ("1.0e+3", 1000.0),
        ("2.5E-1", 0.25),
        ("true", True),
        ("False", False),
        ("", None),
        ("~", None),
        ("null", None),
        ("1e3", 1000.0),
        ("1e-5", 1e-5),
        ("1e-05", 1e-5),
        ("-2.5e4", -25000.0),
        ("1E+2", 100.0),
        ("-.5", -0.5),
        ("e3", "e3"),
        ("1e", "1e"),
        ("1e3 m", "1e3 m"),
        ("01e3", "01e3"),
        ("F (a & b)", "F (a & b)"),
        ("<<", "<<"),
        ("=", "="),
        ("auto", "auto"),
    ],
)
def test_what_is_meant_is_read(text: str, value: object) -> None:
    read = plain_value(text)
    assert read == value
    assert type(read) is type(value)


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("yes", "true"),
        ("On", "true"),
        ("NO", "false"),
        ("off", "false"),
        ("1:30", "sexagesimal"),
        ("1:30.5", "sexagesimal"),
        ("010", "decimal"),
        ("0x1F", "decimal"),
        ("0b11", "decimal"),
        ("1_000", "plain decimal"),
        ("1_000.5", "plain decimal"),
        ("2024-05-01", "date"),
        ("2024-05-01 10:00:00", "date"),
        (".nan", "not finite"),
        ("-.inf", "not finite"),
        ("1.0e+999", "too large"),
        ("1e999", "too large"),
        ("9" * 5000, "plain decimal"),
    ],
)
def test_surprises_are_told(text: str, words: str) -> None:
    read = plain_value(text)
    assert isinstance(read, Oddity)
    assert words in read.found
    assert read.hint


@pytest.mark.parametrize(
    ("text", "hint"),
    [
        ("3,5", "3.5"),
        ("12 m", "12"),
        ("25°", "25"),
        ("fast", ""),
    ],
)
def test_numbers_that_are_text_get_a_hint(text: str, hint: str) -> None:
    assert number_hint(text).endswith(hint)
    assert bool(number_hint(text)) == bool(hint)
