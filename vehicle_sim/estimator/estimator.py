"""The state estimator: attitude reference and navigation filter, their start, and what they vouch for."""

from collections.abc import Sequence
from dataclasses import dataclass, field
from math import sqrt
from typing import Final

from vehicle_sim.estimator.attitude import AttitudeReference
from vehicle_sim.estimator.navigation import NavigationFilter
from vehicle_sim.estimator.process import NavigationTuning
from vehicle_sim.signals import (
    GRAVITY_M_S2,
    BaroReading,
    CompassReading,
    Estimate,
    EstimatorFlag,
    EstimatorStatus,
    Geodetic,
    GpsReading,
    ImuReading,
    Vector,
)

_COMPASS_GATE_RAD: Final = 0.5
_FIX_3D: Final = 3
_SETTLING: Final = (
    EstimatorFlag.ATTITUDE
    | EstimatorFlag.VELOCITY_VERTICAL
    | EstimatorFlag.PREDICTED_HORIZONTAL_RELATIVE
    | EstimatorFlag.PREDICTED_HORIZONTAL_ABSOLUTE
)
_TRACKING: Final = (
    EstimatorFlag.VELOCITY_HORIZONTAL
    | EstimatorFlag.POSITION_HORIZONTAL_RELATIVE
    | EstimatorFlag.POSITION_HORIZONTAL_ABSOLUTE
)
_ZERO: Final[Vector] = (0.0, 0.0, 0.0)
_NOTHING: Final = EstimatorStatus(
    flags=EstimatorFlag(0),
    initialised=False,
    gps_glitch=False,
    velocity_ratio=0.0,
    position_horizontal_ratio=0.0,
    position_vertical_ratio=0.0,
    compass_ratio=0.0,
    horizontal_accuracy_m=99.0,
    vertical_accuracy_m=99.0,
    speed_accuracy_m_s=99.0,
)


def _mean(places: Sequence[Geodetic]) -> Geodetic:
    """Return the middle of places that are close together, counted from the first, whose longitude may be any."""
    first, count = places[0], len(places)
    east_deg = sum((place.lon_deg - first.lon_deg + 180.0) % 360.0 - 180.0 for place in places) / count
    lat_deg, alt_m = sum(place.lat_deg for place in places) / count, sum(place.alt_m for place in places) / count
    return Geodetic(lat_deg, (first.lon_deg + east_deg + 180.0) % 360.0 - 180.0, alt_m)


@dataclass(frozen=True, slots=True, kw_only=True)
class EstimatorTuning:
    """When the estimator starts, trusts itself and stops doing so, and what its filter believes of the sensors."""

    good_gps_s: float = 5.0
    convergence_s: float = 1.5
    worst_position_m: float = 1.5
    lost_gps_s: float = 5.0
    navigation: NavigationTuning = field(default_factory=NavigationTuning)


