"""The path of the fields through the run of a plan on a map that moves (paper, Sec. 4.4)."""

from mission.plan.flight_plan import FlightPlan
from mission.plan.visits import earnest_visits
from mission.spec.model import FIELD
from mission.steering.moving_path import MovingPath, within_speed
from mission.steering.path import build_path


def is_carried(plan: FlightPlan) -> bool:
    """Whether a plan is flown by fields in triangles that move."""
    return plan.spec.flight.guidance == FIELD and plan.moving is not None


def carried_path(plan: FlightPlan) -> MovingPath:
    """The path of the fields through a plan's run, carried over into the moving triangles; of laps a single one.

    Raises:
        NoPlanError: A triangle of it moves faster than the vehicle may fly.
        ValueError: Nothing moves.
    """
    if plan.moving is None:
        raise ValueError("nothing moves")
    spec, run = plan.spec, plan.run
    earnest = earnest_visits(spec, plan.partition, plan.labelling, plan.deterministic, run)
    fixed = build_path(
        plan.partition,
        run,
        start_m=plan.start_m,
        speed_m_s=spec.flight.speed_m_s,
        final_stay_s=spec.flight.final_stay_s,
        settle_in=frozenset(earnest),
    )
    return within_speed(plan.moving, fixed, spec.limits.speed_m_s)
