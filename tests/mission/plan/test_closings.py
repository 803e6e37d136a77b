"""What a flight that is late comes into: compared with the plan flown so much later, judged anew."""

from fractions import Fraction

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from mission.logic.formula.parser import parse_timed_formula
from mission.logic.formula.syntax import Formula, always, negation, proposition
from mission.logic.timed.behaviour import Behaviour, Known
from mission.logic.timed.judge import satisfied
from mission.logic.timed.time_sets import AFTER, BEFORE, NEVER, joined, moved
from mission.plan.closings import ahead, closings, entered

SPANS = st.lists(st.tuples(st.integers(0, 40), st.integers(0, 6)), max_size=4)


def never_k(begin_s: int, end_s: int) -> Formula:
    return always(negation(proposition("K", (Fraction(begin_s), Fraction(end_s)))))


@settings(max_examples=200, deadline=None)
@given(
    spans=SPANS,
    window=st.tuples(st.integers(0, 60), st.integers(1, 20)),
    late=st.integers(0, 30),
    loop_s=st.sampled_from((0, 60)),
)
def test_before_anything_is_flown_it_is_met_where_the_judge_says_so(
    spans: list[tuple[int, int]], window: tuple[int, int], late: int, loop_s: int
) -> None:
    """At 0 all is ahead. What the rest does once more is met, too; a wait of so long is what being late is."""
    inside = joined(((Fraction(a + 1), BEFORE), (Fraction(a + 1 + length), AFTER)) for a, length in sorted(spans))
    formula, begin, end = never_k(window[0], window[0] + window[1]), Fraction(loop_s), Fraction(100)
    (closing,) = closings([formula], Behaviour({"K": Known(inside, inside)}, NEVER, begin, end))
    later = tuple((moved(a, Fraction(late)), moved(b, Fraction(late))) for a, b in inside)
    judged = satisfied(Behaviour({"K": Known(later, later)}, NEVER, begin + late, end + late), formula)
    assert closing.is_met(0.0, float(late)) is (judged is False)


def test_what_was_flown_counts_no_more_and_who_is_inside_goes_on() -> None:
    formula = never_k(20, 30)
    spans = (((Fraction(8), BEFORE), (Fraction(10), AFTER)),)
    found = closings([formula], Behaviour({"K": Known(spans, spans)}, NEVER, Fraction(50), Fraction(60)))
    assert ahead(found, 0.0, 9.0) == ""
    assert ahead(found, 7.9, 11.0) == "K[20,30]"
    assert ahead(found, 9.0, 11.5) == ""
    assert ahead(found, 7.9, 23.0) == ""
    assert entered(found, ["F S", "G !K[20,30]"]) == "K[20,30]"
    assert entered(found, ["F S"]) == ""


@pytest.mark.parametrize("text", ["F[0,5] K", "G[0,5] !K", "G (a -> F[0,5] b)", "G !K"])
def test_what_else_is_asked_for_in_time_is_none(text: str) -> None:
    assert closings([parse_timed_formula(text)], Behaviour({}, NEVER, Fraction(0), Fraction(1))) == ()
