"""Files that are written whole: whoever reads one finds the old content or the new one, never half of it."""

import os
import tempfile
from contextlib import suppress
from pathlib import Path


def write_whole(path: Path, data: bytes, *, durable: bool = False) -> None:
    """Write `data` under a temporary name beside `path`, for its owner alone, then give it its name.

    The temporary name is one that nobody can guess and nothing has, so no link leads the writing elsewhere. What is
    `durable` is on the disk before it has its name, so that it is whole after a loss of power, too.

    Raises:
        OSError: It cannot be written; what was there is still there.
    """
    handle, temporary = tempfile.mkstemp(prefix=f".{path.name}.", dir=path.parent)
    try:
        with os.fdopen(handle, "wb") as file:
            file.write(data)
            if durable:
                file.flush()
                os.fsync(file.fileno())
        Path(temporary).replace(path)
    except OSError:
        with suppress(OSError):
            Path(temporary).unlink()
        raise
