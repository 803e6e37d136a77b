"""A client of MAVLink FTP that is written from the protocol's page: https://mavlink.io/en/services/ftp.html."""

from dataclasses import dataclass
from struct import Struct

from pymavlink.dialects.v20 import ardupilotmega as mavlink

from tests.support.station import Station

HEADER = Struct("<HBBBBBBI")
ACK, NAK = 128, 129
TERMINATE, RESET, LIST, OPEN, READ, CREATE, WRITE, REMOVE, MAKE = range(1, 10)
UNMAKE, OPEN_TO_WRITE, TRUNCATE, RENAME, CRC, BURST = range(10, 16)
FAIL, ERRNO, BAD_SIZE, BAD_SESSION, NO_SESSION, EOF, UNKNOWN, EXISTS, PROTECTED, NOT_FOUND = range(1, 11)


@dataclass(frozen=True)
class Answer:
    sequence: int
    session: int
    opcode: int
    asked: int
    ends_burst: bool
    offset: int
    data: bytes

    @property
    def error(self) -> int | None:
        return self.data[0] if self.opcode == NAK else None


class FileClient:
    """Asks through a station; `answers` are all answers that have come, oldest first."""

    def __init__(self, station: Station) -> None:
        self.station = station
        self.sequence = 0

    def message(
        self, opcode: int, data: bytes = b"", *, session: int = 0, offset: int = 0, size: int | None = None
    ) -> mavlink.MAVLink_file_transfer_protocol_message:
        header = HEADER.pack(self.sequence, session, opcode, len(data) if size is None else size, 0, 0, 0, offset)
        self.sequence = (self.sequence + 1) & 0xFFFF
        return mavlink.MAVLink_file_transfer_protocol_message(0, 1, 1, (header + data).ljust(251, b"\0"))

    def payloads(self) -> list[bytes]:
        ours = (self.station.mav.srcSystem, self.station.mav.srcComponent)
        messages = self.station.of("FILE_TRANSFER_PROTOCOL")
        return [bytes(m.payload) for m in messages if (m.target_system, m.target_component) == ours]

    @property
    def answers(self) -> list[Answer]:
        answers = []
        for payload in self.payloads():
            sequence, session, opcode, size, asked, ends, _padding, offset = HEADER.unpack_from(payload)
            assert opcode in (ACK, NAK)
            assert size <= 239
            assert not any(payload[12 + size :])
            assert opcode == ACK or size in (1, 2)
            answers.append(Answer(sequence, session, opcode, asked, bool(ends), offset, payload[12 : 12 + size]))
        return answers

    def ask(
        self, opcode: int, data: bytes = b"", *, session: int = 0, offset: int = 0, size: int | None = None
    ) -> Answer:
        """Return the answer, which comes at once."""
        self.station.forget()
        message = self.message(opcode, data, session=session, offset=offset, size=size)
        self.station.send(message)
        (answer,) = self.answers
        assert (answer.sequence, answer.asked) == (self.sequence, opcode)
        return answer

    def names(self, path: bytes) -> list[str]:
        """Return the entries of a folder, in as many requests as it takes."""
        names: list[str] = []
        while (answer := self.ask(LIST, path, offset=len(names))).opcode == ACK:
            names += answer.data.decode().removesuffix("\0").split("\0")
        assert answer.error == EOF
        return names

    def opened(self, path: bytes) -> tuple[int, int]:
        """Return the session and the size of a file."""
        answer = self.ask(OPEN, path)
        assert answer.opcode == ACK, answer
        return answer.session, int.from_bytes(answer.data, "little")

    def content(self, session: int, block: int = 239) -> bytes:
        """Read a file block by block to its end."""
        data = b""
        while (answer := self.ask(READ, session=session, offset=len(data), size=block)).opcode == ACK:
            assert answer.offset == len(data)
            data += answer.data
        assert answer.error == EOF
        return data
