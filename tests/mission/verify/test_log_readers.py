"""Readers of logs: what they take from sound ones, and what damage costs."""

import gzip
import io
import re
import sys
from datetime import UTC, datetime
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from pymavlink.dialects.v20 import ardupilotmega as mavlink

from mission.geometry.geodesy import LatLon, place_at_offset
from mission.verify.logs.dataflash import read_dataflash
from mission.verify.logs.flights import flights_of
from mission.verify.logs.reading import LoggedFlight, read_flight
from mission.verify.logs.telemetry import Log, LogError
from mission.verify.logs.tlog import read_tlog
from mission.verify.logs.track import Track, track_of
from tests.support.commands import ROOT
from tests.support.drawn_cases import tried
from tests.support.logs import (
    HOME,
    UTC_US,
    Told,
    dataflash,
    dataflash_flight,
    entries,
    flight,
    heartbeat,
    interleaved,
    local,
    origin,
    tlog,
    world,
)

TIMES = np.linspace(30.0, 49.9, 200)
PLACES = np.column_stack((10.0 + 0.3 * np.arange(200), 5.0 + 4.0 * np.sin(0.05 * np.arange(200))))


def read(tmp_path: Path, data: bytes, **options: object) -> LoggedFlight:
    file = tmp_path / "flight.log"
    file.write_bytes(data)
    return read_flight(file, **{"origin": None, "start_m": (10.0, 5.0), **options})  # type: ignore[arg-type]


def assert_flown(track: Track, atol: float = 1e-4, offset: tuple[float, float] = (0.0, 0.0)) -> None:
    # The last report from the ground belongs to it, where nothing tells the time of a take-off better.
    first = len(track.t_s) - len(TIMES)
    assert 0 <= first <= 1
    np.testing.assert_allclose(track.t_s[first:], TIMES, atol=1e-9)
    np.testing.assert_allclose(track.position_m[first:], PLACES + np.array(offset), atol=atol)
    assert track.begins_whole
    assert track.ends_whole


