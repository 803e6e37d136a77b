"""What a flight without a time law goes by, from its plan."""

import math
from typing import Final

import numpy as np

from mission.geometry.arrays import BoolArray
from mission.link.errand import Errand, Loiter
from mission.link.field_guidance import FieldGuidance
from mission.link.field_orders import FieldOrders
from mission.link.session import Session
from mission.monitor.attitude import GRAVITY_M_S2
from mission.monitor.monitor import Monitor
from mission.plan import FlightPlan
from mission.plan.policy import margin_m, policy_of
from mission.spec.model import FIELD, UNTIL_STOPPED
from mission.steering.field_law import FieldLaw

_BRAKES_BY: Final = 0.5
"""Of the largest acceleration; the rest is for wind."""


def field_orders(plan: FlightPlan, monitor: Monitor) -> FieldOrders | None:
    """The orders of a flight by the field; None where the plan's trajectory is flown."""
    flight = plan.spec.flight
    if flight.guidance != FIELD:
        return None
    policy = policy_of(plan)
    loiters = [
        Loiter(_inside(plan, region.name), region.loiter_s) for region in plan.spec.regions if region.loiter_s > 0.0
    ]
    laps = None if flight.laps == UNTIL_STOPPED else flight.laps
    errand = Errand(policy, loiters, laps=laps, recurrent=plan.run.recurrent, final_stay_s=flight.final_stay_s)
    return FieldOrders(policy, law_of(plan), errand, lambda: monitor.whereabouts)


def is_sealed(session: Session) -> bool:
    """Whether nothing can be completed from where the vehicle is; while a pilot flies it, that is not for us to say."""
    return isinstance(session.guidance, FieldGuidance) and session.guidance.sealed and not session.pilot.words


def law_of(plan: FlightPlan) -> FieldLaw:
    """The velocities to ask for: at the mission's speed, braking as the vehicle can, as far off as the tube is wide."""
    limits = plan.spec.limits
    lean_m_s2 = GRAVITY_M_S2 * math.tan(limits.tilt_rad)
    return FieldLaw(
        plan.partition,
        speed_m_s=min(plan.spec.flight.speed_m_s, limits.speed_m_s),
        acceleration_m_s2=min(limits.acceleration_m_s2, lean_m_s2),
        braking_m_s2=_BRAKES_BY * min(limits.acceleration_m_s2, lean_m_s2),
        margin_m=margin_m(plan.spec.flight),
        moving=plan.moving,
    )


def _inside(plan: FlightPlan, region: str) -> BoolArray:
    inside = np.zeros(plan.partition.size, dtype=np.bool_)
    inside[plan.labelling.triangles_of(region)] = True
    return inside
