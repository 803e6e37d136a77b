"""Failsafe decisions: a table of situations, and the order of their causes."""

import math
from dataclasses import replace
from itertools import combinations
from typing import Any

import pytest

from mission.monitor.failsafe import Decision, Patience, Situation, decide
from mission.monitor.verdict import Verdict

FINE = Situation(
    telemetry_age_s=0.1,
    mode_expected="GUIDED",
    mode_reported="GUIDED",
    estimate_healthy=True,
    battery_critical=False,
    violation="",
    verdict=Verdict.OPEN,
    excess_s=0.0,
    error_m=0.1,
    tube_m=0.5,
)

# In the order in which they count.
CAUSES: tuple[tuple[dict[str, Any], Decision, str], ...] = (
    ({"telemetry_age_s": 3.1}, Decision.LINK_LOST, "nothing was received from the vehicle for 3.1 s"),
    ({"mode_reported": "LOITER"}, Decision.HAND_OVER, "someone else put the vehicle into LOITER"),
    ({"estimate_healthy": False}, Decision.HOLD_AND_LAND, "no longer trusts its own position"),
    ({"battery_critical": True}, Decision.HOLD_AND_LAND, "the battery is critical"),
    ({"violation": "it left the domain"}, Decision.HOLD_AND_LAND, "it left the domain"),
    ({"verdict": Verdict.FALSE}, Decision.HOLD_AND_LAND, "can no longer be satisfied"),
    ({"excess_s": 2.1, "error_m": 1.25}, Decision.HOLD_AND_LAND, "1.25 m off the trajectory for 2.1 s, where 0.50 m"),
)


@pytest.mark.parametrize(
    "change",
    [
        {},
        {"telemetry_age_s": 3.0},
        {"excess_s": 2.0, "error_m": 9.0},
        {"verdict": Verdict.TRUE},
        {"error_m": 0.7, "excess_s": 0.5},
    ],
)
def test_nothing_grave_is_no_reason_to_stop(change: dict[str, Any]) -> None:
    ruling = decide(replace(FINE, **change))
    assert ruling.decision is Decision.CONTINUE
    assert not ruling.reason


@pytest.mark.parametrize(("change", "decision", "reason"), CAUSES)
def test_each_cause_has_its_decision(change: dict[str, Any], decision: Decision, reason: str) -> None:
    ruling = decide(replace(FINE, **change))
    assert ruling.decision is decision
    assert reason in ruling.reason


@pytest.mark.parametrize(("graver", "lesser"), list(combinations(CAUSES, 2)))
def test_the_graver_cause_decides(
    graver: tuple[dict[str, Any], Decision, str], lesser: tuple[dict[str, Any], Decision, str]
) -> None:
    ruling = decide(replace(FINE, **graver[0], **lesser[0]))
    assert ruling.decision is graver[1]
    assert graver[2] in ruling.reason


def test_patience_is_a_setting() -> None:
    late = replace(FINE, telemetry_age_s=4.0)
    assert decide(late, Patience(telemetry_s=5.0)).decision is Decision.CONTINUE
    astray = replace(FINE, excess_s=3.0)
    assert decide(astray, Patience(excess_s=4.0)).decision is Decision.CONTINUE


def test_durations_that_are_no_numbers_are_too_long() -> None:
    assert decide(replace(FINE, telemetry_age_s=math.nan)).decision is Decision.LINK_LOST
    assert decide(replace(FINE, excess_s=math.nan)).decision is Decision.HOLD_AND_LAND
