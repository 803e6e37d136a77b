"""Decodes packed parameters, from the description of the format: https://mavlink.io/en/services/parameter_ftp.html."""

from struct import calcsize, unpack_from
from typing import NamedTuple

LAYOUTS = {1: "<b", 2: "<h", 3: "<i", 4: "<f"}
MAGIC, MAGIC_WITH_DEFAULTS = 0x671B, 0x671C


class Unpacked(NamedTuple):
    """One parameter; where its value begins in the file, and how many bytes of padding stood before it."""

    name: str
    kind: int
    value: float
    default: float
    value_at: int
    padding: int


def unpacked(data: bytes) -> tuple[int, int, list[Unpacked]]:
    """Return the magic, the number of parameters that the vehicle has, and those of the file."""
    magic, count, total = unpack_from("<HHH", data)
    assert magic in (MAGIC, MAGIC_WITH_DEFAULTS)
    parameters: list[Unpacked] = []
    name, at = "", 6
    while at < len(data):
        padding = 0
        while data[at] == 0:
            at, padding = at + 1, padding + 1
        kind, flags = data[at] & 0x0F, data[at] >> 4
        common, own = data[at + 1] & 0x0F, (data[at + 1] >> 4) + 1
        name = name[:common] + data[at + 2 : at + 2 + own].decode("ascii")
        layout, value_at = LAYOUTS[kind], at + 2 + own
        (value,) = (default,) = unpack_from(layout, data, value_at)
        at = value_at + calcsize(layout)
        assert flags in ((0, 1) if magic == MAGIC_WITH_DEFAULTS else (0,))
        if flags:
            (default,) = unpack_from(layout, data, at)
            at += calcsize(layout)
        parameters.append(Unpacked(name, kind, value, default, value_at, padding))
    assert len(parameters) == count
    return magic, total, parameters
