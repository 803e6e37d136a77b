"""Position, velocity and acceleration of a trajectory belong together."""

import json

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from mission.spec.model import Extension
from mission.steering.smoothing import FourierCurve
from mission.steering.timing import time_law
from mission.steering.trajectory import Trajectory


def some_trajectory(seed: int, waves: int, extension: Extension) -> Trajectory:
    rng = np.random.default_rng(seed)
    slope = rng.normal(size=2) if extension is Extension.ODD else np.zeros(2)
    amplitudes = 20.0 * rng.normal(size=(waves, 2)) / (np.arange(1, waves + 1) ** 2)[:, None]
    curve = FourierCurve(extension, rng.uniform(20.0, 200.0), rng.normal(size=2), slope, amplitudes)
    stop = (0.4 * curve.duration_s, 3.0)
    law = time_law(curve, speed_m_s=6.0, acceleration_m_s2=2.0, tilt_rad=0.4, holds=(stop,))
    return Trajectory(curve, law, 15.0)


trajectories = st.builds(some_trajectory, st.integers(0, 10**6), st.integers(1, 30), st.sampled_from(Extension))


@given(trajectories, st.integers(0, 10**6))
@settings(deadline=None, max_examples=40)
def test_derivatives_agree_with_differences(trajectory: Trajectory, seed: int) -> None:
    t = np.random.default_rng(seed).uniform(0.0, trajectory.duration_s, 200)
    # Differences of differences: away from the law's knots, at which the third derivative jumps.
    knots = np.concatenate((trajectory.law.knots_t_s, trajectory.law.knots_t_s + trajectory.law.window_s))
    step = 2e-4
    t = t[np.abs(t[:, None] - knots).min(axis=1) > 2 * step]
    early, late = trajectory.state(t - step), trajectory.state(t + step)
    assert (late[0] - early[0]) / (2 * step) == pytest.approx(trajectory.velocity(t), abs=1e-6)
    assert (late[1] - early[1]) / (2 * step) == pytest.approx(trajectory.acceleration(t), abs=1e-5)


@given(trajectories)
@settings(deadline=None, max_examples=20)
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
