"""Why another plan is asked for in flight, and what has been asked for."""

from collections.abc import Callable
from dataclasses import dataclass

from mission.fly.approach import Approach
from mission.monitor.monitor import Foreseen
from mission.plan import FlightPlan
from mission.spec.model import MissionSpec


@dataclass(frozen=True, eq=False)
class Cause:
    """Why another plan is asked for.

    Attributes:
        reason: In plain words.
        holds: Whether the old plan must not be flown on meanwhile, nor where there is no other.
        waits: Whether it must not be flown on meanwhile.
        amended: The mission as it is from now on; None where it stays as it is.
        fresh: Whether that asks for something else, so that what was done so far does not count.
        returns: Whether what is left of the mission is given up for a return.
        taken_up: Whether nobody has led the vehicle since the last report.
        told: Called with why there is no plan, empty once one is taken over; None where the flight ends without one.
        keep: Called with the number of the new plan before the record tells of it; None where nothing else is kept.
    """

    reason: str
    holds: bool = False
    waits: bool = False
    amended: MissionSpec | None = None
    fresh: bool = False
    returns: bool = False
    taken_up: bool = False
    told: Callable[[str], None] | None = None
    keep: Callable[[int], None] | None = None


@dataclass(eq=False)
class Asked:
    """A plan that was asked for.

    Attributes:
        number: Of the request.
        approach: How it is come to.
        foreseen: What it was made for.
        asked_s: When, by the vehicle's clock and the one here.
        laps_before: How many laps there are before the new plan's, and whether the last of them is under way.
        begun: Whether the approach is flown.
        plan: What was planned; None until it is.
        text: The same as JSON.
    """

    number: int
    approach: Approach
    foreseen: Foreseen
    asked_s: tuple[float, float]
    laps_before: tuple[int, bool]
    begun: bool
    plan: FlightPlan | None = None
    text: str = ""
