"""Plain scalars of a mission file, read more strictly than YAML reads them.

YAML 1.1 finds octal numbers in ``010``, sexagesimal ones in ``1:30``, truth in ``on`` and dates in ``2024-01-01``. A
mission file means none of these by accident: they become an ``Oddity``, which fits no type, and whose reason tells
what YAML took it for. In ``1e-5``, which JSON and most programs write, it finds text: here that is the number.
"""

import math
import re
from collections.abc import Callable
from dataclasses import dataclass
from typing import Final

from yaml.nodes import ScalarNode
from yaml.resolver import Resolver

_INTEGER: Final = re.compile(r"[-+]?(0|[1-9][0-9]{0,99})")
_DECIMAL: Final = re.compile(r"[-+]?((0|[1-9][0-9]*)(\.[0-9]*)?|\.[0-9]+)([eE][-+]?[0-9]{1,6})?")
_LEADING_NUMBER: Final = re.compile(r"([-+]?[0-9]+(?:\.[0-9]+)?)\s*[A-Za-z°/%²]")
_COMMA: Final = re.compile(r"[-+]?[0-9]+,[0-9]+")
_resolve: Final[Callable[[type, str, tuple[bool, bool]], object]] = Resolver().resolve


@dataclass(frozen=True)
class Oddity:
    """A scalar that YAML takes for something that no mission file needs.

    Attributes:
        found: What it is, as the end of "expected a number, found ...".
        hint: What to write instead.
    """

    found: str
    hint: str


def plain_value(text: str) -> bool | int | float | str | Oddity | None:
    """The value of a plain (unquoted) scalar."""
    tag = str(_resolve(ScalarNode, text, (True, False))).rpartition(":")[2]
    if tag == "str" and _DECIMAL.fullmatch(text):
        tag = "float"
    read = _READERS.get(tag)
    return read(text) if read else text


def _truth(text: str) -> bool | Oddity:
    if text.lower() in ("true", "false"):
        return text.lower() == "true"
    truth = "true" if text.lower() in ("yes", "on") else "false"
    return Oddity(f"`{text}`, which YAML reads as {truth}", f'in quotes it is text: "{text}"')


def _date(text: str) -> Oddity:
    return Oddity(f"`{text}`, which YAML reads as a date", f'in quotes it is text: "{text}"')


def _integer(text: str) -> int | Oddity:
    return int(text) if _INTEGER.fullmatch(text) else _odd_number(text)


def _decimal(text: str) -> float | Oddity:
    if not _DECIMAL.fullmatch(text):
        return _odd_number(text)
    number = float(text)
    if math.isfinite(number):
        return number
    return Oddity(f"`{text}`, which is too large for a number", "write a finite number")


def _odd_number(text: str) -> Oddity:
    lower = text.lower().lstrip("+-")
    if lower in (".nan", ".inf"):
        return Oddity(f"`{text}`, which is not finite", "write a finite number")
    if ":" in text:
        return Oddity(f"`{text}`, which YAML reads as a sexagesimal number", "write it in decimals, in the key's unit")
    if lower.startswith(("0x", "0b")) or (lower.startswith("0") and "." not in lower):
        return Oddity(f"`{text}`, which YAML does not read as a decimal number", "write it in decimals, no leading 0")
    return Oddity(f"`{text}`, which is no plain decimal number", "write it in decimals, such as 1000 or 12.5")


_READERS: Final[dict[str, Callable[[str], bool | int | float | Oddity | None]]] = {
    "null": lambda _: None,
    "bool": _truth,
    "int": _integer,
    "float": _decimal,
    "timestamp": _date,
}
"""For each type that YAML may take a plain scalar for; the rest is text."""


def number_hint(text: str) -> str:
    """What to write instead of a text where a number is due; empty where that cannot be guessed."""
    if _COMMA.fullmatch(text):
        return f"the decimal point is a dot: {text.replace(',', '.')}"
    leading = _LEADING_NUMBER.match(text)
    if leading:
        return f"write the number alone, the unit stands in the key: {leading.group(1)}"
    return ""
