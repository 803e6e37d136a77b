"""The time from arming to landing that a plan takes, beside what `flight.longest_s` asks for."""

import math
from dataclasses import dataclass
from typing import Any

from mission.spec.air_time import air_s, longest_text
from mission.spec.model import Flight


@dataclass(frozen=True)
class AirTime:
    """The time from arming to landing that is asked for, and by how much a plan keeps it.

    Attributes:
        longest_s: The longest that it may be.
        takes_s: How long it is about; infinite for laps without end.
    """

    longest_s: float
    takes_s: float

    @classmethod
    def of(cls, flight: Flight, trajectory_s: float) -> "AirTime | None":
        """Of a trajectory that takes so long; None where nothing is asked for."""
        return None if flight.longest_s is None else cls(flight.longest_s, air_s(flight.altitude_m, trajectory_s))

    @property
    def formula(self) -> str:
        """What is asked for."""
        return longest_text(self.longest_s)

    @property
    def margin_s(self) -> float:
        """By how much less it takes; below 0, by how much more."""
        return self.longest_s - self.takes_s

    @property
    def short_s(self) -> float:
        """By how much it fails; not above 0 where it is kept."""
        return -self.margin_s

    @property
    def kept(self) -> bool:
        """Whether it is kept."""
        return self.margin_s >= 0.0

    @property
    def text(self) -> str:
        """How it fares, in words."""
        if math.isinf(self.takes_s):
            return f"{self.formula} is not kept by laps without end"
        if self.kept:
            return f"{self.formula} is kept with about {self.margin_s:.1f} s to spare from arming to landing"
        return f"{self.formula} fails by about {-self.margin_s:.1f} s: from arming to landing are {self.takes_s:.1f} s"

    def to_json(self) -> dict[str, Any]:
        """It as JSON values; a margin without end is null."""
        return {"formula": self.formula, "margin_s": self.margin_s if math.isfinite(self.margin_s) else None}
