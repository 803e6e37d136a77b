"""What the vehicle is asked to do at each time of a trajectory, in the domain's frame.

The trajectory is evaluated in blocks, on a grid of ``_STEP_S``; between two points of the grid runs the polynomial of
degree 5 that has position, velocity and acceleration of both. Where the trajectory is smooth it is off by h^6 / 46080
times the sixth derivative, which is rounding; at a jump of the jerk J, by less than h^3 J / 100, a hundredth of a
micrometre at 1 m/s^3.
"""

import math
from collections.abc import Callable
from typing import Final, NamedTuple, Protocol, Self

import numpy as np

from mission.geometry.arrays import FloatArray
from mission.link.field_orders import FieldOrders
from mission.link.frames import Vector, wrapped
from mission.monitor.gaps import GAP_S
from mission.plan.heading import Nose, Turned

_SETTING_OUT_S: Final = 0.2
"""After a rest: when it is seen where the vehicle flies on to, a centimetre away."""
_FACING_RAD: Final = 0.05
_STEP_S: Final = 0.01
_BLOCK: Final = 128
_MOST_BLOCKS: Final = 4


class Reference(NamedTuple):
    """A point of the trajectory: ENU, metres and seconds, height above the take-off point."""

    position_m: Vector
    velocity_m_s: Vector
    acceleration_m_s2: Vector


