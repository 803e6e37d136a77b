"""Drone missions written in linear temporal logic, planned with a proof and flown over MAVLink.

    >>> import mission
    >>> spec = mission.parse_mission(b'''
    ... domain: {boundary: [[0, 0], [40, 0], [40, 30], [0, 30]]}
    ... regions:
    ...   home: {kind: home, polygon: [[4, 4], [14, 4], [14, 12], [4, 12]]}
    ...   field: {kind: survey, polygon: [[26, 4], [36, 4], [36, 12], [26, 12]]}
    ...   pond: {kind: restricted, polygon: [[18, 2], [22, 2], [22, 14], [18, 14]]}
    ... mission: {formula: F (field & F home)}
    ... start: {position_m: [9, 8]}
    ... ''')
    >>> plan = mission.plan_mission(spec)
    >>> [sorted(letter) for letter in plan.certificate.word if letter]
    [['home'], ['field'], ['home']]
    >>> all(not claim.fault for claim in mission.verify_plan(plan))
    True
    >>> bool(mission.simulate_plan(plan).distance_m.max() < 1e-9)
    True

What there is, by what it is for; each says more in its own documentation. Lengths are metres, times seconds, angles
radians; places are east and north in the domain of the mission, and arrays of them have the shape (N, 2).

- ``load_mission(file)``, ``parse_mission(bytes)``: a mission, ``MissionSpec``, or ``SpecError`` with all its faults.
- ``plan_mission(spec)``: its plan, ``FlightPlan``, or ``NoPlanError``: ``partition`` and ``labelling`` (triangles),
  ``system`` (T), ``automaton`` (A), ``run``, ``path``, ``trajectory``, ``certificate``; ``shortest_runs(plan)`` gives
  all best runs, ``fields_of_run(plan)`` the fields with their equations, ``product_steps(plan)`` delta_P, and where
  something moves ``carried_path(plan)`` the path of the fields in space.
- ``plan_to_json(plan)``, ``plan_from_json(text)``: the plan as text, and back, bit by bit.
- ``simulate_plan(plan)``: the paper's own closed loop along it.
- ``verify_plan(plan)``: each of its claims, judged anew.
- ``fly_plan(plan)``: the flight, with the bundled vehicle or one at an address.
- ``judge_flight(log, spec)``: the verdict on any flight.

Names are looked up when they are used: ``import mission`` loads nothing.
"""

from importlib import import_module
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from mission.errors import LinkError, MissionError, NoPlanError, SpecError, VehicleError
    from mission.fly import FlightOptions, FlightResult, VehicleOptions
    from mission.library import fly_plan, judge_flight, verify_plan
    from mission.plan import FlightPlan, plan_from_json, plan_mission, plan_to_json, shortest_runs
    from mission.plan.carried import carried_path
    from mission.plan.definitions import fields_of_run, product_steps
    from mission.simulate import Simulation, simulate_plan
    from mission.spec.loader import load_mission, parse_mission
    from mission.spec.model import MissionSpec
    from mission.verify.flown.judging import Judged
    from mission.verify.plans import Claim

__version__ = "0.1.0"

_PLACES = {
    "mission.errors": ("LinkError", "MissionError", "NoPlanError", "SpecError", "VehicleError"),
    "mission.fly": ("FlightOptions", "FlightResult", "VehicleOptions"),
    "mission.library": ("fly_plan", "judge_flight", "verify_plan"),
    "mission.plan": ("FlightPlan", "plan_from_json", "plan_mission", "plan_to_json", "shortest_runs"),
    "mission.plan.carried": ("carried_path",),
    "mission.plan.definitions": ("fields_of_run", "product_steps"),
    "mission.simulate": ("Simulation", "simulate_plan"),
    "mission.spec.loader": ("load_mission", "parse_mission"),
    "mission.spec.model": ("MissionSpec",),
    "mission.verify.flown.judging": ("Judged",),
    "mission.verify.plans": ("Claim",),
}
_PLACE_OF = {name: place for place, names in _PLACES.items() for name in names}

__all__ = [
    "Claim",
    "FlightOptions",
    "FlightPlan",
    "FlightResult",
    "Judged",
    "LinkError",
    "MissionError",
    "MissionSpec",
    "NoPlanError",
    "Simulation",
    "SpecError",
    "VehicleError",
    "VehicleOptions",
    "carried_path",
    "fields_of_run",
    "fly_plan",
    "judge_flight",
    "load_mission",
    "parse_mission",
    "plan_from_json",
    "plan_mission",
    "plan_to_json",
    "product_steps",
    "shortest_runs",
    "simulate_plan",
    "verify_plan",
]


def __getattr__(name: str) -> object:
    """Load what is asked for."""
    if name not in _PLACE_OF:
        raise AttributeError(f"module 'mission' has no attribute {name!r}")
    return getattr(import_module(_PLACE_OF[name]), name)


def __dir__() -> list[str]:
    return sorted([*globals(), *__all__])
