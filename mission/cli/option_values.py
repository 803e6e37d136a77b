"""Values on the command line of ``mission``, read into what they are, or refused with what to write instead."""

import argparse
import math
from typing import Final

from mission.errors import GeometryError
from mission.geometry.geodesy import LatLon
from mission.spec.model import MOST_LAPS, UNTIL_STOPPED

_DIGITS = 18
_MOST_ID = 255
FORMATS: Final = ("png", "svg", "pdf")
"""Of pictures."""


def whole(text: str) -> int:
    """A whole number from 0."""
    if not (text.isascii() and text.isdigit() and len(text) <= _DIGITS):
        raise argparse.ArgumentTypeError(f"{text!r} is not a whole number from 0")
    return int(text)


def positive_whole(text: str) -> int:
    """A whole number from 1."""
    if not whole(text):
        raise argparse.ArgumentTypeError("write a whole number from 1")
    return int(text)


def system_id(text: str) -> int:
    """A MAVLink system id of a vehicle, 1 to 255."""
    number = positive_whole(text)
    if number > _MOST_ID:
        raise argparse.ArgumentTypeError(f"system ids are 1 to {_MOST_ID}, {text} is not")
    return number


def laps(text: str) -> int | str:
    """How many laps, or that they have no end."""
    if text.replace("-", "_") == UNTIL_STOPPED:
        return UNTIL_STOPPED
    count = positive_whole(text)
    if count > MOST_LAPS:
        raise argparse.ArgumentTypeError(f"{text} laps are more than {MOST_LAPS}; until-stopped has no end")
    return count


def whole_or_auto(text: str) -> int | str:
    """A whole number from 1, or auto."""
    return text if text == "auto" else positive_whole(text)


def seed(text: str) -> int:
    """A seed, 32 bits without sign."""
    if whole(text) >= 2**32:
        raise argparse.ArgumentTypeError(f"a seed is less than 2^32, {text} is not")
    return int(text)


def number(text: str) -> float:
    """A finite number."""
    try:
        value = float(text)
    except ValueError:
        value = math.nan
    if not math.isfinite(value):
        raise argparse.ArgumentTypeError(f"{text!r} is not a finite number")
    return value


def positive(text: str) -> float:
    """A finite number above 0."""
    value = number(text)
    if value <= 0.0:
        raise argparse.ArgumentTypeError(f"{text} is not positive")
    return value


def place(text: str) -> LatLon:
    """LATITUDE,LONGITUDE in degrees."""
    latitude, separator, longitude = text.partition(",")
    if not separator:
        raise argparse.ArgumentTypeError(f"write LATITUDE,LONGITUDE in degrees, not {text!r}")
    try:
        return LatLon(number(latitude), number(longitude))
    except GeometryError as error:
        raise argparse.ArgumentTypeError(str(error)) from None


def offset(text: str) -> tuple[float, float]:
    """EAST,NORTH in metres."""
    east, separator, north = text.partition(",")
    if not separator:
        raise argparse.ArgumentTypeError(f"write EAST,NORTH in metres, not {text!r}")
    return number(east), number(north)


def extent(text: str) -> tuple[float, float]:
    """EAST,NORTH in metres, both above 0."""
    east, separator, north = text.partition(",")
    if not separator:
        raise argparse.ArgumentTypeError(f"write EAST,NORTH in metres, not {text!r}")
    return positive(east), positive(north)


def wind(text: str) -> str:
    """NORTH,EAST or SPEED@FROM_DEGREES in m/s, as it was written."""
    first, separator, second = text.partition("@" if "@" in text else ",")
    if not separator:
        raise argparse.ArgumentTypeError(f"write NORTH,EAST or SPEED@FROM_DEGREES, not {text!r}")
    if number(first) < 0.0 and separator == "@":
        raise argparse.ArgumentTypeError(f"the speed {first} is negative")
    number(second)
    return text


def add_format(command: argparse.ArgumentParser, *, beside_png: bool = False) -> None:
    """Add the choice of the pictures' format; of reports, whose page shows PNG, of one more."""
    words = "draw the pictures in this format, too; the page shows png" if beside_png else "what the pictures are"
    command.add_argument("--format", choices=FORMATS, default="png", help=f"{words} (default: %(default)s)")
