"""Words for a terminal: what it would obey, and what nobody would see, is shown by its code."""


def printable(text: str) -> str:
    """Return the text in one line, with Python's escapes for control and format characters."""
    return "".join(c if c.isprintable() else c.encode("unicode_escape").decode("ascii") for c in text)
