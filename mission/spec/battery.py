"""What a mission file says of the battery: what hovering and flying take of it, and what is to stay in it."""

from dataclasses import dataclass
from typing import Any, Final

from mission.spec.shape_schema import Schema, mapping, number

_RESERVE: Final = 0.2
"""What batteries of lithium are not to be emptied beyond."""


@dataclass(frozen=True)
class Battery:
    """The battery.

    Attributes:
        current_a: What the vehicle draws in flight, on average.
        reserve: Share of the capacity that is to be left after the landing.
        capacity_mah: Of a full one; None where the vehicle's own word for it is taken.
    """

    current_a: float
    reserve: float = _RESERVE
    capacity_mah: float | None = None

    def charge_mah(self, duration_s: float) -> float:
        """What so long a flight takes."""
        return self.current_a * duration_s / 3.6


BATTERY_SCHEMA: Final[Schema] = mapping(
    "The battery: before it arms, a flight is refused for which the charge does not suffice.",
    ("current_a",),
    {
        "current_a": number(
            "Mean current in flight, A; logs of earlier flights tell it.", 0.01, 1_000.0, examples=[14.5]
        ),
        "reserve": number("Share of the capacity that is to be left after the landing.", 0.0, 0.9, default=_RESERVE),
        "capacity_mah": number(
            "Capacity of a full battery, mAh; without it, what the vehicle is set to (BATT_CAPACITY, BAT1_CAPACITY).",
            10.0,
            1.0e6,
            examples=[5000],
        ),
    },
    examples=[{"current_a": 14.5, "reserve": 0.25, "capacity_mah": 5000}],
)


def battery_of(data: dict[str, Any] | None) -> Battery | None:
    """The battery of a mission file's section ``battery``."""
    return None if data is None else Battery(**{key: float(value) for key, value in data.items()})
