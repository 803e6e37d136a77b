"""The planned path: the paper's figures, continuity, and the triangles it runs through."""

import numpy as np
import pytest

from mission.geometry.location import Locator
from mission.geometry.simplices import Partition
from mission.geometry.triangulation import triangulate_nodes
from mission.planning.run import Run
from mission.steering.path import SteeringPath, build_path

# Seed of these numbers: the paper, Figs. 1 to 3 and Sec. 6.
NODES = [[0, 0], [0, 10], [15, 10], [15, 0], [6, 10], [9, 10], [11, 0], [2, 8], [8, 7], [11, 2], [5, 5]]
STATES = (0, 8, 11, 12, 4, 5, 7, 3, 1, 5, 4, 12, 10)
RUN = Run(STATES[:-1], STATES[-1:], (1, 3, 3, 1, 1, 3, 1, 2, 2, 2, 3, 2, 0))
LOOP = Run((), (5, 7, 3, 1), (3, 1, 2, 2))


@pytest.fixture(scope="module")
def partition() -> Partition:
    return triangulate_nodes(np.array(NODES, dtype=np.float64))


def paper_path(
    partition: Partition, final_stay_s: float = 100.0, settle_in: frozenset[int] = frozenset()
) -> SteeringPath:
    return build_path(
        partition, RUN, start_m=(11.0, 9.5), speed_m_s=0.05, final_stay_s=final_stay_s, settle_in=settle_in
    )


def test_the_papers_run_takes_743_s_and_33_8_m_before_the_stay(partition: Partition) -> None:
    path = paper_path(partition)
    stay = path.segments[-1]
    assert stay.control == 0
    assert stay.duration_s == 100.0
    assert stay.start_s == pytest.approx(743.0, abs=0.5)
    assert paper_path(partition, 1e-9).length_m == pytest.approx(33.8, abs=0.05)
    assert path.length_m == pytest.approx(35.2, abs=0.05)
    assert path.lap is None
    assert len(path.legs) == 1


def test_length_is_that_of_a_fine_polygon(partition: Partition) -> None:
    path = paper_path(partition)
    fine = path.position(np.union1d(np.linspace(0.0, path.duration_s, 100_001), path.knots_s))
    assert np.linalg.norm(np.diff(fine, axis=0), axis=1).sum() == pytest.approx(path.length_m, rel=1e-7)


@pytest.mark.parametrize("settle_in", [frozenset[int](), frozenset({7})])
def test_the_path_is_continuous_and_runs_through_its_triangles(partition: Partition, settle_in: frozenset[int]) -> None:
    path = paper_path(partition, settle_in=settle_in)
    locator = Locator(partition)
    passed = [segment.triangle for segment in path.segments]
    assert [t for i, t in enumerate(passed) if i == 0 or t != passed[i - 1]] == list(STATES)
    for before, after in zip(path.segments[:-1], path.segments[1:], strict=True):
        assert after.start_s == pytest.approx(before.start_s + before.duration_s, abs=1e-9)
        ends = path.position([after.start_s - 1e-9, after.start_s])
        np.testing.assert_allclose(ends[0], ends[1], atol=1e-8)
    for segment in path.segments:
        middle = path.position([segment.start_s + 0.5 * segment.duration_s])
        assert locator.triangle_at(middle)[0] == segment.triangle


def test_settling_goes_well_inside(partition: Partition) -> None:
    settled = paper_path(partition, settle_in=frozenset({7}))
    inside = [segment for segment in settled.segments if segment.triangle == 3]
    assert [segment.control for segment in inside] == [0, 2]
    deepest = partition.barycentric(np.array([3]), np.array([inside[1].entry_m])).min()
    assert deepest > 0.15
    assert settled.duration_s > paper_path(partition).duration_s


def passed(path: SteeringPath) -> list[int]:
    triangles = [segment.triangle for segment in path.segments]
    return [t for i, t in enumerate(triangles) if i == 0 or t != triangles[i - 1]]


def test_a_recurrent_run_has_a_lap_that_ends_where_it_begins(partition: Partition) -> None:
    path = build_path(partition, LOOP, start_m=(3.0, 6.5), speed_m_s=1.0, final_stay_s=5.0)
    assert passed(path) == [*LOOP.suffix, 5]
    out, lap = path.legs
    assert path.repeated_leg == 1
    assert passed(out) == [5]
    assert passed(lap) == [*LOOP.suffix, 5]
    begins_s, ends_s = path.lap_s or (0.0, 0.0)
    assert (begins_s, ends_s) == (out.duration_s, path.duration_s)
    begins, ends = path.position([begins_s, ends_s])
    assert ends == pytest.approx(begins, abs=1e-12)
    assert lap.position([0.0])[0] == pytest.approx(begins, abs=1e-12)
    assert partition.barycentric(np.array([5]), ends[None]).min() > 0.05
    assert np.hypot(*path.velocity(np.linspace(0.0, path.duration_s, 500)).T).max() <= 1.0 + 1e-9


def test_a_flight_that_starts_where_its_lap_begins_starts_with_the_lap(partition: Partition) -> None:
    there = build_path(partition, LOOP, start_m=(3.0, 6.5), speed_m_s=1.0, final_stay_s=5.0)
    seam = there.position([there.duration_s])[0]
    path = build_path(partition, LOOP, start_m=seam, speed_m_s=1.0, final_stay_s=5.0)
    assert path.repeated_leg == 0
    assert len(path.legs) == 1
    assert path.position([0.0, path.duration_s]) == pytest.approx(np.array([seam, seam]), abs=1e-12)


def test_a_path_goes_on_with_another_one(partition: Partition) -> None:
    lap = build_path(partition, LOOP, start_m=(3.0, 6.5), speed_m_s=1.0, final_stay_s=5.0)
    end = lap.position([lap.duration_s])[0]
    back = build_path(partition, Run((5,), (7,), (3, 0)), start_m=end, speed_m_s=1.0, final_stay_s=5.0)
    whole = lap.then(back)
    assert [leg.duration_s for leg in whole.legs] == pytest.approx(
        [*(leg.duration_s for leg in lap.legs), back.duration_s]
    )
    assert whole.duration_s == pytest.approx(lap.duration_s + back.duration_s)
    assert whole.lap_s == lap.lap_s
    later = np.linspace(0.0, back.duration_s, 30)
    assert whole.position(lap.duration_s + later) == pytest.approx(back.position(later), abs=1e-9)


@pytest.mark.parametrize("wrong", [{"speed_m_s": 0.0}, {"final_stay_s": 0.0}])
def test_senseless_arguments_are_refused(partition: Partition, wrong: dict[str, float]) -> None:
    arguments = {"speed_m_s": 1.0, "final_stay_s": 1.0} | wrong
    with pytest.raises(ValueError, match="must be positive"):
        build_path(
            partition,
            RUN,
            start_m=(11.0, 9.5),
            speed_m_s=arguments["speed_m_s"],
            final_stay_s=arguments["final_stay_s"],
        )
