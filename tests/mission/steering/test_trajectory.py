"""Position, velocity and acceleration of a trajectory belong together."""

import json
from functools import cache

import numpy as np
import pytest
from hypothesis import given, reject, settings
from hypothesis import strategies as st

from mission.spec.model import Extension
from mission.steering.bezier import BezierCurve
from mission.steering.grid import Limits
from mission.steering.joined import joins_smoothly
from mission.steering.smoothing import FourierCurve
from mission.steering.timing import even_rate, time_law
from mission.steering.trajectory import Leg, Trajectory
from tests.support.drawn_cases import tried


def some_trajectory(seed: int, waves: int, extension: Extension) -> Trajectory:
    rng = np.random.default_rng(seed)
    slope = rng.normal(size=2) if extension is Extension.ODD else np.zeros(2)
    amplitudes = 20.0 * rng.normal(size=(waves, 2)) / (np.arange(1, waves + 1) ** 2)[:, None]
    curve = FourierCurve(extension, rng.uniform(20.0, 200.0), rng.normal(size=2), slope, amplitudes)
    stop = (0.4 * curve.duration_s, 3.0)
    law = time_law(curve, Limits(6.0, 2.0, 4.0), holds=(stop,))
    return Trajectory((Leg(curve, law),), 15.0)


trajectories = st.builds(some_trajectory, st.integers(0, 10**6), st.integers(1, 30), st.sampled_from(Extension))


@given(trajectories, st.integers(0, 10**6))
@tried(40)
def test_derivatives_agree_with_differences(trajectory: Trajectory, seed: int) -> None:
    t = np.random.default_rng(seed).uniform(0.0, trajectory.duration_s, 200)
    # Differences of differences: away from the law's knots, at which the third derivative jumps.
    law = trajectory.legs[0].law
    step = 2e-4
    t = t[np.abs(t[:, None] - law.knots_t_s).min(axis=1) > 2 * step]
    early, late = trajectory.state(t - step), trajectory.state(t + step)
    assert (late[0] - early[0]) / (2 * step) == pytest.approx(trajectory.velocity(t), abs=1e-6)
    assert (late[1] - early[1]) / (2 * step) == pytest.approx(trajectory.acceleration(t), abs=1e-5)


@given(trajectories)
@tried(20)
def test_outside_its_span_it_rests_at_the_ends(trajectory: Trajectory) -> None:
    t = np.array([-1.0, 0.0, trajectory.duration_s, trajectory.duration_s + 1.0])
    ends = trajectory.curve.position(np.array([0.0, 0.0, trajectory.curve.duration_s, trajectory.curve.duration_s]))
    position, velocity, acceleration = trajectory.state(t)
    assert position == pytest.approx(ends, abs=1e-8)
    assert velocity == pytest.approx(np.zeros((4, 2)), abs=1e-8)
    assert acceleration == pytest.approx(np.zeros((4, 2)), abs=1e-8)
    assert (trajectory.position(t) == position).all()


def test_trajectories_survive_json() -> None:
    trajectory = some_trajectory(4, 12, Extension.ODD)
    again = Trajectory.from_json(json.loads(json.dumps(trajectory.to_json())))
    t = np.linspace(0.0, trajectory.duration_s, 77)
    for mine, theirs in zip(trajectory.state(t), again.state(t), strict=True):
        assert (mine == theirs).all()
    assert again.altitude_m == trajectory.altitude_m


def lapping(seed: int, laps: int | None = 3) -> Trajectory:
    """A way to a lap, the lap, and a way back."""
    return Trajectory(legs_of(seed), 15.0, 1, laps)


