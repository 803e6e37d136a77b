"""Automata of formulas that are no targets: published sets, families that grow, and formulas by chance.

    python -m pytest -m bench -n 0 -s tests/bench/test_bench_families.py

Each is translated as it is and negated; times are of the processor, one round each, and slow is what takes longer than
so many million turns of a plain loop.
"""

from collections.abc import Iterator
from functools import partial
from random import Random

import pytest

from mission.errors import AutomatonSizeError
from mission.logic.automata.refutation import refutation
from mission.logic.automata.translate import translate, translate_generalised
from mission.logic.formula.parser import parse_formula
from mission.logic.formula.syntax import Formula, negation
from tests.support.families import ETESSAMI_HOLZMANN, FAMILIES, SOMENZI_BLOEM
from tests.support.formulas import random_formula
from tests.support.measuring import TURNS, timed, turn_s

pytestmark = [pytest.mark.bench, pytest.mark.timeout(1200)]

SIZES = (2, 4, 6)
CHANCE = 500
SLOW = 30


def described(formula: Formula) -> tuple[str, float]:
    """States, edges, kind and time of both automata."""
    try:
        automaton, generalised = translate(formula), translate_generalised(formula)
    except AutomatonSizeError:
        return "too large", timed(partial(_refused, formula), 1).processor_s
    seconds = timed(partial(translate, formula), 1).processor_s
    kind = "deterministic" if automaton.deterministic else ""
    size = f"{automaton.size:>6}{automaton.edge_count:>8}  {kind:<14}"
    return f"{size}{generalised.size:>6} /{generalised.sets:>2}{1e3 * seconds:>12.1f} ms", seconds


def _refused(formula: Formula) -> None:
    with pytest.raises(AutomatonSizeError):
        translate(formula)


def lines(name: str, formula: Formula) -> Iterator[str]:
    for shown, meaning in ((name, formula), (f"! {name}", negation(formula))):
        text, seconds = described(meaning)
        yield f"{shown:<28}{text}{'   slow' if seconds > SLOW * TURNS * turn_s() else ''}"


HEAD = f"\n{'':<28}{'states':>6}{'edges':>8}  {'':<14}{'generalised / sets':<10}{'time':>8}"


@pytest.mark.parametrize(
    ("name", "formulas"), [("Etessami, Holzmann", ETESSAMI_HOLZMANN), ("Somenzi, Bloem", SOMENZI_BLOEM)]
)
def test_published_sets(name: str, formulas: tuple[str, ...]) -> None:
    print(HEAD)
    for number, text in enumerate(formulas, start=1):
        print("\n".join(lines(f"{name} {number}", parse_formula(text))))


@pytest.mark.parametrize("family", FAMILIES)
def test_families_that_grow(family: str) -> None:
    print(HEAD)
    for size in SIZES:
        print("\n".join(lines(f"{family} {size}", parse_formula(FAMILIES[family](size)))), flush=True)


@pytest.mark.parametrize("operators", [5, 10, 15, 20])
def test_formulas_by_chance(operators: int) -> None:
    random = Random(operators)  # noqa: S311 - no secrets here
    formulas = [random_formula(random, operators, ("a", "b", "c", "d")) for _ in range(CHANCE)]
    automata = [translate(formula) for formula in formulas]
    times = sorted(timed(partial(translate, formula), 1).processor_s for formula in formulas)
    states, edges = sum(found.size for found in automata), sum(found.edge_count for found in automata)
    kinds = sum(found.deterministic for found in automata)
    print(
        f"\n{CHANCE} formulas of {operators} operators: {states} states, {edges} edges, {kinds} deterministic; "
        f"{1e3 * times[CHANCE // 2]:.1f} ms median, {1e3 * times[-1]:.1f} ms slowest"
    )
    assert times[-1] < SLOW * TURNS * turn_s()


@pytest.mark.parametrize("count", [4, 6, 8])
def test_what_recurrent_formulas_cost_negated(count: int) -> None:
    patrol = " & ".join(f"G F a{i}" for i in range(count))
    formula = parse_formula(f"{patrol} & G (b -> F c)")
    whole, negated, apart = (
        timed(partial(build, meaning), 3).processor_s
        for build, meaning in ((translate, formula), (translate, negation(formula)), (refutation, formula))
    )
    print(f"patrol of {count} and a reaction: its negation takes {negated / whole:.2f} of its own time, and")
    print(f"    the negations of its conjuncts, side by side, {apart / negated:.2f} of that")
    assert negated <= 3.0 * whole
    assert apart <= negated
