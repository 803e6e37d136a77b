"""The log of each armed period, and how ground stations list and fetch it."""

from collections import Counter
from itertools import pairwise

import pytest
from pymavlink.dialects.v20 import ardupilotmega as mavlink

from tests.support.recorded import entries_of
from tests.support.station import Station, endpoint_of
from vehicle_sim.autopilot import Mode
from vehicle_sim.parameters import Flavour
from vehicle_sim.protocol import flight_log
from vehicle_sim.protocol.log_transfer import DATA_PER_STEP

BOOT_UTC_S = 1_735_689_600  # 2025-01-01 00:00 UTC


@pytest.fixture(params=Flavour)
def station(request: pytest.FixtureRequest) -> Station:
    return Station(endpoint_of(request.param))


def first_id(station: Station) -> int:
    return 1 if station.endpoint.table.flavour is Flavour.ARDUPILOT else 0


def arm_for(station: Station, seconds: float) -> None:
    assert station.command(mavlink.MAV_CMD_COMPONENT_ARM_DISARM, 1) == mavlink.MAV_RESULT_ACCEPTED
    station.run(seconds)
    assert station.command(mavlink.MAV_CMD_COMPONENT_ARM_DISARM, 0) == mavlink.MAV_RESULT_ACCEPTED
    station.run(0.1)


def listed(station: Station, start: int = 0, end: int = 0xFFFF) -> list[tuple[int, int]]:
    """Return id and size of each log in the list."""
    station.forget()
    station.send(mavlink.MAVLink_log_request_list_message(1, 1, start, end))
    station.wait_until(lambda: bool(station.of("LOG_ENTRY")), within_s=0.1)
    last = station.last("LOG_ENTRY")
    station.wait_until(lambda: station.last("LOG_ENTRY").id == last.last_log_num, within_s=1.0)
    station.run(0.1)
    return [(entry.id, entry.size) for entry in station.of("LOG_ENTRY")]


def fetched(station: Station, log_id: int, size: int, *, lose: int = 0) -> bytes:
    """Fetch a log as clients do: all of it, then what did not come; every `lose`th part is lost at first."""
    parts: dict[int, bytes] = {}
    station.forget()
    station.send(mavlink.MAVLink_log_request_data_message(1, 1, log_id, 0, 0xFFFFFFFF))
    station.wait_until(lambda: ended(station, size), within_s=size / 50_000 + 1.0)
    for place, message in enumerate(station.of("LOG_DATA")):
        if not lose or place % lose:
            parts[message.ofs] = bytes(message.data[: message.count])
    for offset in [offset for offset in range(0, size, 90) if offset not in parts]:
        station.forget()
        station.send(mavlink.MAVLink_log_request_data_message(1, 1, log_id, offset, 90))
        station.wait_until(lambda: bool(station.of("LOG_DATA")), within_s=0.1)
        (message,) = station.of("LOG_DATA")
        parts[message.ofs] = bytes(message.data[: message.count])
    station.send(mavlink.MAVLink_log_request_end_message(1, 1))
    return b"".join(parts[offset] for offset in sorted(parts))


def ended(station: Station, size: int) -> bool:
    parts = station.of("LOG_DATA")
    return bool(parts) and parts[-1].ofs + parts[-1].count >= size


def test_without_a_log_one_entry_says_so_and_no_data_come(station: Station) -> None:
    station.send(mavlink.MAVLink_log_request_list_message(1, 1, 0, 0xFFFF))
    (entry,) = station.of("LOG_ENTRY")
    assert (entry.id, entry.num_logs, entry.last_log_num, entry.size) == (0, 0, 0, 0)
    for log_id in (0, 1, 4, 0xFFFF):
        station.send(mavlink.MAVLink_log_request_data_message(1, 1, log_id, 0, 90))
    station.run(0.1)
    assert station.of("LOG_DATA") == []


