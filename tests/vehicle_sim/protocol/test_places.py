"""Which numbers are a place: fields that nobody has filled in, homes out of reach, and what is left as it is."""

import math

import pytest
from pymavlink.dialects.v20 import ardupilotmega as mavlink

from tests.support.station import Station, endpoint_of
from vehicle_sim.autopilot import Command, Mode
from vehicle_sim.geodesy import geodetic_at, ned_offset_m
from vehicle_sim.parameters import Flavour
from vehicle_sim.protocol.mission_items import mission_item
from vehicle_sim.protocol.plan_store import PlanItem
from vehicle_sim.signals import Geodetic

AP, PX4 = Flavour.ARDUPILOT, Flavour.PX4
ACCEPTED, DENIED, FAILED = mavlink.MAV_RESULT_ACCEPTED, mavlink.MAV_RESULT_DENIED, mavlink.MAV_RESULT_FAILED
REPOSITION, SET_HOME = mavlink.MAV_CMD_DO_REPOSITION, mavlink.MAV_CMD_DO_SET_HOME
AMSL, ABOVE_HOME = mavlink.MAV_FRAME_GLOBAL, mavlink.MAV_FRAME_GLOBAL_RELATIVE_ALT_INT
NOT_GIVEN = 2**31 - 1
NAN = math.nan
GO_THERE = (-1.0, 1.0, 0.0, NAN)
STANDING = 1.5
"""How far a vehicle that stands still may seem to be from where it was told to stand, m."""


def ready(flavour: Flavour) -> Station:
    station = Station(endpoint_of(flavour))
    station.wait_for_position()
    return station


def home_of(station: Station) -> Geodetic:
    home = station.endpoint.vehicle.autopilot.home
    assert home is not None
    return home


def away(station: Station, north_m: float, up_m: float = 0.0) -> tuple[int, int, float]:
    """A place seen from home, as COMMAND_INT has it."""
    place = geodetic_at(home_of(station), (north_m, 0.0, -up_m))
    return round(place.lat_deg * 1e7), round(place.lon_deg * 1e7), place.alt_m


def where(station: Station) -> tuple[float, float, float]:
    """North, east and up of home, as the vehicle estimates it."""
    vehicle = station.endpoint.vehicle
    origin = vehicle.estimate.origin
    assert origin is not None
    home = ned_offset_m(origin, home_of(station))
    north, east, down = (here - zero for here, zero in zip(vehicle.estimate.position_ned_m, home, strict=True))
    return north, east, -down


def speed(station: Station) -> float:
    return math.hypot(*station.endpoint.vehicle.estimate.velocity_ned_m_s)


def holding(height_m: float = 8.0) -> Station:
    """A PX4 that holds."""
    station = Station(endpoint_of(PX4))
    station.take_off(height_m)
    station.wait_until(lambda: station.endpoint.vehicle.autopilot.mode is Mode.HOLD, within_s=20.0)
    return station


@pytest.mark.parametrize("flavour", Flavour)
def test_nobody_is_sent_to_two_zeros(flavour: Flavour) -> None:
    station = Station(endpoint_of(flavour))
    station.take_off(8.0)
    station.run(4.0)
    before = station.endpoint.vehicle.autopilot.target
    assert station.command_int(REPOSITION, ABOVE_HOME, GO_THERE, (0, 0, 10.0)) == DENIED
    if flavour is PX4:
        assert station.command(REPOSITION, *GO_THERE, 0.0, 0.0, home_of(station).alt_m + 10.0) == DENIED
    assert station.endpoint.vehicle.autopilot.target == before


def test_to_ardupilot_no_height_above_home_has_not_been_filled_in() -> None:
    station = Station(endpoint_of(AP))
    station.take_off(8.0)
    x, y, sea_m = away(station, 10.0)
    assert station.command_int(REPOSITION, ABOVE_HOME, GO_THERE, (x, y, 0.0)) == DENIED
    assert station.command_int(REPOSITION, AMSL, GO_THERE, (x, y, sea_m + 8.0)) == ACCEPTED


