"""Velocities towards a fence: never faster to any border than the vehicle can stop, and untouched far from all."""

from dataclasses import replace
from math import cos, hypot, pi, sin

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from vehicle_sim.autopilot.avoidance import stopping_speed, within_fence
from vehicle_sim.autopilot.fence import FenceWatch
from vehicle_sim.autopilot.geofence import Circle, FencePlan, Polygon
from vehicle_sim.estimator import Estimator, EstimatorTuning
from vehicle_sim.geodesy import geodetic_at
from vehicle_sim.parameters import FenceType, Flavour, default_parameters, flight_settings
from vehicle_sim.signals import Geodetic, Setpoint

ORIGIN = Geodetic(47.397742, 8.545594, 488.0)
HOME = (0.0, 0.0, 0.0)
STORE = default_parameters(Flavour.ARDUPILOT)
STORE.set("FENCE_ENABLE", 1)
STORE.set("FENCE_RADIUS", 60)
STORE.set("FENCE_ALT_MAX", 50)
SETTINGS = flight_settings(STORE)
AT_REST = Estimator(EstimatorTuning(), step_s=0.01).estimate._replace(origin=ORIGIN)
MARGIN_M = SETTINGS.fence.margin_m


def fence(corners: int, reach_m: float) -> FenceWatch:
    watch = FenceWatch(SETTINGS.fence)
    turns = [2.0 * pi * i / corners for i in range(corners)]
    around = tuple(geodetic_at(ORIGIN, (reach_m * cos(t), reach_m * sin(t), 0.0)) for t in turns)
    hole = Circle(contains=False, centre=geodetic_at(ORIGIN, (8.0, 0.0, 0.0)), radius_m=3.0)
    watch.load(FencePlan((Polygon(contains=True, vertices=around), hole)))
    return watch


@given(
    corners=st.integers(3, 40),
    place=st.tuples(st.floats(-25.0, 25.0), st.floats(-25.0, 25.0), st.floats(-49.0, 0.0)),
    velocity=st.tuples(*[st.floats(-12.0, 12.0)] * 3),
)
def test_no_border_is_met_faster_than_it_can_stop(
    corners: int, place: tuple[float, float, float], velocity: tuple[float, float, float]
) -> None:
    watch = fence(corners, 40.0)
    if watch.forbids(place, HOME, ORIGIN):
        return
    estimate = AT_REST._replace(position_ned_m=place)
    north, east, down = within_fence(
        Setpoint(velocity_ned_m_s=velocity), estimate, SETTINGS, watch, HOME
    ).velocity_ned_m_s
    assert north is not None
    assert east is not None
    assert down is not None
    braking = 0.75 * SETTINGS.acceleration_m_s2
    for offset in watch.local(ORIGIN).nearest_m(*place[:2]):
        distance = float(np.hypot(*offset))
        towards = (north * offset[0] + east * offset[1]) / max(distance, 1e-9)
        assert towards <= stopping_speed(distance - MARGIN_M, braking, SETTINGS.reaction_s) + 1e-5
    outwards = hypot(*place[:2])
    if outwards > 1e-6:
        leaving = (north * place[0] + east * place[1]) / outwards
        assert leaving <= stopping_speed(60.0 - outwards - MARGIN_M, braking, SETTINGS.reaction_s) + 1e-5
    assert hypot(north, east) <= hypot(*velocity[:2]) + 1e-6
    assert -down <= max(-velocity[2], 0.0)
    assert down >= velocity[2]


def test_far_from_all_borders_and_in_other_cases_nothing_changes() -> None:
    watch = fence(6, 40.0)
    slow = Setpoint(velocity_ned_m_s=(-0.5, 0.5, -0.5))
    fast = Setpoint(velocity_ned_m_s=(12.0, 0.0, 0.0))
    here = AT_REST._replace(position_ned_m=(-12.0, 0.0, -5.0))
    assert within_fence(slow, here, SETTINGS, watch, HOME) is slow
    assert within_fence(fast, here, SETTINGS, watch, HOME) is not fast
    placed = replace(fast, position_ned_m=(1.0, 1.0, -5.0))
    assert within_fence(placed, here, SETTINGS, watch, HOME) is placed
    partial = Setpoint(velocity_ned_m_s=(12.0, None, None))
    assert within_fence(partial, here, SETTINGS, watch, HOME) is partial
    watch.switch(FenceType.AREAS | FenceType.CIRCLE | FenceType.ALTITUDE, on=False)
    assert within_fence(fast, here, SETTINGS, watch, HOME) is fast


@pytest.mark.parametrize("distance_m", [0.0, -3.0])
def test_there_is_no_speed_without_room(distance_m: float) -> None:
    assert stopping_speed(distance_m, 2.0, 0.8) == 0.0


@given(distance_m=st.floats(0.01, 500.0), acceleration_m_s2=st.floats(0.1, 10.0), reaction_s=st.floats(0.0, 2.0))
def test_the_stopping_speed_uses_the_room_up(distance_m: float, acceleration_m_s2: float, reaction_s: float) -> None:
    speed = stopping_speed(distance_m, acceleration_m_s2, reaction_s)
    assert reaction_s * speed + speed**2 / (2.0 * acceleration_m_s2) == pytest.approx(distance_m, rel=1e-6)
