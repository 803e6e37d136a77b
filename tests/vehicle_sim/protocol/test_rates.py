"""Who gets what how often: groups, intervals, single requests, each on its own link."""

import math
from itertools import pairwise

import pytest
from pymavlink.dialects.v20 import ardupilotmega as mavlink

from tests.support.station import Station, endpoint_of
from vehicle_sim.parameters import Flavour
from vehicle_sim.protocol.flavour import TABLES, Rates

ACCEPTED = mavlink.MAV_RESULT_ACCEPTED
SET = mavlink.MAV_CMD_SET_MESSAGE_INTERVAL
GET = mavlink.MAV_CMD_GET_MESSAGE_INTERVAL
ATTITUDE = mavlink.MAVLINK_MSG_ID_ATTITUDE
HEARTBEAT = mavlink.MAVLINK_MSG_ID_HEARTBEAT


@pytest.mark.parametrize("flavour", Flavour)
def test_an_interval_is_kept_to_and_told(flavour: Flavour) -> None:
    station = Station(endpoint_of(flavour))
    assert station.command(SET, ATTITUDE, 20_000) == ACCEPTED
    station.run(4.0)
    assert len(station.of("ATTITUDE")) == 200
    stamps = [message.time_boot_ms for message in station.of("ATTITUDE")]
    assert {after - before for before, after in pairwise(stamps)} == {20}
    assert station.command(GET, ATTITUDE) == ACCEPTED
    assert station.last("MESSAGE_INTERVAL").interval_us == 20_000
    assert station.command(SET, ATTITUDE, -1) == ACCEPTED
    station.forget()
    station.run(1.0)
    assert not station.of("ATTITUDE")
    assert station.command(GET, ATTITUDE) == ACCEPTED
    assert station.last("MESSAGE_INTERVAL").interval_us == -1


def test_zero_means_the_default_rate_of_the_link() -> None:
    station = Station(endpoint_of(Flavour.PX4), rates=Rates.GROUND_STATION)
    assert station.command(SET, ATTITUDE, 500_000) == ACCEPTED
    assert station.command(SET, ATTITUDE, 0) == ACCEPTED
    station.run(2.0)
    assert len(station.of("ATTITUDE")) == 30
    silent = Station(endpoint_of(Flavour.ARDUPILOT))
    assert silent.command(SET, ATTITUDE, 100_000) == ACCEPTED
    assert silent.command(SET, ATTITUDE, 0) == ACCEPTED
    silent.run(1.0)
    assert not silent.of("ATTITUDE")


@pytest.mark.parametrize(
    ("flavour", "result"),
    [(Flavour.ARDUPILOT, mavlink.MAV_RESULT_DENIED), (Flavour.PX4, mavlink.MAV_RESULT_FAILED)],
)
def test_unknown_messages(flavour: Flavour, result: int) -> None:
    station = Station(endpoint_of(flavour))
    assert station.command(SET, 60_000, 1e5) == result
    assert station.command(SET, math.nan, 1e5) == result
    assert station.request(60_000) == TABLES[flavour].no_message
    assert station.command(GET, 60_000) == ACCEPTED
    assert station.last("MESSAGE_INTERVAL").interval_us == 0
    said = "No ap_message for mavlink id (60000)" in station.texts()
    assert said is (flavour is Flavour.ARDUPILOT)


@pytest.mark.parametrize("interval", [-2.0, math.nan, math.inf, 1e12])
def test_impossible_intervals_are_denied(interval: float) -> None:
    station = Station(endpoint_of(Flavour.ARDUPILOT))
    assert station.command(SET, ATTITUDE, interval) == mavlink.MAV_RESULT_DENIED


def test_the_heartbeat_cannot_be_turned_off() -> None:
    station = Station(endpoint_of(Flavour.ARDUPILOT))
    assert station.command(SET, HEARTBEAT, -1) == mavlink.MAV_RESULT_DENIED
    station.send(mavlink.MAVLink_request_data_stream_message(1, 1, mavlink.MAV_DATA_STREAM_ALL, 0, 0))
    station.run(3.0)
    assert len(station.of("HEARTBEAT")) == 3


