"""Flights side by side: the numbers that differ between two flights of a mission, or between missions."""

from collections.abc import Iterable, Mapping
from typing import Any, Final

_OF_FLIGHT: Final = (
    "duration_s",
    "length_m",
    "rms_error_m",
    "largest_error_m",
    "largest_speed_m_s",
    "distance_to_restricted_m",
    "charge_percent",
)


def comparison(flights: Iterable[tuple[str, Mapping[str, Any]]]) -> list[dict[str, Any]]:
    """A row for each flight, as JSON values.

    Args:
        flights: The name of each flight's folder, and its ``summary``, of a flight that was recorded.

    Returns:
        Of each its ``folder``, ``mission``, ``achieved`` (None where no verdict was reached) and ``reason``, then what
        its summary has of what was flown: ``duration_s``, ``length_m``, ``rms_error_m`` and ``largest_error_m`` (from
        the trajectory, horizontally), ``largest_speed_m_s``, ``distance_to_restricted_m`` (region by region) and
        ``charge_percent`` (first and last); None for what is not known.
    """
    return [
        {
            "folder": folder,
            "mission": told["mission"],
            "achieved": told["verdict"]["achieved"],
            "reason": told["verdict"]["reason"],
            **{name: told["flown"][name] for name in _OF_FLIGHT},
        }
        for folder, told in flights
    ]
