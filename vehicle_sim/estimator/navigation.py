"""Position and velocity by a Kalman filter (filterpy), with the measured acceleration as its input.

A fix arrives late but says when it was taken, so the filter runs behind: its horizon is the time of the last
measurement taken, the accelerations since are kept, and those until the next measurement carry the filter there. What
the vehicle is told is the state at the horizon carried on to now by all that are kept, in closed form and just as the
filter will do it later: only the covariance waits. Measurements are taken in the order of their own times; the
barometer's wait for a fix that may be older, for a quarter of a second at most (the longest lag that ArduPilot's and
PX4's filters bear), and a fix older than the horizon comes too late.
"""

from collections import deque
from collections.abc import Iterable
from math import sqrt
from typing import Final, NamedTuple

import numpy as np

from vehicle_sim.estimator.innovation import normalised_square
from vehicle_sim.estimator.process import (
    STATES,
    A,
    B,
    D,
    G,
    M,
    Matrix,
    NavigationTuning,
    P,
    Process,
    V,
    first_covariance,
    from_body,
)
from vehicle_sim.geodesy import ned_offset_m
from vehicle_sim.signals import BaroReading, Geodetic, GpsReading, Vector

_ROWS: Final = 7
_FIX_3D: Final = 3
_POSITION, _HEIGHT, _VELOCITY, _BARO = slice(0, 2), slice(2, 3), slice(3, 6), slice(6, 7)
_GPS_GROUPS: Final = ((0, _POSITION), (1, _HEIGHT), (2, _VELOCITY))
_BARO_GROUP: Final = ((3, _BARO),)
# 99.9999 % points of chi-square with 2, 1, 3 and 1 degrees of freedom: a real error practically never meets them.
_GATES: Final = (27.6, 23.9, 30.7, 23.9)
_LONGEST_EPOCH_STEPS: Final = 10
_RESET_VARIANCE_M2: Final = 1e4
_RESET_VARIANCE_M2_S2: Final = 1e2
_SHARP: Final = 0.7
"""Horizontal dilution of precision of the sky that the noise of the tuning belongs to."""


class Levelling(NamedTuple):
    """What the filter hands over to the attitude reference.

    `north_m_s2` and `east_m_s2` are an error of the acceleration that is a tilt, `forward_m_s3` and `right_m_s3` its
    growth in body axes, which is a bias of the gyros, and `bias_m_s2` is one of the accelerometers.
    """

    north_m_s2: float
    east_m_s2: float
    forward_m_s3: float
    right_m_s3: float
    bias_m_s2: Vector

    def joined(self, other: "Levelling") -> "Levelling":
        """Return both together."""
        mine, its = self.bias_m_s2, other.bias_m_s2
        return Levelling(
            self.north_m_s2 + other.north_m_s2,
            self.east_m_s2 + other.east_m_s2,
            self.forward_m_s3 + other.forward_m_s3,
            self.right_m_s3 + other.right_m_s3,
            (mine[0] + its[0], mine[1] + its[1], mine[2] + its[2]),
        )


_LEVEL: Final = Levelling(0.0, 0.0, 0.0, 0.0, (0.0, 0.0, 0.0))


Pushed = tuple[float, float, float, float, float, float]
"""Position and velocity (NED) that measured accelerations have added since the horizon."""

_UNPUSHED: Final[Pushed] = (0.0, 0.0, 0.0, 0.0, 0.0, 0.0)


def _carried(pushed: Pushed, accelerations: Iterable[Vector], step_s: float) -> Pushed:
    """Return what has been added after further steps, each of constant acceleration."""
    half = 0.5 * step_s * step_s
    p_n, p_e, p_d, v_n, v_e, v_d = pushed
    for a_n, a_e, a_d in accelerations:
        p_n += v_n * step_s + a_n * half
        p_e += v_e * step_s + a_e * half
        p_d += v_d * step_s + a_d * half
        v_n += a_n * step_s
        v_e += a_e * step_s
        v_d += a_d * step_s
    return p_n, p_e, p_d, v_n, v_e, v_d


