"""Paths of searched runs through random domains: each field keeps to its triangle and hands over on the facet."""

from itertools import groupby

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st
from scipy.integrate import quad

from mission.errors import NoPlanError
from mission.geometry.regions import label_triangles
from mission.geometry.simplices import Partition
from mission.geometry.triangulation import triangulate_nodes
from mission.planning.product import Product
from mission.planning.run import Run
from mission.planning.search import search
from mission.planning.transition_system import TransitionSystem
from mission.spec.model import Semantics
from mission.steering.path import SteeringPath, build_path
from tests.support.curves import paper_path
from tests.support.domains import random_nodes
from tests.support.drawn_cases import tried
from tests.support.required import required
from tests.support.triangles import shares


def random_run(seed: int, count: int, formula: str) -> tuple[Partition, Run]:
    partition = triangulate_nodes(random_nodes(seed, count))
    rng = np.random.default_rng(seed)
    members = {name: np.arange(partition.size) == rng.integers(partition.size) for name in "ab"}
    labelling = label_triangles(partition.size, members)
    system = TransitionSystem.from_partition(partition, labelling, np.zeros(partition.size, dtype=np.bool_))
    automaton = required(formula, labelling.letters)
    try:
        runs = search(Product(system, automaton, int(rng.integers(partition.size)), Semantics.STANDARD))
    except NoPlanError:
        assume(False)
    return partition, runs[runs.count // 2]


def triangles_passed(run: Run) -> list[int]:
    return [*run.prefix, *(run.suffix if run.recurrent else ()), run.suffix[0]]


@tried(60)
@given(
    seed=st.integers(0, 2**32 - 1),
    count=st.integers(4, 25),
    formula=st.sampled_from(["F (a & F b)", "G F a & G F b", "F G a"]),
    at=shares(),
    speed=st.sampled_from([0.05, 4.0]),
)
def test_each_field_keeps_to_its_triangle(seed: int, count: int, formula: str, *, at: np.ndarray, speed: float) -> None:
    partition, run = random_run(seed, count, formula)
    start = at @ partition.corners_m[run.states[0]]  # corners and edges too
    path = build_path(partition, run, start_m=start, speed_m_s=speed, final_stay_s=20.0 / speed)
    np.testing.assert_allclose(path.position([0.0])[0], start, atol=1e-9)
    passed = [triangle for triangle, _ in groupby(segment.triangle for segment in path.segments)]
    expected = triangles_passed(run)
    left = iter(expected)  # where the path enters at a corner that also lies on the exit facet, no time is spent
    assert all(triangle in left for triangle in passed)
    for segment in path.segments:
        inside = np.linspace(0.0, segment.duration_s, 40)[:-1]
        shares_of = partition.barycentric(np.full(39, segment.triangle), path.position(segment.start_s + inside))
        assert shares_of.min() > -1e-7
    for before, after in zip(path.segments[:-1], path.segments[1:], strict=True):
        moment = np.array([np.nextafter(after.start_s, 0.0), after.start_s])
        ends, begins = path.position(moment)
        np.testing.assert_allclose(ends, begins, atol=1e-8)
        assert partition.barycentric(np.array([before.triangle]), np.array([after.entry_m])).min() > -1e-7
    stays = partition.barycentric(np.array([run.suffix[0]]), path.position([path.duration_s]))
    assert stays.min() > 0.0
    assert np.hypot(*path.velocity(np.linspace(0.0, path.duration_s, 200)).T).max() <= speed * (1.0 + 1e-9)


def quadrature(path: SteeringPath) -> float:
    def speed_of(t: float) -> float:
        return float(np.hypot(*path.velocity([t])[0]))

    return sum(
        quad(speed_of, s.start_s, np.nextafter(s.start_s + s.duration_s, 0.0), epsabs=1e-12, epsrel=1e-12)[0]
        for s in path.segments
    )


@pytest.mark.parametrize("seed", range(4))
def test_the_length_is_that_of_an_adaptive_quadrature(seed: int) -> None:
    partition, run = random_run(seed, 12, "F a")
    path = build_path(partition, run, start_m=partition.incentres_m[run.states[0]], speed_m_s=2.0, final_stay_s=40.0)
    assert path.length_m == pytest.approx(quadrature(path), rel=1e-9)


def test_the_length_of_the_papers_path() -> None:
    assert paper_path().length_m == pytest.approx(quadrature(paper_path()), rel=1e-9)
