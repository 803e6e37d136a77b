"""The gaps of a flight: stretches in which nothing was told of the position, or nothing was asked of the vehicle."""

from collections.abc import Sequence
from dataclasses import dataclass
from enum import StrEnum
from typing import Final

GAP_S: Final = 0.5
"""Vehicle time between two messages of a kind that is more than this is a gap."""


class Missing(StrEnum):
    """What did not come."""

    POSITION = "position"
    SETPOINT = "setpoint"


@dataclass(frozen=True)
class Gap:
    """One gap, in vehicle time.

    Between two setpoints the trajectory paused; between two positions a straight line stands for what was flown.
    """

    missing: Missing
    from_s: float
    for_s: float


def gaps_text(gaps: Sequence[Gap]) -> str:
    """The gaps in plain words; empty where there are none."""
    unknown, paused = (
        [gap.for_s for gap in gaps if gap.missing is missing] for missing in (Missing.POSITION, Missing.SETPOINT)
    )
    parts = []
    if unknown:
        parts.append(f"where it was is unknown {_times(unknown)}{max(unknown):.1f} s")
    if paused:
        parts.append(f"the trajectory paused {_times(paused)}{max(paused):.1f} s")
    return ", ".join(parts)


def _times(lengths_s: list[float]) -> str:
    return "for " if len(lengths_s) == 1 else f"{len(lengths_s)} times for up to "
