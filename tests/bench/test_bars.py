"""Every bar that automata and search are held against, in one table.

    python -m pytest -m bench -n 0 -s tests/bench/test_bars.py

Times are of the processor, as nothing here runs in parallel, and they are held against others of the same run: a
translation against a loop of a million turns, a search against scipy's Dijkstra over the same triangles, for each state
of its automaton. Of each search the remark has the median by the wall, the memory of product and search, and how many
shortest runs there are. A new row is one more ``Bar`` in one of the functions below, a new search one more ``Case``.
"""

from collections.abc import Iterator
from dataclasses import replace
from functools import partial

import numpy as np
import pytest

from mission.logic.automata.translate import translate
from mission.logic.formula.parser import parse_formula
from mission.plan.best_runs import best_runs
from mission.planning.objective import Objective
from mission.planning.product import Product
from mission.planning.search import search
from mission.spec.model import Semantics
from mission.spec.specification import Specification
from tests.support.formulas import Measured, measured_formulas
from tests.support.measuring import Bar, Ratio, at_least, at_most, compared, loop, peak_mb, seconds, table, within
from tests.support.patrols import optimal_tour, patrol
from tests.support.searches import CASES, dijkstra_of, problem, searched

pytestmark = [pytest.mark.bench, pytest.mark.timeout(600)]

ROUNDS = 9
ROUNDS_OF_A_FORMULA = 3
EIGHT_TARGETS = 256  # states
TOUR, PATROLS = 8, 10


def translation(measured: Measured) -> Ratio:
    return compared(partial(translate, measured.formula), loop, ROUNDS_OF_A_FORMULA)


def of_automata() -> Iterator[Bar]:
    patterns, missions = measured_formulas("dac"), measured_formulas("mission")
    automata = {measured: translate(measured.formula) for measured in (*patterns, *missions)}
    of_patterns, of_missions = ([automata[measured] for measured in group] for group in (patterns, missions))
    yield at_most("55 specification patterns: states", sum(found.size for found in of_patterns), 214)
    yield at_most("55 specification patterns: edges", sum(found.edge_count for found in of_patterns), 614)
    yield at_least("55 specification patterns: deterministic", sum(found.deterministic for found in of_patterns), 48)
    yield at_most("25 mission formulas: states", sum(found.size for found in of_missions), 619)
    yield at_least("25 mission formulas: deterministic", sum(found.deterministic for found in of_missions), 24)
    times = {measured: translation(measured) for measured in automata}
    large = {measured for measured, found in automata.items() if found.size >= EIGHT_TARGETS}
    for what, bar, group in (
        ("slowest formula but those of 8 targets", 10, times.keys() - large),
        ("slowest formula of 8 targets", 20, large),
    ):
        slowest = max(group, key=lambda measured: times[measured].units)
        remark = f"{slowest.group} {slowest.number}, {automata[slowest].size} states"
        yield within(what, times[slowest], bar, "the loop", remark)


def of_searches() -> Iterator[Bar]:
    as_short = 0
    for case in CASES:
        system, automaton, start = problem(case)
        find = partial(searched, system, automaton, start)
        took, memory_mb, runs = compared(find, dijkstra_of(system, start), ROUNDS), peak_mb(find), find()
        as_short += all(
            system.weights[list(run.states), list(run.controls)].sum() == runs.cost
            for run in (runs[0], runs[runs.count - 1])
        )
        remark = (
            f"wall {seconds(took.times.wall_s)}, {memory_mb:.0f} MB, {float(runs.count):.1e} runs of cost {runs.cost}"
        )
        took = replace(took, units=took.units / case.states)
        yield within(f"search: {case.name}", took, case.bar, "Dijkstra a state", remark)
    yield at_least("searches whose last counted run is as short as the first", as_short, len(CASES))


def of_tours() -> Iterator[Bar]:
    formula = parse_formula(" & ".join(f"G F r{i}" for i in range(TOUR)))
    required, best, ratios = Specification(formula), 0, []
    for seed in range(PATROLS):
        system = patrol(seed, 100, TOUR, 1, 1)
        start = int(np.argmax(system.letter_of == 0))
        found = best_runs(system, required, start, Semantics.STANDARD, Objective())
        best += found.exact and len(found.runs[0].suffix) == optimal_tour(system, start, TOUR)
        waiting = Product(system, found.product.automaton.in_turn(), start, Semantics.STANDARD)
        in_turn = search(waiting, closing=True)
        ratios.append(len(in_turn[0].suffix) / len(found.runs[0].suffix))
    remark = f"one fixed order is up to {max(ratios):.2f} times longer, {sum(ratios) / PATROLS:.2f} on average"
    yield at_least(f"patrols of {TOUR} regions that match the tour found by brute force", best, PATROLS, remark)


def test_every_bar_is_met() -> None:
    bars = [*of_automata(), *of_searches(), *of_tours()]
    print(f"\n{table(bars)}")
    assert not [bar.what for bar in bars if not bar.met]
