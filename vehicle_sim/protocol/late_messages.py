"""Messages that pymavlink's dialect of ArduPilot does not have yet, made and read by their definitions in `common.xml`.

They are put into the dialect's own table, so that links read them with their checksum, and receivers in the same
process too. A dialect that has one already keeps its own.
"""

from itertools import chain
from struct import Struct
from typing import Any, Final

from vehicle_sim.protocol.data_files import data_file
from vehicle_sim.protocol.dialect import Message, mavlink


class LateMessage(mavlink.MAVLink_message):  # type: ignore[misc]  # pymavlink ships no types
    """A message whose fields are given in the order of the wire, or by their names."""

    def __init__(self, *values: object, **named: object) -> None:
        super().__init__(type(self).id, type(self).msgname)
        self._fieldnames = type(self).fieldnames
        for name, value in chain(zip(self._fieldnames, values, strict=False), named.items()):
            setattr(self, name, value.decode("ascii", "replace") if isinstance(value, bytes) else value)

    def pack(self, mav: mavlink.MAVLink, force_mavlink1: bool = False) -> bytes:  # noqa: FBT001, FBT002 - pymavlink's signature
        """Return the frame."""
        kind = type(self)
        numbers: list[Any] = []
        for name, length in zip(kind.fieldnames, kind.array_lengths, strict=True):
            value = getattr(self, name)
            if isinstance(value, str):
                value = [value.encode("ascii", "replace")]
            numbers += value if length else [value]
        payload = kind.unpacker.pack(*numbers)
        frame: bytes = self._pack(mav, kind.crc_extra, payload, force_mavlink1=force_mavlink1)
        return frame


def _late(name: str, number: int, crc_extra: int, fields: dict[str, str]) -> type[Message]:
    """Define a message; each of its fields in the order of the wire has a format of `struct`, as `H` or `40B`."""
    counts = [int(field[:-1] or 0) for field in fields.values()]
    is_text = [field.endswith("s") for field in fields.values()]
    attributes: dict[str, Any] = {
        "id": number,
        "msgname": name,
        "fieldnames": list(fields),
        "ordered_fieldnames": list(fields),
        "fieldtypes": ["char" if text else "uint8_t" for text in is_text],
        "orders": list(range(len(fields))),
        "lengths": [1 if text else count or 1 for count, text in zip(counts, is_text, strict=True)],
        "array_lengths": counts,
        "crc_extra": crc_extra,
        "unpacker": Struct("<" + "".join(fields.values())),
    }
    kind = type(name, (LateMessage,), attributes)
    mavlink.mavlink_map.setdefault(number, kind)
    return kind


_KINDS: Final = {name: _late(name, *row) for name, row in data_file("late_messages").items()}
ComponentMetadata: Final = _KINDS["COMPONENT_METADATA"]
Event: Final = _KINDS["EVENT"]
CurrentEventSequence: Final = _KINDS["CURRENT_EVENT_SEQUENCE"]
RequestEvent: Final = _KINDS["REQUEST_EVENT"]
ResponseEventError: Final = _KINDS["RESPONSE_EVENT_ERROR"]
AvailableModes: Final = _KINDS["AVAILABLE_MODES"]
CurrentMode: Final = _KINDS["CURRENT_MODE"]
AvailableModesMonitor: Final = _KINDS["AVAILABLE_MODES_MONITOR"]
