"""The mission protocol as timelines: uploads, losses, repetitions, rivals, refusals, downloads."""

import pytest
from pymavlink.dialects.v20 import ardupilotmega as mavlink

from tests.support.station import Station, endpoint_of
from vehicle_sim.autopilot import Mode
from vehicle_sim.parameters import Flavour
from vehicle_sim.protocol.dialect import Message
from vehicle_sim.protocol.flavour import TABLES

MISSION, FENCE, RALLY, EVERYTHING = 0, 1, 2, 255
ACCEPTED = mavlink.MAV_MISSION_ACCEPTED
LAT, LON = 473_977_420, 85_455_940


def item(seq: int, **changes: float) -> Message:
    fields: dict[str, float] = {
        "frame": mavlink.MAV_FRAME_GLOBAL_RELATIVE_ALT_INT,
        "command": mavlink.MAV_CMD_NAV_WAYPOINT,
        "param1": 0.0,
        "current": 0,
        "x": LAT + 100 * seq,
        "y": LON,
        "z": 10.0,
        "mission_type": MISSION,
    }
    f = fields | changes
    return mavlink.MAVLink_mission_item_int_message(
        1,
        1,
        seq,
        f["frame"],
        f["command"],
        f["current"],
        1,
        f["param1"],
        0,
        0,
        0,
        f["x"],
        f["y"],
        f["z"],
        f["mission_type"],
    )


def count(number: int, mission_type: int = MISSION) -> Message:
    return mavlink.MAVLink_mission_count_message(1, 1, number, mission_type)


def requests(station: Station) -> list[int]:
    return [m.seq for m in station.heard if m.get_type() in ("MISSION_REQUEST", "MISSION_REQUEST_INT")]


def acknowledgements(station: Station) -> list[tuple[int, int]]:
    return [(m.type, m.mission_type) for m in station.of("MISSION_ACK")]


def upload(station: Station, items: list[Message], mission_type: int = MISSION) -> None:
    station.send(count(len(items), mission_type))
    for each in items:
        assert requests(station)[-1] == each.seq
        station.send(each)


def download(station: Station, mission_type: int = MISSION) -> list[Message]:
    station.forget()
    station.send(mavlink.MAVLink_mission_request_list_message(1, 1, mission_type))
    number = station.last("MISSION_COUNT").count
    for seq in range(number):
        station.send(mavlink.MAVLink_mission_request_int_message(1, 1, seq, mission_type))
    station.send(mavlink.MAVLink_mission_ack_message(1, 1, ACCEPTED, mission_type))
    return station.of("MISSION_ITEM_INT")


def fence() -> list[Message]:
    vertex = mavlink.MAV_CMD_NAV_FENCE_POLYGON_VERTEX_INCLUSION
    return [item(seq, command=vertex, param1=3, mission_type=FENCE) for seq in range(3)]


@pytest.mark.parametrize("flavour", Flavour)
@pytest.mark.parametrize("mission_type", [MISSION, FENCE, RALLY])
def test_empty_plans_answer(flavour: Flavour, mission_type: int) -> None:
    station = Station(endpoint_of(flavour))
    assert download(station, mission_type) == []
    station.send(count(0, mission_type))
    assert acknowledgements(station) == [(ACCEPTED, mission_type)]


@pytest.mark.parametrize("flavour", Flavour)
def test_what_goes_up_comes_down(flavour: Flavour) -> None:
    station = Station(endpoint_of(flavour))
    upload(station, [item(seq) for seq in range(4)])
    assert acknowledgements(station) == [(ACCEPTED, MISSION)]
    asked = "MISSION_REQUEST_INT" if flavour is Flavour.PX4 else "MISSION_REQUEST"
    assert [message.seq for message in station.of(asked)] == [0, 1, 2, 3]
    items = download(station)
    assert [(m.seq, m.x, m.y, m.z, m.command) for m in items] == [
        (seq, LAT + 100 * seq, LON, 10.0, mavlink.MAV_CMD_NAV_WAYPOINT) for seq in range(4)
    ]
    upload(station, fence(), FENCE)
    assert len(download(station, FENCE)) == 3
    assert len(download(station)) == 4


@pytest.mark.parametrize("flavour", Flavour)
def test_lost_requests_are_repeated_and_repeated_items_are_harmless(flavour: Flavour) -> None:
    station = Station(endpoint_of(flavour))
    station.send(count(2))
    station.run(TABLES[flavour].plan_retry_us * 1e-6 + 0.02)
    assert requests(station) == [0, 0]
    station.send(item(0), item(0), item(0))
    assert requests(station)[-1] == 1
    station.send(item(1))
    assert acknowledgements(station) == [(ACCEPTED, MISSION)]
    assert len(download(station)) == 2


