r"""Text from outside, such as names and what a vehicle says, as a terminal and a page may show it.

A terminal obeys control characters; bidirectional ones turn what follows round; invisible ones make two names look the
same. Each of them is shown by its code instead, as Python writes it: ``\x1b``, ``\u202e``.
"""

import re
from typing import Final

_BLANK: Final = re.compile(
    "[\u034f\u115f\u1160\u17b4\u17b5\u180b-\u180d\u180f\u2800\u3164\ufe00-\ufe0f\uffa0\U000e0100-\U000e01ef]"
)
"""Letters, marks and symbols that show nothing: Default_Ignorable_Code_Point of Unicode, and the blank of Braille."""


def shows(character: str) -> bool:
    """Whether a character shows something, and does no more than that; a space does."""
    return character.isprintable() and not _BLANK.match(character)


def printable(text: str, keep: str = "") -> str:
    """The text with the code in place of each character that does not show.

    Args:
        text: Any text, halves of surrogate pairs included.
        keep: Characters that stay as they are, such as the line ends of a text of several lines.
    """
    if text.isprintable() and not _BLANK.search(text):
        return text
    return "".join(c if c in keep or shows(c) else c.encode("unicode_escape").decode("ascii") for c in text)
