"""Flight figures of both flavours beside those of ArduCopter and PX4 in their own simulators."""

import pytest

from tests.support.flight_figures import APART, FLIGHTS, RECORDED, Recorded, is_near, ratio
from vehicle_sim.dynamics.airframe import Dynamics
from vehicle_sim.parameters import Flavour


def _shown(row: str, recorded: Recorded) -> str:
    value = recorded[row]
    return f"{value[0]:g}-{value[1]:g}" if isinstance(value, tuple) else f"{value:g}"


@pytest.mark.bench
@pytest.mark.parametrize("dynamics", Dynamics)
@pytest.mark.parametrize("flavour", Flavour)
def test_figures(flavour: Flavour, dynamics: Dynamics) -> None:
    recorded, apart, far = RECORDED[flavour], APART[flavour], []
    print(f"\n{flavour}, {dynamics:<38}{'recorded':>12}{'ours':>12}{'ratio':>8}")
    for flight in FLIGHTS:
        for row, ours in flight(flavour, dynamics).items():
            if row not in recorded:
                print(f"{row:<50}{'':>12}{ours:>12.3f}")
                continue
            near = is_near(ours, recorded[row])
            remark = "" if near else apart.get(row, "too far")
            print(f"{row:<50}{_shown(row, recorded):>12}{ours:>12.3f}{ratio(ours, recorded[row]):>8.2f}  {remark}")
            far += [row] if not near and row not in apart else []
    assert not far
