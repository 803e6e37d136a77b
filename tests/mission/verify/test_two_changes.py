"""A plan that was tampered with in several fields at once, so that they agree, is found all the same."""

import json
from collections.abc import Callable
from functools import cache
from pathlib import Path
from typing import Any

import pytest

from mission.cli import main
from mission.plan import plan_to_json
from mission.verify.plans import claims
from tests.support.small_missions import CORRIDOR, FIELDS, PHOTOGRAPHED, ROUNDS, SMALL, plan_of

CAMERA = "camera: {field_of_view_deg: [80, 60], overlap: 0.5, sidelap: 0.1}"
IN_LANES = PHOTOGRAPHED.replace(CAMERA, "spacing_m: 6")
Plan = dict[str, Any]


@cache
def written(text: str) -> str:
    return plan_to_json(plan_of(text))


@cache
def sound(text: str) -> str:
    """A plan in which nothing is wrong."""
    assert not [claim for claim in claims(written(text)) if claim.fault]
    return written(text)


def law_of(plan: Plan) -> Plan:
    law: Plan = plan["trajectory"]["legs"][0]["law"]
    return law


def scaled(values: list[float], by: float) -> list[float]:
    return [by * value for value in values]


def spline_of(plan: Plan) -> Plan:
    curve: Plan = plan["trajectory"]["legs"][0]["curve"]
    return curve["legs"][0] if curve["kind"] == "joined" else curve


def the_same_curve_in_half_the_time(plan: Plan) -> None:
    law = law_of(plan)
    law.update(knots_t_s=scaled(law["knots_t_s"], 0.5), rates=scaled(law["rates"], 2.0))
    law.update(growths=scaled(law["growths"], 4.0))


def the_series_and_its_law_stretched(plan: Plan) -> None:
    curve, law = plan["trajectory"]["legs"][0]["curve"], law_of(plan)
    curve.update(duration_s=2.0 * curve["duration_s"], slope_m_s=scaled(curve["slope_m_s"], 0.5))
    law.update({key: scaled(law[key], 2.0) for key in ("knots_s", "rates", "growths")})
    plan["certificate"].update(knots_s=scaled(plan["certificate"]["knots_s"], 2.0))
    plan["stops"] = [[2.0 * s, lasts] for s, lasts in plan["stops"]]


def a_narrower_tube_that_is_farther_away(plan: Plan) -> None:
    plan["certificate"]["tube_m"] -= 0.1
    plan["certificate"]["clearance_m"] += 0.1


def a_triangle_named_as_one_of_the_piece_before(plan: Plan) -> None:
    """Counted from the end, the number of a triangle in one piece is that of another in the piece before."""
    size, sets = len(plan["labels"]["letter_of"]), plan["certificate"]["possible"]
    piece = next(k for k in range(1, len(sets)) if set(sets[k - 1]) - set(sets[k]) and len(sets[k - 1]) > 1)
    gone = min(set(sets[piece - 1]) - set(sets[piece]))
    sets[piece - 1].remove(gone)
    sets[piece].append(gone - size)


def a_field_in_a_triangle_counted_from_the_end(plan: Plan) -> None:
    plan["path"]["segments"][3]["triangle"] -= len(plan["labels"]["letter_of"])


def a_lap_counted_from_the_end(plan: Plan) -> None:
    plan["trajectory"]["lap"] -= len(plan["trajectory"]["legs"])


def a_way_of_no_time(plan: Plan) -> None:
    spline = spline_of(plan)
    first = spline["controls_m"][0]
    spline["knots_s"].insert(1, spline["knots_s"][1])
    spline["controls_m"].insert(1, [first[-1], *([[1e3, 1e3]] * (len(first) - 2)), first[-1]])


def a_curve_that_begins_late(plan: Plan) -> None:
    spline = spline_of(plan)
    spline["knots_s"][0] = 0.5 * spline["knots_s"][1]


def lanes_and_their_visit_forgotten(plan: Plan) -> None:
    plan["covers"].clear()


@pytest.mark.parametrize(
    ("text", "change", "row", "words"),
    [
        (ROUNDS + CORRIDOR, the_same_curve_in_half_the_time, "time law", "and the limit is"),
        (SMALL + FIELDS, the_series_and_its_law_stretched, "curve", "off the series of its path"),
        (SMALL + FIELDS, a_narrower_tube_that_is_farther_away, "mission", "certificate.tube_m"),
        (ROUNDS + FIELDS, a_triangle_named_as_one_of_the_piece_before, "file", "a triangle has a number from 0 to"),
        (ROUNDS + FIELDS, a_field_in_a_triangle_counted_from_the_end, "file", "a triangle has a number from 0 to"),
        (ROUNDS + CORRIDOR, a_lap_counted_from_the_end, "file", "`trajectory.lap` is the number of no leg"),
        (ROUNDS + CORRIDOR, a_way_of_no_time, "file", "goes nowhere in no time"),
        (ROUNDS + CORRIDOR, a_curve_that_begins_late, "file", "a curve begins at 0"),
        (IN_LANES + FIELDS, lanes_and_their_visit_forgotten, "lanes", "field is visited from"),
    ],
)
def test_changes_that_agree_are_found(text: str, change: Callable[[Plan], None], row: str, words: str) -> None:
    plan = json.loads(sound(text))
    change(plan)
    assert words in {claim.name: claim.fault or "" for claim in claims(json.dumps(plan))}[row]


def test_a_plan_of_another_mission_is_told_apart(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """A plan proves the mission in it: one that was changed with it is found beside the mission's file alone."""
    plan, file = tmp_path / "plan.json", tmp_path / "mission.yaml"
    plan.write_text(written(SMALL + CORRIDOR))
    file.write_text(SMALL + CORRIDOR)
    assert main(["verify", str(plan), "--mission", str(file)]) == 0
    assert "the mission is that of" in capsys.readouterr().out
    file.write_text(SMALL.replace("loiter_s: 2", "loiter_s: 3") + CORRIDOR)
    assert main(["verify", str(plan), "--mission", str(file)]) == 1
    assert "regions.goal.loiter_s" in capsys.readouterr().out
