from itertools import product

import pytest
from hypothesis import given
from hypothesis import strategies as st

from mission.logic.automata.diagrams import Diagram, Diagrams, TooLargeError
from tests.support.drawn_cases import tried

WIDTH = 4
truth_tables = st.integers(0, (1 << (1 << WIDTH)) - 1)


def of_table(diagrams: Diagrams, table: int) -> Diagram:
    """The function that is true for assignment i where bit i of ``table`` is set."""
    rows = (diagrams.cube((bits, ~bits & (1 << WIDTH) - 1)) for bits in range(1 << WIDTH) if table >> bits & 1)
    return diagrams.any_of(rows)


def table_of(diagrams: Diagrams, diagram: Diagram) -> int:
    return sum(1 << bits for bits in range(1 << WIDTH) if diagrams.evaluate(diagram, bits) is True)


@given(truth_tables, truth_tables)
@tried(60)
def test_boolean_operations_and_canonicity(first: int, second: int) -> None:
    diagrams = Diagrams()
    a, b = of_table(diagrams, first), of_table(diagrams, second)
    everything = (1 << (1 << WIDTH)) - 1
    assert table_of(diagrams, a) == first
    assert diagrams.both(a, b) == of_table(diagrams, first & second)
    assert diagrams.either(a, b) == of_table(diagrams, first | second)
    assert diagrams.neither(a) == of_table(diagrams, ~first & everything)
    assert (a == b) == (first == second)


@given(truth_tables)
@tried(60)
def test_covers_are_exact_and_irredundant(table: int) -> None:
    diagrams = Diagrams()
    function = of_table(diagrams, table)
    cubes = diagrams.cover(function)
    assert diagrams.any_of(map(diagrams.cube, cubes)) == function
    for index in range(len(cubes)):
        rest = diagrams.any_of(map(diagrams.cube, cubes[:index] + cubes[index + 1 :]))
        assert rest != function


@given(st.lists(st.sampled_from("xyz"), min_size=1 << WIDTH, max_size=1 << WIDTH))
@tried(40)
def test_regions_and_paths_of_other_values(values: list[str]) -> None:
    diagrams = Diagrams()
    diagram = diagrams.leaf("x")
    for bits, value in enumerate(values):
        here = diagrams.cube((bits, ~bits & (1 << WIDTH) - 1))
        diagram = diagrams.choose(here, diagrams.leaf(value), diagram)
    regions = {diagrams.value[leaf]: where for leaf, where in diagrams.regions(diagram, {}).items()}
    assert set(regions) == set(values)
    for bits, value in enumerate(values):
        assert diagrams.evaluate(diagram, bits) == value
        assert diagrams.evaluate(regions[value], bits)
    assert {diagrams.value[leaf] for leaf in diagrams.leaves(diagram)} == set(values)
    paths = [(cube, diagrams.value[leaf]) for cube, leaf in diagrams.paths(diagram)]
    for bits, value in enumerate(values):
        assert [end for (holds, fails), end in paths if not (holds & ~bits or fails & bits)] == [value]


def test_combination_of_values() -> None:
    diagrams = Diagrams()
    first = diagrams.test(0, diagrams.leaf(1), diagrams.leaf(2))
    second = diagrams.test(1, diagrams.leaf(10), diagrams.leaf(20))
    total = diagrams.combine(first, second, lambda a, b: a + b, {})
    found = {bits: diagrams.evaluate(total, bits) for bits in range(4)}
    assert found == {a | b << 1: (1, 2)[a] + (10, 20)[b] for a, b in product((0, 1), repeat=2)}


def test_a_pool_grows_as_far_as_it_is_allowed() -> None:
    diagrams = Diagrams()
    diagrams.allow(3)
    for variable in range(3):
        diagrams.literal(variable)
    with pytest.raises(TooLargeError):
        diagrams.literal(3)
