"""How operators may be spelled: signs of ASCII and Unicode, words of English, and commands of LaTeX.

The first spelling of each is the one that this project writes. Signs that stand for past operators (◆ ■ ●) or for more
than one thing (`*`, `+`) are no spellings.
"""

import unicodedata
from enum import StrEnum
from typing import Final

from mission.logic.formula.operators import Operator


class Sign(StrEnum):
    """What is written in a formula and is no operator of a node."""

    XOR = "xor"
    OPEN = "("
    CLOSE = ")"


Meaning = Operator | Sign

_TABLE: Final[dict[Meaning, tuple[str, str, str]]] = {
    # meaning: signs, words, commands of LaTeX
    Operator.NOT: ("! ~ ¬ ∼", "not", "neg lnot sim"),
    Operator.ALWAYS: ("[] □ ☐ ◻ ▢ ⬜", "always globally", "Box square"),
    Operator.EVENTUALLY: ("<> ◇ ◊ ⋄ ♢ ⬦", "eventually finally", "Diamond diamond lozenge"),
    Operator.NEXT: ("○ ◯ ⚪ ∘", "next", "bigcirc circ"),
    Operator.AND: ("& && /\\ ∧ ⋀", "and", "land wedge bigwedge"),
    Operator.OR: ("| || \\/ ∨ ⋁", "or", "lor vee bigvee"),
    Sign.XOR: ("^ ⊕ ⊻", "xor", "oplus veebar"),
    Operator.IMPLIES: (
        "-> => --> → ⇒ ⟶ ⟹ ⊃",
        "implies",
        "to rightarrow Rightarrow longrightarrow Longrightarrow implies supset",
    ),
    Operator.IFF: (
        "<-> <=> <--> ↔ ⇔ ⟷ ⟺ ≡",
        "iff",
        "leftrightarrow Leftrightarrow longleftrightarrow Longleftrightarrow iff equiv",
    ),
    Operator.UNTIL: ("", "until", ""),
    Operator.RELEASE: ("", "release releases", ""),
    Operator.TRUE: ("⊤", "true", "top"),
    Operator.FALSE: ("⊥", "false", "bot"),
    Sign.OPEN: ("(", "", ""),
    Sign.CLOSE: (")", "", ""),
}


def _column(index: int) -> dict[str, Meaning]:
    return {spelling: meaning for meaning, spellings in _TABLE.items() for spelling in spellings[index].split()}


SIGNS: Final = _column(0)
WORDS: Final = _column(1)
"""In lower case; ``AND`` and ``And`` are read as well."""

COMMANDS: Final = _column(2)
"""Without the backslash."""

SPACES: Final = ("left", "right", "quad", "qquad", "big", "Big", "bigl", "bigr", "Bigl", "Bigr", "limits", "nolimits")
"""Commands of LaTeX that only set their surroundings."""

PREFIX_LETTERS: Final = {"F": Operator.EVENTUALLY, "G": Operator.ALWAYS, "X": Operator.NEXT}
INFIX_LETTERS: Final = {
    "U": Operator.UNTIL,
    "R": Operator.RELEASE,
    "V": Operator.RELEASE,
    "W": Operator.WEAK_UNTIL,
    "M": Operator.STRONG_RELEASE,
}

KNOWN_OPERATORS: Final = "! & | xor -> <-> F G X U W R M"

_PAST: Final = "operators of the past are not known"
MISTAKEN: Final = {
    "*": "and is written &",
    "·": "and is written &",
    "+": "or is written |",
    ",": "and is written &, or is written |",
    "=": "equivalence is written <->, implication ->",
    "≠": "exclusive or is written xor",
    "'": 'a name with special characters is written in double quotes: "north field"',
    "“": 'quotes are written "',
    "”": 'quotes are written "',
    "{": "groups are written in parentheses: (a & b)",
    "[": "groups are written in parentheses, and always as G or []",
    "<": "eventually is written F or <>",
    "-": "implication is written ->; a name has letters, digits, _ and . only",
    "◆": _PAST,
    "■": _PAST,
    "●": _PAST,
}
"""What to write instead of a sign that has no meaning here, where that can be said."""


def folded(text: str) -> str:
    """The text with each character in its plain form where Unicode has one (`𝒰` is U, `＆` is &); columns stay."""
    return text if text.isascii() else "".join(_plain(character) for character in text)


def _plain(character: str) -> str:
    if character in SIGNS:
        return character
    plain = unicodedata.normalize("NFKC", character)
    return plain if len(plain) == 1 and (plain.isascii() or plain in SIGNS) else character


def named(character: str) -> str:
    """A character for a message: itself, its code point and its name."""
    name = unicodedata.name(character, "")
    return repr(character) if character.isascii() else f"{character!r} (U+{ord(character):04X}{name and ' '}{name})"
