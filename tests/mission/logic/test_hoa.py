from random import Random

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from mission.errors import SpecError
from mission.logic.automaton import BuchiAutomaton
from mission.logic.hoa import parse_generalised, parse_hoa, to_hoa
from mission.logic.parser import parse_formula
from mission.logic.translate import translate, translate_generalised
from mission.logic.word import satisfies
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
        ("1 Inf(0)", "2 Inf(0)|Inf(1)", 5, "'|' is in no Büchi"),
        ("1 Inf(0)", "0 f", 5, "'f' is in no Büchi"),
        ("1 Inf(0)", "1 Inf(1)", 5, "acceptance set 1 does not exist"),
        ("1 Inf(0)", "999 Inf(1)", 5, "more than 64"),
        ("1 Inf(0)", "1 " + "(" * 5000, 5, "'(' is in no Büchi"),
        ("--BODY--", "--ABORT--", 6, "aborted"),
        ("--BODY--\n", "", 6, "State: is not known"),
        ("State: 0 {0}", "State: 0 {1}", 7, "acceptance set 1 does not exist"),
        ("State: 0 {0}", "State: 0 {0} State: 0", 7, "defined twice"),
        ("State: 0 {0}", "State: [0] 0 {0}", 8, "so that its edges have none"),
        ("[0] 0", "[0] 0&0", 8, "alternating"),
        ("[0] 0", "[0] 1", 8, "state 1 does not exist"),
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


def test_a_file_of_any_size_is_answered() -> None:
    with pytest.raises(SpecError, match="characters"):
        parse_hoa("x" * 5_000_000)


@given(st.integers(0, len(STATE_BASED)), st.integers(0, 8), st.text('0123{}[]()&|!@ taf"/*-:', max_size=6))
@settings(max_examples=300, deadline=None)
def test_damaged_files_raise_nothing_else(start: int, length: int, text: str) -> None:
    damaged = STATE_BASED[:start] + text + STATE_BASED[start + length :]
    faults = None
    try:
        parse_hoa(damaged)
    except SpecError as error:
        faults = error.faults
    assert faults is None or faults[0].line >= 1
