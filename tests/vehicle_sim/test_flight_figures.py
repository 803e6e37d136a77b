"""Some of the figures of `tests/bench/test_bench_figures.py`, and what is said in a flight."""

from collections.abc import Callable

import pytest

from tests.support.flight_figures import APART, RECORDED, Figures, Flight, is_near, returning, stopping, taking_off
from vehicle_sim.autopilot import Mode
from vehicle_sim.dynamics.airframe import Dynamics
from vehicle_sim.parameters import Flavour

ARDUPILOT_STARTS = [
    "RCInput: decoding UDP (Pulses)",
    "Calibrating barometer",
    "Barometer 1 calibration complete",
    "ArduPilot Ready",
    "AHRS: DCM active",
    "EKF3 IMU0 initialised",
    "AHRS: EKF3 active",
    "EKF3 IMU0 tilt alignment complete",
    "EKF3 IMU0 MAG0 initial yaw alignment complete",
    "GPS 1: probing for u-blox at 230400 baud",
    "GPS 1: detected u-blox",
    "EKF3 IMU0 origin set",
    "Field Elevation Set: 488m",
    "EKF3 IMU0 is using GPS",
]
IN_FLIGHT = {
    Flavour.ARDUPILOT: [
        "Arming motors",
        "EKF3 IMU0 MAG0 in-flight yaw alignment complete",
        "SIM Hit ground at 0.50 m/s",
        "Disarming motors",
    ],
    Flavour.PX4: [
        "Armed by external command\t",
        "Takeoff detected\t",
        "RTL: start return at 492 m (4 m above destination)\t",
        "RTL: land at destination\t",
        "Landing detected\t",
        "Disarmed by landing\t",
    ],
}


@pytest.mark.parametrize("flight", [taking_off, stopping, returning])
@pytest.mark.parametrize("flavour", Flavour)
def test_it_flies_like_the_real_one(flavour: Flavour, flight: Callable[[Flavour, Dynamics], Figures]) -> None:
    figures, recorded = flight(flavour, Dynamics.HOVER), RECORDED[flavour]
    compared = {row: (ours, recorded[row]) for row, ours in figures.items() if row in recorded.keys() - APART[flavour]}
    assert len(compared) >= 4
    assert {row: pair for row, pair in compared.items() if not is_near(*pair)} == {}


@pytest.mark.parametrize("flavour", Flavour)
def test_what_is_said_in_a_flight(flavour: Flavour) -> None:
    flight = Flight(flavour)
    said, vehicle = flight.station, flight.station.endpoint.vehicle
    if flavour is Flavour.ARDUPILOT:
        assert [text for text in said.texts() if not text.startswith("PreArm")] == ARDUPILOT_STARTS
    said.forget()
    flight.take_off(4.0, 12.0)
    flight.station.set_mode(Mode.RETURN)
    said.wait_until(lambda: not vehicle.autopilot.armed, within_s=120.0)
    said.run(0.1)
    chunks = "".join(f"{text}\n" if len(text) < 50 else text for text in said.texts())
    assert chunks.splitlines() == IN_FLIGHT[flavour]


def test_who_is_disarmed_in_the_air_falls_and_hits_the_ground() -> None:
    flight = Flight(Flavour.ARDUPILOT)
    flight.take_off(4.0, 12.0)
    flight.station.forget()
    flight.station.command(400, 0, 21196)
    flight.station.run(2.0)
    (hit,) = [text for text in flight.station.texts() if text.startswith("SIM Hit ground")]
    assert 7.0 < float(hit.split()[-2]) < 9.0
