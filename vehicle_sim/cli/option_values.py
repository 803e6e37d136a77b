"""Texts of `vehicle-sim`'s options turned into values; each refuses what it cannot use with `ArgumentTypeError`."""

import argparse
from math import atan2, degrees, hypot, isfinite
from typing import Final

from vehicle_sim.errors import ConfigurationError
from vehicle_sim.server.addresses import LISTENING, Address, parse_address

HOME_FIELDS: Final = ("home_lat_deg", "home_lon_deg", "home_alt_m")
_FASTEST: Final = 1000.0
_MOST_PATIENT_S: Final = 60.0


def number(text: str) -> float:
    """Return a finite number."""
    try:
        value = float(text)
    except ValueError:
        raise argparse.ArgumentTypeError(f"{text!r} is not a number") from None
    if not isfinite(value):
        raise argparse.ArgumentTypeError(f"{text!r} is not a finite number")
    return value


def not_negative(text: str) -> float:
    """Return a number from 0 up."""
    value = number(text)
    if value < 0.0:
        raise argparse.ArgumentTypeError(f"{text} is negative")
    return value


def speed(text: str) -> float:
    """Return a multiple of real time."""
    value = number(text)
    if not 0.0 < value <= _FASTEST:
        raise argparse.ArgumentTypeError(f"the speed lies in (0, {_FASTEST:g}], {text} does not")
    return value


def patience(text: str) -> float:
    """Return for how many seconds of real time a late client is waited for."""
    value = not_negative(text)
    if value > _MOST_PATIENT_S:
        raise argparse.ArgumentTypeError(f"patience ends at {_MOST_PATIENT_S:g} s, {text} does not")
    return value


def whole(text: str, low: int, high: int) -> int:
    """Return a whole number within bounds."""
    if not (text.isascii() and text.isdigit() and low <= int(text) <= high):
        raise argparse.ArgumentTypeError(f"{text!r} is not a whole number from {low} to {high}")
    return int(text)


def seed(text: str) -> int:
    """Return the seed of all noise."""
    return whole(text, 0, 2**32 - 1)


def system_id(text: str) -> int:
    """Return a MAVLink system id."""
    return whole(text, 1, 255)


def assignment(text: str) -> tuple[str, str]:
    """Return the name of a parameter and the text of its value."""
    name, equals, value = (part.strip() for part in text.partition("="))
    if not (name and equals and value):
        raise argparse.ArgumentTypeError(f"write NAME=VALUE, not {text!r}")
    return name, value


def wind(text: str) -> tuple[float, float]:
    """Return speed in m/s and the direction in degrees that the wind blows from."""
    speed_text, at, from_text = text.partition("@")
    if at:
        return not_negative(speed_text), number(from_text) % 360.0
    north_text, comma, east_text = text.partition(",")
    if not comma:
        raise argparse.ArgumentTypeError(f"write NORTH,EAST or SPEED@FROM_DEGREES, not {text!r}")
    north, east = number(north_text), number(east_text)
    return hypot(north, east), degrees(atan2(-east, -north)) % 360.0


def home(text: str) -> tuple[float, float, float]:
    """Return latitude and longitude in degrees and the altitude in metres."""
    parts = text.split(",")
    if len(parts) != len(HOME_FIELDS):
        raise argparse.ArgumentTypeError(f"write LAT,LON,ALT, not {text!r}")
    lat_deg, lon_deg, alt_m = (number(part) for part in parts)
    return lat_deg, lon_deg, alt_m


def address(text: str) -> Address:
    """Return the address of a link."""
    try:
        return parse_address(text)
    except ConfigurationError as error:
        raise argparse.ArgumentTypeError(str(error)) from None


def listen_address(text: str) -> Address:
    """Return an address that waits for clients."""
    place = address(text)
    if place.scheme not in LISTENING:
        raise argparse.ArgumentTypeError(f"{place} does not listen; write it with --connect, or udpin:, tcpin: or pty:")
    return place


def connect_address(text: str) -> Address:
    """Return an address that speaks first."""
    place = address(text)
    if place.scheme in LISTENING:
        raise argparse.ArgumentTypeError(f"{place} listens; write it with --listen, or udpout:, tcp: or serial:")
    return place
