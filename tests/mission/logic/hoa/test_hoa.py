import re
from random import Random

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from mission.errors import AutomatonSizeError, SpecError
from mission.logic.automata.automaton import BuchiAutomaton
from mission.logic.automata.translate import translate, translate_generalised
from mission.logic.formula.parser import parse_formula
from mission.logic.formula.word import satisfies
from mission.logic.hoa.text import parse_generalised, parse_hoa, to_hoa
from tests.support.drawn_cases import tried
from tests.support.formulas import random_formula, random_word


def accepts_exactly(automaton: BuchiAutomaton, formula: str) -> None:
    random = Random(3)  # noqa: S311 - no secrets here
    meaning = parse_formula(formula)
    for _ in range(60):
        word = random_word(random, ("a", "b", "c"))
        assert automaton.accepts(word) is satisfies(word, meaning), f"{formula} on {word}"


@pytest.mark.parametrize("seed", range(2))
def test_what_is_written_is_read_as_the_same_automaton(seed: int) -> None:
    random = Random(seed)  # noqa: S311 - no secrets here
    for _ in range(30):
        formula = random_formula(random, random.randrange(10), ("a", "b", "no fly zone"))
        automaton = translate(formula)
        assert parse_hoa(to_hoa(automaton)) == automaton
        generalised = translate_generalised(formula)
        assert parse_generalised(to_hoa(generalised)) == generalised


STATE_BASED = """HOA: v1
name: "a comes, then b for ever, or \\"c\\"" tool: "some" "1.0"
/* a comment /* in a comment */ */
States: 2 Start: 0
acc-name: Buchi properties: trans-labels deterministic x-unknown 7
Acceptance: 1 Inf(0)
AP: 3 "a" "b" "c"
Alias: @a 0 Alias: @leave (@a | 2)
--BODY--
State: 0 "waits" [!@leave] 0 [@leave] 1
State: 1 {0} [t] 1
--END--
"""


def test_state_based_with_aliases_comments_and_names() -> None:
    automaton = parse_hoa(STATE_BASED)
    assert automaton.size == 2
    assert automaton.accepting == {1}
    assert [str(edge.guard) for edge in automaton.edges] == ["!a & !c", "a | c", "true"]
    accepts_exactly(automaton, "F (a | c)")


@pytest.mark.parametrize(
    ("text", "formula"),
    [
        # Transition-based Büchi.
        (
            'AP: 1 "a" Acceptance: 1 Inf(0) Start: 0 --BODY-- State: 0 [0] 0 {0} [!0] 0 --END--',
            "G F a",
        ),
        # Generalised, implicit labels: edge i is for the letter of the bits of i.
        (
            'AP: 2 "a" "b" Acceptance: 2 (Inf(0) & Inf(1)) Start: 0 --BODY-- State: 0 0 0 {0} 0 {1} 0 {0 1} --END--',
            "G F a & G F b",
        ),
        # Complemented sets, repeated and unused ones.
        (
            'AP: 1 "a" Acceptance: 4 Inf(!2) & Inf(!2) Start: 0 --BODY-- State: 0 {0} [!0] 0 {2} [0] 0 {1} --END--',
            "G F a",
        ),
        # Labels on states, and several initial states.
        (
            (
                'AP: 1 "a" States: 2 Start: 0 Start: 1 Acceptance: 1 Inf(0) --BODY-- '
                "State: [0] 0 {0} 0 1 State: [!0] 1 0 1 --END--"
            ),
            "G F a",
        ),
        # Several initial states with marks on transitions.
        (
            (
                'AP: 2 "a" "b" Start: 0 Start: 1 Acceptance: 1 Inf(0) --BODY-- '
                "State: 0 [0] 0 {0} [!0] 0 State: 1 [1] 1 {0} [!1] 1 --END--"
            ),
            "G F a | G F b",
        ),
        # Every infinite run is accepting.
        (
            'AP: 1 "a" Start: 0 acc-name: all Acceptance: 0 t --BODY-- State: 0 [0] 0 --END--',
            "G a",
        ),
        # Labels with all operators; parallel edges.
        (
            (
                'AP: 2 "a" "b" Start: 0 Acceptance: 1 Inf(0) --BODY-- '
                "State: 0 {0} [0 & !(1 | f)] 0 [!!1&t] 0 [f] 3 State: 3 --END--"
            ),
            "G (a | b)",
        ),
        # States in any order, without a number of them.
        (
            'AP: 1 "a" Start: 1 Acceptance: 1 Inf(0) --BODY-- State: 0 {0} [t] 0 State: 1 [0] 0 [!0] 1 --END--',
            "F a",
        ),
    ],
)
def test_the_kinds_that_are_read(text: str, formula: str) -> None:
    accepts_exactly(parse_hoa("HOA: v1 " + text), formula)


