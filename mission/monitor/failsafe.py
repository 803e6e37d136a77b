"""What to do about the vehicle now: one table, from the gravest condition to none.

The first row that applies decides. The order says who is to be believed: without fresh telemetry nothing else is
known; a person who took over is never fought for the controls; then what endangers the vehicle itself; then what
endangers others, or the mission.
"""

from collections.abc import Callable
from dataclasses import dataclass
from enum import StrEnum

from mission.monitor.verdict import Verdict


class Decision(StrEnum):
    """What the flight does next."""

    CONTINUE = "continue"
    HOLD_AND_LAND = "hold and land"
    HAND_OVER = "hand over"
    LINK_LOST = "link lost"


@dataclass(frozen=True)
class Situation:
    """What is known of the vehicle at one moment.

    Attributes:
        telemetry_age_s: Time since anything was received from it.
        mode_expected: Name of the mode that we put it into.
        mode_reported: Name of the mode that it says it is in.
        estimate_healthy: Whether its own estimator vouches for its position.
        battery_critical: Whether it reports a battery that is critical or worse.
        violation: Why the flight is violated already, in plain words; empty where it is not.
        verdict: What is known of the word flown so far.
        excess_s: How long the tracking error has been beyond the certified tube without a break; 0 inside.
        error_m: The largest tracking error on an axis now.
        tube_m: Half width of the certified tube.
    """

    telemetry_age_s: float
    mode_expected: str
    mode_reported: str
    estimate_healthy: bool
    battery_critical: bool
    violation: str
    verdict: Verdict
    excess_s: float
    error_m: float
    tube_m: float


@dataclass(frozen=True)
class Patience:
    """How long two conditions may last before they count."""

    telemetry_s: float = 3.0
    excess_s: float = 2.0


@dataclass(frozen=True)
class Ruling:
    """A decision and its reason in plain words; no reason is needed to go on."""

    decision: Decision
    reason: str = ""


_Row = tuple[Callable[[Situation, Patience], bool], Decision, Callable[[Situation], str]]

_TABLE: tuple[_Row, ...] = (
    (
        lambda now, patience: not now.telemetry_age_s <= patience.telemetry_s,
        Decision.LINK_LOST,
        lambda now: f"nothing was received from the vehicle for {now.telemetry_age_s:.1f} s",
    ),
    (
        lambda now, _: now.mode_reported != now.mode_expected,
        Decision.HAND_OVER,
        lambda now: f"someone else put the vehicle into {now.mode_reported}",
    ),
    (
        lambda now, _: not now.estimate_healthy,
        Decision.HOLD_AND_LAND,
        lambda _: "the vehicle no longer trusts its own position",
    ),
    (
        lambda now, _: now.battery_critical,
        Decision.HOLD_AND_LAND,
        lambda _: "the battery is critical",
    ),
    (
        lambda now, _: bool(now.violation),
        Decision.HOLD_AND_LAND,
        lambda now: now.violation,
    ),
    (
        lambda now, _: now.verdict is Verdict.FALSE,
        Decision.HOLD_AND_LAND,
        lambda _: "the formula can no longer be satisfied",
    ),
    (
        lambda now, patience: not now.excess_s <= patience.excess_s,
        Decision.HOLD_AND_LAND,
        lambda now: (
            f"{now.error_m:.2f} m off the trajectory for {now.excess_s:.1f} s, where {now.tube_m:.2f} m are proved safe"
        ),
    ),
)


def decide(now: Situation, patience: Patience | None = None) -> Ruling:
    """Decide what to do. A duration that is not a number counts as too long."""
    limits = patience or Patience()
    for applies, decision, reason in _TABLE:
        if applies(now, limits):
            return Ruling(decision, reason(now))
    return Ruling(Decision.CONTINUE)
