"""What another formula forbids is seen on the way that is flown meanwhile, by all of its tube."""

import numpy as np
import pytest

from mission.fly.prohibitions import Prohibitions
from mission.geometry.arrays import FloatArray
from mission.spec.loader import parse_mission
from tests.support.small_missions import SMALL

INTO_GOAL = np.linspace((9.0, 8.0), (30.0, 8.0), 200)
BESIDE_GOAL = np.linspace((9.0, 12.6), (30.0, 12.6), 200)
AT_HOME = np.linspace((6.0, 6.0), (12.0, 10.0), 50)


def prohibitions(formula: str) -> Prohibitions:
    text = SMALL.replace("F (goal & F G home) & G !pond", formula)
    assert text != SMALL
    found = Prohibitions.of(parse_mission(text.encode()))
    assert found is not None
    return found


@pytest.mark.parametrize(
    ("formula", "places_m", "half_m", "met"),
    [
        ("F G home & G !goal", INTO_GOAL, 0.5, "goal"),
        ("F G home & G !goal", AT_HOME, 0.5, ""),
        ("F G home & G !goal", BESIDE_GOAL, 0.5, ""),
        ("F G home & G !goal", BESIDE_GOAL, 0.7, "goal"),
        ("F G home & (!goal U pond)", INTO_GOAL, 0.0, "goal"),
        ("F (goal & F G home)", INTO_GOAL, 0.5, ""),
        ("F goal & G (goal -> G goal)", INTO_GOAL, 0.5, ""),
        ("F G home & G home", INTO_GOAL, 0.0, "what is in no region"),
    ],
)
def test_what_is_met(formula: str, places_m: FloatArray, half_m: float, met: str) -> None:
    assert prohibitions(formula).met(places_m, half_m) == met
