"""The velocities that are asked for: out through the facet, and never faster toward a wall than can be braked."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from mission.geometry.arrays import FloatArray
from mission.geometry.triangulation import triangulate_nodes
from mission.steering.facet_control import affine_fields, exit_velocities
from mission.steering.field_law import LAG_S, FieldLaw, Frame

PARTITION = triangulate_nodes(np.array([(0.0, 0.0), (30.0, 0.0), (30.0, 20.0), (0.0, 20.0), (11.0, 9.0), (21.0, 12.0)]))
LAW = FieldLaw(PARTITION, speed_m_s=4.0, acceleration_m_s2=2.5, braking_m_s2=1.25, margin_m=0.5)
STILL = LAW.frame(0.0)
WALL = np.array([[0, 1]])
GAP = np.array([[0, 1], [2, 3]])
PLACES = st.tuples(st.floats(0.1, 29.9), st.floats(0.1, 19.9)).map(np.array)
VELOCITIES = st.tuples(st.floats(-8.0, 8.0), st.floats(-8.0, 8.0)).map(np.array)


@given(
    triangle=st.integers(0, PARTITION.size - 1),
    facet=st.integers(0, 2),
    shares=st.tuples(*[st.floats(0.01, 1.0)] * 3).map(np.array),
)
def test_it_is_the_affine_field_at_one_speed(triangle: int, facet: int, shares: FloatArray) -> None:
    place = shares @ PARTITION.corners_m[triangle] / shares.sum()
    F, g = affine_fields(PARTITION.corners_m, exit_velocities(PARTITION, 1.0)[:, facet])
    field = F[triangle] @ place + g[triangle]
    asked = LAW.leaving(triangle, facet, place, STILL)
    np.testing.assert_allclose(asked, 4.0 * field / np.linalg.norm(field), atol=1e-9)
    assert asked @ PARTITION.normals[triangle, facet] > 0.0


@given(wanted=VELOCITIES, place=PLACES, velocity=VELOCITIES)
def test_it_can_brake_before_the_margin(wanted: FloatArray, place: FloatArray, velocity: FloatArray) -> None:
    asked = LAW.guarded(wanted, place, velocity, WALL, frame=STILL, drift_m_s=np.zeros(2))
    toward = -asked[1]
    room = place[1] - LAW.margin_m - LAG_S * max(-velocity[1], 0.0)
    if room > 0.0:
        assert toward <= np.sqrt(2.0 * LAW.braking_m_s2 * room) + 1e-9
    elif wanted[1] <= 0.0 and place[1] - 0.1 - LAG_S * max(-velocity[1], 0.0) <= 0.0:
        assert toward <= 1e-9
    if toward < -wanted[1] - 1e-9 and room > 0.0:  # braked: no slower than it need be, and along the wall as wanted
        np.testing.assert_allclose(asked[0], wanted[0])


def test_a_gap_between_walls_that_leaves_no_margin_is_passed_slowly() -> None:
    gap = Frame(np.array([[-10.0, 0.0], [-0.4, 0.0], [0.4, 0.0], [10.0, 0.0]]), np.zeros((4, 2)))
    place, velocity, still = np.array([0.1, -3.0]), np.zeros(2), np.zeros(2)
    nearest = 1e9
    for _ in range(2000):
        asked = LAW.guarded(np.array([0.0, 4.0]), place, velocity, GAP, frame=gap, drift_m_s=still)
        velocity = velocity + np.clip(asked - velocity, -0.1, 0.1)
        place = place + 0.05 * velocity
        nearest = min(nearest, *(float(np.hypot(*(place - [end, 0.0]))) for end in (-0.4, 0.4)))
    assert place[1] > 3.0
    assert nearest > 0.1


@given(place=PLACES)
def test_it_comes_to_stand_without_passing(place: FloatArray) -> None:
    point, velocity = np.array([15.0, 10.0]), LAW.standing(np.array([15.0, 10.0]), place)
    distance = float(np.hypot(*(point - place)))
    assert np.hypot(*velocity) <= min(4.0, np.sqrt(2.0 * LAW.braking_m_s2 * distance)) + 1e-9
    assert velocity @ (point - place) >= 0.0
