"""Stages of runs: every word that a flight through them can spell satisfies the formula, and the mesh does not show."""

from pathlib import Path
from random import Random

import numpy as np
import pytest
import shapely

from mission.geometry.arrays import BoolArray
from mission.geometry.location import Locator
from mission.geometry.regions import Labelling
from mission.geometry.simplices import Partition
from mission.logic.formula.parser import parse_formula
from mission.logic.formula.word import LassoWord, satisfies
from mission.plan.progress import Grounds, NoStagesError, Stages, StagesOfRuns
from mission.planning.product import Product
from mission.planning.search import search
from mission.planning.transition_system import TransitionSystem
from mission.spec.domain import build_domain, restricted_triangles
from mission.spec.loader import load_mission, parse_mission
from mission.spec.model import MissionSpec, Semantics
from mission.steering.taut import TautPath, taut_path
from tests.support.required import required

MISSIONS = Path(__file__).parents[3] / "missions"
TRIED = 30

FORMULAS = (
    "F S1",
    "F (S1 & F (S2 & F home)) & F S3",
    "(!S2 U S1) & F (S2 & F G home)",
    "F S1 & F S2 & F S3 & G (S1 -> (!S3 W S2))",
    "F (S1 & F (S2 & F (S1 & F home)))",
    "F (S1 & X (!S1 U S2)) & F G home",
    "F G S1 | F G S2",
    "G F S1 & G F S2",
    "F S3 & G F S1 & G F S2 & G F home",
    "G F (S1 & F (S2 & F S3))",
    "F S1 & G (S1 -> F S2) & G F S3 & G F S1",
    "G (S1 -> (!S2 W home)) & G F S1 & G F S2",
    "F G !home & F S1 & F S2",
    "F (S1 & (!S3 U S2)) & (G F S3 | F G home)",
    "G F S1 & G F S3 & G (S1 -> (!S2 W S3)) & F S2",
    "G F (S1 & X F S2) & F G !S3 & F S3",
)


def survey(formula: str) -> MissionSpec:
    text = (MISSIONS / "survey.yaml").read_text(encoding="utf-8")
    kept = [line for line in text.splitlines() if not line.strip().startswith("formula:")]
    place = kept.index("mission:") + 1
    return parse_mission("\n".join([*kept[:place], f"  formula: {formula}", *kept[place:]]).encode())


def staged(spec: MissionSpec, margin_m: float) -> tuple[Stages, Partition, Labelling, BoolArray]:
    partition, labelling = build_domain(spec)
    restricted = restricted_triangles(spec, labelling)
    system = TransitionSystem.from_partition(partition, labelling, restricted)
    start = int(Locator(partition).triangle_at(np.array([spec.start.position_m]))[0])
    automaton = required(spec.formula, labelling.letters)
    run = search(Product(system, automaton, start, spec.semantics))[0]
    stages = StagesOfRuns(Grounds(partition, labelling, restricted, margin_m), automaton, spec.semantics).of(run)
    return stages, partition, labelling, restricted


def path_of(spec: MissionSpec, margin_m: float) -> TautPath:
    stages, *_ = staged(spec, margin_m)
    return taut_path(np.array(spec.start.position_m), stages.stages, lap=stages.lap, entries=stages.entries)


@pytest.mark.parametrize("formula", FORMULAS)
def test_every_word_through_the_stages_satisfies_the_formula(formula: str) -> None:
    spec = survey(formula)
    stages, partition, labelling, restricted = staged(spec, 1e-6)
    centres = shapely.points(partition.incentres_m)
    letters = np.array(labelling.letter_of)
    free = [np.unique(letters[shapely.contains(stage.free, centres)]).tolist() for stage in stages.stages]
    ends = [np.unique(letters[shapely.contains(stage.target, centres)]).tolist() for stage in stages.stages]
    forbidden = set(letters[restricted].tolist())
    assert not forbidden & {letter for of_stage in free for letter in of_stage}
    start = int(Locator(partition).triangle_at(np.array([spec.start.position_m]))[0])
    random, parsed = Random(formula), parse_formula(formula)  # noqa: S311 - no secret

    def flown(places: range) -> list[int]:
        word: list[int] = []
        for place in places:
            if stages.stages[place].index >= 0:
                word += [
                    *random.choices(free[place], k=random.randrange(4)),
                    *random.choices(ends[place], k=random.randrange(1, 3)),
                ]
            else:
                word += random.choices(free[place], k=random.randrange(4))
        return word

    for _ in range(TRIED):
        once = [int(letters[start])] if spec.semantics is Semantics.STANDARD else []
        if stages.lap is None:
            once += flown(range(len(stages.stages)))
            again = random.choices(ends[-1], k=random.randrange(1, 4))
        else:
            once += flown(range(stages.lap))
            again = [
                letter for _ in range(random.randrange(1, 3)) for letter in flown(range(stages.lap, len(stages.stages)))
            ]
        word = LassoWord(tuple(labelling.letters[i] for i in once), tuple(labelling.letters[i] for i in again))
        assert satisfies(word, parsed), word


@pytest.mark.parametrize("formula", ["F (S1 & X (S1 & X (S1 & F S2)))", "F (S1 & X F (S1 & F S2))"])
def test_a_word_that_counts_triangles_has_no_stages(formula: str) -> None:
    with pytest.raises(NoStagesError):
        staged(survey(formula), 1e-6)


def test_a_region_that_the_square_does_not_fit_in_has_no_stage() -> None:
    with pytest.raises(NoStagesError, match="the tube does not fit into S3"):
        staged(survey("F S3"), 15.0)


@pytest.mark.parametrize(("margin_m", "length_m"), [(1e-6, 22.2687), (0.1, 23.04), (0.25, 24.206), (0.5, 26.176)])
def test_the_papers_mission_has_the_lengths_that_it_should(margin_m: float, length_m: float) -> None:
    # The first is the shortest way through the corners of K1, by hand; a square reaches farther than a disc.
    hand = [(11.0, 9.5), (8.0, 7.0), (5.0, 5.0), (3.2, 8.6), (5.0, 5.0), (11.0, 2.0)]
    assert np.hypot(*np.diff(hand, axis=0).T).sum() == pytest.approx(22.2687, abs=1e-4)
    assert path_of(load_mission(MISSIONS / "paper.yaml"), margin_m).length_m == pytest.approx(length_m, abs=1e-3)


@pytest.mark.parametrize("name", ["delivery", "patrol"])
def test_the_path_does_not_depend_on_the_mesh(name: str) -> None:
    text = (MISSIONS / f"{name}.yaml").read_text(encoding="utf-8")
    place = text.index("\n\nregions:")
    meshed = [text[:place] + f"\n  mesh: {{largest_m: {largest}}}" + text[place:] for largest in (40, 11)]
    coarse, fine = (path_of(parse_mission(each.encode()), 0.5) for each in meshed)
    assert coarse.lap == fine.lap
    for one, other in zip(coarse.lines, fine.lines, strict=True):
        assert one.points_m.shape == other.points_m.shape
        assert np.abs(one.points_m - other.points_m).max() < 1e-6


def test_what_laps_must_not_touch_again_is_left_before_them() -> None:
    path = path_of(survey("G F S1 & G F S2 & F G !S3 & F S3"), 0.5)
    assert path.lap is not None
    lap = shapely.LineString(np.concatenate([line.points_m for line in path.lines[path.lap :]]))
    assert shapely.distance(lap, shapely.Polygon([(100, 10), (128, 12), (126, 34), (102, 32)])) >= 0.5
