"""The files that the vehicle shows: its logs, ArduPilot's packed parameters, what clients have written, none besides.

| autopilot | logs                                                  | besides                                |
|-----------|-------------------------------------------------------|----------------------------------------|
| ArduPilot | `/APM/LOGS/00000001.tlog`, the same in `logs`         | `@PARAM/param.pck`, an empty `@SYS`    |
| PX4       | `/fs/microsd/log/DATE/TIME_NUMBER.tlog`, also in `log` | `/etc/extras`: its component metadata  |

Clients write anywhere as ArduPilot, and below `/fs/microsd` as PX4, but neither logs nor what the autopilot itself has;
what is written as ArduPilot's packed parameters is set when it is closed.
The folders are those of the autopilots; the names end in `.tlog`, for that is what the logs are. Paths are compared
with names in memory, never given to the operating system.
"""

from collections.abc import Iterable
from contextlib import suppress
from errno import EINVAL, ENOENT
from time import gmtime, strftime
from typing import TYPE_CHECKING, Final, Protocol

from vehicle_sim.errors import ParameterError
from vehicle_sim.parameters import Flavour, ParameterStore
from vehicle_sim.protocol.component_metadata import FOLDER, metadata_files
from vehicle_sim.protocol.packed_parameters import (
    LARGEST_UPLOAD,
    Excerpt,
    estimated_size,
    excerpt_of,
    packed,
    uploaded,
)
from vehicle_sim.protocol.written_files import InvalidReadError, Path, WrittenFile, WrittenFiles

if TYPE_CHECKING:
    from vehicle_sim.protocol.flight_log import FlightLog, FlightRecorder
    from vehicle_sim.protocol.host import Host

_Files = dict[Path, "FlightLog"]
_PARAMETERS: Final = ("@PARAM", "param.pck")
_LOG_FOLDERS: Final[dict[Flavour, Path]] = {
    Flavour.ARDUPILOT: ("APM", "LOGS"),
    Flavour.PX4: ("fs", "microsd", "log"),
}
_SHORT: Final = {Flavour.ARDUPILOT: "logs", Flavour.PX4: "log"}
_SECOND_US: Final = 1_000_000


class OpenFile(Protocol):
    """A file that somebody reads; its content does not change under them."""

    @property
    def told_size(self) -> int:
        """The size that is told when it is opened, in bytes."""
        ...

    def read(self, offset: int, count: int) -> bytes:
        """Return up to `count` bytes (1 to 239) from `offset` on; none at the end and after it.

        Raises:
            InvalidReadError: It cannot be read like this.
        """
        ...


class OpenLog:
    """A log as long as it was when it was opened."""

    def __init__(self, log: "FlightLog") -> None:
        self._log = log
        self.told_size = len(log.data)

    def read(self, offset: int, count: int) -> bytes:
        """Return up to `count` bytes from `offset` on."""
        return self._log.read(offset, min(offset + count, self.told_size)) if offset < self.told_size else b""


class OpenBytes:
    """A file that never changes."""

    def __init__(self, data: bytes) -> None:
        self._data = data
        self.told_size = len(data)

    def read(self, offset: int, count: int) -> bytes:
        """Return up to `count` bytes from `offset` on."""
        return self._data[offset : offset + count]


class OpenParameters:
    """The packed parameters as they were at the first read, in blocks of the size of that read."""

    def __init__(self, store: ParameterStore, excerpt: Excerpt) -> None:
        self._store = store
        self._excerpt = excerpt
        self._block_bytes = 0
        self._data = b""
        self.told_size = estimated_size(store)

    def read(self, offset: int, count: int) -> bytes:
        """Return the block at `offset`.

        Raises:
            InvalidReadError: The blocks are of another size, or there is no such parameter.
        """
        if not self._block_bytes:
            try:
                self._data = packed(self._store, self._excerpt, count)
            except ValueError:
                raise InvalidReadError(EINVAL) from None
            self._block_bytes = count
        if count != self._block_bytes:
            raise InvalidReadError(EINVAL)
        return self._data[offset : offset + count]


class ParameterUpload(WrittenFile):
    """Packed parameters that somebody writes."""

    def __init__(self, store: ParameterStore) -> None:
        super().__init__(WrittenFiles(), bytearray())
        self._store = store

    def write(self, offset: int, part: bytes) -> None:
        """Put a part into it."""
        if offset + len(part) > LARGEST_UPLOAD:
            raise OSError(EINVAL, "too many parameters")
        super().write(offset, part)

    def close(self) -> None:
        """Set what was written, up to where it cannot be read; what cannot be set stays as it is."""
        try:
            for name, value in uploaded(bytes(self._data)):
                with suppress(ParameterError):
                    self._store.set(name, value)
        except ValueError:
            raise OSError(EINVAL, "no packed parameters") from None


