"""The mission protocol: upload, download and clearing of plans, with one partner at a time.

https://mavlink.io/en/services/mission.html. An upload asks for item after item, asks again when one does not come, and
takes effect as a whole with its last item; any fault, or silence, leaves the former plan as it was. Downloads need no
state: every item that is asked for is sent.
"""

from dataclasses import dataclass, field
from math import isfinite
from typing import TYPE_CHECKING, Final

from vehicle_sim.autopilot import Mode, Outcome, Severity
from vehicle_sim.geodesy import ned_offset_m
from vehicle_sim.parameters import Flavour
from vehicle_sim.protocol.dialect import Message, mavlink
from vehicle_sim.protocol.places import GLOBAL_FRAMES, global_place
from vehicle_sim.protocol.plan_store import MOST_ITEMS, PlanItem, PlanKind, PlanStore, fault
from vehicle_sim.protocol.streams import NEVER_US
from vehicle_sim.protocol.units import E7, whole_number

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    from vehicle_sim.protocol.commands import Request
    from vehicle_sim.protocol.host import Host, Sender
    from vehicle_sim.protocol.link import Link
    from vehicle_sim.protocol.telemetry import Builder

_ALL: Final = mavlink.MAV_MISSION_TYPE_ALL
_ACCEPTED: Final = mavlink.MAV_MISSION_ACCEPTED
_GUIDED_GO_TO: Final = 2
_NO_MISSION: Final = 1
_MISSION_NOT_STARTED: Final = 2
_INT32: Final = 2**31


@dataclass(slots=True)
class _Upload:
    """An upload under way: from whom, of what, how far, and when the last sign of life came."""

    partner: "Sender"
    kind: PlanKind
    count: int
    items: list[PlanItem] = field(default_factory=list)
    heard_us: int = 0
    ask_again_us: int = 0


