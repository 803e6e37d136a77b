"""Warnings for missions that have a plan."""

import pytest

from mission.logic.formula.parser import parse_formula
from mission.plan.cautions import cautions
from mission.spec.model import Semantics
from mission.spec.specification import Specification
from tests.support.small_missions import SMALL, plan_of

LETTERS = (frozenset[str](), frozenset({"home"}), frozenset({"a"}))
AT_HOME = 1


@pytest.mark.parametrize(
    ("formula", "says"),
    [
        ("F home & F a", "`F home` already holds where the flight starts (home)"),
        ("F a & X !a", "`X !a` may depend on the mesh"),
        ("F a & G (a -> F a)", "`G (a -> F a)` asks nothing"),
        ("F a & G !(a & home)", "`G !(a & home)` asks nothing: every flight on this map"),
    ],
)
def test_one_conjunct_is_odd(formula: str, says: str) -> None:
    (warning,) = cautions(Specification(parse_formula(formula)), LETTERS, AT_HOME, Semantics.STANDARD)
    assert warning.startswith(says)
    assert "speed" not in says or warning.endswith("can, write `limits: {speed_m_s: 6.5}`")


@pytest.mark.parametrize("formula", ["F (a & F home)", "G F home & F a", "F G home", "!a U home | F a & G !a"])
def test_nothing_is_odd(formula: str) -> None:
    assert cautions(Specification(parse_formula(formula)), LETTERS, 0, Semantics.STANDARD) == ()


def test_the_paper_does_not_read_the_label_of_the_start() -> None:
    assert cautions(Specification(parse_formula("F home")), LETTERS, AT_HOME, Semantics.PAPER) == ()


def test_a_plan_carries_its_warnings() -> None:
    plan = plan_of(SMALL.replace("formula: F (goal", "formula: F home & F (goal"))
    assert [warning.split(" already")[0] for warning in plan.warnings] == ["`F home`"]
    assert plan_of(SMALL).warnings == ()


@pytest.mark.parametrize(
    ("change", "says"),
    [
        (
            ("altitude_m: 6", "altitude_m: 3000"),
            "flight.altitude_m: 3000 m above the take-off point is more",
        ),
        (
            ("speed_m_s: 4.0", "speed_m_s: 6.5"),
            "flight.speed_m_s: 6.5 m/s is above limits.speed_m_s, so it is flown at 6 m/s at most; where the vehicle",
        ),
    ],
)
def test_how_it_is_flown_may_be_odd(change: tuple[str, str], says: str) -> None:
    (warning,) = plan_of(SMALL.replace(*change)).warnings
    assert warning.startswith(says)
    assert "speed" not in says or warning.endswith("can, write `limits: {speed_m_s: 6.5}`")


def test_limits_themselves_are_not_odd() -> None:
    text = SMALL.replace("altitude_m: 6", "altitude_m: 120").replace("speed_m_s: 4.0", "speed_m_s: 6.0")
    assert plan_of(text).warnings == ()
