"""The reference that is flown along a leg: within its limits, on its line, and to the end."""

from math import dist, hypot, inf, pi, sqrt

import pytest
from hypothesis import given
from hypothesis import strategies as st

from tests.support.bare_vehicle import booted
from tests.support.drawn_cases import tried
from vehicle_sim.autopilot import SpeedAxis
from vehicle_sim.autopilot.legs import CircleTask, CruiseTask, Reference, arrival_speed, corner_speed
from vehicle_sim.parameters import Flavour, default_parameters, flight_settings
from vehicle_sim.signals import Vector

SETTINGS = {flavour: flight_settings(default_parameters(flavour)) for flavour in Flavour}
ESTIMATE = booted().estimate
TICK_S = 0.05
ORIGIN: Vector = (0.0, 0.0, -10.0)


@given(left=st.floats(0.0, 500.0), end=st.floats(0.0, 8.0), braking=st.floats(0.5, 5.0))
def test_braking_from_the_arrival_speed_is_never_harder_than_allowed(left: float, end: float, braking: float) -> None:
    """The deceleration of v(s) is v dv/ds."""
    step = 1e-4
    here, nearer = arrival_speed(left + step, end, braking), arrival_speed(left, end, braking)
    assert here >= nearer >= end
    assert here * (here - nearer) / step <= braking * 1.01 + 1e-6


def test_speed_round_corners() -> None:
    straight = corner_speed((0, 0, 0), (50, 0, 0), (100, 0, 0), 2.0, 1.0)
    assert straight == inf
    right = corner_speed((0, 0, 0), (50, 0, 0), (50, 50, 0), 2.0, 1.0)
    # An arc tangent to both legs two metres from the corner has a radius of two metres.
    assert right == pytest.approx(sqrt(1.0 * 2.0))
    assert corner_speed((0, 0, 0), (50, 0, 0), (0, 0, 0), 2.0, 1.0) == pytest.approx(0.0, abs=1e-6)
    assert corner_speed((0, 0, 0), (0, 0, 0), (50, 0, 0), 2.0, 1.0) == 0.0
    short = corner_speed((0, 0, 0), (1, 0, 0), (1, 1, 0), 2.0, 1.0)
    assert short == pytest.approx(sqrt(0.5))


PLACE = st.tuples(st.floats(-60.0, 60.0), st.floats(-60.0, 60.0), st.floats(-40.0, -2.0))
VELOCITY = st.tuples(st.floats(-5.0, 5.0), st.floats(-5.0, 5.0), st.floats(-1.0, 1.0))


@tried(100)
@given(end=PLACE, moving=VELOCITY, flavour=st.sampled_from(Flavour), speed=st.none() | st.floats(1.0, 9.0))
def test_a_leg_is_flown_within_the_limits_and_ends(
    end: Vector, moving: Vector, flavour: Flavour, speed: float | None
) -> None:
    """With a vehicle that is always where the reference is."""
    flight = SETTINGS[flavour]
    speeds = {} if speed is None else {SpeedAxis.HORIZONTAL: speed}
    task = CruiseTask(
        Reference(ORIGIN, moving), flight, start=ORIGIN, end=end, speeds=speeds, accept_m=1.0, accept_height_m=1.0
    )
    fastest = max(speeds.get(SpeedAxis.HORIZONTAL, flight.cruise_m_s), hypot(moving[0], moving[1]))
    now_s, before = 0.0, moving
    while not (task.finished and dist(task.reference.place, end) < 0.2):
        now_s += TICK_S
        assert now_s < 240.0
        task.advance(now_s, ESTIMATE._replace(position_ned_m=task.reference.place))
        north, east, down = task.reference.velocity
        assert hypot(north, east) <= fastest + 0.3
        assert -flight.climb_m_s - 0.3 <= down <= flight.descent_m_s + 0.3
        if task.reference.place != end:
            assert hypot(north - before[0], east - before[1]) <= flight.acceleration_m_s2 * TICK_S * 1.01
        before = task.reference.velocity


def test_a_reference_waits_for_its_vehicle() -> None:
    flight = SETTINGS[Flavour.ARDUPILOT]
    task = CruiseTask(
        Reference(ORIGIN, (0.0, 0.0, 0.0)),
        flight,
        start=ORIGIN,
        end=(100.0, 0.0, -10.0),
        speeds={},
        accept_m=1.0,
        accept_height_m=1.0,
    )
    for tick in range(1, 600):
        task.advance(tick * TICK_S, ESTIMATE._replace(position_ned_m=ORIGIN))
    assert 3.0 < task.reference.place[0] < 7.0
    assert task.setpoint.velocity_ned_m_s == pytest.approx((0.0, 0.0, 0.0), abs=0.05)


def test_pausing_stops_the_reference_and_lets_it_go_on() -> None:
    task = CruiseTask(
        Reference(ORIGIN, (0.0, 0.0, 0.0)),
        SETTINGS[Flavour.ARDUPILOT],
        start=ORIGIN,
        end=(100.0, 0.0, -10.0),
        speeds={},
        accept_m=1.0,
        accept_height_m=1.0,
    )
    seen = []
    for tick in range(1, 1200):
        task.paused = 100 <= tick < 400
        task.advance(tick * TICK_S, ESTIMATE._replace(position_ned_m=task.reference.place))
        seen.append(task.reference.place[0])
    assert seen[398] == pytest.approx(seen[300], abs=1e-6)
    assert seen[-1] == 100.0
    assert task.finished


@pytest.mark.parametrize("clockwise", [True, False])
def test_a_circle_is_round_and_turns_so_often(*, clockwise: bool) -> None:
    centre: Vector = (10.0, 5.0, -10.0)
    task = CircleTask(
        Reference((16.0, 5.0, -10.0), (0.0, 0.0, 0.0)),
        SETTINGS[Flavour.ARDUPILOT],
        centre=centre,
        radius_m=6.0,
        turns=1.5,
        clockwise=clockwise,
        speeds={},
    )
    ticks = 0
    while not task.finished:
        ticks += 1
        task.advance(ticks * TICK_S, ESTIMATE._replace(position_ned_m=task.reference.place))
        assert dist(task.reference.place, centre) == pytest.approx(6.0)
    # Twenty degrees a second, after a start from rest.
    assert ticks * TICK_S == pytest.approx(1.5 * 2.0 * pi / 0.349, abs=1.0)
    assert task.turned_rad == pytest.approx(3.0 * pi, abs=0.05)
    assert task.reference.place[0] == pytest.approx(4.0, abs=0.2)
