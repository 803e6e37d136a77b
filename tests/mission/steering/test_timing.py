"""The time law: twice differentiable, within the limits, at rest where it must be, and no slower than needed."""

import json
import math
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from mission.spec.model import Extension
from mission.steering.smoothing import FourierCurve, fit_fourier
from mission.steering.timing import GRAVITY_M_S2, TimeLaw, time_law
from mission.steering.trajectory import Leg, Trajectory
from tests.support.curves import paper_path


def flown_curve(seed: int, waves: int, extension: Extension) -> FourierCurve:
    """A curve of some metres a second with corners, as a smoothed mission has them."""
    rng = np.random.default_rng(seed)
    duration = rng.uniform(10.0, 200.0)
    decay = (np.arange(1, waves + 1) ** 2)[:, None]
    slope = rng.normal(size=2) if extension is Extension.ODD else np.zeros(2)
    return FourierCurve(extension, duration, rng.normal(size=2), slope, duration * rng.normal(size=(waves, 2)) / decay)


curves = st.builds(flown_curve, st.integers(0, 10**6), st.integers(1, 40), st.sampled_from(Extension))


def holds_of(curve: FourierCurve, fractions: list[float]) -> tuple[tuple[float, float], ...]:
    return tuple((fraction * curve.duration_s, 1.0 + 3.0 * fraction) for fraction in fractions)


@given(curves, st.floats(0.2, 8.0), st.floats(0.1, 3.0), st.lists(st.floats(0.0, 1.0), max_size=3))
@settings(deadline=None, max_examples=40)
def test_limits_are_kept_everywhere(curve: FourierCurve, speed: float, limit: float, fractions: list[float]) -> None:
    law = time_law(curve, speed_m_s=speed, acceleration_m_s2=limit, tilt_rad=0.5, holds=holds_of(curve, fractions))
    knots = np.concatenate((law.knots_t_s, law.knots_t_s + law.window_s))
    t = np.union1d(np.linspace(0.0, law.duration_s, 4001), knots)
    _, velocity, acceleration = Trajectory((Leg(curve, law),), 10.0).state(t)
    assert np.linalg.norm(velocity, axis=1).max() <= speed * (1 + 1e-9)
    assert np.linalg.norm(acceleration, axis=1).max() <= limit * (1 + 1e-6)
    _, rate, _ = law.jet(t)
    assert (rate >= 0.0).all()
    assert rate.max() <= 1.0 + 1e-9


@given(
    curves, st.floats(0.2, 8.0), st.floats(0.1, 3.0), st.tuples(st.floats(0.0, 0.8), st.floats(0.05, 0.2)), st.data()
)
@settings(deadline=None, max_examples=25)
def test_where_it_is_to_be_slow_it_is_and_nowhere_faster_for_it(
    curve: FourierCurve, speed: float, limit: float, span: tuple[float, float], data: st.DataObject
) -> None:
    begin, end = span[0] * curve.duration_s, sum(span) * curve.duration_s
    most = data.draw(st.floats(0.1, 0.9))
    law, free = (
        time_law(curve, speed_m_s=speed, acceleration_m_s2=limit, tilt_rad=0.5, slow=slow)
        for slow in (((begin, end, most),), ())
    )
    arrival, departure = law.time_at([begin, end])
    t = np.linspace(0.0, law.duration_s, 4001)
    _, rate, _ = law.jet(t)
    # The average looks back over the window.
    inside = (arrival + law.window_s <= t) & (t <= departure - law.window_s)
    assert rate[inside].max(initial=0.0) <= most + 1e-9
    assert departure - arrival >= (end - begin) / most - law.window_s
    assert law.duration_s >= 0.99 * free.duration_s  # the grids differ
    _, velocity, acceleration = Trajectory((Leg(curve, law),), 10.0).state(t)
    assert np.linalg.norm(velocity, axis=1).max() <= speed * (1 + 1e-9)
    assert np.linalg.norm(acceleration, axis=1).max() <= limit * (1 + 1e-6)