class NavigationFilter:
    """The running filter of one vehicle.

    `position_taken_s` is when a GPS position was taken that last passed its gate, `ratios` are the latest innovation
    test ratios (horizontal position, height, velocity, barometer), 1 at the gate.
    """

    def __init__(
        self,
        tuning: NavigationTuning,
        *,
        step_s: float,
        time_s: float,
        origin: Geodetic,
        fixes: int,
        baro_zero_m: float,
        attitude_rad: Vector,
    ) -> None:
        """Start at `time_s` where the vehicle stands.

        `origin` is the mean of so many `fixes`, `baro_zero_m` what the barometer shows there, `attitude_rad` are the
        roll, pitch and yaw at which it was levelled.
        """
        self.origin: Final = origin
        self.started_s: Final = time_s
        self.position_taken_s = time_s
        self.ratios = [0.0] * len(_GATES)
        self._horizon = round(time_s / step_s)
        self._kept: list[Vector] = []
        self._attitudes: list[Vector] = []
        self._attitude_rad = attitude_rad
        self._baros: deque[BaroReading] = deque()
        self._longest_lag = round(tuning.longest_lag_s / step_s)
        self._tuning = tuning
        self._step_s = step_s
        self._baro_zero_m = baro_zero_m
        self._process = Process(tuning, step_s=step_s)
        self._measurements = {
            (with_gps, with_baro): self._measurement_model(gps=with_gps, baro=with_baro)
            for with_gps in (False, True)
            for with_baro in (False, True)
        }
        # Mean after the last update, as plain numbers, and what acceleration has added since.
        self._mean = [0.0] * STATES
        self._pushed = _UNPUSHED
        from filterpy.kalman import KalmanFilter  # noqa: PLC0415 - as long in loading as all the rest of a vehicle

        self._filter = KalmanFilter(dim_x=STATES, dim_z=_ROWS, dim_u=6)
        self._filter.x = np.zeros((STATES, 1))
        self._filter.P = first_covariance(tuning, attitude_rad, fixes)

    @property
    def covariance(self) -> Matrix:
        """Covariance (18, 18) of the state as it is now."""
        f, q = self._process.epoch(len(self._kept), self._attitude_rad, self._pushed)
        covariance: Matrix = f @ self._filter.P @ f.T + q
        return covariance

    @property
    def variances(self) -> list[float]:
        """Variances of the 18 states at the last measurement taken."""
        variances: list[float] = self._filter.P.diagonal().tolist()
        return variances

    def advance(
        self,
        acceleration_ned_m_s2: Vector,
        attitude_rad: Vector,
        gps: GpsReading | None,
        baro: BaroReading | None,
    ) -> Levelling | None:
        """Go on by one step of constant measured acceleration, with what has arrived at its end.

        Returns:
            None where no measurement was due. Else what has been taken out of the state, for the caller to level by:
            the prediction is the same whether the filter or the attitude holds it.
        """
        self._pushed = _carried(self._pushed, (acceleration_ned_m_s2,), self._step_s)
        kept, step_s = self._kept, self._step_s
        kept.append(acceleration_ned_m_s2)
        self._attitudes.append(attitude_rad)
        self._attitude_rad = attitude_rad
        if baro is not None:
            self._baros.append(baro)
        limit = self._horizon + len(kept) - self._longest_lag
        if gps is not None:
            taken = round(gps.time_s / step_s)
            if taken > self._horizon:
                return self._take(taken, gps)
        if self._baros and round(self._baros[0].time_s / step_s) <= limit:
            return self._take(limit, None)
        if limit - self._horizon >= _LONGEST_EPOCH_STEPS:
            return self._close(limit, None, None)
        return None

    def _take(self, until: int, gps: GpsReading | None) -> Levelling:
        """Take the measurements up to step `until`, in order; the fix is the last of them."""
        levelling = _LEVEL
        baros, step_s = self._baros, self._step_s
        while baros and (taken := round(baros[0].time_s / step_s)) <= until:
            baro = baros.popleft()
            if taken <= self._horizon:
                continue
            is_last = gps is not None and taken == until
            levelling = levelling.joined(self._close(taken, gps if is_last else None, baro))
            gps = None if is_last else gps
        if gps is not None:
            levelling = levelling.joined(self._close(until, gps, None))
        return levelling

    def mean(self) -> tuple[Vector, Vector, Vector]:
        """Return position, velocity and error of the acceleration as they are now."""
        mean, t = self._mean, len(self._kept) * self._step_s
        half = 0.5 * t * t
        dp_n, dp_e, dp_d, dv_n, dv_e, dv_d = self._pushed
        b_n, b_e = mean[6], mean[7]
        return (
            (
                mean[0] + t * mean[3] + dp_n - half * b_n,
                mean[1] + t * mean[4] + dp_e - half * b_e,
                mean[2] + t * mean[5] + dp_d,
            ),
            (mean[3] + dv_n - t * b_n, mean[4] + dv_e - t * b_e, mean[5] + dv_d),
            (b_n, b_e, 0.0),
        )

    def _close(self, until: int, gps: GpsReading | None, baro: BaroReading | None) -> Levelling:
        """Move the horizon to step `until` and take the measurements of that time."""
        kalman, steps, kept = self._filter, until - self._horizon, self._kept
        self._horizon = until
        self._pushed = _carried(_UNPUSHED, kept[:steps], self._step_s)
        f, q = self._process.epoch(steps, self._attitudes[steps // 2], self._pushed)
        kalman.predict(u=np.array(self._pushed).reshape(6, 1), B=self._process.input, F=f, Q=q)
        if gps is not None or baro is not None:
            self._correct(gps, baro)
        return self._level(steps)

    def _level(self, steps: int) -> Levelling:
        """Take out of the state, for the attitude reference, what may be held there as well."""
        x, share = self._filter.x, min(steps * self._step_s / self._tuning.levelling_s, 1.0)
        bias = x[A, 0].copy()
        north, east = share * float(x[6, 0]), share * float(x[7, 0])
        forward, right = x[D, 0].tolist()
        levelling = Levelling(north, east, forward, right, (float(bias[0]), float(bias[1]), float(bias[2])))
        x[B, 0] *= 1.0 - share
        x[A, 0] = x[D, 0] = 0.0
        self._mean = x[:, 0].tolist()
        # What was measured since has the errors that will be measured no more.
        wrong_n, wrong_e, wrong_d = (from_body(self._attitude_rad) @ bias + (north, east, 0.0)).tolist()
        self._kept = [(a - wrong_n, b - wrong_e, c - wrong_d) for a, b, c in self._kept[steps:]]
        del self._attitudes[:steps]
        self._pushed = _carried(_UNPUSHED, self._kept, self._step_s)
        return levelling

    def _measurement_model(self, *, gps: bool, baro: bool) -> tuple[Matrix, Matrix]:
        """Return H (7, 18) and R (7, 7); the rows of a sensor that has nothing new are zero and tell nothing."""
        tuning = self._tuning
        h, r = np.zeros((_ROWS, STATES)), np.eye(_ROWS)
        if gps:
            h[:3, P] = h[:3, G] = np.eye(3)
            h[_VELOCITY, V] = np.eye(3)
            r[_POSITION, _POSITION] *= tuning.gps_noise_m**2
            r[_HEIGHT, _HEIGHT] *= tuning.gps_vertical_noise_m**2
            r[_VELOCITY, _VELOCITY] *= tuning.gps_velocity_noise_m_s**2
        if baro:
            h[_BARO, 2], h[_BARO, M] = 1.0, -1.0
            r[_BARO, _BARO] *= tuning.baro_noise_m**2
        return h, r

    def _correct(self, gps: GpsReading | None, baro: BaroReading | None) -> None:
        """Take the measurements, each group only if it passes its gate."""
        kalman, z = self._filter, np.zeros((_ROWS, 1))
        groups: tuple[tuple[int, slice], ...] = ()
        if gps is not None and gps.fix_type >= _FIX_3D:
            z[:3, 0] = ned_offset_m(self.origin, gps.position)
            z[3:6, 0] = gps.velocity_ned_m_s
            groups += _GPS_GROUPS
        if baro is not None:
            z[6, 0] = self._baro_zero_m - baro.altitude_m
            groups += _BARO_GROUP
        h, r = self._measurements[len(groups) >= len(_GPS_GROUPS), baro is not None]
        if gps is not None and gps.hdop != _SHARP:
            r = r.copy()
            r[:3, :3] *= (gps.hdop / _SHARP) ** 2  # few satellites, and the receiver says so
        innovation = (z - h @ kalman.x)[:, 0].tolist()
        spread = (h @ kalman.P @ h.T + r).tolist()
        refused = []
        for index, rows in groups:
            nis = normalised_square(innovation[rows], [row[rows] for row in spread[rows]])
            self.ratios[index] = sqrt(nis / _GATES[index])
            if nis > _GATES[index]:
                refused.append(rows)
            elif rows is _POSITION and gps is not None:
                self.position_taken_s = gps.time_s
        if refused:
            h, r = h.copy(), r.copy()
            for rows in refused:
                z[rows], h[rows], r[rows, rows] = 0.0, 0.0, np.eye(rows.stop - rows.start)
            if _POSITION in refused and self._horizon * self._step_s - self.position_taken_s > self._tuning.reset_gps_s:
                # A position that insists for so long is believed, with its velocity: the next fix will pass.
                kalman.P[_POSITION, _POSITION] += _RESET_VARIANCE_M2 * np.eye(2)
                kalman.P[V, V] += _RESET_VARIANCE_M2_S2 * np.eye(3)
        kalman.update(z, R=r, H=h)
