"""The flight loop against a scripted vehicle: verdicts, refusals, failures, and what is left in the record."""

import math

import numpy as np
import pytest

from mission.errors import LinkError, VehicleError
from mission.fly import FlightOptions, FlightResult, StopRequest
from mission.fly.preflight import Checks, NoGoError
from mission.link.ending import Ending
from mission.monitor.stage import Stage
from mission.plan import FlightPlan
from tests.support.scripted_flight import Flight
from tests.support.scripted_vehicle import BRAKE, RTL, Script, ScriptedVehicle
from tests.support.small_missions import SMALL, at_a_place, plan_of
from tests.support.usual_cases import sampled

METRES_PER_DEGREE = 111_194.93  # along a meridian of the scripted vehicle's sphere


@pytest.fixture(scope="module")
def plan() -> FlightPlan:
    return plan_of(SMALL)


@pytest.fixture(scope="module", params=["ardupilot", "px4"])
def usual(request: pytest.FixtureRequest, plan: FlightPlan) -> tuple[Flight, FlightResult]:
    """The small mission, flown once by each flavour without a fault."""
    flight = Flight(ScriptedVehicle(request.param), plan)
    return flight, flight.run()


def test_a_mission_is_achieved_by_what_was_reported(usual: tuple[Flight, FlightResult]) -> None:
    flight, result = usual
    assert result.achieved
    assert result.exit_code == 0
    assert result.ending is Ending.LANDED
    assert result.largest_distance_m < 2.0
    assert any("goal" in letter for letter in result.word)
    assert result.word[-1] == {"home"}
    record = flight.record
    assert record.vehicle["autopilot"] == ("PX4" if flight.vehicle.px4 else "ArduPilot")
    assert record.verdict is not None
    assert record.verdict["achieved"] is True
    assert len(record.track.t_s) > 500
    assert [visit.labels for visit in record.visits] == [*result.word]
    assert record.track.position_m[0][:2] == pytest.approx((9.0, 8.0), abs=0.01)  # anchored at the start


def test_setpoints_of_the_trajectory_are_told_from_those_before_and_after(
    plan: FlightPlan, usual: tuple[Flight, FlightResult]
) -> None:
    flight, _ = usual
    times = flight.record.setpoints.trajectory_s
    on_it = times[~np.isnan(times)]
    assert on_it[0] < 0.1
    assert on_it[-1] == pytest.approx(plan.trajectory.duration_s, abs=0.1)
    assert (on_it[1:] > on_it[:-1]).all()
    assert np.isnan(times)[0]
    assert np.isnan(times)[-1]


def test_progress_goes_from_waiting_to_the_end(plan: FlightPlan, usual: tuple[Flight, FlightResult]) -> None:
    flight, _ = usual
    stages = [p.stage for p in flight.progress]
    assert stages == sorted(stages, key=list(Stage).index)
    assert any("position" in p.waiting_for for p in flight.progress)
    left = [p.left_s for p in flight.progress]
    assert left == sorted(left, reverse=True)
    assert left[0] == pytest.approx(plan.trajectory.duration_s)
    assert left[-1] == 0.0
    assert [p.leg for p in flight.progress] == sorted(p.leg for p in flight.progress)
    assert flight.progress[-1].leg == flight.progress[-1].legs - 1
    assert flight.progress[0].awaited == ("goal",)
    assert flight.progress[-1].done == flight.progress[-1].total


@sampled("start_m", [(9.0, 8.0), (20.0, 15.0)], [(20.0, 15.0)])
def test_a_mission_with_a_place_is_planned_anew_from_where_the_vehicle_stands(start_m: tuple[float, float]) -> None:
    vehicle = ScriptedVehicle("ardupilot")
    # The estimator's origin is at 47 N 8 E and the vehicle stands 3 m north and 2 m west of it.
    placed = plan_of(
        at_a_place(
            47.0 + (3.0 - start_m[1]) / METRES_PER_DEGREE,
            8.0 + (-2.0 - start_m[0]) / (METRES_PER_DEGREE * math.cos(math.radians(47.0))),
        )
    )
    flight = Flight(vehicle, placed)
    result = flight.run()
    assert result.achieved
    assert result.plan.start_m == pytest.approx(start_m, abs=0.1)
    assert flight.record.track.position_m[0][:2] == pytest.approx(start_m, abs=0.1)
    home = result.plan.trajectory.position([result.plan.trajectory.duration_s])[0]
    landed = (vehicle.position[1] + 2.0 + start_m[0], vehicle.position[0] - 3.0 + start_m[1])
    assert landed == pytest.approx(tuple(home), abs=0.3)


