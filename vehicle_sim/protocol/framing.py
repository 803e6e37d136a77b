"""MAVLink 2 frames of the vehicle's own messages, packed without pymavlink's detours: the bytes are the same.

https://mavlink.io/en/guide/serialization.html: header, payload without its trailing zeros, CRC-16/MCRF4XX over both
and the message's extra byte. A vehicle packs hundreds of messages a second of its time, on each of its links.
"""

from collections.abc import Callable
from operator import attrgetter
from struct import Struct
from typing import Final

from vehicle_sim.protocol.dialect import MAGIC_V2, Message, mavlink

_HEADER: Final = Struct("<BBBBBBHB")
_MAGIC: Final = bytes((MAGIC_V2,))
_CHECKSUM: Final = Struct("<H")

Packer = tuple[Callable[[Message], tuple[float, ...]], Callable[..., bytes], bytes]
_packers: dict[type[Message], Packer | None] = {}


def _packer(kind: type[Message]) -> Packer | None:
    """Return fields in wire order, payload and extra byte; None of a message that holds arrays or characters."""
    if any(kind.array_lengths) or "char" in kind.fieldtypes or len(kind.ordered_fieldnames) < 2:  # noqa: PLR2004
        return None  # of a single field, attrgetter gives no tuple
    return attrgetter(*kind.ordered_fieldnames), kind.unpacker.pack, bytes((kind.crc_extra,))


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
    fields_of, pack, extra = packer
    # A payload keeps its first byte, even if all of it is zero.
    payload = pack(*fields_of(message))
    payload = payload.rstrip(b"\0") or payload[:1]
    number, ids = kind.id, (mav.srcSystem, mav.srcComponent)
    covered = _HEADER.pack(len(payload), 0, 0, mav.seq, *ids, number & 0xFFFF, number >> 16) + payload
    return _MAGIC + covered + _CHECKSUM.pack(mavlink.x25crc(covered + extra).crc)