class Estimator:
    """Estimates the state of one vehicle from its sensors; `estimate` is the newest.

    There is no local position before the GPS has been good for some seconds: then the mean of its fixes becomes the
    origin and the filter starts, and a little later, when it has settled, it vouches for the position.
    """

    def __init__(self, tuning: EstimatorTuning, *, step_s: float) -> None:
        """Know nothing."""
        self._tuning = tuning
        self._step_s = step_s
        self._attitude = AttitudeReference(step_s=step_s)
        self.navigation: NavigationFilter | None = None
        self._baro_sum_m, self._baro_count = 0.0, 0
        self._gps_good_since_s: float | None = None
        self._fixes: list[Geodetic] = []
        self._status = _NOTHING
        self.estimate = Estimate(0.0, None, _ZERO, _ZERO, _ZERO, 0.0, 0.0, 0.0, _ZERO, _NOTHING)

    @property
    def attitude_corrections(self) -> tuple[Vector, float, float]:
        """Drift of the gyros in rad/s that is taken out, and the last corrections of tilt and yaw in radians."""
        return self._attitude.bias_rad_s, self._attitude.tilt_miss_rad, self._attitude.compass_miss_rad

    def step(
        self,
        time_s: float,
        imu: ImuReading,
        gps: GpsReading | None,
        baro: BaroReading | None,
        compass: CompassReading | None,
    ) -> Estimate:
        """Take the measurements of one step (None: nothing new from that sensor) and return the new estimate."""
        attitude, navigation = self._attitude, self.navigation
        attitude.step(imu)
        if compass is not None:
            attitude.take_compass(compass)
        if navigation is None:
            self._wait(time_s, gps, baro)
            place, going, error = _ZERO, _ZERO, _ZERO
        else:
            levelling = navigation.advance(attitude.acceleration_ned_m_s2, attitude.angles_rad, gps, baro)
            if levelling is not None:
                attitude.tilt(-levelling.north_m_s2 / GRAVITY_M_S2, -levelling.east_m_s2 / GRAVITY_M_S2)
                p_bias, q_bias = levelling.right_m_s3 / GRAVITY_M_S2, -levelling.forward_m_s3 / GRAVITY_M_S2
                attitude.trim(p_bias, q_bias, levelling.bias_m_s2)
                self._judge(time_s, navigation)
            place, going, error = navigation.mean()
        a = attitude.acceleration_ned_m_s2
        self.estimate = Estimate(
            time_s,
            None if navigation is None else navigation.origin,
            place,
            going,
            (a[0] - error[0], a[1] - error[1], a[2] - error[2]),
            attitude.roll_rad,
            attitude.pitch_rad,
            attitude.yaw_rad,
            attitude.rates_rad_s,
            self._status,
        )
        return self.estimate

    def _wait(self, time_s: float, gps: GpsReading | None, baro: BaroReading | None) -> None:
        if baro is not None:
            self._baro_sum_m += baro.altitude_m
            self._baro_count += 1
        if self._attitude.aligned and not self._status.attitude_ok:
            self._status = self._status._replace(flags=EstimatorFlag.ATTITUDE | EstimatorFlag.CONSTANT_POSITION)
        if gps is None:
            return
        if gps.fix_type < _FIX_3D:
            self._gps_good_since_s = None
            self._fixes.clear()
            return
        self._fixes.append(gps.position)
        if self._gps_good_since_s is None:
            self._gps_good_since_s = time_s
        enough = time_s - self._gps_good_since_s >= self._tuning.good_gps_s
        if enough and self._attitude.aligned and self._baro_count:
            self.navigation = NavigationFilter(
                self._tuning.navigation,
                step_s=self._step_s,
                time_s=time_s,
                origin=_mean(self._fixes),
                fixes=len(self._fixes),
                baro_zero_m=self._baro_sum_m / self._baro_count,
                attitude_rad=self._attitude.angles_rad,
            )

    def _judge(self, time_s: float, navigation: NavigationFilter) -> None:
        """Say what may be relied upon."""
        p, tuning, ratios = navigation.variances, self._tuning, navigation.ratios
        horizontal, vertical = sqrt(p[0] + p[1]), sqrt(p[2])
        age = time_s - navigation.position_taken_s
        settled = time_s - navigation.started_s >= tuning.convergence_s
        flags = _SETTLING
        if settled:
            flags |= EstimatorFlag.POSITION_VERTICAL_ABSOLUTE
        if settled and age < tuning.lost_gps_s and horizontal < tuning.worst_position_m:
            flags |= _TRACKING
        self._status = EstimatorStatus(
            flags=flags,
            initialised=True,
            gps_glitch=ratios[0] > 1.0,
            velocity_ratio=ratios[2],
            position_horizontal_ratio=ratios[0],
            position_vertical_ratio=max(ratios[1], ratios[3]),
            compass_ratio=min(abs(self._attitude.compass_miss_rad) / _COMPASS_GATE_RAD, 1.0),
            horizontal_accuracy_m=horizontal,
            vertical_accuracy_m=vertical,
            speed_accuracy_m_s=sqrt(p[3] + p[4]),
        )
