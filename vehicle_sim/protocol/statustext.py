"""STATUSTEXT, in chunks where a text is longer than one message holds.

https://mavlink.io/en/messages/common.html#STATUSTEXT: chunks share an id that is not zero; a chunk without a
terminating NUL is followed by another, so a text that fills its last chunk ends with an empty one.
"""

from typing import Final

from vehicle_sim.protocol.dialect import Message, mavlink

CHUNK: Final = 50
"""Bytes of text in one message."""

_LAST_ID: Final = 65535
_MOST_CHUNKS: Final = 255


class TextChunker:
    """Makes STATUSTEXT messages and numbers those that belong together."""

    def __init__(self) -> None:
        self._last_id = 0

    def messages(self, severity: int, text: str) -> list[Message]:
        """Return the messages that carry `text`; what is not ASCII is replaced by question marks."""
        data = text.encode("ascii", "replace")
        if len(data) <= CHUNK:
            return [mavlink.MAVLink_statustext_message(severity, data, 0, 0)]
        self._last_id = self._last_id % _LAST_ID + 1
        chunks = [data[start : start + CHUNK] for start in range(0, len(data) + 1, CHUNK)][:_MOST_CHUNKS]
        return [
            mavlink.MAVLink_statustext_message(severity, chunk, self._last_id, number)
            for number, chunk in enumerate(chunks)
        ]
