"""The mission protocol: upload, download and clearing of plans, with one partner at a time.

https://mavlink.io/en/services/mission.html. An upload asks for item after item, asks again when one does not come, and
takes effect as a whole with its last item; any fault, or silence, leaves the former plan as it was. Downloads need no
state: every item that is asked for is sent.
"""

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Final

from vehicle_sim.autopilot import Severity
from vehicle_sim.parameters import Flavour
from vehicle_sim.protocol.dialect import Message, mavlink
from vehicle_sim.protocol.mission_items import item_fault
from vehicle_sim.protocol.missions import CHANGE_HEIGHT, GO_TO, fly_item
from vehicle_sim.protocol.opaque_ids import plan_id, with_ids
from vehicle_sim.protocol.places import GLOBAL_FRAMES
from vehicle_sim.protocol.plan_store import MOST_ITEMS, PlanItem, PlanKind, PlanStore, place_fault
from vehicle_sim.protocol.streams import NEVER_US
from vehicle_sim.protocol.units import E7

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    from vehicle_sim.protocol.host import Host, Sender
    from vehicle_sim.protocol.link import Link

_ALL: Final = mavlink.MAV_MISSION_TYPE_ALL
_ACCEPTED: Final = mavlink.MAV_MISSION_ACCEPTED
_INT32: Final = 2**31
_TOTALS: Final = {PlanKind.MISSION: "MIS_TOTAL", PlanKind.FENCE: "FENCE_TOTAL", PlanKind.RALLY: "RALLY_TOTAL"}
"""ArduPilot's parameters that tell how many items each plan has."""


