"""The vehicle's own geofence: set before arming, in the way of a planner that errs, and put back whatever happens."""

import io
import json
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from typing import Any

import pytest
from pymavlink.dialects.v20 import ardupilotmega as mavlink
from shapely import Point, Polygon

from mission.errors import MissionError, VehicleError
from mission.fly import FlightOptions, FlightResult, StopRequest, fencing, fly
from mission.link.frames import Anchoring
from mission.plan import FlightPlan
from mission.report.record import FlightRecord
from tests.support.faults import schedule_of
from tests.support.fences import stopping_distance_m
from tests.support.lockstep import LockstepVehicle, vehicle_of
from tests.support.small_missions import FLOWN_BRISKLY, SMALL, at_a_place, plan_of
from tests.support.usual_cases import ARDUPILOT, EACH, PX4
from vehicle_sim.autopilot import Mode
from vehicle_sim.autopilot.geofence import Polygon as SimPolygon
from vehicle_sim.geodesy import geodetic_at, ned_offset_m
from vehicle_sim.protocol.fences import fence_plan
from vehicle_sim.protocol.plan_store import PlanItem, PlanKind
from vehicle_sim.signals import Geodetic

SWITCH = {"ardupilot": "FENCE_ENABLE", "px4": "GF_ACTION"}
WALL = Polygon([(18, 0), (28, 0), (28, 10), (18, 10)])
WEST_M = 18.0
ROUND_THE_WALL = (
    """\
domain:
  boundary: [[0, 0], [46, 0], [46, 30], [0, 30]]
regions:
  home: {kind: home, polygon: [[4, 4], [12, 4], [12, 12], [4, 12]]}
  goal: {kind: survey, polygon: [[34, 4], [42, 4], [42, 12], [34, 12]]}
  wall: {kind: restricted, polygon: [[18, 0], [28, 0], [28, 10], [18, 10]]}
mission:
  formula: F (goal & F G home)
start:
  position_m: [9, 10]
"""
    + FLOWN_BRISKLY
)
START_M = (9.0, 10.0)
GUARDED = FlightOptions(fence=True)


@pytest.fixture(scope="module")
def walled() -> FlightPlan:
    return plan_of(ROUND_THE_WALL)


@pytest.fixture(scope="module")
def small() -> FlightPlan:
    return plan_of(SMALL)


@dataclass
class Watched(LockstepVehicle):
    """A vehicle of which each step is looked at."""

    flavour: str
    fault: str = ""
    deepest_m: float = 0.0
    armed_with: set[tuple[int, float]] = field(default_factory=set)

    def __post_init__(self) -> None:
        config = vehicle_of(self.flavour)
        config = replace(config, faults=schedule_of(self.fault)) if self.fault else config
        super().__init__(config, at_step=lambda _: self.look())

    def look(self) -> None:
        vehicle = self.vehicle
        if vehicle.autopilot.armed and vehicle.steps % 10 == 0:
            fence = vehicle.autopilot.guard.fence
            self.armed_with.add((len(fence.plan.areas), vehicle.parameters[SWITCH[self.flavour]]))
            north, east, _ = vehicle.truth.position_ned_m
            here = Point(START_M[0] + east, START_M[1] + north)
            if WALL.contains(here):
                self.deepest_m = max(self.deepest_m, here.x - WEST_M, WALL.exterior.distance(here))

    def has(self) -> tuple[dict[str, float], tuple[PlanItem, ...]]:
        """Its parameters, and the items of its fence."""
        store = self.vehicle.parameters
        return {name: store[name] for name in store.names}, self.endpoint._plans.store.plans[PlanKind.FENCE]

    def given(self, *items: PlanItem, **parameters: float) -> "Watched":
        """The same with a fence of its owner's."""
        self.endpoint._plans.store.replace(PlanKind.FENCE, items)
        self.vehicle.autopilot.guard.fence.load(fence_plan(items))
        for name, value in parameters.items():
            self.vehicle.parameters.set(name, value)
        return self


@dataclass
class Flown:
    """How a flight ended: its result, or the error that it failed with."""

    result: FlightResult | None
    error: MissionError | None
    record: list[dict[str, Any]]
    warnings: list[str]


def flown(
    plan: FlightPlan,
    vehicle: LockstepVehicle,
    options: FlightOptions = GUARDED,
    stop_request: Callable[[], StopRequest | None] | None = None,
) -> Flown:
    sink = io.BytesIO()
    result, failure, warnings = None, None, list[str]()
    record = FlightRecord(sink, mission="guard")
    try:
        result = fly(
            plan, vehicle, vehicle, record, options=options, stop_request=stop_request, on_warning=warnings.append
        )
    except MissionError as error:
        failure = error
    return Flown(result, failure, [json.loads(line) for line in sink.getvalue().splitlines()], warnings)


@ARDUPILOT
def test_a_flight_in_its_tube_is_not_disturbed_and_leaves_no_trace(small: FlightPlan, flavour: str) -> None:
    vehicle = Watched(flavour)
    before = vehicle.has()
    flight = flown(small, vehicle)
    assert flight.result is not None
    assert flight.result.achieved
    assert vehicle.armed_with == {(2, {"ardupilot": 1.0, "px4": 2.0}[flavour])}
    assert vehicle.has() == before
    (told,) = [line for line in flight.record if line.get("name") == "geofence"]
    assert told["items_before"] == []
    assert len(told["items"]) == 8
    assert told["parameters_before"].items() <= before[0].items()
    assert not flight.warnings


