"""Records with odd values, as of a damaged file or another writer: refused in words, or reported without them."""

import json
from pathlib import Path
from typing import Any

import pytest

from mission.errors import RecordError
from mission.monitor.stage import Stage
from mission.plan import FlightPlan
from mission.report.page import page
from mission.report.reading import parse_record
from mission.report.report import write_report
from mission.report.summary import summary
from tests.support.small_missions import SMALL, plan_of

REST = (0.0, 0.0, 0.0)
HEADER = {"kind": "header", "t_s": None, "mission": "small", "schema": 2}
FLY = {"kind": "event", "t_s": 0.0, "name": "stage", "stage": Stage.FLY.value}


GAP = {"kind": "event", "t_s": 1.0, "name": "gap", "missing": "position", "for_s": 1.5}
ODD_ROWS: tuple[object, ...] = (None, 7, "x", [None], [[1]], [{}], [{"row": 7, "figure": ["x"]}])


def reported(t_s: float, **values: object) -> dict[str, Any]:
    """What the vehicle told on its way."""
    return {
        "kind": "telemetry",
        "t_s": t_s,
        "position_m": (9.0 + t_s, 8.0, 6.0),
        "velocity_m_s": (1.0, 0.0, 0.0),
        "attitude_rad": REST,
    } | values


def asked(t_s: float, **values: object) -> dict[str, Any]:
    """What it was asked for."""
    return {
        "kind": "setpoint",
        "t_s": t_s,
        "position_m": (9.0 + t_s, 8.0, 6.0),
        "velocity_m_s": (1.0, 0.0, 0.0),
        "acceleration_m_s2": REST,
        "trajectory_s": t_s,
    } | values


def flight(*odd: object) -> bytes:
    """A short flight with odd lines in it."""
    lines: list[object] = [HEADER, FLY, asked(0.0), reported(0.0), asked(0.5), reported(0.5), *odd]
    return b"".join(json.dumps(line).encode() + b"\n" for line in [*lines, asked(2.0), reported(2.0)])


@pytest.fixture(scope="module")
def small() -> FlightPlan:
    return plan_of(SMALL)


@pytest.mark.parametrize(
    "odd",
    [
        asked(1.0, position_m=None),
        asked(1.0, velocity_m_s=None),
        reported(1.0, position_m=(1e308, -1e308, 1e308)),
        {"kind": "charge", "t_s": 1.0, "percent": None, "drawn_mah": None},
        GAP | {"t_s": None},
        *({"kind": "event", "t_s": 1.0, "name": "preflight", "rows": rows} for rows in ODD_ROWS),
        {"kind": "event", "t_s": 1.0, "name": "preflight"},
    ],
    ids=lambda odd: json.dumps(odd)[:90],
)
def test_odd_values_cost_no_report(small: FlightPlan, tmp_path: Path, odd: dict[str, object]) -> None:
    record = parse_record(flight(odd))
    write_report(small, record, tmp_path, pictures=False)
    told = json.loads((tmp_path / "summary.json").read_text(), parse_constant=pytest.fail)
    assert told["flown"]["reports"] >= 3
    assert "There is no verdict." in (tmp_path / "report.html").read_text(encoding="utf-8")


def test_a_setpoint_without_a_place_is_left_out(small: FlightPlan) -> None:
    whole, odd = (summary(small, parse_record(flight(each))) for each in (asked(1.0), asked(1.0, position_m=None)))
    assert odd["flown"]["largest_error_m"] == pytest.approx(whole["flown"]["largest_error_m"], abs=1e-9)


@pytest.mark.parametrize("achieved", [[], {}, 1, "yes", 1e308], ids=repr)
def test_a_verdict_is_yes_no_or_open(achieved: object) -> None:
    with pytest.raises(RecordError, match="a verdict is true, false or null"):
        parse_record(flight({"kind": "verdict", "t_s": 1.0, "achieved": achieved, "reason": ""}))


def test_a_row_of_the_check_is_shown_as_far_as_it_is_told(small: FlightPlan) -> None:
    row = {"row": "battery", "level": "caution", "forced": True, "figure": "<b>", "advice": None}
    record = parse_record(flight({"kind": "event", "t_s": 1.0, "name": "preflight", "rows": [row, 7], "go": True}))
    html = page(small, record, summary(small, record), ())
    assert "<td>battery</td><td>caution, forced</td><td>&lt;b&gt;</td>" in html
    assert "Check before the flight: go" in html


@pytest.mark.parametrize("odd", [{"for_s": None}, {"for_s": 10**400}, {"for_s": "long"}, {"for_s": -1}], ids=str)
def test_a_gap_that_has_no_length_is_refused(odd: dict[str, object]) -> None:
    with pytest.raises(RecordError):
        parse_record(flight(GAP | odd))
