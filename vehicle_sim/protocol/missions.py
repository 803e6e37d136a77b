"""Missions under way: which item is current, which was reached, start, choice of the next item, and going somewhere.

https://mavlink.io/en/services/mission.html. The transfer of missions is the business of `plans`.
"""

from math import isfinite
from typing import TYPE_CHECKING, Final

from vehicle_sim.autopilot import Mode, Outcome, Progress, Severity
from vehicle_sim.geodesy import ned_offset_m
from vehicle_sim.parameters import Flavour
from vehicle_sim.protocol.dialect import Message, mavlink
from vehicle_sim.protocol.mission_items import mission_item
from vehicle_sim.protocol.opaque_ids import with_ids
from vehicle_sim.protocol.places import altitude_m, global_place
from vehicle_sim.protocol.plan_store import PlanItem, PlanKind, PlanStore
from vehicle_sim.protocol.units import E7, whole_number

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    from vehicle_sim.protocol.commands import Request
    from vehicle_sim.protocol.host import Host, Sender
    from vehicle_sim.protocol.telemetry import Builder
    from vehicle_sim.signals import PartialVector

GO_TO: Final = 2
CHANGE_HEIGHT: Final = 3

_NO_MISSION: Final = 1
_STATES: Final = {Progress.NOT_STARTED: 2, Progress.ACTIVE: 3, Progress.PAUSED: 4, Progress.COMPLETE: 5}
_IN_MODE, _SUSPENDED = 1, 2
_NO_ITEMS: Final = 65535
_MISSION_MODES: Final = {
    Flavour.ARDUPILOT: (Mode.AUTO,),
    Flavour.PX4: (Mode.AUTO, Mode.TAKEOFF, Mode.LAND),
}


class MissionService:
    """Tells how the mission goes on, and takes requests about it.

    Attributes:
        keepers: Hands a whole new mission to the autopilot, for the transfer of plans.
    """

    def __init__(self, host: "Host", store: PlanStore) -> None:
        """Speak of the mission in `store`, which the autopilot of `host` flies."""
        self._host = host
        self._store = store
        self._is_px4 = host.table.flavour is Flavour.PX4
        self.keepers: Mapping[PlanKind, Callable[[tuple[PlanItem, ...]], int]] = {PlanKind.MISSION: self._keep}
        self.messages: Mapping[int, Callable[[Sender, Message], None]] = {
            mavlink.MAVLINK_MSG_ID_MISSION_SET_CURRENT: self.on_set_current,
        }
        self.commands: Mapping[int, Callable[[Request], Outcome]] = {
            mavlink.MAV_CMD_MISSION_START: self._start,
            mavlink.MAV_CMD_DO_SET_MISSION_CURRENT: self._set_current,
        }
        self.telemetry: Mapping[int, Builder] = {
            mavlink.MAVLINK_MSG_ID_MISSION_CURRENT: lambda _host: self._mission_current()
        }

    def report(self) -> None:
        """Tell every link what happened: items that were reached and, on PX4, each new current item."""
        news = self._host.vehicle.autopilot.mission.news
        while news:
            item, reached = news.popleft()
            if reached:
                self._host.broadcast(mavlink.MAVLink_mission_item_reached_message(item))
            elif self._is_px4:
                self._host.broadcast(self._mission_current(item))

    def _keep(self, items: tuple[PlanItem, ...]) -> int:
        flavour = self._host.table.flavour
        marked = [seq for seq, item in enumerate(items) if item.is_current]
        flown = tuple(mission_item(flavour, item) for item in items)
        self._host.vehicle.autopilot.load_mission(flown, marked[-1] if marked else None)
        if items and not self._is_px4:
            self._host.say(Severity.INFO, "Flight plan received")
        return int(mavlink.MAV_MISSION_ACCEPTED)

    def on_set_current(self, sender: "Sender", message: Message) -> None:
        """Choose the next item; answered by what is current then, by ArduPilot with the number that was asked for."""
        if self._host.vehicle.autopilot.mission.set_current(message.seq):
            sender.link.send(self._mission_current(message.seq))
            return
        if self._is_px4:
            self._host.say(Severity.CRITICAL, "WPM: WP CURR CMD: Not in list")
        sender.link.send(self._mission_current())

    def _set_current(self, request: "Request") -> Outcome:
        seq = whole_number(request.params[0])
        resets = request.params[1] == 1.0
        mission = self._host.vehicle.autopilot.mission
        refused = Outcome.DENIED if self._is_px4 else Outcome.FAILED
        if seq is None or not mission.set_current(seq, resets_jumps=resets):
            return refused
        request.sender.link.send(self._mission_current())
        return Outcome.ACCEPTED

    def _start(self, request: "Request") -> Outcome:
        """Fly the mission; only PX4 knows a first item, and neither knows a last one."""
        first, last = request.params[:2]
        autopilot = self._host.vehicle.autopilot
        if not self._is_px4:
            return Outcome.DENIED if first != 0.0 or last != 0.0 else autopilot.start_mission()
        if not isfinite(first) or first < -1.0 or first >= len(autopilot.mission.items):
            return Outcome.DENIED
        return autopilot.start_mission(int(first) if first >= 0.0 else None)

    def _mission_current(self, seq: int | None = None) -> Message:
        autopilot, table = self._host.vehicle.autopilot, self._host.table
        mission = autopilot.mission
        # Of ArduPilot's count the home position is no part.
        total = len(mission.items) - int(table.home_is_item_0)
        state = _STATES[mission.progress]
        if not mission.present or (self._is_px4 and autopilot.mission_fault is not None):
            state = _NO_MISSION
        elif not self._is_px4 and mission.progress is Progress.PAUSED:
            state = _STATES[Progress.NOT_STARTED]  # ArduPilot knows only "stopped"
        message = mavlink.MAVLink_mission_current_message(
            mission.current if seq is None else seq,
            total if mission.present else _NO_ITEMS,
            state,
            _IN_MODE if autopilot.mode in _MISSION_MODES[table.flavour] else _SUSPENDED,
        )
        return with_ids(message, *(self._store.ids[kind] for kind in PlanKind)) if self._is_px4 else message


def fly_item(host: "Host", item: PlanItem, purpose: int) -> int:
    """Fly there at once, or to its height alone: how older ground stations send ArduPilot somewhere in GUIDED.

    Returns the MAV_MISSION_RESULT.
    """
    vehicle = host.vehicle
    autopilot, estimate = vehicle.autopilot, vehicle.estimate
    origin = estimate.origin
    if origin is None or autopilot.mode is not Mode.GUIDED:
        return int(mavlink.MAV_MISSION_ERROR)
    target: PartialVector | None = None
    if purpose == CHANGE_HEIGHT:
        alt_m = altitude_m(item.z, item.frame, autopilot.home)
        kept = estimate.position_ned_m if autopilot.target is None else autopilot.target.position_ned_m
        target = None if alt_m is None else (kept[0], kept[1], origin.alt_m - alt_m)
    elif item.command == mavlink.MAV_CMD_NAV_WAYPOINT:
        place = global_place(item.x / E7, item.y / E7, item.z, item.frame, autopilot.home)
        target = None if place is None else ned_offset_m(origin, place)
    outcome = Outcome.DENIED if target is None else autopilot.reposition(target)
    return int(mavlink.MAV_MISSION_ACCEPTED if outcome is Outcome.ACCEPTED else mavlink.MAV_MISSION_ERROR)
