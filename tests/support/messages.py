"""A message of every kind, addressed to the vehicle, made from the definitions."""

from typing import Any

from pymavlink.dialects.v20 import ardupilotmega as mavlink

from vehicle_sim.protocol.dialect import Message


def plain_message(number: int, *, system: int = 1, component: int = 1) -> Message:
    """Return a message of small harmless values."""
    kind = mavlink.mavlink_map[number]
    lengths = dict(zip(kind.ordered_fieldnames, kind.array_lengths, strict=True))
    fields: dict[str, Any] = {"target_system": system, "target_component": component, "mavlink_version": 3}
    values: list[Any] = []
    for name, sort in zip(kind.fieldnames, kind.fieldtypes, strict=True):
        if name in fields:
            values.append(fields[name])
        elif sort == "char":
            values.append(b"FS_GCS_ENABLE")
        elif lengths[name]:
            values.append([1] * lengths[name])
        else:
            values.append(1)
    return kind(*values)
