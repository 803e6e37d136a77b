"""Words that can be spelled against listing them by the planner's own way, and tubes against squares along a curve."""

from itertools import pairwise

import numpy as np
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st

from mission.geometry.simplices import Partition
from mission.geometry.triangulation import triangulate_nodes
from mission.spec.model import Extension, Semantics
from mission.steering import possible_words
from mission.steering.smoothing import FourierCurve
from mission.verify.plans.patches import Patches, patches_of
from mission.verify.plans.tube import Ground, far_enough, stray
from mission.verify.plans.words import Layers, spells
from tests.support.curves import marked, refuting
from tests.support.drawn_cases import tried

LETTERS = (frozenset[str](), frozenset({"a"}), frozenset({"b"}))
FORMULAS = ("F a", "G !a", "F (a & F b)", "!b U a", "G F a", "F G a", "X a", "G (a -> X b)", "G F a & G F b")
# Six triangles in a row, each with two vertices of the one before it.
STRIP = triangulate_nodes(np.array([(0.5 * i, float(i % 2)) for i in range(8)]))


@st.composite
def flights(draw: st.DrawFn) -> tuple[list[list[int]], int | None]:
    rows = [draw(st.sets(st.integers(0, 5), min_size=1, max_size=3)) for _ in range(draw(st.integers(1, 4)))]
    for before, after in pairwise(rows):
        if not before & after:
            after.add(min(before))
    return [sorted(row) for row in rows], draw(st.none() | st.integers(0, len(rows) - 1))


@given(flights(), st.lists(st.integers(0, 2), min_size=6, max_size=6), st.booleans(), st.sampled_from(FORMULAS))
@tried(100)
def test_both_ways_to_find_violating_words_agree(
    flight: tuple[list[list[int]], int | None],
    letter_of: list[int],
    reads_first: bool,  # noqa: FBT001 - as hypothesis gives it
    text: str,
) -> None:
    rows, loop = flight
    refutation = refuting(text, LETTERS)
    other = possible_words.Violations(
        possible_words.Layers(tuple(map(tuple, rows)), loop),
        corners=STRIP.triangles,
        letter_of=np.array(letter_of),
        refutation=refutation,
        semantics=Semantics.STANDARD if reads_first else Semantics.PAPER,
    )
    layers = Layers(rows, None if loop is None else (loop, len(rows)))
    assert spells(layers, STRIP, np.array(letter_of), refutation, reads_first=reads_first) == other.exists()


def test_a_flight_goes_on_after_any_number_of_laps() -> None:
    letter_of = np.array([0, 0, 1, 0, 0, 2])
    lap = [[0], [0, 1], [1], [0, 1], [0]]
    never_a = refuting("G !a", LETTERS)
    assert not spells(Layers([*lap, [0]], (0, 5)), STRIP, letter_of, never_a, reads_first=True)
    assert spells(Layers([*lap, [0], [0, 2]], (0, 5)), STRIP, letter_of, never_a, reads_first=True)
    assert not spells(
        Layers([*lap, [0], [0, 2]], (0, 5)), STRIP, letter_of, refuting("true", LETTERS), reads_first=True
    )


def square() -> Partition:
    ticks = np.linspace(0.0, 10.0, 6)
    return triangulate_nodes(np.array([(x, y) for x in ticks for y in ticks]) + 0.0)


def curve_of(seed: int) -> tuple[FourierCurve, Patches]:
    random = np.random.default_rng(seed)
    amplitudes = random.normal(size=(5, 2)) / np.arange(1, 6)[:, None] ** 2 * 0.8
    curve = FourierCurve(Extension.ODD, 10.0, random.uniform(3.0, 7.0, 2), np.zeros(2), amplitudes)
    return curve, patches_of(curve.to_json())


def met(partition: Partition, curve: FourierCurve, knots: np.ndarray, half: float) -> list[set[int]]:
    """The triangles that squares along each piece of a curve meet, at many places."""
    tree, found = shapely.STRtree(shapely.polygons(partition.corners_m)), []
    for begin, end in pairwise(knots.tolist()):
        p = curve.position(np.linspace(begin, end, 201))
        found.append(set(tree.query(shapely.box(*(p - half).T, *(p + half).T), predicate="intersects")[1].tolist()))
    return found


@given(st.integers(0, 10_000), st.sampled_from([0.0, 0.3]))
@settings(deadline=None, max_examples=6)
def test_what_squares_meet_must_be_named(seed: int, half: float) -> None:
    partition = square()
    curve, patches = curve_of(seed)
    ground, knots = Ground(partition, marked(partition, ())), np.linspace(0.0, 10.0, 8)
    inside = bool(((patches.control_m > 1.0) & (patches.control_m < 9.0)).all())
    sets = met(partition, curve, knots, half)
    wide = [sorted(a | b) for a, b in zip(sets, met(partition, curve, knots, half + 0.05), strict=True)]
    if inside:
        assert stray(ground, patches, half, knots, wide) is None
    for piece in (0, 4):
        left_out = min(sets[piece])
        fewer = [[t for t in each if (k, t) != (piece, left_out)] for k, each in enumerate(wide)]
        assert stray(ground, patches, half, knots, fewer) is not None


@given(st.integers(0, 10_000))
@tried(10)
def test_a_distance_is_believed_only_where_it_is_kept_and_honest(seed: int) -> None:
    partition = square()
    curve, patches = curve_of(seed)
    ground = Ground(partition, marked(partition, (0,)))
    closed = shapely.polygons(partition.corners_m[0])
    truth = float(shapely.distance(closed, shapely.points(curve.position(np.linspace(0.0, 10.0, 4001)))).min())
    if truth > 0.5:
        assert far_enough(ground, patches, 0.99 * truth) is None
        assert far_enough(ground, patches, 1.001 * truth) is not None
        assert far_enough(ground, patches, 0.9 * truth) is not None
