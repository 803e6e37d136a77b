"""Coming to rest: closed forms, and that nothing of the motion is lost."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from mission.steering.stopping import stopping, stopping_after


def test_a_brake_that_comes_up_and_fades_takes_half_the_time_of_its_jerk_more() -> None:
    # From v with a and j: v / a + a / j seconds, on the mean of which the speed is v / 2.
    found = stopping(4.0, 0.0, 2.0, 4.0)
    assert found.times_s.tolist() == pytest.approx([0.0, 0.5, 2.0, 2.5])
    assert found.way == pytest.approx(4.0 / 2.0 * 2.5)


def test_a_slow_vehicle_does_not_come_to_its_largest_brake() -> None:
    found = stopping(0.25, 0.0, 2.0, 4.0)
    assert found.times_s.tolist() == pytest.approx([0.0, 0.25, 0.25, 0.5])
    assert float(found.accelerations.min()) == pytest.approx(-1.0)


@given(st.floats(0.05, 15.0), st.floats(-3.0, 3.0), st.floats(0.5, 3.0), st.floats(0.5, 8.0), st.floats(1.001, 1.5))
def test_the_motion_ends_at_rest_and_stretches(
    speed: float, acceleration: float, most: float, jerk: float, more: float
) -> None:
    found = stopping(speed, acceleration, most, jerk)
    assert found.accelerations[0] == acceleration
    assert (np.diff(found.times_s) >= -1e-12).all()
    ends = speed + 0.5 * float(np.diff(found.times_s) @ (found.accelerations[1:] + found.accelerations[:-1]))
    assert ends == pytest.approx(0.0, abs=1e-9 * (1.0 + speed))
    later = stopping_after(more * found.way, speed, acceleration, most, jerk)
    if later is not None:
        assert later.way == pytest.approx(more * found.way, rel=1e-6)
        assert float(-later.accelerations.min()) <= max(most, -acceleration) + 1e-9
