import subprocess
import sys
from collections.abc import Sequence
from itertools import combinations, product
from random import Random

import pytest

from mission.errors import AutomatonSizeError
from mission.logic.automata.automaton import BuchiAutomaton, compile_generalised, compile_to_alphabet
from mission.logic.automata.translate import translate, translate_generalised
from mission.logic.formula.parser import parse_formula
from mission.logic.formula.syntax import Formula, negation, proposition_order
from mission.logic.formula.word import satisfies
from mission.logic.hoa.text import parse_generalised, parse_hoa, to_hoa
from tests.support.families import ETESSAMI_HOLZMANN, FAMILIES, SOMENZI_BLOEM
from tests.support.formulas import GOLDEN, Measured, measured_formulas, random_formula, random_word
from tests.support.letters import Rows, accepts, have_common_word, rows_of

NAMES = ("a", "b", "c", "d")
LETTERS = tuple(frozenset(letter) for size in range(4) for letter in combinations(NAMES[:3], size))


def check(formula: Formula, random: Random, words: int) -> None:
    """Compare every form of the automata of a formula and of its negation with the meaning of the formula.

    On random words both must be right; that no word at all is accepted for both is found out exactly. Written as text
    and read again, an automaton must be the same.
    """
    compiled: list[list[Rows]] = []
    lassos = [random_word(random, NAMES[:3]) for _ in range(words)]
    for meaning in (formula, negation(formula)):
        automaton, generalised = translate(meaning), translate_generalised(meaning)
        assert parse_hoa(to_hoa(automaton)) == automaton
        assert parse_generalised(to_hoa(generalised)) == generalised
        forms = compile_to_alphabet(automaton, LETTERS), compile_generalised(generalised, LETTERS)
        compiled.append([rows_of(forms[0]), rows_of(forms[1])])
        for word in lassos:
            expected = satisfies(word, meaning)
            assert automaton.accepts(word) is expected, f"{meaning} on {word}"
            for rows in compiled[-1]:
                assert accepts(rows, LETTERS, word) is expected, f"{meaning} on {word}"
    for positive, negative in product(*compiled):
        assert not have_common_word(positive, negative), f"a word satisfies {formula} and its negation"


@pytest.mark.parametrize("seed", range(2))
def test_random_formulas_on_random_words(seed: int) -> None:
    random = Random(seed)  # noqa: S311 - no secrets here
    for _ in range(60):
        check(random_formula(random, random.randrange(1, 21), NAMES[: random.randrange(1, 5)]), random, 10)


@pytest.mark.long
@pytest.mark.timeout(1200)
@pytest.mark.parametrize("seed", range(100, 110))
def test_many_random_formulas_on_random_words(seed: int) -> None:
    random = Random(seed)  # noqa: S311 - no secrets here
    for _ in range(600):
        check(random_formula(random, random.randrange(1, 21), NAMES[: random.randrange(1, 5)]), random, 25)


@pytest.mark.parametrize("seed", range(2))
def test_generalised_automata_are_read_with_accepting_states(seed: int) -> None:
    random = Random(seed)  # noqa: S311 - no secrets here
    for _ in range(40):
        formula = random_formula(random, random.randrange(1, 13), NAMES[:3])
        automaton = parse_hoa(to_hoa(translate_generalised(formula)))
        for _ in range(12):
            word = random_word(random, NAMES[:3])
            assert automaton.accepts(word) is satisfies(word, formula), f"{formula} on {word}"


def totals(group: str) -> tuple[tuple[int, int, int], list[tuple[Measured, BuchiAutomaton]]]:
    found = [(measured, translate(measured.formula)) for measured in measured_formulas(group)]
    automata = [automaton for _, automaton in found]
    sums = (
        sum(automaton.size for automaton in automata),
        sum(automaton.edge_count for automaton in automata),
        sum(automaton.deterministic for automaton in automata),
    )
    return sums, found


