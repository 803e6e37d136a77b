"""What a record says of the regions that were to be covered."""

from dataclasses import replace

from mission.monitor.coverage import CoverageWatch, Covered
from mission.plan import FlightPlan
from mission.report.reading import Record
from mission.report.tracking import tracking_of


def covered_again(plan: FlightPlan, record: Record) -> tuple[Covered, ...]:
    """What was covered, found again from the positions of a record, which may be that of a flight cut short."""
    if not plan.covers:
        return ()
    watch = CoverageWatch(plan)
    tracking = tracking_of(record)
    rows = zip(tracking.t_s.tolist(), tracking.trajectory_s.tolist(), tracking.position_m.tolist(), strict=True)
    for t_s, trajectory_s, (east, north) in rows:
        watch.report(t_s, trajectory_s, (east, north))
    trajectory = plan.trajectory
    if trajectory.laps is None:
        # Nobody had said how many; as many were flown as the last report has come to.
        last = tracking.trajectory_s[-1:].tolist() or [0.0]
        trajectory = (
            trajectory.ended_after(last[0])
            if record.verdict is None
            else replace(trajectory, laps=max(1, int(record.verdict.get("laps") or 1)))
        )
    return watch.covered(trajectory)
