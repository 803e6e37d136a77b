"""MAVLink 2 frames of the vehicle's own messages, packed without pymavlink's detours: the bytes are the same.

https://mavlink.io/en/guide/serialization.html: header, payload without its trailing zeros, CRC-16/MCRF4XX over both
and the message's extra byte. A vehicle packs hundreds of messages a second of its time, on each of its links.
"""

from collections.abc import Callable, Sequence
from operator import attrgetter
from struct import Struct
from typing import Any, Final

from vehicle_sim.protocol.dialect import MAGIC_V2, Message, mavlink

_HEADER: Final = Struct("<BBBBBBHB")
_MAGIC: Final = bytes((MAGIC_V2,))
_CHECKSUM: Final = Struct("<H")

Packer = tuple[Callable[[Message], tuple[float, ...]], Callable[..., bytes], bytes]
_packers: dict[type[Message], Packer | None] = {}


def _packer(kind: type[Message]) -> Packer | None:
    """Return numbers in wire order, payload and extra byte; None of a message that holds characters."""
    if "char" in kind.fieldtypes or len(kind.ordered_fieldnames) < 2:  # noqa: PLR2004
        return None  # of a single field, attrgetter gives no tuple
    numbers_of: Callable[[Message], tuple[float, ...]] = attrgetter(*kind.ordered_fieldnames)
    if any(kind.array_lengths):
        numbers_of = _flattening(numbers_of, kind.array_lengths)
    return numbers_of, kind.unpacker.pack, bytes((kind.crc_extra,))


def _flattening(
    fields_of: Callable[[Message], tuple[Any, ...]], lengths: Sequence[int]
) -> Callable[[Message], tuple[float, ...]]:
    """Return what gives the numbers of a message with arrays; `lengths` are those of the arrays, 0 of a number."""

    def numbers_of(message: Message) -> tuple[float, ...]:
        numbers: list[float] = []
        for field, length in zip(fields_of(message), lengths, strict=True):
            if length:
                numbers.extend(field)
            else:
                numbers.append(field)
        return tuple(numbers)

    return numbers_of


def frame_of(message: Message, mav: mavlink.MAVLink) -> bytes:
    """Return the MAVLink 2 frame of `message` with ids and sequence number of `mav`, signed where `mav` signs."""
    kind = type(message)
    try:
        packer = _packers[kind]
    except KeyError:
        packer = _packers[kind] = _packer(kind)
    # A message that packs in a way of its own carries more than its class knows.
    if packer is None or mav.signing.sign_outgoing or "_pack" in vars(message):
        return bytes(message.pack(mav))
    numbers_of, pack, extra = packer
    # A payload keeps its first byte, even if all of it is zero.
    payload = pack(*numbers_of(message))
    payload = payload.rstrip(b"\0") or payload[:1]
    number, ids = kind.id, (mav.srcSystem, mav.srcComponent)
    covered = _HEADER.pack(len(payload), 0, 0, mav.seq, *ids, number & 0xFFFF, number >> 16) + payload
    return _MAGIC + covered + _CHECKSUM.pack(mavlink.x25crc(covered + extra).crc)
