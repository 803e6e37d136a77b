from typing import Any

import numpy as np
import pytest

from mission.logic.automata.automaton import (
    BuchiAutomaton,
    Edge,
    GeneralisedBuchi,
    MarkedEdge,
    compile_generalised,
    compile_to_alphabet,
    states_with_nonempty_language,
)
from mission.logic.automata.guards import Guard
from mission.logic.automata.translate import translate, translate_generalised
from mission.logic.formula.parser import parse_formula
from mission.logic.formula.word import LassoWord

NAMES = ("a", "b")
TRUE = Guard(NAMES, ((0, 0),))
A = Guard(NAMES, ((1, 0),))
NOT_A = Guard(NAMES, ((0, 1),))
LETTERS = (frozenset[str](), frozenset({"a"}), frozenset({"b", "elsewhere"}))


def automaton(**changes: Any) -> BuchiAutomaton:  # noqa: ANN401 - any field
    fields: dict[str, Any] = {
        "propositions": NAMES,
        "size": 2,
        "initial": (0,),
        "accepting": frozenset({1}),
        "edges": (Edge(0, NOT_A, 0), Edge(0, A, 1), Edge(1, TRUE, 1)),
    }
    return BuchiAutomaton(**(fields | changes))


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"size": 1}, "leaves the 1 states|does not exist"),
        ({"initial": ()}, "initial"),
        ({"initial": (2,)}, "initial"),
        ({"initial": (1, 0)}, "initial"),
        ({"accepting": frozenset({2})}, "accepting"),
        ({"edges": (Edge(0, A, 2),)}, "leaves"),
        ({"edges": (Edge(0, A, 1), Edge(0, NOT_A, 1))}, "ordered"),
        ({"edges": (Edge(1, A, 1), Edge(0, NOT_A, 1))}, "ordered"),
        ({"edges": (Edge(0, Guard(NAMES, ()), 1),)}, "guard"),
        ({"edges": (Edge(0, Guard(("c",), ((1, 0),)), 1),)}, "guard"),
        ({"propositions": ("a", "a")}, "twice"),
    ],
)
def test_an_automaton_is_valid_from_birth(changes: dict[str, Any], message: str) -> None:
    with pytest.raises(ValueError, match=message):
        automaton(**changes)


def test_a_generalised_automaton_is_valid_from_birth() -> None:
    good = (MarkedEdge(0, A, 0, ()), MarkedEdge(0, NOT_A, 0, (0, 1)))
    assert GeneralisedBuchi(NAMES, 1, (0,), 2, good).sets == 2
    for bad in ((good[1], good[0]), (MarkedEdge(0, A, 0, (2,)),), (MarkedEdge(0, A, 0, (1, 0)),)):
        with pytest.raises(ValueError, match="edge"):
            GeneralisedBuchi(NAMES, 1, (0,), 2, bad)


@pytest.mark.parametrize("cube", [(1, 1), (4, 0), (0, 4), (-1, 0)])
def test_a_guard_is_valid_from_birth(cube: tuple[int, int]) -> None:
    with pytest.raises(ValueError, match="no cube"):
        Guard(NAMES, (cube,))


def test_guards_are_short_formulas() -> None:
    names = ("a", "b", "no go")
    guard = Guard(names, ((0b001, 0b100), (0b010, 0b100)))
    assert str(guard) == '!"no go" & (a | b)'
    assert guard.allows(frozenset({"a"}))
    assert not guard.allows(frozenset({"a", "no go"}))
    assert not guard.allows(frozenset())
    assert str(Guard(names, ())) == "false"
    assert str(Guard(names, ((0, 0),))) == "true"


def test_determinism_and_completeness() -> None:
    assert automaton().deterministic
    assert automaton().complete
    assert not automaton(edges=(Edge(0, TRUE, 0), Edge(0, A, 1))).deterministic
    assert not automaton(edges=(Edge(0, NOT_A, 0), Edge(1, TRUE, 1))).complete
    assert not automaton(initial=(0, 1)).deterministic
    assert automaton().edge_count == 3


def test_acceptance_of_words() -> None:
    empty, a = frozenset[str](), frozenset({"a"})
    assert automaton().accepts(LassoWord((), (empty, a)))
    assert not automaton().accepts(LassoWord((), (empty,)))
    assert automaton(initial=(0, 1)).accepts(LassoWord((), (empty,)))
    assert not automaton(accepting=frozenset({0})).accepts(LassoWord((a,), (empty,)))


def test_compiled_rows_are_all_transitions_in_order() -> None:
    compiled = compile_to_alphabet(automaton(), LETTERS)
    rows = np.column_stack((compiled.sources, compiled.letters, compiled.targets)).tolist()
    assert rows == [[0, 0, 0], [0, 1, 1], [0, 2, 0], [1, 0, 1], [1, 1, 1], [1, 2, 1]]
    assert compiled.states == 2
    assert compiled.initial.tolist() == [0]
    assert compiled.accepting.tolist() == [False, True]
    with pytest.raises(ValueError, match="read-only"):
        compiled.sources[0] = 1
    assert compile_to_alphabet(automaton(edges=()), LETTERS).sources.shape == (0,)


def test_compiled_generalised_rows_have_marks() -> None:
    generalised = translate_generalised(parse_formula("G F a & G F b"))
    compiled = compile_generalised(generalised, LETTERS)
    assert (compiled.states, compiled.sets) == (1, 2)
    assert compiled.letters.tolist() == [0, 1, 2]
    assert sorted(compiled.marks.sum(axis=1).tolist()) == [0, 1, 1]
    assert compiled.marks[0].tolist() == [False, False]


def test_the_alphabet_decides_what_can_still_be_satisfied() -> None:
    mission = translate(parse_formula("F a & F b"))
    everything = compile_to_alphabet(mission, (frozenset(), frozenset({"a"}), frozenset({"b"})))
    assert states_with_nonempty_language(everything).all()
    without_b = compile_to_alphabet(mission, (frozenset(), frozenset({"a"})))
    alive = states_with_nonempty_language(without_b)
    assert not alive[0]
    assert alive.sum() == 2  # b is behind, with a behind or not
    assert not states_with_nonempty_language(compile_to_alphabet(translate(parse_formula("false")), LETTERS)).any()
