"""Landing detection: the ground is what carries the vehicle although thrust does not."""

from typing import Final

from vehicle_sim.signals import GRAVITY_M_S2, Estimate

_THRUST_SHARE: Final = 0.93
_VERTICAL_M_S: Final = 0.2
_HORIZONTAL_M_S: Final = 0.7
_DURATION_S: Final = 1.0


class LandDetector:
    """Tells that the vehicle has landed, from thrust and estimated velocity alone.

    In flight, thrust below weight means that the vehicle sinks ever faster; if it stays still instead for a
    second, it stands.
    """

    def __init__(self) -> None:
        """Start with nothing observed."""
        self._still_since_s: float | None = None

    def reset(self) -> None:
        """Forget what was observed: the vehicle takes off."""
        self._still_since_s = None

    def landed(self, now_s: float, estimate: Estimate, thrust_m_s2: float) -> bool:
        """Observe one moment and say whether the vehicle has landed.

        `thrust_m_s2` is the specific thrust that the controller asks for.
        """
        north, east, down = estimate.velocity_ned_m_s
        # Without a position the horizontal speed drifts and says nothing.
        slow = north * north + east * east < _HORIZONTAL_M_S**2 or not estimate.status.position_ok
        still = abs(down) < _VERTICAL_M_S and slow
        if thrust_m_s2 > _THRUST_SHARE * GRAVITY_M_S2 or not still:
            self._still_since_s = None
            return False
        if self._still_since_s is None:
            self._still_since_s = now_s
        return now_s - self._still_since_s >= _DURATION_S
