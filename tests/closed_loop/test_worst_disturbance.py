"""Flights against the worst disturbance within the bound of the file: none may leave the tube of its proof.

`python -m pytest -m long -rP tests/closed_loop/test_worst_disturbance.py` flies all of them, for half an hour on two
cores, and says how many there were and which share of its tube the worst one took.
"""

import io
from collections.abc import Callable
from dataclasses import replace
from itertools import product

import pytest

from mission.fly import fly
from mission.link.ending import Ending
from mission.plan import FlightPlan
from mission.report.record import FlightRecord
from tests.support.adversary import Sign, away, beating, pumping, pushed, rambling
from tests.support.lockstep import LockstepVehicle, as_it_comes, vehicle_of
from tests.support.small_missions import ROUNDS, SMALL, plan_of
from vehicle_sim.control.controller import PX4_GAINS, TrackingGains
from vehicle_sim.dynamics.airframe import Dynamics
from vehicle_sim.vehicle import VehicleConfig

DEFAULT_TUBE = SMALL.replace("  disturbance_m_s2: 0.5\n", "").replace("  time_constant_s: 1.0\n", "")
MISSIONS = {"small": SMALL, "rounds": ROUNDS, "with the default tube": DEFAULT_TUBE}
SPEEDS_M_S = (2.0, 4.0, 6.0)
DISTURBANCES: dict[str, Callable[[int], tuple[Sign, Sign]]] = {
    "away": lambda _seed: (away, away),
    "pumping": lambda _seed: (pumping, pumping),
    "beating with 1.5 s": lambda _seed: (beating(1.5), beating(1.7)),
    "beating with 3 s": lambda _seed: (beating(3.0), beating(3.3)),
    "beating with 5 s": lambda _seed: (beating(5.0), beating(5.5)),
    "beating with 9 s": lambda _seed: (beating(9.0), beating(8.0)),
    "rambling": lambda seed: (rambling(seed), rambling(seed + 1000)),
}
SEEDS = (1, 2)
WINDS_M_S = (0.0, 2.0, 4.0, 5.0)


VEHICLES: dict[str, VehicleConfig] = {
    "ardupilot": replace(vehicle_of("ardupilot"), gains=TrackingGains()),
    "px4": replace(vehicle_of("px4"), gains=TrackingGains()),
    "px4 with its own gains": replace(vehicle_of("px4"), gains=PX4_GAINS),
    "ardupilot as it comes": as_it_comes("ardupilot"),
    "px4 as it comes": as_it_comes("px4"),
}
GROUPS = [
    (vehicle, mission, speed_m_s)
    for vehicle, mission, speed_m_s in product(VEHICLES, MISSIONS, SPEEDS_M_S)
    if mission == "with the default tube" or "as it comes" not in vehicle
]
"""A vehicle with its own drag follows late by itself, for which a tube of the disturbance alone has no room."""


def flown(
    config: VehicleConfig,
    plan: FlightPlan,
    seed: int,
    signs: tuple[Sign, Sign] | None,
    *,
    dynamics: Dynamics = Dynamics.HOVER,
    wind_m_s: float = 0.0,
) -> float:
    """The worst error as a share of the tube, against this disturbance, or in this wind alone.

    The vehicle lands under this as well, by itself, and drifts no farther than the plan leaves room for.
    """
    config = replace(config, seed=seed, dynamics=dynamics, wind_m_s=wind_m_s, wind_from_deg=70.0 * seed)
    vehicle = LockstepVehicle(config)
    if signs is not None:
        pushed(vehicle, plan.spec.flight.disturbance_m_s2, signs)
    result = fly(plan, vehicle, vehicle, FlightRecord(io.BytesIO(), mission="worst"))
    assert result.ending is Ending.LANDED
    assert result.achieved, result.reason
    return result.largest_error_m / plan.certificate.tube_m


def planned(mission: str, speed_m_s: float) -> FlightPlan:
    text = MISSIONS[mission]
    for usual in ("  speed_m_s: 4.0\n", "  speed_m_s: 5.0\n"):
        text = text.replace(usual, f"  speed_m_s: {speed_m_s}\n", 1)
    return plan_of(text)


@pytest.mark.parametrize(
    ("vehicle", "mission", "speed_m_s", "disturbance", "seed"),
    [
        ("ardupilot", "small", 6.0, "pumping", 1),
        ("px4 with its own gains", "small", 6.0, "pumping", 1),
        ("px4 with its own gains", "small", 6.0, "beating with 3 s", 1),
        ("px4", "small", 6.0, "away", 1),
        ("px4 with its own gains", "rounds", 4.0, "away", 2),
    ],
)
def test_the_worst_disturbance_is_not_enough(
    vehicle: str, mission: str, speed_m_s: float, disturbance: str, seed: int
) -> None:
    """Without the damping of the setpoints' correction, the second one takes 1.15 of its tube.

    The last one brakes hard while the push that its autopilot has learned turns round: 1.08 with a pull of 0.8 and a
    lead that begins with nothing.
    """
    assert flown(VEHICLES[vehicle], planned(mission, speed_m_s), seed, DISTURBANCES[disturbance](seed)) <= 1.0


@pytest.mark.long
@pytest.mark.timeout(1800)
@pytest.mark.parametrize(("vehicle", "mission", "speed_m_s"), GROUPS)
def test_hundreds_of_flights(vehicle: str, mission: str, speed_m_s: float) -> None:
    """Against each disturbance with either dynamics; with the default tube, which holds none, in winds."""
    plan = planned(mission, speed_m_s)
    shares: dict[tuple[object, ...], float] = {}
    if plan.spec.flight.disturbance_m_s2:
        for name, seed, dynamics in product(DISTURBANCES, SEEDS, Dynamics):
            shares[name, seed, dynamics] = flown(
                VEHICLES[vehicle], plan, seed, DISTURBANCES[name](seed), dynamics=dynamics
            )
    else:
        for wind_m_s, seed in product(WINDS_M_S, (*SEEDS, 3)):
            shares[wind_m_s, seed] = flown(VEHICLES[vehicle], plan, seed, None, wind_m_s=wind_m_s)
    worst = max(shares, key=lambda key: shares[key])
    told = f"{len(shares)} flights, {shares[worst]:.2f} of the tube ({', '.join(map(str, worst))})"
    print(f"\n{vehicle}, {mission} at {speed_m_s:g} m/s: {told}")  # noqa: T201
    assert shares[worst] <= 1.0
