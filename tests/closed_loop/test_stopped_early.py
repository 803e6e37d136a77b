"""A flight that is stopped as the vehicle lifts off: it is held, or stays on the ground, and what is said is so."""

import io
from itertools import chain, repeat

import pytest

from mission.fly import FlightOptions, StopRequest, fly
from mission.link.ending import Ending
from mission.monitor.stage import Stage
from mission.plan import FlightPlan
from mission.report.record import FlightRecord
from tests.support.lockstep import LockstepVehicle, vehicle_of
from tests.support.small_missions import SMALL, plan_of

HOLDING = {"px4": "AUTO.LOITER", "ardupilot": "BRAKE"}


@pytest.fixture(scope="module")
def plan() -> FlightPlan:
    return plan_of(SMALL)


@pytest.mark.parametrize("lands", [True, False])
@pytest.mark.parametrize(("flavour", "after_s"), [("px4", 0.0), ("px4", 0.4), ("ardupilot", 1.0), ("ardupilot", 1.3)])
def test_a_stop_as_the_vehicle_lifts_off(plan: FlightPlan, flavour: str, after_s: float, *, lands: bool) -> None:
    """Its last word may be of the time before: that it waits in the mode that holds it, or is on the ground."""
    vehicle = LockstepVehicle(vehicle_of(flavour))
    rises_s: list[float] = []
    wishes = chain((StopRequest("enough"),), repeat(None))

    def stop() -> StopRequest | None:
        return next(wishes) if rises_s and vehicle.now_s() >= rises_s[0] + after_s else None

    result = fly(
        plan,
        vehicle,
        vehicle,
        FlightRecord(io.BytesIO(), mission="stopped"),
        options=FlightOptions(land_when_stopped=lands),
        stop_request=stop,
        on_progress=lambda now: rises_s.append(vehicle.now_s()) if now.stage is Stage.TAKE_OFF else None,
    )
    assert result.ending is Ending.STOPPED
    assert result.reason.startswith("enough")
    until_s = vehicle.now_s() + 10.0
    while vehicle.now_s() < until_s:
        vehicle.receive(0.1)
    assert (HOLDING[flavour] in result.reason) == vehicle.vehicle.autopilot.armed
    assert not (lands and vehicle.vehicle.autopilot.armed)
