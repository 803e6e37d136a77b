"""What of the regions to be covered was really covered, from the positions that were reported on their lanes."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
import shapely

from mission.coverage.flown import swath, uncovered
from mission.geometry.arrays import BoolArray, FloatArray, IntArray
from mission.monitor.gaps import GAP_S
from mission.monitor.monitor import Outcome
from mission.plan import CoveredVisit, FlightPlan
from mission.spec.model import Point
from mission.steering.trajectory import Trajectory


@dataclass(frozen=True, eq=False)
class Covered:
    """One visit of a region that was to be covered.

    Attributes:
        region: Name of the region.
        lap: In which lap, from 1; 0 outside of laps.
        share: Of its area, how much was within half a spacing of where the vehicle was on the lanes.
        asked: How much the mission asks for.
        left_out: What was not.
    """

    region: str
    lap: int
    share: float
    asked: float
    left_out: shapely.Geometry

    @property
    def enough(self) -> bool:
        """Whether as much was covered as the mission asks for."""
        return self.share >= self.asked


class CoverageWatch:
    """Collects where the vehicle was on the lanes of a plan.

    Attributes:
        flown_s: The latest time on the trajectory that was reported; 0 before the first.
    """

    def __init__(self, plan: FlightPlan, laps_before: int = 0) -> None:
        """Watch from the ground, or after so many laps."""
        self.flown_s = 0.0
        self._plan, self._laps_before = plan, laps_before
        self._reports: list[tuple[float, float, float, float]] = []

    def report(self, t_s: float, trajectory_s: float, position_m: Point) -> None:
        """Take a position into account that was reported while the trajectory was flown.

        Args:
            t_s: Vehicle time.
            trajectory_s: Time on the trajectory, laps included.
            position_m: East and north.
        """
        self.flown_s = max(self.flown_s, trajectory_s)
        if self._plan.covers:
            self._reports.append((t_s, trajectory_s, *position_m))

    def covered(self, trajectory: Trajectory) -> tuple[Covered, ...]:
        """Each visit of which lanes were flown, in the order of time.

        Args:
            trajectory: The plan's, with as many laps as were flown.
        """
        if not self._reports:
            return ()
        told = np.array(self._reports)
        laps = trajectory.lap_at(told[:, 1])
        rows = np.column_stack((told[:, 0], trajectory.parameter(told[:, 1]), told[:, 2:]))
        found = (
            _covered(self._plan, visit, lap, rows[laps == lap])
            for lap in dict.fromkeys(laps.tolist())
            for visit in self._plan.covers
        )
        return tuple(
            replace(visit, lap=visit.lap + self._laps_before) if visit.lap else visit
            for visit in found
            if visit is not None
        )


def together(legs: Sequence[Sequence[Covered]]) -> tuple[Covered, ...]:
    """What was covered in the legs of a flight: a visit that one has cut short is completed by that of the next.

    Args:
        legs: What was covered in each, visit by visit, in the order of time.
    """
    found: list[Covered] = []
    for number, leg in enumerate(legs):
        completed: set[str] = set()
        for visit in leg:
            open_at = next((i for i, each in reversed([*enumerate(found)]) if each.region == visit.region), None)
            begun = number > 0 and open_at is not None and visit.region not in completed
            completed.add(visit.region)
            if begun and open_at is not None and not found[open_at].enough:
                found[open_at] = _completed(found[open_at], visit)
            else:
                found.append(visit)
    return tuple(found)


def _completed(begun: Covered, visit: Covered) -> Covered:
    """A visit with what another one covered besides."""
    area_m2 = begun.left_out.area / (1.0 - begun.share) if begun.share < 1.0 else math.inf
    left_out = shapely.intersection(begun.left_out, visit.left_out)
    return replace(begun, share=1.0 - left_out.area / area_m2, asked=visit.asked, left_out=left_out)


def judged(outcome: Outcome, visits: Sequence[Covered]) -> Outcome:
    """The verdict of a flight that had regions to cover: it achieves nothing where one was covered too little."""
    short = [visit for visit in visits if not visit.enough]
    if not (outcome.achieved and short):
        return outcome
    worst = min(short, key=lambda visit: visit.share - visit.asked)
    more = f"; so were {len(short) - 1} more" if len(short) > 1 else ""
    return Outcome(achieved=False, reason=f"too little of {worst.region} was covered, {worst.asked:.1%} is asked{more}")


def coverage_text(visits: Sequence[Covered]) -> str:
    """What was covered, in plain words; of laps the least of each region; empty where nothing was to be."""
    least: dict[str, Covered] = {}
    for visit in visits:
        if visit.region not in least or visit.share < least[visit.region].share:
            least[visit.region] = visit
    return ", ".join(
        f"{visit.region} covered to {visit.share:.1%}{f' in lap {visit.lap}' if visit.lap else ''}"
        for visit in least.values()
    )


def covered_values(visit: Covered) -> dict[str, object]:
    """A visit as values for a record."""
    return {"region": visit.region, "lap": visit.lap, "share": visit.share, "asked": visit.asked}


def on_lanes(visit: CoveredVisit, s: FloatArray) -> BoolArray:
    """At which curve parameters (P,) the lanes of a visit are flown, shape (P,)."""
    index: IntArray = np.searchsorted(visit.lanes_s[:, 0], s, side="right") - 1
    inside: BoolArray = (index >= 0) & (s <= visit.lanes_s[np.maximum(index, 0), 1])
    return inside


def _covered(plan: FlightPlan, visit: CoveredVisit, lap: int, rows: FloatArray) -> Covered | None:
    """What of a visit was covered; None where none of its lanes was flown.

    Args:
        plan: The plan.
        visit: One of its visits.
        lap: Which lap the rows are of.
        rows: Shape (P, 4): vehicle time, curve parameter, east and north, in the order of time.
    """
    rows = _with_ends(rows, visit.lanes_s.ravel())
    counts = on_lanes(visit, rows[:, 1])
    if not counts.any():
        return None
    area = plan.area_of(visit.region)
    covered = swath(rows[:, 2:], rows[:, 0], spacing_m=visit.spacing_m, longest_gap_s=GAP_S, counts=counts)
    left_out = uncovered(area, covered if visit.before is None else shapely.union_all([covered, visit.before]))
    return Covered(visit.region, lap, 1.0 - left_out.area / area.area, visit.share, left_out)


def _with_ends(rows: FloatArray, ends_s: FloatArray) -> FloatArray:
    """The rows with further ones where lanes begin and end, on the straight line between the reports around these."""
    after = np.searchsorted(rows[:, 1], ends_s)
    between = (after > 0) & (after < len(rows))
    after, ends_s = after[between], ends_s[between]
    before, behind = rows[after - 1], rows[after]
    spans = behind[:, 1] - before[:, 1]
    shares = np.divide(ends_s - before[:, 1], spans, out=np.zeros_like(spans), where=spans > 0.0)
    new = before + shares[:, None] * (behind - before)
    new[:, 1] = ends_s
    both = np.concatenate((rows, new[behind[:, 0] - before[:, 0] <= GAP_S]))
    return both[np.argsort(both[:, 1], kind="stable")]
