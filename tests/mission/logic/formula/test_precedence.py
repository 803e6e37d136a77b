"""Which operator binds tighter: the order of Spot's grammar (parsetl.yy), each pair of operators tried."""

from itertools import product

import pytest

from mission.logic.formula.parser import parse_formula

LEVELS = (("->", "<->"), ("|",), ("xor", "^"), ("&",), ("U", "R", "W", "M"))
"""Binary operators, from the loosest to the tightest."""

TO_THE_RIGHT = ("->", "<->", "U", "R", "W", "M")
PREFIX = ("!", "X", "F", "G")
LEVEL_OF = {operator: level for level, operators in enumerate(LEVELS) for operator in operators}


@pytest.mark.parametrize(("first", "second"), list(product(LEVEL_OF, repeat=2)))
def test_binary_operators(first: str, second: str) -> None:
    apart = LEVEL_OF[first] - LEVEL_OF[second]
    left_first = apart > 0 or (apart == 0 and first not in TO_THE_RIGHT)
    meant = f"(a {first} b) {second} c" if left_first else f"a {first} (b {second} c)"
    assert parse_formula(f"a {first} b {second} c") is parse_formula(meant)


@pytest.mark.parametrize(("prefix", "binary"), list(product(PREFIX, LEVEL_OF)))
def test_prefix_operators_bind_tightest(prefix: str, binary: str) -> None:
    assert parse_formula(f"{prefix} a {binary} b") is parse_formula(f"({prefix} a) {binary} b")
    assert parse_formula(f"a {binary} {prefix} b") is parse_formula(f"a {binary} ({prefix} b)")
    assert parse_formula(f"a {binary} {prefix} b {binary} c") is not parse_formula(
        f"a {binary} {prefix} (b {binary} c)"
    )
