"""Logs and files: there are none, and whoever asks is told so at once instead of waiting for it.

https://mavlink.io/en/services/ftp.html; https://mavlink.io/en/messages/common.html#LOG_REQUEST_LIST.
"""

from struct import pack, unpack_from
from typing import TYPE_CHECKING, Final

from vehicle_sim.protocol.dialect import Message, mavlink
from vehicle_sim.protocol.host import Host, Sender

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

_HEADER: Final = "<HBBBBBxI"
_PAYLOAD_BYTES: Final = 251
_ACK: Final = 128
_NAK: Final = 129
_END_OF_FILE: Final = 6
_UNKNOWN_COMMAND: Final = 7
_FILE_NOT_FOUND: Final = 10

_TERMINATE_SESSION: Final = 1
_RESET_SESSIONS: Final = 2
_LIST_DIRECTORY: Final = 3
_OPEN_TO_READ: Final = 4
_CHECKSUM: Final = 14
_OPEN_TO_READ_BURST: Final = 15
_READERS: Final = frozenset((_OPEN_TO_READ, _CHECKSUM, _OPEN_TO_READ_BURST))


class FileService:
    """Answers FILE_TRANSFER_PROTOCOL and the log requests of a vehicle without files."""

    def __init__(self, host: Host) -> None:
        self._host = host
        self.messages: Mapping[int, Callable[[Sender, Message], None]] = {
            mavlink.MAVLINK_MSG_ID_FILE_TRANSFER_PROTOCOL: self.on_file_transfer,
            mavlink.MAVLINK_MSG_ID_LOG_REQUEST_LIST: self.on_log_list,
            mavlink.MAVLINK_MSG_ID_LOG_REQUEST_DATA: self.on_log_data,
        }

    def on_file_transfer(self, sender: Sender, message: Message) -> None:
        """Answer one request: sessions end, directories are empty, no file exists."""
        sequence, session, opcode, _size, _request, _burst, offset = unpack_from(_HEADER, bytes(message.payload))
        if opcode in (_ACK, _NAK):
            return
        if opcode in (_TERMINATE_SESSION, _RESET_SESSIONS):
            answer, data = _ACK, b""
        else:
            error = _UNKNOWN_COMMAND
            error = _END_OF_FILE if opcode == _LIST_DIRECTORY else error
            error = _FILE_NOT_FOUND if opcode in _READERS else error
            answer, data = _NAK, bytes((error,))
        header = pack(_HEADER, (sequence + 1) & 0xFFFF, session, answer, len(data), opcode, 0, offset)
        payload = (header + data).ljust(_PAYLOAD_BYTES, b"\0")
        sender.link.send(
            mavlink.MAVLink_file_transfer_protocol_message(0, sender.system_id, sender.component_id, payload)
        )

    def on_log_list(self, sender: Sender, _message: Message) -> None:
        """Answer that there is no log."""
        sender.link.send(mavlink.MAVLink_log_entry_message(0, 0, 0, 0, 0))

    def on_log_data(self, sender: Sender, message: Message) -> None:
        """Answer that this log ends where it begins."""
        sender.link.send(mavlink.MAVLink_log_data_message(message.id, message.ofs, 0, (0,) * 90))