@pytest.mark.parametrize("flavour", Flavour)
def test_a_setpoint_at_two_zeros_is_none(flavour: Flavour) -> None:
    station = Station(endpoint_of(flavour))
    station.take_off(8.0)
    station.run(2.0)

    def send(x: int, y: int) -> None:
        fields = (x, y, 8.0, *(0.0,) * 8)
        station.send(mavlink.MAVLink_set_position_target_global_int_message(0, 1, 1, 6, 0xDF8, *fields))

    x, y, _ = away(station, 20.0)
    send(x, y)
    station.set_mode(Mode.GUIDED)
    send(x, y)
    station.run(1.0)
    flown = station.endpoint.vehicle.autopilot.target
    send(0, 0)
    after = station.endpoint.vehicle.autopilot.target
    assert flown is not None
    assert after is not None
    if flavour is PX4:
        assert after == flown
    else:
        # It stops, as for everything that it cannot fly.
        assert after.position_ned_m[0] is not None
        assert abs(after.position_ned_m[0] - station.endpoint.vehicle.estimate.position_ned_m[0]) < 5.0


@pytest.mark.parametrize("flavour", Flavour)
def test_home_is_not_moved_to_two_zeros(flavour: Flavour) -> None:
    station = ready(flavour)
    moved = away(station, 30.0, 2.0)
    assert station.command_int(SET_HOME, AMSL, (0,) * 4, moved) == ACCEPTED
    kept = home_of(station)
    station.send(mavlink.MAVLink_set_home_position_message(1, 0, 0, 480_000, 0, 0, 0, (1, 0, 0, 0), 0, 0, 0))
    assert home_of(station) == kept
    if flavour is PX4:
        assert station.command_int(SET_HOME, AMSL, (0,) * 4, (0, 0, 0.0)) == DENIED
        assert home_of(station) == kept
        return
    # ArduPilot takes them for: here.
    zeros = mavlink.MAVLink_set_home_position_message(1, 0, 0, 0, 0, 0, 0, (1, 0, 0, 0), 0, 0, 0)
    for here in (
        lambda: station.command_int(SET_HOME, AMSL, (0,) * 4, (0, 0, 0.0)),
        lambda: station.command(SET_HOME),
        lambda: station.send(zeros),
    ):
        assert station.command_int(SET_HOME, AMSL, (0,) * 4, moved) == ACCEPTED
        here()
        assert math.hypot(*where(station)) < 1e-3
    assert station.command_int(SET_HOME, AMSL, (2, 0, 0, 0), moved) == FAILED


@pytest.mark.parametrize("place", [(60_000.0, 0.0), (0.0, 60_000.0)])
def test_ardupilot_refuses_a_home_that_is_far_from_the_origin(place: tuple[float, float]) -> None:
    station = ready(AP)
    kept = home_of(station)
    x, y, sea_m = away(station, *place)
    assert station.command_int(SET_HOME, AMSL, (0,) * 4, (x, y, sea_m)) == FAILED
    station.send(mavlink.MAVLink_set_home_position_message(1, x, y, round(sea_m * 1e3), 0, 0, 0, (1, 0, 0, 0), 0, 0, 0))
    assert home_of(station) == kept
    near = away(station, 40_000.0)
    assert station.command_int(SET_HOME, AMSL, (0,) * 4, near) == ACCEPTED


def test_older_clients_go_nowhere_by_two_zeros_but_up() -> None:
    station = Station(endpoint_of(AP))
    station.take_off(8.0)

    def send(purpose: int) -> int:
        fields = (0, 3, mavlink.MAV_CMD_NAV_WAYPOINT, purpose, 1, 0, 0, 0, 0, 0.0, 0.0, 12.0)
        station.send(mavlink.MAVLink_mission_item_message(1, 1, *fields, 0))
        return int(station.last("MISSION_ACK").type)

    assert send(2) == mavlink.MAV_MISSION_ERROR
    assert send(3) == mavlink.MAV_MISSION_ACCEPTED
    station.wait_until(lambda: station.height_m() > 11.0, within_s=20.0)
    assert math.hypot(*where(station)[:2]) < STANDING


