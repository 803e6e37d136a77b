"""A computer that is short of time: listening and speaking cost time that the vehicle flies on.

Setpoints still come, and what is heard is heard in time.
"""

import io
from typing import TYPE_CHECKING, Any

import pytest

from mission.fly import FlightResult, Progress, fly
from mission.link.identity import LinkOptions
from mission.link.session import Session
from mission.plan import FlightPlan
from mission.report.reading import Record, parse_record
from mission.report.record import FlightRecord
from tests.support.lockstep import LockstepVehicle, vehicle_of
from tests.support.small_missions import SMALL, plan_of
from tests.support.usual_cases import PX4

if TYPE_CHECKING:
    from collections.abc import Callable

MESSAGES_S = 61.0
"""Messages that the planner handles in each second of a flight, where it leaves none out."""


class CostlyFlight:
    """Each message that is handled costs vehicle time, as do each setpoint that is sent, and one stall in flight."""

    def __init__(self, flavour: str, load: float, stall_s: float = 0.0, setpoint_s: float = 0.0) -> None:
        self.vehicle = LockstepVehicle(vehicle_of(flavour))
        self.said: list[str] = []
        self.shown: list[Progress] = []
        self.sent_s: list[float] = []
        self._cost_s, self._stall_s, self._debt_s = load / MESSAGES_S, stall_s, 0.0
        self._setpoint_s = setpoint_s
        self._sink = io.BytesIO()

    def cost(self, seconds: float) -> None:
        self._debt_s += seconds
        while self._debt_s >= 0.01:
            self._debt_s -= 0.01
            self.vehicle.endpoint.advance()

    def run(self, plan: FlightPlan, monkeypatch: pytest.MonkeyPatch) -> FlightResult:
        take: Callable[..., None] = Session._take
        send = LockstepVehicle.send

        def take_at_a_cost(session: Session, *arguments: Any) -> None:  # noqa: ANN401 - passed on as they are
            take(session, *arguments)
            self.cost(self._cost_s)

        def send_and_note(vehicle: LockstepVehicle, data: bytes) -> None:
            if data[7] == 84:  # SET_POSITION_TARGET_LOCAL_NED
                self.sent_s.append(vehicle.now_s())
                self.cost(self._setpoint_s)
            send(vehicle, data)

        monkeypatch.setattr(Session, "_take", take_at_a_cost)
        monkeypatch.setattr(LockstepVehicle, "send", send_and_note)
        return fly(
            plan,
            self.vehicle,
            self.vehicle,
            FlightRecord(self._sink, mission="small"),
            on_progress=self.watch,
            on_warning=self.said.append,
        )

    def watch(self, progress: Progress) -> None:
        self.shown.append(progress)
        if self._stall_s and progress.trajectory_s > 5.0:
            stall_s, self._stall_s = self._stall_s, 0.0
            self.cost(stall_s)

    @property
    def gaps_s(self) -> list[float]:
        """Vehicle time between two setpoints, the longest first."""
        return sorted((b - a for a, b in zip(self.sent_s, self.sent_s[1:], strict=False)), reverse=True)

    @property
    def record(self) -> Record:
        return parse_record(self._sink.getvalue())


@pytest.fixture(scope="module")
def plan() -> FlightPlan:
    return plan_of(SMALL)


@pytest.mark.parametrize(("flavour", "stall_s"), [("ardupilot", 1.0), ("px4", 0.8)])
def test_a_stall_is_one_gap_and_it_is_told_how_far_behind_the_computer_was(
    plan: FlightPlan, monkeypatch: pytest.MonkeyPatch, flavour: str, stall_s: float
) -> None:
    flight = CostlyFlight(flavour, 0.93, stall_s)
    result = flight.run(plan, monkeypatch)
    assert result.achieved, result.reason
    assert flight.gaps_s[0] == pytest.approx(stall_s, abs=0.1)
    assert flight.gaps_s[1] <= 0.2
    assert stall_s - 0.25 <= result.behind_s <= stall_s + 0.25
    assert any(progress.behind_s > 0.2 for progress in flight.shown)
    assert flight.shown[-1].behind_s == 0.0
    (said,) = flight.said
    assert said.startswith("this computer does not keep up: it is ")
    record = flight.record
    told = [event for event in record.events if "this computer" in event.text]
    assert [event.text for event in told][:2] == ["this computer does not keep up", "this computer keeps up again"]
    assert told[1].values["left_out"] > 0
    assert record.verdict is not None
    assert record.verdict["behind_s"] == result.behind_s


def test_setpoints_come_even_if_there_is_more_to_hear_than_there_is_time(
    plan: FlightPlan, monkeypatch: pytest.MonkeyPatch
) -> None:
    flight = CostlyFlight("px4", 1.3)
    result = flight.run(plan, monkeypatch)
    assert result.achieved, result.reason
    assert flight.gaps_s[0] <= 0.2
    assert 0.2 < result.behind_s < 1.0


def test_what_is_said_is_heard_in_time_even_if_setpoints_take_longer_than_there_is_between_them(
    plan: FlightPlan, monkeypatch: pytest.MonkeyPatch
) -> None:
    flight = CostlyFlight("ardupilot", 0.4, setpoint_s=0.04)
    result = flight.run(plan, monkeypatch)
    assert result.achieved, result.reason
    assert result.behind_s < 0.2
    assert flight.gaps_s[0] <= 0.2


def test_who_has_time_is_not_behind(plan: FlightPlan, monkeypatch: pytest.MonkeyPatch) -> None:
    flight = CostlyFlight("ardupilot", 0.5)
    result = flight.run(plan, monkeypatch)
    assert result.behind_s == 0.0
    assert flight.said == []
    assert flight.gaps_s[0] <= 0.1


@PX4
def test_setpoints_come_at_50_hz_and_the_record_says_how_regularly(
    plan: FlightPlan, monkeypatch: pytest.MonkeyPatch, flavour: str
) -> None:
    flight = CostlyFlight(flavour, 0.0)
    result = flight.run(plan, monkeypatch)
    gaps_s = sorted(flight.gaps_s)
    period_s = LinkOptions().setpoint_s
    assert period_s == 1.0 / 50.0
    assert gaps_s[int(0.99 * len(gaps_s))] <= 1.5 * period_s
    verdict = flight.record.verdict
    assert verdict is not None
    assert verdict["setpoints"] == len(flight.sent_s)
    assert verdict["median_gap_s"] == pytest.approx(period_s, abs=1e-3)
    assert verdict["p99_gap_s"] <= 1.5 * period_s
    assert verdict["largest_gap_s"] == pytest.approx(result.cadence.largest_gap_s, abs=1e-4)
    assert verdict["largest_gap_s"] == pytest.approx(gaps_s[-1], abs=0.011)
