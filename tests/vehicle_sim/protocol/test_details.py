"""Details by which a vehicle is told from a real one: its version, its clock over a restart, its terrain."""

import pytest
from pymavlink.dialects.v20 import ardupilotmega as mavlink

from tests.support.station import Station, endpoint_of
from vehicle_sim.parameters import Flavour

AP, PX4 = Flavour.ARDUPILOT, Flavour.PX4
TERRAIN_CAPABILITY, COMPASS_CAPABILITY = 512, 4096


def test_what_it_was_built_from() -> None:
    hashes = {}
    for flavour in Flavour:
        station = Station(endpoint_of(flavour))
        station.request(mavlink.MAVLINK_MSG_ID_AUTOPILOT_VERSION)
        hashes[flavour] = bytes(station.last("AUTOPILOT_VERSION").flight_custom_version)
    # ArduPilot tells the digits themselves, PX4 their bytes from the last on.
    assert hashes[AP].decode("ascii") == "90700977"
    assert hashes[PX4][::-1].hex() == "94cb201200000000"


@pytest.mark.parametrize("flavour", Flavour)
def test_the_clock_of_the_satellites_goes_on_over_a_restart(flavour: Flavour) -> None:
    station = Station(endpoint_of(flavour))
    station.wait_for_position()
    station.request(mavlink.MAVLINK_MSG_ID_SYSTEM_TIME)
    before = station.last("SYSTEM_TIME")
    assert station.command(mavlink.MAV_CMD_PREFLIGHT_REBOOT_SHUTDOWN, 1) == mavlink.MAV_RESULT_ACCEPTED
    station.run(1.0)
    station.wait_for_position()
    station.request(mavlink.MAVLINK_MSG_ID_SYSTEM_TIME)
    after = station.last("SYSTEM_TIME")
    passed_us = after.time_unix_usec - before.time_unix_usec
    assert 0 < passed_us < 60e6
    assert abs(passed_us - after.time_boot_ms * 1000) < 1e6


def test_terrain_is_flat() -> None:
    station = Station(endpoint_of(AP))
    check = mavlink.MAVLink_terrain_check_message(474_000_000, 85_000_000)
    station.send(check)
    assert not station.of("TERRAIN_REPORT")
    station.wait_for_position()
    station.send(check)
    told = station.last("TERRAIN_REPORT")
    assert (told.lat, told.lon, told.pending) == (474_000_000, 85_000_000, 0)
    assert told.terrain_height == pytest.approx(488.0, abs=2.0)
    assert station.request(mavlink.MAVLINK_MSG_ID_TERRAIN_REPORT) == mavlink.MAV_RESULT_ACCEPTED
    assert station.last("TERRAIN_REPORT").current_height == pytest.approx(0.0, abs=2.0)


def test_what_is_claimed_is_there() -> None:
    claims = {
        flavour: int(endpoint_of(flavour).table.capabilities) & (TERRAIN_CAPABILITY | COMPASS_CAPABILITY)
        for flavour in Flavour
    }
    assert claims == {AP: TERRAIN_CAPABILITY | COMPASS_CAPABILITY, PX4: 0}
    px4 = Station(endpoint_of(PX4))
    px4.wait_for_position()
    px4.send(mavlink.MAVLink_terrain_check_message(474_000_000, 85_000_000))
    assert not px4.of("TERRAIN_REPORT")
    assert px4.command(mavlink.MAV_CMD_DO_START_MAG_CAL) == mavlink.MAV_RESULT_UNSUPPORTED


def test_the_list_of_modes_is_watched() -> None:
    for flavour, result in ((AP, mavlink.MAV_RESULT_ACCEPTED), (PX4, mavlink.MAV_RESULT_DENIED)):
        assert Station(endpoint_of(flavour)).request(437) == result