@pytest.mark.parametrize("flavour", Flavour)
@pytest.mark.parametrize(("kind", "command"), [(1, mavlink.MAV_CMD_NAV_FENCE_CIRCLE_INCLUSION), (2, 5100)])
def test_neither_fence_nor_rally_point_lies_at_two_zeros(flavour: Flavour, kind: int, command: int) -> None:
    station = ready(flavour)
    station.send(mavlink.MAVLink_mission_count_message(1, 1, 1, kind))
    station.send(mavlink.MAVLink_mission_item_int_message(1, 1, 0, 3, command, 0, 1, 100.0, 0, 0, 0, 0, 0, 10.0, kind))
    assert station.last("MISSION_ACK").type == mavlink.MAV_MISSION_INVALID_PARAM5_X


def test_to_look_at_zeros_is_to_look_ahead_to_ardupilot() -> None:
    zeros = PlanItem(3, mavlink.MAV_CMD_DO_SET_ROI_LOCATION, 1, (0.0,) * 4, 0, 0, 0.0)
    assert mission_item(AP, zeros).command is Command.LOOK_AHEAD
    assert mission_item(AP, zeros._replace(x=1)).command is Command.LOOK_AT


@pytest.mark.parametrize("by_int", [True, False])
def test_px4_pauses_where_nothing_is_given(by_int: bool) -> None:  # noqa: FBT001 - a parameter of the test
    station = holding()
    x, y, sea_m = away(station, 60.0, 8.0)
    assert station.command_int(REPOSITION, AMSL, GO_THERE, (x, y, sea_m)) == ACCEPTED
    station.wait_until(lambda: speed(station) > 3.0, within_s=20.0)
    begun = where(station)
    if by_int:
        assert station.command_int(REPOSITION, AMSL, GO_THERE, (NOT_GIVEN, NOT_GIVEN, NAN)) == ACCEPTED
    else:
        assert station.command(REPOSITION, *GO_THERE, NAN, NAN, NAN) == ACCEPTED
    station.wait_until(lambda: speed(station) < 0.3, within_s=10.0)
    stopped = where(station)
    assert begun[0] < stopped[0] < begun[0] + 15.0
    assert stopped[2] == pytest.approx(begun[2], abs=1.0)


def test_px4_changes_its_height_alone_also_on_the_way() -> None:
    station = holding()
    x, y, sea_m = away(station, 30.0, 8.0)
    assert station.command_int(REPOSITION, AMSL, GO_THERE, (x, y, sea_m)) == ACCEPTED
    station.wait_until(lambda: speed(station) > 3.0, within_s=20.0)
    up = (NOT_GIVEN, NOT_GIVEN, sea_m + 6.0)
    assert station.command_int(REPOSITION, AMSL, GO_THERE, up) == ACCEPTED
    station.wait_until(lambda: math.dist(where(station), (30.0, 0.0, 14.0)) < STANDING, within_s=30.0)


def test_px4_turns_alone() -> None:
    station = holding()
    begun = where(station)
    east = (-1.0, 1.0, 0.0, math.pi / 2)
    assert station.command_int(REPOSITION, AMSL, east, (NOT_GIVEN, NOT_GIVEN, NAN)) == ACCEPTED
    station.wait_until(lambda: abs(station.endpoint.vehicle.estimate.yaw_rad - math.pi / 2) < 0.05, within_s=10.0)
    assert math.dist(where(station), begun) < STANDING
    # A height that follows keeps the heading that is turned to.
    assert station.command(REPOSITION, *GO_THERE, NAN, NAN, home_of(station).alt_m + 12.0) == ACCEPTED
    station.wait_until(lambda: where(station)[2] > 11.0, within_s=20.0)
    assert station.endpoint.vehicle.estimate.yaw_rad == pytest.approx(math.pi / 2, abs=0.1)


def test_ardupilot_wants_a_whole_place() -> None:
    station = Station(endpoint_of(AP))
    station.take_off(8.0)
    assert station.command_int(REPOSITION, ABOVE_HOME, GO_THERE, (NOT_GIVEN, NOT_GIVEN, 9.0)) == DENIED
