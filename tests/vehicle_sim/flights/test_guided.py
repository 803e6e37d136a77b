"""Flight by setpoints of the bare vehicle, as timelines."""

import pytest

from tests.support.bare_vehicle import booted, hovering, mode_of, offboard, place, run, said, wait_until
from vehicle_sim.autopilot import ArmingReason, Failsafe, Mode, Outcome, SpeedAxis
from vehicle_sim.parameters import Flavour
from vehicle_sim.signals import Setpoint

AP, PX4 = Flavour.ARDUPILOT, Flavour.PX4


def test_px4_offboard_needs_a_stream_before_and_says_accepted_without() -> None:
    vehicle = hovering(PX4)
    autopilot = vehicle.autopilot
    said(vehicle)
    assert autopilot.set_mode(Mode.GUIDED) is Outcome.ACCEPTED
    assert mode_of(vehicle) is Mode.HOLD
    assert said(vehicle) == ["Switching to Offboard is currently not available"]
    offboard(vehicle)


def test_px4_on_the_ground_changes_to_offboard_and_then_refuses_to_arm() -> None:
    vehicle = booted(PX4)
    assert vehicle.autopilot.set_mode(Mode.GUIDED) is Outcome.ACCEPTED
    assert vehicle.autopilot.mode is Mode.GUIDED
    assert vehicle.autopilot.arm() is Outcome.TEMPORARILY_REJECTED
    assert [fault.reason for fault in vehicle.autopilot.arming_faults] == [ArmingReason.NO_SETPOINTS]


@pytest.mark.parametrize(
    ("action", "mode"),
    [(0, Mode.POSITION), (1, Mode.ALT_HOLD), (2, Mode.MANUAL), (3, Mode.RETURN), (4, Mode.LAND), (5, Mode.HOLD)],
)
def test_px4_acts_when_setpoints_stop(action: int, mode: Mode) -> None:
    vehicle = hovering(PX4)
    vehicle.parameters.set("COM_OBL_RC_ACT", action)
    offboard(vehicle)
    last_s = vehicle.time_s
    lost_s = wait_until(vehicle, lambda v: v.autopilot.in_failsafe, within_s=3.0)
    assert lost_s - last_s == pytest.approx(1.05, abs=0.1)
    # There is no hold before this one.
    assert vehicle.autopilot.mode is mode
    assert vehicle.autopilot.failsafe is Failsafe.SETPOINTS_LOST


def test_px4_goes_back_to_offboard_with_the_stream_unless_the_pilot_has_chosen() -> None:
    for pilot_chooses in (False, True):
        vehicle = hovering(PX4)
        setpoint = offboard(vehicle)
        run(vehicle, 2.0)
        assert mode_of(vehicle) is Mode.POSITION
        if pilot_chooses:
            vehicle.autopilot.hold()
        run(vehicle, 1.0, setpoint)
        assert vehicle.autopilot.mode is (Mode.HOLD if pilot_chooses else Mode.GUIDED)
        assert vehicle.autopilot.failsafe is Failsafe.NONE


def test_ardupilot_stops_but_stays_guided_when_velocities_stop() -> None:
    vehicle = hovering()
    run(vehicle, 4.0, Setpoint(velocity_ned_m_s=(2.0, 0.0, 0.0)))
    last_s = vehicle.time_s
    run(vehicle, 2.5)
    assert vehicle.estimate.velocity_ned_m_s[0] == pytest.approx(2.0, abs=0.3)
    stopped_s = wait_until(vehicle, lambda v: abs(v.truth.velocity_ned_m_s[0]) < 0.2, within_s=5.0)
    assert stopped_s - last_s == pytest.approx(4.3, abs=0.7)
    assert vehicle.autopilot.mode is Mode.GUIDED
    assert not vehicle.autopilot.in_failsafe


def test_ardupilot_goes_on_to_a_position_that_was_sent_once() -> None:
    vehicle = hovering()
    target = place(vehicle, north=25.0)
    vehicle.autopilot.setpoint(Setpoint(position_ned_m=target))
    run(vehicle, 15.0)
    assert vehicle.estimate.position_ned_m[0] == pytest.approx(target[0], abs=0.3)


def test_ten_metres_take_ardupilot_about_four_seconds() -> None:
    vehicle = hovering()
    target = place(vehicle, north=10.0)
    assert target[0] is not None
    started_s, goal = vehicle.time_s, target[0]
    vehicle.autopilot.setpoint(Setpoint(position_ned_m=target))
    reached_s = wait_until(vehicle, lambda v: v.estimate.position_ned_m[0] > goal - 1.0, within_s=10.0)
    assert reached_s - started_s == pytest.approx(4.0, abs=1.0)
    run(vehicle, 6.0)
    assert vehicle.estimate.position_ned_m[0] == pytest.approx(goal, abs=0.3)


def test_setpoints_outside_guided_are_ignored() -> None:
    vehicle = hovering()
    vehicle.autopilot.set_mode(Mode.POSITION)
    before = vehicle.autopilot.target
    assert not vehicle.autopilot.setpoint(Setpoint(position_ned_m=place(vehicle, north=50.0)))
    assert vehicle.autopilot.target == before


def test_speed_and_yaw_on_request() -> None:
    vehicle = hovering()
    autopilot = vehicle.autopilot
    assert autopilot.change_speed(1.5) is Outcome.ACCEPTED
    assert autopilot.change_speed(0.0) is Outcome.FAILED
    assert autopilot.change_speed(0.5, SpeedAxis.UP) is Outcome.ACCEPTED
    autopilot.reposition(place(vehicle, north=12.0, up=3.0))
    run(vehicle, 4.0)
    speed = vehicle.truth.velocity_ned_m_s
    assert speed[0] == pytest.approx(1.5, abs=0.15)
    assert -speed[2] == pytest.approx(0.5, abs=0.1)
    assert autopilot.turn(1.2) is Outcome.ACCEPTED
    run(vehicle, 5.0)
    assert vehicle.truth.yaw_rad == pytest.approx(1.2, abs=0.1)
    assert autopilot.turn(-0.7, relative=True) is Outcome.ACCEPTED
    run(vehicle, 5.0)
    assert vehicle.truth.yaw_rad == pytest.approx(0.5, abs=0.1)
    assert hovering(PX4).autopilot.turn(1.0) is Outcome.UNSUPPORTED


def test_pause_stops_and_resume_goes_on() -> None:
    vehicle = hovering()
    target = place(vehicle, north=80.0)
    assert target[0] is not None
    vehicle.autopilot.setpoint(Setpoint(position_ned_m=target))
    run(vehicle, 4.0)
    assert vehicle.autopilot.pause() is Outcome.ACCEPTED
    run(vehicle, 6.0)
    stopped = vehicle.estimate.position_ned_m[0]
    assert stopped < target[0] - 10.0
    assert vehicle.autopilot.resume() is Outcome.ACCEPTED
    run(vehicle, 20.0)
    assert vehicle.estimate.position_ned_m[0] == pytest.approx(target[0], abs=0.3)
