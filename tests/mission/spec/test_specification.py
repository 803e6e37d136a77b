"""Missions that name an automaton: planned from every form that is read, proved, written, read back and warned of."""

import json
from dataclasses import replace
from random import Random

import pytest

from mission.errors import AutomatonSizeError, NoPlanError
from mission.logic.automata import complement as complement_module
from mission.logic.automata.translate import translate_generalised
from mission.logic.formula.parser import parse_formula
from mission.logic.formula.syntax import TRUE
from mission.logic.formula.word import LassoWord, Letter
from mission.logic.hoa.text import to_hoa
from mission.monitor.monitor import Monitor
from mission.monitor.verdict import FormulaWatch, Verdict
from mission.plan import FlightPlan, plan_from_json, plan_mission, plan_to_json
from mission.spec.loader import load_mission, parse_mission
from mission.spec.model import MissionSpec
from mission.spec.specification import of_mission
from tests.support.automata import random_automaton
from tests.support.commands import MISSIONS
from tests.support.proofs import untrue
from tests.support.small_missions import SMALL

HEAD = 'HOA: v1 Start: 0 AP: 2 "goal" "home" '
FORMS = {
    "two accepting states": HEAD
    + "Acceptance: 1 Inf(0) --BODY-- State: 0 [!0] 0 [0] 1 State: 1 {0} [0] 1 [!0] 2 State: 2 {0} [!0] 2 [0] 1 --END--",
    "transitions accept": HEAD
    + "Acceptance: 1 Inf(0) --BODY-- State: 0 [!0] 0 [0] 1 State: 1 [!1] 1 [1] 1 {0} --END--",
    "generalised": HEAD + "Acceptance: 2 Inf(0)&Inf(1) --BODY-- State: 0 [0] 0 {0} [1] 0 {1} [!0&!1] 0 --END--",
    "several initial states": HEAD + "Start: 1 Acceptance: 1 Inf(0) --BODY-- State: 0 [!0] 0 [0] 2 State: 1 [f] 1 "
    "State: 2 {0} [t] 2 --END--",
    "implicit labels": HEAD + "Acceptance: 1 Inf(0) --BODY-- State: 0 0 1 0 1 State: 1 {0} 1 1 1 1 --END--",
    "aliases": HEAD + "Alias: @g 0&!1 Acceptance: 1 Inf(0) --BODY-- State: 0 [!@g] 0 [@g] 1 State: 1 {0} [t] 1 --END--",
    "nondeterministic": HEAD + "Acceptance: 1 Inf(0) --BODY-- State: 0 [t] 0 [0] 1 State: 1 [t] 1 [1] 2 State: 2 {0} "
    "[1] 2 --END--",
    "no acceptance sets": HEAD + "Acceptance: 0 t --BODY-- State: 0 [!0] 0 --END--",
}
PAIRS = load_mission(MISSIONS / "pairs.yaml")


def mission_of(hoa: str, more: str = "") -> MissionSpec:
    text = SMALL.replace("formula: F (goal & F G home) & G !pond", "automaton: it.hoa") + more
    return parse_mission(text.encode(), "small.yaml", lambda _: hoa.encode())


def word_of(plan: FlightPlan) -> LassoWord:
    labels = [plan.labelling.label(triangle) for triangle in plan.run.states]
    return LassoWord(tuple(labels[: len(plan.run.prefix)]), tuple(labels[len(plan.run.prefix) :]))


@pytest.fixture(scope="module")
def pairs() -> FlightPlan:
    return plan_mission(PAIRS)


@pytest.mark.parametrize("form", sorted(FORMS))
def test_whatever_is_read_is_planned_with_a_proof(form: str) -> None:
    plan = plan_mission(mission_of(FORMS[form]))
    assert plan.certificate.holds
    assert plan.required.satisfied_by(word_of(plan))
    assert not untrue(plan)


@pytest.mark.parametrize("formula", ["F (goal & F G home)", "G F goal & G F home", "F goal & G (goal -> F home)"])
def test_the_automaton_of_a_formula_is_planned_as_the_formula_is(formula: str) -> None:
    automaton = to_hoa(translate_generalised(parse_formula(formula)))
    named = plan_mission(mission_of(automaton))
    written = plan_mission(replace(named.spec, automaton=None, formula=formula))
    assert len(named.run.states) == len(written.run.states)
    assert named.certificate.holds
    assert written.required.satisfied_by(word_of(named))


def test_an_even_number_is_planned(pairs: FlightPlan) -> None:
    word = [min(letter) for letter in pairs.certificate.word if letter]
    assert word == ["home", "field", "depot", "field", "depot", "home"]
    assert pairs.formula is TRUE
    assert pairs.specification == "automaton pairs.hoa"
    assert pairs.automaton.accepting == {5}
    assert pairs.warnings == ()


def test_tasks_beside_it_are_met_too() -> None:
    tasks = "tasks:\n  - visit: [home]\n  - {avoid: goal, weight: 2}\n  - {avoid: pond, weight: 1}\n"
    plan = plan_mission(mission_of(FORMS["two accepting states"], tasks))
    assert [task.task for task in plan.dropped] == ["avoid goal"]
    assert plan.specification == "automaton it.hoa, and F home & G !pond"
    assert plan.required.satisfied_by(word_of(plan))
    assert plan.dropped[0].reason == "these contradict each other"
    forbidden = "tasks:\n  - avoid: goal\n"
    with pytest.raises(NoPlanError, match=r"contradict each other:\n    automaton it\.hoa\n    G !goal") as caught:
        plan_mission(mission_of(FORMS["two accepting states"], forbidden))
    assert caught.value.conjuncts == ("automaton it.hoa", "G !goal")


