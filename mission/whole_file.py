"""Files that are either whole or not there: written under a temporary name, then renamed."""

import os
from pathlib import Path
from secrets import token_hex

_OWNER_ALONE = 0o600


def write_whole(path: Path, content: bytes | str, *, private: bool = False, durable: bool = True) -> None:
    """Write ``content`` (text as UTF-8) to ``path`` so that no reader ever sees a part of it.

    An existing file, or a link, is replaced in one step, or kept as it was where the writing fails. Nobody can guess
    the temporary name, and where something has it, nothing is written: a link that others put there leads nowhere.

    Args:
        path: Where.
        content: What.
        private: Whether it is for its owner alone.
        durable: Whether it is to be on the disk before it has its name, and so whole after a loss of power, too. That
            may take a while.

    Raises:
        OSError: The folder does not exist, or the file cannot be written there.
    """
    data = content.encode() if isinstance(content, str) else content
    temporary = path.with_name(f".{token_hex(16)}.part")
    with open(temporary, "xb", opener=_opened_for_owner if private else None) as file:
        try:
            file.write(data)
            file.flush()
            if durable:
                os.fsync(file.fileno())
            temporary.replace(path)
        except BaseException:
            temporary.unlink(missing_ok=True)
            raise


def _opened_for_owner(path: str, flags: int) -> int:
    return os.open(path, flags, _OWNER_ALONE)
