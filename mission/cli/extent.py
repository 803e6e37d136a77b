"""How far and how long a plan flies, and what it leaves out, in words."""

from mission.plan import FlightPlan


def extent(plan: FlightPlan, digits: int = 0) -> str:
    """``350.2 m in 129 s``, of what is flown; of a flight of laps also how long one is."""
    trajectory = plan.trajectory
    if trajectory.lap is None:
        return f"{plan.curve.length_m:.{digits}f} m in {trajectory.duration_s:.0f} s"
    lap = plan.curve.legs[trajectory.lap]
    each = f"{lap.length_m:.{digits}f} m in {trajectory.legs[trajectory.lap].duration_s:.0f} s"
    if trajectory.laps is None:
        return f"laps of {each} each, until Ctrl-C"
    laps = "1 lap" if trajectory.laps == 1 else f"{trajectory.laps:,} laps"
    return f"{laps} of {each}, all in all {length_m(plan):.{digits}f} m in {trajectory.duration_s:.0f} s"


def length_m(plan: FlightPlan) -> float | None:
    """The length of all that is flown; None while nobody has said how many laps there are."""
    trajectory = plan.trajectory
    if trajectory.lap is None:
        return plan.curve.length_m
    if trajectory.laps is None:
        return None
    return plan.curve.length_m + (trajectory.laps - 1) * plan.curve.legs[trajectory.lap].length_m


def without(plan: FlightPlan) -> str:
    """``; without visit: [S3] (weight 2)``: the wishes that the plan gives up; empty where it meets all."""
    if not plan.dropped:
        return ""
    return "; without " + ", ".join(f"{task.task} (weight {task.weight:g})" for task in plan.dropped)
