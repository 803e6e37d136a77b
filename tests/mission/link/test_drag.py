"""Drag is told from lean and velocity, whatever the wind, and not guessed where nothing tells it."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from mission.link.drag import MOST_DRAG_PER_S, DragEstimate
from tests.support.swinging import flown

PERIOD_S = 0.1


@given(st.floats(0.0, 1.5), st.tuples(st.floats(-5.0, 5.0), st.floats(-5.0, 5.0)))
def test_it_is_the_slope_of_the_lean_whatever_the_wind(drag_per_s: float, wind_m_s: tuple[float, float]) -> None:
    assert flown(drag_per_s, wind_m_s).drag_per_s == pytest.approx(drag_per_s, rel=0.06, abs=0.02)


def test_at_a_steady_speed_nothing_tells_it() -> None:
    estimate = DragEstimate()
    for tick in range(200):
        estimate.observe(tick * PERIOD_S, (3.0, 0.0, 0.0), (0.2, 0.0, 0.0))
    assert estimate.drag_per_s == pytest.approx(0.0, abs=1e-9)


@given(
    st.lists(
        st.tuples(
            st.floats(-1.0, 1.0),
            st.tuples(*[st.floats(-30.0, 30.0)] * 3),
            st.tuples(*[st.floats(-1.2, 1.2)] * 3),
        ),
        max_size=60,
    )
)
def test_it_stays_within_its_bounds(
    reports: list[tuple[float, tuple[float, float, float], tuple[float, float, float]]],
) -> None:
    estimate, t_s = DragEstimate(), 0.0
    for step_s, velocity, attitude in reports:
        t_s += step_s
        estimate.observe(t_s, velocity, attitude)
        assert 0.0 <= estimate.drag_per_s <= MOST_DRAG_PER_S
