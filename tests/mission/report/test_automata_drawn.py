"""Pictures of automata: no arrow over a state or a guard, heads that are seen, and no state that nothing leads to."""

from dataclasses import replace
from functools import cache
from itertools import combinations

import numpy as np
import pytest
import shapely

from mission.logic.automata.combination import union
from mission.logic.formula.parser import parse_formula
from mission.report.figures.automaton import MOST_STATES, automaton
from mission.report.figures.automaton_layout import DISC_PT, Arrangement, Part, arranged
from mission.report.figures.guard_text import keyed
from mission.spec.loader import load_mission
from mission.spec.specification import Specification, formula_of
from tests.support.commands import MISSIONS
from tests.support.drawn_plans import SURVEY_TOUR, plan_of

MISSION_FILES = sorted(MISSIONS.glob("*.yaml"))
HEAD_PT = 8.0
ROUND = (
    "F (pond & F (orchard & F base)) & !orchard U pond & !base U orchard & G (pond -> pond U (!base U orchard))"
    " & G (base -> F north_field) & !base U (base & base U G !base) & G !school & G !mast"
)


@cache
def of_mission(name: str) -> tuple[Part, Arrangement]:
    spec = load_mission(MISSIONS / name)
    machine = union(*Specification(formula_of(spec, ()), spec.automaton).shown)
    states = tuple(range(min(machine.size, MOST_STATES)))
    edges = tuple(edge for edge in machine.edges if edge.source in states and edge.target in states)
    names, key = keyed([edge.guard for edge in edges])
    part = Part(states, edges, frozenset(), tuple(names), tuple(key), "")
    return part, arranged(part, [state for state in machine.initial if state in states], 8.5)


def boxes_of(arrangement: Arrangement) -> list[shapely.Geometry]:
    half = 0.5 * np.array(arrangement.sizes).reshape(-1, 2)
    corners = np.hstack((arrangement.labels - half, arrangement.labels + half))
    return [shapely.box(*box) for box in corners.tolist()]


@pytest.mark.parametrize("name", [file.name for file in MISSION_FILES])
def test_no_arrow_crosses_a_state_or_the_guard_of_another(name: str) -> None:
    part, arrangement = of_mission(name)
    boxes = boxes_of(arrangement)
    discs = [shapely.Point(node).buffer(DISC_PT - 0.2) for node in arrangement.nodes]
    lines = [shapely.LineString(curve) for curve in [*arrangement.curves, *arrangement.starts]]
    crossing, hit = shapely.STRtree([*discs, *boxes]).query(lines, predicate="intersects")
    own = {(k, len(discs) + k) for k in range(len(boxes))}
    assert set(zip(crossing.tolist(), hit.tolist(), strict=True)) <= own
    assert not any(a.intersects(b) for a, b in combinations([*discs, *boxes], 2))
    assert len(part.edges) == len(boxes)


@pytest.mark.parametrize("name", ["paper.yaml", "tasks_delivery.yaml", "patrol.yaml"])
def test_each_arrow_ends_at_its_state_with_room_for_its_head(name: str) -> None:
    part, arrangement = of_mission(name)
    for (source, target), curve in zip(part.pairs, arrangement.curves, strict=True):
        for state, end in ((source, curve[0]), (target, curve[-1])):
            assert np.hypot(*(end - arrangement.nodes[state])) == pytest.approx(DISC_PT)
        if source != target:
            assert curve[-1, 1] == curve[-2, 1]
            assert abs(curve[-1, 0] - curve[-2, 0]) >= HEAD_PT
    for arrow in arrangement.starts:
        assert np.hypot(*(arrow[1] - arrow[0])) > HEAD_PT


def test_states_that_only_edges_lead_to_that_no_label_takes_are_left_out_and_that_is_said() -> None:
    plan = replace(plan_of(SURVEY_TOUR), required=Specification(parse_formula(ROUND)))
    figure = automaton(plan)
    (axes,) = figure.axes
    drawn = {int(text.get_text()[1:]) for text in axes.texts if text.get_gid() == "state"}
    assert len(drawn) < plan.shown_automaton.size
    (note,) = [text.get_text() for text in figure.texts if "left out" in text.get_text()]
    assert f"{plan.shown_automaton.size - len(drawn)} state" in note