def test_a_flight_is_read_back_from_its_log(station: Station) -> None:
    station.take_off(5.0)
    station.set_mode(Mode.LAND)
    station.wait_until(lambda: not station.endpoint.vehicle.autopilot.armed, within_s=40.0)
    station.run(0.1)
    texts = station.texts()
    ((log_id, size),) = listed(station)
    assert log_id == first_id(station)
    date_s = station.last("LOG_ENTRY").time_utc
    data = fetched(station, log_id, size)
    assert len(data) == size
    entries = entries_of(data)
    times = [utc_us for utc_us, _ in entries]
    assert times == sorted(times)
    assert not any(utc_us & 0b11 for utc_us in times)
    duration_s = (times[-1] - times[0]) / 1e6
    counts = Counter(message.get_type() for _, message in entries)
    for kind, hertz in (("ATTITUDE", 4), ("LOCAL_POSITION_NED", 4), ("VFR_HUD", 1), ("GPS_RAW_INT", 1)):
        assert counts[kind] == pytest.approx(hertz * duration_s, abs=1.5)
    heights_m = [-message.z for _, message in entries if message.get_type() == "LOCAL_POSITION_NED"]
    assert max(heights_m) == pytest.approx(5.0, abs=0.6)
    assert abs(heights_m[0]) < 1.0
    assert abs(heights_m[-1]) < 1.0
    for utc_us, message in entries:
        if message.get_type() == "ATTITUDE":
            assert abs(utc_us - BOOT_UTC_S * 1_000_000 - message.time_boot_ms * 1000) < 1004
    armed = [bool(m.base_mode & 128) for _, m in entries if m.get_type() == "HEARTBEAT"]
    assert armed[:-1] == [True] * (len(armed) - 1)
    assert armed[-1] is False
    assert [m.get_seq() for _, m in entries] == [place % 256 for place in range(len(entries))]
    said = [message.text for _, message in entries if message.get_type() == "STATUSTEXT"]
    assert said
    assert texts[-len(said) :] == said  # all of them, from the one that says that it is armed
    assert date_s == times[0] // 1_000_000


def test_the_list_tells_ids_sizes_and_dates(station: Station) -> None:
    station.wait_for_position()
    arms_at_s = []
    for seconds in (1.0, 2.0, 1.5):
        arms_at_s.append(station.endpoint.vehicle.time_s)
        arm_for(station, seconds)
    entries = listed(station)
    assert [log_id for log_id, _ in entries] == [first_id(station) + place for place in range(3)]
    dates = [entry.time_utc for entry in station.of("LOG_ENTRY")]
    assert [date - BOOT_UTC_S for date in dates] == [pytest.approx(at_s, abs=1.1) for at_s in arms_at_s]
    assert {(entry.num_logs, entry.last_log_num) for entry in station.of("LOG_ENTRY")} == {(3, first_id(station) + 2)}
    middle = first_id(station) + 1
    assert listed(station, middle, middle) == [entries[1]]
    assert listed(station, middle, 0xFFFF) == entries[1:]
    assert listed(station, 77, 99) == entries[2:]
    for log_id, size in entries:
        assert len(entries_of(fetched(station, log_id, size))) > 20


@pytest.mark.parametrize("lose", [2, 7])
def test_holes_are_filled(station: Station, lose: int) -> None:
    station.wait_for_position()
    arm_for(station, 3.0)
    ((log_id, size),) = listed(station)
    whole = fetched(station, log_id, size)
    assert fetched(station, log_id, size, lose=lose) == whole
    assert whole == bytes(station.endpoint.recorder.logs[0].data)


def test_a_part_past_the_end_is_empty_and_one_across_it_is_short(station: Station) -> None:
    station.wait_for_position()
    arm_for(station, 1.0)
    ((log_id, size),) = listed(station)
    for offset, count in ((size, 0), (size + 1000, 0), (0xFFFFFFFF, 0), (size - 7, 7)):
        station.forget()
        station.send(mavlink.MAVLink_log_request_data_message(1, 1, log_id, offset, 90))
        station.run(0.1)
        (part,) = station.of("LOG_DATA")
        assert (part.id, part.ofs, part.count) == (log_id, offset, count)
    station.forget()
    for unknown in (first_id(station) - 1, log_id + 1):
        if unknown >= 0:
            station.send(mavlink.MAVLink_log_request_data_message(1, 1, unknown, 0, 90))
    station.run(0.1)
    assert station.of("LOG_DATA") == []


def test_data_are_paced_and_stop_when_told(station: Station) -> None:
    station.wait_for_position()
    arm_for(station, 8.0)
    ((log_id, size),) = listed(station)
    station.forget()
    station.send(mavlink.MAVLink_log_request_data_message(1, 1, log_id, 0, 0xFFFFFFFF))
    sent = [len(station.of("LOG_DATA"))]
    for _ in range(4):
        station.endpoint.advance()
        station.collect()
        sent.append(len(station.of("LOG_DATA")))
    assert [after - before for before, after in pairwise(sent)] == [DATA_PER_STEP] * 4
    assert sent[-1] * 90 < size
    station.send(mavlink.MAVLink_log_request_end_message(1, 1))
    station.run(0.1)
    assert len(station.of("LOG_DATA")) == sent[-1]


