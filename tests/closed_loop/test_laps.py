"""Flights of laps: as many as the file asks for, or until told to stop; then the vehicle returns."""

import io
import math
from collections.abc import Callable
from dataclasses import replace

import pytest

from mission.fly import FlightOptions, FlightResult, Progress, StopRequest, fly
from mission.link.ending import Ending
from mission.monitor.stage import Stage
from mission.monitor.verdict import Verdict
from mission.plan import FlightPlan
from mission.report.page import page
from mission.report.reading import Record, parse_record
from mission.report.record import FlightRecord
from mission.report.summary import summary
from tests.support.lockstep import LockstepVehicle, vehicle_of
from tests.support.small_missions import ROUNDS, plan_of

CTRL_C = StopRequest("interrupted by the user", after_lap=True)


@pytest.fixture(scope="module")
def endless() -> FlightPlan:
    return plan_of(ROUNDS.replace("laps: 2", "laps: until_stopped"))


class Flight:
    """A flight with requests to stop at times on its trajectory."""

    def __init__(self, plan: FlightPlan, requests: list[tuple[float, StopRequest]]) -> None:
        self.plan, self.requests = plan, list(requests)
        self.vehicle = LockstepVehicle(vehicle_of("px4"))
        self.moments: list[Progress] = []
        self._sink = io.BytesIO()

    def run(self) -> FlightResult:
        return fly(
            self.plan,
            self.vehicle,
            self.vehicle,
            FlightRecord(self._sink, mission="rounds"),
            options=FlightOptions(land_when_stopped=True),
            on_progress=self.moments.append,
            stop_request=self._request,
        )

    def _request(self) -> StopRequest | None:
        flown_s = self.moments[-1].trajectory_s if self.moments else 0.0
        if self.requests and flown_s > self.requests[0][0]:
            return self.requests.pop(0)[1]
        return None

    @property
    def record(self) -> Record:
        return parse_record(self._sink.getvalue())


def times(plan: FlightPlan) -> tuple[float, float]:
    """How long the way to the lap takes, and the lap."""
    out, lap, _ = plan.trajectory.legs
    return out.duration_s, lap.duration_s


@pytest.mark.parametrize(
    ("when", "laps"),
    [
        (lambda out_s, _: 0.5 * out_s, 1),  # before the first lap
        (lambda out_s, lap_s: out_s + 1.3 * lap_s, 2),
    ],
)
def test_laps_go_on_until_told_to_stop(endless: FlightPlan, when: Callable[[float, float], float], laps: int) -> None:
    out_s, lap_s = times(endless)
    flight = Flight(endless, [(when(out_s, lap_s), CTRL_C)])
    result = flight.run()
    assert result.achieved, result.reason
    assert result.exit_code == 0
    assert result.laps == laps
    assert result.reason == f"{laps} lap{'s were' if laps > 1 else ' was'} flown, nothing was violated so far"
    assert result.ending is Ending.LANDED
    assert result.interrupted
    assert flight.record.verdict is not None
    assert flight.record.verdict["interrupted"] is True
    assert result.word[-1] == {"home"}
    assert not result.violations
    asked = flight.record.setpoints.trajectory_s
    ended = endless.trajectory.ended_after(when(out_s, lap_s))
    assert ended.laps == laps
    assert max(t for t in asked if math.isfinite(t)) == pytest.approx(ended.duration_s, abs=0.1)
    assert "returning after this lap" in [event.text for event in flight.record.events]
    before = [moment for moment in flight.moments if not moment.returning and moment.stage is Stage.FLY]
    after = [moment for moment in flight.moments if moment.returning]
    assert all(moment.laps_asked is None and moment.left_s == math.inf for moment in before)
    assert all(moment.laps_asked == laps and moment.left_s < math.inf for moment in after)
    assert {moment.verdict for moment in flight.moments} == {Verdict.OPEN}
    text = page(endless, flight.record, summary(endless, flight.record), ())
    for words in ("until the vehicle is told to return", "Way back from the laps", "open: some satisfy the formula"):
        assert words in text


def test_the_laps_that_the_file_asks_for_are_flown_and_counted() -> None:
    flight = Flight(plan_of(ROUNDS), [])
    result = flight.run()
    assert result.achieved
    assert result.reason == "2 of 2 laps were flown, nothing was violated so far"
    assert flight.record.verdict is not None
    assert flight.record.verdict["laps"] == 2
    assert result.word[-1] == {"home"}


def test_fewer_laps_than_the_file_asks_for_are_not_what_it_asks_for(endless: FlightPlan) -> None:
    out_s, lap_s = times(endless)
    spec = replace(endless.spec, flight=replace(endless.spec.flight, laps=5))
    plan = replace(endless, spec=spec, trajectory=replace(endless.trajectory, laps=5))
    result = Flight(plan, [(out_s + 0.2 * lap_s, CTRL_C)]).run()
    assert result.ending is Ending.LANDED
    assert not result.achieved
    assert result.reason == "1 of 5 laps were flown, nothing was violated so far"


def test_the_second_request_gives_the_flight_up(endless: FlightPlan) -> None:
    out_s, lap_s = times(endless)
    flight = Flight(endless, [(out_s, CTRL_C), (out_s + 0.3 * lap_s, CTRL_C)])
    result = flight.run()
    assert result.ending is Ending.STOPPED
    assert result.interrupted
    assert not result.achieved
    assert result.laps == 0
    # It may hold for less than passes between two moments.
    assert Stage.HOLD in {event.values["stage"] for event in flight.record.events if event.text == "stage"}


def test_on_the_way_back_the_first_request_gives_the_flight_up(endless: FlightPlan) -> None:
    plan = replace(endless, trajectory=replace(endless.trajectory, laps=1))
    flight = Flight(plan, [(plan.trajectory.laps_end_s + 0.5, CTRL_C)])
    result = flight.run()
    assert result.ending is Ending.STOPPED
    assert result.laps == 1


def test_the_end_of_the_program_does_not_wait_for_a_lap(endless: FlightPlan) -> None:
    out_s, _ = times(endless)
    result = Flight(endless, [(out_s, StopRequest("ended by SIGTERM"))]).run()
    assert result.ending is Ending.STOPPED
    assert result.reason == "ended by SIGTERM"


def test_the_third_request_is_obeyed_at_once(endless: FlightPlan) -> None:
    out_s, _ = times(endless)
    with pytest.raises(KeyboardInterrupt):
        Flight(endless, [(out_s, CTRL_C)] * 3).run()