@pytest.mark.parametrize("seed", range(3))
def test_a_word_satisfies_a_mission_or_its_refutation(seed: int) -> None:
    random = Random(seed)  # noqa: S311 - no secrets here
    letters: tuple[Letter, ...] = (frozenset(), frozenset({"goal"}), frozenset({"home"}), frozenset({"pond"}))
    for _ in range(20):
        hoa = to_hoa(random_automaton(random, 3, random.randrange(3), 1.6, 4))
        hoa = hoa.replace('"a"', '"goal"').replace('"b"', '"home"')
        tasks = random.choice(["", "tasks:\n  - visit: goal\n", "tasks:\n  - avoid: home\n  - patrol: [goal]\n"])
        required = of_mission(mission_of(hoa, tasks), letters)
        for _ in range(12):
            parts = ([random.choice(letters) for _ in range(random.randint(1, 4))] for _ in range(2))
            word = LassoWord(*map(tuple, parts))
            good = required.satisfied_by(word)
            assert required.automaton.accepts(word) is good
            assert required.refutation.accepts(word) is not good


def test_a_plan_needs_no_other_file(pairs: FlightPlan) -> None:
    text = plan_to_json(pairs)
    again = plan_from_json(text)
    assert again.spec == pairs.spec
    assert again.required == pairs.required
    assert not untrue(again)
    assert plan_to_json(again) == text


def test_a_plan_is_proved_against_the_automaton_in_it_and_not_what_stands_beside(pairs: FlightPlan) -> None:
    document = json.loads(plan_to_json(pairs))
    text = document["mission_automaton"].replace('at home" {0}', 'at home"')
    document["mission_automaton"] = text.replace(
        'odd number of loads is delivered"', 'odd number of loads is delivered" {0}'
    )
    again = plan_from_json(json.dumps(document))
    assert again.required != pairs.required
    assert untrue(again)


def test_the_monitor_judges_by_the_automaton(pairs: FlightPlan) -> None:
    def flown(plan: FlightPlan, *names: str) -> Monitor:
        watch = Monitor(
            plan.locator,
            plan.labelling,
            satisfied_by=plan.required.satisfied_by,
            automata=plan.compiled_parts,
            whole=plan.deterministic,
            refutation=plan.compiled_refutation,
            semantics=plan.spec.semantics,
            restricted=plan.restricted,
        )
        # Home, and east of the barn, field and depot; ways between them meet nothing restricted.
        places = {"home": (12.0, 12.0), "field": (70.0, 40.0), "depot": (69.0, 12.0)}
        for t_s, name in enumerate(names):
            assert watch.observe(float(t_s), places[name])
        return watch

    twice = flown(pairs, "home", "depot", "field", "depot", "field", "depot", "home")
    assert twice.verdict is Verdict.OPEN
    assert twice.verdict_at_end(stays=True).achieved
    thrice = flown(pairs, "home", "depot", *("field", "depot") * 3, "home")
    outcome = thrice.verdict_at_end(stays=True)
    assert not outcome.achieved
    assert outcome.reason == "the word that was flown does not satisfy the specification"
    assert not flown(pairs, "home", "depot", *("field", "depot") * 2).verdict_at_end(stays=True).achieved


def test_the_monitor_knows_when_an_automaton_is_met_or_lost_for_good() -> None:
    plan = plan_mission(mission_of(FORMS["two accepting states"]))
    for name, verdict in (("home", Verdict.OPEN), ("goal", Verdict.TRUE)):
        watch = FormulaWatch(plan.compiled_parts, plan.deterministic, plan.compiled_refutation, plan.labelling.letters)
        watch.read(plan.labelling.letters.index(frozenset({name})))
        assert watch.verdict is verdict
    never = plan_mission(mission_of(FORMS["no acceptance sets"]))
    watch = FormulaWatch(never.compiled_parts, never.deterministic, never.compiled_refutation, never.labelling.letters)
    watch.read(never.labelling.letters.index(frozenset({"goal"})))
    assert watch.verdict is Verdict.FALSE


def test_an_automaton_that_counts_triangles_is_warned_of() -> None:
    # Two triangles of the goal are wanted, or a stay in one.
    text = HEAD + "Acceptance: 1 Inf(0) --BODY-- State: 0 [t] 0 [0] 1 State: 1 [0] 2 State: 2 {0} [t] 2 --END--"
    (warning,) = plan_mission(mission_of(text)).warnings
    assert warning.startswith("the automaton it.hoa may depend on the mesh: it counts how many triangles")


def test_an_automaton_that_asks_nothing_is_warned_of() -> None:
    nothing = HEAD + "Acceptance: 0 t --BODY-- State: 0 [t] 0 --END--"
    assert plan_mission(mission_of(nothing)).warnings == (
        "the automaton it.hoa asks nothing: every flight on this map satisfies it",
    )
    at_start = HEAD + "Acceptance: 1 Inf(0) --BODY-- State: 0 [!1] 0 [1] 1 State: 1 {0} [t] 1 --END--"
    assert plan_mission(mission_of(at_start)).warnings == (
        "the automaton it.hoa already holds where the flight starts (home): it asks nothing of the rest",
    )


def test_an_automaton_that_cannot_be_complemented_is_refused_with_what_to_do(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(complement_module, "MAX_STATES", 1)
    with pytest.raises(AutomatonSizeError, match="give a smaller automaton, or a deterministic one") as caught:
        plan_mission(mission_of(FORMS["nondeterministic"]))
    assert caught.value.exit_code == 2


def test_that_there_is_no_run_is_said_before_anything_is_complemented(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(complement_module, "MAX_STATES", 1)
    with pytest.raises(NoPlanError, match="asks for goal and home at once, but no triangle lies in both"):
        plan_mission(mission_of(FORMS["nondeterministic"].replace("[0] 1", "[0&1] 1")))