class Flown(Protocol):
    """A trajectory in the plane at one altitude, at rest at both ends and beyond them."""

    @property
    def duration_s(self) -> float:
        """Time from start to end; infinite where it has laps that nobody has counted."""
        ...

    @property
    def altitude_m(self) -> float:
        """Height above the take-off point."""
        ...

    def state(self, t_s: FloatArray, /) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Position, velocity and acceleration at the times (P,), each of shape (P, 2)."""
        ...

    @property
    def laps(self) -> int | None:
        """How often its lap is flown, if it has one; None where nobody has said."""
        ...

    @property
    def laps_end_s(self) -> float:
        """When the last lap is over; infinite where nobody has said how many there are, 0 where there is none."""
        ...

    def first_lap_s(self, t_s: float, /) -> float:
        """A time in a lap as that in the first lap."""
        ...

    def ended_after(self, t_s: float, /) -> Self:
        """The same up to the end of the lap that is flown at a time, then what comes after the laps."""
        ...


class Bounds(NamedTuple):
    """What keeps a flight within what was proved of it.

    Attributes:
        tube_m: How far from the trajectory the vehicle may be on each axis; 0 where nothing is known of that.
        reach_m: How much of the tube is for corrections of the setpoints.
        lean_m_s2: The acceleration that the largest tilt gives.
        acceleration_m_s2: What a change of plans may ask for.
    """

    tube_m: float = 0.0
    reach_m: float = 0.0
    lean_m_s2: float = math.inf
    acceleration_m_s2: float = 1.0


class Course:
    """A trajectory with the heading that goes with it, which is taken up no faster than the vehicle may turn.

    Attributes:
        heading_rad: The heading asked for last, clockwise from north.
        yaw_rate_rad_s: How fast it changes.
        bounds: What its flight is to stay within.
        nose: Where it looks.
        orders: What is gone by where the trajectory is not flown, but the field where the vehicle is; None else.
        waits: Whether the vehicle waits at its end for another course, and the flight does not end there.
        turned_s: Vehicle time for which the heading was asked; None before the first.
        duration_s: Time from the start of the trajectory to its end.
        altitude_m: Height above the take-off point.
    """

    def __init__(
        self,
        trajectory: Flown,
        heading_rad: float,
        bounds: Bounds | None = None,
        nose: Nose | None = None,
        orders: FieldOrders | None = None,
        *,
        planned_s: Callable[[float], float | None] | None = None,
        waits: bool = False,
    ) -> None:
        """Begin with the heading that the vehicle has.

        Args:
            trajectory: What is flown.
            heading_rad: Of the vehicle.
            bounds: What the flight is to stay within.
            nose: Where it looks.
            orders: What is gone by where the trajectory is not flown.
            planned_s: A time as one on the trajectory of the plan, None where nothing of it is flown; the same time by
                default.
            waits: Whether the vehicle waits at its end.
        """
        self._trajectory = trajectory
        self.duration_s, self.altitude_m = trajectory.duration_s, trajectory.altitude_m
        self.nose = nose or Nose()
        self.heading_rad = heading_rad
        self.yaw_rate_rad_s = 0.0
        self._taken_up = False
        self.bounds = bounds or Bounds()
        self.orders = orders
        self.waits = waits
        self._planned_s = planned_s
        self.turned_s: float | None = None
        self._blocks: dict[int, list[tuple[float, ...]]] = {}

    @property
    def trajectory(self) -> Flown:
        """What is flown."""
        return self._trajectory

    @property
    def lasts_s(self) -> float:
        """How long a flight may take that does not slow down: by the field, or where it waits, nobody knows."""
        return self.duration_s if self.orders is None and not self.waits else math.inf

    @property
    def planned(self) -> bool:
        """Whether some of a plan is flown."""
        return self.planned_s(0.0) is not None

    def planned_s(self, t_s: float) -> float | None:
        """A time as one on the trajectory of the plan; None where nothing of a plan is flown."""
        return t_s if self._planned_s is None else self._planned_s(t_s)

    def follow(self, before: "Course") -> None:
        """Go on with the heading that another one came to."""
        self.heading_rad, self.turned_s = before.heading_rad, before.turned_s

    @property
    def laps(self) -> int | None:
        """How often the lap is flown; None where nobody has said."""
        return self._trajectory.laps

    def first_lap_s(self, t_s: float) -> float:
        """A time in a lap as that in the first lap."""
        return self._trajectory.first_lap_s(t_s)

    def end_laps(self, t_s: float) -> bool:
        """Let the lap that is flown at a time be the last; nothing changes before its end.

        Returns:
            False where no lap is flown then.
        """
        if t_s >= self._trajectory.laps_end_s:
            return False
        self._trajectory = self._trajectory.ended_after(t_s)
        self.duration_s = self._trajectory.duration_s
        self._blocks.clear()
        return True

    def reference(self, t_s: float) -> Reference:
        """The point of the trajectory at a time; at rest before its start and after its end."""
        at = min(max(t_s, 0.0), self.duration_s) / _STEP_S
        point = int(at)
        number, row = divmod(point, _BLOCK)
        x0, y0, x1, y1, x2, y2, x3, y3, x4, y4, x5, y5 = (self._blocks.get(number) or self._block(number))[row]
        u, h = at - point, _STEP_S
        return Reference(
            (
                x0 + u * (x1 + u * (x2 + u * (x3 + u * (x4 + u * x5)))),
                y0 + u * (y1 + u * (y2 + u * (y3 + u * (y4 + u * y5)))),
                self.altitude_m,
            ),
            (
                (x1 + u * (2.0 * x2 + u * (3.0 * x3 + u * (4.0 * x4 + u * 5.0 * x5)))) / h,
                (y1 + u * (2.0 * y2 + u * (3.0 * y3 + u * (4.0 * y4 + u * 5.0 * y5)))) / h,
                0.0,
            ),
            (
                (2.0 * x2 + u * (6.0 * x3 + u * (12.0 * x4 + u * 20.0 * x5))) / (h * h),
                (2.0 * y2 + u * (6.0 * y3 + u * (12.0 * y4 + u * 20.0 * y5))) / (h * h),
                0.0,
            ),
        )

    def _block(self, number: int) -> list[tuple[float, ...]]:
        """What each quintic of one block of the grid is, which starts at each of its points (``_quintics``)."""
        times = np.arange(number * _BLOCK, (number + 1) * _BLOCK + 1, dtype=np.float64) * _STEP_S
        found = _quintics(*self._trajectory.state(times))
        while len(self._blocks) >= _MOST_BLOCKS:
            del self._blocks[next(iter(self._blocks))]
        self._blocks[number] = found
        return found

    def turn(self, reference: Reference, t_s: float, now_s: float) -> float:
        """The heading at ``now_s``, on the way to the one wanted at the time ``t_s``, where ``reference`` is."""
        elapsed = 0.0 if self.turned_s is None else min(max(now_s - self.turned_s, 0.0), GAP_S)
        self.turned_s = now_s
        wanted = self.wanted(reference, t_s)
        if wanted is None:
            self.yaw_rate_rad_s = 0.0
            return self.heading_rad
        fastest = self.nose.rate_rad_s
        off, most = wrapped(wanted.heading_rad - self.heading_rad), fastest * elapsed
        self.heading_rad = wrapped(self.heading_rad + min(max(off, -most), most))
        if abs(off) <= most:
            self._taken_up = True
            self.yaw_rate_rad_s = min(max(wanted.rate_rad_s, -fastest), fastest)
        else:
            self.yaw_rate_rad_s = math.copysign(fastest, off) if elapsed > 0.0 else 0.0
        return self.heading_rad

    def faces(self, yaw_rad: float | None) -> bool:
        """Whether a vehicle with this yaw, None where it told none, looks where it is to look before it sets out."""
        if self.nose.heading is None or yaw_rad is None:
            return True
        return self._taken_up and abs(wrapped(yaw_rad - self.heading_rad)) <= _FACING_RAD

    def wanted(self, reference: Reference, t_s: float) -> Turned | None:
        """Where the nose is to look at a time, where ``reference`` is; None where it stays as it is.

        At rest that is where the vehicle sets out to, where the mission says that the nose goes with the flight.
        """
        once_s = self.first_lap_s(t_s)
        position, velocity, acceleration = (vector[:2] for vector in reference)
        found = self.nose.at(once_s, position, velocity, acceleration)
        if found is not None:
            return found
        left_s = self.nose.rest_left_s(once_s)
        if left_s is None or self.orders is not None:
            return None
        later_s = t_s + left_s + _SETTING_OUT_S
        onward = self.reference(later_s)
        found = self.nose.at(self.first_lap_s(later_s), onward.position_m[:2], onward.velocity_m_s[:2])
        return None if found is None else found._replace(rate_rad_s=0.0)


def _quintics(position: FloatArray, velocity: FloatArray, acceleration: FloatArray) -> list[tuple[float, ...]]:
    """The quintics between points of the grid that follow each other, by the share of the way from one to the next.

    Args:
        position: At the points, shape (P, 2), metres; likewise the others.
        velocity: m/s.
        acceleration: m/s^2.

    Returns:
        P - 1 rows: the coefficients of the power 0 for x and y, then those of the power 1, up to 5.
    """
    h = _STEP_S
    c0, c1, c2 = position[:-1], h * velocity[:-1], 0.5 * h * h * acceleration[:-1]
    d = position[1:] - c0 - c1 - c2
    v = h * velocity[1:] - c1 - 2.0 * c2
    a = h * h * acceleration[1:] - 2.0 * c2
    c3, c4, c5 = 10.0 * d - 4.0 * v + 0.5 * a, -15.0 * d + 7.0 * v - a, 6.0 * d - 3.0 * v + 0.5 * a
    return list(map(tuple, np.concatenate((c0, c1, c2, c3, c4, c5), axis=1).tolist()))
