"""Intersections, unions and conversions against membership, decided from the definition of acceptance."""

from random import Random

import pytest

from mission.errors import AutomatonSizeError, SpecError
from mission.logic.automata import combination, conversion, diagrams
from mission.logic.automata.automaton import GeneralisedBuchi, MarkedEdge
from mission.logic.automata.combination import intersection, union
from mission.logic.automata.conversion import with_accepting_states, with_marked_transitions
from mission.logic.automata.guards import Guard
from mission.logic.automata.translate import translate, translate_generalised
from mission.logic.formula.parser import parse_formula
from mission.logic.formula.word import LassoWord, satisfies
from mission.logic.hoa.text import parse_generalised
from tests.support.automata import accepts, random_automaton, random_lasso
from tests.support.formulas import random_word


@pytest.mark.parametrize("seed", range(4))
def test_an_intersection_accepts_what_both_accept(seed: int) -> None:
    random = Random(seed)  # noqa: S311 - no secrets here
    for _ in range(20):
        one, other = (random_automaton(random, random.randint(1, 3), random.randrange(3), 1.6, 4) for _ in range(2))
        both = intersection(one, other)
        assert both.sets == one.sets + other.sets
        for _ in range(12):
            word = random_lasso(random, 4)
            assert accepts(both, word) is (accepts(one, word) and accepts(other, word))


@pytest.mark.parametrize("seed", range(4))
def test_a_union_accepts_what_either_accepts_and_conversions_change_nothing(seed: int) -> None:
    random = Random(seed)  # noqa: S311 - no secrets here
    for _ in range(20):
        one, other = (random_automaton(random, random.randint(1, 3), random.randrange(3), 1.6, 4) for _ in range(2))
        machines = with_accepting_states(one), with_accepting_states(other)
        either = union(*machines)
        for _ in range(12):
            word = random_lasso(random, 4)
            assert machines[0].accepts(word) is accepts(one, word)
            assert accepts(with_marked_transitions(machines[1]), word) is accepts(other, word)
            assert either.accepts(word) is (accepts(one, word) or accepts(other, word))


def test_different_propositions_are_brought_together() -> None:
    random, names = Random(2), ("a", "b", "c")  # noqa: S311 - no secrets here
    left, right = parse_formula("G F (a & b)"), parse_formula("F (b & c) | G !c")
    both = intersection(translate_generalised(left), translate_generalised(right))
    either = union(translate(right), translate(left))
    assert set(both.propositions) == set(either.propositions) == set(names)
    for _ in range(80):
        word = random_word(random, names)
        truths = satisfies(word, left), satisfies(word, right)
        assert accepts(both, word) is all(truths)
        assert either.accepts(word) is any(truths)


def test_accepting_states_keep_their_numbers() -> None:
    whole = Guard((), ((0, 0),))
    edges = tuple(MarkedEdge(s, whole, t, (0,) * (s in {1, 3})) for s, t in ((0, 1), (1, 2), (2, 3), (3, 0)))
    found = with_accepting_states(GeneralisedBuchi((), 4, (0, 2), 1, edges))
    assert (found.size, found.initial) == (4, (0, 2))
    assert found.accepting == {1, 3}
    assert found.accepts(LassoWord((), (frozenset(),)))


def test_sizes_are_bounded(monkeypatch: pytest.MonkeyPatch) -> None:
    random = Random(1)  # noqa: S311 - no secrets here
    large = random_automaton(random, 6, 2, 2.2, 4)
    monkeypatch.setattr(combination, "MAX_STATES", 5)
    with pytest.raises(AutomatonSizeError, match="together have more than 5 states"):
        intersection(large, large)
    monkeypatch.setattr(conversion, "MAX_COPIES", 5)
    with pytest.raises(AutomatonSizeError, match="6 states and 2 acceptance sets, too many"):
        with_accepting_states(large)


def test_a_label_that_no_short_guard_can_say_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    """The parity of many propositions has a small diagram, and as many cubes as words of even parity."""
    monkeypatch.setattr(diagrams, "MAX_CUBES", 1000)
    count = 20
    names = " ".join(f'"p{i}"' for i in range(count))
    steps = "".join(f"Alias: @{i} !@{i - 1}&{i} | @{i - 1}&!{i}\n" for i in range(1, count))
    text = (
        f"HOA: v1\nStart: 0\nAP: {count} {names}\nAlias: @0 0\n{steps}Acceptance: 0 t\n--BODY--\nState: 0\n"
        f"[@{count - 1}] 0\n--END--"
    )
    with pytest.raises(SpecError, match="too complicated"):
        parse_generalised(text)
