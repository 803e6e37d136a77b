"""What a record says of the regions that were to be covered."""

from mission.monitor.coverage import Covered
from mission.plan import FlightPlan
from mission.report.reading import Record
from mission.report.replay import judged_again


def covered_again(plan: FlightPlan, record: Record) -> tuple[Covered, ...]:
    """What was covered, found again from the positions of a record, which may be that of a flight cut short."""
    if not plan.covers:
        return ()
    legs = judged_again(plan, record)
    trajectory = legs.now.plan.trajectory
    if trajectory.laps is not None:
        return legs.covered(trajectory.laps)
    # Nobody had said how many; as many were flown as the last report has come to.
    if record.verdict is None:
        return legs.covered(trajectory.ended_after(legs.now.coverage.flown_s).laps)
    return legs.covered(max(1, int(record.verdict.get("laps") or 1) - legs.now.laps_before))
