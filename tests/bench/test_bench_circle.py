"""The rms error on a circle of 6 m at 2.1 m/s, beside what real autopilots' own simulators showed."""

import pytest

from tests.support.circle import rms_error_m
from vehicle_sim.dynamics.airframe import Dynamics
from vehicle_sim.parameters import Flavour

_REAL = {Flavour.ARDUPILOT: ("0.6", "0.25"), Flavour.PX4: ("1.3-1.7", "1.1-1.7")}


@pytest.mark.bench
def test_circle() -> None:
    print("\nrms error, m             calm                 wind 6 m/s, gusts 1.5    the real one")
    print("                         pos+vel   +acc       pos+vel   +acc           pos+vel   +acc")
    for flavour in Flavour:
        for dynamics in Dynamics:
            ours = [
                rms_error_m(flavour, dynamics, with_acceleration=leads, wind_m_s=wind_m_s)
                for wind_m_s in (0.0, 6.0)
                for leads in (False, True)
            ]
            plain, led = _REAL[flavour]
            print(
                f"{flavour:<10}{dynamics:<12}   {ours[0]:7.2f}{ours[1]:7.2f}       {ours[2]:7.2f}{ours[3]:7.2f}"
                f"           {plain:>7}{led:>9}"
            )
            assert max(ours) < 1.0