class VirtualTree:
    """Folders and files by their paths."""

    def __init__(self, host: "Host", recorder: "FlightRecorder") -> None:
        self._host = host
        self._recorder = recorder
        self._flavour = host.table.flavour
        self.written = WrittenFiles()

    def place_to_write(self, path: str) -> Path | None:
        """Return the place that a path names, if clients may write there; None if not.

        Raises:
            FileNotFoundError: It is in a folder that is not there.
        """
        place = self._parts(path)
        inside = ("fs", "microsd") if self._flavour is Flavour.PX4 else ()
        if not place or place[0].startswith("@") or place[: len(inside)] != inside or place in self._logs():
            return None
        if place not in self.written.folders and self.entries(path) is not None:
            return None
        if self.entries("/".join(place[:-1])) is None:
            raise FileNotFoundError(ENOENT, path)
        return place

    def open_to_write(self, path: str, *, empties: bool) -> WrittenFile | None:
        """Return a file to write; None where clients may not write."""
        if self._parts(path.partition("?")[0]) == _PARAMETERS and self._flavour is Flavour.ARDUPILOT:
            return ParameterUpload(self._host.vehicle.parameters)
        place = self.place_to_write(path)
        return None if place is None else self.written.open(place, empties=empties)

    def entries(self, path: str) -> list[bytes] | None:
        """Return what a folder holds, each as `D` and a name or `F`, a name, a tab and a size; None of no folder."""
        folder, files = self._parts(path), self._logs()
        if folder is None:
            return None
        sizes = {place: len(log.data) for place, log in files.items()}
        sizes.update({place: len(data) for place, data in self.written.files.items()})
        folders: set[Path] = {(), _LOG_FOLDERS[self._flavour], *self.written.folders}
        if self._flavour is Flavour.ARDUPILOT:
            sizes[_PARAMETERS] = estimated_size(self._host.vehicle.parameters)
            folders.add(("@SYS",))
        else:
            sizes.update({(*FOLDER, name): len(data) for name, data in metadata_files().items()})
        folders.update(place[:-1] for place in sizes)
        folders.update([place[:depth] for place in folders for depth in range(len(place))])
        if folder not in folders:
            return None
        inside = _children(folder, folders)
        return [f"D{name}".encode() for name in inside] + [
            f"F{name}\t{sizes[*folder, name]}".encode() for name in _children(folder, sizes)
        ]

    def open(self, path: str) -> OpenFile | None:
        """Return a file; None where there is none.

        Raises:
            InvalidReadError: The question after the name asks for what the file cannot hold.
        """
        name, _, query = path.partition("?")
        place = self._parts(name)
        if place == _PARAMETERS and self._flavour is Flavour.ARDUPILOT:
            try:
                return OpenParameters(self._host.vehicle.parameters, excerpt_of(query))
            except ValueError:
                raise InvalidReadError(EINVAL) from None
        place = self._parts(path)
        if self._flavour is Flavour.PX4 and place is not None and place[:-1] == FOLDER:
            data = metadata_files().get(place[-1])
            return None if data is None else OpenBytes(data)
        if place is not None and place in self.written.files:
            return OpenBytes(bytes(self.written.files[place]))
        log = None if place is None else self._logs().get(place)
        return None if log is None else OpenLog(log)

    def _parts(self, path: str) -> Path | None:
        parts = tuple(part for part in path.split("/") if part not in ("", "."))
        if ".." in parts:
            return None
        if parts[:1] == (_SHORT[self._flavour],):
            parts = _LOG_FOLDERS[self._flavour] + parts[1:]
        return parts

    def _logs(self) -> _Files:
        folder = _LOG_FOLDERS[self._flavour]
        if self._flavour is Flavour.ARDUPILOT:
            return {(*folder, f"{log.number:08d}.tlog"): log for log in self._recorder.logs}
        files: _Files = {}
        for log in self._recorder.logs:
            began = gmtime(log.utc_us // _SECOND_US)
            name = f"{strftime('%H_%M_%S', began)}_{log.number:03d}.tlog"
            files[*folder, strftime("%Y-%m-%d", began), name] = log
        return files


def _children(folder: Path, places: Iterable[Path]) -> list[str]:
    """Return the names of what lies directly in a folder."""
    return sorted(place[-1] for place in places if place and place[:-1] == folder)