@cache
def legs_of(seed: int) -> tuple[Leg, ...]:
    rng = np.random.default_rng(seed)
    seam, legs = rng.normal(size=2), []
    for begin, end in ((rng.normal(size=2) * 9.0, seam), (seam, seam), (seam, rng.normal(size=2) * 9.0)):
        duration_s = rng.uniform(10.0, 40.0)
        waves = 8.0 * rng.normal(size=(6, 2)) / (np.arange(1, 7) ** 2)[:, None]
        curve = FourierCurve(Extension.ODD, duration_s, begin, (end - begin) / duration_s, waves)
        law = time_law(curve, Limits(6.0, 2.0, 4.0))
        legs.append(Leg(curve, law))
    return tuple(legs)


@pytest.mark.parametrize("seed", range(3))
def test_laps_repeat_and_join_without_a_jump(seed: int) -> None:
    trajectory = lapping(seed)
    out_s, lap_s, back_s = (leg.duration_s for leg in trajectory.legs)
    assert trajectory.duration_s == pytest.approx(out_s + 3.0 * lap_s + back_s)
    assert trajectory.laps_end_s == pytest.approx(out_s + 3.0 * lap_s)
    own = np.linspace(0.0, lap_s, 40)[1:-1]
    expected = trajectory.legs[1].state(own)
    for lap in range(3):
        for found, wanted in zip(trajectory.state(out_s + lap * lap_s + own), expected, strict=True):
            assert found == pytest.approx(wanted, abs=1e-9)
    for seam_s in out_s + lap_s * np.arange(4):
        before, at, after = (trajectory.state(seam_s + np.array([step])) for step in (-1e-6, 0.0, 1e-6))
        for values in zip(before, at, after, strict=True):
            assert np.ptp(np.concatenate(values), axis=0) == pytest.approx(0.0, abs=1e-4)
        assert at[1] == pytest.approx(np.zeros((1, 2)), abs=1e-6)


def test_the_parameter_is_that_of_the_path_with_each_leg_once() -> None:
    trajectory = lapping(1)
    times = np.linspace(0.0, trajectory.duration_s, 300)
    places = trajectory.parameter(times)
    assert trajectory.curve.position(places) == pytest.approx(trajectory.position(times), abs=1e-7)
    assert places[-1] == pytest.approx(trajectory.curve.duration_s)


@given(st.floats(0.0, 500.0), st.sampled_from([None, 1, 2, 7]))
@tried(60)
def test_to_end_laps_changes_nothing_before_the_present_one_is_over(now_s: float, laps: int | None) -> None:
    trajectory = lapping(2, laps)
    ended = trajectory.ended_after(now_s)
    assert ended.laps is not None
    assert laps is None or ended.laps <= laps
    assert ended.duration_s < np.inf
    until_s = min(now_s, trajectory.duration_s)
    times = np.linspace(0.0, until_s, 50)
    assert (ended.position(times) == trajectory.position(times)).all()
    out_s, lap_s, _ = (leg.duration_s for leg in trajectory.legs)
    if now_s < trajectory.laps_end_s:
        # It is over with the lap that is flown, or with the first.
        assert now_s <= ended.laps_end_s <= max(now_s, out_s) + lap_s + 1e-9


def test_laps_without_an_end_go_on_for_ever() -> None:
    trajectory = lapping(0, None)
    assert trajectory.duration_s == np.inf
    out_s, lap_s, _ = (leg.duration_s for leg in trajectory.legs)
    early, late = trajectory.position([out_s + 3.0, out_s + 1000.0 * lap_s + 3.0])
    assert late == pytest.approx(early, abs=1e-6)


@pytest.mark.parametrize(
    ("lap", "laps", "words"), [(0, 1, "where it begins"), (3, 1, "where it begins"), (1, 0, "once or more")]
)
def test_what_is_no_lap_is_refused(lap: int, laps: int, words: str) -> None:
    legs = lapping(0).legs
    with pytest.raises(ValueError, match=words):
        Trajectory(legs, 15.0, lap, laps)


def test_legs_that_do_not_join_are_refused() -> None:
    out, lap, back = lapping(0).legs
    with pytest.raises(ValueError, match="do not join"):
        Trajectory((lap, out, back), 15.0)


