"""What is said of regions and nodes that move: in the terminal, in reports, and on maps of other programs."""

import json
from argparse import Namespace

import pytest

from mission.cli.plan import print_plan, summary
from mission.cli.screen import speak
from mission.export.files import WRITERS
from mission.export.placed_plan import placed_plan
from mission.geometry.geodesy import LatLon
from mission.report.fact_rows import planned_rows
from mission.report.summary import summary as report_summary
from mission.spec.moving import motions_by_name
from tests.support.drifting_missions import drifting, moved_nodes
from tests.support.drifting_plans import drifting_plan


@pytest.mark.parametrize(
    ("motion", "text"),
    [
        ("{velocity_m_s: [0, 2], until_s: 20}", "by [0, 40] m until 20 s"),
        ("{velocity_m_s: [0.5, 0], from_s: 4, until_s: 8.5}", "by [2.25, 0] m from 4 to 8.5 s"),
        (
            "{waypoints: [[0, 0, 0], [5, 0, 0], [10, 5, 0], [20, 5, 5]]}",
            "by [5, 5] m through 1 way-point from 5 to 20 s",
        ),
        (
            "{waypoints: [[10, 5, 5], [20, 0, 0]], smooth: true}",
            "out and back through 1 way-point until 20 s, smoothly",
        ),
        ("{waypoints: [[10, 0, 0]]}", "by nothing"),
    ],
)
def test_how_something_moves_is_said_in_a_few_words(motion: str, text: str) -> None:
    assert {name: each.text for name, each in motions_by_name(drifting(motion=motion)).items()} == {"K": text}


def test_nodes_that_move_are_named_by_their_numbers() -> None:
    assert [*motions_by_name(moved_nodes("[4, 5]"))] == ["nodes 4, 5"]
    assert [*motions_by_name(moved_nodes("[4]"))] == ["node 4"]


def test_a_plan_says_what_moves_in_all_its_forms(capsys: pytest.CaptureFixture[str]) -> None:
    plan = drifting_plan()
    speak(Namespace())  # as loud as commands are
    print_plan(plan)
    assert "Moves          K by [0, 10] m until 20 s" in capsys.readouterr().out
    assert summary(plan)["motions"] == {"K": {"waypoints": [[0.0, 0.0, 0.0], [20.0, 0.0, 10.0]]}}
    rows = planned_rows(report_summary(plan, None)["planned"])
    assert ("Moves, by the clock of the trajectory", "K by [0, 10] m until 20 s") in rows


@pytest.mark.parametrize("ending", [".geojson", ".kml"])
def test_a_map_shows_what_moves_where_it_begins_and_says_how(ending: str) -> None:
    placed = placed_plan(drifting_plan(), LatLon(47.0, 8.0), 0.2)
    written = WRITERS[ending](placed, "drift", "ardupilot").decode()
    assert "by [0, 10] m until 20 s" in written
    assert [sorted(letter) for letter in placed.word] == [["home"], [], ["S1"], [], ["home"]]
    if ending == ".geojson":
        (south, *_) = (each for each in json.loads(written)["features"] if each["properties"].get("name") == "K")
        assert south["properties"]["motion"] == "by [0, 10] m until 20 s"