def test_specification_patterns_have_small_and_right_automata() -> None:
    (states, edges, deterministic), found = totals("dac")
    assert states <= 214
    assert edges <= 614
    assert deterministic >= 48
    random = Random(7)  # noqa: S311 - no secrets here
    for measured, automaton in found:
        names = automaton.propositions
        for _ in range(40):
            word = random_word(random, names)
            assert automaton.accepts(word) is satisfies(word, measured.formula), f"{measured.formula} on {word}"


def test_missions_have_small_and_right_automata() -> None:
    (states, _, deterministic), found = totals("mission")
    assert states <= 619
    assert deterministic >= 24
    random = Random(8)  # noqa: S311 - no secrets here
    for measured, automaton in found:
        if automaton.size <= 64:
            for _ in range(20):
                word = random_word(random, automaton.propositions)
                assert automaton.accepts(word) is satisfies(word, measured.formula), f"{measured.formula} on {word}"


@pytest.mark.parametrize(
    ("texts", "states"),
    [
        (ETESSAMI_HOLZMANN, 94),
        (SOMENZI_BLOEM, 157),
        ([family(2) for family in FAMILIES.values()], 253),
    ],
    ids=["Etessami, Holzmann", "Somenzi, Bloem", "families of 2"],
)
def test_formulas_that_are_no_targets_have_small_and_right_automata(texts: Sequence[str], states: int) -> None:
    random, found = Random(9), 0  # noqa: S311 - no secrets here
    for text in texts:
        formula = parse_formula(text)
        names = proposition_order(formula)
        positive, negative = translate(formula), translate(negation(formula))
        found += positive.size + negative.size
        for _ in range(10):
            word = random_word(random, names)
            expected = satisfies(word, formula)
            assert positive.accepts(word) is expected, f"{formula} on {word}"
            assert negative.accepts(word) is not expected, f"!({formula}) on {word}"
    assert found <= states  # as measured, so that no change makes them larger unseen


def test_specification_patterns_have_the_automata_that_were_checked_in() -> None:
    known = (GOLDEN / "dac.hoa").read_text(encoding="utf-8")
    found = "".join(to_hoa(translate(measured.formula)) for measured in measured_formulas("dac"))
    assert found == known


def test_the_mission_of_the_paper() -> None:
    automaton = translate(parse_formula("F (S1 & F R) & G !K1"))
    edges = [(edge.source, str(edge.guard), edge.target) for edge in automaton.edges]
    assert edges == [
        (0, "!S1 & !K1", 0),
        (0, "S1 & !R & !K1", 1),
        (0, "S1 & R & !K1", 2),
        (1, "!R & !K1", 1),
        (1, "R & !K1", 2),
        (2, "!K1", 2),
    ]
    assert automaton.initial == (0,)
    assert automaton.accepting == {2}
    assert automaton.deterministic
    assert not automaton.complete


@pytest.mark.parametrize(("text", "states", "edges"), [("true", 1, 1), ("false", 1, 0), ("a & !a", 1, 0), ("a", 2, 2)])
def test_the_smallest_automata(text: str, states: int, edges: int) -> None:
    automaton = translate(parse_formula(text))
    assert (automaton.size, automaton.edge_count) == (states, edges)


def test_a_nondeterministic_automaton_where_a_deterministic_one_is_exponential() -> None:
    automaton = translate(parse_formula("F (a & " + "X " * 12 + "b)"))
    assert automaton.size <= 14


