"""Smallest cores against brute force over all subsets."""

from itertools import combinations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from mission.errors import AutomatonSizeError
from mission.plan import core as core_module
from mission.plan.core import Core, smallest_core
from tests.support.drawn_cases import tried

Family = list[frozenset[int]]
CONFLICTS = st.lists(st.frozensets(st.integers(0, 6), min_size=1), max_size=5)


def solver_of(conflicts: Family, asked: Family) -> core_module.Solver:
    """Any set is met that holds no conflict; what it is met with grows as long as that stays true."""

    def solve(members: tuple[int, ...]) -> int | None:
        asked.append(frozenset(members))
        met = set(members)
        if any(conflict <= met for conflict in conflicts):
            return None
        for other in range(7):
            if not any(conflict <= met | {other} for conflict in conflicts):
                met.add(other)
        return sum(1 << member for member in met)

    return solve


@given(CONFLICTS)
def test_the_core_is_the_first_of_the_smallest_conflicts(conflicts: Family) -> None:
    subsets = [set(chosen) for size in range(1, 8) for chosen in combinations(range(7), size)]
    first = next((tuple(sorted(s)) for s in subsets if any(conflict <= s for conflict in conflicts)), None)
    expected = None if first is None else Core(first, smallest=True)
    assert smallest_core(7, solver_of(conflicts, [])) == expected


@given(CONFLICTS)
def test_no_set_is_tried_that_a_known_solution_meets(conflicts: Family) -> None:
    asked: Family = []
    smallest_core(7, solver_of(conflicts, asked))
    solve = solver_of(conflicts, [])
    known: list[int] = []
    for members in asked:
        bits = sum(1 << member for member in members)
        assert all(bits & ~met for met in known) or len(members) == 7
        met = solve(tuple(sorted(members)))
        known.extend([] if met is None else [met])


@tried(50)
@given(CONFLICTS)
def test_beyond_the_bound_a_core_still_needs_all_its_members(conflicts: Family) -> None:
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(core_module, "MAX_QUESTIONS", 0)
        core = smallest_core(7, solver_of(conflicts, []))
    if core is None:
        assert not conflicts
        return
    assert not core.smallest
    members = frozenset(core.members)
    assert any(conflict <= members for conflict in conflicts)
    assert not any(conflict <= members - {member} for member in members for conflict in conflicts)


def test_sets_that_are_too_large_a_question_are_passed_over() -> None:
    def solve(members: tuple[int, ...]) -> int | None:
        if len(members) == 2:
            raise AutomatonSizeError("too large")
        return None if len(members) == 3 else sum(1 << member for member in members)

    assert smallest_core(3, solve) == Core((0, 1, 2), smallest=False)
    assert smallest_core(2, solve) is None
