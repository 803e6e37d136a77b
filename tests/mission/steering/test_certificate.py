"""Certificates: they hold for the paper's mission, fall where they must, and are never wrong."""

import json
from itertools import pairwise

import numpy as np
import pytest
import shapely
from hypothesis import HealthCheck, assume, given
from hypothesis import strategies as st

from mission.geometry.arrays import FloatArray
from mission.geometry.location import Locator
from mission.geometry.regions import Labelling
from mission.geometry.simplices import Partition
from mission.geometry.triangulation import triangulate_nodes
from mission.logic.automata.automaton import compile_to_alphabet
from mission.logic.automata.refutation import refutation
from mission.logic.formula.parser import parse_formula
from mission.logic.formula.word import LassoWord, satisfies
from mission.spec.model import Extension, Semantics
from mission.steering.certificate import Certificate
from mission.steering.joined import JoinedCurve
from mission.steering.prover import Prover
from mission.steering.smoothing import FourierCurve, fit_fourier
from tests.support.curves import (
    PAPER_FORMULA,
    labelled,
    marked,
    paper_labelling,
    paper_partition,
    paper_path,
    refuting,
)
from tests.support.domains import random_nodes
from tests.support.drawn_cases import tried
from tests.support.usual_cases import sampled


def certified(
    curve: FourierCurve | JoinedCurve,
    partition: Partition | None = None,
    labelling: Labelling | None = None,
    *,
    formula: str = PAPER_FORMULA,
    semantics: Semantics = Semantics.STANDARD,
    restricted: tuple[int, ...] = (6,),
    tube_m: float = 0.1,
    landing_m: float = 0.0,
    repeats: bool = False,
) -> Certificate:
    domain, labels = partition or paper_partition(), labelling or paper_labelling()
    prover = Prover(
        domain,
        labels,
        refutation=refuting(formula, labels.letters),
        semantics=semantics,
        restricted=marked(domain, restricted),
        tube_m=tube_m,
        landing_m=landing_m,
    )
    return prover.certify(curve if isinstance(curve, JoinedCurve) else JoinedCurve((curve,)), repeats=repeats)


def moved(curve: FourierCurve, by_m: tuple[float, float]) -> FourierCurve:
    return FourierCurve(
        curve.extension, curve.duration_s, curve.base_m + np.array(by_m), curve.slope_m_s, curve.coefficients_m
    )


def line(start_m: tuple[float, float], end_m: tuple[float, float], duration_s: float = 10.0) -> FourierCurve:
    slope = (np.array(end_m) - np.array(start_m)) / duration_s
    return FourierCurve(Extension.ODD, duration_s, np.array(start_m), slope, np.full((1, 2), 1e-12))


@pytest.mark.parametrize("extension", Extension)
@pytest.mark.parametrize("tube_m", [0.0, 0.05, 0.2])
def test_the_papers_smoothed_path_is_certified(extension: Extension, tube_m: float) -> None:
    certificate = certified(fit_fourier(paper_path(), 28, extension), tube_m=tube_m)
    assert certificate.holds, certificate.reason
    assert [sorted(letter) for letter in certificate.word] == [["S2"], [], ["S1"], [], ["R"]]
    assert certificate.frequencies == 28
    assert len(certificate.knots_s) == len(certificate.possible) + 1
    assert certificate.clearance_m is not None
    assert certificate.tube_clearance_m == pytest.approx(certificate.clearance_m - 2**0.5 * tube_m)


def test_clearance_is_just_below_the_distance_of_dense_samples() -> None:
    curve = fit_fourier(paper_path(), 28, Extension.ODD)
    certificate = certified(curve)
    samples = shapely.points(curve.position(np.linspace(0.0, curve.duration_s, 60001)))
    least = shapely.distance(samples, shapely.Polygon(paper_partition().corners_m[6])).min()
    assert certificate.clearance_m is not None
    assert 0.98 * least <= certificate.clearance_m <= least
    assert certified(curve, restricted=()).clearance_m is None


def test_too_few_waves_miss_the_first_region() -> None:
    certificate = certified(fit_fourier(paper_path(), 4, Extension.EVEN))
    assert not certificate.holds
    assert "never enters S1" in certificate.reason
    assert certificate.where_s is not None
    assert certificate.counterexample


