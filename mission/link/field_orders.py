"""What a flight without a time law goes by."""

from collections.abc import Callable
from dataclasses import dataclass

from mission.link.errand import Errand
from mission.monitor.monitor import Whereabouts
from mission.planning.policy import Policy
from mission.steering.field_law import FieldLaw


@dataclass(frozen=True, eq=False)
class FieldOrders:
    """What a flight by the field goes by.

    Attributes:
        policy: What to do next, whatever has happened.
        law: The velocity to ask for.
        errand: What the flight is at.
        where: Where it is, by the monitor; None before its word begins, and outside the domain.
    """

    policy: Policy
    law: FieldLaw
    errand: Errand
    where: Callable[[], Whereabouts | None]
