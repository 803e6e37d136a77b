"""A recorded flight judged again, by the monitor that watched it, from the positions that were reported."""

from collections.abc import Iterator

from mission.monitor.flight import FlightMonitor
from mission.plan import FlightPlan
from mission.report.reading import Record


def replay(plan: FlightPlan, record: Record) -> Iterator[tuple[float, FlightMonitor]]:
    """The time of each report and what the monitor knows after it; the same monitor each time, going on.

    Args:
        plan: As it was flown.
        record: The flight's.
    """
    judged = FlightMonitor(plan)
    track = record.track
    places = track.position_m[:, :2].tolist()
    for t_s, (east, north), stage in zip(track.t_s.tolist(), places, track.stages, strict=True):
        judged.report(stage, t_s, (east, north))
        yield t_s, judged


def judged_again(plan: FlightPlan, record: Record) -> FlightMonitor:
    """What the monitor knows at the end of a record, which may be that of a flight cut short."""
    judged = FlightMonitor(plan)
    for _, judged in replay(plan, record):  # noqa: B007 - the last one is wanted
        pass
    return judged
