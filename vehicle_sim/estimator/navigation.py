"""Position and velocity by a Kalman filter (filterpy), with the measured acceleration as its input.

State (13): position (3), velocity (3), error of the acceleration (3), slow GPS error (3), barometer error (1); all NED,
relative to the origin, which is where the GPS said the vehicle was when the filter started.

A fix arrives late but says when it was taken, so the filter runs behind: its horizon is the time of the last
measurement taken, the accelerations since are kept, and those until the next measurement carry the filter there. What
the vehicle is told is the state at the horizon carried on to now by all that are kept, in closed form and just as the
filter will do it later: only the covariance waits. Measurements are taken in the order of their own times; the
barometer's wait for a fix that may be older, for a quarter of a second at most (the longest lag that ArduPilot's and
PX4's filters bear), and a fix older than the horizon comes too late.

The slow GPS error is a state because it cannot be averaged away: without it the filter would claim centimetres that it
does not have. The barometer's error is a random walk, relative to what it showed at the start.
"""

from collections import deque
from dataclasses import dataclass
from math import exp, sqrt
from typing import Final

import numpy as np
from filterpy.kalman import KalmanFilter
from numpy.typing import NDArray

from vehicle_sim.geodesy import ned_offset_m
from vehicle_sim.signals import BaroReading, GpsReading, Vector

_STATES: Final = 13
_P, _V, _B, _G, _M = slice(0, 3), slice(3, 6), slice(6, 9), slice(9, 12), 12
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


@dataclass(frozen=True, slots=True, kw_only=True)
class NavigationTuning:
    """What the filter believes of its sensors: standard deviations, correlation time, walks per root second."""

    acceleration_m_s2: float = 0.055
    acceleration_walk: float = 0.004
    acceleration_start_m_s2: float = 0.07
    velocity_start_m_s: float = 0.05
    gps_noise_m: float = 0.2
    gps_vertical_noise_m: float = 0.35
    gps_wander_m: float = 0.2
    gps_vertical_wander_m: float = 0.3
    gps_wander_time_s: float = 60.0
    gps_velocity_noise_m_s: float = 0.08
    baro_noise_m: float = 0.15
    baro_walk: float = 0.03
    longest_lag_s: float = 0.25
    reset_gps_s: float = 7.0
    levelling_s: float = 5.0