def test_a_curve_through_the_restricted_triangle_is_refused_with_the_place() -> None:
    certificate = certified(line((5.2, 8.8), (7.5, 9.0)), formula="true")
    assert not certificate.holds
    assert "may cross K1 near" in certificate.reason
    assert certificate.clearance_m == 0.0
    assert certificate.where_m is not None
    assert shapely.distance(shapely.Point(certificate.where_m), shapely.Polygon(paper_partition().corners_m[6])) < 0.2


def test_a_curve_that_shaves_the_restricted_triangle_depends_on_the_tube() -> None:
    # K1 has the corner (5, 5); a vertical line 0.2 m to the left of it.
    shave = line((4.8, 4.0), (4.8, 6.0))
    assert certified(shave, formula="true", tube_m=0.19).holds
    refused = certified(shave, formula="true", tube_m=0.2)
    assert not refused.holds
    assert refused.clearance_m == pytest.approx(0.2, abs=0.003)


def test_a_tube_that_reaches_beyond_the_domain_is_refused() -> None:
    low = line((3.0, 0.15), (8.0, 0.15))
    assert certified(low, formula="true", tube_m=0.1).holds
    refused = certified(low, formula="true", tube_m=0.15)
    assert not refused.holds
    assert "leave the domain" in refused.reason
    assert not certified(line((3.0, -3.0), (8.0, -3.0)), formula="true").holds


@pytest.mark.parametrize("by_m", [(1.5, 0.0), (3.0, 0.0), (0.0, -2.0), (0.0, 0.6), (-3.0, 0.0)])
def test_a_displaced_curve_is_refused(by_m: tuple[float, float]) -> None:
    curve = fit_fourier(paper_path(), 28, Extension.ODD)
    assert certified(curve).holds
    assert not certified(moved(curve, by_m)).holds


def test_a_region_that_shrinks_is_missed() -> None:
    partition, path = paper_partition(), paper_path()
    curve = fit_fourier(path, 28, Extension.ODD)
    # The part of S1 that the curve enters is cut off: only the rest carries the label.
    corners = partition.corners_m[3]
    far = corners[np.argmax(np.linalg.norm(corners - curve.position(np.array([420.0])), axis=1))]
    nodes = np.concatenate((partition.vertices_m, [far + 0.05 * (corners.mean(axis=0) - far)]))
    finer = triangulate_nodes(nodes)
    small = [t for t in range(finer.size) if len(nodes) - 1 in finer.triangles[t] and finer.areas_m2[t] < 1.0]
    at = Locator(finer)
    k1, r, s2 = (int(at.triangle_at(partition.corners_m[[t]].mean(axis=1))[0]) for t in (6, 10, 0))
    labels = labelled(finer, {"S1": tuple(small[:1]), "K1": (k1,), "R": (r,), "S2": (s2,)})
    refused = certified(curve, finer, labels, restricted=(k1,))
    assert not refused.holds
    assert "S1" in refused.reason


def test_a_region_that_is_only_brushed_is_not_surely_visited() -> None:
    # From T11 up to just above the edge between (8, 7) and (11, 2), into T8.
    brush = line((9.0, 4.2), (9.62, 4.62))
    labels = labelled(paper_partition(), {"there": (8,)})
    assert certified(brush, labelling=labels, formula="F there", tube_m=0.0).holds
    refused = certified(brush, labelling=labels, formula="F there", tube_m=0.3)
    assert not refused.holds
    assert "is not sure to enter there" in refused.reason
    back = certified(line((9.0, 4.2), (9.3, 4.4)), labelling=labels, formula="G !there", tube_m=0.3)
    assert not back.holds
    assert "may cross there near" in back.reason


def test_the_papers_semantics_does_not_read_the_start() -> None:
    inside = line((11.0, 9.5), (11.2, 9.4))  # stays in T0 = S2
    assert certified(inside, formula="G S2", semantics=Semantics.PAPER).holds
    leaving = line((11.0, 9.5), (11.5, 6.0))
    assert certified(leaving, formula="!S2 & F G !S2", semantics=Semantics.PAPER, tube_m=0.0).holds
    assert not certified(leaving, formula="!S2 & F G !S2", semantics=Semantics.STANDARD, tube_m=0.0).holds


