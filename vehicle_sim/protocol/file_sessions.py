"""Who reads which file: the sessions of MAVLink FTP.

ArduPilot has five, for all clients together, of the numbers that the clients ask for; one that has been idle for three
seconds gives way to a new one, and after twenty its file is closed. PX4 has one for each link, of number 0, which must
be ended before another file can be opened there (ArduPilot `GCS_FTP.cpp`, PX4 `mavlink_ftp.cpp`).
"""

from dataclasses import dataclass
from typing import TYPE_CHECKING, Final, NamedTuple

from vehicle_sim.parameters import Flavour
from vehicle_sim.protocol.ftp import Nak, RefusedError

if TYPE_CHECKING:
    from vehicle_sim.protocol.link import Link
    from vehicle_sim.protocol.virtual_tree import OpenFile

MOST_SESSIONS: Final = 5
_GIVES_WAY_US: Final = 3_000_000
_CLOSES_US: Final = 20_000_000


class Client(NamedTuple):
    """Who asks: the link, and the source of the messages."""

    link: "Link"
    system_id: int
    component_id: int


@dataclass(slots=True)
class Burst:
    """A part of a file on its way, block by block: `sequence` and `offset` of the next one."""

    sequence: int
    offset: int
    block_bytes: int
    sent: int = 0


@dataclass(slots=True)
class Session:
    """One open file of one client."""

    client: Client
    number: int
    file: "OpenFile"
    used_us: int
    burst: Burst | None = None


class Sessions:
    """All open files of a vehicle."""

    def __init__(self, flavour: Flavour) -> None:
        self._is_ardupilot = flavour is Flavour.ARDUPILOT
        self._open: list[Session] = []

    def __len__(self) -> int:
        return len(self._open)

    def bursts(self) -> list[tuple[Session, Burst]]:
        """Return the bursts that are under way."""
        return [(session, session.burst) for session in self._open if session.burst is not None]

    def begin(self, client: Client, number: int, file: "OpenFile", now_us: int) -> Session:
        """Open a file; the number is the one that the client asks for, where it may choose.

        Raises:
            RefusedError: The session is in use, or there is none left.
        """
        self._close_idle(now_us)
        if self._is_ardupilot:
            self._make_room(client, number, now_us)
        elif any(session.client.link is client.link for session in self._open):
            raise RefusedError(Nak.NO_SESSIONS_AVAILABLE)
        else:
            number = 0
        session = Session(client, number, file, now_us)
        self._open.append(session)
        return session

    def of(self, client: Client, number: int, now_us: int) -> Session:
        """Return an open session.

        Raises:
            RefusedError: There is none of this number.
        """
        self._close_idle(now_us)
        session = self._find(client, number)
        if session is None:
            raise RefusedError(Nak.FILE_NOT_FOUND if self._is_ardupilot else Nak.INVALID_SESSION)
        session.used_us = now_us
        return session

    def end(self, client: Client, number: int) -> "OpenFile | None":
        """Close a session and return its file; on ArduPilot one that is not open is closed already.

        Raises:
            RefusedError: There is none of this number.
        """
        session = self._find(client, number)
        if session is not None:
            self._open.remove(session)
        elif not self._is_ardupilot:
            raise RefusedError(Nak.INVALID_SESSION)
        return None if session is None else session.file

    def reset(self, client: Client) -> None:
        """Close all sessions of a client; on PX4, whose session belongs to the link, whoever opened it there."""
        self._open = [session for session in self._open if not self._is_of(session, client)]

    def forget(self, link: "Link") -> None:
        """Close all sessions of a link that is gone."""
        self._open = [session for session in self._open if session.client.link is not link]

    def _is_of(self, session: Session, client: Client) -> bool:
        return session.client == client if self._is_ardupilot else session.client.link is client.link

    def _find(self, client: Client, number: int) -> Session | None:
        for session in self._open:
            if session.number == number and self._is_of(session, client):
                return session
        return None

    def _make_room(self, client: Client, number: int, now_us: int) -> None:
        """Close an idle session if a new one needs its number or its place."""
        present = self._find(client, number)
        if present is not None:
            if now_us - present.used_us <= _GIVES_WAY_US:
                raise RefusedError(Nak.FAIL)
            self._open.remove(present)
        if len(self._open) >= MOST_SESSIONS:
            oldest = min(self._open, key=lambda session: session.used_us)
            if now_us - oldest.used_us < _GIVES_WAY_US:
                raise RefusedError(Nak.NO_SESSIONS_AVAILABLE)
            self._open.remove(oldest)

    def _close_idle(self, now_us: int) -> None:
        if self._is_ardupilot:
            self._open = [session for session in self._open if now_us - session.used_us <= _CLOSES_US]
