"""A pilot takes the vehicle from its trajectory and hands it back elsewhere: the flight goes on from there."""

import pytest
from pymavlink.dialects.v20 import ardupilotmega as mavlink

from mission.fly import FlightOptions
from mission.link.ending import Ending
from mission.plan import FlightPlan
from tests.support.replanned import Replanned
from tests.support.small_missions import SMALL, plan_of
from tests.support.station import Station
from tests.support.usual_cases import ARDUPILOT
from vehicle_sim.autopilot import Mode

FLAVOURS = pytest.mark.parametrize("flavour", ["ardupilot", "px4"])
PILOTED = {"ardupilot": Mode.POSITION, "px4": Mode.HOLD}
FROM_S, FOR_S = 3.0, 20.0
GUST = "gust, since: takeoff, at_s: 16, for_s: 8, north_m_s: 8"
"""What carries the vehicle across triangles while the pilot has it."""


class Pilot:
    """Takes the vehicle, and hands it back."""

    def __init__(self, *, hands_back: bool = True) -> None:
        self.took = self.gave = False
        self.hands_back = hands_back

    def fly(self, flown: Replanned, since_s: float) -> None:
        autopilot = flown.vehicle.vehicle.autopilot
        if since_s >= FROM_S and not self.took:
            self.took = True
            autopilot.set_mode(PILOTED[flown.flavour])
        elif self.took and not self.gave and self.hands_back and since_s >= FROM_S + FOR_S:
            self.gave = True
            autopilot.set_mode(Mode.GUIDED)


class AtTheSticks:
    """Takes the vehicle, flies it to its left, which is north, and hands it back while it still brakes."""

    def __init__(self) -> None:
        self.station: Station | None = None
        self.mode: Mode | None = None

    def fly(self, flown: Replanned, since_s: float) -> None:
        if self.station is None:
            self.station = Station(flown.vehicle.endpoint)
        if since_s < FROM_S:
            return
        wanted = Mode.POSITION if since_s < FROM_S + 7.0 else Mode.GUIDED
        if wanted is not self.mode:
            self.mode = wanted
            self.station.set_mode(wanted)
        right = -350 if FROM_S + 2.0 <= since_s < FROM_S + 6.0 else 0
        self.station.send(mavlink.MAVLink_manual_control_message(1, 0, right, 500, 0, 0))
        self.station.forget()


@pytest.fixture(scope="module")
def plan() -> FlightPlan:
    return plan_of(SMALL)


@FLAVOURS
def test_handed_back_it_goes_on_from_where_it_is(plan: FlightPlan, flavour: str) -> None:
    options = FlightOptions(resume_when_handed_back=True)
    flight = Replanned(plan, flavour, GUST, at_step=Pilot().fly, options=options, drag_per_s=0.5)
    assert flight.result.achieved, flight.result.reason
    assert flight.result.ending is Ending.LANDED
    assert len(flight.result.plans) == 2
    assert flight.entered() == ["home", "goal", "home"]
    [held], [back] = flight.events("held by a pilot"), flight.events("handed back")
    assert back["t_s"] - held["t_s"] == pytest.approx(FOR_S, abs=3.0)
    commands = [row["t_s"] or 0.0 for row in flight.events("command")]
    assert not [t_s for t_s in commands if held["t_s"] <= t_s <= back["t_s"]]  # nobody is fought
    intentions = ["handed back: planning from here", "going on from here to goal"]
    assert [row["reason"] for row in flight.events("intention")] == intentions
    assert flight.told == (f"{held['reason']}: waiting until it is handed back", *intentions)


@ARDUPILOT
def test_flown_elsewhere_by_sticks_it_goes_on_from_where_it_comes_to_rest(plan: FlightPlan, flavour: str) -> None:
    flight = Replanned(plan, flavour, at_step=AtTheSticks().fly, options=FlightOptions(resume_when_handed_back=True))
    assert flight.result.achieved, flight.result.reason
    [leg] = flight.events("leg")
    assert leg["start_m"][1] > plan.start_m[1] + 2.0
    assert flight.entered() == ["home", "goal", "home"]


def test_without_being_asked_to_wait_it_lets_go(plan: FlightPlan) -> None:
    flight = Replanned(plan, "ardupilot", at_step=Pilot(hands_back=False).fly)
    assert flight.result.ending is Ending.HANDED_OVER
