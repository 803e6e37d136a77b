"""Why another plan is asked for in flight, and what has been asked for."""

from collections.abc import Callable
from dataclasses import dataclass

from mission.fly.approach import Approach
from mission.geometry.arrays import FloatArray
from mission.monitor.monitor import Foreseen
from mission.plan import FlightPlan
from mission.plan.rest import Rest
from mission.spec.model import MissionSpec


@dataclass(frozen=True, eq=False)
class Cause:
    """Why another plan is asked for.

    Attributes:
        reason: In plain words.
        holds: Whether the old plan must not be flown on meanwhile, nor where there is no other.
        waits: Whether it must not be flown on meanwhile.
        spares: Given places close together, shape (n, 2), on which the vehicle would go on and come to rest: whether it
            may go there. Where nobody can say, it comes to rest at once.
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
    spares: Callable[[FloatArray], bool] | None = None
    amended: MissionSpec | None = None
    fresh: bool = False
    returns: bool = False
    taken_up: bool = False
    told: Callable[[str], None] | None = None
    keep: Callable[[int], None] | None = None


@dataclass(frozen=True, eq=False)
class Entry:
    """A way into a plan that was asked for.

    Attributes:
        approach: How the plan is come to.
        begun: Whether that is flown already, so that a plan that begins at its end cannot be late.
        foreseen: What will have been spelled there.
        laps_before: How many laps there are before the new plan's, and whether the last of them is under way.
        rest: The same for who plans.
    """

    approach: Approach
    begun: bool
    foreseen: Foreseen
    laps_before: tuple[int, bool]
    rest: Rest

    @property
    def aside(self) -> bool:
        """Whether the vehicle leaves the plan that is flown to come to rest."""
        return self.approach.flown_s is None


@dataclass(eq=False)
class Asked:
    """A plan that was asked for.

    Attributes:
        number: Of the request.
        entries: Where it may begin, the best first: in motion, if that is asked for, and at rest.
        asked_s: When, by the vehicle's clock and the one here.
        entry: Where it begins; None until it is planned.
        plan: What was planned; None until it is.
        text: The same as JSON.
    """

    number: int
    entries: tuple[Entry, ...]
    asked_s: tuple[float, float]
    entry: Entry | None = None
    plan: FlightPlan | None = None
    text: str = ""

    @property
    def stop(self) -> Entry:
        """Where it begins at rest."""
        return self.entries[-1]
