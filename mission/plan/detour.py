"""A run that costs more than the best ones do, where none of these can be proved.

The triangle at which a proof fails is closed, and the best runs of the map that remains are searched; again and again
while the first of these is not proved in turn. A triangle without which the mission has no run stays open.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Final

from mission.errors import NoPlanError, SearchSizeError
from mission.plan.best_runs import BestRuns
from mission.plan.proved_run import NoneProvedError, PassedOver, ProvedRun

MOST_SEARCHES: Final = 6
"""Times that a triangle is closed and the map searched again."""

_MOST_LISTED: Final = 8


@dataclass(frozen=True)
class Avoided:
    """A triangle that the run that is flown keeps out of.

    Attributes:
        triangle: Which.
        reason: What is not proved of a run through it, in plain words.
    """

    triangle: int
    reason: str


@dataclass(frozen=True)
class Avoidance:
    """Why the run that is flown costs more than the best ones.

    Attributes:
        triangles: Those that it keeps out of, at least one.
        best_costs: What the prefix and the suffix of a best run cost, in the unit of the mission's costs.
    """

    triangles: tuple[Avoided, ...]
    best_costs: tuple[float, float]

    @property
    def closed(self) -> tuple[int, ...]:
        """The numbers of the triangles."""
        return tuple(each.triangle for each in self.triangles)

    @property
    def listed(self) -> str:
        """The triangles within a sentence."""
        return _listed(self.triangles)


@dataclass(frozen=True, eq=False)
class Flown:
    """A proved run.

    Attributes:
        proved: The run.
        among: The best runs of the map without what was closed, of which it is one.
        passed_over: The best runs of all of the map that were tried before.
        avoided: The triangles that were closed, in this order.
    """

    proved: ProvedRun
    among: BestRuns
    passed_over: tuple[PassedOver, ...]
    avoided: tuple[Avoided, ...] = ()


def flown_run(
    best: BestRuns,
    proved: Callable[[BestRuns], ProvedRun],
    searched: Callable[[Sequence[int]], BestRuns],
    *,
    start: int,
    most_searches: int,
) -> Flown:
    """Prove one of the best runs, or else close triangles one by one until one of what remains is proved.

    Args:
        best: The best runs.
        proved: Proves one of some best runs; raises NoneProvedError.
        searched: The best runs that keep out of some triangles; raises NoPlanError where there are none.
        start: The start triangle, which cannot be closed.
        most_searches: How often a triangle may be closed, and the map searched again.

    Raises:
        NoPlanError: None was found; says why a best run of all of T is not proved.
    """
    try:
        first = proved(best)
        return Flown(first, best, first.passed_over)
    except NoneProvedError as error:
        failure = error
    avoided: tuple[Avoided, ...] = ()
    blamed, looked_at = dict(failure.blamed), {start}
    for _ in range(most_searches):
        triangle = next((candidate for candidate in blamed if candidate not in looked_at), None)
        if triangle is None:
            break
        looked_at.add(triangle)
        tried = (*avoided, Avoided(triangle, blamed[triangle]))
        try:
            found = searched([each.triangle for each in tried])
            return Flown(proved(found), found, failure.passed_over, tried)
        except NoneProvedError as error:
            avoided, blamed = tried, error.blamed | blamed
        except (NoPlanError, SearchSizeError):
            continue
    also = f"; nor is a dearer one without {_listed(avoided)}" if avoided else ""
    raise NoPlanError(f"{failure}{also}") from failure


def _listed(avoided: tuple[Avoided, ...]) -> str:
    several = "s" if len(avoided) > 1 else ""
    more = f" and {len(avoided) - _MOST_LISTED} more" if len(avoided) > _MOST_LISTED else ""
    return f"triangle{several} {', '.join(str(each.triangle) for each in avoided[:_MOST_LISTED])}{more}"
