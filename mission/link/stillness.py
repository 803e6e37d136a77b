"""Since when a vehicle has been still where it should be."""

import math
from typing import Final

from mission.link.frames import Vector

_STEADY_M: Final = 0.3
_STEADY_M_S: Final = 0.3


class Stillness:
    """Watches reports.

    Attributes:
        off_m: Horizontal distance of the last report from where the vehicle should be; infinite before the first.
    """

    def __init__(self) -> None:
        """Know of no report."""
        self.off_m = math.inf
        self._from_s = math.inf

    def observe(
        self, at_s: float, position_m: Vector, velocity_m_s: Vector, wanted_m: Vector, *, facing: bool = True
    ) -> None:
        """Take a report; ``facing`` is whether its nose is where it should be, too."""
        self.off_m = math.hypot(position_m[0] - wanted_m[0], position_m[1] - wanted_m[1])
        still = self.off_m <= _STEADY_M and math.hypot(*velocity_m_s) <= _STEADY_M_S
        if not (still and facing) or abs(position_m[2] - wanted_m[2]) > 2.0 * _STEADY_M:
            self._from_s = math.inf
        elif math.isinf(self._from_s):
            self._from_s = at_s

    def steady_s(self, at_s: float) -> float:
        """How long the vehicle has been still there."""
        return max(at_s - self._from_s, 0.0)
