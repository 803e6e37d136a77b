"""Enclosures contain the curve, contacts miss no triangle, and distances are lower bounds: against shapely."""

from dataclasses import replace

import numpy as np
import pytest
import shapely
from hypothesis import given
from hypothesis import strategies as st

from mission.geometry.arrays import FloatArray
from mission.geometry.triangulation import triangulate_nodes
from mission.spec.model import Extension
from mission.steering.enclosure import ContactSearch, RegionDistance, clearance, enclose, insert_knots, split
from mission.steering.joined import JoinedCurve
from mission.steering.smoothing import FourierCurve, fit_fourier
from tests.support.curves import marked, paper_partition, paper_path
from tests.support.domains import random_nodes
from tests.support.drawn_cases import tried


def wandering_curve(seed: int, waves: int, extension: Extension) -> FourierCurve:
    """A curve about the middle of the random domains."""
    rng = np.random.default_rng(seed)
    amplitudes = rng.normal(size=(waves, 2)) * (30.0, 20.0) / (np.arange(1, waves + 1) ** 1.5)[:, None]
    slope = rng.normal(size=2) * 0.2 if extension is Extension.ODD else np.zeros(2)
    return FourierCurve(extension, 80.0, np.array([75.0, 50.0]), slope, amplitudes)


def swept(p: FloatArray, q: FloatArray, width: float) -> shapely.Geometry:
    corners = np.array([(-1, -1), (-1, 1), (1, -1), (1, 1)]) * width
    return shapely.MultiPoint(np.concatenate((p + corners, q + corners))).convex_hull


def joined(legs: list[FourierCurve]) -> JoinedCurve:
    """The curves one after the other, each shifted to where the one before it ends."""
    placed = legs[:1]
    for leg in legs[1:]:
        shift = placed[-1].position([placed[-1].duration_s])[0] - leg.position([0.0])[0]
        placed.append(replace(leg, base_m=leg.base_m + shift))
    return JoinedCurve(tuple(placed))


@given(
    st.lists(
        st.builds(wandering_curve, st.integers(0, 10**6), st.integers(1, 30), st.sampled_from(Extension)),
        min_size=1,
        max_size=3,
    ),
    st.integers(0, 10**6),
)
@tried(30)
def test_the_curve_stays_within_its_pieces(legs: list[FourierCurve], seed: int) -> None:
    curve = joined(legs)
    rng = np.random.default_rng(seed)
    enclosure = enclose(curve, curve.frequencies + int(rng.integers(1, 40)))
    enclosure = insert_knots(curve, enclosure, rng.uniform(-1.0, 81.0 * len(legs), 5))
    enclosure = split(curve, enclosure, rng.random(len(enclosure.remainder_m)) < 0.3, 3)
    assert enclosure.knots_s[[0, -1]] == pytest.approx([0.0, 80.0 * len(legs)])
    assert np.isin(curve.starts_s, enclosure.knots_s).all()
    # Where two legs meet there is a piece without length.
    assert np.unique(enclosure.knots_s).tolist() == sorted(set(enclosure.knots_s) | set(curve.starts_s))
    assert np.count_nonzero(np.diff(enclosure.knots_s) == 0.0) == len(legs) - 1
    assert (np.diff(enclosure.knots_s) >= 0.0).all()
    assert enclosure.points_m == pytest.approx(curve.position(enclosure.knots_s), abs=1e-9)
    shares = np.linspace(0.0, 1.0, 21)
    inside = enclosure.knots_s[:-1, None] + np.diff(enclosure.knots_s)[:, None] * shares
    points = curve.position(inside.ravel()).reshape(*inside.shape, 2)
    chords = enclosure.points_m[:-1, None] + shares[:, None] * np.diff(enclosure.points_m, axis=0)[:, None]
    assert (np.linalg.norm(points - chords, axis=2).max(axis=1) <= enclosure.remainder_m + 1e-12).all()


@given(st.integers(0, 10**6), st.integers(6, 40))
@tried(40)
def test_contacts_are_those_of_the_swept_squares(seed: int, nodes: int) -> None:
    rng = np.random.default_rng(seed)
    partition = triangulate_nodes(random_nodes(seed, nodes))
    starts = rng.uniform((0.0, 0.0), (150.0, 100.0), (12, 2))
    ends = starts + rng.normal(size=(12, 2)) * rng.choice([0.0, 1.0, 30.0], (12, 1))
    widths = rng.choice([0.0, 0.3, 5.0], 12)
    contacts = ContactSearch(partition).contacts(starts, ends, widths)
    triangles = shapely.polygons(partition.corners_m)
    domain = shapely.union_all(triangles)
    for k, found in enumerate(contacts.sets):
        shape = swept(starts[k], ends[k], max(widths[k], 1e-12))
        gaps = shapely.distance(shape, triangles)
        assert set(np.flatnonzero(gaps == 0.0).tolist()) <= set(found)
        assert set(found) <= set(np.flatnonzero(gaps <= 1e-7).tolist())
        rim = shapely.distance(shape, domain.boundary)
        if rim > 1e-6:
            assert contacts.outside[k] == (not domain.contains(shape))
        elif rim == 0.0:
            assert contacts.outside[k]


def test_the_deepest_triangle_is_the_one_with_the_centre() -> None:
    partition = paper_partition()
    centres = partition.corners_m.mean(axis=1)
    contacts = ContactSearch(partition).contacts(centres, centres, np.full(partition.size, 0.5))
    assert contacts.centres().tolist() == list(range(partition.size))
    assert contacts.marked(marked(partition, (6,)))[6]


def test_squares_beyond_the_domain_touch_nothing() -> None:
    far = np.array([[100.0, 100.0]])
    contacts = ContactSearch(paper_partition()).contacts(far, far, np.array([1.0]))
    assert contacts.sets == [()]
    assert contacts.outside.tolist() == [True]
    assert contacts.centres().tolist() == [-1]


@pytest.mark.parametrize("extension", Extension)
@pytest.mark.parametrize("restricted", [(6,), (2, 6, 7), (9,), (1, 3)])
def test_clearance_is_a_tight_lower_bound(extension: Extension, restricted: tuple[int, ...]) -> None:
    partition = paper_partition()
    curve = JoinedCurve((fit_fourier(paper_path(), 28, extension),))
    distance = RegionDistance(partition, marked(partition, restricted))
    bound = clearance(curve, enclose(curve, 256), distance)
    region = shapely.union_all(shapely.polygons(partition.corners_m[list(restricted)]))
    dense = shapely.points(curve.position(np.linspace(0.0, curve.duration_s, 40001)))
    least = float(shapely.distance(dense, region).min())
    assert bound <= least
    assert bound >= 0.98 * least - 1e-3
