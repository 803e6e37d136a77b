"""Missions of tasks: every pattern is planned and proved; the cheapest soft tasks are dropped, with the reason."""

from collections.abc import Callable
from dataclasses import replace
from functools import cache
from itertools import chain, combinations
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from mission.errors import NoPlanError, SpecError
from mission.logic.formula.parser import parse_formula
from mission.logic.formula.syntax import Formula, conjunction, eventually, propositions
from mission.logic.formula.word import LassoWord, satisfies
from mission.plan import FlightPlan, formula_of, plan_from_json, plan_mission, plan_to_json
from mission.plan.tasks import dropped_tasks
from mission.spec.loader import load_mission, parse_mission
from mission.spec.model import MissionSpec
from mission.spec.task import Task, TaskKind
from tests.support.drawn_cases import tried

MISSIONS = Path(__file__).parents[3] / "missions"

# Fields, a home and a no-fly pond, all apart.
MAP = """\
domain:
  boundary: [[0, 0], [90, 0], [90, 60], [0, 60]]
regions:
  home: {kind: home, polygon: [[8, 8], [22, 8], [22, 22], [8, 22]]}
  west: {kind: survey, polygon: [[8, 38], [22, 38], [22, 52], [8, 52]]}
  park: {kind: survey, polygon: [[36, 44], [46, 44], [46, 54], [36, 54]]}
  north: {kind: survey, polygon: [[64, 38], [78, 38], [78, 52], [64, 52]]}
  east: {kind: survey, polygon: [[64, 8], [78, 8], [78, 22], [64, 22]]}
  pond: {kind: restricted, polygon: [[40, 28], [50, 28], [50, 36], [40, 36]]}
start:
  position_m: [15, 15]
flight: {disturbance_m_s2: 0.2}
"""

# Regions beside and upon others, for the patterns that need such.
MORE = {
    "yard": "  yard: {kind: home, polygon: [[22, 8], [34, 8], [34, 22], [22, 22]]}\n",
    "zone": "  zone: {kind: survey, polygon: [[64, 38], [78, 38], [78, 52], [64, 52]]}\n",
}

PLANNED = [
    ["visit: [west, north, east]"],
    ["sequenced_visit: [north, home, west]"],
    ["ordered_visit: [east, north, west]"],
    ["strict_ordered_visit: [west, east, north]"],
    ["fair_visit: [west, east, north]"],
    ["patrol: [west, east, north]"],
    ["sequenced_patrol: [west, east, north]"],
    ["ordered_patrol: [west, east, north]"],
    ["strict_ordered_patrol: [west, east, north]"],
    ["fair_patrol: [west, east]"],
    ["avoid: pond", "visit: north"],
    ["avoid: {region: north, until: west}", "visit: north"],
    ["avoid: {region: home, after: west}", "visit: west"],
    ["visits: {region: east, at_most: 1}", "sequenced_visit: [north, home]"],
    ["visits: {region: east, at_least: 2}"],
    ["visits: {region: east, exactly: 2}", "sequenced_visit: [east, home]"],
    ["wait: {in: home, until: yard}"],
    ["react: {when: north, then: zone, how: instantaneous}", "visit: north"],
    ["react: {when: north, then: east, how: delayed}", "visit: north"],
    ["react: {when: north, then: home, how: prompt}", "visit: [north, east]"],
    ["react: {when: north, then: zone, how: bound}", "visit: zone"],
    ["react: {when: west, then: park, how: bound_delay}", "visit: [west, north]"],
]


def spec_of(*tasks: str, regions: str = "", mission: str = "") -> MissionSpec:
    text = MAP.replace("start:", f"{regions}start:")
    listed = "tasks:\n" + "".join(f"  - {{{task}}}\n" for task in tasks) if tasks else ""
    return parse_mission(f"{text}{mission}{listed}".encode(), "tasks.yaml")


def word_of(plan: FlightPlan) -> LassoWord:
    labels = [plan.labelling.label(triangle) for triangle in plan.run.states]
    split = len(plan.run.prefix)
    return LassoWord(tuple(labels[:split]), tuple(labels[split:]))


@pytest.mark.parametrize("tasks", PLANNED, ids=str)
def test_every_pattern_is_planned_and_proved(tasks: list[str]) -> None:
    regions = "".join(line for name, line in MORE.items() if name in str(tasks))
    plan = plan_mission(spec_of(*tasks, regions=regions))
    assert plan.certificate.holds
    assert satisfies(word_of(plan), plan.formula)
    assert plan.specification == str(plan.formula) == str(formula_of(plan.spec))
    assert plan.dropped == ()