def test_laps_survive_json() -> None:
    for laps in (None, 4):
        trajectory = lapping(5, laps)
        again = Trajectory.from_json(json.loads(json.dumps(trajectory.to_json())))
        assert (again.lap, again.laps, again.duration_s) == (1, laps, trajectory.duration_s)
        assert (again.position([33.0, 99.0]) == trajectory.position([33.0, 99.0])).all()


def a_round(seed: int) -> tuple[BezierCurve, BezierCurve, BezierCurve]:
    """A way to a lap, the lap, and a way back, which go on smoothly."""
    rng = np.random.default_rng(seed)
    seam = [rng.normal(size=2), 2.0 * rng.normal(size=2), 0.5 * rng.normal(size=2)]
    away = [20.0 * rng.normal(size=2), 2.0 * rng.normal(size=2), np.zeros(2)]

    def spline(begin: list[np.ndarray], end: list[np.ndarray], lasts_s: float) -> BezierCurve:
        """The piece of degree 5 between two jets."""
        (p, v, a), (q, w, b), h = begin, end, lasts_s
        points = [p, p + v * h / 5, p + 2 * v * h / 5 + a * h**2 / 20, q - 2 * w * h / 5 + b * h**2 / 20, q - w * h / 5]
        return BezierCurve(np.array([0.0, h]), np.array([[*points, q]]))

    return spline(away, seam, 6.0), spline(seam, seam, 9.0), spline(seam, away, 7.0)


@given(st.integers(0, 10**6), st.floats(2.0, 8.0), st.floats(0.5, 4.0), st.floats(0.8, 12.0))
@settings(deadline=None, max_examples=6)
def test_laps_that_join_smoothly_are_flown_through(seed: int, speed: float, acceleration: float, jerk: float) -> None:
    out, lap, back = a_round(seed)
    assert joins_smoothly(out, lap)
    assert joins_smoothly(lap, lap)
    assert joins_smoothly(lap, back)
    limits = Limits(speed, acceleration, jerk)
    rate = min(even_rate(curve, limits, np.inf) for curve in (out, lap, back))
    try:
        laws = [
            time_law(curve, limits, ends=ends)
            for curve, ends in ((out, (0, rate)), (lap, (rate, rate)), (back, (rate, 0)))
        ]
    except ValueError:
        reject()  # where the ends of laps are stops
    resting = time_law(lap, limits)
    assert laws[1].duration_s < resting.duration_s
    trajectory = Trajectory(tuple(Leg(*each) for each in zip((out, lap, back), laws, strict=True)), 10.0, 1, 3)
    t = np.linspace(0.0, trajectory.duration_s, 8001)
    _, velocity, acceleration_of = trajectory.state(t)
    assert np.linalg.norm(velocity, axis=1).max() <= speed * (1.0 + 1e-6)
    assert np.linalg.norm(acceleration_of, axis=1).max() <= acceleration * (1.0 + 1e-6)
    # Between any two instants, those of seams among them, the acceleration changes by no more than the jerk admits.
    changes = np.linalg.norm(np.diff(acceleration_of, axis=0), axis=1) / np.diff(t)
    assert changes.max() <= jerk * (1.0 + 1e-3) + 1e-3
    first, last = laws[0].duration_s, laws[0].duration_s + 3.0 * laws[1].duration_s
    assert np.linalg.norm(trajectory.velocity([first, last]), axis=1).min() > 0.0


def test_a_velocity_that_jumps_is_refused() -> None:
    out, lap, back = a_round(3)
    limits = Limits(4.0, 2.0, 4.0)
    legs = tuple(Leg(curve, time_law(curve, limits)) for curve in (out, lap, back))
    rate = 0.5 * even_rate(lap, limits, np.inf)
    moving = Leg(lap, time_law(lap, limits, ends=(rate, rate)))
    with pytest.raises(ValueError, match="do not jump"):
        Trajectory((legs[0], moving, legs[2]), 10.0, 1, 3)
