"""Seeded MAVLink traffic of the worst kind, and a judge of frames that shares no code with the vehicle's parser."""

import random
import struct
from dataclasses import dataclass
from itertools import accumulate
from typing import Final

from pymavlink.dialects.v20 import ardupilotmega as mavlink

from tests.support.messages import plain_message

_SIZES: Final = {"char": 1, "int8_t": 1, "uint8_t": 1, "int16_t": 2, "uint16_t": 2, "int32_t": 4, "uint32_t": 4}
_SIZES.update({"float": 4, "int64_t": 8, "uint64_t": 8, "double": 8, "uint8_t_mavlink_version": 1})
_WILD: Final = (
    b"\x00",
    b"\xff",
    b"\x7f",
    b"\x80",
    struct.pack("<f", float("nan")),
    struct.pack("<f", float("inf")),
    struct.pack("<f", -float("inf")),
    struct.pack("<f", 3e38),
    struct.pack("<f", 1e-40),
    struct.pack("<i", 900_000_000),
)


def _crc_table() -> list[int]:
    table = []
    for byte in range(256):
        crc = byte
        for _ in range(8):
            crc = crc >> 1 ^ 0x8408 if crc & 1 else crc >> 1
        table.append(crc)
    return table


_TABLE: Final = _crc_table()


def checksum(data: bytes) -> int:
    """Return CRC-16/MCRF4XX, from its polynomial."""
    crc = 0xFFFF
    for byte in data:
        crc = crc >> 8 ^ _TABLE[(crc ^ byte) & 0xFF]
    return crc


@dataclass(frozen=True)
class Kind:
    """What a message's frames look like: where its target is, how long it is, what its checksum starts from."""

    number: int
    extra: int
    payload: bytes
    target_at: int | None


def _kind(number: int) -> Kind:
    message = mavlink.mavlink_map[number]
    lengths = dict(zip(message.ordered_fieldnames, message.array_lengths, strict=True))
    types = dict(zip(message.fieldnames, message.fieldtypes, strict=True))
    sizes = [_SIZES[types[name]] * max(lengths[name], 1) for name in message.ordered_fieldnames]
    starts = dict(zip(message.ordered_fieldnames, accumulate([0, *sizes]), strict=False))
    frame = plain_message(number).pack(mavlink.MAVLink(None))
    payload = frame[10:-2].ljust(sum(sizes), b"\x00")
    return Kind(number, message.crc_extra, payload, starts.get("target_system"))


KINDS: Final = {number: _kind(number) for number in mavlink.mavlink_map if number >= 0}


def sealed(kind: Kind, payload: bytes, header: tuple[int, int, int], *, old: bool = False) -> bytes:
    """Return the frame of a payload with the right checksum; `header` is sequence, system and component."""
    if old:
        covered = bytes((len(payload), *header, kind.number)) + payload
        magic = b"\xfe"
    else:
        covered = bytes((len(payload), 0, 0, *header)) + kind.number.to_bytes(3, "little") + payload
        magic = b"\xfd"
    return magic + covered + struct.pack("<H", checksum(covered + bytes((kind.extra,))))


def holds_a_message(data: bytes) -> bool:
    """Whether a valid frame of a known message begins anywhere in the data."""
    for at in range(len(data) - 7):
        old = data[at] == 0xFE
        if not old and data[at] != 0xFD:
            continue
        header = 6 if old else 10
        head = data[at : at + header]
        if len(head) < header:
            continue
        stop = at + header + head[1]
        if stop + 2 > len(data) or (not old and head[2] & 0xFE):
            continue
        kind = KINDS.get(head[5] if old else int.from_bytes(head[7:10], "little"))
        if kind is not None and checksum(data[at + 1 : stop] + bytes((kind.extra,))) == int.from_bytes(
            data[stop : stop + 2], "little"
        ):
            return True
    return False


class Traffic:
    """Pieces of traffic, the same from the same seed."""

    def __init__(self, seed: int, handled: list[int]) -> None:
        self._random = random.Random(seed)  # noqa: S311 - noise, not a secret
        self._handled, self._all = handled, sorted(KINDS)

    def _payload(self, kind: Kind, target: int | None) -> bytes:
        draw = self._random
        payload = bytearray(kind.payload)
        for _ in range(draw.choice((0, 1, 2, 4, 30))):
            wild = draw.choice((*_WILD, draw.randbytes(4)))
            at = draw.randrange(len(payload))
            payload[at : at + len(wild)] = wild[: len(payload) - at]
        if kind.target_at is not None and target is not None:
            payload[kind.target_at] = target
        return bytes(payload)

    def message(self, target: int | None) -> bytes:
        """Return a valid frame of any message, with wild values, to a system; None leaves the target to chance."""
        draw = self._random
        numbers = self._handled if draw.random() < 0.7 else self._all
        kind = KINDS[draw.choice(numbers)]
        while target is not None and kind.target_at is None:
            kind = KINDS[draw.choice(numbers)]
        payload = self._payload(kind, target)
        old = kind.number < 256 and draw.random() < 0.1
        header = (draw.randrange(256), draw.choice((255, 255, 245, 1, draw.randrange(256))), draw.choice((190, 191, 1)))
        if not old and draw.random() < 0.3 and (kind.target_at is None or target is None):
            payload = payload[: draw.randrange(1, len(payload) + 1)]  # cut at will, and sealed again
        return sealed(kind, payload, header, old=old)

    def broken(self) -> bytes:
        """Return what is no valid frame, or only by chance: noise, or a frame that was damaged on its way."""
        draw = self._random
        choice = draw.random()
        if choice < 0.3:
            return draw.randbytes(draw.randrange(1, 600))
        if choice < 0.4:
            return bytes(draw.choices((0xFD, 0xFE, 0, 1, 255), k=draw.randrange(1, 400)))
        frame = bytearray(self.message(1))
        if choice < 0.8:
            for _ in range(draw.randrange(1, 6)):
                frame[draw.randrange(len(frame))] ^= draw.randrange(1, 256)
        elif choice < 0.9:
            del frame[draw.randrange(len(frame)) :]
        else:
            at = draw.randrange(len(frame))
            frame[at:at] = draw.randbytes(draw.randrange(1, 20))
        return bytes(frame)
