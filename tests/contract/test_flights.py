"""Every mission file flies, in lock-step, and its vehicle reports a word that satisfies it."""

import io
from pathlib import Path

from mission.fly import fly, home_for
from mission.plan import plan_mission
from mission.report.record import FlightRecord
from mission.spec.loader import load_mission
from tests.support.commands import MISSIONS
from tests.support.lockstep import LockstepVehicle, vehicle_of
from tests.support.usual_cases import sampled

# The paper's mission takes a quarter of an hour of vehicle time and is flown by the closed-loop tests.
FLOWN = [file for file in sorted(MISSIONS.glob("*.yaml")) if file.stem != "paper"]
LONG = {"farm", "orchard", "park", "power_line", "yard"}
"""Some minutes of vehicle time each; a small field is covered in every run of the tests, by the closed-loop ones."""
ELSEWHERE = {"pairs", "response", "survey"}
"""The closed-loop tests fly these in every run: with a named automaton, in strong wind, and with drag."""
ALIKE = {"delivery", "inspection", "tasks_soft"}
"""One after the other as in `tasks_delivery`, which is flown in every run, as `patrol` is."""


USUAL = [file for file in FLOWN if file.stem not in LONG | ELSEWHERE | ALIKE]


@sampled("file", FLOWN, USUAL, ids=lambda file: file.stem)
def test_a_mission_is_achieved(file: Path) -> None:
    plan = plan_mission(load_mission(file))
    home = home_for(plan.spec)
    place = {} if home is None else dict(zip(("home_lat_deg", "home_lon_deg", "home_alt_m"), home, strict=True))
    flavour = ("ardupilot", "px4")[FLOWN.index(file) % 2]
    vehicle = LockstepVehicle(vehicle_of(flavour, seed=3, **place))
    result = fly(plan, vehicle, vehicle, FlightRecord(io.BytesIO(), mission=file.stem))
    assert result.achieved, result.reason
    assert not result.violations
    assert not vehicle.vehicle.autopilot.armed
