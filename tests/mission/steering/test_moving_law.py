"""The law of flights by the field in triangles that move: it leads out by the facet, and knows how walls move."""

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from mission.geometry.moving import MovingPartition
from mission.steering.facet_control import exit_velocities, stay_equilibria
from mission.steering.field_law import FieldLaw, Frame
from mission.steering.moving_fields import MovingFields
from tests.support.drawn_cases import tried
from tests.support.moving_meshes import shaken

SEEDS = st.integers(0, 10_000)
VELOCITIES = st.tuples(st.floats(-6.0, 6.0), st.floats(-6.0, 6.0)).map(np.array)


def law_of(moving: MovingPartition) -> FieldLaw:
    return FieldLaw(moving.fixed, speed_m_s=3.0, acceleration_m_s2=2.5, braking_m_s2=1.25, margin_m=0.5, moving=moving)


def unfolded(seed: int) -> MovingPartition:
    moving = shaken(seed, 0.5)
    assume(moving.first_flat() is None)
    return moving


@tried(60)
@given(seed=SEEDS)
def test_it_asks_for_the_carried_field_at_one_speed(seed: int) -> None:
    moving, rng = unfolded(seed), np.random.default_rng(seed)
    law, time_s = law_of(moving), float(rng.uniform(0.0, 8.0))
    triangle, facet = int(rng.integers(moving.fixed.size)), int(rng.integers(3))
    shares = rng.dirichlet(np.ones(3))
    frame, fields = (
        law.frame(time_s),
        MovingFields(moving, np.array([triangle]), exit_velocities(moving.fixed, 1.0)[[triangle], facet]),
    )
    vertices = moving.fixed.triangles[triangle]
    drift = shares @ moving.velocities_at(time_s)[vertices]
    place = shares @ moving.vertices_at(time_s)[vertices]
    carried = shares @ fields.vertex_velocities(time_s)[0] - drift
    asked = law.leaving(triangle, facet, place, frame)
    assert np.linalg.norm(asked) == pytest.approx(3.0, rel=1e-9)
    own = asked - drift
    assert own @ carried == pytest.approx(np.linalg.norm(own) * np.linalg.norm(carried), rel=1e-9)
    assert law.drift(triangle, place, frame) == pytest.approx(drift, abs=1e-9)
    stands = moving.carried(np.array([time_s]), stay_equilibria(moving.fixed)[[triangle]], np.array([triangle]))[0]
    assert law.stand_m(triangle, frame) == pytest.approx(stands, abs=1e-9)


@tried(30)
@given(seed=SEEDS)
def test_who_flies_it_leaves_by_the_facet(seed: int) -> None:
    moving, rng = unfolded(seed), np.random.default_rng(seed)
    law, step_s = law_of(moving), 0.01
    triangle, facet = int(rng.integers(moving.fixed.size)), int(rng.integers(3))
    own = np.array([triangle])
    time_s, place = 0.0, rng.dirichlet(np.ones(3)) @ moving.fixed.corners_m[triangle]
    for _ in range(1500):
        place = place + step_s * law.leaving(triangle, facet, place, law.frame(time_s))
        time_s += step_s
        shares = moving.at(time_s).barycentric(own, place[None])[0]
        if shares.min() < 0.0:
            break
    assert shares.argmin() == facet


@given(wanted=VELOCITIES, velocity=VELOCITIES, drift=VELOCITIES, y=st.floats(0.2, 9.0))
def test_walls_that_move_with_all_the_rest_are_kept_off_as_if_they_stood(
    wanted: np.ndarray, velocity: np.ndarray, drift: np.ndarray, y: float
) -> None:
    law, place, walls = law_of(shaken(1, 0.0)), np.array([5.0, y]), np.array([[0, 1], [1, 2]])
    ends = np.array([[0.0, 0.0], [10.0, 0.0], [10.0, 10.0]])
    still, moved = (Frame(ends, np.tile(each, (3, 1))) for each in (np.zeros(2), drift))
    asked = law.guarded(wanted, place, velocity, walls, frame=still, drift_m_s=np.zeros(2))
    along = law.guarded(wanted + drift, place, velocity + drift, walls, frame=moved, drift_m_s=drift)
    assert along == pytest.approx(asked + drift, abs=1e-6)


def test_a_wall_that_comes_nearer_is_given_way_to_and_one_that_recedes_may_be_followed() -> None:
    law, place, still = law_of(shaken(1, 0.0)), np.array([5.0, 1.0]), np.zeros(2)
    ends, walls = np.array([[0.0, 0.0], [10.0, 0.0]]), np.array([[0, 1]])

    def north(speed_m_s: float) -> float:
        frame = Frame(ends, np.tile([0.0, speed_m_s], (2, 1)))
        return float(law.guarded(np.array([0.0, -3.0]), place, still, walls, frame=frame, drift_m_s=still)[1])

    assert north(1.0) > north(0.0) > north(-1.0)
    assert north(2.0) > 0.0
