"""A specification whose automaton would be too large is shown part by part, in the table, the file and the picture."""

import json
from collections.abc import Iterator
from pathlib import Path

import pytest
from matplotlib.text import Text

from mission.cli import main
from mission.logic.automata.translate import Bounds
from mission.plan import FlightPlan, plan_from_json, plan_mission, plan_to_json
from mission.report.figures.automaton import automaton, states_along
from mission.spec import specification
from mission.spec.loader import parse_mission
from tests.support.small_missions import SMALL


@pytest.fixture(scope="module", autouse=True)
def bounded() -> Iterator[None]:
    with pytest.MonkeyPatch.context() as patched:
        patched.setattr(specification, "GLANCE", Bounds(1, 10, 10, 10))
        yield


@pytest.fixture(scope="module")
def plan(bounded: None) -> FlightPlan:  # noqa: ARG001 - it has effect
    return plan_mission(parse_mission(SMALL.encode(), "small.yaml"))


def test_the_parts_stand_side_by_side(plan: FlightPlan) -> None:
    parts = plan.required.shown
    assert plan.shown_parts == len(parts) == 2
    assert plan.shown_automaton.size == sum(part.size for part in parts)
    assert len(plan.shown_automaton.initial) == 2
    again = plan_from_json(plan_to_json(plan))
    assert again.shown_automaton == plan.shown_automaton
    written = json.loads(plan_to_json(plan))
    assert (written["automaton_parts"], written["automaton"]["states"]) == (2, plan.shown_automaton.size)


def test_the_picture_shows_all_of_them(plan: FlightPlan) -> None:
    figure = automaton(plan)
    assert any("Automata of 2 parts: " in str(text.get_text()) for text in figure.findobj(Text))
    assert set(plan.shown_automaton.initial) <= set(states_along(plan))


def test_the_table_counts_them(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    file = tmp_path / "small.yaml"
    file.write_text(SMALL, encoding="utf-8")
    assert main(["plan", str(file), "--transitions"]) == 0
    printed = capsys.readouterr().out
    assert "A  2 automata side by side, all of which must accept: " in printed
    assert "(with deterministic automata of its parts, 2 states together)" in printed
    assert main(["plan", str(file), "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["automaton_parts"] == 2
