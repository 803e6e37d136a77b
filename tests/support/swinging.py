"""A vehicle that swings to and fro, leaning as its drag and the wind ask of it."""

import math

from mission.link.drag import DragEstimate
from mission.monitor.attitude import GRAVITY_M_S2

PERIOD_S = 0.1


def flown(drag_per_s: float, wind_m_s: tuple[float, float], seconds: float = 20.0) -> DragEstimate:
    """An estimate after swinging to and fro by 3 m/s on both axes, nose to the north."""
    estimate = DragEstimate()
    for tick in range(round(seconds / PERIOD_S)):
        t_s = tick * PERIOD_S
        speed = [3.0 * math.sin(0.5 * t_s), 3.0 * math.cos(0.7 * t_s)]
        growth = [1.5 * math.cos(0.5 * t_s), -2.1 * math.sin(0.7 * t_s)]
        needs = [a + drag_per_s * (v - w) for a, v, w in zip(growth, speed, wind_m_s, strict=True)]
        # To the east by roll, to the north by pitch (nose down), exact for one of them after the other.
        pitch = -math.atan(needs[1] / GRAVITY_M_S2)
        roll = math.atan(needs[0] * math.cos(pitch) / GRAVITY_M_S2)
        estimate.observe(t_s, (speed[0], speed[1], 0.0), (roll, pitch, 0.0))
    return estimate
