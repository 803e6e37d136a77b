"""Whether PX4 would fly a mission at all: it accepts almost any upload, and looks at the whole before it flies.

The checks and their texts are those of PX4's `FeasibilityChecker.cpp`; that a place must be one on earth is added.
"""

from collections.abc import Sequence
from math import hypot
from typing import Final

from vehicle_sim.autopilot.mission_items import Command, Kind, MissionItem
from vehicle_sim.geodesy import ned_offset_m
from vehicle_sim.parameters import FlightSettings
from vehicle_sim.signals import Geodetic

_POLE_DEG: Final = 90.0
_ANTIMERIDIAN_DEG: Final = 180.0
_LEAST_TAKEOFF_M: Final = 1.0


def mission_fault(
    items: Sequence[MissionItem], settings: FlightSettings, home: Geodetic, *, landed: bool
) -> str | None:
    """Return the text of the first thing that is wrong with a mission; None if it may be flown."""
    for number, item in enumerate(items, start=1):
        if item.unflyable:
            return f"Mission rejected: item {number}: {item.unflyable}"
        place = item.place
        if place is not None and place.lat_deg is not None:
            on_earth = abs(place.lat_deg) <= _POLE_DEG and abs(place.lon_deg) <= _ANTIMERIDIAN_DEG
            if not on_earth:
                return f"Mission rejected: item {number}: no place on earth"
        if item.command is Command.JUMP and not 0 <= item.target < len(items):
            return f"Mission rejected: item {number}: jump out of bounds"
    return (
        _starts_by_landing(items, landed=landed)
        or _takeoff_fault(items, settings, home)
        or _distance_fault(items, settings, home)
        or _ends_fault(items, settings)
    )


def _starts_by_landing(items: Sequence[MissionItem], *, landed: bool) -> str | None:
    starts = landed and bool(items) and items[0].command is Command.LAND
    return "Mission rejected: starts with landing" if starts else None


def _takeoff_fault(items: Sequence[MissionItem], settings: FlightSettings, home: Geodetic) -> str | None:
    placed = False
    for item in items:
        if item.command is Command.TAKEOFF and item.place is not None:
            height_m = item.place.geodetic(home, home).alt_m - home.alt_m
            if height_m - _LEAST_TAKEOFF_M < settings.accept_m:
                return "Mission rejected: Takeoff altitude too low!"
            if placed:
                return "Mission rejected: takeoff not first waypoint item"
        placed = placed or (item.kind is Kind.NAVIGATE and item.command is not Command.DELAY)
    return None


def _distance_fault(items: Sequence[MissionItem], settings: FlightSettings, home: Geodetic) -> str | None:
    for item in items:
        if item.place is not None and item.kind is Kind.NAVIGATE:
            north, east, _ = ned_offset_m(home, item.place.geodetic(home, home))
            if (distance := hypot(north, east)) > settings.mission_farthest_m:
                return f"First waypoint too far away: {distance:.0f}m, {settings.mission_farthest_m:.0f} max"
            return None
    return None


def _ends_fault(items: Sequence[MissionItem], settings: FlightSettings) -> str | None:
    takes_off = any(item.command is Command.TAKEOFF for item in items)
    lands = any(item.command is Command.LAND for item in items)
    if settings.mission_needs_takeoff and not takes_off:
        return "Mission rejected: Takeoff waypoint required."
    if settings.mission_needs_landing and not lands:
        return "Mission rejected: Landing waypoint/pattern required."
    if settings.mission_needs_both_or_none and takes_off is not lands:
        return "Mission rejected: Add Takeoff or Landing item, or remove the other."
    return None