GOOD = 'HOA: v1\nAP: 1 "a"\nStates: 1\nStart: 0\nAcceptance: 1 Inf(0)\n--BODY--\nState: 0 {0}\n[0] 0\n--END--\n'


@pytest.mark.parametrize(
    ("old", "new", "line", "message"),
    [
        ("HOA: v1", "States: 1", 1, "does not begin with HOA:"),
        ("HOA: v1", "HOA: v2", 1, "version v2"),
        ('AP: 1 "a"', 'AP: 2 "a"', 2, "2 propositions are announced, and 1 are named"),
        ('AP: 1 "a"', 'AP: 2 "a" "a"', 2, "named twice"),
        ('AP: 1 "a"', "AP: 40 " + " ".join(f'"a{i}"' for i in range(40)), 2, "more than 32"),
        ('AP: 1 "a"', r'AP: 1 "a\"b"', 2, "cannot be the name"),
        ('AP: 1 "a"', "Tree: 5", 2, "Tree: is not known"),
        ('AP: 1 "a"', "AP: 1 a", 2, "0 are named"),
        ("States: 1", "States: 1\nStates: 1", 4, "occurs twice"),
        ("States: 1", "States: 99999999", 3, "more than 20000 states"),
        ("States: 1", "States: 99999999999", 3, "too large"),
        ("Start: 0", "Start: 0&1", 4, "alternating"),
        ("Start: 0", "Start: 1", 4, "state 1 does not exist"),
        ("Start: 0\n", "", 5, "Start: is missing"),
        ("Start: 0", "Alias: @x 0 Alias: @x 0", 4, "defined twice"),
        ("Acceptance: 1 Inf(0)\n", "", 5, "Acceptance: is missing"),
        ("Inf(0)", "Fin(0)", 5, "'Fin' is in no Büchi"),
        ("1 Inf(0)", "2 Inf(0)|Inf(2)", 5, "acceptance set 2 does not exist"),
        ("1 Inf(0)", "0 f", 5, "'f' is in no Büchi"),
        ("1 Inf(0)", "1 Inf(1)", 5, "acceptance set 1 does not exist"),
        ("1 Inf(0)", "999 Inf(1)", 5, "more than 64"),
        ("1 Inf(0)", "1 " + "(" * 5000, 5, "'(' is in no Büchi"),
        ("--BODY--", "--ABORT--", 6, "aborted"),
        ('AP: 1 "a"', 'AP: 2 "a" --ABORT--', 2, "aborted"),
        ("[0] 0", "[0 & --ABORT--", 8, "aborted"),
        ("--END--", "--ABORT--", 9, "aborted"),
        # Other kinds of acceptance, each as the format writes it.
        ("1 Inf(0)", "1 Fin(0)", 5, "'Fin' is in no Büchi"),
        ("1 Inf(0)", "3 Fin(0)|Fin(1)|Fin(2)", 5, "'Fin' is in no Büchi"),
        ("1 Inf(0)", "2 Fin(0)&Inf(1)", 5, "'Fin' is in no Büchi"),
        ("1 Inf(0)", "2 (Fin(0)|Inf(1))", 5, "'Fin' is in no Büchi"),
        ("1 Inf(0)", "3 Inf(0)&Inf(1)&Fin(2)", 5, "'Fin' is in no Büchi"),
        ("1 Inf(0)", "3 Inf(0) | (Fin(0)&Fin(1)&Inf(2))", 5, "'Fin' is in no Büchi"),
        ("1 Inf(0)", "2 Inf(0)&(Inf(1)|Fin(0))", 5, "'Fin' is in no Büchi"),
        ("1 Inf(0)", "40 " + "|".join(f"(Inf({i})&Inf({i + 20}))" for i in range(20)), 5, "when it is multiplied out"),
        ("1 Inf(0)", "2 Inf(0)|Inf(1) acc-name: Buchi", 5, "acc-name: says Buchi"),
        ("1 Inf(0)", "1 Inf(0) Inf(0)", 5, "--BODY-- is expected here"),
        # A name of the acceptance that says something else than the condition.
        ("States: 1", "acc-name: co-Buchi", 3, "acc-name: says co-Buchi"),
        ("States: 1", "acc-name: Rabin 1", 3, "acc-name: says Rabin 1"),
        ("States: 1", "acc-name: all", 3, "acc-name: says all"),
        ("States: 1", "acc-name: none", 3, "acc-name: says none"),
        ("States: 1", "acc-name: generalized-Buchi 2", 3, "acc-name: says generalized-Buchi 2"),
        ("States: 1", "acc-name: generalized-Buchi", 3, "acc-name: says generalized-Buchi"),
        ("1 Inf(0)", "1 t acc-name: Buchi", 5, "acc-name: says Buchi"),
        ("1 Inf(0)", "1 Inf(!0) acc-name: Buchi", 5, "acc-name: says Buchi"),
        ("1 Inf(0)", "2 Inf(0)&Inf(1) acc-name: Buchi", 5, "acc-name: says Buchi"),
        # Properties that the automaton does not have.
        ("States: 1", "properties: univ-branch", 3, "universal branching"),
        ("States: 1", "properties: x trans-acc", 3, "says trans-acc, but in line 7 a state is in acceptance sets"),
        ("States: 1", "properties: state-labels", 3, "says state-labels, but in line 7 edges have labels"),
        ("States: 1", "properties: implicit-labels", 3, "says implicit-labels, but in line 7 edges have labels"),
        ("States: 1", "properties: deterministic complete", 3, "says complete, and the automaton is not"),
        ("--BODY--\n", "", 6, "State: is not known"),
        ("State: 0 {0}", "State: 0 {1}", 7, "acceptance set 1 does not exist"),
        ("State: 0 {0}", "State: 0 {0} State: 0", 7, "defined twice"),
        ("State: 0 {0}", "State: [0] 0 {0}", 8, "so that its edges have none"),
        ("[0] 0", "[0] 0&0", 8, "alternating"),
        ("[0] 0", "[0] 1", 8, "state 1 does not exist"),
        ("States: 1\nStart: 0", "States: 3\nStart: 2", 4, "state 2 is never defined"),
        (
            "States: 1",
            "properties: deterministic !complete !deterministic",
            3,
            "says !deterministic, and the automaton",
        ),
        ("[0] 0", "[1] 0", 8, "proposition 1 does not exist"),
        ("[0] 0", "[99] 0", 8, "proposition 99 does not exist"),
        ("[0] 0", "[@x] 0", 8, "alias @x is not defined"),
        ("[0] 0", "[0&] 0", 8, "']' is no part of a label"),
        ("[0] 0", "[0 0", 8, "] is expected here"),
        ("[0] 0", "[" + "(" * 5000, 8, "'(' is no part of a label"),
        ("[0] 0", "[0] 0 0", 7, "some have none"),
        ("[0] 0", "0", 7, "1 edges without labels, not 2"),
        ("[0] 0", "[x] 0", 8, "'x' is no part of a label"),
        ("[0] 0", "§", 8, "'§' has no meaning"),
        ("[0] 0", "/* ", 8, "never closed"),
        ("--END--", "", 10, "State: or --END-- is expected"),
        ("--END--", "--END-- HOA: v1", 9, "one automaton is read"),
    ],
)
def test_what_is_refused_with_line_and_reason(old: str, new: str, line: int, message: str) -> None:
    assert parse_hoa(GOOD).size == 1
    with pytest.raises(SpecError) as caught:
        parse_hoa(GOOD.replace(old, new, 1))
    (fault,) = caught.value.faults
    assert message in fault.message
    assert fault.line == line
    assert fault.column >= 1