def test_erased_logs_are_gone(station: Station) -> None:
    station.wait_for_position()
    arm_for(station, 1.0)
    arm_for(station, 1.0)
    station.send(mavlink.MAVLink_log_erase_message(1, 1))
    station.run(0.1)
    assert listed(station) == [(0, 0)]
    arm_for(station, 1.0)
    assert [log_id for log_id, _ in listed(station)] == [first_id(station)]


def test_in_flight_ardupilot_keeps_its_logs_to_itself_and_says_so_once() -> None:
    station = Station(endpoint_of(Flavour.ARDUPILOT))
    station.take_off()
    station.forget()
    for _ in range(3):
        station.send(mavlink.MAVLink_log_request_list_message(1, 1, 0, 0xFFFF))
        station.send(mavlink.MAVLink_log_request_data_message(1, 1, 1, 0, 90))
        station.send(mavlink.MAVLink_log_erase_message(1, 1))
    station.run(0.1)
    assert station.of("LOG_ENTRY") == station.of("LOG_DATA") == []
    assert station.texts() == ["Disarm for log download"]
    assert len(station.endpoint.recorder.logs) == 1


def test_in_flight_px4_sends_what_the_log_held_when_it_was_asked() -> None:
    station = Station(endpoint_of(Flavour.PX4))
    station.take_off()
    ((log_id, size),) = listed(station)
    part = fetched(station, log_id, size)[:size]
    assert entries_of(part)
    station.send(mavlink.MAVLink_log_erase_message(1, 1))
    assert listed(station)[0][1] >= size  # the log that is being written stays


def test_ardupilot_serves_one_link_at_a_time() -> None:
    station = Station(endpoint_of(Flavour.ARDUPILOT))
    other = Station(station.endpoint, "other", system_id=254)
    station.wait_for_position()
    arm_for(station, 4.0)
    ((log_id, size),) = listed(station)
    other.collect()
    other.forget()
    station.send(mavlink.MAVLink_log_request_data_message(1, 1, log_id, 0, 0xFFFFFFFF))
    other.send(mavlink.MAVLink_log_request_list_message(1, 1, 0, 0xFFFF))
    station.run(0.5)
    other.collect()
    assert other.of("LOG_ENTRY") == []
    assert other.texts() == ["Log download in progress"]
    assert listed(other) == [(log_id, size)]


def test_logs_outlive_a_reboot_and_a_closed_link_ends_its_transfer(station: Station) -> None:
    other = Station(station.endpoint, "other", system_id=254)
    station.wait_for_position()
    arm_for(station, 4.0)
    entries = listed(station)
    other.send(mavlink.MAVLink_log_request_data_message(1, 1, entries[0][0], 0, 0xFFFFFFFF))
    station.endpoint.remove_link("other")
    station.run(0.1)
    assert station.command(mavlink.MAV_CMD_PREFLIGHT_REBOOT_SHUTDOWN, 1) == mavlink.MAV_RESULT_ACCEPTED
    station.run(3.0)
    assert listed(station) == entries


def test_the_same_flight_gives_the_same_log() -> None:
    logs = []
    for _ in range(2):
        station = Station(endpoint_of(Flavour.ARDUPILOT))
        station.take_off()
        logs.append(bytes(station.endpoint.recorder.logs[0].data))
    assert logs[0] == logs[1]


def test_old_logs_make_room_and_a_long_one_goes_on_in_another(
    station: Station, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(flight_log, "MOST_BYTES", 12_000)
    monkeypatch.setattr(flight_log, "MOST_BYTES_EACH", 4_000)
    station.wait_for_position()
    finished: list[flight_log.FlightLog] = []
    station.endpoint.recorder.on_finished = finished.append
    station.take_off()
    station.run(15.0)
    logs = station.endpoint.recorder.logs
    assert 2 <= len(logs) <= 4
    assert sum(len(log.data) for log in logs) <= 12_000
    assert len(finished) == logs[-1].number - 1 > 3
    assert [log.number for log in logs] == list(range(logs[0].number, logs[-1].number + 1))
    whole = b"".join(bytes(log.data) for log in finished)
    assert [m.get_seq() for _, m in entries_of(whole)] == [n % 256 for n in range(len(entries_of(whole)))]


def test_there_are_never_more_than_so_many_logs(station: Station, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(flight_log, "MOST_LOGS", 3)
    station.wait_for_position()
    for _ in range(5):
        arm_for(station, 0.2)
    assert [log.number for log in station.endpoint.recorder.logs] == [3, 4, 5]
    assert len(listed(station)) == 3
