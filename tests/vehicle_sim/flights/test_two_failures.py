"""Two failures at once, in either order: the graver answer stands, and the end of one does not end the other's."""

import pytest

from tests.support.dangers import Endangered, Fault
from vehicle_sim.autopilot import Failsafe, Mode
from vehicle_sim.parameters import Flavour

AP, PX4 = Flavour.ARDUPILOT, Flavour.PX4

PAIRS: list[tuple[Flavour, Fault, Fault, dict[str, float], Mode]] = [
    (
        PX4,
        Fault.GROUND,
        Fault.BATTERY_EMERGENCY,
        {"NAV_DLL_ACT": 2, "COM_DL_LOSS_T": 5, "COM_LOW_BAT_ACT": 3},
        Mode.LAND,
    ),
    (PX4, Fault.STICKS, Fault.BATTERY_CRITICAL, {"NAV_RCL_ACT": 1, "COM_LOW_BAT_ACT": 2}, Mode.LAND),
    (PX4, Fault.FENCE, Fault.STICKS, {"GF_ACTION": 2, "NAV_RCL_ACT": 2}, Mode.RETURN),
    (AP, Fault.STICKS, Fault.GROUND, {"FS_THR_ENABLE": 3, "FS_GCS_ENABLE": 1}, Mode.LAND),
]
ORDERS = pytest.mark.parametrize("swapped", [False, True])


@pytest.mark.parametrize(("flavour", "first", "second", "parameters", "mode"), PAIRS)
@ORDERS
def test_the_graver_answer_stands_in_either_order(
    flavour: Flavour, first: Fault, second: Fault, parameters: dict[str, float], mode: Mode, *, swapped: bool
) -> None:
    one = Endangered(flavour, sticks=Fault.STICKS in (first, second), **parameters)
    for fault in (second, first) if swapped else (first, second):
        one.begin(fault)
        one.fly(2.0)
    one.fly(12.0)
    assert one.now() is mode


@ORDERS
def test_what_ends_leaves_the_other_failure_present(*, swapped: bool) -> None:
    one = Endangered(PX4, sticks=True, NAV_DLL_ACT=1, COM_DL_LOSS_T=5, NAV_RCL_ACT=1)
    faults = (Fault.GROUND, Fault.STICKS) if swapped else (Fault.STICKS, Fault.GROUND)
    for fault in faults:
        one.begin(fault)
    one.fly(8.0)
    assert one.now() is Mode.HOLD
    one.end(faults[0])
    one.fly(2.0)
    left = {Fault.GROUND: Failsafe.GROUND_LOST, Fault.STICKS: Failsafe.STICKS_LOST}[faults[1]]
    assert one.vehicle.autopilot.failsafe is left
    assert one.now() is Mode.HOLD
    one.end(faults[1])
    one.fly(2.0)
    assert one.vehicle.autopilot.failsafe is Failsafe.NONE