def there_and_back(radius_m: float, centre_m: tuple[float, float] = (8.0, 5.5)) -> FourierCurve:
    """A lap: along an arc and back; sines and cosines of one kind only give no rounder one."""
    amplitudes = np.zeros((2, 2))
    amplitudes[1] = radius_m, 0.4 * radius_m
    return FourierCurve(Extension.EVEN, 60.0, np.array(centre_m), np.zeros(2), amplitudes)


def lap_labels() -> Labelling:
    """Where ``there_and_back`` turns: p at its ends, q halfway; ``never`` is elsewhere."""
    p, q = Locator(paper_partition()).triangle_at(there_and_back(2.0).position(np.array([0.0, 30.0]))).tolist()
    assert p != q
    return labelled(paper_partition(), {"p": (p,), "q": (q,), "never": (6,)})


def test_laps_are_repeated_for_ever() -> None:
    labels = lap_labels()
    curve = JoinedCurve((there_and_back(2.0), there_and_back(2.0)))
    assert certified(curve, labelling=labels, formula="G F p & G F q", restricted=(), repeats=True).holds
    assert certified(curve, labelling=labels, formula="G F q & G !never", restricted=(), repeats=True).holds
    assert not certified(curve, labelling=labels, formula="F G p", restricted=(), repeats=True).holds
    # Without the loop the vehicle stays where the last lap ends.
    assert certified(curve, labelling=labels, formula="F G p", restricted=()).holds
    assert not certified(curve, labelling=labels, formula="G F q", restricted=()).holds


def test_what_leads_to_a_lap_is_no_part_of_it() -> None:
    lap, labels = there_and_back(0.5), lap_labels()
    begin = lap.position([0.0])[0]
    way = JoinedCurve((line(tuple(there_and_back(2.0).position([0.0])[0]), tuple(begin)), lap))
    assert certified(way, labelling=labels, formula="F p", restricted=(), repeats=True).holds
    assert not certified(way, labelling=labels, formula="G F p", restricted=(), repeats=True).holds


def test_a_lap_that_does_not_close_is_refused() -> None:
    with pytest.raises(ValueError, match="a lap ends where it begins"):
        certified(line((1.0, 1.0), (2.0, 2.0)), repeats=True)


def test_certificates_survive_json() -> None:
    for waves in (4, 28):
        certificate = certified(fit_fourier(paper_path(), waves, Extension.ODD))
        data = json.loads(json.dumps(certificate.to_json()))
        again = Certificate.from_json(data)
        assert again.to_json() == data
        assert (again.holds, again.reason, again.word) == (certificate.holds, certificate.reason, certificate.word)


def test_a_tube_needs_a_width() -> None:
    with pytest.raises(ValueError, match="half width"):
        certified(line((1.0, 1.0), (2.0, 1.0)), tube_m=-1.0)


def wandering(rng: np.random.Generator, waves: int) -> FourierCurve:
    amplitudes = rng.normal(size=(waves, 2)) * (35.0, 22.0) / (np.arange(1, waves + 1) ** 1.7)[:, None]
    return FourierCurve(Extension.EVEN, 60.0, np.array([75.0, 50.0]), np.zeros(2), amplitudes)


def inside_the_tube(curve: FourierCurve, tube_m: float, rng: np.random.Generator) -> FloatArray:
    """A dense flight somewhere in the tube, often along its very sides."""
    s = np.linspace(0.0, curve.duration_s, 1500)
    knots = np.linspace(0.0, curve.duration_s, int(rng.integers(2, 60)))
    sides = np.clip(rng.normal(size=(len(knots), 2)) * rng.choice([0.5, 5.0]), -1.0, 1.0)
    aside = np.stack([np.interp(s, knots, sides[:, axis]) for axis in (0, 1)], axis=1)
    return curve.position(s) + tube_m * aside


def flown_triangles(locator: Locator, points: FloatArray) -> list[int]:
    inside = locator.triangle_at(points)
    visited = [int(inside[0])]
    for i in np.flatnonzero(inside[1:] != inside[:-1]).tolist():
        p, q = points[i], points[i + 1]
        walk = [t for t, _ in locator.crossed((float(p[0]), float(p[1])), (float(q[0]), float(q[1])))]
        visited += [t for t in (*walk, int(inside[i + 1])) if t != visited[-1]]
    return [t for k, t in enumerate(visited) if k == 0 or t != visited[k - 1]]


