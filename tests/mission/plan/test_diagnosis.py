"""Diagnoses against the search of the product itself, on random small domains."""

from itertools import combinations, pairwise
from random import Random

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from mission.errors import NoPlanError
from mission.logic.formula.parser import parse_formula
from mission.logic.formula.syntax import Formula, always, conjunction, eventually, negation, proposition
from mission.logic.formula.word import satisfies
from mission.plan import diagnosis
from mission.plan.coarse_map import CoarseMap
from mission.plan.diagnosis import Cause, Part, diagnose, parts_of
from mission.planning.product import Product
from mission.planning.search import search
from mission.planning.transition_system import TransitionSystem
from mission.spec.model import Semantics
from tests.support.drawn_cases import tried
from tests.support.formulas import random_formula
from tests.support.products import random_system
from tests.support.required import required

NAMES = ("a", "b", "k")
LETTERS = (frozenset[str](), frozenset({"a"}), frozenset({"b"}), frozenset({"a", "b"}), frozenset({"k"}))
SEEDS = st.integers(0, 2**32 - 1)


def random_domain(seed: int) -> TransitionSystem:
    """Up to eight triangles that carry any of the letters; the first is outside the restricted region."""
    rng = np.random.default_rng(seed)
    system = random_system(rng, int(rng.integers(2, 9)), len(LETTERS))
    letter_of = np.array(system.letter_of)
    letter_of[0] = rng.integers(len(LETTERS) - 1)
    return TransitionSystem(system.successors, letter_of, LETTERS)


def has_a_run(system: TransitionSystem, parts: tuple[Part, ...], semantics: Semantics) -> bool:
    """Asked of the planner's own search, with restricted triangles blocked."""
    closed = {part.restricted for part in parts if part.restricted}
    blocked = np.array([bool(closed & letter) for letter in system.letters])[system.letter_of]
    successors = np.where((system.successors >= 0) & ~blocked[system.successors], system.successors, -1)
    narrowed = TransitionSystem(successors, system.letter_of, system.letters)
    formula = conjunction(*(part.formula for part in parts if not part.restricted))
    try:
        search(Product(narrowed, required(formula, system.letters), 0, semantics))
    except NoPlanError:
        return False
    return True


def random_conjunction(seed: int) -> Formula:
    random = Random(seed)  # noqa: S311 - draws a test
    a, b = proposition("a"), proposition("b")
    plain = [eventually(a), eventually(b), always(negation(a)), always(negation(b)), eventually(always(a))]
    drawn = (eventually(random_formula(random, random.randint(0, 4), NAMES)) for _ in range(random.randint(1, 2)))
    return conjunction(*drawn, *random.sample(plain, random.randint(0, 3)))


@tried(150)
@given(SEEDS, SEEDS, st.sampled_from(Semantics))
def test_a_core_has_no_run_each_smaller_set_has_one_and_nothing_is_said_of_what_has_a_plan(
    domain: int, draw: int, semantics: Semantics
) -> None:
    system, formula = random_domain(domain), random_conjunction(draw)
    parts = parts_of(formula, ("k",), {})
    found = diagnose(formula, system, ("k",), 0, semantics)
    assert (found is None) == has_a_run(system, parts, semantics)
    if found is None:
        return
    core = tuple(part for part in parts if part.restricted in found.restricted and part.restricted)
    core = (*(part for part in parts if str(part.formula) in found.conjuncts and not part.restricted), *core)
    assert found.smallest
    assert len(core) == len(found.conjuncts) + len(found.restricted)
    assert not has_a_run(system, core, semantics)
    assert all(has_a_run(system, rest, semantics) for rest in combinations(parts, len(core) - 1))


@tried(60)
@given(SEEDS, SEEDS, st.sampled_from(Semantics), st.booleans())
def test_a_word_of_the_coarse_map_satisfies_its_formula(
    domain: int,
    draw: int,
    semantics: Semantics,
    keeps: bool,  # noqa: FBT001 - drawn
) -> None:
    system, formula = random_domain(domain), random_conjunction(draw)
    area = CoarseMap.of(system, 0, keeps_triangles=keeps)
    word = area.word(required(formula, system.letters).whole, area.closed(frozenset({"k"})), semantics)
    if word is not None:
        assert satisfies(word, formula)
        assert not any("k" in letter for letter in word.prefix + word.suffix)
        assert semantics is Semantics.PAPER or (word.prefix + word.suffix)[0] == system.letters[system.letter_of[0]]


