"""Reasons to give a flight up: a table of situations, and their order."""

from itertools import combinations
from typing import Any

import pytest

from mission.monitor.failsafe import Situation, reason_to_stop
from mission.monitor.verdict import Verdict

FINE = Situation(
    estimate_healthy=True,
    battery_critical=False,
    violation="",
    verdict=Verdict.OPEN,
    astray=False,
    error_m=0.1,
)

# In the order in which they count.
CAUSES: tuple[tuple[dict[str, Any], str], ...] = (
    ({"estimate_healthy": False}, "no longer trusts its own position"),
    ({"battery_critical": True}, "the battery is critical"),
    ({"violation": "it left the domain"}, "it left the domain"),
    ({"closing": "the flight is 3.0 s late and would come into gate[60,180]"}, "3.0 s late"),
    ({"verdict": Verdict.FALSE}, "can no longer be satisfied"),
    ({"sealed": True}, "from here nothing can be completed without a violation"),
    ({"astray": True, "error_m": 12.34}, "does not follow: it is 12.3 m off"),
)


@pytest.mark.parametrize("change", [{}, {"verdict": Verdict.TRUE}, {"error_m": 9.0}])
def test_nothing_grave_is_no_reason_to_stop(change: dict[str, Any]) -> None:
    assert not reason_to_stop(FINE._replace(**change))


@pytest.mark.parametrize(("change", "reason"), CAUSES)
def test_each_cause_has_its_reason(change: dict[str, Any], reason: str) -> None:
    assert reason in reason_to_stop(FINE._replace(**change))


@pytest.mark.parametrize(("graver", "lesser"), list(combinations(CAUSES, 2)))
def test_the_graver_cause_is_told(graver: tuple[dict[str, Any], str], lesser: tuple[dict[str, Any], str]) -> None:
    assert graver[1] in reason_to_stop(FINE._replace(**lesser[0] | graver[0]))
