"""All parameters in one file, ArduPilot's `@PARAM/param.pck`.

https://mavlink.io/en/services/parameter_ftp.html and ArduPilot `AP_Filesystem_Param.cpp`: a header of three unsigned
16-bit numbers (magic, parameters in the file, parameters of the vehicle), then for each parameter one byte of type
and flags, one of name lengths, the part of the name that differs from the one before, the value, and on request the
default where the value is another. All is little-endian. Zeros in front of a parameter are padding: no value lies
across two blocks of the size in which the file is read, so that a block read again holds no half of a new value.
"""

import re
from dataclasses import dataclass
from struct import pack
from typing import Final

from vehicle_sim.parameters import ParameterKind, ParameterStore

_MAGIC: Final = 0x671B
_MAGIC_WITH_DEFAULTS: Final = 0x671C
_HAS_DEFAULT: Final = 1 << 4
_TYPES: Final = {
    ParameterKind.INT8: (1, "<b", 1),
    ParameterKind.INT16: (2, "<h", 2),
    ParameterKind.INT32: (3, "<i", 4),
    ParameterKind.REAL32: (4, "<f", 4),
}
_OPTION: Final = re.compile(r"(start|count|withdefaults)=([0-9]*)")
_ESTIMATED_BYTES: Final = 12
_LIMIT: Final = 0xFFFF


@dataclass(frozen=True, slots=True)
class Excerpt:
    """Which parameters are asked for: `count` from index `start` on (0 means all of them), with defaults or not."""

    start: int = 0
    count: int = 0
    with_defaults: bool = False


def excerpt_of(query: str) -> Excerpt:
    """Read what follows the file's name after a question mark: `start=N&count=N&withdefaults=1`.

    Raises:
        ValueError: A number that the file cannot serve.
    """
    values = {"start": 0, "count": 0, "withdefaults": 0}
    for part in query.split("&"):
        option = _OPTION.match(part)
        if option is not None:
            values[option[1]] = int(option[2] or "0")
    if max(values["start"], values["count"]) >= _LIMIT or values["withdefaults"] > 1:
        raise ValueError(f"{query!r} asks for parameters that no vehicle has")
    return Excerpt(values["start"], values["count"], bool(values["withdefaults"]))


def estimated_size(store: ParameterStore) -> int:
    """Return the size that is told before the file is read: its true one depends on how it is read."""
    return len(store) * _ESTIMATED_BYTES


def packed(store: ParameterStore, excerpt: Excerpt, block_bytes: int) -> bytes:
    """Return the file for a reader of blocks of `block_bytes`.

    Raises:
        ValueError: The excerpt begins after the last parameter.
    """
    if excerpt.start >= len(store):
        raise ValueError(f"there are {len(store)} parameters, none from index {excerpt.start} on")
    stop = excerpt.start + excerpt.count if excerpt.count else len(store)
    names = store.names[excerpt.start : stop]
    magic = _MAGIC_WITH_DEFAULTS if excerpt.with_defaults else _MAGIC
    data = bytearray(pack("<HHH", magic, len(names), len(store)))
    last = ""
    for name in names:
        definition = store.definition(name)
        number, layout, value_bytes = _TYPES[definition.kind]
        value, default = store.stored(name), definition.stored(definition.default)
        common = _common_length(last, name)
        own = name[common:].encode("ascii")
        values = pack(layout, value)
        flags = 0
        if excerpt.with_defaults and value != default:
            flags, values = _HAS_DEFAULT, values + pack(layout, default)
        entry = bytes((number | flags, common | (len(own) - 1) << 4)) + own + values
        over = (len(data) + len(entry)) % block_bytes
        if value_bytes > 1 and 0 < over < value_bytes:
            data += bytes(value_bytes - over)
        data += entry
        last = name
    return bytes(data)


def _common_length(last: str, name: str) -> int:
    """Return how many characters two names have in common at their beginnings."""
    length = 0
    for one, other in zip(last, name, strict=False):
        if one != other:
            break
        length += 1
    return length