FRAME = np.array([(-60.0, -60.0), (210.0, -60.0), (210.0, 160.0), (-60.0, 160.0)])
FORMULAS = ("F a", "G !a", "F (a & F b)", "!b U a", "F a & F b", "F G !b", "G (a -> F b)", "X X a", "!a W b")


@given(st.integers(0, 10**6), st.sampled_from(FORMULAS), st.sampled_from(Semantics), st.sampled_from((0.05, 0.5, 2.0)))
# Most random curves violate most formulas and are passed over; those that are certified are what counts.
@tried(60, suppress_health_check=[HealthCheck.filter_too_much])
def test_nothing_in_a_certified_tube_violates(seed: int, text: str, semantics: Semantics, tube_m: float) -> None:
    rng = np.random.default_rng(seed)
    partition = triangulate_nodes(np.concatenate((random_nodes(seed, 14), FRAME)))
    chosen = rng.permutation(partition.size)
    labels = labelled(partition, {"a": tuple(chosen[:4].tolist()), "b": tuple(chosen[4:8].tolist())})
    restricted = tuple(chosen[8:10].tolist())
    curve = wandering(rng, int(rng.integers(1, 12)))
    certificate = certified(
        curve, partition, labels, formula=text, semantics=semantics, restricted=restricted, tube_m=tube_m
    )
    assume(certificate.holds)
    locator, formula = Locator(partition), parse_formula(text)
    for _ in range(6):
        points = inside_the_tube(curve, tube_m, rng)
        visited = flown_triangles(locator, points)
        assert not set(visited) & {-1, *restricted}
        word = [labels.label(t) for t in visited]
        prefix = tuple(word if semantics is Semantics.STANDARD else word[1:])
        assert satisfies(LassoWord(prefix, (word[-1],)), formula)
        distances = shapely.distance(
            shapely.points(curve.position(np.linspace(0.0, 60.0, 500)))[:, None],
            shapely.polygons(partition.corners_m[list(restricted)]),
        )
        assert certificate.clearance_m is not None
        assert certificate.clearance_m <= distances.min()


@sampled("seed", range(40), range(0, 40, 4))
def test_without_a_tube_the_proof_decides(seed: int) -> None:
    rng = np.random.default_rng(seed)
    partition = triangulate_nodes(np.concatenate((random_nodes(seed, 14), FRAME)))
    chosen = rng.permutation(partition.size)
    labels = labelled(partition, {"a": tuple(chosen[:4].tolist()), "b": tuple(chosen[4:8].tolist())})
    curve = wandering(rng, int(rng.integers(1, 12)))
    points = curve.position(np.linspace(0.0, 60.0, 6000))
    word = [labels.label(t) for t in flown_triangles(Locator(partition), points)]
    # X counts triangles, and on a facet a vehicle may change back and forth: no proof, however thin the tube.
    for text in (text for text in FORMULAS if "X" not in text):
        certificate = certified(curve, partition, labels, formula=text, restricted=(), tube_m=0.0)
        assert certificate.holds == satisfies(LassoWord(tuple(word), (word[-1],)), parse_formula(text)), text
        assert certificate.reason
        assert (certificate.where_s is None) == (certificate.where_m is None) == certificate.holds
        for t, u in pairwise(certificate.counterexample):
            assert set(partition.triangles[t]) & set(partition.triangles[u])


@pytest.mark.parametrize("by_m", [(0.0, 0.0), (0.3, -0.2), (-0.9, 0.6), (1.5, 1.5)])
@pytest.mark.parametrize("formula", [PAPER_FORMULA, f"{PAPER_FORMULA} & F G R & G (S1 -> F R)", "F S1 & G !R"])
def test_a_proof_conjunct_by_conjunct_is_one_of_the_whole(formula: str, by_m: tuple[float, float]) -> None:
    curve = JoinedCurve((moved(fit_fourier(paper_path(), 28, Extension.ODD), by_m),))
    labels = paper_labelling()
    whole, apart = (
        Prover(
            paper_partition(),
            labels,
            refutation=machine,
            semantics=Semantics.STANDARD,
            restricted=marked(paper_partition(), ()),
            tube_m=0.1,
        ).certify(curve)
        for machine in (
            refuting(formula, labels.letters),
            compile_to_alphabet(refutation(parse_formula(formula)), labels.letters),
        )
    )
    assert (apart.holds, apart.possible) == (whole.holds, whole.possible)