@dataclass(slots=True)
class _Upload:
    """An upload under way: from whom, of what, how far, and when the last sign of life came.

    One of a part begins with the `items` that are before it, and ends with the `rest`, which stays as it is.
    """

    partner: "Sender"
    kind: PlanKind
    count: int
    items: list[PlanItem] = field(default_factory=list)
    rest: tuple[PlanItem, ...] = ()
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
        self._is_px4 = host.table.flavour is Flavour.PX4
        self.store = PlanStore()
        self.keepers: dict[PlanKind, Callable[[tuple[PlanItem, ...]], int]] = {}
        self.next_due_us = NEVER_US
        self._upload: _Upload | None = None
        self._last: tuple[Sender, int, int] | None = None
        self.messages: Mapping[int, Callable[[Sender, Message], None]] = {
            mavlink.MAVLINK_MSG_ID_MISSION_COUNT: self.on_count,
            mavlink.MAVLINK_MSG_ID_MISSION_ITEM: self.on_item,
            mavlink.MAVLINK_MSG_ID_MISSION_ITEM_INT: self.on_item,
            mavlink.MAVLINK_MSG_ID_MISSION_ACK: self.on_ack,
            mavlink.MAVLINK_MSG_ID_MISSION_REQUEST_LIST: self.on_request_list,
            mavlink.MAVLINK_MSG_ID_MISSION_REQUEST: self.on_request,
            mavlink.MAVLINK_MSG_ID_MISSION_REQUEST_INT: self.on_request,
            mavlink.MAVLINK_MSG_ID_MISSION_CLEAR_ALL: self.on_clear_all,
            mavlink.MAVLINK_MSG_ID_MISSION_WRITE_PARTIAL_LIST: self._refuse if self._is_px4 else self.on_partial,
            mavlink.MAVLINK_MSG_ID_MISSION_REQUEST_PARTIAL_LIST: self._refuse,
        }

    def forget(self, link: "Link") -> None:
        """Give up what was under way on a link that is gone."""
        if self._upload is not None and self._upload.partner.link is link:
            self._end_upload()
        if self._last is not None and self._last[0].link is link:
            self._last = None

    def advance(self) -> None:
        """Ask again for an item that did not come, or give the upload up."""
        upload, now_us = self._upload, self._host.now_us
        if upload is None:
            return
        if now_us - upload.heard_us >= self._host.table.plan_timeout_us:
            self._end_upload()
            if self._is_px4:
                self._host.say(Severity.CRITICAL, "Operation timeout")
            else:
                self._host.say(Severity.WARNING, "Mission upload timeout")
                self._acknowledge(upload.partner, mavlink.MAV_MISSION_OPERATION_CANCELLED, upload.kind)
        elif now_us >= upload.ask_again_us:
            self._ask()

    # Upload.

    def on_count(self, sender: "Sender", message: Message) -> None:
        """Begin an upload; the same partner may begin anew, another one has to wait."""
        kind = _kind(message.mission_type)
        if kind is None:
            self._acknowledge(sender, mavlink.MAV_MISSION_UNSUPPORTED, message.mission_type)
        elif self._upload is not None and self._upload.partner != sender:
            self._acknowledge(sender, mavlink.MAV_MISSION_ERROR if self._is_px4 else mavlink.MAV_MISSION_DENIED, kind)
        elif message.count > MOST_ITEMS:
            if not self._is_px4:
                self._host.say(Severity.WARNING, f"Only {MOST_ITEMS} items are supported")
            self._acknowledge(sender, mavlink.MAV_MISSION_NO_SPACE, kind)
        elif message.count == 0:
            self._end_upload()
            self._acknowledge(sender, self._keep(kind, ()), kind)
        else:
            self._upload = _Upload(sender, kind, message.count, heard_us=self._host.now_us)
            self._last = None
            self._ask()

    def on_item(self, sender: "Sender", message: Message) -> None:
        """Take the item that was asked for; one that was taken already is asked for no more, others are faults."""
        item = _item(message)
        if message.current in (GO_TO, CHANGE_HEIGHT) and not self._is_px4:
            result = fly_item(self._host, item, message.current) if isinstance(item, PlanItem) else item
            self._acknowledge(sender, result, PlanKind.MISSION)
            return
        upload = self._upload
        if upload is None or upload.partner != sender or upload.kind != message.mission_type:
            self._refuse_item(sender, message)
            return
        upload.heard_us = self._host.now_us
        expected = len(upload.items)
        if message.seq == expected - 1:
            self._ask()  # our last request was lost, or the partner repeats itself
            return
        if message.seq != expected:
            if not self._is_px4:  # PX4 waits for the right one
                self._acknowledge(sender, mavlink.MAV_MISSION_INVALID_SEQUENCE, upload.kind)
            return
        result = self._fault(upload.kind, item) if isinstance(item, PlanItem) else item
        if not isinstance(item, PlanItem) or result != _ACCEPTED:
            self._end_upload()
            if self._is_px4:
                self._host.say(Severity.CRITICAL, "IGN MISSION_ITEM: Invalid item")
            self._acknowledge(sender, result, upload.kind)
            return
        upload.items.append(item)
        if len(upload.items) < upload.count:
            self._ask()
            return
        self._end_upload()
        result = self._keep(upload.kind, (*upload.items, *upload.rest))
        self._last = (sender, upload.kind, message.seq) if result == _ACCEPTED else None
        self._acknowledge(sender, result, upload.kind, named=True)

    def _refuse_item(self, sender: "Sender", message: Message) -> None:
        """Answer an item that nobody asked for; to PX4 it may be the last one again, whose answer was lost."""
        if not self._is_px4:
            other = self._upload is not None and self._upload.partner != sender
            self._acknowledge(
                sender, mavlink.MAV_MISSION_DENIED if other else mavlink.MAV_MISSION_ERROR, message.mission_type
            )
        elif self._upload is not None and self._upload.partner != sender:
            self._host.say(Severity.CRITICAL, "REJ. MIS ITEM: partner id mismatch")
        elif self._last == (sender, message.mission_type, message.seq):
            self._acknowledge(sender, _ACCEPTED, message.mission_type, named=True)
        else:
            self._acknowledge(sender, mavlink.MAV_MISSION_ERROR, message.mission_type)

    def _fault(self, kind: PlanKind, item: PlanItem) -> int:
        if kind is PlanKind.MISSION:
            return item_fault(self._host.table.flavour, item)
        return place_fault(kind, item)

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
        name = plan_id(items) if self._is_px4 else 0
        if items and self._is_px4 and name == self.store.ids[kind]:
            return int(_ACCEPTED)  # the same again, which changes nothing
        result = self.keepers[kind](items) if kind in self.keepers else int(_ACCEPTED)
        if result == _ACCEPTED:
            self.store.replace(kind, items, name)
            self._host.vehicle.parameters.tell(_TOTALS[kind], len(items))
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
        if self._upload is not None:
            if self._is_px4:
                self._host.say(Severity.INFO, "Mission download request ignored, already active")
            else:
                self._acknowledge(sender, mavlink.MAV_MISSION_DENIED, kind)
            return
        count = mavlink.MAVLink_mission_count_message(
            sender.system_id, sender.component_id, len(self._items(kind)), kind
        )
        sender.link.send(with_ids(count, self.store.ids[kind]) if self._is_px4 else count)

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
        current = int(kind is PlanKind.MISSION and message.seq == self._host.vehicle.autopilot.mission.current)
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
        flown = not self._is_px4 and self._host.vehicle.autopilot.mission.running
        if self._upload is not None and self._is_px4:
            self._host.say(Severity.CRITICAL, "WPM: IGN CLEAR CMD: Busy")
            return
        if self._upload is not None or (flown and kind in (None, PlanKind.MISSION)):
            # ArduPilot does not forget what it is flying.
            self._acknowledge(sender, mavlink.MAV_MISSION_ERROR, message.mission_type)
            return
        for cleared in PlanKind if kind is None else (kind,):
            self._keep(cleared, ())
        self._acknowledge(sender, _ACCEPTED, message.mission_type)

    def on_partial(self, sender: "Sender", message: Message) -> None:
        """Begin an upload of items from one to another, as ArduPilot does; both may be one past the end."""
        kind, first, last = _kind(message.mission_type), message.start_index, message.end_index
        items = () if kind is None else self.store.plans[kind]
        if kind is None:
            self._refuse(sender, message)
        elif self._upload is not None and self._upload.partner != sender:
            self._acknowledge(sender, mavlink.MAV_MISSION_DENIED, kind)
        elif not 0 <= first <= last <= len(items):
            self._host.say(Severity.WARNING, "Flight plan update rejected")
            self._acknowledge(sender, mavlink.MAV_MISSION_ERROR, kind)
        else:
            items = tuple(item._replace(is_current=False) for item in items)
            before, rest = list(items[:first]), items[last + 1 :]
            self._upload = _Upload(sender, kind, last + 1, before, rest, heard_us=self._host.now_us)
            self._last = None
            self._ask()

    def _refuse(self, sender: "Sender", message: Message) -> None:
        """Refuse to transfer part of a plan."""
        self._acknowledge(sender, mavlink.MAV_MISSION_UNSUPPORTED, message.mission_type)

    def _acknowledge(self, sender: "Sender", result: int, mission_type: int, *, named: bool = False) -> None:
        """Answer; PX4's answer to a whole plan is `named` after it."""
        ack = mavlink.MAVLink_mission_ack_message(sender.system_id, sender.component_id, int(result), int(mission_type))
        kind = _kind(mission_type)
        if named and self._is_px4 and kind is not None:
            ack = with_ids(ack, self.store.ids[kind])
        sender.link.send(ack)