DETERMINISTIC = (
    'HOA: v1 AP: 1 "a" Start: 0 Acceptance: 1 Inf(0)\nproperties: deterministic --BODY-- State: 0 {0} [0] 0 '
)


@pytest.mark.parametrize("more", ["[t] 1 State: 1", "[0] 0 {0} [0] 1 State: 1"])
def test_a_choice_is_not_deterministic(more: str) -> None:
    assert parse_generalised(DETERMINISTIC + "[!0] 1 State: 1 --END--").deterministic
    with pytest.raises(SpecError, match="says deterministic, and the automaton is not"):
        parse_hoa(DETERMINISTIC + more + " --END--")


@pytest.mark.parametrize(
    ("properties", "body", "message"),
    [
        ("state-acc", "State: 0 [t] 0 {0}", "an edge is in acceptance sets"),
        ("trans-labels", "State: [t] 0 0", "a state has a label"),
        ("explicit-labels", "State: 0 0 0", "edges have no labels"),
        ("state-labels", "State: 0 0 0", "edges have no labels"),
        ("implicit-labels", "State: [t] 0 0", "a state has a label"),
    ],
)
def test_properties_say_how_the_body_is_written(properties: str, body: str, message: str) -> None:
    text = f'HOA: v1 AP: 1 "a" Start: 0 Acceptance: 1 Inf(0) properties: {properties} --BODY-- {body} --END--'
    with pytest.raises(SpecError, match=f"says {properties}, but in line 1 {message}"):
        parse_hoa(text)
    assert parse_hoa(text.replace(properties, "weak very-weak unambiguous stutter-invariant colored")).size == 1


