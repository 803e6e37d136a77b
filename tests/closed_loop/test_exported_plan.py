"""A plan that is exported, uploaded and flown by the autopilot itself, without a planner beside it."""

from collections.abc import Callable
from itertools import product

import numpy as np
import pytest
import shapely
from pymavlink.dialects.v20 import ardupilotmega as mavlink

from mission.export.files import WRITERS
from mission.export.placed_plan import PlacedPlan, placed_plan
from mission.export.route import usual_tolerance
from mission.geometry.geodesy import LatLon, enu_offset_m
from mission.monitor.flight import FlightMonitor
from mission.monitor.monitor import Monitor
from tests.support.ground_station_file import upload_plan
from tests.support.small_missions import ROUNDS, SMALL, plan_of
from tests.support.station import Station
from tests.support.usual_cases import EACH, sampled
from vehicle_sim.autopilot import Mode, Progress
from vehicle_sim.parameters import Flavour
from vehicle_sim.protocol.endpoint import Endpoint
from vehicle_sim.vehicle import Vehicle, VehicleConfig

PLACE = LatLon(-35.3632, 149.1652)
PHOTOGRAPHED = """
domain:
  boundary: [[0, 0], [40, 0], [40, 28], [0, 28]]
  mesh: {}
regions:
  home: {kind: home, polygon: [[1, 1], [9, 1], [9, 9], [1, 9]]}
  field:
    kind: survey
    polygon: [[14, 4], [38, 4], [38, 26], [14, 26]]
    cover: {camera: {field_of_view_deg: [60, 45], overlap: 0.6, sidelap: 0.4}, heading_deg: 90}
mission: {formula: F (field & F G home)}
start: {position_m: [5, 5]}
flight: {altitude_m: 10, speed_m_s: 4, final_stay_s: 2, time_constant_s: 1, disturbance_m_s2: 0.4}
"""
FENCED = {
    Flavour.ARDUPILOT: {"FENCE_ENABLE": 1, "FENCE_TYPE": 4},
    Flavour.PX4: {"GF_ACTION": 2},
}


def exported(text: str) -> PlacedPlan:
    plan = plan_of(text)
    return placed_plan(plan, PLACE, usual_tolerance(plan))


def flown(
    placed: PlacedPlan,
    flavour: Flavour,
    within_s: float,
    images: list[tuple[float, float]] | None = None,
    noses: list[tuple[tuple[float, float], float]] | None = None,
) -> Monitor:
    """Upload the ``.plan`` to a vehicle that stands at its start, fly it with the fence on, and watch where it goes.

    Where its camera took an image is added to ``images``, ENU; where it was, and its heading in degrees, to ``noses``.
    """
    home = placed.places(placed.plan.curve.position([0.0]))[0]
    config = VehicleConfig(flavour=flavour, home_lat_deg=home.latitude_deg, home_lon_deg=home.longitude_deg)
    station = Station(Endpoint(Vehicle(config), flavour, 1))
    vehicle = station.endpoint.vehicle
    for name, value in FENCED[flavour].items():
        vehicle.parameters.set(name, value)
    station.wait_for_position()
    upload_plan(station, WRITERS[".plan"](placed, "", flavour.value))
    if flavour is Flavour.ARDUPILOT:
        assert station.command(mavlink.MAV_CMD_COMPONENT_ARM_DISARM, 1) == mavlink.MAV_RESULT_ACCEPTED
    assert station.command(mavlink.MAV_CMD_MISSION_START) == mavlink.MAV_RESULT_ACCEPTED
    position = mavlink.MAVLINK_MSG_ID_GLOBAL_POSITION_INT
    station.command(mavlink.MAV_CMD_SET_MESSAGE_INTERVAL, position, 100_000)
    station.command(mavlink.MAV_CMD_SET_MESSAGE_INTERVAL, mavlink.MAVLINK_MSG_ID_CAMERA_IMAGE_CAPTURED, 1_000_000)
    station.wait_until(lambda: bool(station.of("MISSION_ITEM_REACHED")), within_s=60.0)
    station.forget()
    station.wait_until(_landed(station), within_s=within_s)
    monitor = FlightMonitor(placed.plan).monitor
    for message in station.of("GLOBAL_POSITION_INT"):
        here = LatLon(message.lat / 1e7, message.lon / 1e7)
        monitor.observe(message.time_boot_ms / 1000.0, enu_offset_m(PLACE, here))
    if noses is not None:
        for message in station.of("GLOBAL_POSITION_INT"):
            here = LatLon(message.lat / 1e7, message.lon / 1e7)
            noses.append((enu_offset_m(PLACE, here), message.hdg / 100.0))
    if images is not None:
        told = station.of("CAMERA_FEEDBACK" if flavour is Flavour.ARDUPILOT else "CAMERA_IMAGE_CAPTURED")
        places = [(told_of.lat, told_of.lng if flavour is Flavour.ARDUPILOT else told_of.lon) for told_of in told]
        images += [enu_offset_m(PLACE, LatLon(latitude / 1e7, longitude / 1e7)) for latitude, longitude in places]
    assert not [text for text in station.texts() if "ence" in text]
    return monitor


