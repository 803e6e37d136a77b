"""A number of laps that is written into the text of a mission file."""

from dataclasses import replace
from typing import Literal

import pytest

from mission.spec.amended import with_laps
from mission.spec.loader import parse_mission
from tests.support.small_missions import ROUNDS, SMALL

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
    amended = with_laps(text, laps)
    assert parse_mission(amended.encode(), "a.yaml") == replace(asked, flight=replace(asked.flight, laps=laps))
    assert sum(" #" in line for line in amended.splitlines()) == sum(" #" in line for line in text.splitlines())


def test_where_no_place_is_the_laps_own_they_are_told_in_a_comment() -> None:
    text = ROUNDS.replace("laps: 2", "laps: *few").replace("[[0, 0], [40", "[[&few 2, 2], [40")
    amended = with_laps(text, 5)
    assert amended.startswith(text.rstrip())
    assert amended.endswith("# flown with laps: 5\n")