def _errs(monkeypatch: pytest.MonkeyPatch) -> None:
    """Let the planner take itself to be seven metres north of where it is, from when the fence has been made."""
    anchored = fencing.anchored_at

    def wrong(north_m: float, east_m: float, anchoring: Anchoring) -> Anchoring:
        return anchored(north_m - 7.0, east_m, anchoring)

    monkeypatch.setattr(fencing, "anchored_at", wrong)


@EACH
def test_a_planner_that_errs_is_stopped_by_the_autopilot(
    walled: FlightPlan, flavour: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    vehicle = Watched(flavour)
    before = vehicle.has()
    _errs(monkeypatch)
    flight = flown(walled, vehicle)
    assert isinstance(flight.error, VehicleError)
    assert "fence" in str(flight.error)
    assert vehicle.vehicle.autopilot.mode in (Mode.BRAKE, Mode.HOLD)
    assert 0.0 < vehicle.deepest_m < stopping_distance_m(vehicle.vehicle, 4.5)
    assert vehicle.has() == before


def test_without_the_fence_the_same_planner_flies_through_the_wall(
    walled: FlightPlan, monkeypatch: pytest.MonkeyPatch
) -> None:
    vehicle = Watched("px4")
    _errs(monkeypatch)
    monkeypatch.setattr(fencing, "fence_items", lambda _areas: ())
    result = flown(walled, vehicle).result
    assert result is not None
    assert result.achieved  # as far as the planner can tell
    assert vehicle.deepest_m > 9.5


@PX4
def test_an_interrupted_flight_puts_the_owner_s_fence_back(small: FlightPlan, flavour: str) -> None:
    """Also where the flight is ended in the air, and messages are lost."""
    item = PlanItem(mavlink.MAV_FRAME_GLOBAL, mavlink.MAV_CMD_NAV_FENCE_CIRCLE_EXCLUSION, 1, (20.0, 0, 0, 0), 1, 1, 0.0)
    owners = {"ardupilot": {"FENCE_ENABLE": 1.0, "FENCE_ACTION": 1.0}, "px4": {"GF_ACTION": 3.0}}[flavour]
    vehicle = Watched(flavour, "link, since: takeoff, at_s: 5, drop: 0.15, duplicate: 0.1").given(item, **owners)
    before = vehicle.has()
    stops = iter([StopRequest("enough")])

    def stop() -> StopRequest | None:
        high = vehicle.vehicle.autopilot.armed and vehicle.vehicle.truth.position_ned_m[2] < -4.0
        return next(stops, None) if high else None

    flight = flown(small, vehicle, stop_request=stop)
    assert flight.result is not None
    assert flight.result.interrupted
    assert vehicle.vehicle.autopilot.flying
    assert vehicle.has() == before
    assert flight.warnings == ["the vehicle's own geofence, of 1 items, gives way to that of this mission"]


@ARDUPILOT
def test_what_cannot_be_put_back_is_said(small: FlightPlan, flavour: str) -> None:
    flight = flown(small, Watched(flavour, "link, since: takeoff, at_s: 5, drop: 1"))
    assert flight.error is not None
    assert "own geofence this was not put back" in str(flight.error)
    assert SWITCH[flavour] in str(flight.error)


def test_a_fence_that_is_to_stay_stays_and_one_that_was_not_asked_for_never_comes(small: FlightPlan) -> None:
    vehicle = Watched("ardupilot")
    assert flown(small, vehicle, FlightOptions(fence=True, keep_fence=True)).result is not None
    parameters, items = vehicle.has()
    assert (parameters["FENCE_ENABLE"], len(items)) == (1.0, 8)
    other = Watched("px4")
    before = other.has()
    assert flown(small, other, FlightOptions()).result is not None
    assert (other.armed_with, other.has()) == ({(0, before[0]["GF_ACTION"])}, before)


@pytest.mark.parametrize("latitude_deg", [0.0, -67.0])
def test_the_fence_lies_where_the_mission_does(latitude_deg: float) -> None:
    """A mission at a place on Earth, from a vehicle whose own origin is elsewhere."""
    plan = plan_of(at_a_place(latitude_deg, 8.0))
    # At the equator a sphere of ArduPilot's radius is 0.7 % off, which is why the fence gives way by a few centimetres.
    home = geodetic_at(Geodetic(latitude_deg, 8.0, 0.0), (8.0, 9.0, 0.0))
    config = replace(vehicle_of("ardupilot"), home_lat_deg=home.lat_deg, home_lon_deg=home.lon_deg)
    vehicle = LockstepVehicle(config)
    flight = flown(plan, vehicle, FlightOptions(fence=True, keep_fence=True))
    assert flight.result is not None
    assert flight.result.achieved
    _, pond = vehicle.vehicle.autopilot.guard.fence.plan.areas
    assert isinstance(pond, SimPolygon)
    corners = [ned_offset_m(Geodetic(latitude_deg, 8.0, 0.0), corner)[:2] for corner in pond.vertices]
    kept = Polygon([(east, north) for north, east in corners])
    drawn = Polygon([(4, 22), (14, 22), (14, 28), (4, 28)])
    assert drawn.buffer(0.02).contains(kept)
    assert kept.buffer(0.4, join_style="mitre").contains(drawn)