# The home position can be read at any time: clients ask for it even where the count is 0, and wait for it.
_UNKNOWN_HOME: Final = PlanItem(
    mavlink.MAV_FRAME_GLOBAL, mavlink.MAV_CMD_NAV_WAYPOINT, 1, (0.0, 0.0, 0.0, 0.0), 0, 0, 0.0
)
_KINDS: Final = {kind.value: kind for kind in PlanKind}


def _kind(mission_type: int) -> PlanKind | None:
    return _KINDS.get(mission_type)


def _item(message: Message) -> PlanItem | int:
    """Return the item of either message; a MAV_MISSION_RESULT where a number of the float form is none that fits."""
    if message.get_msgId() == mavlink.MAVLINK_MSG_ID_MISSION_ITEM_INT:
        x, y = message.x, message.y
    else:
        scale = E7 if message.frame in GLOBAL_FRAMES else 1.0
        for value, result in (
            (message.x, mavlink.MAV_MISSION_INVALID_PARAM5_X),
            (message.y, mavlink.MAV_MISSION_INVALID_PARAM6_Y),
        ):
            if not abs(value * scale) < _INT32:
                return int(result)
        x, y = round(message.x * scale), round(message.y * scale)
    params = (message.param1, message.param2, message.param3, message.param4)
    return PlanItem(
        message.frame, message.command, message.autocontinue, params, x, y, message.z, is_current=message.current == 1
    )
