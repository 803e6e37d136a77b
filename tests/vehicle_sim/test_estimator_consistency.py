"""Consistency of the filter: errors and innovations are as large as it says (Bar-Shalom, Li, Kirubarajan, 5.4.2).

The normalised estimation error squared (NEES) of position and velocity, over independent flights, and the normalised
innovation squared (NIS) of each group of measurements, over time and flights, are chi-square distributed where the
filter's covariances are true; sums of them have bounds.
"""

import numpy as np
import pytest
from scipy.stats import chi2

from tests.support.bare_vehicle import booted, hovering, run
from vehicle_sim.estimator.navigation import NavigationFilter
from vehicle_sim.geodesy import ned_offset_m
from vehicle_sim.signals import BaroReading, GpsReading, Setpoint
from vehicle_sim.vehicle import Vehicle

GATES = (27.6, 23.9, 30.7, 23.9)
DEGREES = (2, 1, 3, 1)
LIKELY = (0.0005, 0.9995)
MOTIONS = pytest.mark.parametrize("motion", ["standing", "hovering", "manoeuvring"])


class Innovations:
    """Watches a filter take its measurements, and keeps the sums of their normalised innovations squared."""

    def __init__(self, navigation: NavigationFilter) -> None:
        self.sums, self.counts = np.zeros(4), np.zeros(4, dtype=int)
        self._navigation, self._take = navigation, navigation._correct
        navigation._correct = self._watch  # type: ignore[method-assign]

    def _watch(self, gps: GpsReading | None, baro: BaroReading | None) -> None:
        self._take(gps, baro)
        taken = np.array([gps is not None] * 3 + [baro is not None])
        self.sums += taken * np.square(self._navigation.ratios) * GATES
        self.counts += taken


def error_of(vehicle: Vehicle) -> np.ndarray[tuple[int], np.dtype[np.float64]]:
    """Error of position and velocity (6), both counted from the estimator's own origin."""
    estimate = vehicle.estimate
    assert estimate.origin is not None
    place = ned_offset_m(estimate.origin, vehicle.true_place)
    true = np.array([*place, *vehicle.truth.velocity_ned_m_s])
    return true - [*estimate.position_ned_m, *estimate.velocity_ned_m_s]


def manoeuvre(vehicle: Vehicle) -> None:
    """Fly to and fro as hard as the limits allow, turning."""
    n, e, d = vehicle.estimate.position_ned_m
    for leg in range(4):
        place = (n + (8.0 if leg % 2 == 0 else -8.0), e + (6.0 if leg in (1, 2) else -6.0), d)
        run(vehicle, 4.37, Setpoint(position_ned_m=place, velocity_ned_m_s=(0.0, 0.0, 0.0), yaw_rad=leg * 1.2 - 1.5))


def campaign(motion: str, seeds: range) -> tuple[float, Innovations]:
    """The sum of the NEES over flights, and all innovations of them."""
    nees, all_of = 0.0, None
    for seed in seeds:
        vehicle = booted(seed=seed) if motion == "standing" else hovering(seed=seed, wind_m_s=4.0)
        navigation = vehicle._estimator.navigation
        assert navigation is not None
        innovations = Innovations(navigation)
        if motion == "manoeuvring":
            manoeuvre(vehicle)
        else:
            run(vehicle, 17.3)
        error = error_of(vehicle)
        nees += float(error @ np.linalg.solve(navigation.covariance[:6, :6], error))
        if all_of is None:
            all_of = innovations
        else:
            all_of.sums += innovations.sums
            all_of.counts += innovations.counts
    assert all_of is not None
    return nees, all_of


def judge(motion: str, seeds: range) -> None:
    nees, innovations = campaign(motion, seeds)
    assert chi2.ppf(LIKELY[0], 6 * len(seeds)) < nees < chi2.ppf(LIKELY[1], 6 * len(seeds))
    for total, count, degrees in zip(innovations.sums, innovations.counts, DEGREES, strict=True):
        assert chi2.ppf(LIKELY[0], degrees * count) < total < chi2.ppf(LIKELY[1], degrees * count)


@MOTIONS
def test_errors_and_innovations_are_as_large_as_the_filter_says(motion: str) -> None:
    judge(motion, range(200, 204))


@pytest.mark.long
@MOTIONS
def test_the_same_over_many_flights(motion: str) -> None:
    judge(motion, range(1000, 1100))
