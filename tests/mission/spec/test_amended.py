"""Values that are written into the text of a mission file."""

from dataclasses import replace
from typing import Literal

import pytest

from mission.spec.amended import GONE, with_values
from mission.spec.loader import parse_mission
from mission.spec.model import Extension, Smoothing
from tests.support.small_missions import ROUNDS, SMALL

LAPS = ("mission", "laps")
FLOWING = ROUNDS.replace(
    "mission:\n  formula: G F east & G F north & G !pond\n  laps: 2\n",
    'mission: {formula: "G F east & G F north & G !pond", laps: 2} # as "agreed"\n',
)
FORMS = {
    "there": ROUNDS,
    "commented": ROUNDS.replace("laps: 2", "laps: 2  # and no more"),
    "quoted": ROUNDS.replace("laps: 2", "'laps':   until_stopped"),
    "missing": ROUNDS.replace("  laps: 2\n", ""),
    "first": ROUNDS.replace("mission:\n", "mission:\n  # how often\n  laps: 2\n").replace(
        "& G !pond\n  laps: 2", "& G !pond"
    ),
    "flowing": FLOWING,
    "flowing, missing": FLOWING.replace(", laps: 2", ""),
    "no section": SMALL.replace("mission:\n  formula: F (goal & F G home) & G !pond\n", "tasks: [{visit: [goal]}]\n"),
    "returns": ROUNDS.replace("\n", "\r\n"),
}


@pytest.mark.parametrize("laps", [7, "until_stopped"])
@pytest.mark.parametrize("form", FORMS)
def test_the_text_asks_for_so_many_laps_and_is_else_the_same(form: str, laps: int | Literal["until_stopped"]) -> None:
    text = FORMS[form]
    asked = parse_mission(text.encode(), "a.yaml")
    amended = with_values(text, {LAPS: laps})
    assert parse_mission(amended.encode(), "a.yaml") == replace(asked, flight=replace(asked.flight, laps=laps))
    assert sum(" #" in line for line in amended.splitlines()) == sum(" #" in line for line in text.splitlines())


def test_where_no_place_is_the_laps_own_the_mission_is_written_anew() -> None:
    text = ROUNDS.replace("laps: 2", "laps: *few").replace("[[0, 0], [40", "[[&few 2, 2], [40")
    asked = parse_mission(text.encode(), "a.yaml")
    amended = with_values(text, {LAPS: 5})
    assert parse_mission(amended.encode(), "a.yaml") == replace(asked, flight=replace(asked.flight, laps=5))


@pytest.mark.parametrize("form", FORMS)
def test_any_value_is_changed_added_or_taken_away(form: str) -> None:
    text = FORMS[form]
    asked = parse_mission(text.encode(), "a.yaml")
    changes = {
        ("start", "position_m"): [10.0, 9.0],
        ("flight", "altitude_m"): 12.5,
        ("limits", "jerk_m_s3"): 3.0,
        ("smoothing", "frequencies"): 30,
        ("regions", "pond", "clearance_m"): 1.5,
        ("description",): "as 'tried': here",
        ("flight", "time_constant_s"): GONE,
    }
    changed = parse_mission(with_values(text, changes).encode(), "a.yaml")
    assert changed.start.position_m == (10.0, 9.0)
    assert (changed.flight.altitude_m, changed.limits.jerk_m_s3) == (12.5, 3.0)
    assert changed.smoothing == Smoothing(Extension.ODD, 30)
    assert {region.name: region.clearance_m for region in changed.regions}["pond"] == 1.5
    assert changed.description == "as 'tried': here"
    assert (changed.formula, changed.tasks, changed.flight.speed_m_s) == (
        asked.formula,
        asked.tasks,
        asked.flight.speed_m_s,
    )


def test_a_section_that_is_a_text_gives_way() -> None:
    changed = with_values(SMALL + "smoothing: corridor\n", {("smoothing", "frequencies"): 20})
    assert parse_mission(changed.encode(), "a.yaml").smoothing == Smoothing(Extension.ODD, 20)