@pytest.mark.parametrize(
    "acceptance",
    [
        "acc-name: Buchi Acceptance: 1 Inf(0)",
        "Acceptance: 1 (Inf(0)) acc-name: Buchi",
        "acc-name: generalized-Buchi 2 Acceptance: 2 Inf(1)&Inf(0)",
        "acc-name: generalized-Buchi 0 Acceptance: 0 t",
        "acc-name: Streett 0 Acceptance: 0 t",
        "acc-name: parity max even 1 Acceptance: 1 Inf(0)",
        "acc-name: x-of-its-own t 3 Acceptance: 1 Inf(0)",
    ],
)
def test_names_that_agree_with_the_acceptance(acceptance: str) -> None:
    marks = "{0 1}" if "Inf(1)" in acceptance else "{0}" if "Inf" in acceptance else ""
    text = f'HOA: v1 AP: 1 "a" Start: 0 {acceptance} --BODY-- State: 0 {marks} [0] 0 --END--'
    accepts_exactly(parse_hoa(text), "G a")


@pytest.mark.parametrize(("edge", "line", "column"), [("\n[!0] 7", 9, 6), ("\n  [!0] 1", 9, 8), ("\n[f] 5", 9, 5)])
@pytest.mark.parametrize("states", ["", "States: 9"])
def test_an_edge_to_a_state_that_is_never_defined_is_refused(edge: str, line: int, column: int, states: str) -> None:
    with pytest.raises(SpecError) as caught:
        parse_hoa(GOOD.replace("States: 1", states).replace("[0] 0", f"[0] 0{edge}"))
    (fault,) = caught.value.faults
    assert (fault.line, fault.column) == (line, column)
    assert "is never defined" in fault.message


