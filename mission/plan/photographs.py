"""When a flight is to be photographed: stretches of its trajectory, with the distance between two pictures."""

import math
from collections.abc import Iterable
from dataclasses import dataclass
from itertools import pairwise
from typing import Any, Final

import numpy as np

from mission.plan.covering import CoveredVisit
from mission.plan.turning import headings_of
from mission.steering.trajectory import Trajectory

_STEP_S: Final = 0.1
_SAME_S: Final = 1e-8


@dataclass(frozen=True, slots=True)
class Photographs:
    """One stretch.

    Attributes:
        begin_s: Time on the trajectory at which the first picture is taken; of a lap, in the first one.
        end_s: Time on the trajectory after which none is.
        distance_m: Level distance from one picture to the next; None for a single one.
        heading_rad: Where the vehicle looks, clockwise from north, from the first picture on; None for where it flies.

    Raises:
        ValueError: It ends before it begins, or a number is out of range.
    """

    begin_s: float
    end_s: float
    distance_m: float | None
    heading_rad: float | None = None

    def __post_init__(self) -> None:
        if not 0.0 <= self.begin_s < self.end_s < math.inf:
            raise ValueError(f"photographs are taken from {self.begin_s} s to {self.end_s} s, which is no stretch")
        if self.distance_m is not None and not 0.0 < self.distance_m < math.inf:
            raise ValueError(f"photographs are {self.distance_m} m apart, which is no distance")
        if self.heading_rad is not None and not math.isfinite(self.heading_rad):
            raise ValueError(f"photographs are taken at a heading of {self.heading_rad} rad, which is none")


def along_lanes(trajectory: Trajectory, visits: Iterable[CoveredVisit]) -> tuple[Photographs, ...]:
    """A stretch for each lane of the regions of which images are taken, but for a rest of one that has none."""
    found: list[Photographs] = []
    for visit in visits:
        if visit.trigger_m is not None:
            # Where the vehicle waits for its turn to be over before a lane, the lane begins after that.
            begins = trajectory.time_at(visit.imaged_s[:, 0], leaving=True)
            times = np.stack((begins, trajectory.time_at(visit.imaged_s[:, 1])), axis=1).tolist()
            headings = headings_of(visit.lanes_m).tolist()
            for (begin, end), heading in zip(times, headings, strict=True):
                # One lane may end where the next begins, but for what a search for times leaves.
                ended = found[-1].end_s if found else 0.0
                from_s = ended if 0.0 < ended - begin < _SAME_S else begin
                if from_s < end:
                    found.append(Photographs(from_s, end, visit.trigger_m, heading))
    return in_order(found)


def in_order(stretches: Iterable[Photographs]) -> tuple[Photographs, ...]:
    """The same stretches.

    Raises:
        ValueError: They overlap, or are not in the order of the trajectory.
    """
    found = tuple(stretches)
    for before, after in pairwise(found):
        if after.begin_s < before.end_s:
            raise ValueError(f"photographs from {after.begin_s} s on begin before {before.end_s} s")
    return found


def planned_pictures(trajectory: Trajectory, stretches: Iterable[Photographs]) -> int:
    """How many pictures a flight takes that keeps to the trajectory: the first of each stretch, and those after it.

    Of laps without a number one is counted.
    """
    count = 0
    for stretch in stretches:
        laps = (trajectory.laps or 1) if trajectory.lap_at([stretch.begin_s])[0] else 1
        count += laps
        if stretch.distance_m is None:
            continue
        times = np.linspace(stretch.begin_s, stretch.end_s, 2 + int((stretch.end_s - stretch.begin_s) / _STEP_S))
        steps = np.diff(trajectory.state(times)[0], axis=0)
        count += laps * int(float(np.hypot(steps[:, 0], steps[:, 1]).sum()) / stretch.distance_m)
    return count


def photographs_to_json(stretches: Iterable[Photographs]) -> list[list[float | None]]:
    """Begin, end, distance and heading of each stretch."""
    return [[each.begin_s, each.end_s, each.distance_m, each.heading_rad] for each in stretches]


def photographs_from_json(data: Any) -> tuple[Photographs, ...]:  # noqa: ANN401 - any JSON value
    """Read what ``photographs_to_json`` gave.

    Raises:
        TypeError: It is no list of lists of numbers.
        ValueError: The stretches are none, or not in order.
    """
    found = []
    for each in data:
        begin, end, *others = each
        apart, heading = (None if number is None else float(number) for number in (*others, None)[:2])  # as of old
        found.append(Photographs(float(begin), float(end), apart, heading))
    return in_order(found)
