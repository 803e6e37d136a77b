"""A battery that does not hold the plan: the vehicle comes home on its own with what is to stay in it."""

from dataclasses import replace
from itertools import product

import pytest

from mission.fly import FlightOptions
from mission.fly.preflight import Checks
from mission.link.ending import Ending
from mission.plan import FlightPlan
from mission.report.reading import LEG, LaterPlan
from mission.report.replay import judged_again
from mission.spec.battery import Battery
from tests.support.replanned import Replanned
from tests.support.resumed import Killed
from tests.support.small_missions import PHOTOGRAPHED, ROUNDS, SMALL, plan_of
from tests.support.usual_cases import ARDUPILOT, EACH, sampled
from vehicle_sim.parameters import Flavour

CAPACITY = {"ardupilot": "BATT_CAPACITY", "px4": "BAT1_CAPACITY"}
CAPACITY_MAH = 1500.0
DRAWN_A = 11.8
"""By the bundled vehicle, near hovering."""

NEAR_SHARE = 0.02
"""How near to the reserve it is to come home."""

ANYWAY = FlightOptions(checks=Checks(forced=("battery",)), land_when_stopped=True)
FAR = SMALL.replace("40, 0], [40, 30", "140, 0], [140, 30").replace(
    "[[26, 4], [36, 4], [36, 12], [26, 12]]", "[[126, 4], [136, 4], [136, 12], [126, 12]]"
)
WHOLE_MAH = 313.0
"""What the check before says of the mission above."""


def carrying(plan: FlightPlan, usable_mah: float, current_a: float, capacity_mah: float = CAPACITY_MAH) -> FlightPlan:
    battery = Battery(current_a, reserve=1.0 - usable_mah / capacity_mah)
    return replace(plan, spec=replace(plan.spec, battery=battery))


def flown(plan: FlightPlan, flavour: str, usable_mah: float, current_a: float = DRAWN_A) -> Replanned:
    """A flight with a full battery of which so much may be used."""
    plan = carrying(plan, usable_mah, current_a)
    return Replanned(plan, flavour, options=ANYWAY, parameters={CAPACITY[flavour]: CAPACITY_MAH})


def over_mah(flight: Replanned, usable_mah: float) -> float:
    """What is left beyond the reserve after the landing, by the vehicle's own books."""
    return usable_mah - flight.vehicle.vehicle.battery.consumed_mah


@pytest.fixture(scope="module")
def far() -> FlightPlan:
    return plan_of(FAR)


# With px4 the vehicle draws more than the file says.
@pytest.mark.parametrize(("flavour", "current_a"), [("ardupilot", DRAWN_A), ("px4", 0.9 * DRAWN_A)])
def test_sixty_per_cent_of_what_the_plan_takes_bring_it_home(far: FlightPlan, flavour: str, current_a: float) -> None:
    usable_mah = 0.6 * WHOLE_MAH
    flight = flown(far, flavour, usable_mah, current_a)
    result = flight.result
    assert result.ending is Ending.LANDED
    assert not result.achieved
    assert not result.violations
    assert flight.entered() == ["home", "home"]
    assert abs(over_mah(flight, usable_mah)) <= NEAR_SHARE * CAPACITY_MAH
    assert "the mission was given up for a return" in result.reason
    assert "left undone: goal" in result.reason
    assert "longer" not in result.reason  # it was the shorter way
    [leg] = flight.events("leg")
    record = flight.record
    later = tuple(LaterPlan(at_s, result.plans[number - 1], laps) for at_s, number, laps, _ in record.takeovers)
    assert judged_again(carrying(far, usable_mah, current_a), replace(record, later=later)).outcome().achieved is False
    assert leg["reason"].startswith("battery: ")
    assert len(flight.events("way home")) < 10


@sampled(
    ("flavour", "capacity_mah", "wind_from_deg"),
    [("px4", 1500.0, 270.0), ("ardupilot", 3000.0, 90.0), ("ardupilot", 5200.0, 270.0)],
    [("px4", 1500.0, 270.0), ("ardupilot", 3000.0, 90.0)],
)
def test_wind_that_is_against_the_way_home_or_with_it_is_reckoned_with(
    far: FlightPlan, flavour: str, capacity_mah: float, wind_from_deg: float
) -> None:
    """As near to the reserve as with the smallest battery; home lies in the west."""
    usable_mah = 0.6 * WHOLE_MAH
    flight = Replanned(
        carrying(far, usable_mah, DRAWN_A, capacity_mah),
        flavour,
        options=ANYWAY,
        parameters={CAPACITY[flavour]: capacity_mah},
        wind_m_s=5.0,
        wind_from_deg=wind_from_deg,
    )
    assert flight.result.ending is Ending.LANDED
    assert flight.entered() == ["home", "home"]
    assert abs(over_mah(flight, usable_mah)) <= NEAR_SHARE * CAPACITY_MAH
    way = flight.events("way home")[-1]
    against = wind_from_deg == 270.0
    assert (way["current_a"] > 1.1 * way["mean_current_a"]) is against
    assert ("on the way home against the wind" in flight.events("leg")[0]["reason"]) is against


