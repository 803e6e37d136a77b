"""MAVLink 2 frames of messages and back, without pymavlink's detours: bytes and values are the same.

https://mavlink.io/en/guide/serialization.html: header, payload without its trailing zeros, CRC-16/MCRF4XX over both
and the message's extra byte. A vehicle packs hundreds of messages a second of its time, on each of its links, and
unpacks one for each setpoint.
"""

from collections.abc import Callable, Sequence
from functools import lru_cache
from itertools import chain
from operator import attrgetter, itemgetter
from struct import Struct
from typing import Final, NamedTuple

from vehicle_sim.protocol.dialect import MAGIC_V2, Message, mavlink

_HEADER: Final = Struct("<BBBBBBHB")
_MAGIC: Final = bytes((MAGIC_V2,))
_CHECKSUM: Final = Struct("<H")


class _Shape(NamedTuple):
    """How one kind of message lies in its payload; without arrays, it is made of the numbers in another order."""

    kind: Callable[..., Message]
    numbers_of: Callable[[Message], Sequence[float]]
    payload: Struct
    extra: bytes
    ordered: Callable[[Sequence[float]], Sequence[float]] | None


@lru_cache(maxsize=512)
def _shape(number: int) -> _Shape | None:
    """Return that of a message; None of one that holds characters, or that the dialect does not have."""
    kind = mavlink.mavlink_map.get(number)
    if kind is None or "char" in kind.fieldtypes or len(kind.orders) == 1:
        return None  # of a single field, attrgetter gives no tuple
    fields_of, lengths, extra = attrgetter(*kind.ordered_fieldnames), kind.array_lengths, bytes((kind.crc_extra,))
    if not any(lengths):
        return _Shape(kind, fields_of, kind.unpacker, extra, itemgetter(*kind.orders))

    def numbers_of(message: Message) -> Sequence[float]:
        parts = zip(fields_of(message), lengths, strict=True)
        return [*chain.from_iterable(part if length else (part,) for part, length in parts)]

    return _Shape(kind, numbers_of, kind.unpacker, extra, None)


def frame_of(message: Message, mav: mavlink.MAVLink) -> bytes:
    """Return the MAVLink 2 frame of `message` with ids and sequence number of `mav`, signed where `mav` signs."""
    number: int = type(message).id
    shape = _shape(number)
    # A message that packs in a way of its own carries more than its class knows.
    if shape is None or mav.signing.sign_outgoing or "_pack" in vars(message):
        return bytes(message.pack(mav))
    # A payload keeps its first byte, even if all of it is zero.
    payload = shape.payload.pack(*shape.numbers_of(message))
    payload = payload.rstrip(b"\0") or payload[:1]
    ids = mav.srcSystem, mav.srcComponent
    covered = _HEADER.pack(len(payload), 0, 0, mav.seq, *ids, number & 0xFFFF, number >> 16) + payload
    return _MAGIC + covered + _CHECKSUM.pack(mavlink.x25crc(covered + shape.extra).crc)


def message_of(frame: bytearray, mav: mavlink.MAVLink) -> Message:
    """Return the message of a frame that is as long as it says, as `mav` decodes it.

    Raises:
        MAVError: It is none.
    """
    plain = frame[0] == MAGIC_V2 and not frame[2]
    shape = _shape(frame[7] | frame[8] << 8 | frame[9] << 16) if plain else None
    if shape is None or shape.ordered is None:
        return mav.decode(frame)
    if mavlink.x25crc(frame[1:-2] + shape.extra).crc != frame[-2] | frame[-1] << 8:
        raise mavlink.MAVError("the checksum is wrong")
    whole, size = shape.payload, shape.payload.size
    message = shape.kind(*shape.ordered(whole.unpack(frame[10:-2][:size].ljust(size, b"\0"))))
    header = message.get_header()
    _, header.mlen, _, header.compat_flags, header.seq, header.srcSystem, header.srcComponent = frame[:7]
    message.get_msgbuf().extend(frame)
    return message
