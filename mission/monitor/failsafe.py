"""When to give a flight up: one table, from the gravest reason to none.

The first row that applies decides: what endangers the vehicle comes before what endangers others, or the mission. A
vehicle that has fallen silent, and one that somebody else flies, are the business of the link and never come this far.
Beyond the certified tube nothing is proved, but the reported word still decides, so a flight goes on there.
"""

from collections.abc import Callable
from typing import NamedTuple

from mission.monitor.verdict import Verdict


class Situation(NamedTuple):
    """What is known of the vehicle at one moment.

    Attributes:
        estimate_healthy: Whether its own estimator vouches for its position.
        battery_critical: Whether it reports a battery that is critical or worse.
        violation: Why the flight is violated already, in plain words; empty where it is not.
        verdict: What is known of the word flown so far.
        astray: Whether it has been too far off its trajectory for too long.
        error_m: The largest tracking error on an axis now.
        closing: What comes of restricted regions that are there for a time only, or move, in plain words; empty for
            nothing.
        sealed: Whether the task cannot be completed from where the vehicle is, whatever is flown.
    """

    estimate_healthy: bool
    battery_critical: bool
    violation: str
    verdict: Verdict
    astray: bool
    error_m: float
    closing: str = ""
    sealed: bool = False


_TABLE: tuple[tuple[Callable[[Situation], bool], Callable[[Situation], str]], ...] = (
    (lambda now: not now.estimate_healthy, lambda _: "the vehicle no longer trusts its own position"),
    (lambda now: now.battery_critical, lambda _: "the battery is critical"),
    (lambda now: bool(now.violation), lambda now: now.violation),
    (lambda now: bool(now.closing), lambda now: now.closing),
    (lambda now: now.verdict is Verdict.FALSE, lambda _: "the specification can no longer be satisfied"),
    (lambda now: now.sealed, lambda _: "from here nothing can be completed without a violation"),
    (lambda now: now.astray, lambda now: f"the vehicle does not follow: it is {now.error_m:.1f} m off"),
)


def reason_to_stop(now: Situation) -> str:
    """Why the vehicle is to hold and land, in plain words; empty while it may go on."""
    return next((reason(now) for applies, reason in _TABLE if applies(now)), "")
