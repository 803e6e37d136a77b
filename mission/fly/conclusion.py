"""What a flight has come to, from its session and what was watched of it."""

from mission.errors import VehicleError
from mission.fly.result import FlightResult
from mission.fly.watch import FlightWatch
from mission.link.ending import Ending
from mission.link.session import Session
from mission.monitor.cadence import slowed_text
from mission.monitor.coverage import Covered, coverage_text, judged
from mission.monitor.gaps import gaps_text
from mission.monitor.pictures import pictures_text


def concluded(
    session: Session, watch: FlightWatch, *, remarks: str, interrupted: bool, behind_s: float
) -> FlightResult:
    """The verdict on a flight that came to its end.

    Args:
        session: At its end.
        watch: What was watched.
        remarks: What else is to be said of the flight, in plain words; empty where there is nothing.
        interrupted: Whether the user ended it.
        behind_s: How far this computer was behind what the vehicle said, at most.

    Raises:
        VehicleError: A failsafe of the vehicle ended the flight.
    """
    ending = session.ending or Ending.LANDED
    if ending is Ending.FAILSAFE:
        raise VehicleError(session.ending_reason)
    achieved, reason, covered = False, session.ending_reason, _covered(session, watch)
    if ending is Ending.LANDED:
        outcome = judged(watch.legs.outcome(), covered)
        achieved, reason = outcome.achieved, outcome.reason
    return FlightResult(
        plan=watch.plan,
        plans=tuple(leg.plan for leg in watch.legs.legs),
        achieved=achieved,
        reason=joined(reason, *shortcomings(session, watch, remarks)),
        ending=ending,
        interrupted=interrupted,
        vehicle=watch.vehicle,
        began_s=watch.began_s,
        ended_s=session.vehicle.clock.newest_s,
        largest_error_m=watch.tracking.largest_m,
        largest_distance_m=watch.largest_distance_m,
        largest_velocity_error_m_s=watch.tracking.largest_m_s,
        beyond_tube_s=watch.beyond_tube_s,
        behind_s=behind_s,
        word=watch.legs.word,
        laps=watch.legs.laps,
        cadence=watch.cadence.cadence,
        link_delay_s=session.contact.arrival.largest_s,
        gaps=tuple(watch.gaps),
        violations=watch.legs.violations,
        covered=covered,
        pictures=tuple(watch.pictures),
        planned_pictures=watch.legs.planned_pictures(),
    )


def shortcomings(session: Session, watch: FlightWatch, remarks: str) -> tuple[str, ...]:
    """What is wrong with the flight, or known of it alone, whatever its end; empty words where nothing is."""
    trouble = session.contact.photography.trouble
    pictures = pictures_text(watch.pictures, watch.legs.planned_pictures(), trouble)
    guard = session.contact.fence
    fence = "" if guard is None else guard.trouble
    slowed = slowed_text(watch.cadence.cadence, session.contact.arrival.largest_s)
    return coverage_text(_covered(session, watch)), gaps_text(watch.gaps), slowed, pictures, fence, remarks


def joined(*parts: str) -> str:
    """Parts of a reason as one; empty ones are left out."""
    return "; ".join(filter(None, parts))


def _covered(session: Session, watch: FlightWatch) -> tuple[Covered, ...]:
    """What was covered so far."""
    return () if session.guidance is None else watch.covered(session.guidance.course.laps)
