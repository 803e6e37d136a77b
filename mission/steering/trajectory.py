"""The trajectory that the vehicle tracks: a curve, flown by a time law, at one altitude."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from numpy.typing import ArrayLike

from mission.geometry.arrays import FloatArray
from mission.steering.smoothing import FourierCurve
from mission.steering.timing import TimeLaw


@dataclass(frozen=True, eq=False)
class Trajectory:
    """Analytic position, velocity and acceleration over time, ENU in the domain's frame; at rest outside its span.

    Attributes:
        curve: The smoothed path r(s).
        law: The time law s = sigma(t).
        altitude_m: Height above the take-off point.
    """

    curve: FourierCurve
    law: TimeLaw
    altitude_m: float

    @property
    def duration_s(self) -> float:
        """Time from start to end, stops included."""
        return self.law.duration_s

    def position(self, t_s: ArrayLike) -> FloatArray:
        """Position r(sigma(t)) at the times ``t_s`` (P,), shape (P, 2), metres."""
        return self.curve.position(self.law.parameter(t_s))

    def velocity(self, t_s: ArrayLike) -> FloatArray:
        """Velocity r' sigma' at the times ``t_s`` (P,), shape (P, 2), m/s."""
        return self.state(t_s)[1]

    def acceleration(self, t_s: ArrayLike) -> FloatArray:
        """Acceleration r'' sigma'^2 + r' sigma'' at the times ``t_s`` (P,), shape (P, 2), m/s^2."""
        return self.state(t_s)[2]

    def state(self, t_s: ArrayLike) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Position, velocity and acceleration at the times ``t_s`` (P,), each of shape (P, 2)."""
        s, rate, growth = self.law.jet(t_s)
        position, slope, bend = self.curve.jet(s)
        rates = rate[:, None]
        return position, slope * rates, bend * rates**2 + slope * growth[:, None]

    def to_json(self) -> dict[str, Any]:
        """The trajectory as JSON values; ``from_json`` gives it back bit by bit."""
        return {"curve": self.curve.to_json(), "law": self.law.to_json(), "altitude_m": self.altitude_m}

    @staticmethod
    def from_json(data: Mapping[str, Any]) -> "Trajectory":
        """The trajectory that ``to_json`` wrote; raises KeyError, TypeError or ValueError where it is not one."""
        return Trajectory(
            FourierCurve.from_json(data["curve"]), TimeLaw.from_json(data["law"]), float(data["altitude_m"])
        )
