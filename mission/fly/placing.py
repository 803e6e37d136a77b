"""Where the mission lies, at a place on Earth or wherever the vehicle stands, and what its flight stays within."""

import math
from typing import Final

import numpy as np

from mission.errors import GeometryError, NoPlanError, VehicleError
from mission.geometry.geodesy import LatLon, enu_offset_m
from mission.geometry.location import OUTSIDE
from mission.link.course import Bounds, Course
from mission.link.field_orders import FieldOrders
from mission.link.frames import Anchor, Anchoring, Vector, enu_from_ned, ned_from_enu
from mission.link.vehicle_state import VehicleState
from mission.monitor.attitude import GRAVITY_M_S2
from mission.plan import FlightPlan
from mission.plan.heading import nose_of
from mission.spec.model import Origin, Point

_AGREE_M: Final = 2.0
_AGREE_SHARE: Final = 0.005
_BRAKES_BY: Final = 0.7
"""Of the largest acceleration, where a plan is left for another; the rest is for wind."""


def anchored_at_start(start_m: Point) -> Anchoring:
    """Where the vehicle stands when it is armed, there is the start."""

    def anchor(vehicle_ned_m: Vector) -> Anchor:
        return Anchor.between(vehicle_ned_m, (*start_m, 0.0))

    return anchor


def placed(origin: Origin, vehicle: VehicleState) -> tuple[Point, Anchoring]:
    """Where the vehicle stands in a domain that lies at a place on Earth, and how to tie the two together.

    The local frame counts from the estimator's origin, which is neither home nor the domain's origin. The vehicle's
    own global position must say the same, or the frames are not what they are taken for.

    Raises:
        NoPlanError: It stands so far away that an offset means nothing.
        VehicleError: It has not told where it is, or its positions contradict each other.
    """
    if vehicle.origin is None or vehicle.position is None or vehicle.place is None:
        raise VehicleError("the vehicle has not told where on Earth it is")
    domain = LatLon(origin.latitude_deg, origin.longitude_deg)
    try:
        frame = LatLon(vehicle.origin.latitude_deg, vehicle.origin.longitude_deg)
        here = LatLon(vehicle.place.latitude_deg, vehicle.place.longitude_deg)
        frame_east_m, frame_north_m = enu_offset_m(domain, frame)
        here_east_m, here_north_m = enu_offset_m(domain, here)
    except GeometryError as error:
        raise NoPlanError(f"the vehicle cannot fly this mission from where it is: {error}") from error
    east_m, north_m, _ = enu_from_ned(vehicle.position.position_ned_m)
    stands = (frame_east_m + east_m, frame_north_m + north_m)
    apart_m = math.hypot(stands[0] - here_east_m, stands[1] - here_north_m)
    if apart_m > _AGREE_M + _AGREE_SHARE * math.hypot(east_m, north_m):
        raise VehicleError(f"the vehicle's local and global positions are {apart_m:.1f} m apart")

    def anchor(vehicle_ned_m: Vector) -> Anchor:
        north, east, _ = ned_from_enu((-frame_east_m, -frame_north_m, 0.0))
        return Anchor((north, east, vehicle_ned_m[2]))

    return stands, anchor


def check_stand(plan: FlightPlan, stands_m: Point) -> None:
    """Refuse to fly from outside the domain or from a restricted region.

    Raises:
        NoPlanError: It stands there.
    """
    place = f"the vehicle stands at ({stands_m[0]:.1f}, {stands_m[1]:.1f}) m"
    if int(plan.locator.triangle_at(np.array([stands_m]))[0]) == OUTSIDE:
        raise NoPlanError(f"{place}, outside the mission's domain")
    names = {
        name
        for triangle in plan.locator.triangles_touching(stands_m).tolist()
        if plan.restricted[triangle]
        for name in plan.labelling.label(triangle)
    }
    if names:
        raise NoPlanError(f"{place}, in or at the edge of the restricted {', '.join(sorted(names))}")


def bounds_of(plan: FlightPlan) -> Bounds:
    """What the flight of a plan stays within."""
    lean_m_s2 = GRAVITY_M_S2 * math.tan(plan.spec.limits.tilt_rad)
    braking_m_s2 = _BRAKES_BY * min(plan.spec.limits.acceleration_m_s2, lean_m_s2)
    return Bounds(plan.certificate.tube_m, plan.spec.flight.margins.correction_m, lean_m_s2, braking_m_s2)


def course_of(plan: FlightPlan, heading_rad: float, orders: FieldOrders | None) -> Course:
    """What is flown of a plan by a vehicle with this heading, clockwise from north; with orders by the field."""
    return Course(plan.trajectory, heading_rad, bounds_of(plan), nose_of(plan), orders)
