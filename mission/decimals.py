"""Numbers in messages, written so that whoever copies one into a file has the number that was meant."""

from decimal import Decimal

DIGITS = 9
"""Digits after the point, of metres nanometres: in a domain of a metre and more, finer differences are rounding."""


def decimal(value: float) -> str:
    """A finite number with as many digits as it needs and no exponent: ``131.7625``, ``5412345.67``, ``0.00001``."""
    if isinstance(value, int):
        return str(value)
    rounded = round(float(value), DIGITS) or 0.0  # never -0
    text = format(Decimal(repr(rounded)), "f")
    return text.removesuffix(".0")


def measure(value: float) -> str:
    """A length to be understood, not copied: three significant digits, no exponent."""
    return decimal(float(f"{value:.3g}"))


def count(number: int, noun: str) -> str:
    """``3 runs``, ``1 run``."""
    return f"{number:,} {noun}{'' if number == 1 else 's'}"
