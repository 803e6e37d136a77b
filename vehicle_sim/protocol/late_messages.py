"""Messages that pymavlink's dialect of ArduPilot does not have yet, made and read by their definitions in `common.xml`.

They are put into the dialect's own table, so that links read them with their checksum, and receivers in the same
process too. A dialect that has one already keeps its own.
"""

from itertools import chain
from struct import Struct
from typing import Any, Final

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


def _late(number: int, name: str, crc_extra: int, **fields: str) -> type[Message]:
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


ComponentMetadata: Final = _late(397, "COMPONENT_METADATA", 182, time_boot_ms="I", file_crc="I", uri="100s")
Event: Final = _late(
    410,
    "EVENT",
    160,
    id="I",
    event_time_boot_ms="I",
    sequence="H",
    destination_component="B",
    destination_system="B",
    log_levels="B",
    arguments="40B",
)
CurrentEventSequence: Final = _late(411, "CURRENT_EVENT_SEQUENCE", 106, sequence="H", flags="B")
RequestEvent: Final = _late(
    412, "REQUEST_EVENT", 33, first_sequence="H", last_sequence="H", target_system="B", target_component="B"
)
ResponseEventError: Final = _late(
    413,
    "RESPONSE_EVENT_ERROR",
    77,
    sequence="H",
    sequence_oldest_available="H",
    target_system="B",
    target_component="B",
    reason="B",
)
AvailableModes: Final = _late(
    435,
    "AVAILABLE_MODES",
    134,
    custom_mode="I",
    properties="I",
    number_modes="B",
    mode_index="B",
    standard_mode="B",
    mode_name="35s",
)
CurrentMode: Final = _late(436, "CURRENT_MODE", 193, custom_mode="I", intended_custom_mode="I", standard_mode="B")
AvailableModesMonitor: Final = _late(437, "AVAILABLE_MODES_MONITOR", 30, seq="B")
