"""The tube of the proof, from its causes: disturbances, the estimator, the autopilot's following, corrections.

The vehicle's distance from its trajectory, on each axis, is the sum of

- what a disturbance of at most w leaves to the tracking law of Eq. 12, w tau^2, and of its velocity 2 w tau / e: the
  integrals over |t e^(-t/tau)| and over the size of its derivative;
- how far its own estimate is off, for flights are judged by that;
- how far the autopilot's law is behind by itself, where nothing disturbs it;
- the reach of the setpoints' correction, which may lead off a vehicle that needs none.

A landing is the autopilot's own: it holds the place at which the vehicle happens to be in its tube when it is told to
land, and is off from there by the same causes, corrections left out, which nobody makes any more.
"""

import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any, Final

from mission.spec.shape_schema import Schema, mapping, number


@dataclass(frozen=True)
class Margins:
    """What of the tube comes from other causes than disturbances, on each axis.

    Attributes:
        estimator_m: Bound of the estimated position's error.
        following_m: Bound of the autopilot's own following error.
        correction_m: Reach of the correction of setpoints.
        following_m_s: Bound of the velocity's own following error.
    """

    estimator_m: float = 0.0
    following_m: float = 0.0
    correction_m: float = 0.0
    following_m_s: float = 0.0

    @property
    def sum_m(self) -> float:
        """All that concerns the position."""
        return self.own_m + self.correction_m

    @property
    def own_m(self) -> float:
        """What of it the vehicle has by itself, whoever leads it."""
        return self.estimator_m + self.following_m


NO_MARGINS: Final = Margins()

DEFAULT_MARGINS: Final = Margins(estimator_m=0.1, following_m=0.4, correction_m=0.1, following_m_s=0.8)
"""What ArduCopter and PX4 need as they come, at the default speed and with the corrections of setpoints."""

TUBE_SCHEMA: Final[Schema] = mapping(
    "How far the vehicle may be from its path on each axis, by cause; with what `disturbance_m_s2` leaves, the sum is "
    "the tube of the proof. Without it, and without `disturbance_m_s2`, the defaults hold; where only that is given, "
    "it is all of the tube. `mission calibrate` measures these.",
    (),
    {
        "estimator_m": number("Error of the estimated position, m.", 0.0, 100.0, default=DEFAULT_MARGINS.estimator_m),
        "following_m": number(
            "How far the autopilot is behind by itself, m.", 0.0, 100.0, default=DEFAULT_MARGINS.following_m
        ),
        "correction_m": number(
            "How far setpoints may be corrected by the following error that is seen, m.",
            0.0,
            10.0,
            default=DEFAULT_MARGINS.correction_m,
        ),
        "following_m_s": number(
            "How far the velocity may be off by itself, m/s; flights are judged by it, the path is not widened.",
            0.0,
            100.0,
            default=DEFAULT_MARGINS.following_m_s,
        ),
    },
    examples=[{"estimator_m": 0.1, "following_m": 0.4, "correction_m": 0.1}],
)


def margins_of(flight: dict[str, Any]) -> Margins:
    """The margins of a mission file's section ``flight``."""
    if "tube" not in flight and "disturbance_m_s2" in flight:
        return Margins(following_m_s=DEFAULT_MARGINS.following_m_s)
    given = flight.get("tube", {})
    return Margins(
        **{key: float(given.get(key, getattr(DEFAULT_MARGINS, key))) for key in Margins.__dataclass_fields__}
    )


def disturbed_m(disturbance_m_s2: float, time_constant_s: float) -> float:
    """Bound of the position's error under a disturbance: w tau^2."""
    return disturbance_m_s2 * time_constant_s**2


def disturbed_m_s(disturbance_m_s2: float, time_constant_s: float) -> float:
    """Bound of the velocity's error under a disturbance: 2 w tau / e."""
    return 2.0 * disturbance_m_s2 * time_constant_s / math.e


def causes(disturbance_m_s2: float, time_constant_s: float, margins: Margins) -> Iterator[tuple[str, float]]:
    """Each cause that adds to the tube, in plain words, with its share in metres."""
    named = (
        (f"disturbances of {disturbance_m_s2:g} m/s²", disturbed_m(disturbance_m_s2, time_constant_s)),
        ("the estimator", margins.estimator_m),
        ("following", margins.following_m),
        ("corrections", margins.correction_m),
    )
    return ((name, share_m) for name, share_m in named if share_m > 0.0)
