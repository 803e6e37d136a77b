"""Missions that no flight satisfies, each beside the explanation that its writer reads."""

from pathlib import Path

import numpy as np
import pytest

from mission.errors import AutomatonSizeError, NoPlanError
from mission.geometry.location import Locator
from mission.plan import plan_mission
from mission.plan.diagnosis import Cause
from mission.spec.domain import build_domain
from mission.spec.loader import load_mission
from tests.support.small_missions import FIELDS, SMALL, plan_of

FOLDER = Path(__file__).parents[2] / "golden" / "refusals"
MISSIONS = sorted(FOLDER.glob("*.yaml"))


def refused(file: Path) -> NoPlanError:
    with pytest.raises(NoPlanError) as caught:
        plan_mission(load_mission(file))
    return caught.value


@pytest.mark.parametrize("file", MISSIONS, ids=lambda file: str(file.stem))
def test_the_explanation_is_the_one_beside_the_mission(file: Path) -> None:
    spec = load_mission(file)
    start = Locator(build_domain(spec)[0]).triangle_at(np.array([spec.start.position_m]))[0]
    text = file.with_suffix(".txt").read_text(encoding="utf-8")
    assert f"{refused(file)}\n" == text.replace("{start}", str(start))


def test_every_explanation_has_its_mission() -> None:
    assert len(MISSIONS) >= 10
    assert {file.stem for file in FOLDER.glob("*.txt")} == {file.stem for file in MISSIONS}


def test_every_cause_has_a_mission() -> None:
    assert {refused(file).cause for file in MISSIONS} == set(Cause)


def test_the_failure_carries_its_parts() -> None:
    failure = refused(FOLDER / "behind_a_wall.yaml")
    assert failure.cause == Cause.UNREACHABLE
    assert failure.conjuncts == ("F silo",)
    assert failure.restricted == ("wall",)
    assert failure.regions == ("silo",)
    assert failure.exit_code == 3


def test_a_question_that_is_too_large_leaves_the_reason_of_the_search(monkeypatch: pytest.MonkeyPatch) -> None:
    def too_large(*_: object, **__: object) -> None:
        raise AutomatonSizeError("too large")

    monkeypatch.setattr("mission.plan.explained.diagnose", too_large)
    failure = refused(FOLDER / "behind_a_wall.yaml")
    assert failure.conjuncts == ()
    assert "silo" in str(failure)


def test_a_region_that_the_tube_does_not_fit_into_is_named() -> None:
    narrow = SMALL.replace("[[26, 4], [36, 4], [36, 12], [26, 12]]", "[[26, 4], [26.8, 4], [26.8, 12], [26, 12]]")
    for text in (narrow, narrow + FIELDS):
        with pytest.raises(NoPlanError) as caught:
            plan_of(text)
        assert str(caught.value).splitlines() == [
            "there is a plan without a tube, but not with this one of 0.5 m per axis:",
            "    the tube does not fit into goal; a tube of 0.27 m per axis surely has room there",
            "    it takes up to 0.707 m on each side of the path: see `flight.tube`",
        ]