def _landed(station: Station) -> Callable[[], bool]:
    autopilot = station.endpoint.vehicle.autopilot

    def landed() -> bool:
        assert autopilot.mode is Mode.AUTO or not autopilot.armed
        return autopilot.mission.progress is Progress.COMPLETE and not autopilot.armed

    return landed


def spelled(monitor: Monitor) -> tuple[frozenset[str], ...]:
    word = monitor.word
    return tuple(letter for i, letter in enumerate(word) if i == 0 or letter != word[i - 1])


@EACH
def test_the_autopilot_spells_the_word_of_the_plan(flavour: Flavour) -> None:
    placed = exported(SMALL)
    monitor = flown(placed, flavour, within_s=120.0)
    assert spelled(monitor) == placed.word == placed.plan.certificate.word
    outcome = monitor.verdict_at_end(stays=True)
    assert outcome.achieved, outcome.reason


@sampled(
    ("flavour", "heading"),
    product(Flavour, ("{fixed: 200}", "{toward: pond}")),
    [(Flavour.ARDUPILOT, "{fixed: 200}"), (Flavour.PX4, "{toward: pond}")],
)
def test_the_nose_looks_where_the_mission_says(flavour: Flavour, heading: str) -> None:
    noses: list[tuple[tuple[float, float], float]] = []
    flown(exported(SMALL.replace("flight:", f"flight:\n  heading: {heading}")), flavour, within_s=120.0, noses=noses)
    off_deg = []
    for (east, north), heading_deg in noses:
        due = 200.0 if "fixed" in heading else np.degrees(np.arctan2(9.0 - east, 25.0 - north))
        off_deg.append(abs((heading_deg - due + 180.0) % 360.0 - 180.0))
    # The first turn takes a while, and what comes after the last waypoint is the autopilot's.
    assert np.quantile(off_deg, 0.7) < 15.0


def test_laps_are_flown_as_often_as_the_plan_says() -> None:
    placed = exported(ROUNDS)
    monitor = flown(placed, Flavour.ARDUPILOT, within_s=240.0)
    assert monitor.laps == 2
    assert not monitor.violations


@EACH
def test_images_are_taken_in_the_lanes_of_a_region_that_is_covered(flavour: Flavour) -> None:
    placed = exported(PHOTOGRAPHED)
    (visit,) = placed.plan.covers
    assert visit.trigger_m is not None
    images: list[tuple[float, float]] = []
    monitor = flown(placed, flavour, within_s=150.0, images=images)
    assert not monitor.violations
    lanes = shapely.MultiLineString(list(visit.lanes_m))
    assert shapely.distance(shapely.points(images), lanes).max() < 0.5 * visit.spacing_m
    due = sum(1.0 + length // visit.trigger_m for length in np.hypot(*(visit.lanes_m[:, 1] - visit.lanes_m[:, 0]).T))
    assert len(images) == pytest.approx(due, abs=len(visit.lanes_m))
