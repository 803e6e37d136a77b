"""Classes of the temporal hierarchy, and what follows for deterministic automata."""

from itertools import count, islice
from random import Random

import pytest

from mission.logic.automata import translate as translation
from mission.logic.automata.translate import translate
from mission.logic.automata.weak import is_obligation, is_persistence
from mission.logic.formula.parser import parse_formula
from mission.logic.formula.rewriting import simplified
from tests.support.formulas import random_formula

RECURRENT = " & ".join(f"G F a{i}" for i in range(8))


@pytest.mark.parametrize(
    ("text", "obligation", "persistence"),
    [
        ("G !a", True, True),
        ("F a", True, True),
        ("F a | G b", True, True),
        ("G a U F b", True, True),
        ("F G a", False, True),
        ("F (a & G b)", False, True),
        ("a U G b", False, True),
        ("F G a M F b", False, True),
        ("a W F G b", False, True),
        ("F G b R a", False, True),
        ("G F a", False, False),
        ("F G a | G F b", False, False),
        ("F G a W b", False, False),
        (f"!({RECURRENT} & G (b -> F c))", False, True),
    ],
)
def test_classes_of_formulas(text: str, obligation: bool, persistence: bool) -> None:  # noqa: FBT001 - a table
    formula = simplified(parse_formula(text))
    assert (is_obligation(formula), is_persistence(formula)) == (obligation, persistence)


@pytest.mark.parametrize(
    "text", [f"!({RECURRENT} & G (b -> F c))", f"!({RECURRENT})", "F (a & G b) | F G c", "F k | F G !a | F (b & G !c)"]
)
def test_no_deterministic_automaton_is_looked_for_where_there_is_none(
    text: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    looked: list[object] = []
    monkeypatch.setattr(translation, "accepting_like", lambda *arguments: looked.append(arguments))
    assert not translate(parse_formula(text)).deterministic
    assert not looked


@pytest.mark.parametrize("seed", range(2))
def test_none_is_missed_where_there_is_one(seed: int, monkeypatch: pytest.MonkeyPatch) -> None:
    """Formulas that ask for something from some time on, and may be obligations that do not look like it."""
    random = Random(seed)  # noqa: S311 - no secrets here
    drawn = (random_formula(random, random.randint(4, 8), ("a", "b", "c")) for _ in count())
    lasting = (f for f in drawn if is_persistence(simplified(f)) and not is_obligation(simplified(f)))
    formulas = list(islice(lasting, 25))
    quick = [translate(formula) for formula in formulas]
    monkeypatch.setattr(translation, "is_persistence", lambda _: False)
    assert quick == [translate(formula) for formula in formulas]
    assert any(automaton.deterministic for automaton in quick)
    assert not all(automaton.deterministic for automaton in quick)
