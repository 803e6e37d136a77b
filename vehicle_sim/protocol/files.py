"""MAVLink FTP: folders are listed, files are read, and written in memory.

https://mavlink.io/en/services/ftp.html; ArduPilot `GCS_FTP.cpp`, PX4 `mavlink_ftp.cpp`. A request that comes again is
answered with the same bytes again; a burst that is asked for again starts over.
"""

from collections import OrderedDict
from errno import EBADF, EEXIST, ENOENT
from struct import pack
from typing import TYPE_CHECKING, Final, NamedTuple

from vehicle_sim.parameters import Flavour
from vehicle_sim.protocol.checksum import plain_crc32
from vehicle_sim.protocol.dialect import Message, mavlink
from vehicle_sim.protocol.file_sessions import Burst, Client, Session, Sessions
from vehicle_sim.protocol.flight_log import FlightRecorder
from vehicle_sim.protocol.ftp import LARGEST_BLOCK, Nak, Opcode, RefusedError, Reply, Request
from vehicle_sim.protocol.host import Host, Sender
from vehicle_sim.protocol.link import Link
from vehicle_sim.protocol.virtual_tree import OpenFile, VirtualTree
from vehicle_sim.protocol.written_files import InvalidReadError, Path, WrittenFile

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

BLOCKS_PER_STEP: Final = 4
"""Messages of a burst that are sent in one step of the vehicle in each session: 105 kB/s at steps of 10 ms."""

_BURST_BLOCKS: Final = 2000
_PX4_BURST_BYTES: Final = 35_000
_REPEATED_WITHIN_US: Final = 5_000_000
_MOST_CLIENTS: Final = 16
_ERRORS: Final = {ENOENT: Nak.FILE_NOT_FOUND, EEXIST: Nak.FILE_EXISTS}


class _Answered(NamedTuple):
    """The last request of a client, its answer, and when that was."""

    request: bytes
    reply: bytes
    at_us: int