@pytest.mark.parametrize("flavour", Flavour)
def test_silence_ends_an_upload_and_keeps_the_former_plan(flavour: Flavour) -> None:
    station = Station(endpoint_of(flavour))
    upload(station, [item(0)])
    station.forget()
    station.send(count(3), item(0))
    station.run(TABLES[flavour].plan_timeout_us * 1e-6 + 0.1)
    if flavour is Flavour.PX4:
        assert acknowledgements(station) == []
        assert station.texts()[-1] == "Operation timeout"
    else:
        assert acknowledgements(station) == [(mavlink.MAV_MISSION_OPERATION_CANCELLED, MISSION)]
        assert "Mission upload timeout" in station.texts()
    station.forget()
    station.run(10.0)
    assert requests(station) == []
    assert len(download(station)) == 1


def test_a_rival_has_to_wait() -> None:
    endpoint = endpoint_of(Flavour.ARDUPILOT)
    first, rival = Station(endpoint, "first"), Station(endpoint, "rival", system_id=254)
    first.send(count(2), item(0))
    rival.send(count(1))
    assert acknowledgements(rival) == [(mavlink.MAV_MISSION_DENIED, MISSION)]
    rival.send(item(1), mavlink.MAVLink_mission_clear_all_message(1, 1, EVERYTHING))
    rival.send(mavlink.MAVLink_mission_request_list_message(1, 1, MISSION))
    assert acknowledgements(rival)[1:] == [
        (mavlink.MAV_MISSION_DENIED, MISSION),
        (mavlink.MAV_MISSION_ERROR, EVERYTHING),
        (mavlink.MAV_MISSION_DENIED, MISSION),
    ]
    first.send(item(1))
    assert acknowledgements(first) == [(ACCEPTED, MISSION)]
    rival.send(count(1), item(0))
    assert acknowledgements(rival)[-1] == (ACCEPTED, MISSION)


def test_a_rival_of_px4_is_told_in_words() -> None:
    endpoint = endpoint_of(Flavour.PX4)
    first, rival = Station(endpoint, "first"), Station(endpoint, "rival", system_id=254)
    first.send(count(2), item(0))
    rival.send(count(1))
    assert acknowledgements(rival) == [(mavlink.MAV_MISSION_ERROR, MISSION)]
    rival.send(item(1), mavlink.MAVLink_mission_clear_all_message(1, 1, EVERYTHING))
    rival.send(mavlink.MAVLink_mission_request_list_message(1, 1, MISSION))
    assert len(acknowledgements(rival)) == 1
    assert rival.texts() == [
        "REJ. MIS ITEM: partner id mismatch",
        "WPM: IGN CLEAR CMD: Busy",
        "Mission download request ignored, already active",
    ]
    first.send(item(1))
    assert acknowledgements(first) == [(ACCEPTED, MISSION)]


def test_the_last_item_again_is_answered_again_by_px4() -> None:
    station = Station(endpoint_of(Flavour.PX4))
    upload(station, [item(0), item(1)])
    station.send(item(1), item(0))
    assert acknowledgements(station) == [(ACCEPTED, MISSION)] * 2 + [(mavlink.MAV_MISSION_ERROR, MISSION)]


def test_a_partner_that_leaves_frees_the_way() -> None:
    endpoint = endpoint_of(Flavour.PX4)
    first, rival = Station(endpoint, "first"), Station(endpoint, "rival", system_id=254)
    first.send(count(2))
    endpoint.remove_link("first")
    rival.send(count(1), item(0))
    assert acknowledgements(rival) == [(ACCEPTED, MISSION)]
    rival.send(count(2), mavlink.MAVLink_mission_ack_message(1, 1, mavlink.MAV_MISSION_OPERATION_CANCELLED, MISSION))
    rival.forget()
    rival.run(10.0)
    assert requests(rival) == []


def test_wrong_sequence_too_many_and_unknown_kinds() -> None:
    ardupilot = Station(endpoint_of(Flavour.ARDUPILOT))
    ardupilot.send(count(3), item(2))
    assert acknowledgements(ardupilot) == [(mavlink.MAV_MISSION_INVALID_SEQUENCE, MISSION)]
    station = Station(endpoint_of(Flavour.PX4))
    station.send(count(3), item(2))
    assert acknowledgements(station) == []
    station.send(mavlink.MAVLink_mission_ack_message(1, 1, mavlink.MAV_MISSION_OPERATION_CANCELLED, MISSION))
    station.send(count(60_000))
    assert acknowledgements(station) == [(mavlink.MAV_MISSION_NO_SPACE, MISSION)]
    station.forget()
    station.send(count(1, 7))
    station.send(mavlink.MAVLink_mission_request_list_message(1, 1, 7))
    station.send(mavlink.MAVLink_mission_clear_all_message(1, 1, 7))
    station.send(mavlink.MAVLink_mission_request_partial_list_message(1, 1, 0, 1, MISSION))
    assert acknowledgements(station) == [(mavlink.MAV_MISSION_UNSUPPORTED, 7)] * 3 + [
        (mavlink.MAV_MISSION_UNSUPPORTED, MISSION)
    ]
    station.forget()
    station.send(mavlink.MAVLink_mission_request_int_message(1, 1, 99, MISSION))
    assert acknowledgements(station) == [(mavlink.MAV_MISSION_INVALID_SEQUENCE, MISSION)]


