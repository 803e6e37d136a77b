"""The monitor on flights over the paper's domain."""

import math
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from mission.geometry.location import Locator
from mission.logic.formula.parser import parse_formula
from mission.logic.formula.word import LassoWord, satisfies
from mission.monitor.laps import Laps
from mission.monitor.monitor import Monitor, ViolationKind
from mission.monitor.verdict import Verdict
from mission.spec.model import Semantics
from mission.spec.specification import deterministic_of
from tests.support.curves import (
    PAPER_FORMULA,
    PAPER_RUN,
    compiled,
    marked,
    paper_labelling,
    paper_partition,
    paper_path,
    refuting,
)
from tests.support.drawn_cases import tried


def monitor(
    formula: str = PAPER_FORMULA,
    semantics: Semantics = Semantics.STANDARD,
    suffix: tuple[int, ...] = (),
    laps: int = 0,
) -> Monitor:
    labels = paper_labelling()
    whole = deterministic_of(parse_formula(formula), None, labels.letters).whole
    return Monitor(
        Locator(paper_partition()),
        labels,
        satisfied_by=lambda word: satisfies(word, parse_formula(formula)),
        automata=(compiled(formula, labels.letters),),
        whole=whole,
        refutation=refuting(formula, labels.letters),
        semantics=semantics,
        restricted=marked(paper_partition(), (6,)),
        counter=Laps(whole, labels, suffix=suffix),
        laps=laps,
    )


def centre(triangle: int) -> tuple[float, float]:
    x, y = paper_partition().corners_m[triangle].mean(axis=0)
    return float(x), float(y)


def flown(watch: Monitor, *places: tuple[float, float], start_s: float = 0.0) -> Monitor:
    for i, place in enumerate(places):
        assert watch.observe(start_s + i, place)
    return watch


@pytest.mark.parametrize("step_s", [0.5, 3.0, 9.0])
def test_the_planned_path_spells_the_planned_run(step_s: float) -> None:
    path, watch = paper_path(), monitor()
    verdicts = []
    for t in np.arange(0.0, path.duration_s, step_s):
        x, y = path.position(np.array([t]))[0]
        watch.observe(float(t), (float(x), float(y)))
        verdicts.append(watch.verdict)
    assert tuple(visit.triangle for visit in watch.visits) == PAPER_RUN.states
    starts = [segment.start_s for segment in path.segments]
    assert [visit.entered_s for visit in watch.visits] == pytest.approx(starts, abs=step_s)
    assert watch.progress.done == watch.progress.total == 2
    assert set(verdicts) == {Verdict.OPEN}  # K1 can still be entered
    assert watch.verdict_at_end(stays=True).achieved


def test_no_triangle_is_skipped_between_reports() -> None:
    watch = flown(monitor(), (11.0, 9.5), (10.8, 1.0))
    partition = paper_partition()
    visited = [visit.triangle for visit in watch.visits]
    assert len(visited) >= 3
    for t, u in pairwise(visited):
        assert u in partition.neighbours[t]
    times = [visit.entered_s for visit in watch.visits]
    assert times == sorted(times)
    assert 0.0 < times[1] < 1.0


def test_the_papers_semantics_does_not_read_the_first_label() -> None:
    places = (centre(0), centre(8))
    assert flown(monitor("S2"), *places).verdict is Verdict.TRUE
    skipping = flown(monitor("S2", Semantics.PAPER), *places)
    assert skipping.verdict is Verdict.FALSE
    assert skipping.word == (frozenset(),)
    only = flown(monitor("G S2", Semantics.PAPER), centre(0))
    assert only.word == ()
    assert only.verdict_at_end(stays=True).achieved


def test_entering_a_restricted_triangle_is_a_violation_whatever_the_formula() -> None:
    watch = flown(monitor("F R"), centre(2), centre(7))  # straight through K1
    kinds = [violation.kind for violation in watch.violations]
    assert kinds == [ViolationKind.ENTERED_RESTRICTED]
    assert watch.violations[0].names == ("K1",)
    assert 0.0 < watch.violations[0].time_s < 1.0
    assert watch.verdict is Verdict.FALSE
    outcome = watch.verdict_at_end(stays=True)
    assert not outcome.achieved
    assert "entered a restricted region (K1)" in outcome.reason


