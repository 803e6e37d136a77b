"""All parameters in one file, ArduPilot's `@PARAM/param.pck`.

https://mavlink.io/en/services/parameter_ftp.html and ArduPilot `AP_Filesystem_Param.cpp`: a header of three unsigned
16-bit numbers (magic, parameters in the file, parameters of the vehicle), then for each parameter one byte of type
and flags, one of name lengths, the part of the name that differs from the one before, the value, and on request the
default where the value is another. All is little-endian. Zeros in front of a parameter are padding: no value lies
across two blocks of the size in which the file is read, so that a block read again holds no half of a new value.

A file that is written has the same entries, without padding and defaults, and in its header in the place of the number
of all parameters its own length.
"""

import re
from collections.abc import Iterator
from dataclasses import dataclass
from struct import calcsize, error, pack, unpack_from
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
_LAYOUTS: Final = {number: layout for number, layout, _ in _TYPES.values()}
_HEADER: Final = "<HHH"
_LONGEST_NAME: Final = 16

LARGEST_UPLOAD: Final = _LIMIT
"""Bytes of a file that is written, at most: its length is a number of 16 bits."""


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
    data = bytearray(pack(_HEADER, magic, len(names), len(store)))
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


def uploaded(data: bytes) -> Iterator[tuple[str, float]]:
    """Return names and values of a file that somebody has written, as far as it can be read.

    Raises:
        ValueError: What follows is no such file.
    """
    try:
        magic, count, length = unpack_from(_HEADER, data)
        if magic != _MAGIC or length != len(data):
            raise ValueError("neither magic nor length of packed parameters")
        at, name = calcsize(_HEADER), b""
        for _ in range(count):
            kind, lengths = data[at], data[at + 1]
            layout, common, own = _LAYOUTS.get(kind), lengths & 0xF, (lengths >> 4) + 1
            if layout is None or common > len(name) or common + own > _LONGEST_NAME:
                raise ValueError(f"no parameter at byte {at}")
            name = name[:common] + data[at + 2 : at + 2 + own]
            at += 2 + own
            (value,) = unpack_from(layout, data, at)
            at += calcsize(layout)
            yield name.decode("ascii", "replace"), value
    except (IndexError, error):
        raise ValueError("packed parameters that end too early") from None


def _common_length(last: str, name: str) -> int:
    """Return how many characters two names have in common at their beginnings."""
    length = 0
    for one, other in zip(last, name, strict=False):
        if one != other:
            break
        length += 1
    return length
