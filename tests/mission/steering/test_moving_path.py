"""Paths through moving triangles: against differences, images of the fixed path, and limits of speed."""

from itertools import pairwise

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from mission.errors import NoPlanError
from mission.geometry.location import Locator
from mission.geometry.moving import MovingPartition
from mission.planning.run import Run
from mission.steering.moving_path import MovingPath, within_speed
from mission.steering.path import SteeringPath, build_path
from tests.support.drawn_cases import tried
from tests.support.moving_meshes import shaken

SEEDS = st.integers(0, 10_000)


def some_path(seed: int) -> tuple[MovingPartition, SteeringPath]:
    """A path through some triangles one after the other, to stay in the last."""
    moving = shaken(seed, 0.5)
    assume(moving.first_flat() is None)
    across = moving.fixed.neighbours.tolist()
    states = [0]
    while len(states) < 7:
        onward = [near for near in across[states[-1]] if near >= 0 and near not in states]
        if not onward:
            break
        states.append(onward[seed % len(onward)])
    controls = tuple(1 + across[here].index(there) for here, there in pairwise(states))
    run = Run(tuple(states[:-1]), (states[-1],), (*controls, 0))
    path = build_path(
        moving.fixed,
        run,
        start_m=moving.fixed.incentres_m[0],
        speed_m_s=2.0,
        final_stay_s=2.0,
        settle_in=frozenset({2}),
    )
    return moving, path


@tried(30)
@given(seed=SEEDS)
def test_it_is_the_image_of_the_fixed_path_and_its_velocity_and_acceleration_are_its_derivatives(seed: int) -> None:
    moving, fixed = some_path(seed)
    path = MovingPath(moving, fixed)
    times = np.random.default_rng(seed).uniform(0.0, path.duration_s, 60)
    position, velocity, acceleration = path.state(times)
    triangles = path.triangles_at(times)
    assert np.abs(position - moving.carried(times, fixed.position(times), triangles)).max() < 1e-9
    found = Locator(moving.fixed).triangle_at(moving.pulled_back(times, position))
    off_edges = moving.fixed.barycentric(triangles, fixed.position(times)).min(axis=1) > 1e-6
    assert (found == triangles)[off_edges].all()
    step_s = 1e-5
    smooth = np.abs(times[:, None] - path.knots_s).min(axis=1) > 2 * step_s
    (before, slow, _), (after, fast, _) = (path.state(times + sign * step_s) for sign in (-1, 1))
    assert np.abs((after - before) / (2 * step_s) - velocity)[smooth].max() < 1e-5
    assert np.abs((fast - slow) / (2 * step_s) - acceleration)[smooth].max() < 1e-4


@tried(15)
@given(seed=SEEDS)
def test_its_velocity_jumps_where_it_says_and_its_position_nowhere(seed: int) -> None:
    path = MovingPath(*some_path(seed))
    inner = path.knots_s[1:-1]
    eps_s = 1e-9
    (before, slow, _), (after, fast, _) = (path.state(inner + sign * eps_s) for sign in (-1, 1))
    apart = np.diff(path.knots_s).min() > 4 * eps_s
    assert np.abs(after - before).max() < 1e-7
    assert not apart or np.abs(fast - slow - path.jumps_m_s).max() < 1e-5


@tried(30)
@given(seed=SEEDS, limit=st.sampled_from([0.8, 1.2, 2.0, 9.0]))
def test_it_is_slowed_down_to_a_limit_and_goes_the_same_way(seed: int, limit: float) -> None:
    moving, fixed = some_path(seed)
    assume(moving.fastest_m_s < limit)
    path = within_speed(moving, fixed, limit)
    speeds = np.linalg.norm(path.state(np.linspace(0.0, path.duration_s, 2000))[1], axis=1)
    assert speeds.max() <= limit * (1.0 + 1e-9)
    assert limit < 9.0 or path.duration_s == pytest.approx(fixed.duration_s, rel=1e-12)
    for slowed, before in zip(path.fixed.segments, fixed.segments, strict=True):
        share = np.linspace(0.0, 1.0, 9)[:-1]
        ways = [
            each.position(segment.start_s + share * segment.duration_s)
            for each, segment in ((path.fixed, slowed), (fixed, before))
        ]
        assert np.abs(ways[0] - ways[1]).max() < 1e-7


def test_a_limit_that_the_frame_alone_exceeds_is_refused_with_its_figures() -> None:
    mesh = shaken(4, 0.5).fixed
    places = np.repeat(mesh.vertices_m[None], 3, axis=0)
    inner = int(np.flatnonzero(~np.isin(np.arange(len(mesh.vertices_m)), range(4)))[0])
    places[2, inner] += [0.03, 0.04]
    moving = MovingPartition(mesh, np.array([0.0, 1.0, 1.01]), places)
    here = int(np.flatnonzero((mesh.triangles == inner).any(axis=1))[0])
    stay = Run((), (here,), (0,))

    def path(stay_s: float) -> SteeringPath:
        return build_path(mesh, stay, start_m=mesh.incentres_m[here], speed_m_s=1.0, final_stay_s=stay_s)

    x, y = mesh.vertices_m[inner]
    told = rf"triangle {here}, .*from 1.0 s on its corner that is \({x:.6g}, {y:.6g}\) m .* 5 m/s, and .* is 4$"
    with pytest.raises(NoPlanError, match=told):
        within_speed(moving, path(2.0), 4.0)
    assert within_speed(moving, path(0.9), 4.0).duration_s == pytest.approx(0.9)  # it is over before that
    assert within_speed(moving, path(2.0), 5.5).duration_s > 2.0
