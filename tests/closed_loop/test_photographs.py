"""Flights that are photographed, in lock-step: where pictures are taken, and that the trigger is off in the end."""

import io
from collections.abc import Callable
from dataclasses import replace
from itertools import pairwise
from math import hypot

import numpy as np
import pytest

from mission.errors import FlightError
from mission.fly import FlightResult, fly
from mission.fly.interruption import StopRequest
from mission.link.ending import Ending
from mission.plan import FlightPlan
from mission.plan.photographs import Photographs
from mission.report.reading import Record, parse_record
from mission.report.record import FlightRecord
from tests.support.lockstep import LockstepVehicle, vehicle_of
from tests.support.small_missions import SMALL, plan_of
from tests.support.steered_plans import BY_FIELDS
from tests.support.usual_cases import ARDUPILOT
from vehicle_sim.autopilot import Mode

EVERY_M = 3.0


@pytest.fixture(scope="module")
def plan() -> FlightPlan:
    plan = plan_of(SMALL + BY_FIELDS)
    duration_s = plan.trajectory.duration_s
    stretches = (
        Photographs(0.2 * duration_s, 0.45 * duration_s, EVERY_M),
        Photographs(0.5 * duration_s, 0.5 * duration_s + 1.0, None),
        Photographs(0.6 * duration_s, 0.8 * duration_s, EVERY_M),
    )
    return replace(plan, photographs=stretches)


def flown(
    plan: FlightPlan,
    vehicle: LockstepVehicle,
    stop: Callable[[], StopRequest | None] | None = None,
    warnings: list[str] | None = None,
) -> tuple[FlightResult, Record]:
    sink = io.BytesIO()
    warned = [] if warnings is None else warnings
    record = FlightRecord(sink, mission="small")
    result = fly(plan, vehicle, vehicle, record, stop_request=stop, on_warning=warned.append)
    return result, parse_record(sink.getvalue())


def still_triggers(vehicle: LockstepVehicle) -> bool:
    """Whether a picture is taken by a vehicle that is carried on by 20 m."""
    camera = vehicle.vehicle.camera
    assert camera is not None
    before, estimate = camera.taken, vehicle.vehicle.estimate
    for metres in range(20):
        north, east, down = estimate.position_ned_m
        place = (north + metres, east, down)
        camera.step(estimate._replace(position_ned_m=place, time_s=estimate.time_s + metres), in_mission=False)
    return camera.taken > before


@ARDUPILOT
def test_pictures_are_taken_in_their_stretches_and_nowhere_else(plan: FlightPlan, flavour: str) -> None:
    vehicle = LockstepVehicle(vehicle_of(flavour, 5, wind_m_s=2.0))
    result, record = flown(plan, vehicle)
    assert result.achieved, result.reason
    camera = vehicle.vehicle.camera
    assert camera is not None
    assert len(result.pictures) == len(record.pictures) == camera.taken
    assert abs(camera.taken - plan.planned_pictures) <= 1
    assert f"{camera.taken} photographs of {plan.planned_pictures} planned" in result.reason
    assert result.began_s is not None
    begins = result.began_s
    rows = [
        [each for each in record.pictures if row.begin_s - 0.01 <= each.t_s - begins <= row.end_s + 0.1]
        for row in plan.photographs
    ]
    assert sum(map(len, rows)) == camera.taken
    first, single, last = rows
    assert len(single) == 1
    assert single[0].t_s - begins == pytest.approx(plan.photographs[1].begin_s, abs=0.1)
    for row in (first, last):
        assert len(row) > 2
        gaps = [hypot(b.position_m[0] - a.position_m[0], b.position_m[1] - a.position_m[1]) for a, b in pairwise(row)]
        # A step of 0.01 s late at most, and centimetres of rounding of the place.
        assert all(EVERY_M - 0.03 <= gap <= EVERY_M + 0.01 * plan.spec.flight.speed_m_s * 1.5 + 0.03 for gap in gaps)
    # What the autopilot tells of a picture is what it told of itself then.
    track = record.track
    for each in record.pictures:
        near = int(np.argmin(np.abs(track.t_s - each.t_s)))
        assert np.allclose(track.position_m[near], each.position_m, atol=0.35)
        off = np.exp(1j * track.attitude_rad[near]) / np.exp(1j * np.array(each.attitude_rad))
        assert np.abs(np.angle(off)).max() < 0.1
    assert all(0.0 < number < 5.0 for each in record.pictures for number in each.accuracy_m)
    assert not still_triggers(vehicle)


def test_a_flight_that_is_given_up_in_a_stretch_switches_the_trigger_off(plan: FlightPlan) -> None:
    vehicle = LockstepVehicle(vehicle_of("ardupilot", 5))
    wishes = iter([StopRequest("enough")])

    def stop() -> StopRequest | None:
        camera = vehicle.vehicle.camera
        return next(wishes, None) if camera is not None and camera.taken >= 3 else None

    result, record = flown(plan, vehicle, stop)
    assert result.ending is Ending.STOPPED
    assert len(record.pictures) >= 3
    assert not still_triggers(vehicle)


def test_a_pilot_who_takes_over_finds_the_trigger_off(plan: FlightPlan) -> None:
    def take_over(lockstep: LockstepVehicle) -> None:
        camera = lockstep.vehicle.camera
        if camera is not None and camera.taken == 3:
            lockstep.vehicle.autopilot.set_mode(Mode.HOLD)

    vehicle = LockstepVehicle(vehicle_of("px4", 5), take_over)
    result, _ = flown(plan, vehicle)
    assert result.ending is Ending.HANDED_OVER
    assert not still_triggers(vehicle)


def test_a_vehicle_without_a_camera_is_flown_to_the_end_and_the_verdict_says_what_is_missing(plan: FlightPlan) -> None:
    vehicle = LockstepVehicle(vehicle_of("px4", 5))
    vehicle.vehicle.camera = None
    warnings: list[str] = []
    result, _ = flown(plan, vehicle, warnings=warnings)
    assert result.achieved
    assert f"0 photographs of {plan.planned_pictures} planned" in result.reason
    assert "the camera's command to photograph every 3 m was not answered" in result.reason
    assert len(warnings) == 1


@pytest.mark.parametrize(("flavour", "error"), [("px4", ZeroDivisionError), ("ardupilot", KeyboardInterrupt)])
def test_whatever_fails_here_or_who_is_impatient_leaves_the_trigger_off(
    plan: FlightPlan, flavour: str, error: type[BaseException]
) -> None:
    vehicle = LockstepVehicle(vehicle_of(flavour, 5))

    def fail() -> StopRequest | None:
        camera = vehicle.vehicle.camera
        if camera is not None and camera.taken >= 3:
            raise error
        return None

    with pytest.raises(FlightError if error is ZeroDivisionError else error):
        flown(plan, vehicle, fail)
    assert not still_triggers(vehicle)
