"""Size of the automaton and time of the translation, formula by formula, beside the best known translator.

python -m pytest -m bench -n 0 -s tests/bench/test_bench_automata.py
"""

from functools import partial

import pytest

from mission.logic.automata.translate import translate
from tests.support.formulas import measured_formulas
from tests.support.measuring import timed

REPETITIONS = 3


@pytest.mark.bench
@pytest.mark.timeout(600)
@pytest.mark.parametrize("group", ["dac", "mission"])
def test_automata_of_the_measured_formulas(group: str) -> None:
    print(f"\n{'formula':<12}{'states':>14}{'edges':>16}{'deterministic':>16}{'time':>12}")
    sums = [0] * 6
    slowest = 0.0
    for measured in measured_formulas(group):
        automaton = translate(measured.formula)
        found = (automaton.size, automaton.edge_count, int(automaton.deterministic))
        known = (measured.states, measured.edges, int(measured.deterministic))
        sums = [total + value for total, value in zip(sums, found + known, strict=True)]
        seconds = timed(partial(translate, measured.formula), REPETITIONS).processor_s
        slowest = max(slowest, seconds)
        cells = [f"{mine} ({theirs})" for mine, theirs in zip(found, known, strict=True)]
        name = f"{group} {measured.number}"
        print(f"{name:<12}{cells[0]:>14}{cells[1]:>16}{cells[2]:>16}{seconds * 1e3:>9.1f} ms")
    cells = [f"{mine} ({theirs})" for mine, theirs in zip(sums[:3], sums[3:], strict=True)]
    print(f"{'sum':<12}{cells[0]:>14}{cells[1]:>16}{cells[2]:>16}{slowest * 1e3:>9.1f} ms slowest")
    print("in parentheses: the best known translator")
