"""What a flight needs to hear from the vehicle, and for how long it can do without.

Not everything that is heard keeps a flight: a vehicle of which only heartbeats arrive can be neither led nor watched.
Ages are counted on the vehicle's clock as far as it was seen to pass, because a simulator's may be many times as fast
or as slow as ours. That of the position, without which this clock may stand, is counted on the clock here as well.
"""

import math
from dataclasses import dataclass
from typing import Final

from mission.link.values import Body, EstimatorReport, Heartbeat, LocalPosition


@dataclass(frozen=True)
class Need:
    """One row.

    Attributes:
        body: The message.
        name: What is missing without it, to be read after "the vehicle has not told".
        ask_s: At this age it is asked for again.
        patience: At so many times the patience of the link the flight is given up.
        here: Whether its age on the clock here counts too, if that is greater.
    """

    body: type[Body]
    name: str
    ask_s: float
    patience: float
    here: bool = False


NEEDS: Final = (
    Need(LocalPosition, "its position", 1.0, 1.0, here=True),
    Need(EstimatorReport, "how well it knows its position", 3.0, 2.0),
    Need(Heartbeat, "its mode", math.inf, 2.0),
)


class Watchdog:
    """Watches the age of each need; times are seconds of the clock here and seconds seen to pass on the vehicle's."""

    def __init__(self, patience_s: float) -> None:
        """Watch nothing before the first look; no age is greater than the time since then."""
        self._patience_s = patience_s
        self._heard: dict[type[Body], tuple[float, float]] = {}
        self._began: tuple[float, float] | None = None

    def take(self, body: Body, now_s: float, seen_s: float) -> None:
        """Take note that a message has come."""
        self._heard[type(body)] = (now_s, seen_s)

    def overdue(self, now_s: float, seen_s: float) -> tuple[type[Body], ...]:
        """The messages to ask for again."""
        return tuple(need.body for need in NEEDS if self._age_s(need, now_s, seen_s) >= need.ask_s)

    def lost(self, now_s: float, seen_s: float) -> str:
        """Why the flight cannot go on, in plain words; empty while it can."""
        for need in NEEDS:
            age_s = self._age_s(need, now_s, seen_s)
            if age_s > need.patience * self._patience_s:
                return f"the vehicle has not told {need.name} for {age_s:.1f} s"
        return ""

    def _age_s(self, need: Need, now_s: float, seen_s: float) -> float:
        self._began = began = self._began or (now_s, seen_s)
        heard = self._heard.get(need.body, began)
        age_s = seen_s - max(heard[1], began[1])
        return max(age_s, now_s - max(heard[0], began[0])) if need.here else age_s
