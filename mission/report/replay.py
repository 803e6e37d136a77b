"""A recorded flight judged again, by the monitors that watched it, from the positions that were reported."""

from collections.abc import Iterator

import numpy as np

from mission.monitor.flight import FlightMonitor
from mission.monitor.legs import FlightLegs
from mission.plan import FlightPlan
from mission.report.reading import LEG, Record
from mission.report.tracking import tracking_of


def replay(plan: FlightPlan, record: Record) -> Iterator[tuple[float, FlightMonitor]]:
    """The time of each report and what the monitor of the plan that is flown then knows after it, which goes on.

    Args:
        plan: As it was flown first.
        record: The flight's.
    """
    legs = legs_of(plan, record)
    track = record.track
    places = track.position_m[:, :2].tolist()
    for t_s, (east, north), stage in zip(track.t_s.tolist(), places, track.stages, strict=True):
        legs.report(stage, t_s, (east, north))
        yield t_s, legs.now.judged


def judged_again(plan: FlightPlan, record: Record) -> FlightLegs:
    """What is known at the end of a record, which may be that of a flight cut short, of its coverage too."""
    legs, track, tracking = legs_of(plan, record), record.track, tracking_of(record)
    errors_m = np.abs(tracking.error_m).max(axis=1, initial=0.0).tolist()
    flown = dict(zip(tracking.t_s.tolist(), zip(tracking.trajectory_s.tolist(), errors_m, strict=True), strict=True))
    places = track.position_m[:, :2].tolist()
    for t_s, (east, north), stage in zip(track.t_s.tolist(), places, track.stages, strict=True):
        trajectory_s, error_m = flown.get(t_s, (None, 0.0))
        legs.report(stage, t_s, (east, north), trajectory_s)
        if trajectory_s is not None:
            legs.now.keep(trajectory_s, in_tube=error_m <= legs.now.plan.certificate.tube_m)
    return legs


def legs_of(plan: FlightPlan, record: Record) -> FlightLegs:
    """The legs of a flight, none of which has begun but the first."""
    legs = FlightLegs(plan)
    told = {event.t_s: event.values for event in record.events if event.text == LEG}
    for later in record.later:
        why = told.get(later.from_s, {})
        returns, fresh, amended = (why.get(key) is True for key in ("returns", "fresh", "amended"))
        legs.take_over(
            later.plan,
            later.from_s,
            later.laps_before,
            begun=later.begun,
            returns=returns,
            fresh=fresh,
            amended=amended,
        )
    return legs
