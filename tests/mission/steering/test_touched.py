"""Which triangles a tube touches in a domain that moves, against places in it at instants of their own."""

import numpy as np
import pytest
import shapely
from hypothesis import given
from hypothesis import strategies as st

from mission.geometry.arrays import FloatArray
from mission.geometry.location import Locator
from mission.geometry.moving import MovingPartition
from mission.spec.model import Extension
from mission.steering.enclosure import enclose
from mission.steering.joined import JoinedCurve
from mission.steering.smoothing import FourierCurve
from mission.steering.touched import MovingTouched, StillTouched
from tests.support.drawn_cases import tried
from tests.support.moving_meshes import shaken, some_mesh

TUBE_M = 0.7
SLOWER = 0.1
"""Seconds that a unit of the parameter takes."""


def wandering(seed: int) -> JoinedCurve:
    """A curve about the middle of the meshes, which takes 8 s."""
    rng = np.random.default_rng(seed)
    amplitudes = rng.normal(size=(4, 2)) * 3.0 / np.arange(1, 5)[:, None]
    return JoinedCurve((FourierCurve(Extension.EVEN, 80.0, np.array([10.0, 10.0]), np.zeros(2), amplitudes),))


def timing(begins: FloatArray, ends: FloatArray) -> tuple[FloatArray, FloatArray]:
    return SLOWER * begins, SLOWER * ends


@given(seed=st.integers(0, 10_000))
@tried(30)
def test_a_triangle_that_a_flight_is_in_is_among_those_of_its_piece(seed: int) -> None:
    moving, curve, rng = shaken(seed, 0.4), wandering(seed), np.random.default_rng(seed)
    if moving.first_flat() is not None:
        return
    enclosure = enclose(curve, 40)
    touched = MovingTouched(moving, np.zeros(moving.fixed.size, dtype=np.bool_), TUBE_M, timing)
    contacts = touched.pieces(enclosure)
    places = rng.uniform(0.0, 80.0, 60)
    aside = rng.uniform(-TUBE_M, TUBE_M, (60, 2))
    for s, place in zip(places.tolist(), curve.position(places) + aside, strict=True):
        piece = int(np.searchsorted(enclosure.knots_s, s, side="right"))  # the first set is that of the start
        triangle = int(Locator(moving.at(SLOWER * s)).triangle_at(place[None])[0])
        if triangle < 0:
            assert contacts.outside[piece]
        else:
            assert triangle in contacts.sets[piece]


def test_in_a_domain_that_stands_it_is_what_is_touched_there() -> None:
    mesh = some_mesh(4)
    moving = MovingPartition(mesh, np.zeros(1), mesh.vertices_m[None])
    restricted = np.arange(mesh.size) == 3
    enclosure = enclose(wandering(2), 64)
    still, other = StillTouched(mesh, restricted, TUBE_M), MovingTouched(moving, restricted, TUBE_M, timing)
    for name in ("pieces", "knots"):
        one, two = getattr(still, name)(enclosure), getattr(other, name)(enclosure)
        assert one.sets == two.sets
        assert (one.outside == two.outside).all()
        assert np.abs(one.depth_m - two.depth_m).max() < 1e-9
        assert (one.centres() == two.centres()).all()
    assert still.end(enclosure, 1.5).sets == other.end(enclosure, 1.5).sets
    assert other.clearance_m(wandering(2), enclosure) == pytest.approx(
        still.clearance_m(wandering(2), enclosure), rel=0.02
    )


@given(seed=st.integers(0, 10_000))
@tried(15)
def test_the_clearance_is_that_of_dense_samples_or_a_little_less(seed: int) -> None:
    moving, curve = shaken(seed, 0.4), wandering(seed)
    if moving.first_flat() is not None:
        return
    restricted = np.arange(moving.fixed.size) == seed % moving.fixed.size
    touched = MovingTouched(moving, restricted, TUBE_M, timing)
    bound = touched.clearance_m(curve, enclose(curve, 64))
    places = np.linspace(0.0, 80.0, 1601)
    corners = moving.corners_at(SLOWER * places, np.full(len(places), np.flatnonzero(restricted)[0]))
    sampled = float(shapely.distance(shapely.points(curve.position(places)), shapely.polygons(corners)).min())
    assert bound is not None
    assert bound <= sampled
    assert bound >= 0.85 * sampled - 0.05


def test_what_moves_after_the_end_is_met_where_the_flight_rests() -> None:
    mesh = some_mesh(4)
    inner = 4 + int(np.argmin(np.linalg.norm(mesh.vertices_m[4:] - 10.0, axis=1)))
    later = mesh.vertices_m.copy()
    later[inner] += 1.0
    moving = MovingPartition(mesh, np.array([0.0, 20.0, 30.0]), np.stack((mesh.vertices_m, mesh.vertices_m, later)))
    assert moving.first_flat() is None
    nothing = np.zeros(mesh.size, dtype=np.bool_)
    place = later[inner] - 0.2
    before = set(Locator(mesh).triangles_touching((float(place[0]), float(place[1]))).tolist())
    rest = MovingTouched(moving, nothing, 0.0, timing).rest(place[None], 0.0, np.array([8.0]))
    assert before < set(rest.sets[0])
