"""A fence is really kept: flights against it in the modes that fly by themselves, by the vehicle's true place."""

from collections.abc import Callable

import pytest

from tests.support.bare_vehicle import hovering
from tests.support.fences import Timeline, at_home, circle, fenced, ring, stopping_distance_m
from tests.support.usual_cases import sampled
from vehicle_sim.autopilot import Command, Datum, MissionItem, Mode, Outcome, Place
from vehicle_sim.autopilot.geofence import Area
from vehicle_sim.parameters import Flavour
from vehicle_sim.signals import Setpoint
from vehicle_sim.vehicle import Vehicle

AP, PX4 = Flavour.ARDUPILOT, Flavour.PX4
BORDER_M, SPEED_M_S = 40.0, 5.0
OUT = Setpoint(velocity_ned_m_s=(SPEED_M_S, 0.0, 0.0))
NOISE_M = 2.5
"""How far the estimated place may be from the true one, and what a breach is told by."""

Border = Callable[[Vehicle], Area]
BORDERS: dict[str, Border] = {
    "inside a polygon": lambda vehicle: ring(vehicle, BORDER_M),
    "inside a polygon of 24 corners": lambda vehicle: ring(vehicle, BORDER_M, corners=24),
    "inside a circle": lambda vehicle: circle(vehicle, BORDER_M),
    "outside a polygon": lambda vehicle: ring(vehicle, 20.0, north=BORDER_M + 20.0, contains=False),
    "outside a circle": lambda vehicle: circle(vehicle, 20.0, north=BORDER_M + 20.0, contains=False),
}


def watched(flavour: Flavour, border: Border, **parameters: float) -> Vehicle:
    enabled = {"FENCE_ENABLE": 1.0} if flavour is AP else {}
    vehicle = hovering(flavour)
    return fenced(vehicle, border(vehicle), **(enabled | parameters))


@sampled("name", BORDERS, ["inside a polygon", "outside a circle"])
@pytest.mark.parametrize(
    ("flavour", "parameters", "mode"),
    [
        (AP, {"FENCE_ACTION": 4, "AVOID_ENABLE": 0}, Mode.BRAKE),
        (PX4, {"GF_ACTION": 2}, Mode.HOLD),
    ],
)
def test_velocities_outward_end_within_the_stopping_distance(
    name: str, flavour: Flavour, parameters: dict[str, float], mode: Mode
) -> None:
    vehicle = watched(flavour, BORDERS[name], **parameters)
    if flavour is PX4:
        vehicle.autopilot.setpoint(OUT)
        assert vehicle.autopilot.set_mode(Mode.GUIDED) is Outcome.ACCEPTED
    flight = Timeline(vehicle).fly(25.0, OUT)
    assert flight.fastest_m_s > SPEED_M_S - 1.0
    assert flight.sequence[-1] is mode
    assert BORDER_M - NOISE_M < flight.north_m < BORDER_M + stopping_distance_m(vehicle, SPEED_M_S) + NOISE_M


@sampled("name", BORDERS, ["inside a polygon of 24 corners", "inside a circle"])
def test_ardupilot_slows_velocities_down_and_stays_inside(name: str) -> None:
    vehicle = watched(AP, BORDERS[name])
    flight = Timeline(vehicle).fly(25.0, OUT)
    assert flight.sequence == [Mode.GUIDED]
    assert BORDER_M - 10.0 < flight.north_m < BORDER_M


@sampled("name", BORDERS, ["outside a polygon", "inside a circle"])
def test_px4_that_predicts_stops_at_the_border(name: str) -> None:
    vehicle = watched(PX4, BORDERS[name], GF_PREDICT=1)
    vehicle.autopilot.setpoint(OUT)
    assert vehicle.autopilot.set_mode(Mode.GUIDED) is Outcome.ACCEPTED
    flight = Timeline(vehicle).fly(20.0, OUT)
    assert flight.sequence[-1] is Mode.HOLD
    assert flight.north_m < BORDER_M + NOISE_M


@pytest.mark.parametrize(("flavour", "action"), [(AP, "FENCE_ACTION"), (PX4, "GF_ACTION")])
def test_a_mission_that_leads_out_is_broken_off(flavour: Flavour, action: str) -> None:
    answer = {AP: {action: 1.0}, PX4: {action: 3.0, "COM_FAIL_ACT_T": 0.0}}[flavour]
    vehicle = watched(flavour, BORDERS["inside a circle"], **answer)
    out = at_home(vehicle, 90.0, 0.0)
    far = MissionItem(command=Command.WAYPOINT, place=Place(out.lat_deg, out.lon_deg, 10.0, Datum.HOME))
    # ArduPilot's first item stands for home, and is not flown.
    vehicle.autopilot.load_mission((far, far) if flavour is AP else (far,))
    assert vehicle.autopilot.set_mode(Mode.AUTO) is Outcome.ACCEPTED
    flight = Timeline(vehicle).fly(40.0)
    assert Mode.RETURN in flight.sequence
    cruise_m_s = vehicle.autopilot.settings.cruise_m_s
    assert flight.north_m < BORDER_M + stopping_distance_m(vehicle, cruise_m_s) + NOISE_M
    assert vehicle.truth.position_ned_m[0] < BORDER_M


@pytest.mark.parametrize(("flavour", "ceiling"), [(AP, "FENCE_ALT_MAX"), (PX4, "GF_MAX_VER_DIST")])
def test_the_ceiling_is_kept(flavour: Flavour, ceiling: str) -> None:
    vehicle = hovering(flavour)
    kind = {"FENCE_ENABLE": 1.0, "FENCE_TYPE": 1.0, "FENCE_ACTION": 4.0} if flavour is AP else {}
    fenced(vehicle, **kind, **{ceiling: 20.0})
    up = Setpoint(velocity_ned_m_s=(0.0, 0.0, -2.0))
    if flavour is PX4:
        vehicle.autopilot.setpoint(up)
        assert vehicle.autopilot.set_mode(Mode.GUIDED) is Outcome.ACCEPTED
    flight = Timeline(vehicle).fly(15.0, up)
    assert 15.0 < flight.up_m < 20.0 + 3.0 + NOISE_M