def test_states_that_nothing_leads_to_need_not_be_defined() -> None:
    assert parse_hoa(GOOD.replace("States: 1", "States: 4")).size == 4


@pytest.mark.parametrize(
    ("condition", "formula"),
    [
        ("2 Inf(0)|Inf(1)", "G F a | G F b"),
        ("3 (Inf(0)|Inf(1)) & Inf(2)", "(G F a | G F b) & G F (a & b)"),
        ("3 Inf(2) | Inf(0)&Inf(1)", "G F (a & b) | G F a & G F b"),
        ("3 Inf(!0) | Inf(1)", "G F !a | G F b"),
        ("2 Inf(0)&(Inf(1)|Inf(0))", "G F a"),
        ("2 Inf(0)|t", "true"),
    ],
)
def test_sets_that_recur_are_read_in_any_combination(condition: str, formula: str) -> None:
    edges = "[0&!1] 0 {0} [!0&1] 0 {1} [0&1] 0 {0 1 2} [!0&!1] 0"
    edges = edges if condition[0] == "3" else edges.replace("0 1 2", "0 1")
    text = f'HOA: v1 AP: 2 "a" "b" Start: 0 Acceptance: {condition} --BODY-- State: 0 {edges} --END--'
    accepts_exactly(parse_hoa(text), formula)


def test_version_1_1_adds_names_with_dots_and_properties_that_are_denied() -> None:
    more = "HOA: v1.1\nspot.highlight.edges: 1 2\ncontrollable-AP: 0\nproperties: !complete deterministic x.y !weak"
    assert parse_generalised(GOOD.replace("HOA: v1", more)) == parse_generalised(GOOD)
    assert parse_generalised(GOOD.replace("HOA: v1", "HOA: v1.1")) == parse_generalised(GOOD)
    with pytest.raises(SpecError, match=r"version v1\.2 of the format is not known"):
        parse_hoa(GOOD.replace("HOA: v1", "HOA: v1.2"))
    with pytest.raises(SpecError, match=r"Spot\.x: is not known, and could change"):
        parse_hoa(GOOD.replace("HOA: v1", "HOA: v1.1 Spot.x: 1"))


def test_a_byte_order_mark_is_read() -> None:
    assert parse_generalised("\ufeff" + GOOD) == parse_generalised(GOOD)
    with pytest.raises(SpecError) as caught:
        parse_hoa("\ufeff" + GOOD.replace("HOA: v1", "HOA: v2"))
    assert (caught.value.faults[0].line, caught.value.faults[0].column) == (1, 6)


def parity(width: int) -> str:
    """Aliases of few characters each; the last one is true where an odd number of propositions holds."""
    odd = [f"Alias: @{i} @{i - 1}&!{i}|!@{i - 1}&{i}" for i in range(1, width)]
    return "\n".join(["Alias: @0 0", *odd])


def header(propositions: int, sets: int, more: str = "") -> str:
    names = " ".join(f'"a{i}"' for i in range(propositions))
    condition = "&".join(f"Inf({i})" for i in range(sets))
    return f"HOA: v1 AP: {propositions} {names} Start: 0 Acceptance: {sets} {condition} {more} --BODY--\n"


REST = "".join(f" State: {i}" for i in range(1, 24))


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (header(32, 1, parity(32)) + "State: 0 {0} [@31] 0 --END--", "too complicated"),
        (
            header(24, 2) + "State: 0 " + " ".join(f"[{i}] {i} {{0}}" for i in range(24)) + REST + " --END--",
            "24 states and 2 acceptance sets, too many",
        ),
        (
            header(1, 64) + "".join(f"State: {i} [0] {i + 1}\n" for i in range(4000)) + "State: 4000 --END--",
            "4001 states and 64 acceptance sets",
        ),
    ],
)
def test_short_files_of_huge_automata_are_refused(text: str, message: str) -> None:
    assert len(text) < 100_000
    with pytest.raises((SpecError, AutomatonSizeError), match=message):
        parse_hoa(text)


