"""Automata that stand in the mission file itself: what they accept, and what may be wrong with them."""

import json
from itertools import combinations
from random import Random

import pytest
from hypothesis import given
from hypothesis import strategies as st

from mission.errors import SpecError
from mission.logic.automata.automaton import BuchiAutomaton
from mission.logic.automata.conversion import with_accepting_states
from mission.logic.formula.operators import TEMPORAL
from mission.logic.formula.parser import parse_formula
from mission.logic.formula.syntax import postorder
from mission.logic.formula.word import LassoWord, satisfies
from mission.logic.hoa.text import parse_generalised, parse_hoa
from mission.plan import plan_from_json, plan_mission, plan_to_json
from mission.spec.document import document_of
from mission.spec.loader import parse_mission
from mission.spec.written_automaton import written_automaton
from tests.support.formulas import random_formula, random_word

NAMES = ("field", "home", "den 2")
MISSION = """
domain: {boundary: [[0, 0], [40, 0], [40, 30], [0, 30]]}
regions:
  home: {kind: home, polygon: [[4, 4], [14, 4], [14, 12], [4, 12]]}
  field: {kind: survey, polygon: [[26, 4], [36, 4], [36, 12], [26, 12]]}
mission:
  automaton:
    states: [begun, seen, done]
    accepting: [done]
    edges:
      - {from: begun, to: begun, when: "!field"}
      - {from: begun, to: seen, when: field}
      - {from: seen, to: seen, when: "!home"}
      - {from: seen, to: done, when: home}
      - {from: done, to: done}
start: {position_m: [9, 8]}
"""


def automaton_of(**value: object) -> BuchiAutomaton:
    text, findings = written_automaton(value, None)
    assert not findings
    return with_accepting_states(parse_generalised(text))


@given(st.integers(0, 2**32 - 1))
def test_an_edge_reads_what_its_formula_says(seed: int) -> None:
    random = Random(seed)  # noqa: S311 - no secrets here
    guard = random_formula(random, random.randrange(7), NAMES)
    if {node.operator for node in postorder(guard)} & TEMPORAL:
        guard = parse_formula('field <-> !(home <-> "den 2" -> field)')
    once = [{"from": "a", "to": 1, "when": str(guard)}, {"from": 1, "to": 1}]
    automaton = automaton_of(states=["a", 1], accepting=[1], edges=once)
    for size in range(len(NAMES) + 1):
        for letter in map(frozenset, combinations(NAMES, size)):
            meant = satisfies(LassoWord((letter,), (frozenset(),)), guard)
            assert automaton.accepts(LassoWord((letter,), (frozenset(),))) == meant


def test_nested_equivalences_do_not_grow() -> None:
    text, _ = written_automaton(
        {"states": [0], "accepting": [0], "edges": [{"from": 0, "to": 0, "when": " <-> ".join(["(a <-> b)"] * 40)}]},
        None,
    )
    assert len(text) < 5_000


def test_it_accepts_what_the_same_formula_does() -> None:
    spec = parse_mission(MISSION.encode())
    assert spec.automaton is not None
    automaton = parse_hoa(spec.automaton.text)
    formula = parse_formula("F (field & X F home)")
    random = Random(1)  # noqa: S311 - no secrets here
    words = [random_word(random, ("field", "home")) for _ in range(200)]
    assert {automaton.accepts(word) == satisfies(word, formula) for word in words} == {True}
    assert {automaton.accepts(word) for word in words} == {True, False}


def test_the_initial_state_may_be_any() -> None:
    edges, word = [{"from": "done", "to": "done", "when": "a"}], LassoWord((), (frozenset("a"),))
    assert not automaton_of(states=["x", "done"], accepting=["done"], edges=edges).accepts(word)
    assert automaton_of(states=["x", "done"], initial="done", accepting=["done"], edges=edges).accepts(word)


def test_it_is_planned_written_and_read_back() -> None:
    spec = parse_mission(MISSION.encode(), "by_hand.yaml")
    plan = plan_mission(spec)
    assert plan.certificate.holds
    assert plan_from_json(plan_to_json(plan)).spec == spec
    assert spec.automaton is not None
    text = spec.automaton.text
    assert parse_mission(json.dumps(document_of(spec)).encode(), "by_hand.yaml", lambda _: text.encode()) == spec


@pytest.mark.parametrize(
    ("old", "new", "path", "message", "hint"),
    [
        ("to: seen, when", "to: sen, when", "edges[1].to", "`sen` is none of the automaton's states", "`seen`"),
        ("[done]", "[7]", "accepting[0]", "`7` is none of the automaton's states", "begun, seen, done"),
        ("states:", "initial: 3\n    states:", "initial", "`3` is none of the automaton's states", "begun"),
        ("when: home", "when: F home", "edges[3].when", "`F` is about more than one moment", "one letter"),
        ("when: home", "when: hone", "edges[3].when", "`hone` is no region", "`home`"),
        ("when: home", "when: home &", "edges[3].when", "lacks its operand", "proposition"),
        ("accepting: [done]", "accepting: done", "accepting", "expected a list", "[done]"),
        ("from: done,", "form: done,", "edges[4].form", "unknown key `form`", "`from`"),
    ],
)
def test_what_is_wrong_is_told_with_its_place(old: str, new: str, path: str, message: str, hint: str) -> None:
    with pytest.raises(SpecError) as caught:
        parse_mission(MISSION.replace(old, new, 1).encode())
    told = {fault.path: fault for fault in caught.value.faults}
    fault = told[f"mission.automaton.{path}"]
    assert message in fault.message
    assert hint in fault.hint
    assert fault.line > 0