@pytest.mark.parametrize("flavour", Flavour)
def test_clear_all_clears_all(flavour: Flavour) -> None:
    station = Station(endpoint_of(flavour))
    upload(station, [item(0), item(1)])
    upload(station, fence(), FENCE)

    store = station.endpoint.vehicle.parameters
    names = [name for name in ("MIS_TOTAL", "FENCE_TOTAL") if name in store]  # ArduPilot's
    assert [store[name] for name in names] == [2, 3][: len(names)]
    station.send(mavlink.MAVLink_mission_clear_all_message(1, 1, MISSION))
    assert [store[name] for name in names] == [0, 3][: len(names)]
    assert (len(download(station)), len(download(station, FENCE))) == (0, 3)
    station.send(mavlink.MAVLink_mission_clear_all_message(1, 1, EVERYTHING))
    assert acknowledgements(station)[-1] == (ACCEPTED, EVERYTHING)
    assert download(station, FENCE) == []


def test_item_0_of_ardupilot_is_home() -> None:
    station = Station(endpoint_of(Flavour.ARDUPILOT))
    station.wait_for_position()
    (home,) = download(station)
    told = station.endpoint.vehicle.autopilot.home
    assert told is not None
    assert (home.x, home.y) == (round(told.lat_deg * 1e7), round(told.lon_deg * 1e7))
    upload(station, [item(0, x=0, y=0), item(1)])
    items = download(station)
    assert [(m.seq, m.x) for m in items] == [(0, home.x), (1, LAT + 100)]
    # Older clients ask in the float form.
    station.send(mavlink.MAVLink_mission_request_message(1, 1, 1, MISSION))
    old = station.last("MISSION_ITEM")
    assert (old.x, old.y) == pytest.approx(((LAT + 100) * 1e-7, LON * 1e-7), abs=1e-5)


def test_items_in_the_float_form() -> None:
    station = Station(endpoint_of(Flavour.PX4))
    station.send(count(1))
    station.send(mavlink.MAVLink_mission_item_message(1, 1, 0, 3, 16, 0, 1, 0, 0, 0, 0, 47.5, 8.5, 10.0, MISSION))
    assert acknowledgements(station) == [(ACCEPTED, MISSION)]
    (only,) = download(station)
    assert (only.x, only.y) == (475_000_000, 85_000_000)
    station.send(count(1))
    nan = float("nan")
    station.send(mavlink.MAVLink_mission_item_message(1, 1, 0, 3, 16, 0, 1, 0, 0, 0, 0, nan, 8.5, 10.0, MISSION))
    assert acknowledgements(station)[-1] == (mavlink.MAV_MISSION_INVALID_PARAM5_X, MISSION)


def test_the_current_item() -> None:
    station = Station(endpoint_of(Flavour.PX4))
    upload(station, [item(seq) for seq in range(3)])
    station.send(mavlink.MAVLink_mission_set_current_message(1, 1, 2))
    current = station.last("MISSION_CURRENT")
    assert (current.seq, current.total) == (2, 3)
    station.send(mavlink.MAVLink_mission_set_current_message(1, 1, 77))
    assert station.last("MISSION_CURRENT").seq == 2
    set_current = mavlink.MAV_CMD_DO_SET_MISSION_CURRENT
    assert station.command(set_current, 1) == mavlink.MAV_RESULT_ACCEPTED
    assert station.command(set_current, 77) == mavlink.MAV_RESULT_DENIED
    assert station.request(mavlink.MAVLINK_MSG_ID_MISSION_CURRENT) == mavlink.MAV_RESULT_ACCEPTED
    assert station.last("MISSION_CURRENT").seq == 1


def test_guided_go_to_of_older_clients() -> None:
    station = Station(endpoint_of(Flavour.ARDUPILOT))
    station.take_off(8.0)
    home = station.endpoint.vehicle.autopilot.home
    assert home is not None
    lat, lon = home.lat_deg + 1e-4, home.lon_deg
    go_to = mavlink.MAVLink_mission_item_message(1, 1, 0, 3, 16, 2, 1, 0, 0, 0, 0, lat, lon, 8.0, MISSION)
    before = station.endpoint.vehicle.estimate.position_ned_m[0]
    station.send(go_to)
    assert acknowledgements(station) == [(ACCEPTED, MISSION)]
    station.wait_until(lambda: station.endpoint.vehicle.estimate.position_ned_m[0] > before + 9.0, within_s=30.0)
    station.set_mode(Mode.LAND)
    station.forget()
    station.send(go_to)
    assert acknowledgements(station) == [(mavlink.MAV_MISSION_ERROR, MISSION)]