def test_a_long_chain_of_states_is_read() -> None:
    chain = "".join(f"State: {i} [0] {i + 1} {{0}}\n" for i in range(2000))
    automaton = parse_hoa(header(1, 2) + chain + "State: 2000 {0 1} [t] 2000 --END--")
    assert automaton.size == 2001


def test_a_file_of_any_size_is_answered() -> None:
    with pytest.raises(SpecError, match="characters"):
        parse_hoa("x" * 5_000_000)


SEEDS = (
    STATE_BASED,
    'HOA: v1 AP: 2 "a" "b" Acceptance: 2 (Inf(0) & Inf(1)) Start: 0 --BODY-- State: 0 0 0 {0} 0 {1} 0 {0 1} --END--',
    (
        'HOA: v1 AP: 1 "a" States: 2 Start: 0 Start: 1 Acceptance: 2 Inf(0)&Inf(!1) properties: state-labels --BODY--\n'
        "State: [0] 0 {0} 0 1 State: [!0] 1 0 1 --END--"
    ),
    to_hoa(translate_generalised(parse_formula("G F a & G F b & G (c -> F d)"))),
    to_hoa(translate(parse_formula("F (a & F b) & G !c | G F d"))),
)
_TOKENS = re.compile(r'"(?:[^"\\]|\\.)*"|[\w@-]+:?|[^\w\s]|\s+')


def read_or_refused(text: str) -> None:
    faults = None
    try:
        automaton = parse_hoa(text)
        assert parse_hoa(to_hoa(automaton)) == automaton
    except SpecError as error:
        faults = error.faults
    assert faults is None or (faults[0].line >= 1 and faults[0].column >= 1 and faults[0].message)


@given(
    st.sampled_from(SEEDS), st.integers(0, 2000), st.integers(0, 8), st.text('0123{}[]()&|!@ taf"/*-:\\', max_size=6)
)
@tried(300)
def test_damaged_files_raise_nothing_else(text: str, start: int, length: int, inserted: str) -> None:
    start %= len(text)
    read_or_refused(text[:start] + inserted + text[start + length :])


@given(st.sampled_from(SEEDS), st.lists(st.tuples(*[st.integers(0, 10_000)] * 3), min_size=1, max_size=4))
@tried(400)
def test_files_with_tokens_out_of_place_raise_nothing_else(text: str, changes: list[tuple[int, int, int]]) -> None:
    pieces = _TOKENS.findall(text)
    others = [piece for seed in SEEDS for piece in _TOKENS.findall(seed)]
    for where, what, how in changes:
        place = where % len(pieces)
        kept = (pieces[place],) if how % 3 else ()  # a token is replaced, doubled, or followed by a stranger
        new = (pieces[place],) if how % 3 == 1 else (others[what % len(others)],)
        pieces[place : place + 1] = [*kept, *new]
    read_or_refused("".join(pieces))


@pytest.mark.long
@pytest.mark.timeout(1200)
@given(st.sampled_from(SEEDS), st.lists(st.tuples(*[st.integers(0, 10_000)] * 3), min_size=1, max_size=12))
@settings(max_examples=20_000, deadline=None)
def test_many_files_with_tokens_out_of_place(text: str, changes: list[tuple[int, int, int]]) -> None:
    pieces = _TOKENS.findall(text)
    for where, what, how in changes:
        first, second = where % len(pieces), what % len(pieces)
        if how % 3 == 0:
            pieces[first], pieces[second] = pieces[second], pieces[first]
        elif how % 3 == 1:
            pieces[first:first] = pieces[second : second + how % 7]
        elif len(pieces) > 20:
            del pieces[first : first + how % 5]
    read_or_refused("".join(pieces))