@pytest.mark.parametrize(
    ("start_m", "words"),
    [((-5.0, 8.0), "outside the mission's domain"), ((9.0, 25.0), "restricted pond"), ((2e6, 0.0), "km")],
)
def test_a_flight_from_where_none_was_proved_is_refused(start_m: tuple[float, float], words: str) -> None:
    vehicle = ScriptedVehicle("px4")
    placed = plan_of(
        at_a_place(
            47.0 + (3.0 - start_m[1]) / METRES_PER_DEGREE,
            8.0 + (-2.0 - start_m[0]) / (METRES_PER_DEGREE * math.cos(math.radians(47.0))),
        )
    )
    flight = Flight(vehicle, placed)
    with pytest.raises(NoGoError, match=words) as caught:
        flight.run()
    assert caught.value.exit_code == 2
    assert flight.record.verdict is not None
    assert words in flight.record.verdict["reason"]
    flight = Flight(vehicle, placed)
    flight.options = FlightOptions(checks=Checks(forced=("origin",)))
    with pytest.raises(NoGoError, match=words):
        flight.run()
    assert not vehicle.setpoints
    assert not vehicle.armed


def test_positions_that_contradict_each_other_are_not_flown_on() -> None:
    vehicle = ScriptedVehicle("ardupilot")
    placed = plan_of(at_a_place(47.0, 8.0))
    flight = Flight(vehicle, placed)
    honest = vehicle._report

    def report_a_shifted_place() -> None:
        north = vehicle.origin[0]
        vehicle._streams.pop(49, None)
        if vehicle._due(49, 1.0):
            from pymavlink.dialects.v20 import ardupilotmega as mavlink  # noqa: PLC0415 - this lie alone needs it

            vehicle._emit(mavlink.MAVLink_gps_global_origin_message(round((north + 0.001) * 1e7), 80000000, 0))
        honest()

    vehicle._report = report_a_shifted_place  # type: ignore[method-assign]
    with pytest.raises(NoGoError, match="m apart") as caught:
        flight.run()
    assert caught.value.exit_code == 4


def test_a_pilot_who_takes_over_ends_the_mission_unachieved(plan: FlightPlan) -> None:
    vehicle = ScriptedVehicle("ardupilot")
    flight = Flight(vehicle, plan)
    flight.at_stage[Stage.FLY] = lambda: setattr(vehicle, "mode", RTL)
    result = flight.run()
    assert not result.achieved
    assert result.exit_code == 1
    assert "RTL" in result.reason
    assert flight.record.verdict is not None
    assert flight.record.verdict["ending"] == "handed_over"


def test_a_failsafe_is_a_vehicle_failure_with_its_words(plan: FlightPlan) -> None:
    vehicle = ScriptedVehicle("ardupilot")
    flight = Flight(vehicle, plan)

    def fail() -> None:
        vehicle.mode, vehicle.failsafe = RTL, True
        vehicle.say("Battery 1 is critical")

    flight.at_stage[Stage.FLY] = fail
    with pytest.raises(VehicleError, match=r"failsafe.*RTL.*Battery 1 is critical"):
        flight.run()
    assert flight.record.verdict is not None
    assert flight.record.verdict["achieved"] is False


def test_a_vehicle_that_reports_a_restricted_region_is_stopped(plan: FlightPlan) -> None:
    vehicle = ScriptedVehicle("ardupilot")
    flight = Flight(vehicle, plan)
    flight.at_stage[Stage.FLY] = lambda: vehicle.position.__setitem__(0, vehicle.position[0] + 17.0)
    result = flight.run()
    assert not result.achieved
    assert "entered a restricted region" in result.reason
    assert result.ending is Ending.STOPPED
    assert vehicle.mode == BRAKE
    assert not result.interrupted
    assert [event.text for event in flight.record.events].count("violation") >= 1


