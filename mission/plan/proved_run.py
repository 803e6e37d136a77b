"""The run that is flown: the one that was chosen, or where nobody chose and it cannot be proved, another as good.

Whether a run can be smoothed with a proof shows only when it is tried: its path may pass close by a region that its
word must leave out. Then runs through the triangle from which that region may be entered are likely to fail as well:
they are left for last. Runs whose numbers are close differ in little, so that the others are looked at in an order that
spreads over all of them. A run that fails may cost many attempts at a smoothing: of the others, each is first smoothed
with all the frequencies there may be, and only where that is proved, with fewer.
"""

from collections import Counter
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from itertools import islice, pairwise
from typing import Final

from mission.errors import NoPlanError, UnprovedError
from mission.plan.best_runs import Runs
from mission.planning.run import Run
from mission.steering.path import SteeringPath
from mission.steering.proved_smoothing import ProvedCurve

MOST_OTHERS: Final = 8
"""Runs that are tried beside the first one."""

_LOOKED_AT: Final = 1024  # runs among which those are that are tried


@dataclass(frozen=True)
class PassedOver:
    """A run that is as good as the one that is flown, and was not proved.

    Attributes:
        index: Its number among the shortest runs.
        reason: Why, in plain words.
    """

    index: int
    reason: str


class NoneProvedError(NoPlanError):
    """None of the runs that were tried is proved.

    Attributes:
        passed_over: The runs.
        blamed: The triangles of theirs at which proofs fail, those of most runs first, each with what fails.
    """

    def __init__(self, message: str, *, passed_over: tuple[PassedOver, ...], blamed: dict[int, str]) -> None:
        super().__init__(message)
        self.passed_over, self.blamed = passed_over, blamed


@dataclass(frozen=True, eq=False)
class ProvedRun:
    """A run with a proof.

    Attributes:
        index: Its number among the shortest runs.
        run: The run.
        path: The path that steers through it.
        proved: The smoothed path.
        passed_over: The runs that were tried before.
    """

    index: int
    run: Run
    path: SteeringPath
    proved: ProvedCurve
    passed_over: tuple[PassedOver, ...]


def proved_run(
    runs: Runs,
    index: int,
    path_of: Callable[[Run], SteeringPath],
    smoothed: Callable[[Run, SteeringPath, bool], ProvedCurve],
    *,
    others: bool,
    doubtful: bool = False,
) -> ProvedRun:
    """Prove a run, or another one that is as good.

    Args:
        runs: The shortest runs.
        index: The number of the one that is tried first.
        path_of: Steers through a run.
        smoothed: Smooths the path of a run with a proof, with as few frequencies as it needs; whether to try with all
            of them first. Raises UnprovedError where there is no proof.
        others: Whether others may be flown.
        doubtful: Whether even the first one is likely to have no proof.

    Raises:
        NoneProvedError: None of those that were tried is proved; says why the first one is not.
    """
    passed_over: list[PassedOver] = []
    blamed: Counter[int] = Counter()
    why: dict[int, str] = {}
    waiting = list(islice(spread_from(index, runs.count), _LOOKED_AT if others else 1))
    while waiting and len(passed_over) <= MOST_OTHERS:
        avoiding = (i for i in waiting if blamed.keys().isdisjoint(runs[i].states)) if blamed else iter(waiting)
        number = next(avoiding, waiting[0])
        waiting.remove(number)
        run = runs[number]
        path = path_of(run)
        try:
            return ProvedRun(number, run, path, smoothed(run, path, doubtful or bool(passed_over)), tuple(passed_over))
        except UnprovedError as error:
            passed_over.append(PassedOver(number, str(error)))
            guilty = set(_left_from(run, error.counterexample)) or set(_at(path, error.where_s))
            blamed.update(sorted(guilty))
            why = dict.fromkeys(guilty, str(error)) | why
    more = len(passed_over) - 1
    also = f"; nor is any of {more} others of the {runs.count} runs that are as short" if more else ""
    raise NoneProvedError(
        f"{passed_over[0].reason}{also}",
        passed_over=tuple(passed_over),
        blamed={triangle: why[triangle] for triangle, _ in blamed.most_common()},
    )


def _left_from(run: Run, counterexample: tuple[int, ...]) -> Iterator[int]:
    """The triangles of a run from which a violating flight in its tube goes where the run never is."""
    planned = frozenset(run.states)
    return (before for before, after in pairwise(counterexample) if before in planned and after not in planned)


def _at(path: SteeringPath, where_s: float | None) -> tuple[int, ...]:
    """The triangle of a path at a time."""
    if where_s is None:
        return ()
    return tuple(segment.triangle for segment in path.segments if segment.start_s <= where_s)[-1:]


def spread_from(index: int, count: int) -> Iterator[int]:
    """The numbers 0 to ``count - 1``, each once, from ``index`` on: halfway round from there, then the quarters, ..."""
    yield index
    seen, parts = {index}, 1
    while len(seen) < count:
        parts *= 2
        for odd in range(1, parts, 2):
            number = (index + count * odd // parts) % count
            if number not in seen:
                seen.add(number)
                yield number
