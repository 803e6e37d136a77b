"""Numbers in messages: whoever copies one has the number that was meant."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from mission.decimals import decimal, measure
from mission.spec.scalars import plain_value


@pytest.mark.parametrize(
    ("value", "text"),
    [
        (131.7625, "131.7625"),
        (5412345.67, "5412345.67"),
        (34.999999, "34.999999"),
        (94.15 + 1e-14, "94.15"),
        (1e6, "1000000"),
        (-1e6, "-1000000"),
        (1e-5, "0.00001"),
        (10**30, "1" + "0" * 30),
        (-0.0, "0"),
        (-1e-12, "0"),
        (20, "20"),
    ],
)
def test_all_digits_and_no_exponent(value: float, text: str) -> None:
    assert decimal(value) == text


@pytest.mark.parametrize(
    ("value", "text"), [(1234.5, "1230"), (0.0041234, "0.00412"), (5000.0, "5000"), (1e-6, "0.000001")]
)
def test_measures_have_three_digits(value: float, text: str) -> None:
    assert measure(value) == text


@given(st.floats(-1e7, 1e7))
def test_a_copied_number_is_within_a_nanometre(value: float) -> None:
    read = plain_value(decimal(value))
    assert isinstance(read, int | float)
    assert abs(read - value) <= 1e-9
