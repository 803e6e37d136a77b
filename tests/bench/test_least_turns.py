"""The bounds of turns against closed forms, and against themselves with more knots."""

import math

import numpy as np
import pytest

from tests.bench.least_turns import End, Pace, Way

SPEED_M_S, ACCELERATION_M_S2, JERK_M_S3 = 8.0, 2.5, 4.0
PACE = Pace(SPEED_M_S, ACCELERATION_M_S2, JERK_M_S3)
WITHOUT_JERK = Pace(SPEED_M_S, ACCELERATION_M_S2)


def turn_back_s(aside_m: float) -> float:
    """What turning back onto a lane beside takes at least without a limit of jerk, beyond both lanes at full speed.

    Let u be the speed where one lane ends, and where the other begins: time reversal and mirroring make one turn of two
    different speeds, or of ends that do not lie side by side, another of equal duration, and the mean of both
    accelerations has u for the mean of the speeds. The least time T from (u, 0) to (-u, 0) that leads aside by w has
    the acceleration a (-1, k t) / sqrt(1 + k^2 t^2), t from -T/2 to T/2 (Pontryagin), whence, with z = k T / 2,

        u^2 = w a asinh(z)^2 / (z sqrt(1 + z^2) - asinh(z)),  T = 2 z u / (a asinh(z)),

    and slowing down from the full speed v to u, and up again, costs (v - u)^2 / (a v).
    """
    z = np.geomspace(1e-3, 1e6, 4000)
    arc = np.arcsinh(z)
    u = np.sqrt(aside_m * ACCELERATION_M_S2 * arc**2 / (z * np.sqrt(1.0 + z**2) - arc))
    lasts = 2.0 * z * u / (ACCELERATION_M_S2 * arc)
    lost = (SPEED_M_S - u) ** 2 / (ACCELERATION_M_S2 * SPEED_M_S)
    return float(np.where(u <= SPEED_M_S, lasts + lost, np.inf).min())


def turn(aside_m: float, pace: Pace, *, ahead_m: float = 0.0, window_s: float = 3.0, intervals: int = 20) -> Way:
    leave, arrive = End(0.0, window_s), End(math.pi, window_s)
    return Way(leave, arrive, (ahead_m, ahead_m, aside_m, aside_m), pace, intervals)


@pytest.mark.parametrize("aside_m", [4.0, 12.3, 20.0])
def test_without_jerk_turns_take_what_pontryagin_has(aside_m: float) -> None:
    least = turn(aside_m, WITHOUT_JERK).least_s()
    assert 0.995 * turn_back_s(aside_m) <= least <= turn_back_s(aside_m)


def test_more_knots_raise_the_bound_by_less_and_less() -> None:
    found = np.array([turn(12.3, PACE, intervals=n).least_s() for n in (5, 10, 20, 40)])
    more = np.diff(found)
    assert np.all(more > 0.0)
    assert np.all(more[1:] < more[:-1])
    assert more[-1] < 0.005 * found[-1]


def test_more_jerk_and_nothing_seen_of_lanes_lower_the_bound() -> None:
    found = [turn(12.3, pace).least_s() for pace in (PACE, Pace(SPEED_M_S, ACCELERATION_M_S2, 8.0), WITHOUT_JERK)]
    assert found == sorted(found, reverse=True)
    assert turn(12.3, PACE, window_s=0.0).least_s() < turn(12.3, PACE, window_s=1.0).least_s() < found[0] + 1e-6


@pytest.mark.parametrize("way_m", [16.0, 60.0])
def test_from_rest_to_rest_straight_on_takes_what_the_profile_does(way_m: float) -> None:
    # Acceleration comes up, stays where there is room for it, goes, and the same to slow down.
    tops = np.linspace(0.0, SPEED_M_S, 4001)[1:]
    ramps = np.array([Pace(float(top), ACCELERATION_M_S2, JERK_M_S3).settles_s for top in tops])
    left = way_m - tops * ramps
    exact = float((2.0 * ramps + left / tops)[left >= 0.0].min())
    least = Way(End(rests=True), End(rests=True), (way_m, way_m, 0.0, 0.0), PACE).least_s()
    assert 0.98 * exact <= least <= exact + 1e-6


def test_straight_on_costs_nothing_and_a_step_aside_less_than_turning_back() -> None:
    straight = Way(End(0.0, 3.0), End(0.0, 3.0), (10.0, 10.0, 0.0, 0.0), PACE).least_s()
    aside = Way(End(0.0, 3.0), End(0.0, 3.0), (10.0, 10.0, 2.0, 2.0), PACE).least_s()
    assert 10.0 / SPEED_M_S - 0.03 <= straight <= 10.0 / SPEED_M_S + 1e-6
    assert straight + 0.5 < aside < turn(2.0, PACE).least_s()


@pytest.mark.parametrize("ahead_m", [3.0, 10.0])
def test_a_turn_takes_as_long_backwards(ahead_m: float) -> None:
    one, other = (turn(12.3, PACE, ahead_m=away).least_s() for away in (ahead_m, -ahead_m))
    assert one == pytest.approx(other, abs=0.02)
    assert one > turn(12.3, PACE).least_s()