def test_a_telemetry_log_of_local_positions(tmp_path: Path) -> None:
    found = read(tmp_path, tlog(flight(TIMES, PLACES)))
    assert_flown(found.track)
    assert (found.kind, found.number, found.flights, found.notes) == ("telemetry log", 1, 1, ())
    assert "start (10, 5)" in found.track.frame
    told = datetime.fromtimestamp(UTC_US // 1_000_000 + 30, UTC)
    assert found.track.clock.text(30.0) == f"{told:%H:%M:%S}.0"


def test_a_telemetry_log_of_positions_on_earth_in_a_mission_with_an_origin(tmp_path: Path) -> None:
    corner = place_at_offset(HOME, -3.0, 8.0)
    found = read(tmp_path, tlog(flight(TIMES, PLACES, world)), origin=corner)
    assert_flown(found.track, atol=0.02, offset=(3.0, -8.0))


def test_local_positions_are_placed_by_the_origin_of_their_frame(tmp_path: Path) -> None:
    corner = place_at_offset(HOME, -3.0, 8.0)
    found = read(tmp_path, tlog([origin(20.0), *flight(TIMES, PLACES)]), origin=corner)
    assert_flown(found.track, atol=0.02, offset=(3.0, -8.0))


def test_local_positions_without_an_origin_cannot_be_placed_on_earth(tmp_path: Path) -> None:
    with pytest.raises(LogError, match="GPS_GLOBAL_ORIGIN"):
        read(tmp_path, tlog(flight(TIMES, PLACES)), origin=HOME)


def test_local_positions_that_are_not_those_on_earth_give_way(tmp_path: Path) -> None:
    drifting = PLACES + np.linspace(0.0, 20.0, 200)[:, None]
    both = sorted([*flight(TIMES, drifting), *flight(TIMES, PLACES, world)], key=lambda each: each[0])
    found = read(tmp_path, tlog(both))
    assert "on Earth" in found.track.frame
    np.testing.assert_allclose(found.track.position_m[-1], PLACES[-1], atol=0.05)


def test_a_log_that_begins_with_noise_is_one_still(tmp_path: Path) -> None:
    found = read(tmp_path, b"noise" + tlog(flight(TIMES, PLACES)))
    assert_flown(found.track)
    assert found.notes == ("5 bytes of the log are no frames and were passed over",)


def test_an_origin_that_moves_in_flight_makes_the_globe_the_frame(tmp_path: Path) -> None:
    told = flight(TIMES, PLACES)
    moved = [*told[:100], origin(35.0, place_at_offset(HOME, 5.0, 0.0)), *told[100:]]
    both = sorted([origin(20.0), *moved, *flight(TIMES, PLACES, world)], key=lambda each: each[0])
    assert "on Earth" in read(tmp_path, tlog(both), origin=HOME).track.frame


def test_a_flight_elsewhere_is_refused(tmp_path: Path) -> None:
    with pytest.raises(LogError, match="km"):
        read(tmp_path, tlog(flight(TIMES, PLACES, world)), origin=LatLon(-47.0, 8.0))


def test_a_dataflash_log(tmp_path: Path) -> None:
    found = read(tmp_path, dataflash(dataflash_flight(TIMES, PLACES)))
    assert_flown(found.track, atol=1e-5)
    assert found.notes == ()


def test_the_time_of_the_day_of_a_dataflash_log_is_that_of_the_satellites(tmp_path: Path) -> None:
    # 2024-01-01 00:00:18 in GPS time, which is 00:00:00 UTC: day 1 of week 2295.
    told = [("GPS", (30_000_000, 0, 3, 86_418_000, 2295)), *dataflash_flight(TIMES, PLACES)]
    clock = read(tmp_path, dataflash(told)).track.clock
    assert clock.utc(30.0) == 1_704_067_200.0
    assert clock.text(30.0) == "00:00:00.0"


def test_a_packed_log_is_read_and_a_damaged_one_refused(tmp_path: Path) -> None:
    packed = gzip.compress(tlog(flight(TIMES, PLACES)), mtime=0)
    assert_flown(read(tmp_path, packed).track)
    with pytest.raises(LogError, match="gzip"):
        read(tmp_path, packed[: len(packed) // 2])


def test_of_both_directions_the_vehicle_counts(tmp_path: Path) -> None:
    station = mavlink.MAVLink_heartbeat_message(
        mavlink.MAV_TYPE_GCS, mavlink.MAV_AUTOPILOT_INVALID, mavlink.MAV_MODE_FLAG_SAFETY_ARMED, 0, 4, 3
    )
    heard = entries(flight(TIMES, PLACES))
    sent = entries([(28.0 + k, station) for k in range(25)], system=255, component=190)
    wrong = entries([local(29.0 + k, 500.0, 500.0) for k in range(25)], system=255, component=1)
    asked = entries([(28.0 + k, station) for k in range(25)], system=255, component=1)
    assert_flown(read(tmp_path, interleaved(heard, sent, wrong, asked)).track)


def test_of_several_vehicles_one_must_be_named(tmp_path: Path) -> None:
    other = entries(flight(TIMES, PLACES + 100.0), system=7)
    log = interleaved(entries(flight(TIMES, PLACES)), other)
    with pytest.raises(LogError, match="--system: 1, 7"):
        read(tmp_path, log)
    found = read(tmp_path, log, system=7, start_m=tuple((PLACES[0] + 100.0).tolist()))
    assert_flown(found.track, offset=(100.0, 100.0))
    assert found.notes == ("the log has other vehicles, too: 1",)
    with pytest.raises(LogError, match="those it has are of 1, 7"):
        read(tmp_path, log, system=3)


def test_messages_that_come_late_or_twice_change_nothing(tmp_path: Path) -> None:
    told = flight(TIMES, PLACES)
    late = [each for k, now in enumerate(told) for each in ((now, told[k - 30]) if k % 7 == 0 and k > 40 else (now,))]
    assert_flown(read(tmp_path, tlog(late)).track)


def test_a_clock_that_begins_anew_begins_another_flight(tmp_path: Path) -> None:
    again: list[Told] = [*flight(TIMES, PLACES), *flight(np.linspace(5.0, 9.9, 50), PLACES[:50])]
    log = tlog(again)
    longest = read(tmp_path, log)
    assert (longest.number, longest.flights) == (1, 2)
    assert_flown(longest.track)
    second = read(tmp_path, log, number=2)
    np.testing.assert_allclose(second.track.t_s[1:], np.linspace(5.0, 9.9, 50), atol=1e-9)
    with pytest.raises(LogError, match="2 flights"):
        read(tmp_path, log, number=3)


def test_several_flights_are_told_apart_by_arming_and_landing(tmp_path: Path) -> None:
    later = TIMES + 100.0
    told = [*flight(TIMES, PLACES), *flight(later[:100], PLACES[:100])]
    # Armed once more, and never in the air.
    told += [heartbeat(300.0, armed=True, flying=False), local(301.0, 0.0, 0.0, 0.0)]
    told += [heartbeat(302.0, armed=False, flying=False), local(303.0, 0.0, 0.0, 0.0)]
    found = read(tmp_path, tlog(told), number=2)
    assert found.flights == 2
    assert (found.track.t_s[0], found.track.t_s[-1]) == pytest.approx((later[0] - 0.1, later[99]))


def test_a_log_that_begins_or_ends_in_the_air_is_no_whole_flight(tmp_path: Path) -> None:
    told = flight(TIMES, PLACES)
    ended = read(tmp_path, tlog(told[:100])).track
    assert ended.begins_whole
    assert not ended.ends_whole
    begun = read(tmp_path, tlog([heartbeat(34.0, armed=True, flying=True), *told[60:]])).track
    assert begun.ends_whole
    assert not begun.begins_whole


def test_without_a_word_of_landing_heights_tell_of_the_ends(tmp_path: Path) -> None:
    mode = mavlink.MAV_MODE_FLAG_SAFETY_ARMED
    armed = (28.0, mavlink.MAVLink_heartbeat_message(2, mavlink.MAV_AUTOPILOT_PX4, mode, 0, 4, 3))
    told = [(t_s, m) for t_s, m in flight(TIMES, PLACES) if m.get_type() != "HEARTBEAT"]
    whole = read(tmp_path, tlog([armed, *told])).track
    assert (whole.begins_whole, whole.ends_whole) == (True, True)
    in_air = read(tmp_path, tlog([armed, *told[5:-20]])).track
    assert (in_air.begins_whole, in_air.ends_whole) == (False, False)


def test_who_tells_of_landings_is_not_asked_whether_it_is_active(tmp_path: Path) -> None:
    told = flight(TIMES, PLACES)
    ground, air = (mavlink.MAVLink_extended_sys_state_message(0, state) for state in (1, 2))
    # Active from arming on, in the air a second after the first report.
    armed = [heartbeat(t_s, armed=True, flying=True) for t_s in (29.0, 40.0)]
    disarmed = [heartbeat(t_s, armed=False, flying=False) for t_s in (28.0, 51.0)]
    active = [*armed, *disarmed, *(each for each in told if each[1].get_type() != "HEARTBEAT")]
    both = sorted([*active, (29.0, ground), (31.01, air), (48.01, ground)], key=lambda each: each[0])
    track = read(tmp_path, tlog(both)).track
    assert (track.t_s[0], track.t_s[-1]) == pytest.approx((31.0, 48.0))


def test_a_vehicle_that_never_flew_has_no_flight(tmp_path: Path) -> None:
    ground = [heartbeat(1.0, armed=False, flying=False), local(2.0, 0.0, 0.0, 0.0), local(3.0, 0.0, 0.0, 0.0)]
    with pytest.raises(LogError, match="never armed"):
        read(tmp_path, tlog(ground))
    armed = [local(0.5, 0.0, 0.0, 0.0), heartbeat(1.0, armed=True, flying=False), local(2.0, 0.0, 0.0, 0.0)]
    with pytest.raises(LogError, match="stayed on the ground"):
        read(tmp_path, tlog(armed))


def test_a_log_without_positions_says_which_are_missing(tmp_path: Path) -> None:
    with pytest.raises(LogError, match="LOCAL_POSITION_NED"):
        read(tmp_path, tlog([heartbeat(float(k), armed=True, flying=True) for k in range(9)]))
    with pytest.raises(LogError, match="XKF1"):
        read(tmp_path, dataflash([("EV", (1_000_000, 28)), ("EV", (2_000_000, 18))]))


@pytest.mark.parametrize("data", [b"", b"\0", b"hello, world\n" * 100, b"\x7fELF" + bytes(5000)])
def test_what_is_no_log_is_refused(tmp_path: Path, data: bytes) -> None:
    with pytest.raises(LogError, match="no log"):
        read(tmp_path, data)


def test_files_of_px4_name_the_extra_that_reads_them(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "pyulog", None)
    with pytest.raises(LogError, match="extra `ulog`"):
        read(tmp_path, b"ULog\x01\x12\x35\x01" + bytes(100))


def test_a_ulog_that_is_cut_ends_in_the_air(tmp_path: Path) -> None:
    data = gzip.decompress((ROOT / "tests" / "golden" / "logs" / "px4_survey.ulg.gz").read_bytes())
    found = read(tmp_path, data[: len(data) // 2])
    assert found.track.begins_whole
    assert not found.track.ends_whole
    with pytest.raises(LogError):
        read(tmp_path, data[:300])


TLOG = tlog(flight(TIMES, PLACES))
FORMATS = len(dataflash([]))
DATAFLASH = dataflash(dataflash_flight(TIMES, PLACES))
KNOWN = {(round(t_s, 3), *np.round(place, 4)) for t_s, place in zip(TIMES.tolist(), PLACES.tolist(), strict=True)}


def rows_of(log: object) -> set[tuple[float, ...]]:
    found = [boot.local_rows for boot in log.boots]  # type: ignore[attr-defined]
    return {
        (round(t_s, 3), *np.round((east, north), 4)) for rows in found for t_s, north, east, down in rows if down < -1.0
    }


@tried(40)
@given(st.integers(0, len(TLOG) - 1), st.binary(max_size=60), st.integers(0, 200), st.booleans())
def test_damage_costs_what_is_damaged_and_no_more(at: int, noise: bytes, lost: int, is_tlog: bool) -> None:  # noqa: FBT001
    whole = TLOG if is_tlog else DATAFLASH
    at = min(at, len(whole) - 1)
    # What the messages of a DataFlash log mean is said at its beginning.
    at = at if is_tlog else max(at, FORMATS)
    damaged = whole[:at] + noise + whole[at + lost :]
    try:
        log = read_tlog(io.BytesIO(damaged), None) if is_tlog else read_dataflash(io.BytesIO(damaged))
    except LogError:
        assert len(damaged) < 1000
        return
    found = rows_of(log)
    assert found <= KNOWN
    # Of a frame, 48 bytes here, each byte that is lost or added may cost two, and one beside.
    assert len(found) >= len(KNOWN) - (lost + len(noise)) / 20.0 - 8.0


@tried(40)
@given(st.integers(0, len(TIMES) - 1), st.integers(3, 23), st.integers(1, 255))
def test_a_damaged_byte_of_a_dataflash_message_costs_that_message_alone(row: int, byte: int, flipped: int) -> None:
    # Nothing checks these messages: a time may be anything, and so may a place.
    begins = [found.start() for found in re.finditer(rb"\xa3\x95\x40", DATAFLASH[FORMATS:])]
    damaged, at = bytearray(DATAFLASH), FORMATS + begins[1 + row]
    damaged[at + byte] ^= flipped
    (boot,) = [boot for boot in read_dataflash(io.BytesIO(bytes(damaged))).boots if boot.local]
    (found,) = flights_of(Log("", (boot,)))
    track = track_of(found, None, (10.0, 5.0))
    sound = {(round(t_s, 3), *np.round(place, 3)) for t_s, place in zip(track.t_s, track.position_m, strict=True)}
    known = {(round(t_s, 3), *np.round(place, 3)) for t_s, place in zip(TIMES, PLACES, strict=True)}
    shifted = 1 if row == 0 else len(known - sound)  # where the first is damaged, the place of take-off is
    assert shifted <= 1
    assert len(sound - known) <= 1 or row == 0


def test_a_long_pause_of_a_log_is_a_gap(tmp_path: Path) -> None:
    later = np.concatenate((TIMES[:100], TIMES[100:] + 500.0))
    found = read(tmp_path, dataflash(dataflash_flight(later, PLACES)))
    assert found.flights == 1
    np.testing.assert_allclose(found.track.t_s, later, atol=1e-6)


def test_an_hour_at_fifty_hertz_is_read_in_pieces() -> None:
    class Counting(io.BytesIO):
        largest = 0

        def read(self, size: int | None = -1) -> bytes:
            self.largest = max(self.largest, len(self.getvalue()) if size is None or size < 0 else size)
            return super().read(size)

    stream = Counting(TLOG * 60)
    read_tlog(stream, None)
    assert stream.largest <= 1 << 20


def test_flights_of_a_log_that_tells_nothing_of_arming_are_one() -> None:
    told = [local(float(t_s), *place) for t_s, place in zip(TIMES.tolist(), PLACES.tolist(), strict=True)]
    (one,) = flights_of(read_tlog(io.BytesIO(tlog(told)), None))
    assert (one.begin_s, one.end_s) != (0.0, 0.0)
    assert one.duration_s == pytest.approx(TIMES[-1] - TIMES[0])