def row(*labels: str) -> TransitionSystem:
    """Triangles side by side, each with its regions."""
    count = len(labels)
    successors = np.full((count, 4), -1)
    successors[:, 0] = np.arange(count)
    successors[:-1, 1] = np.arange(1, count)
    successors[1:, 2] = np.arange(count - 1)
    letters = tuple(dict.fromkeys(frozenset(label.split()) for label in labels))
    return TransitionSystem(
        successors, np.array([letters.index(frozenset(label.split())) for label in labels]), letters
    )


def test_a_region_beyond_another_is_cut_off_by_it() -> None:
    found = diagnose(parse_formula("F a & F b"), row("", "b", "k", "a"), ("k",), 0, Semantics.STANDARD)
    assert found is not None
    assert (found.cause, found.regions, found.restricted) == (Cause.UNREACHABLE, ("a",), ("k",))
    assert "k cuts it off" in found.text


def test_a_region_of_no_triangle_is_named() -> None:
    found = diagnose(parse_formula("F a & F z"), row("", "a"), (), 0, Semantics.STANDARD)
    assert found is not None
    assert found.text == "`F z` asks for z, but no triangle has the label z"


def test_a_map_without_open_space_is_named() -> None:
    found = diagnose(parse_formula("F (!a & !b)"), row("a", "b", "a"), (), 0, Semantics.STANDARD)
    assert found is not None
    assert found.text == "`F (!a & !b)` asks for a place outside a, b, but no triangle lies there"


def test_a_map_in_two_pieces_is_named() -> None:
    apart = row("", "a")
    system = TransitionSystem(
        np.where(apart.successors == apart.successors[:, :1], apart.successors, -1), apart.letter_of, apart.letters
    )
    found = diagnose(parse_formula("F a"), system, (), 0, Semantics.STANDARD)
    assert found is not None
    assert "a cannot be reached from triangle 0 (no region): no way leads to it" in found.text


def test_the_paper_does_not_read_the_label_of_the_start() -> None:
    system = row("a", "")
    assert diagnose(parse_formula("G !a"), system, (), 0, Semantics.PAPER) is None
    found = diagnose(parse_formula("G !a"), system, (), 0, Semantics.STANDARD)
    assert found is not None
    assert found.cause is Cause.START


def test_a_restricted_region_that_a_conjunct_forbids_is_one_part() -> None:
    parts = parts_of(parse_formula("F a & G !k"), ("k", "m"), {})
    assert [str(part) for part in parts] == ["F a", "G !k", "m is restricted: it is never entered"]


def reactions(count: int) -> tuple[Formula, TransitionSystem]:
    """Each region calls for the next one, the first recurs, and the last does not; all are on the map."""
    names = [f"p{i}" for i in range(count)]
    calls = " & ".join(f"G ({one} -> F {other})" for one, other in pairwise(names))
    return parse_formula(f"{calls} & G F {names[0]} & F G !{names[-1]}"), row("", *names)


def test_reactions_that_contradict_each_other_are_named() -> None:
    formula, system = reactions(6)
    found = diagnose(formula, system, (), 0, Semantics.STANDARD)
    assert found is not None
    assert (found.cause, len(found.conjuncts), found.smallest) == (Cause.THEMSELVES, 7, True)


def test_so_are_many_though_the_words_of_all_maps_are_too_many() -> None:
    formula, system = reactions(12)
    found = diagnose(formula, system, (), 0, Semantics.STANDARD)
    assert found is not None
    assert (found.cause, len(found.conjuncts), found.smallest) == (Cause.MAP, 13, True)
    assert "it contradicts itself, or asks for" in found.text


def test_the_questions_have_a_bound(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(diagnosis, "MAX_WORK", 0)
    assert diagnose(*reactions(6), (), 0, Semantics.STANDARD) is None