@given(curves, st.floats(0.2, 8.0), st.floats(0.1, 3.0), st.lists(st.floats(0.0, 1.0), max_size=3))
@settings(deadline=None, max_examples=25)
def test_the_law_stands_still_as_long_as_asked(
    curve: FourierCurve, speed: float, limit: float, fractions: list[float]
) -> None:
    holds = holds_of(curve, fractions)
    law = time_law(curve, speed_m_s=speed, acceleration_m_s2=limit, tilt_rad=0.5, holds=holds)
    for place, seconds in holds:
        little = 1e-8 * curve.duration_s
        arrival = law.time_at(max(0.0, place - little))[0] if place > little else 0.0
        departure = law.time_at(place + little)[0] if place + little < curve.duration_s else law.duration_s
        assert departure - arrival >= seconds
        middle = law.jet(np.array([0.5 * (arrival + departure)]))
        assert abs(middle[0][0] - place) <= little
        assert middle[1][0] == pytest.approx(0.0, abs=1e-6)


@given(curves, st.floats(0.5, 8.0), st.floats(0.1, 3.0))
@settings(deadline=None, max_examples=25)
def test_rest_at_both_ends_and_beyond(curve: FourierCurve, speed: float, limit: float) -> None:
    law = time_law(curve, speed_m_s=speed, acceleration_m_s2=limit, tilt_rad=0.5)
    ends = np.array([-5.0, 0.0, law.duration_s, law.duration_s + 5.0])
    place, rate, growth = law.jet(ends)
    assert place == pytest.approx([0.0, 0.0, curve.duration_s, curve.duration_s], abs=1e-9)
    assert rate == pytest.approx(np.zeros(4), abs=1e-9)
    assert growth == pytest.approx(np.zeros(4), abs=1e-9)


@given(curves, st.floats(0.5, 8.0), st.floats(0.1, 3.0))
@settings(deadline=None, max_examples=25)
def test_the_second_derivative_is_continuous(curve: FourierCurve, speed: float, limit: float) -> None:
    law = time_law(curve, speed_m_s=speed, acceleration_m_s2=limit, tilt_rad=0.5)
    knots = np.concatenate((law.knots_t_s, law.knots_t_s + law.window_s))
    before, after = law.jet(knots - 1e-7)[2], law.jet(knots + 1e-7)[2]
    slopes = np.diff(law.rates) / np.maximum(np.diff(law.knots_t_s), 1e-12)
    steepest = 2.0 * np.abs(slopes).max() / law.window_s
    assert np.abs(after - before).max() <= 2e-7 * steepest + 1e-6


@given(curves, st.floats(0.5, 8.0), st.floats(0.1, 3.0), st.floats(0.0, 1.0))
@settings(deadline=None, max_examples=25)
def test_time_at_inverts_the_law(curve: FourierCurve, speed: float, limit: float, fraction: float) -> None:
    law = time_law(curve, speed_m_s=speed, acceleration_m_s2=limit, tilt_rad=0.5)
    place = fraction * curve.duration_s
    assert law.parameter(law.time_at(place)) == pytest.approx([place], abs=1e-7 * curve.duration_s)


@pytest.mark.parametrize("extension", Extension)
def test_the_papers_mission_keeps_its_times(extension: Extension) -> None:
    curve = fit_fourier(paper_path(), 28, extension)
    law = time_law(curve, speed_m_s=1.0, acceleration_m_s2=0.5, tilt_rad=0.35)
    assert curve.duration_s == pytest.approx(843.0, abs=1.0)
    assert law.duration_s - curve.duration_s < 1.0
    t = np.linspace(1.0, curve.duration_s, 500)
    assert np.abs(law.parameter(t) - t).max() < 1.0
    # The curve is really flown at the planned speed: slowed nowhere but at its ends.
    assert law.jet(t[1:-1])[1] == pytest.approx(np.ones(498), abs=1e-9)


def test_tilt_bounds_the_acceleration() -> None:
    curve = flown_curve(3, 20, Extension.ODD)
    tilt = 0.05
    limited = time_law(curve, speed_m_s=9.0, acceleration_m_s2=9.0, tilt_rad=tilt)
    same = time_law(curve, speed_m_s=9.0, acceleration_m_s2=GRAVITY_M_S2 * math.tan(tilt), tilt_rad=1.0)
    assert limited.duration_s == same.duration_s