@EACH
def test_what_suffices_for_no_way_home_ends_the_flight_where_it_is(far: FlightPlan, flavour: str) -> None:
    """The charge falls at once to less than the straight way takes."""
    usable_mah = 0.9 * WHOLE_MAH

    def drained(flight: Replanned, flying_s: float) -> None:
        if flying_s >= 20.0 and flight.vehicle.vehicle.battery.consumed_mah < CAPACITY_MAH - 60.0:
            flight.vehicle.vehicle.battery.consumed_mah = CAPACITY_MAH - 60.0

    flight = Replanned(
        carrying(far, usable_mah, DRAWN_A),
        flavour,
        options=ANYWAY,
        parameters={CAPACITY[flavour]: CAPACITY_MAH},
        at_step=drained,
    )
    assert flight.result.ending is Ending.STOPPED
    assert not flight.result.achieved
    assert "it suffices for no way home" in flight.result.reason
    assert not flight.vehicle.vehicle.autopilot.armed


@ARDUPILOT
def test_what_suffices_is_flown_to_the_end(flavour: str) -> None:
    flight = flown(plan_of(SMALL), flavour, 150.0)
    assert flight.result.achieved, flight.result.reason
    assert len(flight.result.plans) == 1
    assert "battery" not in flight.result.reason
    assert not flight.events("way home")


def test_from_amid_a_field_it_returns_with_what_was_covered() -> None:
    flight = flown(plan_of(PHOTOGRAPHED), "ardupilot", 200.0)
    result = flight.result
    assert result.ending is Ending.LANDED
    assert not result.achieved
    [covered] = result.covered
    assert 0.1 < covered.share < covered.asked
    assert "field covered to" in result.reason
    assert abs(over_mah(flight, 200.0)) <= NEAR_SHARE * CAPACITY_MAH


@sampled(
    ("flavour", "at_s"),
    product(Flavour, (30.0, 40.0, 44.0, 51.0)),
    [(Flavour.ARDUPILOT, 44.0), (Flavour.PX4, 40.0)],
)
def test_a_return_goes_on_from_its_record(far: FlightPlan, flavour: Flavour, at_s: float) -> None:
    """Killed on the way home, or just before that is begun: home it goes, and to nothing that was given up."""
    plan = carrying(far, 0.6 * WHOLE_MAH, DRAWN_A)
    killed = Killed(plan, flavour, at_s, ANYWAY, {CAPACITY[flavour]: CAPACITY_MAH})
    returns = [event.values["returns"] for event in killed.record.events if event.text == LEG]
    assert returns == [True] * (at_s > 30.0)
    alone_s = 8.0
    killed.leave(alone_s)
    result = killed.resume()
    assert result.ending is Ending.LANDED
    assert not result.achieved
    assert not result.violations
    assert killed.entered() == ["home", "home"]
    assert "the mission was given up for a return" in result.reason
    assert "left undone: goal" in result.reason
    # A return that was begun is late by as long as nobody led it, and by how long it takes to be found again.
    late_mah = Battery(DRAWN_A).charge_mah(alone_s + 4.0) if returns else 0.0
    over = 0.6 * WHOLE_MAH - killed.bench.vehicle.battery.consumed_mah
    assert abs(over + 0.5 * late_mah) <= 0.5 * late_mah + NEAR_SHARE * CAPACITY_MAH
    assert judged_again(plan, killed.record).outcome().reason in result.reason


def test_a_lap_that_is_given_up_for_a_return_is_none() -> None:
    capacity_mah, usable_mah = 1000.0, 130.0
    plan = carrying(plan_of(ROUNDS), usable_mah, DRAWN_A, capacity_mah)
    flight = Replanned(plan, "ardupilot", options=ANYWAY, parameters={CAPACITY["ardupilot"]: capacity_mah})
    assert "0 of 2 laps were flown" in flight.result.reason
    assert "returned before all was done" in flight.result.reason
    assert flight.result.laps == 0


@pytest.mark.parametrize(("asked", "achieved"), [("9", False), ("until_stopped", True)])
def test_as_many_laps_are_flown_as_the_charge_allows_for(asked: str, achieved: bool) -> None:  # noqa: FBT001 - a row
    plan = plan_of(ROUNDS.replace("laps: 2", f"laps: {asked}"))
    usable_mah = 200.0
    flight = flown(plan, "px4", usable_mah)
    result = flight.result
    assert result.ending is Ending.LANDED
    assert result.achieved is achieved
    assert len(result.plans) == 1
    assert "not enough for one more lap" in result.reason
    lap_mah = Battery(DRAWN_A).charge_mah(plan.trajectory.legs[1].duration_s)
    over = over_mah(flight, usable_mah)
    assert 0.0 <= over <= lap_mah + NEAR_SHARE * CAPACITY_MAH
    assert result.laps == len([name for name in flight.entered() if name == "north"])
