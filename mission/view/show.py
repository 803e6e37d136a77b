"""What the pages of a flight have been told so far: enough for one that comes late, and never more than that."""

import json
from collections.abc import Iterable, Sequence
from typing import Any, Final

from mission.fly.result import Progress
from mission.plan import FlightPlan
from mission.printable import printable
from mission.view.feed import Answer
from mission.view.moments import Moment, Narrator

_MOST_KEPT: Final = 2000
_MOST_AT_ONCE: Final = 6
"""A vehicle that flies faster than time has more moments than anybody sees; the path needs a few of them."""
_MOST_NEWS: Final = 200


class Show:
    """The moments of one flight, thinned so that there are never too many, and its news.

    Attributes:
        narrator: What tells them.
    """

    def __init__(self, plan: FlightPlan) -> None:
        """Begin before the first."""
        self.narrator = Narrator(plan)
        self._moments: list[Moment] = []
        self._news: list[tuple[float | None, str]] = []
        self._told = 0
        self._answer: Answer | None = None

    def add(self, moments: Iterable[Progress], answers: Sequence[Answer] = (), *, all_of_them: bool = False) -> str:
        """Take what has come; the message for pages that know all that was before, empty where there is nothing new.

        Args:
            moments: Oldest first.
            answers: To what was asked.
            all_of_them: Whether to keep each, as of a replay, which has been thinned already.
        """
        values, news = [], []
        for now in moments:
            values.append(self.narrator.moment(now))
            news += [(values[-1]["t"], printable(words)) for words in now.told[self._told :]]
            self._told = max(self._told, len(now.told))
        if not all_of_them:
            values = values[:: -(-len(values) // _MOST_AT_ONCE) or 1][:-1] + values[-1:]
        self._moments += values
        self._news = (self._news + news)[-_MOST_NEWS:]
        if len(self._moments) > _MOST_KEPT and not all_of_them:
            self._moments = self._moments[:-1:2] + self._moments[-1:]
        self._answer = answers[-1] if answers else self._answer
        return _message(values, news, answers) if values or answers else ""

    @property
    def all(self) -> str:
        """The message for a page that knows nothing."""
        return _message(self._moments, self._news, [self._answer] if self._answer else [], fresh=True)


def _message(
    moments: Sequence[Moment],
    news: Sequence[tuple[float | None, str]],
    answers: Sequence[Answer],
    *,
    fresh: bool = False,
) -> str:
    """As JSON; of each moment after the first only what has changed."""
    changes = [dict(moment) for moment in moments[:1]]
    for k in range(1, len(moments)):
        before = moments[k - 1]
        changes.append({key: value for key, value in moments[k].items() if before[key] != value})
    words = [f"{each.request}: {'' if each.granted else 'refused, '}{printable(each.words)}" for each in answers]
    values: dict[str, Any] = {"moments": changes, "news": news, "answers": words, "fresh": fresh}
    return json.dumps(values, allow_nan=False, separators=(",", ":"))
