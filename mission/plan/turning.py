"""Turning before lanes: a camera looks along a lane from its first picture on, so the vehicle has turned by then.

The heading goes on turning at ``TURN_RAD_S`` from the end of one lane to the begin of the next, whatever the way there
is like, and is then given ``SETTLE_S`` to come to rest. Where the vehicle is faster than that, it slows down on its
way, and waits at the begin of the lane where there is hardly any way.
"""

import math
from collections.abc import Iterable
from dataclasses import dataclass
from typing import Final

import numpy as np

from mission.geometry.arrays import FloatArray
from mission.plan.covering import CoveredVisit
from mission.steering.trajectory import Trajectory

TURN_RAD_S: Final = math.pi / 4.0
"""How fast the heading turns: below what both autopilots turn at by default."""
SETTLE_S: Final = 0.75
LEAD_S: Final = math.pi / TURN_RAD_S + SETTLE_S
"""How long before a lane the heading is its own at most: turning right round takes no longer."""
_STRAIGHT_RAD: Final = 0.01
_SLOWEST: Final = 0.3
"""Of the planned speed: whoever would have to be slower waits for the rest."""


@dataclass(frozen=True)
class RunIn:
    """A stretch of a path on which there must be time to turn.

    Attributes:
        begin_s: Where it begins, steering time.
        end_s: Where it ends, where the vehicle has turned.
        lasts_s: How long it takes at least.
    """

    begin_s: float
    end_s: float
    lasts_s: float

    @property
    def rate(self) -> float:
        """The largest share of the planned speed."""
        return max((self.end_s - self.begin_s) / self.lasts_s, _SLOWEST)

    @property
    def wait_s(self) -> float:
        """How long the vehicle waits at the end."""
        return self.lasts_s - (self.end_s - self.begin_s) / self.rate

    def missing_s(self, trajectory: Trajectory) -> float:
        """How much longer it would have to take on a trajectory; not positive where that is slow enough."""
        begin = trajectory.time_at([self.begin_s])
        end = trajectory.time_at([self.end_s], leaving=True)
        return float(self.lasts_s - (end - begin)[0])


def turn_s(before_rad: float, after_rad: float) -> float:
    """How long it takes to turn from a heading to another, the short way round, and to come to rest."""
    angle = abs(math.remainder(after_rad - before_rad, 2.0 * math.pi))
    return angle / TURN_RAD_S + SETTLE_S if angle > _STRAIGHT_RAD else 0.0


def headings_of(lanes_m: FloatArray) -> FloatArray:
    """The headings of lanes, shape (n, 2, 2), clockwise from north: shape (n,), radians."""
    steps = lanes_m[:, 1] - lanes_m[:, 0]
    return np.asarray(np.arctan2(steps[:, 0], steps[:, 1]))


def run_ins(trajectory: Trajectory, visits: Iterable[CoveredVisit]) -> tuple[RunIn, ...]:
    """Where a trajectory, flown without regard to this, leaves too little time to turn before a photographed lane."""
    starts, found = trajectory.curve.starts_s, []
    leg, end, heading = -1, 0.0, 0.0
    for visit in visits:
        if visit.trigger_m is None:
            continue
        for (begin_s, end_s), after in zip(visit.lanes_s.tolist(), headings_of(visit.lanes_m).tolist(), strict=True):
            here = int(np.searchsorted(starts[1:-1], begin_s, side="right"))
            # Whatever the heading is at the begin of a leg, turning right round is the most.
            from_s, lasts_s = (end, turn_s(heading, after)) if here == leg else (float(starts[here]), LEAD_S)
            run_in = RunIn(from_s, begin_s, lasts_s)
            if run_in.missing_s(trajectory) > 0.0:
                found.append(run_in)
            leg, end, heading = here, end_s, after
    return tuple(found)
