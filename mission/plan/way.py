"""The way in the plane that the search for shortest flights found."""

from dataclasses import dataclass
from typing import Any

import numpy as np

from mission.geometry.arrays import FloatArray, frozen_floats


@dataclass(frozen=True, eq=False)
class Way:
    """A lasso of straight pieces.

    Attributes:
        prefix_m: Shape (P, 2), from the start to where the loop begins, ENU, metres; P at least 1.
        loop_m: Shape (L, 2), round the loop, which ends where it begins; one point where the flight stays.
    """

    prefix_m: FloatArray
    loop_m: FloatArray

    def __post_init__(self) -> None:
        object.__setattr__(self, "prefix_m", frozen_floats(self.prefix_m))
        object.__setattr__(self, "loop_m", frozen_floats(self.loop_m))

    def to_json(self) -> dict[str, Any]:
        """As JSON values."""
        return {"prefix_m": self.prefix_m.tolist(), "loop_m": self.loop_m.tolist()}

    @staticmethod
    def from_json(data: dict[str, Any]) -> "Way":
        """From what ``to_json`` gave.

        Raises:
            ValueError: It is not such.
        """
        parts = [np.array(data[key], dtype=np.float64) for key in ("prefix_m", "loop_m")]
        if any(part.ndim != 2 or part.shape[1] != 2 or not np.isfinite(part).all() for part in parts):  # noqa: PLR2004
            raise ValueError("a way is a list of points")
        return Way(*parts)
