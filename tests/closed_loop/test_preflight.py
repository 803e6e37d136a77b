"""The check before the flight, with the bundled vehicle in lock-step: each row forbids a flight, and gives way by name.

One vehicle of each flavour is made ready once and asked again and again: it is never armed.
"""

import io
import math
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, replace
from typing import Any

import pytest
from pymavlink.dialects.v20 import ardupilotmega as mavlink

from mission.fly import FlightOptions, StopRequest, fly
from mission.fly.preflight import Checks, Findings, Level, NoGoError, inspect
from mission.plan import FlightPlan
from mission.report.reading import Record, parse_record
from mission.report.record import FlightRecord
from mission.spec.battery import Battery
from tests.support.lockstep import vehicle_of
from tests.support.small_missions import SMALL, at_a_place, plan_of
from tests.support.spoken_for import SpokenFor

WELL = 0x33F
"""Flags of an estimator that vouches for all."""


@pytest.fixture(scope="module")
def plan() -> FlightPlan:
    return plan_of(SMALL)


@pytest.fixture(scope="module", params=["ardupilot", "px4"])
def vehicle(request: pytest.FixtureRequest, plan: FlightPlan) -> SpokenFor:
    vehicle = SpokenFor(vehicle_of(request.param))
    assert inspect(plan, vehicle, vehicle).go
    return vehicle


@dataclass(frozen=True)
class Case:
    """A row, what forbids it, and words of its figure; by a parameter, by what is said, or by the plan.

    ``ardupilot`` and ``px4`` are a parameter and its value each.
    """

    row: str
    words: str
    ardupilot: tuple[str, float] | None = None
    px4: tuple[str, float] | None = None
    says: Any = None
    exit_code: int = 4

    def parameter(self, flavour: str) -> tuple[str, float] | None:
        """What is set on this flavour; None where it has nothing of the kind."""
        return self.px4 if flavour == "px4" else self.ardupilot


def fix(kind: int, satellites: int) -> Any:  # noqa: ANN401 - pymavlink ships no types
    return mavlink.MAVLink_gps_raw_int_message(0, kind, 473977420, 85455940, 488000, 80, 90, 0, 0, satellites)


CASES = [
    Case("firmware", "later have all", says=mavlink.MAVLink_autopilot_version_message(
        0, 0x01000000, 0, 0, 0, *[[0] * 8] * 3, 0, 0, 0)),
    Case("satellites", "4 satellites", says=fix(3, 4)),
    Case("satellites", "no place", says=fix(1, 3)),
    Case("speed", "asked", ("WPNAV_SPEED", 200), ("MPC_XY_VEL_MAX", 2), exit_code=2),
    Case("acceleration", "asked", ("WPNAV_ACCEL", 150), ("MPC_ACC_HOR_MAX", 2), exit_code=2),
    Case("tilt", "asked", ("ANGLE_MAX", 1000), None, exit_code=2),
    Case("setpoints", "without setpoints", ("GUID_TIMEOUT", 0.1), ("COM_OF_LOSS_T", 0.1)),
    Case("setpoints", "disarms", None, ("COM_OBL_RC_ACT", 7)),
    Case("link-loss", "terminates", None, ("NAV_DLL_ACT", 5)),
    Case("sticks-loss", "disarms", None, ("NAV_RCL_ACT", 6)),
    Case("low-battery", "terminates", ("BATT_FS_LOW_ACT", 5), None),
    Case("fence", "away from home", None, ("GF_MAX_HOR_DIST", 10)),
    Case("fence", "high", None, ("GF_MAX_VER_DIST", 3)),
]  # fmt: skip
BY_FLAVOUR = {"ardupilot": mavlink.MAVLink_ekf_status_report_message(WELL, 1.5, 0, 0, 0, 0)}
BY_FLAVOUR["px4"] = mavlink.MAVLink_estimator_status_message(0, WELL, 1.5, 0, 0, 0, 0, 0, 0, 0)


class Tried:
    """What came of one attempt to fly: its error or its result, the table and the record."""

    def __init__(self, vehicle: SpokenFor, plan: FlightPlan, *forced: str) -> None:
        self.tables: list[Findings] = []
        sink = io.BytesIO()
        self.error: NoGoError | None = None
        self.reason = ""
        try:
            result = fly(
                plan,
                vehicle,
                vehicle,
                FlightRecord(sink, mission="small"),
                options=FlightOptions(checks=Checks(forced, self.tables.append)),
                stop_request=lambda: StopRequest("enough") if self.tables else None,
            )
            self.reason = result.reason
        except NoGoError as error:
            self.error = error
        self.record: Record = parse_record(sink.getvalue())


class Restarting(SpokenFor):
    """It is restarted at a time of the clock here, which goes on."""

    at_s, _ahead_s = 6.0, 0.0

    def now_s(self) -> float:
        return super().now_s() + self._ahead_s

    def receive(self, within_s: float) -> list[bytes]:
        if self.now_s() >= self.at_s:
            self.at_s, before_s = math.inf, self.now_s()
            self.endpoint.reboot_in(0)
            self.endpoint.advance()
            self._ahead_s += before_s - self.now_s()
        return super().receive(within_s)