def test_a_vehicle_that_does_not_follow_is_stopped(plan: FlightPlan) -> None:
    vehicle = ScriptedVehicle("px4")
    flight = Flight(vehicle, plan)

    def stand() -> None:
        vehicle._take = lambda message: None if message.id == 84 else type(vehicle)._take(vehicle, message)  # type: ignore[method-assign]

    flight.at_stage[Stage.FLY] = stand
    result = flight.run()
    assert not result.achieved
    assert "does not follow" in result.reason


@pytest.mark.parametrize("land", [True, False])
def test_ctrl_c_holds_and_lands_only_what_may_be_landed(plan: FlightPlan, land: bool) -> None:  # noqa: FBT001 - a test's parameter
    vehicle = ScriptedVehicle("ardupilot")
    flight = Flight(vehicle, plan)
    flight.options = FlightOptions(land_when_stopped=land)

    def interrupt() -> None:
        raise KeyboardInterrupt

    flight.at_stage[Stage.FLY] = interrupt
    result = flight.run()
    assert result.interrupted
    assert not result.achieved
    assert result.ending is Ending.STOPPED
    assert vehicle.armed is not land
    assert flight.record.verdict is not None
    assert flight.record.verdict["interrupted"] is True


@pytest.mark.parametrize(
    ("stage", "words"),
    [
        (Stage.READY, ""),
        (Stage.ARM, "that its motors stay off was not confirmed"),
        (Stage.CLIMB, "that it holds was not confirmed: it was last heard in GUIDED"),
        (Stage.FLY, "that it holds was not confirmed: it was last heard in GUIDED"),
        (Stage.TOUCH_DOWN, "the vehicle is landing"),
    ],
)
def test_a_second_ctrl_c_is_obeyed_at_once_and_how_the_vehicle_is_left_is_said(
    plan: FlightPlan, stage: Stage, words: str
) -> None:
    flight, wishes = Flight(ScriptedVehicle("ardupilot"), plan), list[StopRequest]()

    def interrupt() -> None:
        wishes.append(StopRequest("enough"))
        raise KeyboardInterrupt

    flight.at_stage[stage] = interrupt
    flight.stop_request = lambda: wishes.pop() if wishes else None
    try:
        reason = flight.run().reason
    except KeyboardInterrupt:
        verdict = flight.record.verdict
        assert verdict is not None
        reason = str(verdict["reason"])
        assert "its end was not waited for" in reason
        assert flight.warnings == [words] * bool(words)
    assert words in reason


def test_a_reason_to_stop_before_take_off_ends_it_on_the_ground(plan: FlightPlan) -> None:
    vehicle = ScriptedVehicle("px4", Script(origin_at_s=30.0))
    flight = Flight(vehicle, plan)
    requests = [StopRequest("ended by SIGTERM")]
    flight.stop_request = lambda: requests.pop() if requests and vehicle.now_s() > 5.0 else None
    result = flight.run()
    assert result.reason == "ended by SIGTERM"
    assert result.began_s is None
    assert not vehicle.armed


def test_a_vehicle_known_to_be_gone_is_a_link_failure_with_a_readable_record(plan: FlightPlan) -> None:
    vehicle = ScriptedVehicle("px4")
    flight = Flight(vehicle, plan)
    gone: list[str] = []
    flight.at_stage[Stage.FLY] = lambda: gone.append("the bundled vehicle has ended (signal 9)")
    flight.vehicle_failure = lambda: gone[0] if gone else ""
    with pytest.raises(LinkError, match="signal 9") as caught:
        flight.run()
    assert caught.value.exit_code == 4
    assert flight.record.verdict is not None
    assert flight.record.verdict["ending"] == "failed"
    assert not flight.record.cut


def test_a_vehicle_that_falls_silent_is_a_link_failure(plan: FlightPlan) -> None:
    vehicle = ScriptedVehicle("ardupilot")
    flight = Flight(vehicle, plan)
    flight.at_stage[Stage.FLY] = lambda: setattr(vehicle, "gone", True)
    with pytest.raises(LinkError, match="nothing was heard"):
        flight.run()


def test_the_same_flight_twice_is_the_same_record(plan: FlightPlan) -> None:
    records = []
    for _ in range(2):
        flight = Flight(ScriptedVehicle("px4", Script(lose=0.05, shuffle=True), seed=3), plan)
        flight.run()
        records.append(flight.sink.getvalue())
    assert records[0] == records[1]
