"""What clients write by MAVLink FTP: files and folders in memory, never on a disk, and gone with the program."""

from errno import EBADF, EEXIST, ENOENT, ENOSPC, ENOTEMPTY
from os import strerror
from typing import Final

Path = tuple[str, ...]

MOST_BYTES: Final = 4 << 20
"""What all files hold together, at most."""

MOST_ENTRIES: Final = 256
"""Files and folders, at most."""


class InvalidReadError(Exception):
    """A file cannot be read like this.

    Attributes:
        errno: The system's number for it, as the autopilot tells it.
    """

    def __init__(self, errno: int) -> None:
        super().__init__(f"errno {errno}")
        self.errno = errno


class WrittenFiles:
    """Files and folders by their paths; what cannot be done raises OSError, with the number for it."""

    def __init__(self) -> None:
        self.files: dict[Path, bytearray] = {}
        self.folders: set[Path] = set()

    def open(self, place: Path, *, empties: bool) -> "WrittenFile":
        """Open a file to write, a new one where there is none."""
        if place in self.folders:
            raise _error(EEXIST)
        if place not in self.files:
            self._count()
        data = self.files.setdefault(place, bytearray())
        if empties:
            data.clear()
        return WrittenFile(self, data)

    def write(self, data: bytearray, offset: int, part: bytes) -> None:
        """Put a part into a file; what lies between its end and the part is zeros."""
        grown = max(offset + len(part) - len(data), 0)
        if grown + sum(map(len, self.files.values())) > MOST_BYTES:
            raise _error(ENOSPC)
        data.extend(bytes(grown))
        data[offset : offset + len(part)] = part

    def make_folder(self, place: Path) -> None:
        """Make a folder."""
        if place in self.folders or place in self.files:
            raise _error(EEXIST)
        self._count()
        self.folders.add(place)

    def remove(self, place: Path) -> None:
        """Remove a file, or a folder that is empty."""
        if any(other[:-1] == place for other in (*self.files, *self.folders)):
            raise _error(ENOTEMPTY)
        if place in self.folders:
            self.folders.discard(place)
        elif self.files.pop(place, None) is None:
            raise _error(ENOENT)

    def rename(self, old: Path, new: Path) -> None:
        """Give a file another name, in place of what had that."""
        if old not in self.files:
            raise _error(ENOENT)
        self.files[new] = self.files.pop(old)

    def truncate(self, place: Path, size: int) -> None:
        """Cut a file, or lengthen it by zeros."""
        if place not in self.files:
            raise _error(ENOENT)
        data = self.files[place]
        self.write(data, max(size, len(data)), b"")
        del data[size:]

    def _count(self) -> None:
        if len(self.files) + len(self.folders) >= MOST_ENTRIES:
            raise _error(ENOSPC)


class WrittenFile:
    """A file that somebody writes."""

    def __init__(self, files: WrittenFiles, data: bytearray) -> None:
        self._files, self._data = files, data
        self.told_size = len(data)

    def read(self, _offset: int, _count: int) -> bytes:
        """Refuse to read what is open to write.

        Raises:
            InvalidReadError: Always.
        """
        raise InvalidReadError(EBADF)

    def write(self, offset: int, part: bytes) -> None:
        """Put a part into it."""
        self._files.write(self._data, offset, part)

    def close(self) -> None:
        """End writing it."""


def _error(number: int) -> OSError:
    return OSError(number, strerror(number))