def test_tasks_and_a_formula_are_met_together() -> None:
    spec = spec_of("visit: east", mission="mission: {formula: F G home}\n")
    assert str(formula_of(spec)) == "F G home & F east"
    assert plan_mission(spec).run.suffix[-1] in plan_mission(spec).labelling.triangles_of("home")


def test_a_formula_without_tasks_is_shown_as_it_was_written() -> None:
    plan = plan_mission(spec_of(mission="mission: {formula: <>(west  &&  true)}\n"))
    assert plan.specification == "<>(west  &&  true)"


@cache
def wishes() -> FlightPlan:
    return plan_mission(load_mission(MISSIONS / "tasks_soft.yaml"))


def test_the_cheapest_wishes_are_given_up_and_the_plan_says_why() -> None:
    plan = wishes()
    assert [(task.number, task.task, task.weight) for task in plan.dropped] == [
        (3, "avoid road", 1.0),
        (4, "visit pier", 2.0),
    ]
    road, pier = (task.reason for task in plan.dropped)
    assert "visit mast" in road
    assert "pier" not in road.split(":")[0]
    assert "pier" in pier
    assert propositions(plan.formula) == {"home", "barn", "lake", "mast"}


def test_what_was_dropped_stays_with_the_plan() -> None:
    plan = wishes()
    again = plan_from_json(plan_to_json(plan))
    assert again.dropped == plan.dropped
    assert again.formula is plan.formula
    assert again.spec.tasks == plan.spec.tasks


def test_no_file_drops_what_must_be_met() -> None:
    text = plan_to_json(wishes())
    for number in (0, 17, -1):
        changed = text.replace('"dropped": [{"number": 3', f'"dropped": [{{"number": {number}')
        assert changed != text
        with pytest.raises(SpecError, match="may be dropped"):
            plan_from_json(changed)


def test_a_mission_that_must_be_met_and_cannot_is_refused_for_that() -> None:
    spec = spec_of("avoid: north", "visit: north", "visit: east, weight: 3")
    with pytest.raises(NoPlanError, match="north") as refused:
        plan_mission(spec)
    assert "east" not in str(refused.value).split("north")[0]


def test_each_of_two_that_exclude_each_other_names_the_other() -> None:
    plan = plan_mission(spec_of("ordered_visit: [west, east], weight: 2", "ordered_visit: [east, west], weight: 1"))
    (lost,) = plan.dropped
    assert lost.number == 1
    assert lost.reason.startswith("together with ordered_visit [west, east], ")


def test_of_equal_weight_fewer_go_and_the_last_in_the_file() -> None:
    assert lost_numbers([1.0, 1.0], [frozenset({0, 1})]) == [1]
    assert lost_numbers([2.0, 1.0, 1.0], [frozenset({0, 1}), frozenset({0, 2})]) == [0]
    assert lost_numbers([1.0, 1.0, 1.0], [frozenset({0, 1, 2})]) == [2]


NAMES = tuple(f"r{i}" for i in range(6))
CONFLICTS = st.lists(st.frozensets(st.integers(0, 5), min_size=1, max_size=3), max_size=6)


@cache
def homely() -> MissionSpec:
    return spec_of("visit: home")


def soft_spec(weights: list[float]) -> MissionSpec:
    tasks = [Task(TaskKind.VISIT, (name,), weight=weight) for name, weight in zip(NAMES, weights, strict=False)]
    return replace(homely(), tasks=tuple(tasks))


def refusing(conflicts: list[frozenset[int]]) -> Callable[[Formula], NoPlanError | None]:
    """A search that finds no run where a formula asks for all the regions of a conflict."""

    def refusal(formula: Formula) -> NoPlanError | None:
        asked = propositions(formula)
        hit = next((c for c in conflicts if {NAMES[i] for i in c} <= asked), None)
        return None if hit is None else NoPlanError(f"no {sorted(hit)}")

    return refusal


def lost_numbers(weights: list[float], conflicts: list[frozenset[int]]) -> list[int]:
    return [task.number for task in dropped_tasks(soft_spec(weights), refusing(conflicts))]


@tried(80)
@given(weights=st.lists(st.sampled_from([0.1, 0.2, 0.3, 1.0, 2.5]), min_size=6, max_size=6), conflicts=CONFLICTS)
def test_no_subset_is_cheaper(weights: list[float], conflicts: list[frozenset[int]]) -> None:
    subsets = chain.from_iterable(combinations(range(6), size) for size in range(7))
    allowed = [set(lost) for lost in subsets if all(set(lost) & conflict for conflict in conflicts)]
    lost = set(lost_numbers(weights, conflicts))
    assert lost in allowed

    def cost(chosen: set[int]) -> tuple[int, int]:
        return sum(round(10 * weights[i]) for i in chosen), len(chosen)

    assert cost(lost)[0] <= min(cost(chosen) for chosen in allowed)[0]


