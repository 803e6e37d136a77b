"""The parameter protocol: https://mavlink.io/en/services/parameter.html.

ArduPilot sends integers as floats of equal value, PX4 sends their bytes in the float's place.
"""

import re
from math import isfinite
from struct import pack, unpack
from typing import TYPE_CHECKING, Final

from vehicle_sim.autopilot import Outcome, Severity
from vehicle_sim.errors import ParameterError
from vehicle_sim.parameters import ParameterKind, ParameterStore
from vehicle_sim.protocol.checksum import plain_crc32
from vehicle_sim.protocol.commands import Request
from vehicle_sim.protocol.dialect import Message, mavlink
from vehicle_sim.protocol.host import Host, Sender
from vehicle_sim.protocol.link import Link

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

_NO_INDEX: Final = 65535
_NAME_BYTES: Final = 16
_PER_STEP: Final = 4
_RESET: Final = 2.0
_HASH: Final = "_HASH_CHECK"
_VOLATILE: Final = re.compile(
    r"CAL_(ACC|GYRO|MAG)\d_[XYZ](OFF|SCALE|ODIAG|COMP)|CAL_BARO\d_OFF|COM_FLIGHT_UUID|EKF2_MAG_DECL|LND_FLIGHT_T_(HI|LO)"
)
"""What PX4 changes by itself: its checksum leaves it out."""


class ParameterService:
    """Lists, reads and sets parameters.

    Attributes:
        is_listing: Whether a list is on its way on some link, so that `advance` has something to do.
    """

    def __init__(self, host: Host) -> None:
        self._host = host
        self._listing: dict[Link, int] = {}
        self._resets = False
        self.commands: Mapping[int, Callable[[Request], Outcome]] = {
            mavlink.MAV_CMD_PREFLIGHT_STORAGE: self._storage,
        }
        self.messages: Mapping[int, Callable[[Sender, Message], None]] = {
            mavlink.MAVLINK_MSG_ID_PARAM_REQUEST_LIST: self.on_request_list,
            mavlink.MAVLINK_MSG_ID_PARAM_REQUEST_READ: self.on_request_read,
            mavlink.MAVLINK_MSG_ID_PARAM_SET: self.on_set,
        }

    @property
    def _store(self) -> ParameterStore:
        return self._host.vehicle.parameters

    @property
    def is_listing(self) -> bool:
        """Whether `advance` has anything to send."""
        return bool(self._listing)

    def forget(self, link: Link) -> None:
        """Stop what is under way on a link that is gone."""
        self._listing.pop(link, None)

    def reboot(self) -> None:
        """Carry out a reset that has waited for the restart."""
        if self._resets:
            self._resets = False
            self._store.reset()

    def _storage(self, request: Request) -> Outcome:
        """Answer PREFLIGHT_STORAGE: 2 resets all parameters, on PX4 at once, on ArduPilot at the next restart.

        What is set is stored already, so that PX4's requests to load (0) and to save (1) have nothing to do.
        """
        is_px4, action = self._host.table.bytewise_parameters, request.params[0]
        if self._host.vehicle.autopilot.armed:
            return Outcome.TEMPORARILY_REJECTED if is_px4 else Outcome.FAILED
        if action == _RESET:
            if is_px4:
                self._store.reset()
            else:
                self._resets = True
                self._host.say(Severity.WARNING, "All parameters reset, reboot board")
            return Outcome.ACCEPTED
        return Outcome.ACCEPTED if is_px4 and action in (0.0, 1.0) else Outcome.UNSUPPORTED

    def advance(self) -> None:
        """Send the next few parameters of each list that is under way."""
        store = self._store
        for link, start in list(self._listing.items()):
            following = min(start + _PER_STEP, len(store))
            for index in range(start, following):
                link.send(self._value(store.names[index], index))
            if following < len(store):
                self._listing[link] = following
            else:
                del self._listing[link]

    def on_request_list(self, sender: Sender, _message: Message) -> None:
        """Start a list, or start it over."""
        if self._host.table.bytewise_parameters:
            sender.link.send(self._hash())
        self._listing[sender.link] = 0

    def on_request_read(self, sender: Sender, message: Message) -> None:
        """Send one parameter; one that does not exist is not answered, as neither autopilot does."""
        store, index = self._store, message.param_index
        if index >= 0:
            if index < len(store):
                sender.link.send(self._value(store.names[index], index))
            return
        name = message.param_id
        if name in store:
            sender.link.send(self._value(name, self._index(name)))
        elif name == _HASH and self._host.table.bytewise_parameters:
            sender.link.send(self._hash())

    def on_set(self, sender: Sender, message: Message) -> None:
        """Set a parameter and tell every peer what it is now, also where it could not be set."""
        name, table = message.param_id, self._host.table
        if name not in self._store:
            if name == _HASH and table.bytewise_parameters:
                self.forget(sender.link)  # the ground station has these values already
                sender.link.send(self._hash())
            elif table.bytewise_parameters:
                self._host.say(Severity.ERROR, f"unknown param: {name}")
            return
        definition = self._store.definition(name)
        if table.bytewise_parameters and message.param_type != definition.kind.value:
            self._host.say(Severity.ERROR, f"param types mismatch param: {name}")
            return
        value = self._decoded(message.param_value, definition.kind)
        try:
            self._store.set(name, value)
        except ParameterError as error:
            denied = f"Param write denied ({name})" if definition.read_only else str(error)
            self._host.say(Severity.WARNING, denied)
        self._host.broadcast(self._value(name, self._index(name)))

    def _index(self, name: str) -> int:
        return self._store.names.index(name) if self._host.table.names_parameters_on_set else _NO_INDEX

    def _value(self, name: str, index: int) -> Message:
        store = self._store
        kind = store.definition(name).kind
        value = self._encoded(store.stored(name), kind)
        return mavlink.MAVLink_param_value_message(_name_bytes(name), value, kind.value, len(store), index)

    def _encoded(self, value: float, kind: ParameterKind) -> float:
        if self._host.table.bytewise_parameters and kind is not ParameterKind.REAL32:
            return _float_of(pack("<i", int(value)))
        return float(value)

    def _decoded(self, wire: float, kind: ParameterKind) -> float:
        if self._host.table.bytewise_parameters and kind is not ParameterKind.REAL32:
            return float(unpack("<i", pack("<f", wire))[0])
        return wire if isfinite(wire) else float("nan")

    def _hash(self) -> Message:
        """Return PX4's checksum over names and values, with which a ground station knows its cache is right."""
        store, checksum = self._store, 0
        for name in store.names:
            if _VOLATILE.fullmatch(name):
                continue
            is_real = store.definition(name).kind is ParameterKind.REAL32
            value = pack("<f", store.stored(name)) if is_real else pack("<i", int(store.stored(name)))
            checksum = plain_crc32(value, plain_crc32(name.encode("ascii"), checksum))
        wire = _float_of(pack("<I", checksum))
        kind = mavlink.MAV_PARAM_TYPE_UINT32
        return mavlink.MAVLink_param_value_message(_name_bytes(_HASH), wire, kind, len(store), _NO_INDEX)


def _name_bytes(name: str) -> bytes:
    """Return a parameter's name as its field holds it: NUL-terminated only where shorter than the field."""
    return name.encode("ascii")[:_NAME_BYTES]


def _float_of(four_bytes: bytes) -> float:
    return float(unpack("<f", four_bytes)[0])
