"""The time law: within the limits, at rest where it must be, and as fast as theory says that it can be."""

import json
import math
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.linalg import LinAlgError, solveh_banded

from mission.spec.model import Extension
from mission.steering.grid import Limits, Slow
from mission.steering.joined import Curve, JoinedCurve, Piece
from mission.steering.law import TimeLaw
from mission.steering.rounded import RoundedPolyline
from mission.steering.smoothing import FourierCurve, fit_fourier
from mission.steering.timing import GRAVITY_M_S2, level_acceleration, time_law
from tests.mission.steering.test_bezier import random_spline
from tests.support.curves import paper_path
from tests.support.drawn_cases import tried

LIMITS = Limits(5.0, 2.0, 4.0)


def flown_curve(seed: int, waves: int, extension: Extension) -> FourierCurve:
    """A curve of some metres a second with corners, as a smoothed mission has them."""
    rng = np.random.default_rng(seed)
    duration = rng.uniform(10.0, 40.0)
    decay = (np.arange(1, waves + 1) ** 2)[:, None]
    slope = rng.normal(size=2) if extension is Extension.ODD else np.zeros(2)
    return FourierCurve(extension, duration, rng.normal(size=2), slope, duration * rng.normal(size=(waves, 2)) / decay)


def straight(length_m: float) -> RoundedPolyline:
    return RoundedPolyline(np.array([[3.0, -2.0], [3.0 + length_m, -2.0]]), np.empty(0), 1.0)


def a_corner(reach_m: float, turn_deg: float) -> RoundedPolyline:
    turn = math.radians(turn_deg)
    end = [30.0 + 30.0 * math.cos(turn), 30.0 * math.sin(turn)]
    return RoundedPolyline(np.array([[0.0, 0.0], [30.0, 0.0], end]), np.array([reach_m]), 1.0)


curves = st.one_of(
    st.builds(flown_curve, st.integers(0, 10**6), st.integers(1, 20), st.sampled_from(Extension)),
    st.builds(random_spline, st.integers(0, 10**6), st.integers(1, 4)),
    st.builds(a_corner, st.floats(0.5, 30.0), st.floats(-180.0, 180.0)),
)
limits_of_vehicles = st.builds(Limits, st.floats(1.0, 12.0), st.floats(0.3, 5.0), st.floats(0.5, 20.0))


def holds_of(curve: Piece, fractions: list[float]) -> tuple[tuple[float, float], ...]:
    return tuple((fraction * curve.duration_s, 1.0 + 3.0 * fraction) for fraction in fractions)


