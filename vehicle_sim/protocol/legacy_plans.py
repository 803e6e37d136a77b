"""How older ground stations read fences and rally points from ArduPilot: point by point. PX4 never had that.

ArduPilot `AC_PolyFence_loader.cpp`, `GCS_Rally.cpp`. A fence that can be told so is one polygon to stay in: point 0 is
the one to return to, and the last corner is the first again.
"""

from typing import TYPE_CHECKING

from vehicle_sim.autopilot import Severity
from vehicle_sim.autopilot.geofence import Polygon
from vehicle_sim.parameters import Flavour
from vehicle_sim.protocol.dialect import Message, mavlink
from vehicle_sim.protocol.units import E7, clamp16

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    from vehicle_sim.protocol.host import Host, Sender


class LegacyPlanService:
    """Answers FENCE_FETCH_POINT and RALLY_FETCH_POINT."""

    def __init__(self, host: "Host") -> None:
        self._host = host
        known: Mapping[int, Callable[[Sender, Message], None]] = {
            mavlink.MAVLINK_MSG_ID_FENCE_FETCH_POINT: self.on_fence,
            mavlink.MAVLINK_MSG_ID_RALLY_FETCH_POINT: self.on_rally,
        }
        self.messages = {} if host.table.flavour is Flavour.PX4 else known

    def on_fence(self, sender: "Sender", message: Message) -> None:
        """Tell a point of the fence, and how many there are."""
        autopilot = self._host.vehicle.autopilot
        plan = autopilot.guard.fence.plan
        back = plan.return_point or autopilot.home
        areas = plan.areas
        if back is None or len(areas) != 1 or not isinstance(areas[0], Polygon) or not areas[0].contains:
            return
        points = (back, *areas[0].vertices, areas[0].vertices[0])
        if message.idx >= len(points):
            self._host.say(Severity.WARNING, "Invalid fence point, index past end")
            return
        point = points[message.idx]
        who = (sender.system_id, sender.component_id)
        sender.link.send(
            mavlink.MAVLink_fence_point_message(*who, message.idx, len(points), point.lat_deg, point.lon_deg)
        )

    def on_rally(self, sender: "Sender", message: Message) -> None:
        """Tell a rally point, and how many there are."""
        points = self._host.vehicle.autopilot.rally
        if message.idx >= len(points):
            self._host.say(Severity.WARNING, "Bad rally point index")
            return
        point = points[message.idx]
        place = (round(point.place.lat_deg * E7), round(point.place.lon_deg * E7), clamp16(point.height_m))
        who = (sender.system_id, sender.component_id)
        sender.link.send(mavlink.MAVLink_rally_point_message(*who, message.idx, len(points), *place, 0, 0, 0))
