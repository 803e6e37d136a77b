"""Where the mission says where the nose looks: whether the vehicle, which turns so fast and no faster, can do that.

From samples of the flight, and so no proof: of the direction of the flight, or of that to the place that it looks
toward, and how fast these change. Before lanes along which it looks, ``flight`` judges the time to turn.
"""

from math import atan2, pi, remainder
from typing import Final

import numpy as np

from mission.geometry.arrays import BoolArray, FloatArray
from mission.geometry.regions import union_of
from mission.spec.heading import Look
from mission.verify.plans.proof import Verdict
from mission.verify.plans.written import Written

_STEP_S: Final = 0.02
_STANDING_M_S: Final = 0.05
_NEAR_M: Final = 1.0
_ROUNDING: Final = 1.02
_STRAIGHT_RAD: Final = 0.02
_SAME_S: Final = 1e-6


def heading_kept(plan: Written) -> Verdict:
    """The nose can follow what it looks at: no faster than the yaw rate in flight, and with time to turn at rest."""
    heading, most = plan.spec.flight.heading, plan.spec.limits.yaw_rate_rad_s
    if heading is None:
        return None, "none is asked for"
    worst = 0.0
    for number, (curve, law) in enumerate(zip(plan.legs, plan.laws, strict=True)):
        times = np.linspace(0.0, law.duration_s, 2 + int(law.duration_s / _STEP_S))
        place_s = law.jet(times)[0]
        places = curve.at(np.clip(place_s, 0.0, curve.ends_s[-1]))
        steps, lasting = np.diff(places, axis=0), float(times[1])
        counts = np.hypot(steps[:, 0], steps[:, 1]) > _STANDING_M_S * lasting
        counts &= ~_between_lanes(plan, plan.starts_s[number] + 0.5 * (place_s[1:] + place_s[:-1]))
        if heading.look is Look.FIXED:
            continue
        if heading.look is Look.TOWARD:
            away = _centre(plan, heading.region) - 0.5 * (places[1:] + places[:-1])
            counts &= np.hypot(away[:, 0], away[:, 1]) > _NEAR_M
            steps = away
        turned = np.abs(_turns(steps)) / lasting
        both = counts[1:] & counts[:-1]
        if both.any() and float(turned[both].max()) > _ROUNDING * most:
            k = int(np.argmax(np.where(both, turned, 0.0)))
            return f"leg {number} turns by {turned[k]:.2f} rad/s at {times[k + 1]:.2f} s, and may by {most:.2f}", ""
        worst = max([worst, *turned[both].tolist()])
        if heading.look is not Look.TOWARD and (fault := _unturned(plan, number, steps, counts, lasting)):
            return fault, ""
    return None, f"at most {worst:.2f} of {most:.2f} rad/s"


def _turns(steps: FloatArray) -> FloatArray:
    """The angles between vectors (n, 2) and the next, shape (n - 1,)."""
    angles = np.arctan2(steps[:, 0], steps[:, 1])
    return np.asarray((np.diff(angles) + pi) % (2.0 * pi) - pi)


def _unturned(plan: Written, number: int, steps: FloatArray, counts: BoolArray, lasting: float) -> str | None:
    """Where in a leg the vehicle sets out after a rest that was too short for it to turn."""
    moving = np.flatnonzero(counts)
    for k in np.flatnonzero(np.diff(moving) > 1).tolist():
        before, after = moving[k : k + 2].tolist()
        angle = abs(remainder(atan2(*steps[after]) - atan2(*steps[before]), 2.0 * pi))
        if angle > _STRAIGHT_RAD + plan.spec.limits.yaw_rate_rad_s * (after - before) * lasting:
            return f"leg {number} sets out anew at {after * lasting:.2f} s, too soon to turn by {angle:.2f} rad"
    return None


def _centre(plan: Written, name: str) -> FloatArray:
    inside = np.zeros(plan.partition.size, dtype=np.bool_)
    inside[plan.labelling.triangles_of(name)] = True
    return np.array(union_of(plan.partition, inside).centroid.coords[0])


def _between_lanes(plan: Written, place_s: FloatArray) -> BoolArray:
    """Which places on the curve lie between two lanes of a visit along whose lanes the nose looks."""
    heading, found = plan.spec.flight.heading, np.zeros(len(place_s), dtype=np.bool_)
    for visit in plan.data["covers"]:
        if visit["trigger_m"] is not None or (heading is not None and heading.look is Look.LANES):
            found |= (place_s > visit["lanes_s"][0][0] - _SAME_S) & (place_s < visit["lanes_s"][-1][1] + _SAME_S)
    return found
