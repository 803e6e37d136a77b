"""Smallest sets of constraints that cannot be met together.

A set of constraints cannot be met exactly where it shares a member with the rest that each solution leaves unmet: each
solution that is found rules out every set of constraints that it meets, which prunes the search by size to few
questions. Source of the duality: Reiter, "A theory of diagnosis from first principles" (1987); of its use for smallest
cores: Ignatiev, Previti, Liffiton and Marques-Silva, "Smallest MUS extraction with minimal hitting set dualization"
(2015).
"""

from collections.abc import Callable
from dataclasses import dataclass
from itertools import chain, combinations, islice
from typing import Final

from mission.errors import AutomatonSizeError

MAX_QUESTIONS: Final = 300
"""Sets of constraints that are tried in the order of their size."""

_MAX_SETS: Final = 200_000  # sets that are looked at, most of them ruled out by a solution that is known

Solver = Callable[[tuple[int, ...]], int | None]
"""From ascending constraints to a set, as bits, of constraints that some solution of theirs meets; None without one.

It may raise AutomatonSizeError.
"""


@dataclass(frozen=True)
class Core:
    """Constraints that cannot be met together.

    Attributes:
        members: Their numbers, ascending.
        smallest: Whether no other set with this property is smaller; False where the search met its bounds, and then
            the set may even hold members that are not needed.
    """

    members: tuple[int, ...]
    smallest: bool


def smallest_core(count: int, solve: Solver) -> Core | None:
    """A smallest set of the constraints 0 to ``count - 1`` that cannot be met; the first in order of size and place.

    Returns:
        None where all can be met together, or all together are too large a question.
    """
    solved: list[int] = []
    questions, open_questions = 0, False
    sets = chain.from_iterable(combinations(range(count), size) for size in range(1, count + 1))
    for members in islice(sets, _MAX_SETS):
        bits = sum(1 << member for member in members)
        if any(bits & ~met == 0 for met in solved):
            continue
        if questions == MAX_QUESTIONS:
            break
        questions += 1
        try:
            met = solve(members)
        except AutomatonSizeError:
            open_questions = True
            continue
        if met is None:
            return Core(members, smallest=not open_questions)
        solved.append(met | bits)
    return _reduced(count, solve)


def _reduced(count: int, solve: Solver) -> Core | None:
    """A core by leaving out what is not needed: halves first, then ever smaller parts, then single constraints."""
    members = tuple(range(count))
    if not _impossible(members, solve):
        return None
    size = count
    while size > 1:
        size = (size + 1) // 2
        begin = 0
        while begin < len(members):
            rest = members[:begin] + members[begin + size :]
            if rest and _impossible(rest, solve):
                members = rest
            else:
                begin += size
    return Core(members, smallest=False)


def _impossible(members: tuple[int, ...], solve: Solver) -> bool:
    try:
        return solve(members) is None
    except AutomatonSizeError:
        return False