def flown(curve: Curve, law: TimeLaw) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Speed, acceleration and jerk at many times, from the definition, on both sides of each knot."""
    knots = law.knots_t_s
    t = np.concatenate((np.linspace(0.0, law.duration_s, 2001), knots, 0.5 * (knots[:-1] + knots[1:])))
    s, rate, growth = (values[:, None] for values in law.jet(t))
    first, second, third = (curve.derivative(s[:, 0], order) for order in (1, 2, 3))
    before = law.jerks[np.clip(np.searchsorted(knots, t, side="left") - 1, 0, len(law.jerks) - 1)]
    jerks = [
        np.linalg.norm(third * rate**3 + 3.0 * second * rate * growth + first * jerk[:, None], axis=1)
        for jerk in (law.jerks[law.piece_at(t)], before)
    ]
    return (
        np.linalg.norm(first * rate, axis=1),
        np.linalg.norm(second * rate**2 + first * growth, axis=1),
        np.maximum(*jerks),
    )


@given(curves, limits_of_vehicles, st.sampled_from([1.0, math.inf]), st.lists(st.floats(0.0, 1.0), max_size=2))
@tried(20)
def test_limits_are_kept_everywhere(curve: Piece, limits: Limits, fastest: float, fractions: list[float]) -> None:
    law = time_law(curve, limits, fastest=fastest, holds=holds_of(curve, fractions))
    for asked, limit in zip(flown(curve, law), limits, strict=True):
        assert asked.max() <= limit * (1.0 + 1e-6)
    assert law.rates.max() <= fastest * (1.0 + 1e-9)


@given(curves, limits_of_vehicles, st.lists(st.floats(0.0, 1.0), max_size=3))
@tried(10)
def test_the_law_stands_still_as_long_as_asked(curve: Piece, limits: Limits, fractions: list[float]) -> None:
    holds = holds_of(curve, fractions)
    law = time_law(curve, limits, holds=holds)
    little = 1.1e-6 * curve.duration_s
    for place, seconds in holds:
        stood = np.flatnonzero((np.diff(law.knots_s) == 0.0) & (np.abs(law.knots_s[:-1] - place) <= little))
        assert np.diff(law.knots_t_s)[stood].max() >= seconds - 1e-9
        assert law.rates[stood].max() == 0.0


@given(curves, limits_of_vehicles)
@tried(8)
def test_rest_at_both_ends_and_beyond(curve: Piece, limits: Limits) -> None:
    law = time_law(curve, limits)
    ends = np.array([-5.0, 0.0, law.duration_s, law.duration_s + 5.0])
    place, rate, growth = law.jet(ends)
    assert place == pytest.approx([0.0, 0.0, curve.duration_s, curve.duration_s], abs=1e-9)
    assert rate == pytest.approx(np.zeros(4), abs=1e-9)
    assert growth == pytest.approx(np.zeros(4), abs=1e-9)


@given(curves, limits_of_vehicles, st.floats(0.0, 1.0))
@tried(10)
def test_the_law_is_smooth_and_time_at_inverts_it(curve: Piece, limits: Limits, fraction: float) -> None:
    law = time_law(curve, limits)
    assert (np.diff(law.knots_s) >= 0.0).all()
    t, step = fraction * law.duration_s, 1e-6
    places, rates, growths = law.jet([t - step, t + step])
    assert np.ptp(places) <= 2.0 * step * law.rates.max() + 1e-9
    assert np.ptp(rates) <= 2.0 * step * np.abs(law.growths).max() + 1e-9
    assert np.ptp(growths) <= 2.0 * step * np.abs(law.jerks).max() + 1e-9
    s = fraction * curve.duration_s
    assert law.parameter(law.time_at(s)) == pytest.approx([s], abs=1e-9 * (1.0 + curve.duration_s))


@given(curves, limits_of_vehicles, st.floats(0.0, 0.8), st.floats(0.05, 0.2), st.floats(0.1, 0.9))
@tried(8)
def test_where_it_is_to_be_slow_it_is(curve: Piece, limits: Limits, begins: float, lasts: float, share: float) -> None:
    begin, end = begins * curve.duration_s, (begins + lasts) * curve.duration_s
    free = time_law(curve, limits)
    most = share * float(free.rates.max())
    law = time_law(curve, limits, slow=(Slow(begin, end, most),))
    arrival, departure = law.time_at([begin, end])
    assert law.jet(np.linspace(arrival, departure, 801))[1].max() <= most * (1.0 + 1e-9)
    assert law.duration_s >= 0.99 * free.duration_s  # the grids differ


@given(st.floats(0.5, 30.0), st.floats(-180.0, 180.0), st.floats(0.05, 0.95), limits_of_vehicles)
@tried(20)
def test_curves_that_go_over_into_each_other_are_flown_through(
    reach_m: float, turn_deg: float, share: float, limits: Limits
) -> None:
    """Wherever one is joined to the other, on a straight part before a bend; the limits hold around the joint, too."""
    corner = a_corner(reach_m, turn_deg)
    begin = np.array([[-40.0, 0.0], [-40.0 * share, 0.0], [0.0, 0.0]])
    curve = JoinedCurve((*(RoundedPolyline(begin[k : k + 2], np.empty(0), 1.0) for k in (0, 1)), corner))
    law = time_law(curve, limits)
    for asked, limit in zip(flown(curve, law), limits, strict=True):
        assert asked.max() <= limit * (1.0 + 1e-6)
    assert curve.breaks_s.tolist() == []
    joints = curve.joints_s[1:-1]
    assert law.jet(law.time_at(joints))[1].min() > 0.0
    assert law.left_at(joints) == pytest.approx(law.time_at(joints))


def fastest_dash_s(length_m: float, limits: Limits) -> float:
    """The least time from rest to rest on a straight line: seven parts of constant jerk, or fewer."""
    speed, acceleration, jerk = limits

    def ramp_s(top: float) -> float:
        most = min(acceleration, math.sqrt(top * jerk))
        return top / most + most / jerk

    if speed * ramp_s(speed) <= length_m:
        return 2.0 * ramp_s(speed) + length_m / speed - ramp_s(speed)
    low, high = 0.0, speed
    for _ in range(100):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if middle * ramp_s(middle) <= length_m else (low, middle)
    return 2.0 * ramp_s(low)


@given(st.floats(0.01, 500.0), limits_of_vehicles)
@tried(25)
def test_a_straight_dash_takes_little_more_than_it_must(length_m: float, limits: Limits) -> None:
    least_s = fastest_dash_s(length_m, limits)
    used = limits._replace(jerk_m_s3=min(limits.jerk_m_s3, limits.acceleration_m_s2 / 0.15))
    found_s = time_law(straight(length_m), limits).duration_s
    assert least_s * (1.0 - 1e-9) <= found_s <= 1.05 * fastest_dash_s(length_m, used) + 0.01


def test_the_exact_solution_for_a_dash_is_the_textbooks() -> None:
    # 60 m at 6 m/s with 2 m/s^2 and 4 m/s^3: 60 / 6 + 6 / 2 + 2 / 4.
    assert fastest_dash_s(60.0, Limits(6.0, 2.0, 4.0)) == pytest.approx(13.5)
    # All of it at the largest jerk: four parts of the time T / 4 each, s = j T^3 / 32.
    assert fastest_dash_s(1e-3, Limits(6.0, 2.0, 4.0)) == pytest.approx((32.0 * 1e-3 / 4.0) ** (1.0 / 3.0))


def lanes(count: int, apart_m: float) -> RoundedPolyline:
    """There and back again, apart from each other, rounded as lanes are."""
    places = [
        [apart_m * lane, end] for lane in range(count) for end in ((0.0, 300.0) if lane % 2 == 0 else (300.0, 0.0))
    ]
    return RoundedPolyline(np.array(places), np.full(2 * count - 2, apart_m / 3.0), 4.0)


@pytest.mark.parametrize("apart_m", [2.0, 6.0])
def test_a_long_way_is_flown_within_the_limits_and_about_as_fast_as_a_short_one(apart_m: float) -> None:
    few, many = 4, 60
    short, long = (time_law(lanes(count, apart_m), LIMITS) for count in (few, many))
    speed, acceleration, jerk = flown(lanes(many, apart_m), long)
    assert speed.max() <= LIMITS.speed_m_s * (1 + 1e-9)
    assert acceleration.max() <= LIMITS.acceleration_m_s2 * (1 + 1e-6)
    assert jerk.max() <= LIMITS.jerk_m_s3 * (1 + 1e-6)
    assert long.duration_s / many <= 1.01 * short.duration_s / few


@pytest.mark.parametrize("reach_m", [4.0, 8.0, 16.0])
def test_a_corner_is_flown_as_fast_as_its_bend_admits(reach_m: float) -> None:
    curve, limits = a_corner(reach_m, 90.0), Limits(8.0, 2.5, 4.0)
    law = time_law(curve, limits)
    middle_s = float(law.time_at([0.5 * curve.duration_s])[0])
    speed = float(law.jet([middle_s])[1][0]) * math.sqrt(0.5)
    # |r''| = 3 / (4 d) sqrt(2) for c = 1, and r' has the length 1 / sqrt(2) there.
    most = math.sqrt(2.5 / (0.75 * math.sqrt(2.0) / reach_m)) * math.sqrt(0.5)
    assert 0.94 * most <= speed <= most


@pytest.mark.parametrize("extension", Extension)
def test_the_papers_mission_keeps_its_times(extension: Extension) -> None:
    curve = fit_fourier(paper_path(), 28, extension)
    law = time_law(curve, Limits(1.0, 0.5, 4.0), fastest=1.0)
    assert curve.duration_s == pytest.approx(843.0, abs=1.0)
    assert law.duration_s - curve.duration_s < 1.0
    t = np.linspace(1.0, curve.duration_s, 500)
    assert np.abs(law.parameter(t) - t).max() < 1.0
    # The curve is really flown at the planned speed: slowed nowhere but at its ends.
    assert law.jet(t[3:-3])[1] == pytest.approx(np.ones(494), abs=2e-3)


def test_tilt_bounds_the_acceleration() -> None:
    assert level_acceleration(9.0, 0.05) == GRAVITY_M_S2 * math.tan(0.05)
    assert level_acceleration(0.3, 0.05) == 0.3


def test_slower_vehicles_take_longer() -> None:
    curve = flown_curve(7, 30, Extension.ODD)
    durations = [
        time_law(curve, limits).duration_s for limits in (Limits(50.0, 4.0, 9.0), LIMITS, Limits(1.0, 0.5, 0.5))
    ]
    assert durations[0] < durations[1] < durations[2]


def test_stops_at_one_place_are_one_stop() -> None:
    curve = flown_curve(5, 10, Extension.ODD)
    single = time_law(curve, LIMITS, holds=((5.0, 4.0),))
    double = time_law(curve, LIMITS, holds=((5.0, 2.0), (5.0 + 1e-12, 4.0)))
    assert double.duration_s == pytest.approx(single.duration_s, abs=1e-9)


def test_laws_survive_json() -> None:
    curve = flown_curve(5, 10, Extension.ODD)
    law = time_law(curve, LIMITS, holds=((3.0, 2.0),))
    again = TimeLaw.from_json(json.loads(json.dumps(law.to_json())))
    t = np.linspace(0.0, law.duration_s, 99)
    assert (again.parameter(t) == law.parameter(t)).all()


@pytest.mark.parametrize("name", ["knots_t_s", "knots_s", "rates", "growths"])
def test_a_law_of_which_a_number_was_changed_is_none(name: str) -> None:
    data = time_law(flown_curve(5, 10, Extension.ODD), LIMITS).to_json()
    data[name][20] += 1e-3
    with pytest.raises(ValueError, match="time law"):
        TimeLaw.from_json(data)


@pytest.mark.parametrize(
    "change",
    [
        {"limits": Limits(0.0, 2.0, 4.0)},
        {"limits": Limits(5.0, -1.0, 4.0)},
        {"limits": Limits(5.0, math.nan, 4.0)},
        {"limits": Limits(5.0, 2.0, math.inf)},
        {"fastest": 0.0},
        {"holds": ((-1.0, 1.0),)},
        {"holds": ((1.0, math.inf),)},
        {"holds": ((1e9, 1.0),)},
        {"slow": (Slow(1.0, 2.0, 0.0),)},
        {"slow": (Slow(2.0, 1.0, 0.5),)},
    ],
)
def test_impossible_limits_are_refused(change: dict[str, Any]) -> None:
    arguments: dict[str, Any] = {"limits": LIMITS} | change
    with pytest.raises(ValueError, match=r"must be positive|lies on the curve|goes on nevertheless"):
        time_law(flown_curve(5, 10, Extension.ODD), **arguments)


@pytest.mark.parametrize(
    ("times", "places", "rates", "growths"),
    [
        ([0.0], [0.0], [0.0], [0.0]),
        ([0.0, 1.0, 0.5], [0.0, 1.0, 2.0], [0.0, 1.0, 0.0], [0.0, 0.0, 0.0]),
        ([0.0, 1.0], [0.0, -1.0], [0.0, 0.0], [0.0, 0.0]),
        ([0.0, 1.0], [0.0, 1.0], [0.0, -1.0], [0.0, 0.0]),
        ([0.0, 1.0], [0.0], [0.0, 0.0], [0.0, 0.0]),
        ([1.0, 2.0], [0.0, 0.0], [0.0, 0.0], [0.0, 0.0]),
        ([0.0, 1.0], [0.0, 0.0], [0.0, math.nan], [0.0, 0.0]),
        # Between these it would go backwards.
        ([0.0, 2.0], [0.0, 0.0], [0.0, 0.0], [-1.0, 1.0]),
    ],
)
def test_what_is_no_law_is_refused(
    times: list[float], places: list[float], rates: list[float], growths: list[float]
) -> None:
    with pytest.raises(ValueError, match="time law"):
        TimeLaw(np.array(times), np.array(places), np.array(rates), np.array(growths))


def test_a_path_that_stays_in_one_place_has_a_law() -> None:
    curve = FourierCurve(Extension.ODD, 1.0, np.array([3.0, 4.0]), np.zeros(2), np.zeros((1, 2)))
    law = time_law(curve, LIMITS, holds=((1.0, 2.0),))
    assert math.isfinite(law.duration_s)
    assert law.duration_s >= 2.0


def test_where_a_system_has_no_solution_what_was_reached_is_kept(monkeypatch: pytest.MonkeyPatch) -> None:
    solved = iter([True, True, False])

    def some(*args: Any, **others: Any) -> Any:  # noqa: ANN401 - as scipy has it
        if not next(solved, False):
            raise LinAlgError("not positive definite")
        return solveh_banded(*args, **others)

    monkeypatch.setattr("mission.steering.pacing.solveh_banded", some)
    curve = a_corner(5.0, 90.0)
    law = time_law(curve, LIMITS)
    for asked, limit in zip(flown(curve, law), LIMITS, strict=True):
        assert asked.max() <= limit * (1.0 + 1e-6)
    assert next(solved, None) is None
