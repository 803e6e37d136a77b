"""Messages of whole frames, and frames of messages, without pymavlink's detours: the values and bytes are the same.

https://mavlink.io/en/guide/serialization.html. What ``framing`` has cut is whole and its checksum right, so neither is
looked at again. A flight packs and unpacks more than a hundred messages a second of the vehicle's time.
"""

from collections.abc import Callable
from functools import cache
from itertools import accumulate
from operator import attrgetter, itemgetter
from struct import Struct
from typing import Any, Final, NamedTuple

from pymavlink.dialects.v20 import ardupilotmega as mavlink

from mission.link.framing import Frame

Message = Any
"""A message of pymavlink, which ships no types."""

_V2: Final = mavlink.PROTOCOL_MARKER_V2
_MAGIC: Final = bytes((_V2,))
_HEADER: Final = Struct("<BBBBBBHB")
_CHECKSUM: Final = Struct("<H")


class _Unpacking(NamedTuple):
    """How the payload of one kind of message becomes the arguments of its constructor."""

    kind: Callable[..., Message]
    payload: Struct
    arguments: Callable[[tuple[Any, ...]], tuple[Any, ...]]


@cache
def _unpacking(number: int) -> _Unpacking:
    kind = mavlink.mavlink_map[number]
    if "char" not in kind.fieldtypes and max(kind.lengths) == 1 < len(kind.orders):
        return _Unpacking(kind, kind.unpacker, itemgetter(*kind.orders))
    starts = list(accumulate(kind.lengths, initial=0))
    places = [(starts[order], starts[order + 1]) for order in kind.orders]
    return _Unpacking(kind, kind.unpacker, lambda fields: tuple(_value(fields[a:b]) for a, b in places))


def _value(parts: tuple[Any, ...]) -> Any:  # noqa: ANN401 - a number, characters, or an array
    """Characters end before what fills them up; more than one number is an array."""
    if len(parts) > 1:
        return list(parts)
    return parts[0].rstrip(b"\0") if isinstance(parts[0], bytes) else parts[0]


def message_of(frame: Frame) -> Message:
    """The message in a frame of the dialect; what was cut off the end of its payload is zero."""
    kind, payload, arguments = _unpacking(frame.number)
    told = frame.payload[: payload.size].ljust(payload.size, b"\0")
    return kind(*arguments(payload.unpack(told)))


class _Packing(NamedTuple):
    """How one kind of message becomes its payload, and the extra byte of its checksum."""

    fields: Callable[[Message], tuple[Any, ...]]
    payload: Struct
    extra: bytes


@cache
def _packing(number: int) -> _Packing | None:
    """None of a kind that holds characters or arrays, or a single field, of which attrgetter gives no tuple."""
    kind = mavlink.mavlink_map[number]
    if "char" in kind.fieldtypes or max(kind.lengths) > 1 or len(kind.ordered_fieldnames) == 1:
        return None
    return _Packing(attrgetter(*kind.ordered_fieldnames), kind.unpacker, bytes((kind.crc_extra,)))


def frame_of(message: Message, mav: mavlink.MAVLink) -> bytes:
    """The MAVLink 2 frame of a message, with ids and number of ``mav``, signed where ``mav`` signs."""
    number = int(type(message).id)  # some have a field of that name
    packing = _packing(number)
    if packing is None or mav.signing.sign_outgoing:
        return bytes(message.pack(mav))
    whole = packing.payload.pack(*packing.fields(message))
    payload = whole.rstrip(b"\0") or whole[:1]  # the first byte stays, even if all of them are zero
    ids = mav.srcSystem, mav.srcComponent
    covered = _HEADER.pack(len(payload), 0, 0, mav.seq, *ids, number & 0xFFFF, number >> 16) + payload
    return _MAGIC + covered + _CHECKSUM.pack(mavlink.x25crc(covered + packing.extra).crc)
