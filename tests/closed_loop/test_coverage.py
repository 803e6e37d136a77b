"""A field is covered in lock-step, in wind: what is planned is flown, photographed lane by lane, and judged so."""

import io
from math import radians, remainder, tau

import pytest

from mission.fly import FlightResult, fly
from mission.fly.interruption import StopRequest
from mission.plan import FlightPlan
from mission.plan.turning import headings_of
from mission.report.coverage import covered_again
from mission.report.reading import Record, parse_record
from mission.report.record import FlightRecord
from tests.support.fields import SMALL_FIELD
from tests.support.lockstep import LockstepVehicle, vehicle_of
from tests.support.small_missions import plan_of
from tests.support.usual_cases import ARDUPILOT


@pytest.fixture(scope="module")
def plan() -> FlightPlan:
    return plan_of(SMALL_FIELD)


def flown(plan: FlightPlan, vehicle: LockstepVehicle, stop_at_s: float | None = None) -> tuple[FlightResult, Record]:
    sink = io.BytesIO()
    record = FlightRecord(sink, mission="field")

    wishes = [] if stop_at_s is None else [(stop_at_s, StopRequest("enough"))]

    def request() -> StopRequest | None:
        return wishes.pop()[1] if wishes and vehicle.vehicle.time_s >= wishes[0][0] else None

    result = fly(plan, vehicle, vehicle, record, stop_request=request)
    return result, parse_record(sink.getvalue())


@ARDUPILOT
def test_a_field_is_covered_in_wind(plan: FlightPlan, flavour: str) -> None:
    result, record = flown(plan, LockstepVehicle(vehicle_of(flavour, 3, wind_m_s=4.0)))
    assert result.achieved, result.reason
    [covered] = result.covered
    [visit] = plan.covers
    assert covered.share > 0.98
    assert f"field covered to {covered.share:.1%}" in result.reason
    [again] = covered_again(plan, record)
    assert again.share == pytest.approx(covered.share, abs=1e-3)
    assert abs(len(result.pictures) - plan.planned_pictures) <= len(visit.lanes_m)
    # The vehicle has turned into each lane before it takes the first picture there.
    assert result.began_s is not None
    seen = 0
    for stretch, heading_rad in zip(plan.photographs, headings_of(visit.lanes_m).tolist(), strict=True):
        begin_s, end_s = (result.began_s + edge_s for edge_s in (stretch.begin_s - 0.02, stretch.end_s + 0.15))
        taken = [each for each in record.pictures if begin_s <= each.t_s <= end_s]
        assert taken
        off = [abs(remainder(each.attitude_rad[2] - heading_rad, tau)) for each in taken]
        assert max(off) < radians(2.0)
        seen += len(taken)
    assert seen == len(record.pictures)


def test_a_flight_that_ends_halfway_says_how_much_was_covered(plan: FlightPlan) -> None:
    vehicle = LockstepVehicle(vehicle_of("ardupilot", 3))
    result, _ = flown(plan, vehicle, stop_at_s=vehicle.vehicle.time_s + 0.5 * plan.trajectory.duration_s + 20.0)
    assert not result.achieved
    [covered] = result.covered
    assert 0.1 < covered.share < 0.9
    assert f"field covered to {covered.share:.1%}" in result.reason