@pytest.mark.parametrize("stream", [1, 2, 3, 6, 10, 11, 12])
def test_groups_of_ardupilot(stream: int) -> None:
    station = Station(endpoint_of(Flavour.ARDUPILOT))
    station.wait_for_position()
    station.send(mavlink.MAVLink_request_data_stream_message(1, 1, stream, 4, 1))
    station.forget()
    station.run(5.0)
    group = {mavlink.mavlink_map[number].msgname for number in TABLES[Flavour.ARDUPILOT].stream_groups[stream]}
    group -= {"RC_CHANNELS_RAW"}  # by MAVLink 1 alone
    sent = {name: len(station.of(name)) for name in group - {"POSITION_TARGET_GLOBAL_INT", "FENCE_STATUS"}}
    assert set(sent.values()) == {20}
    station.send(mavlink.MAVLink_request_data_stream_message(1, 1, stream, 4, 0))
    station.forget()
    station.run(2.0)
    assert {message.get_type() for message in station.heard} <= {"HEARTBEAT", "STATUSTEXT"}


def test_all_groups_at_once_leave_out_what_is_in_no_group() -> None:
    station = Station(endpoint_of(Flavour.ARDUPILOT))
    station.wait_for_position()
    station.send(mavlink.MAVLink_request_data_stream_message(1, 1, 0, 2, 1))
    station.run(2.0)
    kinds = {message.get_type() for message in station.heard}
    assert {"ATTITUDE", "SYS_STATUS", "LOCAL_POSITION_NED", "VFR_HUD", "EKF_STATUS_REPORT", "RAW_IMU"} <= kinds
    assert not kinds & {"EXTENDED_SYS_STATE", "POSITION_TARGET_LOCAL_NED"}


def test_px4_takes_the_stream_for_a_message() -> None:
    station = Station(endpoint_of(Flavour.PX4))
    station.send(mavlink.MAVLink_request_data_stream_message(1, 1, ATTITUDE, 10, 1))
    station.run(1.0)
    assert len(station.of("ATTITUDE")) == 10


def test_links_have_their_own_rates() -> None:
    endpoint = endpoint_of(Flavour.ARDUPILOT)
    fast, slow = Station(endpoint, "fast"), Station(endpoint, "slow", system_id=254)
    fast.command(SET, ATTITUDE, 20_000)
    slow.command(SET, ATTITUDE, 500_000)
    fast.run(2.0)
    slow.collect()
    assert (len(fast.of("ATTITUDE")), len(slow.of("ATTITUDE"))) == (100, 4)
    # Sequence numbers count on each link by themselves.
    numbers = [message.get_seq() for message in slow.heard if message.get_srcSystem() == 1]
    assert numbers == list(range(len(numbers)))


@pytest.mark.parametrize(("rates", "number"), [(Rates.ONBOARD, 1), (Rates.GROUND_STATION, 2), (Rates.SILENT, None)])
def test_stream_parameters_of_ardupilot_say_what_is_sent_unasked(rates: Rates, number: int | None) -> None:
    endpoint = endpoint_of(Flavour.ARDUPILOT)
    for name in TABLES[Flavour.ARDUPILOT].stream_parameters.get(rates, {}).values():
        assert name.startswith(f"MAV{number}_")
    endpoint.vehicle.parameters.set("MAV1_EXTRA1", 4)
    endpoint.vehicle.parameters.set("MAV2_EXTRA1", 8)
    station = Station(endpoint, rates=rates)
    station.run(2.0)
    hertz = {None: 0, 1: 4, 2: 8}[number]
    assert len(station.of("ATTITUDE")) == 2 * hertz
    assert not station.of("VFR_HUD")
    assert station.command(SET, ATTITUDE, 20_000) == ACCEPTED
    assert station.command(SET, ATTITUDE, 0) == ACCEPTED  # back to what the parameter says
    assert station.command(GET, ATTITUDE) == ACCEPTED
    assert station.last("MESSAGE_INTERVAL").interval_us == (1_000_000 // hertz if hertz else -1)


@pytest.mark.parametrize("flavour", Flavour)
def test_the_origin_of_px4_comes_on_change_and_on_request_alone(flavour: Flavour) -> None:
    origin = mavlink.MAVLINK_MSG_ID_GPS_GLOBAL_ORIGIN
    station = Station(endpoint_of(flavour), rates=Rates.GROUND_STATION)
    station.wait_for_position()
    assert len(station.of("GPS_GLOBAL_ORIGIN")) == 1
    late = Station(station.endpoint, "late", rates=Rates.GROUND_STATION)
    assert late.command(SET, origin, 100_000) == ACCEPTED
    assert late.command(GET, origin) == ACCEPTED
    assert late.last("MESSAGE_INTERVAL").interval_us == 100_000
    late.run(2.0)
    assert len(late.of("GPS_GLOBAL_ORIGIN")) == (0 if flavour is Flavour.PX4 else 20)
    late.forget()
    assert late.request(origin) == ACCEPTED
    assert late.last("GPS_GLOBAL_ORIGIN").latitude != 0
