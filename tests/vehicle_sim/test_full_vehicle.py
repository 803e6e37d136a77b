"""The whole vehicle with the full quadrotor under it: flight, rotors, power, and what telemetry says of them."""

from dataclasses import replace

import numpy as np
import pytest
from pymavlink.dialects.v20 import ardupilotmega as mavlink

from tests.support.bare_vehicle import hovering, run, wait_until
from vehicle_sim.dynamics.airframe import Dynamics
from vehicle_sim.errors import ConfigurationError
from vehicle_sim.parameters import Flavour
from vehicle_sim.protocol.dialect import Message
from vehicle_sim.protocol.endpoint import Endpoint
from vehicle_sim.signals import Setpoint
from vehicle_sim.vehicle import Vehicle, VehicleConfig

BOTH = pytest.mark.parametrize("flavour", list(Flavour))


def flying(flavour: Flavour = Flavour.ARDUPILOT, *, wind_m_s: float = 0.0) -> Vehicle:
    return hovering(flavour, dynamics=Dynamics.QUADROTOR, wind_m_s=wind_m_s)


def told(vehicle: Vehicle, message_id: int) -> Message:
    return Endpoint(vehicle, vehicle.autopilot.flavour).telemetry(message_id)


def pulses(vehicle: Vehicle) -> list[int]:
    message = told(vehicle, mavlink.MAVLINK_MSG_ID_SERVO_OUTPUT_RAW)
    return [message.servo1_raw, message.servo2_raw, message.servo3_raw, message.servo4_raw]


@BOTH
def test_take_off_hover_in_wind_and_land(flavour: Flavour) -> None:
    vehicle = flying(flavour, wind_m_s=8.0)
    places = []
    for _ in range(200):
        run(vehicle, 0.1)
        places.append(vehicle.truth.position_ned_m)
        assert np.hypot(vehicle.truth.roll_rad, vehicle.truth.pitch_rad) < 0.4
    assert np.ptp(np.array(places), axis=0).max() < 2.0
    vehicle.autopilot.land()
    wait_until(vehicle, lambda v: not v.autopilot.armed, within_s=40.0)
    assert vehicle.truth.on_ground
    assert np.hypot(vehicle.truth.roll_rad, vehicle.truth.pitch_rad) < 1e-4
    run(vehicle, 1.0)
    assert vehicle.airframe.outputs == pytest.approx((0.0,) * 4, abs=1e-9)
    assert pulses(vehicle) == [1000] * 4


def test_both_dynamics_stay_together_in_small_manoeuvres() -> None:
    """The same seed, sensors and setpoints, the whole vehicle between: within 10 cm and 2.5 degrees."""
    vehicles = [hovering(dynamics=dynamics) for dynamics in Dynamics]
    latest_s = max(vehicle.time_s for vehicle in vehicles)
    for vehicle in vehicles:
        run(vehicle, latest_s + 3.0 - vehicle.time_s)
    starts = [vehicle.estimate.position_ned_m for vehicle in vehicles]
    for ahead, right, yaw in ((1.0, 0.0, 0.0), (1.0, 1.0, 0.2), (0.0, 0.0, 0.0)):
        for _ in range(40):
            for vehicle, (north, east, down) in zip(vehicles, starts, strict=True):
                run(vehicle, 0.1, Setpoint(position_ned_m=(north + ahead, east + right, down), yaw_rad=yaw))
            hover, full = (vehicle.truth for vehicle in vehicles)
            assert np.allclose(hover.position_ned_m, full.position_ned_m, atol=0.1)
            assert np.allclose((hover.roll_rad, hover.pitch_rad), (full.roll_rad, full.pitch_rad), atol=0.045)
            assert hover.yaw_rad == pytest.approx(full.yaw_rad, abs=0.045)


def test_outputs_are_those_of_the_rotors_that_fly() -> None:
    vehicle = flying()
    assert sum(pulses(vehicle)) / 4.0 == pytest.approx(1500, abs=25)
    n, e, d = vehicle.estimate.position_ned_m
    seen = []
    for _ in range(40):
        run(vehicle, 0.02, Setpoint(position_ned_m=(n + 10.0, e, d)))
        seen.append(pulses(vehicle))
    # Nose down to go north: the rear rotor first, then the front one to stop the turn.
    ahead = np.array([rear - front for front, _right, rear, _left in seen])
    assert ahead.max() > 30
    assert ahead.min() < -30


def test_a_weak_rotor_is_heard_harder_and_gives_its_share() -> None:
    vehicle = flying()
    sound = vehicle.airframe.outputs
    vehicle.airframe.weaken((0.8, 1.0, 1.0, 1.0))
    run(vehicle, 15.0)
    assert vehicle.airframe.outputs == pytest.approx(sound, abs=0.06)
    assert np.hypot(*vehicle.truth.velocity_ned_m_s[:2]) < 0.3
    assert not vehicle.truth.on_ground


@pytest.mark.parametrize("dynamics", list(Dynamics))
def test_current_and_vibration_follow_the_rotors(dynamics: Dynamics) -> None:
    vehicle = hovering(dynamics=dynamics)
    run(vehicle, 2.0)
    battery = vehicle.battery
    assert battery.current_a * battery.voltage_v == pytest.approx(146.0, rel=0.1)
    shaken = told(vehicle, mavlink.MAVLINK_MSG_ID_VIBRATION)
    assert 0.3 < shaken.vibration_x < 1.5
    assert shaken.vibration_z < shaken.vibration_x
    still = told(Vehicle(VehicleConfig(dynamics=dynamics)), mavlink.MAVLINK_MSG_ID_VIBRATION)
    assert still.vibration_x == pytest.approx(0.05)


def test_the_same_seed_gives_the_same_flight() -> None:
    first, second = (flying(wind_m_s=5.0) for _ in range(2))
    for vehicle in (first, second):
        run(vehicle, 5.0)
    assert first.truth == second.truth
    assert first.airframe.outputs == second.airframe.outputs


def test_dynamics_that_do_not_exist_are_refused() -> None:
    with pytest.raises(ConfigurationError, match="dynamics"):
        replace(VehicleConfig(), dynamics="rocket")  # type: ignore[arg-type]
