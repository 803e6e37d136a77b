"""What a plan asks and what a vehicle has told, as the values that rows are judged by."""

import math
from typing import Final

import numpy as np

from mission.errors import NoPlanError, VehicleError
from mission.fly.placing import check_stand, placed
from mission.fly.preflight.rows import Asked, Judgement, Level, Told
from mission.link.contact import Contact
from mission.link.identity import LinkOptions
from mission.link.values import LandedState
from mission.plan import FlightPlan
from mission.spec.air_time import air_s
from mission.spec.model import FIELD

_SAMPLE_S: Final = 0.05
_MOST_SAMPLES: Final = 200_000


def asked_of(plan: FlightPlan, link: LinkOptions, *, fenced: bool = True) -> Asked:
    """What a plan asks of a vehicle; ``fenced`` where its flight sets a geofence of its own."""
    spec, once = plan.spec, plan.trajectory.ended_after(0.0)
    times = np.linspace(0.0, once.duration_s, min(math.ceil(once.duration_s / _SAMPLE_S) + 2, _MOST_SAMPLES))
    position, velocity, acceleration = once.state(times)
    by_field = spec.flight.guidance == FIELD
    altitude_m = spec.flight.altitude_m
    return Asked(
        speed_m_s=spec.flight.speed_m_s if by_field else _largest(velocity),
        acceleration_m_s2=spec.limits.acceleration_m_s2 if by_field else _largest(acceleration),
        jerk_m_s3=spec.limits.jerk_m_s3,
        tilt_rad=spec.limits.tilt_rad,
        yaw_rate_rad_s=None if spec.flight.heading is None else spec.limits.yaw_rate_rad_s,
        altitude_m=altitude_m,
        reach_m=_largest(position - np.asarray(plan.start_m)),
        air_s=air_s(altitude_m, plan.trajectory.duration_s),
        setpoint_s=link.setpoint_s,
        disturbance_m_s2=spec.flight.disturbance_m_s2,
        battery=spec.battery,
        fenced=fenced,
        unfenced=tuple(region.name for region in spec.regions if region.forbidden and region.motion is not None),
        system_id=link.system_id,
        chosen=link.vehicle_id != 0,
    )


def told_of(contact: Contact, plan: FlightPlan) -> Told:
    """What a vehicle has told of itself, as far as it has been heard.

    Raises:
        ValueError: None has been heard.
    """
    kind, vehicle, health = contact.autopilot, contact.vehicle, contact.vehicle.health
    if kind is None:
        raise ValueError("no vehicle has been heard")
    values = contact.parameters.values.items()
    return Told(
        autopilot=kind.name,
        parameters={name: value for name, body in values if math.isfinite(value := body.value(bytewise=kind.bytewise))},
        stand=_stand(contact, plan),
        mode=kind.mode_name(vehicle.mode),
        busy=_busy(contact),
        unready=vehicle.unready(absolute=plan.spec.origin is not None) if not vehicle.armed else "",
        worst_ratio=None if vehicle.estimator is None else vehicle.estimator.worst_ratio,
        fix=vehicle.fix,
        battery_percent=None if health is None or health.battery_percent < 0 else float(health.battery_percent),
        battery_critical=vehicle.battery_critical,
        wind=vehicle.wind,
        firmware=None if vehicle.version is None else vehicle.version.firmware,
        system_id=contact.system_id,
        systems=frozenset(contact.company.systems),
    )


def _largest(vectors: np.ndarray[tuple[int, ...], np.dtype[np.float64]]) -> float:
    return float(np.hypot(*vectors.T).max())


def _busy(contact: Contact) -> str:
    vehicle = contact.vehicle
    if vehicle.armed:
        return "it is armed"
    if vehicle.heartbeat is not None and vehicle.heartbeat.in_failsafe:
        return "it is in a failsafe"
    return "it is in the air" if vehicle.landed is LandedState.IN_AIR else ""


def _stand(contact: Contact, plan: FlightPlan) -> Judgement:
    """Whether the vehicle stands where the mission can begin."""
    origin, vehicle = plan.spec.origin, contact.vehicle
    if origin is None:
        return Judgement(Level.GO, "the mission lies wherever the vehicle stands")
    if vehicle.origin is None or vehicle.position is None or vehicle.place is None:
        return Judgement(Level.UNKNOWN, "it has not told where it is")
    try:
        stands_m, _ = placed(origin, vehicle)
    except NoPlanError as error:
        return Judgement(Level.NO_GO, str(error), _ELSEWHERE, blames_file=True)
    except VehicleError as error:
        return Judgement(Level.NO_GO, str(error), "wait, or restart it: it does not know where it is")
    distance_m = math.hypot(stands_m[0] - plan.start_m[0], stands_m[1] - plan.start_m[1])
    away = f"{distance_m:.0f} m" if distance_m < 10_000.0 else f"{distance_m / 1000.0:.0f} km"  # noqa: PLR2004 - m
    try:
        check_stand(plan, stands_m)
    except NoPlanError as error:
        return Judgement(Level.NO_GO, f"{error}, {away} from the start", _ELSEWHERE, blames_file=True)
    return Judgement(Level.GO, f"it stands {away} from the start")


_ELSEWHERE: Final = "carry it to the start, or see the file's `origin`"
