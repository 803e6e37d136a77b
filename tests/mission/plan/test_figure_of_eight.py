"""A figure of eight is flown at the mission's speed where there is room, and refused where there is none."""

import math
from contextlib import suppress
from dataclasses import replace

import numpy as np
import pytest
import shapely
from hypothesis import given
from hypothesis import strategies as st

from mission.errors import NoPlanError
from mission.plan import FlightPlan
from mission.plan.figure_of_eight import figure_of_eight
from mission.spec.loader import parse_mission
from mission.spec.model import MissionSpec
from tests.support.drawn_cases import tried

FIELD = """\
domain: {boundary: [[0, 0], [%g, 0], [%g, %g], [0, %g]]}
regions: {wall: {kind: restricted, polygon: [[0, 0], [4, 0], [4, 4], [0, 4]]}}
mission: {formula: G !wall}
start: {position_m: [%g, %g]}
flight: {speed_m_s: 4}
"""


def field(east_m: float = 60.0, north_m: float = 60.0, start_m: tuple[float, float] = (30.0, 30.0)) -> MissionSpec:
    return parse_mission((FIELD % (east_m, east_m, north_m, north_m, *start_m)).encode())


def test_it_reaches_the_speed_within_the_limits_and_comes_back() -> None:
    spec = field()
    trajectory = figure_of_eight(spec).trajectory
    place, velocity, acceleration = trajectory.state(np.linspace(0.0, trajectory.duration_s, 4000))
    assert place[0] == pytest.approx([30.0, 30.0])
    assert place[-1] == pytest.approx([30.0, 30.0])
    assert np.hypot(*velocity.T).max() == pytest.approx(4.0, rel=0.05)
    assert np.hypot(*acceleration.T).max() <= spec.limits.acceleration_m_s2 * (1.0 + 1e-6)
    # Both ways round, three times: it crosses the middle six times, the ends of the flight among them.
    away = np.hypot(*(place - 30.0).T) > 1.0
    assert np.count_nonzero(np.diff(away.astype(int)) == 1) == 6


@tried(12)
@given(st.floats(20.0, 60.0), st.floats(20.0, 60.0), st.floats(0.1, 0.9), st.floats(0.1, 0.9))
def test_it_keeps_out_of_everything_or_is_refused(east_m: float, north_m: float, x: float, y: float) -> None:
    spec = field(east_m, north_m, (6.0 + x * (east_m - 7.0), 6.0 + y * (north_m - 7.0)))
    with suppress(NoPlanError):
        _keeps_out(spec, figure_of_eight(spec), shapely.box(0.0, 0.0, east_m, north_m))


def _keeps_out(spec: MissionSpec, plan: FlightPlan, domain: shapely.Polygon) -> None:
    curve = shapely.LineString(plan.trajectory.position(np.linspace(0.0, plan.trajectory.duration_s, 2000)))
    free = domain - shapely.box(0.0, 0.0, 4.0, 4.0)
    assert free.covers(curve)
    assert curve.distance(free.boundary) >= 2.0 * math.sqrt(2.0) * spec.flight.tube_m - 0.05


def test_where_there_is_no_room_it_says_what_to_do() -> None:
    with pytest.raises(NoPlanError, match=r"start where there is more, or give the mission a smaller"):
        figure_of_eight(field(start_m=(1.5, 30.0)))
    spec = field()
    faster = replace(spec, flight=replace(spec.flight, speed_m_s=20.0), limits=replace(spec.limits, speed_m_s=20.0))
    with pytest.raises(NoPlanError, match="no room for a figure of eight of 160 m by 80 m"):
        figure_of_eight(faster)
