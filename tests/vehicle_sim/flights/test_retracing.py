"""ArduPilot's SMART_RTL: the path that is kept, and the way back along it."""

from dataclasses import replace
from math import cos, hypot, sin

import pytest

from tests.support.bare_vehicle import booted, hovering, place, run, said, wait_until
from vehicle_sim.autopilot import Mode, Outcome
from vehicle_sim.autopilot.retracing import FlownPath
from vehicle_sim.signals import Estimate, EstimatorFlag, Vector
from vehicle_sim.vehicle import Vehicle


def walked(places: list[Vector], *, accuracy_m: float = 2.0, most: int = 300) -> tuple[FlownPath, list[str]]:
    """Return the path of a vehicle that has been at all of the places, and what was said."""
    vehicle = booted()
    settings = replace(vehicle.autopilot.settings, path_accuracy_m=accuracy_m, path_places=most)
    path, at = FlownPath(), vehicle.estimate
    texts = [path.advance(at._replace(position_ned_m=one), settings, keeps=True) for one in places]
    return path, [text for text in texts if text]


def test_places_are_kept_an_accuracy_apart_and_straight_lines_by_their_ends() -> None:
    path, _ = walked([(0.1 * step, 0.0, -5.0) for step in range(200)])
    assert len(path.places) == 10
    path.clean(2.0)
    assert path.places == [(0.0, 0.0, -5.0), pytest.approx((18.0, 0.0, -5.0), abs=0.21)]


def test_a_corner_stays_and_a_loop_is_dropped() -> None:
    there = [(float(step), 0.0, -5.0) for step in range(31)]
    loop = [(30.0 + 10.0 * sin(0.1 * turn), 10.0 - 10.0 * cos(0.1 * turn), -5.0) for turn in range(63)]
    on = [(30.0, -float(step), -5.0) for step in range(1, 21)]
    path, _ = walked(there + loop + on)
    path.clean(2.0)
    assert all(hypot(north - 30.0, east) < 3.0 for north, east, _ in path.places[1:-1])
    assert path.places[-1] == pytest.approx((30.0, -20.0, -5.0), abs=2.0)


def test_a_path_that_is_too_long_is_given_up() -> None:
    zigzag = [(float(step), 10.0 * (step // 3 % 2), -5.0) for step in range(0, 90, 3)]
    path, texts = walked(zigzag, most=20)
    assert texts == ["SmartRTL deactivated: buffer full"]
    assert not path.places


def without_position(estimate: Estimate, time_s: float) -> Estimate:
    lost = estimate.status._replace(flags=estimate.status.flags & ~EstimatorFlag.POSITION_HORIZONTAL_ABSOLUTE)
    return estimate._replace(status=lost, time_s=time_s)


def test_a_position_that_is_bad_for_long_ends_the_path() -> None:
    vehicle, path = booted(), FlownPath()
    settings, at = vehicle.autopilot.settings, vehicle.estimate
    assert not path.advance(at, settings, keeps=True)
    assert not path.advance(without_position(at, at.time_s + 14.0), settings, keeps=True)
    bad = path.advance(without_position(at, at.time_s + 16.0), settings, keeps=True)
    assert bad == "SmartRTL deactivated: bad position"


def flown_round_a_corner() -> Vehicle:
    vehicle = hovering(height_m=4.0)
    for north, east in ((18.0, 0.0), (0.0, 18.0)):
        assert vehicle.autopilot.reposition(place(vehicle, north, east)) is Outcome.ACCEPTED
        run(vehicle, 9.0)
    return vehicle


def test_it_flies_back_round_the_corner_and_lands_where_it_was_armed() -> None:
    vehicle = flown_round_a_corner()
    corner_m, straight_m, height_m = 99.0, 99.0, 0.0
    assert vehicle.autopilot.set_mode(Mode.SMART_RTL) is Outcome.ACCEPTED
    while vehicle.autopilot.armed and vehicle.time_s < 120.0:
        run(vehicle, 0.2)
        north, east, down = vehicle.truth.position_ned_m
        corner_m = min(corner_m, hypot(north - 18.0, east))
        straight_m = min(straight_m, hypot(north - 9.0, east - 9.0))
        height_m = max(height_m, -down)
    assert not vehicle.autopilot.armed
    assert corner_m < 3.0
    assert straight_m > 6.0
    assert height_m < 5.5  # and not up to RTL_ALT
    assert hypot(*vehicle.truth.position_ned_m[:2]) < 1.0


@pytest.mark.parametrize(
    ("action", "points", "mode", "text"),
    [
        (4, 300, Mode.SMART_RTL, ""),
        (4, 0, Mode.RETURN, "SmartRTL Unavailable, Trying RTL Mode"),
        (5, 0, Mode.LAND, "SmartRTL Unavailable, Using Land Mode"),
    ],
)
def test_a_lost_radio_leads_back_along_the_path_where_there_is_one(
    action: int, points: int, mode: Mode, text: str
) -> None:
    vehicle = booted()
    vehicle.parameters.set("FS_THR_ENABLE", action)
    vehicle.parameters.set("SRTL_POINTS", points)
    if not points:
        vehicle.autopilot.path.places = []
    autopilot = vehicle.autopilot
    autopilot.set_mode(Mode.GUIDED)
    assert autopilot.arm() is Outcome.ACCEPTED
    assert autopilot.takeoff(3.0) is Outcome.ACCEPTED
    wait_until(vehicle, lambda v: v.autopilot.flying, within_s=10.0)
    if not points:
        assert autopilot.set_mode(Mode.SMART_RTL) is Outcome.FAILED
        assert "Mode change to SMARTRTL failed: init failed" in said(vehicle)
    vehicle.parameters.set("SIM_RC_FAIL", 1)
    run(vehicle, 3.0)
    assert autopilot.mode is mode
    assert not text or text in said(vehicle)