class FileService:
    """Answers FILE_TRANSFER_PROTOCOL.

    Attributes:
        is_sending: Whether `advance` has anything to send.
    """

    def __init__(self, host: Host, recorder: FlightRecorder) -> None:
        self._host = host
        self._tree = VirtualTree(host, recorder)
        self._is_ardupilot = host.table.flavour is Flavour.ARDUPILOT
        self._answered: OrderedDict[Client, _Answered] = OrderedDict()
        self.sessions = Sessions(host.table.flavour)
        self.is_sending = False
        self.messages: Mapping[int, Callable[[Sender, Message], None]] = {
            mavlink.MAVLINK_MSG_ID_FILE_TRANSFER_PROTOCOL: self.on_file_transfer,
        }
        written = self._tree.written
        self._changes: dict[int, Callable[..., None]] = {
            Opcode.REMOVE: written.remove,
            Opcode.REMOVE_DIRECTORY: written.remove,
            Opcode.CREATE_DIRECTORY: written.make_folder,
            Opcode.RENAME: written.rename,
            **({} if self._is_ardupilot else {Opcode.TRUNCATE: written.truncate}),
        }
        self._answers: Mapping[int, Callable[[Client, Request], Reply | None]] = {
            Opcode.NONE: lambda _client, request: _ack(request),
            Opcode.TERMINATE_SESSION: self._terminate,
            Opcode.RESET_SESSIONS: self._reset,
            Opcode.LIST_DIRECTORY: self._list,
            Opcode.OPEN_TO_READ: self._open,
            Opcode.READ: self._read,
            Opcode.BURST_READ: self._start_burst,
            Opcode.CHECKSUM: self._checksum,
            Opcode.CREATE: self._open_to_write,
            Opcode.OPEN_TO_WRITE: self._open_to_write,
            Opcode.WRITE: self._write,
            **dict.fromkeys(self._changes, self._change),
        }

    def forget(self, link: Link) -> None:
        """Close what is open on a link that is gone."""
        self.sessions.forget(link)
        for client in [client for client in self._answered if client.link is link]:
            del self._answered[client]

    def on_file_transfer(self, sender: Sender, message: Message) -> None:
        """Answer one request; what is an answer itself gets none."""
        client, payload = Client(*sender), bytes(message.payload)
        request, now_us = Request.of(payload), self._host.now_us
        if request.opcode in (Opcode.ACK, Opcode.NAK):
            return
        last = self._answered.get(client)
        if last is not None and last.request == payload and now_us - last.at_us <= _REPEATED_WITHIN_US:
            _send(client, last.reply)
            return
        try:
            reply = self._answer(client, request)
        except RefusedError as refused:
            reply = _nak(request, refused)
        except OSError as error:
            reply = _nak(request, _refusal(error.errno or 0))
        if reply is None:
            self._answered.pop(client, None)
            return
        self._answered[client] = _Answered(payload, reply.payload(), now_us)
        self._answered.move_to_end(client)
        if len(self._answered) > _MOST_CLIENTS:
            self._answered.popitem(last=False)
        _send(client, reply.payload())

    def _answer(self, client: Client, request: Request) -> Reply | None:
        """Return the answer to a request; None of a burst, which begins in the coming step.

        Raises:
            RefusedError: The request gets a NAK.
        """
        if request.size > LARGEST_BLOCK:
            raise RefusedError(Nak.INVALID_DATA_SIZE)
        answer = self._answers.get(request.opcode)
        if answer is None:
            raise RefusedError(Nak.UNKNOWN_COMMAND)
        return answer(client, request)

    def advance(self) -> None:
        """Send the next few blocks of each burst."""
        bursts = self.sessions.bursts()
        self.is_sending = bool(bursts)
        for session, burst in bursts:
            session.used_us = self._host.now_us
            for _ in range(BLOCKS_PER_STEP):
                reply = self._block(session, burst)
                _send(session.client, reply.payload())
                if reply.ends_burst:
                    session.burst = None
                    break

    def _block(self, session: Session, burst: Burst) -> Reply:
        """Return the next message of a burst; the last one says that it is."""
        reply = Reply(burst.sequence, session.number, Opcode.ACK, Opcode.BURST_READ, burst.offset)
        try:
            data = _block(session.file, burst.offset, burst.block_bytes)
        except RefusedError as refused:
            return reply._replace(opcode=Opcode.NAK, data=refused.data, ends_burst=True)
        burst.sequence += 1
        burst.offset += len(data)
        burst.sent += 1
        is_long = (
            burst.sent >= _BURST_BLOCKS if self._is_ardupilot else burst.sent * burst.block_bytes > _PX4_BURST_BYTES
        )
        return reply._replace(data=data, ends_burst=is_long)

    def _terminate(self, client: Client, request: Request) -> Reply:
        file = self.sessions.end(client, request.session)
        if isinstance(file, WrittenFile):
            file.close()
        return _ack(request)

    def _reset(self, client: Client, request: Request) -> Reply:
        self.sessions.reset(client)
        return _ack(request)

    def _list(self, _client: Client, request: Request) -> Reply:
        """Return as many entries from number `offset` on as fit into one message."""
        entries = self._tree.entries(request.path)
        if entries is None:
            raise RefusedError(Nak.FILE_NOT_FOUND if self._is_ardupilot else Nak.END_OF_FILE)
        data = b""
        for entry in entries[request.offset :]:
            if len(data) + len(entry) + 1 > LARGEST_BLOCK:
                break
            data += entry + b"\0"
        if not data:
            raise RefusedError(Nak.END_OF_FILE)
        return _ack(request, data)

    def _open(self, client: Client, request: Request) -> Reply:
        file = self._file(request)
        session = self.sessions.begin(client, request.session, file, self._host.now_us)
        return _ack(request, pack("<I", file.told_size))._replace(session=session.number)

    def _file(self, request: Request) -> OpenFile:
        try:
            file = self._tree.open(request.path)
        except InvalidReadError as error:
            raise RefusedError(Nak.FAIL_WITH_ERRNO, error.errno) from None
        if file is None:
            raise RefusedError(Nak.FILE_NOT_FOUND)
        return file

    def _read(self, client: Client, request: Request) -> Reply:
        session = self.sessions.of(client, request.session, self._host.now_us)
        return _ack(request, _block(session.file, request.offset, request.block_bytes))

    def _start_burst(self, client: Client, request: Request) -> None:
        session = self.sessions.of(client, request.session, self._host.now_us)
        session.burst = Burst(request.sequence + 1, request.offset, request.block_bytes)
        session.client = client
        self.is_sending = True

    def _checksum(self, _client: Client, request: Request) -> Reply:
        file, checksum, offset = self._file(request), 0, 0
        while data := _content(file, offset, LARGEST_BLOCK):
            checksum = plain_crc32(data, checksum)
            offset += len(data)
        return _ack(request, pack("<I", checksum))

    def _place(self, path: str) -> Path:
        place = self._tree.place_to_write(path)
        if place is None:
            raise RefusedError(Nak.FILE_PROTECTED)
        return place

    def _open_to_write(self, client: Client, request: Request) -> Reply:
        file = self._tree.open_to_write(request.path, empties=request.opcode == Opcode.CREATE)
        if file is None:
            raise RefusedError(Nak.FILE_PROTECTED)
        session = self.sessions.begin(client, request.session, file, self._host.now_us)
        told = b"" if self._is_ardupilot else pack("<I", file.told_size)
        return _ack(request, told)._replace(session=session.number)

    def _write(self, client: Client, request: Request) -> Reply:
        file = self.sessions.of(client, request.session, self._host.now_us).file
        if not isinstance(file, WrittenFile):
            raise RefusedError(Nak.FAIL) if self._is_ardupilot else RefusedError(Nak.FAIL_WITH_ERRNO, EBADF)
        file.write(request.offset, request.data)
        return _ack(request, b"" if self._is_ardupilot else pack("<I", len(request.data)))

    def _change(self, _client: Client, request: Request) -> Reply:
        """Remove, rename or cut what is there, or make a folder."""
        places = [self._place(path) for path in request.paths(2 if request.opcode == Opcode.RENAME else 1)]
        sizes = (request.offset,) if request.opcode == Opcode.TRUNCATE else ()
        self._changes[request.opcode](*places, *sizes)
        return _ack(request)


def _ack(request: Request, data: bytes = b"") -> Reply:
    return Reply(request.sequence + 1, request.session, Opcode.ACK, request.opcode, request.offset, data)


def _nak(request: Request, refused: RefusedError) -> Reply:
    return Reply(request.sequence + 1, request.session, Opcode.NAK, request.opcode, request.offset, refused.data)


def _refusal(errno: int) -> RefusedError:
    known = _ERRORS.get(errno)
    return RefusedError(Nak.FAIL_WITH_ERRNO, errno) if known is None else RefusedError(known)


def _send(client: Client, payload: bytes) -> None:
    client.link.send(mavlink.MAVLink_file_transfer_protocol_message(0, client.system_id, client.component_id, payload))


def _content(file: OpenFile, offset: int, count: int) -> bytes:
    try:
        return file.read(offset, count)
    except InvalidReadError as error:
        raise RefusedError(Nak.FAIL_WITH_ERRNO, error.errno) from None


def _block(file: OpenFile, offset: int, count: int) -> bytes:
    data = _content(file, offset, count)
    if not data:
        raise RefusedError(Nak.END_OF_FILE)
    return data