class NavigationFilter:
    """The running filter of one vehicle.

    `position_taken_s` is when a GPS position was taken that last passed its gate, `ratios` are the latest innovation
    test ratios (horizontal position, height, velocity, barometer), 1 at the gate.
    """

    def __init__(
        self, tuning: NavigationTuning, *, step_s: float, time_s: float, origin: GpsReading, baro_zero_m: float
    ) -> None:
        """Start at `time_s` where the vehicle stands, which `origin`, a fix, tells, and the barometer `baro_zero_m`."""
        self.origin: Final = origin.position
        self.started_s: Final = time_s
        self.position_taken_s = time_s
        self.ratios = [0.0] * len(_GATES)
        self._horizon = round(time_s / step_s)
        self._kept: list[Vector] = []
        self._baros: deque[BaroReading] = deque()
        self._longest_lag = round(tuning.longest_lag_s / step_s)
        self._tuning = tuning
        self._step_s = step_s
        self._baro_zero_m = baro_zero_m
        self._models: dict[int, tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]] = {}
        self._measurements = {
            (with_gps, with_baro): self._measurement_model(gps=with_gps, baro=with_baro)
            for with_gps in (False, True)
            for with_baro in (False, True)
        }
        # Mean after the last update, as plain numbers, and what acceleration has added since.
        self._mean = [0.0] * _STATES
        self._pushed = [0.0] * 6
        self._filter = KalmanFilter(dim_x=_STATES, dim_z=_ROWS, dim_u=6)
        self._filter.x = np.zeros((_STATES, 1))
        self._filter.P = self._first_covariance()

    def _first_covariance(self) -> NDArray[np.float64]:
        tuning = self._tuning
        # The origin makes the first fix zero: what the fix was wrong by is now the error of the position, negated.
        wander = np.array([tuning.gps_wander_m, tuning.gps_wander_m, tuning.gps_vertical_wander_m]) ** 2
        noise = np.array([tuning.gps_noise_m, tuning.gps_noise_m, tuning.gps_vertical_noise_m]) ** 2
        covariance = np.zeros((_STATES, _STATES))
        covariance[_P, _P] = np.diag(wander + noise)
        covariance[_P, _G] = covariance[_G, _P] = -np.diag(wander)
        covariance[_G, _G] = np.diag(wander)
        covariance[_V, _V] = np.eye(3) * tuning.velocity_start_m_s**2
        covariance[_B, _B] = np.eye(3) * tuning.acceleration_start_m_s2**2
        # The barometer's zero was taken here, so its error begins as that of the height.
        covariance[_M, _M] = wander[2] + noise[2] + tuning.baro_noise_m**2
        covariance[2, _M] = covariance[_M, 2] = wander[2] + noise[2]
        covariance[_G.start + 2, _M] = covariance[_M, _G.start + 2] = -wander[2]
        return covariance

    @property
    def covariance(self) -> NDArray[np.float64]:
        """Covariance (13, 13) of the state as it is now."""
        f, _, q = self._model(len(self._kept))
        covariance: NDArray[np.float64] = f @ self._filter.P @ f.T + q
        return covariance

    @property
    def variances(self) -> list[float]:
        """Variances of the 13 states at the last measurement taken."""
        variances: list[float] = self._filter.P.diagonal().tolist()
        return variances

    def advance(
        self, acceleration_ned_m_s2: Vector, gps: GpsReading | None, baro: BaroReading | None
    ) -> tuple[float, float] | None:
        """Go on by one step of constant measured acceleration, with what has arrived at its end.

        Returns:
            None where no measurement was due. Else the error of the acceleration (north, east, m/s^2) that has been
            taken out of the state, to be bled into the tilt by the caller: the prediction is the same whether the one
            or the other holds it.
        """
        self._push(acceleration_ned_m_s2)
        kept, step_s = self._kept, self._step_s
        kept.append(acceleration_ned_m_s2)
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

    def _push(self, acceleration_ned_m_s2: Vector) -> None:
        """Carry the sums of the accelerations kept on by one more."""
        dt, pushed = self._step_s, self._pushed
        half = 0.5 * dt * dt
        for axis, a in enumerate(acceleration_ned_m_s2):
            pushed[axis] += pushed[axis + 3] * dt + a * half
            pushed[axis + 3] += a * dt

    def _take(self, until: int, gps: GpsReading | None) -> tuple[float, float]:
        """Take the measurements up to step `until`, in order; the fix is the last of them."""
        north = east = 0.0
        baros, step_s = self._baros, self._step_s
        while baros and (taken := round(baros[0].time_s / step_s)) <= until:
            baro = baros.popleft()
            if taken <= self._horizon:
                continue
            is_last = gps is not None and taken == until
            bled = self._close(taken, gps if is_last else None, baro)
            north, east = north + bled[0], east + bled[1]
            gps = None if is_last else gps
        if gps is not None:
            bled = self._close(until, gps, None)
            north, east = north + bled[0], east + bled[1]
        return north, east

    def mean(self) -> tuple[Vector, Vector, Vector]:
        """Return position, velocity and error of the acceleration as they are now."""
        mean, t = self._mean, len(self._kept) * self._step_s
        half = 0.5 * t * t
        dp_n, dp_e, dp_d, dv_n, dv_e, dv_d = self._pushed
        b_n, b_e, b_d = mean[6], mean[7], mean[8]
        return (
            (
                mean[0] + t * mean[3] + dp_n - half * b_n,
                mean[1] + t * mean[4] + dp_e - half * b_e,
                mean[2] + t * mean[5] + dp_d - half * b_d,
            ),
            (mean[3] + dv_n - t * b_n, mean[4] + dv_e - t * b_e, mean[5] + dv_d - t * b_d),
            (b_n, b_e, b_d),
        )

    def _model(self, steps: int) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]:
        """Return F (13, 13), B (13, 6) and Q (13, 13) of an epoch of so many steps."""
        if (known := self._models.get(steps)) is not None:
            return known
        tuning, t, eye = self._tuning, steps * self._step_s, np.eye(3)
        f = np.eye(_STATES)
        f[_P, _V], f[_P, _B], f[_V, _B] = t * eye, -0.5 * t * t * eye, -t * eye
        decay = exp(-t / tuning.gps_wander_time_s)
        f[_G, _G] = decay * eye
        b = np.zeros((_STATES, 6))
        b[:6, :6] = np.eye(6)
        # White acceleration noise and a random walk of its error, both integrated over the epoch.
        white, walk = tuning.acceleration_m_s2**2 * self._step_s, tuning.acceleration_walk**2
        q = np.zeros((_STATES, _STATES))
        q[_P, _P] = (white * t**3 / 3.0 + walk * t**5 / 20.0) * eye
        q[_P, _V] = q[_V, _P] = (white * t**2 / 2.0 + walk * t**4 / 8.0) * eye
        q[_V, _V] = (white * t + walk * t**3 / 3.0) * eye
        q[_P, _B] = q[_B, _P] = -walk * t**3 / 6.0 * eye
        q[_V, _B] = q[_B, _V] = -walk * t**2 / 2.0 * eye
        q[_B, _B] = walk * t * eye
        wander = np.array([tuning.gps_wander_m, tuning.gps_wander_m, tuning.gps_vertical_wander_m]) ** 2
        q[_G, _G] = np.diag(wander) * (1.0 - decay * decay)
        q[_M, _M] = tuning.baro_walk**2 * t
        self._models[steps] = (f, b, q)
        return self._models[steps]

    def _close(self, until: int, gps: GpsReading | None, baro: BaroReading | None) -> tuple[float, float]:
        """Move the horizon to step `until` and take the measurements of that time."""
        kalman, steps, kept = self._filter, until - self._horizon, self._kept
        self._horizon = until
        self._sum(kept[:steps])
        f, b, q = self._model(steps)
        kalman.predict(u=np.array(self._pushed).reshape(6, 1), B=b, F=f, Q=q)
        if gps is not None or baro is not None:
            self._correct(gps, baro)
        share = min(steps * self._step_s / self._tuning.levelling_s, 1.0)
        north, east = share * float(kalman.x[6, 0]), share * float(kalman.x[7, 0])
        kalman.x[6, 0] -= north
        kalman.x[7, 0] -= east
        self._mean = kalman.x[:, 0].tolist()
        # What was measured since with the old tilt has the error that the new tilt will not have.
        self._kept = [(a - north, b - east, c) for a, b, c in kept[steps:]]
        self._sum(self._kept)
        return north, east

    def _sum(self, accelerations: list[Vector]) -> None:
        self._pushed = [0.0] * 6
        for acceleration in accelerations:
            self._push(acceleration)

    def _measurement_model(self, *, gps: bool, baro: bool) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Return H (7, 13) and R (7, 7); the rows of a sensor that has nothing new are zero and tell nothing."""
        tuning = self._tuning
        h, r = np.zeros((_ROWS, _STATES)), np.eye(_ROWS)
        if gps:
            h[:3, _P] = h[:3, _G] = np.eye(3)
            h[_VELOCITY, _V] = np.eye(3)
            r[_POSITION, _POSITION] *= tuning.gps_noise_m**2
            r[_HEIGHT, _HEIGHT] *= tuning.gps_vertical_noise_m**2
            r[_VELOCITY, _VELOCITY] *= tuning.gps_velocity_noise_m_s**2
        if baro:
            h[_BARO, 2], h[_BARO, _M] = 1.0, -1.0
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
        innovation = z - h @ kalman.x
        spread = h @ kalman.P @ h.T + r
        refused = []
        for index, rows in groups:
            y, s = innovation[rows], spread[rows, rows]
            nis = float(y[0, 0] ** 2 / s[0, 0]) if y.size == 1 else float((y.T @ np.linalg.inv(s) @ y)[0, 0])
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
                kalman.P[_V, _V] += _RESET_VARIANCE_M2_S2 * np.eye(3)
        kalman.update(z, R=r, H=h)
