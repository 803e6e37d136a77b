"""Tracking like a real one: how far behind a circle the vehicle flies, within a band round what ArduCopter does."""

import pytest

from tests.support.circle import rms_error_m
from vehicle_sim.dynamics.airframe import Dynamics
from vehicle_sim.parameters import Flavour


@pytest.mark.parametrize("wind_m_s", [0.0, 6.0])
@pytest.mark.parametrize("dynamics", list(Dynamics))
@pytest.mark.parametrize("flavour", list(Flavour))
def test_a_circle_is_tracked_like_arducopter_tracks_it(flavour: Flavour, dynamics: Dynamics, wind_m_s: float) -> None:
    """ArduCopter: 0.6 m with position and velocity, 0.25 m with acceleration too."""
    plain, led = (rms_error_m(flavour, dynamics, with_acceleration=leads, wind_m_s=wind_m_s) for leads in (False, True))
    assert 0.4 < plain < 0.75
    assert 0.06 < led < 0.3
