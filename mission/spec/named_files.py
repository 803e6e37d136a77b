"""The other files that a mission file names, as whoever reads it gives them."""

from collections.abc import Callable


class UnreadableError(Exception):
    """A file that cannot be read: why, and what to do about it."""

    def __init__(self, message: str, hint: str) -> None:
        self.message, self.hint = message, hint
        super().__init__(message)


Reader = Callable[[str], bytes]
"""From a file that a mission names, as it names it, to its content, a byte more than ``yaml_tree.MAX_BYTES`` at most.

It raises UnreadableError.
"""


def nothing_beside(_: str) -> bytes:
    """The reader where there are no other files."""
    raise UnreadableError("there is no such file", "name a file in the mission file that is read")