@pytest.mark.parametrize(
    ("text", "generalised", "sets", "states"),
    [
        *((f"F G {FAMILIES['U right'](number)}", number, 1, number + 1) for number in range(2, 7)),
        ("F G ((a U b) U (c U d))", 4, 2, 6),
        ("F G ((a U b) U (c U (d U e)))", 5, 2, 7),
        ("F G ((a U b) U ((c U d) U e))", 7, 3, 15),
    ],
)
def test_nested_untils_from_some_time_on(text: str, generalised: int, sets: int, states: int) -> None:
    """Bounds by automata made by hand.

    One state waits for the time; after it there is one for each set of inner untils that a run needs to have pending at
    once, the empty one included: with `A = a U b`, `C = c U d` and `B = C U e`, those of `A U B` are {}, A, B, C, AC
    and BC. There is an acceptance set for each formula that is last in an until: e, b and d. With accepting states, all
    sets of pending ones wait for e (6), those with A for b (2), those with C for d (3), and {}, A and B accept where
    the last wait ends. The others have fewer sets to wait for, and accept with nothing pending.
    """
    formula = parse_formula(text)
    small = translate_generalised(formula)
    assert small.size <= generalised
    assert small.sets <= sets
    automaton = translate(formula)
    assert automaton.size <= states
    random = Random(11)  # noqa: S311 - no secrets here
    for _ in range(40):
        word = random_word(random, automaton.propositions)
        assert automaton.accepts(word) is satisfies(word, formula), f"{formula} on {word}"


@pytest.mark.parametrize("shell", ["F G ({})", "G ({})", "G F ({})", "{} & G (a -> F b)"])
def test_eventualities_that_wait_for_the_same_are_met_together(shell: str) -> None:
    random = Random(shell)  # noqa: S311 - no secrets here
    for _ in range(4):
        text = "c"
        for _ in range(random.randrange(2, 5)):
            left, right, negated = random.choice("abc"), random.choice("abc"), random.choice(("", "!"))
            text = random.choice(
                (f"{left} U ({text})", f"({text}) U {right}", f"F {left} & ({text})", f"{negated}{left} | X ({text})")
            )
        check(parse_formula(shell.format(f"({text})")), random, 10)


@pytest.mark.parametrize(
    ("text", "states"),
    [
        ("X X !(X a M (F b M X X (X b -> !a)))", 8),
        ("X ((((F b M b) U b) W (a & (c <-> G c))) U a)", 6),
        ("X ((c <-> true M (F c & b)) R (true R a))", 4),
    ],
)
def test_the_smaller_one_is_taken_of_small_obligations_too(text: str, states: int) -> None:
    """A minimal deterministic automaton of 15, 7 and 5 states."""
    formula = parse_formula(text)
    automaton = translate(formula)
    assert automaton.size <= states
    random = Random(3)  # noqa: S311 - no secrets here
    for _ in range(60):
        word = random_word(random, automaton.propositions)
        assert automaton.accepts(word) is satisfies(word, formula)


def test_what_is_too_large_is_refused() -> None:
    with pytest.raises(AutomatonSizeError, match="nested deeper"):
        translate(parse_formula("X " * 300 + "a"))
    with pytest.raises(AutomatonSizeError, match="propositions"):
        translate(parse_formula(" | ".join(f"a{index}" for index in range(150))))
    with pytest.raises(AutomatonSizeError, match="more than"):
        translate(parse_formula("G (a -> " + "X " * 18 + "b)"))


def test_the_same_formula_gives_the_same_automaton_in_every_process() -> None:
    texts = ("G F a & (F b | G F c) & G (a -> X (b U c))", "F x & F y & G (x -> !y W z)", "F G a | G F b -> c U d")
    program = (
        "import sys; from mission.logic.automata import translate\n"
        "from mission.logic.formula import parser\n"
        "from mission.logic.hoa import text as hoa\n"
        "for text in sys.argv[1:]: print(hoa.to_hoa(translate.translate(parser.parse_formula(text))))"
    )
    outputs = {
        subprocess.run(  # noqa: S603 - this interpreter, with a program written above
            [sys.executable, "-c", program, *texts], env={"PYTHONHASHSEED": seed}, capture_output=True, check=True
        ).stdout
        for seed in ("0", "1", "4242")
    }
    assert len(outputs) == 1
    assert len(next(iter(outputs))) > 100
