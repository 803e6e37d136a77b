"""A double integrator that tracks the smoothed path, as the paper has it, and exactly.

The vehicle is x = (position, velocity) with x' = A x + B u, accelerations for controls (Eq. 5). Its error is
e = x - (r, v) against the steering law (Eq. 10), and u = -K e + v' (Eq. 12) with K = [I / tau^2, 2 I / tau] leaves
e' = (A - B K) e (Eq. 11), critically damped: both eigenvalues of each axis are -1 / tau. So nothing has to be
integrated: with e the error of an axis and d its rate,

    e(t) = (e(0) + c t) exp(-t / tau),  d(t) = (c - (e(0) + c t) / tau) exp(-t / tau),  c = d(0) + e(0) / tau.

A mission that is guided by fields in triangles that move has these for its steering law, carried over by time and not
smoothed: where the velocity of that jumps, d jumps by as much, and the closed form begins again.
"""

import math
from dataclasses import dataclass
from typing import Final

import numpy as np

from mission.geometry.arrays import FloatArray
from mission.monitor.flight import FlightMonitor
from mission.monitor.monitor import Monitor
from mission.monitor.stage import Stage
from mission.plan import FlightPlan
from mission.plan.carried import carried_path, is_carried
from mission.spec.model import Point
from mission.steering.moving_path import MovingPath
from mission.steering.trajectory import Trajectory

_EVERY_S: Final = 0.05
_MOST_SAMPLES: Final = 100_000
SETTLED: Final = 0.02
"""Of the error at the start: what is left of it once the loop has settled."""


@dataclass(frozen=True, eq=False)
class Simulation:
    """A simulated flight along a trajectory; ENU in the domain's frame, one row for each of N times.

    Attributes:
        t_s: Time on the trajectory, shape (N,), evenly spaced, from its start to its end.
        time_constant_s: tau.
        asked_position_m: r of the smoothed steering law, shape (N, 2).
        asked_velocity_m_s: v, shape (N, 2).
        asked_acceleration_m_s2: v', shape (N, 2).
        error_m: Position less r, shape (N, 2).
        velocity_error_m_s: Velocity less v, shape (N, 2).
    """

    t_s: FloatArray
    time_constant_s: float
    asked_position_m: FloatArray
    asked_velocity_m_s: FloatArray
    asked_acceleration_m_s2: FloatArray
    error_m: FloatArray
    velocity_error_m_s: FloatArray

    @property
    def position_m(self) -> FloatArray:
        """Where the vehicle is, shape (N, 2)."""
        return self.asked_position_m + self.error_m

    @property
    def velocity_m_s(self) -> FloatArray:
        """How fast it is, shape (N, 2)."""
        return self.asked_velocity_m_s + self.velocity_error_m_s

    @property
    def gain(self) -> FloatArray:
        """K of Eq. 12, shape (2, 4): 1/s^2 for positions, 1/s for velocities."""
        return np.hstack((np.eye(2) / self.time_constant_s**2, 2.0 * np.eye(2) / self.time_constant_s))

    @property
    def control_m_s2(self) -> FloatArray:
        """The control u of Eq. 12, shape (N, 2)."""
        error = np.hstack((self.error_m, self.velocity_error_m_s))
        return np.asarray(self.asked_acceleration_m_s2 - error @ self.gain.T)

    @property
    def distance_m(self) -> FloatArray:
        """How far the vehicle is from where the steering law is, shape (N,)."""
        return np.asarray(np.hypot(*self.error_m.T))

    def settled_s(self, left_m: float) -> float:
        """From when on the vehicle is never farther than that from the steering law; infinite where it still is."""
        late = np.flatnonzero(self.distance_m > left_m)
        if not len(late):
            return 0.0
        return float(self.t_s[late[-1] + 1]) if late[-1] + 1 < len(self.t_s) else math.inf


def simulate_plan(plan: FlightPlan, *, off_m: Point = (0.0, 0.0)) -> Simulation:
    """Fly a plan's trajectory with the paper's vehicle and its tracking law.

    The vehicle begins where the mission starts, with the velocity of the file, which may be beside the smoothed path:
    the even extension of the Fourier series moves its start. A flight of laps without an end is one of a single lap.

    Args:
        plan: The plan; its ``time_constant_s`` is tau.
        off_m: How far beside its start the vehicle begins, ENU, metres.

    Returns:
        The flight, a row at least every 0.05 s, or 100,000 of them.

    Raises:
        NoPlanError: A triangle through which fields lead moves faster than the vehicle may fly.
    """
    law, tau = _steering_law(plan), plan.spec.flight.time_constant_s
    count = min(_MOST_SAMPLES, math.ceil(law.duration_s / _EVERY_S) + 1)
    t_s = np.linspace(0.0, law.duration_s, max(count, 2))
    position, velocity, acceleration = law.state(t_s)
    error = np.add(plan.start_m, off_m) - position[0]
    rate = np.asarray(plan.spec.start.velocity_m_s) - velocity[0]
    knots_s, jumps = (law.knots_s, law.jumps_m_s) if isinstance(law, MovingPath) else (t_s[[0, -1]], np.empty((0, 2)))
    errors, rates = _errors(t_s, tau, (error, rate), knots_s, jumps)
    return Simulation(t_s, tau, position, velocity, acceleration, errors, rates)


def _steering_law(plan: FlightPlan) -> Trajectory | MovingPath:
    """What is tracked: the trajectory, or the path of the fields in triangles that move."""
    if is_carried(plan):
        return carried_path(plan)
    trajectory = plan.trajectory
    return trajectory if trajectory.laps is not None else trajectory.ended_after(0.0)


def _errors(
    t_s: FloatArray, tau: float, begins: tuple[FloatArray, FloatArray], knots_s: FloatArray, jumps_m_s: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """The error and its rate at times (N,), both (N, 2).

    Args:
        t_s: Ascending.
        tau: The time constant.
        begins: Both at the first knot, each of shape (2,).
        knots_s: Shape (P + 1,), between which the velocity of the steering law is continuous.
        jumps_m_s: By how much it jumps at the inner ones, shape (P - 1, 2).
    """
    rows = np.searchsorted(t_s, knots_s[:-1]).tolist()
    error, rate = begins
    found = []
    for number, (row, until) in enumerate(zip(rows, [*rows[1:], len(t_s)], strict=True)):
        times = np.append(t_s[row:until], knots_s[number + 1]) - knots_s[number]
        errors, rates = _decaying(times, tau, error, rate)
        found.append((errors[:-1], rates[:-1]))
        if number < len(jumps_m_s):
            error, rate = errors[-1], rates[-1] - jumps_m_s[number]
    errors, rates = (np.concatenate(each) for each in zip(*found, strict=True))
    return errors, rates


def _decaying(t_s: FloatArray, tau: float, error: FloatArray, rate: FloatArray) -> tuple[FloatArray, FloatArray]:
    """The closed form, for times (N,) from those of the error and its rate on."""
    slope = rate + error / tau
    decay = np.exp(-t_s / tau)[:, None]
    left = (error + slope * t_s[:, None]) * decay
    return left, slope * decay - left / tau


def judged(plan: FlightPlan, simulation: Simulation) -> Monitor:
    """The monitor of the plan after it has seen all of the simulated flight."""
    watch = FlightMonitor(plan)
    for t_s, (east, north) in zip(simulation.t_s.tolist(), simulation.position_m.tolist(), strict=True):
        watch.report(Stage.FLY, t_s, (east, north))
    return watch.monitor
