"""Stretches of a trajectory that are photographed, as values and in a plan's file."""

from dataclasses import replace
from math import inf, nan

import numpy as np
import pytest

from mission.monitor.pictures import missing, pictures_text
from mission.plan import plan_from_json, plan_to_json
from mission.plan.photographs import Photographs, in_order, planned_pictures
from tests.support.small_missions import SMALL, plan_of


@pytest.mark.parametrize(
    ("begin_s", "end_s", "distance_m"),
    [(-1.0, 2.0, 3.0), (2.0, 2.0, 3.0), (1.0, inf, 3.0), (1.0, nan, 3.0), (1.0, 2.0, 0.0), (1.0, 2.0, inf)],
)
def test_what_is_no_stretch_is_refused(begin_s: float, end_s: float, distance_m: float) -> None:
    with pytest.raises(ValueError, match="photographs are"):
        Photographs(begin_s, end_s, distance_m)


def test_stretches_follow_each_other() -> None:
    first, second = Photographs(0.0, 2.0, 3.0), Photographs(2.0, 3.0, None)
    assert in_order([first, second]) == (first, second)
    with pytest.raises(ValueError, match="heading"):
        Photographs(0.0, 2.0, 3.0, nan)
    for wrong in ([second, first], [first, Photographs(1.0, 3.0, 3.0)]):
        with pytest.raises(ValueError, match="begin before"):
            in_order(wrong)


def test_a_plan_keeps_them_and_an_older_file_has_none() -> None:
    plan = plan_of(SMALL)
    stretches = (Photographs(1.5, 6.25, 2.0, 0.5), Photographs(7.0, 8.0, None))
    text = plan_to_json(replace(plan, photographs=stretches))
    assert plan_from_json(text).photographs == stretches
    written = '"photographs": [[1.5, 6.25, 2.0, 0.5], [7.0, 8.0, null, null]], '
    without = plan_from_json(text.replace(written, '"photographs": [[1.5, 6.25, 2.0]], '))
    assert without.photographs == (Photographs(1.5, 6.25, 2.0),)
    older = text.replace(written, "")
    assert older != text
    assert plan_from_json(older).photographs == ()
    assert planned_pictures(plan.trajectory, stretches[1:]) == 1
    steps = np.diff(plan.trajectory.state(np.linspace(1.5, 6.25, 4000))[0], axis=0)
    length_m = float(np.hypot(*steps.T).sum())
    assert length_m > 6.0
    assert planned_pictures(plan.trajectory, stretches) == 2 + int(length_m / 2.0)


def test_what_became_of_the_pictures_in_words() -> None:
    assert pictures_text((), 0) == ""
    assert pictures_text((3,), 1) == "1 photograph of 1 planned"
    assert missing((3, 4, 7, 9, 9)) == 3
    words = "4 photographs of 9 planned, nothing was heard of 2 more, the camera's command was refused"
    assert pictures_text((3, 4, 5, 8), 9, "the camera's command was refused") == words
