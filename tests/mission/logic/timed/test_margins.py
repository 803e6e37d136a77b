"""By how many seconds bounds are kept, and when a verdict was certain."""

import math
from fractions import Fraction
from random import Random

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from mission.logic.formula.parser import parse_timed_formula
from mission.logic.formula.syntax import LONGEST_S
from mission.logic.timed.behaviour import Piece, from_to, so_far, staying
from mission.logic.timed.judge import satisfied
from mission.logic.timed.margins import margin_s, settled_s
from mission.logic.timed.rewriting import positive, tightened
from tests.support.timed_words import counting, random_timed


def flown(*visits: tuple[str, str]) -> list[Piece]:
    """Pieces that begin at so many seconds with the regions named there."""
    times = [Fraction(time) for time, _ in visits]
    letters = [frozenset(regions.split()) for _, regions in visits]
    spans = [from_to(begin, end) for begin, end in zip(times, [*times[1:], times[-1] + 1], strict=True)]
    return [Piece(span, letter, letter) for span, letter in zip(spans, letters, strict=True)]


FLIGHT = flown(("0", "home"), ("10.5", ""), ("100.25", "S1"), ("110", ""), ("150", "S2"))


@pytest.mark.parametrize(
    ("text", "margin", "settled"),
    [
        ("F[0,120] S1", 19.75, 100.25),
        ("F[0,100] S1", -0.25, 100.0),
        ("G[0,60] !K", math.inf, 60.0),
        ("G[0,100] !S1", 0.249, 100.0),  # at 100.25 itself S1 holds
        ("G[0,120] !S1", -19.751, 100.25),
        ("!S1 U[0,90] S2", -math.inf, 90.0),
        ("!K U[0,100] S2", -50.0, 100.0),
        ("G (S1 -> F[0,45] S2)", -4.75, 145.25),
        ("F K", -math.inf, None),
        ("F[0,3] K", -math.inf, 3.0),
        ("G F[0,30] S2", -120.0, 30.0),
        ("G F[0,150] S2", 0.0, None),
    ],
)
def test_margins_by_hand(text: str, margin: float, settled: float | None) -> None:
    formula = parse_timed_formula(text)
    assert margin_s(staying(FLIGHT), formula) == margin
    assert settled_s(FLIGHT, formula) == settled


@settings(max_examples=40, deadline=None)
@given(st.randoms(use_true_random=False))
def test_a_margin_can_be_taken_from_all_bounds_and_no_more(random: Random) -> None:
    formula = positive(parse_timed_formula(random_timed(random, 4, ("home", "S1", "S2"))))
    behaviour = staying(FLIGHT)
    margin = margin_s(behaviour, formula)
    if math.isfinite(margin):
        exact = round(Fraction(margin) * 1000) * Fraction(1, 1000)
        assert satisfied(behaviour, tightened(formula, exact)) is True
        assert satisfied(behaviour, tightened(formula, exact + Fraction(1, 1000))) is not True


@pytest.mark.parametrize(
    ("text", "window", "margin", "settled"),
    [
        ("G !S1", (60, 180), -50.0, 100.25),  # it would have to begin when S1 is left
        ("G !S1", (0, 60), 40.249, 60.0),
        ("G !S1", (115, LONGEST_S), 5.0, None),
        ("F S1", (60, 180), 49.999, 100.25),
        ("F S1", (104, 106), 1.0, 104.0),
        ("F S1", (111, 120), -1.001, 120.0),
        ("F S2", (149, LONGEST_S), math.inf, 150.0),
        ("G (S1 -> F S2)", (0, 160), 10.0, 160.0),
    ],
)
def test_margins_of_what_counts_for_a_time_only(
    text: str, window: tuple[int, int], margin: float, settled: float | None
) -> None:
    bounds = Fraction(window[0]), Fraction(window[1])
    formula = counting(parse_timed_formula(text), dict.fromkeys(("S1", "S2"), bounds))
    assert (margin_s(staying(FLIGHT), formula), settled_s(FLIGHT, formula)) == (margin, settled)


def test_while_a_flight_lasts_a_bound_is_open_until_it_is_settled() -> None:
    formula = parse_timed_formula("F[0,120] S1 & G[0,60] !K")
    begun = FLIGHT[:2]
    assert satisfied(so_far(begun, Fraction(20)), formula) is None
    # If nothing else comes it is missed when the bound is over.
    assert settled_s(begun, formula, from_s=Fraction(20)) == 120.0
    assert satisfied(so_far(FLIGHT[:3], Fraction(101)), formula) is True


def test_who_looks_from_later_on_finds_what_is_settled_by_then() -> None:
    assert settled_s(FLIGHT, parse_timed_formula("F[0,120] S1"), from_s=Fraction(130)) == 130.0