@pytest.mark.parametrize("flavour", ["ardupilot", "px4"])
@pytest.mark.parametrize("at_s", [2.0, 6.0])
def test_a_vehicle_that_is_restarted_meanwhile_is_asked_again(plan: FlightPlan, flavour: str, at_s: float) -> None:
    vehicle = Restarting(vehicle_of(flavour))
    vehicle.at_s = at_s
    findings = inspect(plan, vehicle, vehicle)
    assert math.isinf(vehicle.at_s)
    assert findings.go, findings.values()


@contextmanager
def changed(vehicle: SpokenFor, case: Case) -> Iterator[None]:
    """The vehicle with what forbids a flight."""
    parameter = case.parameter(vehicle.vehicle.config.flavour.value)
    store = vehicle.vehicle.parameters
    before = None if parameter is None else store[parameter[0]]
    try:
        if parameter is not None:
            store.set(*parameter)
        vehicle.says = [] if case.says is None else [case.says]
        yield
    finally:
        vehicle.says = []
        if parameter is not None and before is not None:
            store.set(parameter[0], before)


@pytest.mark.parametrize(
    ("vehicle", "case"),
    [
        pytest.param(flavour, case, id=f"{flavour}-{case.row}-{case.words}")
        for flavour in ("ardupilot", "px4")
        for case in CASES
        if case.says is not None or case.parameter(flavour) is not None
    ],
    indirect=["vehicle"],
    scope="module",
)
def test_a_row_forbids_the_flight_and_gives_way_by_its_name(vehicle: SpokenFor, plan: FlightPlan, case: Case) -> None:
    with changed(vehicle, case):
        refused, forced = Tried(vehicle, plan), Tried(vehicle, plan, case.row)
    assert refused.error is not None
    assert refused.error.exit_code == case.exit_code
    (row,) = (each for each in refused.error.findings.forbidding)
    assert row.row == case.row
    assert case.words in row.judgement.figure
    assert not vehicle.vehicle.autopilot.armed
    # The record opens and says it.
    assert refused.record.verdict is not None
    assert refused.record.verdict["ending"] == "failed"
    assert case.words in refused.record.verdict["reason"]
    (event,) = (event for event in refused.record.events if event.text == "preflight")
    assert event.values["go"] is False
    # By its name it gives way, and the verdict says so.
    assert forced.error is None
    assert "enough" in forced.reason
    assert f"flown against the check before the flight: {case.row} (" in forced.reason
    assert forced.record.verdict is not None
    assert forced.record.verdict["reason"] == forced.reason


def test_an_estimator_that_refuses_what_is_measured(vehicle: SpokenFor, plan: FlightPlan) -> None:
    vehicle.says = [BY_FLAVOUR[vehicle.vehicle.config.flavour.value]]
    try:
        refused = Tried(vehicle, plan)
    finally:
        vehicle.says = []
    assert refused.error is not None
    assert [row.row for row in refused.error.findings.forbidding] == ["estimator"]


@pytest.mark.parametrize(
    "message", [mavlink.MAVLink_wind_message(270.0, 20.0, 0.0), mavlink.MAVLink_wind_cov_message(0, 0, 20, 0, *[0] * 5)]
)
def test_a_wind_that_cannot_be_leant_against(vehicle: SpokenFor, plan: FlightPlan, message: Any) -> None:  # noqa: ANN401 - pymavlink ships no types
    vehicle.says = [message]
    try:
        refused, forced = Tried(vehicle, plan), Tried(vehicle, plan, "wind")
    finally:
        vehicle.says = []
    assert refused.error is not None
    assert "20.0 m/s from 270°" in str(refused.error)
    assert "flown against the check before the flight: wind" in forced.reason


def test_a_charge_that_does_not_suffice(vehicle: SpokenFor, plan: FlightPlan) -> None:
    thirsty = replace(plan, spec=replace(plan.spec, battery=Battery(current_a=900.0)))
    refused, forced = Tried(vehicle, thirsty), Tried(vehicle, thirsty, "battery")
    assert refused.error is not None
    assert refused.error.exit_code == 4
    assert "mAh needed" in str(refused.error)
    assert "battery" in forced.reason


def test_a_mission_drawn_for_another_town(vehicle: SpokenFor) -> None:
    elsewhere = plan_of(at_a_place(48.2, 16.4))
    refused = Tried(vehicle, elsewhere)
    assert refused.error is not None
    assert refused.error.exit_code == 2
    assert [row.row for row in refused.error.findings.forbidding] == ["origin"]
    assert not vehicle.vehicle.autopilot.armed


def test_to_look_changes_and_arms_nothing(vehicle: SpokenFor, plan: FlightPlan) -> None:
    vehicle.heard.clear()
    revision = vehicle.vehicle.parameters.revision
    findings = inspect(plan, vehicle, vehicle)
    assert findings.go
    assert findings.of(Level.UNKNOWN) in (("wind", "jerk"), ("wind",))
    sent = {"HEARTBEAT", "COMMAND_LONG", "PARAM_REQUEST_READ"}
    assert {message.get_type() for message in vehicle.heard} - {"PING", "TIMESYNC"} == sent
    assert {message.command for message in vehicle.heard if message.get_type() == "COMMAND_LONG"} <= {511, 512}
    assert vehicle.vehicle.parameters.revision == revision
    assert not vehicle.vehicle.autopilot.armed