def test_slower_vehicles_take_longer() -> None:
    curve = flown_curve(7, 30, Extension.ODD)
    durations = [
        time_law(curve, speed_m_s=speed, acceleration_m_s2=limit, tilt_rad=0.5).duration_s
        for speed, limit in ((50.0, 4.0), (5.0, 2.0), (1.0, 0.5))
    ]
    assert durations[0] < durations[1] < durations[2]


def test_a_straight_dash_takes_the_time_of_a_trapezoid() -> None:
    # 60 m at 6 m/s with 2 m/s^2: 3 s to speed, 3 s to rest, 9 m each; plus the window.
    tiny = np.full((1, 2), 1e-12)
    curve = FourierCurve(Extension.ODD, 10.0, np.zeros(2), np.array([6.0, 0.0]), tiny)
    law = time_law(curve, speed_m_s=6.1, acceleration_m_s2=2.0, tilt_rad=0.5, window_s=0.25)
    assert law.duration_s == pytest.approx(3.0 + 3.0 + 42.0 / 6.0 + 0.25, abs=0.02)


def test_stops_at_one_place_are_one_stop() -> None:
    curve = flown_curve(5, 10, Extension.ODD)
    single = time_law(curve, speed_m_s=5.0, acceleration_m_s2=2.0, tilt_rad=0.5, holds=((5.0, 4.0),))
    double = time_law(curve, speed_m_s=5.0, acceleration_m_s2=2.0, tilt_rad=0.5, holds=((5.0, 2.0), (5.0 + 1e-12, 4.0)))
    assert double.duration_s == pytest.approx(single.duration_s, abs=1e-9)


def test_laws_survive_json() -> None:
    curve = flown_curve(5, 10, Extension.ODD)
    law = time_law(curve, speed_m_s=5.0, acceleration_m_s2=2.0, tilt_rad=0.5, holds=((3.0, 2.0),))
    again = TimeLaw.from_json(json.loads(json.dumps(law.to_json())))
    t = np.linspace(0.0, law.duration_s, 99)
    assert (again.parameter(t) == law.parameter(t)).all()


@pytest.mark.parametrize(
    "change",
    [
        {"speed_m_s": 0.0},
        {"acceleration_m_s2": -1.0},
        {"tilt_rad": 0.0},
        {"tilt_rad": math.nan},
        {"tilt_rad": 1.6},
        {"holds": ((-1.0, 1.0),)},
        {"holds": ((1.0, math.inf),)},
        {"holds": ((1e9, 1.0),)},
        {"window_s": 0.0},
    ],
)
def test_impossible_limits_are_refused(change: dict[str, Any]) -> None:
    arguments: dict[str, Any] = {"speed_m_s": 5.0, "acceleration_m_s2": 2.0, "tilt_rad": 0.5} | change
    with pytest.raises(ValueError, match=r"must be positive|lies on the curve"):
        time_law(flown_curve(5, 10, Extension.ODD), **arguments)


@pytest.mark.parametrize(
    ("times", "places", "rates"),
    [
        ([0.0], [0.0], [0.0]),
        ([0.0, 1.0, 0.5], [0.0, 1.0, 2.0], [0.0, 1.0, 0.0]),
        ([0.0, 1.0], [0.0, -1.0], [0.0, 0.0]),
        ([0.0, 1.0], [0.0, 1.0], [0.0, -1.0]),
        ([0.0, 1.0], [0.0], [0.0, 0.0]),
    ],
)
def test_what_is_no_law_is_refused(times: list[float], places: list[float], rates: list[float]) -> None:
    with pytest.raises(ValueError, match="time law"):
        TimeLaw(np.array(times), np.array(places), np.array(rates), 0.5)


def test_a_path_that_stays_in_one_place_has_a_law() -> None:
    curve = FourierCurve(Extension.ODD, 1.0, np.array([3.0, 4.0]), np.zeros(2), np.zeros((1, 2)))
    law = time_law(curve, speed_m_s=5.0, acceleration_m_s2=2.0, tilt_rad=0.4, holds=((1.0, 2.0),))
    assert math.isfinite(law.duration_s)
    assert law.duration_s >= 2.0