def test_leaving_the_domain_is_a_violation_told_once() -> None:
    watch = flown(monitor("true"), (3.0, 0.5), (3.0, -2.0), (4.0, -2.0), (4.0, 0.5), (4.0, -1.0))
    assert [violation.kind for violation in watch.violations] == [ViolationKind.LEFT_DOMAIN] * 2
    assert watch.violations[0].position_m == pytest.approx((3.0, 0.0))
    assert "left the domain" in watch.verdict_at_end(stays=True).reason


@pytest.mark.parametrize("bad", [(math.nan, 1.0), (1.0, math.inf)])
def test_reports_that_say_nothing_are_left_out(bad: tuple[float, float]) -> None:
    watch = flown(monitor(), centre(0))
    assert not watch.observe(5.0, bad)
    assert not watch.observe(math.nan, centre(8))
    assert not watch.observe(0.0, centre(8))
    assert not watch.observe(-1.0, centre(8))
    assert len(watch.visits) == 1
    assert not watch.violations


def test_a_flight_that_was_not_seen_has_achieved_nothing() -> None:
    assert not monitor("true").verdict_at_end(stays=True).achieved


@given(
    st.lists(st.tuples(st.floats(0.1, 14.9), st.floats(0.1, 9.9)), min_size=1, max_size=12), st.sampled_from(Semantics)
)
@tried(80)
def test_the_final_verdict_is_that_of_the_word_closed_by_staying(
    places: list[tuple[float, float]], semantics: Semantics
) -> None:
    watch = flown(monitor("F (S1 & F R) | F S2 & G !K1", semantics), *places)
    last = paper_labelling().label(watch.visits[-1].triangle)
    satisfied = satisfies(LassoWord(watch.word, (last,)), parse_formula("F (S1 & F R) | F S2 & G !K1"))
    assert watch.verdict_at_end(stays=True).achieved == (satisfied and not watch.violations)
    if watch.verdict is Verdict.TRUE:
        assert satisfied
    if watch.verdict is Verdict.FALSE and not watch.violations:
        assert not satisfied


def test_laps_decide_a_recurrent_flight() -> None:
    watch = monitor("G F S1 & G F R & G !K1", suffix=(3, 7, 5, 4, 12, 10, 12, 4, 5, 7), laps=2)
    there = [centre(t) for t in (5, 7, 3)]
    back = [centre(t) for t in (7, 5, 4, 12, 10)]
    flown(watch, *there, *back, *(centre(t) for t in (12, 4, 5, 7, 3)))
    assert watch.laps == 1
    assert watch.verdict is Verdict.OPEN
    assert "1 of 2 laps" in watch.verdict_at_end(stays=False).reason
    flown(watch, *back, *(centre(t) for t in (12, 4, 5, 7, 3)), start_s=100.0)
    assert watch.laps == 2
    assert watch.verdict_at_end(stays=False).achieved
    flown(watch, *(centre(t) for t in (7, 5, 4, 2, 6)), start_s=200.0)
    assert not watch.verdict_at_end(stays=False).achieved


def test_a_word_that_violates_ends_a_recurrent_flight_in_failure() -> None:
    watch = flown(monitor("G F S1 & G !S2", suffix=(3, 7), laps=0), centre(8), centre(0))
    assert not watch.violations
    assert "violates the specification" in watch.verdict_at_end(stays=False).reason


@pytest.mark.parametrize(
    ("place", "kind"), [(centre(6), ViolationKind.ENTERED_RESTRICTED), ((-3.0, 5.0), ViolationKind.LEFT_DOMAIN)]
)
def test_before_the_word_begins_the_vehicle_may_do_no_wrong_either(
    place: tuple[float, float], kind: ViolationKind
) -> None:
    watch = monitor("true")
    watch.guard(0.0, centre(11))
    watch.guard(0.5, (math.nan, 1.0))
    assert not watch.violations
    assert not watch.word
    watch.guard(1.0, place)
    watch.guard(2.0, place)
    assert [(violation.kind, violation.time_s) for violation in watch.violations] == [(kind, 1.0)]
    flown(watch, centre(11), centre(11), start_s=3.0)
    assert watch.verdict is Verdict.FALSE
    assert not watch.verdict_at_end(stays=True).achieved
