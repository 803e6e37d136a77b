"""Geofence and rally points on the wire: plans checked and handed to the autopilot, FENCE_STATUS, DO_FENCE_ENABLE.

https://mavlink.io/en/services/mission.html#geofencing and #rally. The checks are those of ArduPilot
`AC_PolyFence_loader.cpp` and PX4 `mavlink_mission.cpp`: both take a fence as a whole, or answer with an error.
"""

from math import isfinite
from typing import TYPE_CHECKING, Final

from vehicle_sim.autopilot import Outcome, Severity
from vehicle_sim.autopilot.geofence import Area, Circle, FencePlan, Polygon
from vehicle_sim.autopilot.rally import RallyPoint
from vehicle_sim.errors import PlanError
from vehicle_sim.parameters import ALL_FENCES, FenceType, Flavour
from vehicle_sim.protocol.dialect import Message, mavlink
from vehicle_sim.protocol.places import AMSL_FRAMES, HOME_FRAMES
from vehicle_sim.protocol.plan_store import PlanItem, PlanKind
from vehicle_sim.protocol.units import E7, whole_number
from vehicle_sim.signals import Geodetic

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence

    from vehicle_sim.protocol.commands import Request
    from vehicle_sim.protocol.host import Host
    from vehicle_sim.protocol.telemetry import Builder

_RETURN_POINT: Final = mavlink.MAV_CMD_NAV_FENCE_RETURN_POINT
_STAY_IN: Final = mavlink.MAV_CMD_NAV_FENCE_POLYGON_VERTEX_INCLUSION
_STAY_OUT: Final = mavlink.MAV_CMD_NAV_FENCE_POLYGON_VERTEX_EXCLUSION
_CIRCLES: Final = {
    mavlink.MAV_CMD_NAV_FENCE_CIRCLE_INCLUSION: True,
    mavlink.MAV_CMD_NAV_FENCE_CIRCLE_EXCLUSION: False,
}
_FEWEST_VERTICES: Final = 3
_ACCEPTED: Final = mavlink.MAV_MISSION_ACCEPTED
_BREACH_TYPES: Final = (
    (FenceType.CIRCLE | FenceType.AREAS, mavlink.FENCE_BREACH_BOUNDARY),
    (FenceType.ALTITUDE, mavlink.FENCE_BREACH_MAXALT),
)


def fence_plan(items: "Sequence[PlanItem]") -> FencePlan:
    """Return the fence that the items of a plan describe.

    Raises:
        PlanError: The items do not make whole areas; the message says which one is wrong.
    """
    areas: list[Area] = []
    return_point: Geodetic | None = None
    index = 0
    while index < len(items):
        item = items[index]
        count = 1
        if item.command == _RETURN_POINT:
            if return_point is not None:
                raise PlanError("Multiple return points found")
            return_point = _place(item)
        elif item.command in _CIRCLES:
            radius_m = item.params[0]
            if not (isfinite(radius_m) and radius_m > 0.0):
                raise PlanError(f"Non-positive circle radius ({radius_m:g})")
            areas.append(Circle(_CIRCLES[item.command], _place(item), radius_m))
        else:
            # A polygon is a run of vertices of which each names the length of the run.
            count = whole_number(item.params[0]) or 0
            if count < _FEWEST_VERTICES:
                raise PlanError(f"Invalid vertex count ({item.params[0]:g})")
            run = items[index : index + count]
            if len(run) < count or any((one.command, one.params[0]) != (item.command, count) for one in run):
                raise PlanError(f"Incorrect vertices after item {index}: {count} of one kind wanted")
            areas.append(Polygon(item.command == _STAY_IN, tuple(_place(one) for one in run)))
        index += count
    return FencePlan(tuple(areas), return_point)


def _place(item: PlanItem) -> Geodetic:
    return Geodetic(item.x / E7, item.y / E7, item.z)


class FenceService:
    """Fence and rally points of one vehicle.

    Attributes:
        keepers: What takes over a plan of each kind, and answers with a MAV_MISSION_RESULT.
    """

    def __init__(self, host: "Host") -> None:
        self._host = host
        is_px4 = host.table.flavour is Flavour.PX4
        self.keepers: Mapping[PlanKind, Callable[[tuple[PlanItem, ...]], int]] = {
            PlanKind.FENCE: self._keep_fence,
            PlanKind.RALLY: self._keep_rally,
        }
        # PX4 has no such command.
        self.commands: Mapping[int, Callable[[Request], Outcome]] = (
            {} if is_px4 else {mavlink.MAV_CMD_DO_FENCE_ENABLE: self._enable}
        )
        self.telemetry: Mapping[int, Builder] = {mavlink.MAVLINK_MSG_ID_FENCE_STATUS: lambda _host: self._status()}

    def _keep_fence(self, items: tuple[PlanItem, ...]) -> int:
        try:
            plan = fence_plan(items)
        except PlanError as error:
            self._host.say(Severity.WARNING, str(error))
            return int(mavlink.MAV_MISSION_ERROR)
        self._host.vehicle.autopilot.fence_in(plan)
        return int(_ACCEPTED)

    def _keep_rally(self, items: tuple[PlanItem, ...]) -> int:
        autopilot = self._host.vehicle.autopilot
        home_m = 0.0 if autopilot.home is None else autopilot.home.alt_m
        is_px4 = self._host.table.flavour is Flavour.PX4
        frames = HOME_FRAMES | AMSL_FRAMES if is_px4 else HOME_FRAMES
        points = []
        for item in items:
            if item.frame not in frames:
                return int(mavlink.MAV_MISSION_UNSUPPORTED_FRAME)
            height_m = item.z - home_m if item.frame in AMSL_FRAMES else item.z
            points.append(RallyPoint(_place(item), height_m))
        autopilot.rally = tuple(points)
        return int(_ACCEPTED)

    def _enable(self, request: "Request") -> Outcome:
        """Watch the fence or not: parameter 1 says which, 2 the kinds (0: all)."""
        on, kinds = whole_number(request.params[0]), whole_number(request.params[1])
        fence = self._host.vehicle.autopilot.guard.fence
        if on not in (0, 1) or (on == 1 and not fence.is_there):
            return Outcome.FAILED
        fence.switch(FenceType((kinds or 0) & ALL_FENCES) or ALL_FENCES, on=on == 1)
        return Outcome.ACCEPTED

    def _status(self) -> Message | None:
        """FENCE_STATUS: whether, how often, how and when it was breached; nothing while no fence is watched."""
        autopilot = self._host.vehicle.autopilot
        fence = autopilot.guard.fence
        if not fence.enabled:
            return None
        kind = next((kind for kinds, kind in _BREACH_TYPES if kinds & fence.breached), mavlink.FENCE_BREACH_NONE)
        slowed = mavlink.FENCE_MITIGATE_VEL_LIMIT if autopilot.slowed else mavlink.FENCE_MITIGATE_NONE
        return mavlink.MAVLink_fence_status_message(
            int(bool(fence.breached)), fence.breaches, kind, round(fence.breached_s * 1000.0), slowed
        )
