"""The messages of MAVLink FTP: https://mavlink.io/en/services/ftp.html."""

from enum import IntEnum
from struct import Struct
from typing import Final, NamedTuple

LARGEST_BLOCK: Final = 239
"""Bytes of data in one message, at most."""

PAYLOAD_BYTES: Final = 251
_HEADER: Final = Struct("<HBBBBBxI")


class Opcode(IntEnum):
    """What is asked for, or how it was answered."""

    NONE = 0
    TERMINATE_SESSION = 1
    RESET_SESSIONS = 2
    LIST_DIRECTORY = 3
    OPEN_TO_READ = 4
    READ = 5
    CREATE = 6
    WRITE = 7
    REMOVE = 8
    CREATE_DIRECTORY = 9
    REMOVE_DIRECTORY = 10
    OPEN_TO_WRITE = 11
    TRUNCATE = 12
    RENAME = 13
    CHECKSUM = 14
    BURST_READ = 15
    ACK = 128
    NAK = 129


class Nak(IntEnum):
    """Why a request is refused."""

    FAIL = 1
    FAIL_WITH_ERRNO = 2
    INVALID_DATA_SIZE = 3
    INVALID_SESSION = 4
    NO_SESSIONS_AVAILABLE = 5
    END_OF_FILE = 6
    UNKNOWN_COMMAND = 7
    FILE_EXISTS = 8
    FILE_PROTECTED = 9
    FILE_NOT_FOUND = 10


class RefusedError(Exception):
    """A request that gets a NAK.

    Attributes:
        data: What the NAK carries: its code, and the system's error number where there is one.
    """

    def __init__(self, code: Nak, errno: int | None = None) -> None:
        super().__init__(f"{code.name}{'' if errno is None else f', errno {errno}'}")
        self.data = bytes((code,) if errno is None else (code, errno))


class Request(NamedTuple):
    """A request; `data` is as long as its size says, `size` may say more than fits."""

    sequence: int
    session: int
    opcode: int
    size: int
    offset: int
    data: bytes

    @classmethod
    def of(cls, payload: bytes) -> "Request":
        """Read the payload of a message (251 bytes)."""
        sequence, session, opcode, size, _of, _burst, offset = _HEADER.unpack_from(payload)
        return cls(sequence, session, opcode, size, offset, payload[_HEADER.size :][:size])

    @property
    def path(self) -> str:
        """The path in the data.

        Raises:
            RefusedError: There is none.
        """
        return self.paths(1)[0]

    def paths(self, count: int) -> list[str]:
        """Return so many paths in the data.

        Raises:
            RefusedError: There are fewer.
        """
        names = self.data.split(b"\0")[:count]
        if len(names) < count or not all(names):
            raise RefusedError(Nak.INVALID_DATA_SIZE)
        return [name.decode("latin-1") for name in names]

    @property
    def block_bytes(self) -> int:
        """How many bytes a read asks for; none named means as many as fit."""
        return self.size or LARGEST_BLOCK


class Reply(NamedTuple):
    """An answer to a request of the same session and opcode."""

    sequence: int
    session: int
    opcode: Opcode
    asked: int
    offset: int
    data: bytes = b""
    ends_burst: bool = False

    def payload(self) -> bytes:
        """Return the payload of the message (251 bytes)."""
        sequence = self.sequence & 0xFFFF
        header = _HEADER.pack(
            sequence, self.session, self.opcode, len(self.data), self.asked, self.ends_burst, self.offset
        )
        return (header + self.data).ljust(PAYLOAD_BYTES, b"\0")