class PlanService:
    """Answers all of the mission protocol.

    Attributes:
        store: The plans themselves.
        next_due_us: Nothing happens by itself before; `NEVER_US` without an upload.
        keepers: What must agree to a whole plan of a kind before it is stored; others add theirs.
    """

    def __init__(self, host: "Host") -> None:
        self._host = host
        self.store = PlanStore()
        self.keepers: dict[PlanKind, Callable[[tuple[PlanItem, ...]], int]] = {}
        self.next_due_us = NEVER_US
        self._upload: _Upload | None = None
        self.messages: Mapping[int, Callable[[Sender, Message], None]] = {
            mavlink.MAVLINK_MSG_ID_MISSION_COUNT: self.on_count,
            mavlink.MAVLINK_MSG_ID_MISSION_ITEM: self.on_item,
            mavlink.MAVLINK_MSG_ID_MISSION_ITEM_INT: self.on_item,
            mavlink.MAVLINK_MSG_ID_MISSION_ACK: self.on_ack,
            mavlink.MAVLINK_MSG_ID_MISSION_REQUEST_LIST: self.on_request_list,
            mavlink.MAVLINK_MSG_ID_MISSION_REQUEST: self.on_request,
            mavlink.MAVLINK_MSG_ID_MISSION_REQUEST_INT: self.on_request,
            mavlink.MAVLINK_MSG_ID_MISSION_CLEAR_ALL: self.on_clear_all,
            mavlink.MAVLINK_MSG_ID_MISSION_SET_CURRENT: self.on_set_current,
            mavlink.MAVLINK_MSG_ID_MISSION_WRITE_PARTIAL_LIST: self.on_partial,
            mavlink.MAVLINK_MSG_ID_MISSION_REQUEST_PARTIAL_LIST: self.on_partial,
        }
        self.commands: Mapping[int, Callable[[Request], Outcome]] = {
            mavlink.MAV_CMD_MISSION_START: self._start,
            mavlink.MAV_CMD_DO_SET_MISSION_CURRENT: self._set_current,
        }
        self.telemetry: Mapping[int, Builder] = {
            mavlink.MAVLINK_MSG_ID_MISSION_CURRENT: lambda _host: self._mission_current()
        }

    def forget(self, link: "Link") -> None:
        """Give up what was under way on a link that is gone."""
        if self._upload is not None and self._upload.partner.link is link:
            self._end_upload()

    def advance(self) -> None:
        """Ask again for an item that did not come, or give the upload up."""
        upload, now_us = self._upload, self._host.now_us
        if upload is None:
            return
        if now_us - upload.heard_us >= self._host.table.plan_timeout_us:
            self._host.say(Severity.WARNING, "Mission upload timeout")
            self._acknowledge(upload.partner, mavlink.MAV_MISSION_OPERATION_CANCELLED, upload.kind)
            self._end_upload()
        elif now_us >= upload.ask_again_us:
            self._ask()

    # Upload.

    def on_count(self, sender: "Sender", message: Message) -> None:
        """Begin an upload; the same partner may begin anew, another one has to wait."""
        kind = _kind(message.mission_type)
        if kind is None:
            self._acknowledge(sender, mavlink.MAV_MISSION_UNSUPPORTED, message.mission_type)
        elif self._upload is not None and self._upload.partner != sender:
            self._acknowledge(sender, mavlink.MAV_MISSION_DENIED, kind)
        elif message.count > MOST_ITEMS:
            self._acknowledge(sender, mavlink.MAV_MISSION_NO_SPACE, kind)
        elif message.count == 0:
            self._end_upload()
            self._acknowledge(sender, self._keep(kind, ()), kind)
        else:
            self._upload = _Upload(sender, kind, message.count, heard_us=self._host.now_us)
            self._ask()

    def on_item(self, sender: "Sender", message: Message) -> None:
        """Take the item that was asked for; one that was taken already is asked for no more, others are faults."""
        if message.current == _GUIDED_GO_TO and self._host.table.flavour is Flavour.ARDUPILOT:
            self._go_to(sender, message)
            return
        upload, item = self._upload, _item(message)
        if upload is None or upload.partner != sender or upload.kind != message.mission_type:
            self._acknowledge(sender, mavlink.MAV_MISSION_ERROR, message.mission_type)
            return
        upload.heard_us = self._host.now_us
        expected = len(upload.items)
        if message.seq == expected - 1:
            self._ask()  # our last request was lost, or the partner repeats itself
            return
        if message.seq != expected:
            self._acknowledge(sender, mavlink.MAV_MISSION_INVALID_SEQUENCE, upload.kind)
            return
        result = mavlink.MAV_MISSION_INVALID if item is None else fault(upload.kind, item)
        if item is None or result != _ACCEPTED:
            self._end_upload()
            self._acknowledge(sender, result, upload.kind)
            return
        upload.items.append(item)
        if len(upload.items) < upload.count:
            self._ask()
            return
        self._end_upload()
        self._acknowledge(sender, self._keep(upload.kind, tuple(upload.items)), upload.kind)

    def on_ack(self, sender: "Sender", message: Message) -> None:
        """Close a download, which needs nothing; a refusal by the partner ends its upload."""
        if self._upload is not None and self._upload.partner == sender and message.type != _ACCEPTED:
            self._end_upload()

    def _ask(self) -> None:
        upload, table = self._upload, self._host.table
        if upload is None:
            return
        is_int = table.plan_request_id == mavlink.MAVLINK_MSG_ID_MISSION_REQUEST_INT
        request = mavlink.MAVLink_mission_request_int_message if is_int else mavlink.MAVLink_mission_request_message
        partner = upload.partner
        partner.link.send(request(partner.system_id, partner.component_id, len(upload.items), upload.kind))
        upload.ask_again_us = self._host.now_us + table.plan_retry_us
        self.next_due_us = min(upload.ask_again_us, upload.heard_us + table.plan_timeout_us)

    def _keep(self, kind: PlanKind, items: tuple[PlanItem, ...]) -> int:
        """Store a whole plan if its keeper agrees, and return the MAV_MISSION_RESULT."""
        result = self.keepers[kind](items) if kind in self.keepers else int(_ACCEPTED)
        if result == _ACCEPTED:
            self.store.replace(kind, items)
        return result

    def _end_upload(self) -> None:
        self._upload = None
        self.next_due_us = NEVER_US

    # Download.

    def _items(self, kind: PlanKind) -> tuple[PlanItem, ...]:
        """Return the items as the autopilot counts them: ArduPilot's mission begins with the home position."""
        items, home = self.store.plans[kind], self._host.vehicle.autopilot.home
        if kind is not PlanKind.MISSION or not self._host.table.home_is_item_0 or home is None:
            return items
        first = PlanItem(
            mavlink.MAV_FRAME_GLOBAL,
            mavlink.MAV_CMD_NAV_WAYPOINT,
            1,
            (0.0, 0.0, 0.0, 0.0),
            round(home.lat_deg * E7),
            round(home.lon_deg * E7),
            home.alt_m,
        )
        return (first, *items[1:])

    def on_request_list(self, sender: "Sender", message: Message) -> None:
        """Say how many items a plan has."""
        kind = _kind(message.mission_type)
        if kind is None:
            self._acknowledge(sender, mavlink.MAV_MISSION_UNSUPPORTED, message.mission_type)
            return
        count = mavlink.MAVLink_mission_count_message(
            sender.system_id, sender.component_id, len(self._items(kind)), kind
        )
        sender.link.send(count)

    def on_request(self, sender: "Sender", message: Message) -> None:
        """Send one item, in the form in which it was asked for."""
        kind = _kind(message.mission_type)
        items = () if kind is None else self._items(kind)
        if not items and kind is PlanKind.MISSION and self._host.table.home_is_item_0:
            items = (_UNKNOWN_HOME,)
        if message.seq >= len(items):
            self._acknowledge(sender, mavlink.MAV_MISSION_INVALID_SEQUENCE, message.mission_type)
            return
        item = items[message.seq]
        current = int(kind is PlanKind.MISSION and message.seq == self.store.current)
        head = (sender.system_id, sender.component_id, message.seq, item.frame, item.command, current)
        if message.get_msgId() == mavlink.MAVLINK_MSG_ID_MISSION_REQUEST_INT:
            reply = mavlink.MAVLink_mission_item_int_message(
                *head, item.autocontinue, *item.params, item.x, item.y, item.z, kind
            )
        else:
            scale = E7 if item.frame in GLOBAL_FRAMES else 1.0
            reply = mavlink.MAVLink_mission_item_message(
                *head, item.autocontinue, *item.params, item.x / scale, item.y / scale, item.z, kind
            )
        sender.link.send(reply)

    # The rest.

    def on_clear_all(self, sender: "Sender", message: Message) -> None:
        """Forget one plan, or all of them."""
        kind = _kind(message.mission_type)
        if kind is None and message.mission_type != _ALL:
            self._acknowledge(sender, mavlink.MAV_MISSION_UNSUPPORTED, message.mission_type)
            return
        if self._upload is not None and self._upload.partner != sender:
            self._acknowledge(sender, mavlink.MAV_MISSION_DENIED, message.mission_type)
            return
        self._end_upload()
        for cleared in PlanKind if kind is None else (kind,):
            self._keep(cleared, ())
        self._acknowledge(sender, _ACCEPTED, message.mission_type)

    def on_set_current(self, sender: "Sender", message: Message) -> None:
        """Choose the next item; answered by what is current then."""
        if message.seq < max(len(self._items(PlanKind.MISSION)), 1):
            self.store.current = message.seq
        sender.link.send(self._mission_current())

    def on_partial(self, sender: "Sender", message: Message) -> None:
        """Refuse to transfer part of a plan."""
        self._acknowledge(sender, mavlink.MAV_MISSION_UNSUPPORTED, message.mission_type)

    def _go_to(self, sender: "Sender", message: Message) -> None:
        """Fly there at once: how older ground stations of ArduPilot send a vehicle somewhere in GUIDED."""
        vehicle, item = self._host.vehicle, _item(message)
        autopilot, origin = vehicle.autopilot, vehicle.estimate.origin
        place = None
        if item is not None:
            place = global_place(item.x / E7, item.y / E7, item.z, item.frame, autopilot.home)
        accepted = False
        if place is not None and origin is not None and autopilot.mode is Mode.GUIDED:
            accepted = autopilot.reposition(ned_offset_m(origin, place)) is Outcome.ACCEPTED
        self._acknowledge(sender, _ACCEPTED if accepted else mavlink.MAV_MISSION_ERROR, PlanKind.MISSION)

    def _start(self, _request: "Request") -> Outcome:
        return self._host.vehicle.autopilot.set_mode(Mode.AUTO)

    def _set_current(self, request: "Request") -> Outcome:
        seq = whole_number(request.params[0])
        if seq is None or seq >= len(self._items(PlanKind.MISSION)):
            return Outcome.DENIED
        self.store.current = seq
        return Outcome.ACCEPTED

    def _mission_current(self) -> Message:
        items = len(self._items(PlanKind.MISSION))
        has_mission = bool(self.store.plans[PlanKind.MISSION])
        state = _MISSION_NOT_STARTED if has_mission else _NO_MISSION
        # Of ArduPilot's count the home position is no part.
        total = max(items - 1, 0) if self._host.table.home_is_item_0 else items
        return mavlink.MAVLink_mission_current_message(self.store.current, total, state, 0)

    def _acknowledge(self, sender: "Sender", result: int, mission_type: int) -> None:
        sender.link.send(
            mavlink.MAVLink_mission_ack_message(sender.system_id, sender.component_id, int(result), int(mission_type))
        )


# The home position can be read at any time: clients ask for it even where the count is 0, and wait for it.
_UNKNOWN_HOME: Final = PlanItem(
    mavlink.MAV_FRAME_GLOBAL, mavlink.MAV_CMD_NAV_WAYPOINT, 1, (0.0, 0.0, 0.0, 0.0), 0, 0, 0.0
)
_KINDS: Final = {kind.value: kind for kind in PlanKind}


def _kind(mission_type: int) -> PlanKind | None:
    return _KINDS.get(mission_type)


def _item(message: Message) -> PlanItem | None:
    """Return the item of either message; None where a number of the float form is none."""
    if message.get_msgId() == mavlink.MAVLINK_MSG_ID_MISSION_ITEM_INT:
        x, y = message.x, message.y
    else:
        scale = E7 if message.frame in GLOBAL_FRAMES else 1.0
        if not (isfinite(message.x) and isfinite(message.y)):
            return None
        x, y = round(message.x * scale), round(message.y * scale)
        if max(abs(x), abs(y)) >= _INT32:
            return None
    params = (message.param1, message.param2, message.param3, message.param4)
    return PlanItem(message.frame, message.command, message.autocontinue, params, x, y, message.z)