@tried(40)
@given(weights=st.lists(st.sampled_from([1.0, 2.0, 3.0]), min_size=6, max_size=6), conflicts=CONFLICTS)
def test_each_reason_is_a_conflict_that_the_task_is_in(weights: list[float], conflicts: list[frozenset[int]]) -> None:
    for task in dropped_tasks(soft_spec(weights), refusing(conflicts)):
        others = {i for i in range(6) if f"visit {NAMES[i]}" in task.reason}
        assert any(conflict <= others | {task.number} for conflict in conflicts)


def check_against_all_subsets(choice: list[int], weights: list[int]) -> None:
    tasks = [
        "avoid: {region: west, until: east}",
        "avoid: {region: east, until: west}",
        "avoid: north",
        "visit: north",
        "react: {when: west, then: north}",
        "visits: {region: east, exactly: 1}",
        "patrol: [east, home]",
        "wait: {in: home, until: west}",
    ]
    chosen = [tasks[i] for i in choice]

    def planned(some: tuple[int, ...]) -> bool:
        try:
            plan_mission(spec_of("visit: home", *(chosen[i] for i in some)))
        except NoPlanError:
            return False
        return True

    soft = [f"{task}, weight: {weight}" for task, weight in zip(chosen, weights, strict=False)]
    plan = plan_mission(spec_of("visit: home", *soft))
    everything = range(len(chosen))
    best = max(
        sum(weights[i] for i in some)
        for size in range(len(chosen) + 1)
        for some in combinations(everything, size)
        if planned(some)
    )
    assert sum(weights[: len(chosen)]) - sum(task.weight for task in plan.dropped) == best
    assert satisfies(word_of(plan), plan.formula)


CHOICES = st.lists(st.sampled_from(range(8)), min_size=3, max_size=4, unique=True)
WEIGHTS = st.permutations([1, 2, 4, 8])


@settings(max_examples=2, deadline=None)
@given(choice=CHOICES, weights=WEIGHTS)
def test_against_all_subsets_on_a_map(choice: list[int], weights: list[int]) -> None:
    check_against_all_subsets(choice, weights)


@pytest.mark.long
@pytest.mark.timeout(1800)
@tried(40)
@given(choice=CHOICES, weights=WEIGHTS)
def test_against_all_subsets_many_times(choice: list[int], weights: list[int]) -> None:
    check_against_all_subsets(choice, weights)


def test_effective_formulas_are_conjunctions_in_the_order_of_the_file() -> None:
    spec = spec_of("visit: east", "visit: west, weight: 1", mission="mission: {formula: G !pond}\n")
    assert formula_of(spec) is parse_formula("G !pond & F east & F west")
    assert formula_of(spec, [1]) is conjunction(parse_formula("G !pond"), eventually(parse_formula("east")))


COVERED = """\
domain:
  boundary: [[0, 0], [120, 0], [120, 80], [0, 80]]
regions:
  home: {kind: home, polygon: [[5, 5], [20, 5], [20, 20], [5, 20]]}
  field: {kind: survey, polygon: [[30, 10], [110, 10], [110, 70], [30, 70]], cover: {spacing_m: 15}}
  road: {kind: area, polygon: [[66, -5], [74, -5], [74, 85], [66, 85]]}
  edge: {kind: area, polygon: [[106, -5], [114, -5], [114, 85], [106, 85]]}
tasks:
  - sequenced_visit: [field, home]
  - {avoid: road, weight: ROAD}
  - {avoid: edge, weight: 1}
start:
  position_m: [12, 12]
flight: {disturbance_m_s2: 0.5}
"""


def test_a_wish_that_leaves_a_region_uncovered_is_given_up() -> None:
    plan = plan_mission(parse_mission(COVERED.replace("ROAD", "5").encode()))
    (dropped,) = plan.dropped
    assert (dropped.task, dropped.weight) == ("avoid road", 5.0)
    assert dropped.reason.startswith("field cannot be covered: no way leads to ")
    (visit,) = plan.covers
    # The other wish is met: no lane reaches the edge.
    assert visit.lanes_m[..., 0].max() < 106.0
    with pytest.raises(NoPlanError, match="field cannot be covered: no way leads to"):
        plan_mission(parse_mission(COVERED.replace(", weight: ROAD", "").encode()))
