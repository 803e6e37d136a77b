"""What a check of a mission file finds, before it is known where in the file that stands."""

from collections.abc import Iterable
from dataclasses import dataclass
from difflib import get_close_matches

Path = tuple[str | int, ...]


@dataclass(frozen=True)
class Finding:
    """One thing that is wrong.

    Attributes:
        path: Keys and list indices from the root to the value that is wrong.
        message: What is wrong.
        hint: What to write instead; may be empty.
        at_key: Whether the fault is with the key rather than its value.
        character: Index of the character of a text that is wrong; None for the value as a whole.
    """

    path: Path
    message: str
    hint: str = ""
    at_key: bool = False
    character: int | None = None


def dotted(path: Path) -> str:
    """A path as text: ``regions.S1.polygon[2]``."""
    text = ""
    for step in path:
        text += f"[{step}]" if isinstance(step, int) else f".{shortened(step)}" if text else shortened(step)
    return text


def shortened(text: str, most: int = 60) -> str:
    """A text that a file brings along, cut to what a message can show."""
    return text if len(text) <= most else text[: most - 3] + "..."


def nearest(name: str, known: Iterable[str]) -> str:
    """The known name that looks most like a given one, empty where none does; capital letters do not matter."""
    by_lower = {candidate.lower(): candidate for candidate in sorted(known, reverse=True)}
    found = get_close_matches(name.lower(), sorted(by_lower), n=1, cutoff=0.6)
    return by_lower[found[0]] if found else ""


def rather(name: str, known: Iterable[str], what: str, *, most: int = 12) -> str:
    """What to write instead of a name that is unknown: the one that looks most like it, or one of those there are.

    Args:
        name: As it was written.
        known: Those there are, in the order in which they are listed.
        what: What they are, such as ``regions``.
        most: How many are listed.
    """
    names = list(known)
    close = nearest(name, names)
    return f"did you mean `{close}`?" if close else f"the {what} are {listed(names, most=most)}"


def listed(names: Iterable[object], *, most: int = 12) -> str:
    """Names in a row, shortened where there are many."""
    texts = [str(name) for name in names]
    return ", ".join(texts[:most]) + (f" and {len(texts) - most} more" if len(texts) > most else "")


def is_clean(path: Path, findings: list[Finding]) -> bool:
    """Whether nothing was found at a path, in it, or about what it stands in; what is missing was found, too."""
    return not any(path[: len(f.path)] == f.path or f.path[: len(path)] == path for f in findings)
