"""Flights of real autopilots: the readers against what is known of them, and against pymavlink's own readers."""

import gzip
from functools import cache
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from pymavlink import DFReader

from mission.spec.loader import load_mission
from mission.spec.model import MissionSpec
from mission.verify.flown.judging import Judged, judged
from mission.verify.logs.reading import LoggedFlight, read_flight
from mission.verify.logs.track import Track
from tests.support.commands import ROOT
from tests.support.drawn_cases import tried
from tests.support.gaps import contradictions, kept
from tests.support.recorded import entries_of

LOGS = ROOT / "tests" / "golden" / "logs"
WORD = ["home", "", "S1", "", "S2", "", "S3", "", "home"]

# Length in metres and time from take-off to landing in seconds, least distances to K1 and K2 in metres: of ArduCopter's
# flight 229 m at height, 0.44 m and 1.70 m were told by whoever flew it.
KNOWN = {
    "ardupilot_survey_auto.tlog.gz": (231.0, 117.0, 0.44, 1.70),
    "ardupilot_survey_auto.bin.gz": (231.0, 117.0, 0.44, 1.70),
    "px4_survey.tlog.gz": (318.0, 181.0, 14.65, 2.57),
    "px4_survey.ulg.gz": (318.0, 181.0, 14.65, 2.60),
}


def read(file: Path) -> LoggedFlight:
    return read_flight(file, origin=None, start_m=(20.0, 16.0))


@pytest.mark.parametrize("name", KNOWN)
def test_what_is_known_of_a_flight_is_found(name: str) -> None:
    length_m, lasts_s, to_k1_m, to_k2_m = KNOWN[name]
    flight = read(LOGS / name)
    track = flight.track
    assert (flight.number, flight.flights, flight.notes) == (1, 1, ())
    assert track.begins_whole
    assert track.ends_whole
    assert track.t_s[-1] - track.t_s[0] == pytest.approx(lasts_s, abs=0.5)
    assert np.hypot(*np.diff(track.position_m, axis=0).T).sum() == pytest.approx(length_m, abs=3.0)

    found = judged(survey(), track)
    assert found.achieved, found.reason
    assert [",".join(letter.regions or ()) for letter in found.word] == WORD
    nearest = {near.region: near.least_m for near in found.nearness}
    assert nearest["K1"] == pytest.approx(to_k1_m, abs=0.02)
    assert nearest["K2"] == pytest.approx(to_k2_m, abs=0.02)
    assert not found.violations


def test_the_two_logs_of_one_flight_say_the_same() -> None:
    ground, own = (read(LOGS / f"ardupilot_survey_auto.{kind}.gz").track for kind in ("tlog", "bin"))
    times = np.linspace(60.0, 160.0, 101)
    heard, logged = (
        np.column_stack([np.interp(times, track.t_s, axis) for axis in track.position_m.T]) for track in (ground, own)
    )
    assert np.hypot(*(heard - logged).T).max() < 0.1


def test_positions_of_a_dataflash_log_are_those_that_pymavlink_reads(tmp_path: Path) -> None:
    packed = LOGS / "ardupilot_survey_auto.bin.gz"
    plain = tmp_path / "flight.bin"
    plain.write_bytes(gzip.decompress(packed.read_bytes()))
    reader = DFReader.DFReader_binary(str(plain))
    rows = []
    while (message := reader.recv_match(type=["XKF1"])) is not None:
        rows.append((message.TimeUS * 1e-6, message.PE, message.PN))
    reader.data_map.close()
    reader.filehandle.close()
    oracle = np.array(rows)
    track = read(packed).track
    inside = (oracle[:, 0] >= track.t_s[0]) & (oracle[:, 0] <= track.t_s[-1])
    moved = oracle[inside, 1:] - oracle[inside][0, 1:] + (20.0, 16.0)
    np.testing.assert_array_equal(track.t_s, oracle[inside, 0])
    np.testing.assert_allclose(track.position_m, moved, atol=1e-9)


def test_positions_of_a_telemetry_log_are_those_that_pymavlink_reads() -> None:
    packed = LOGS / "ardupilot_survey_auto.tlog.gz"
    rows = np.array(
        [
            (message.time_boot_ms * 1e-3, message.y, message.x)
            for _, message in entries_of(gzip.decompress(packed.read_bytes()))
            if message.get_type() == "LOCAL_POSITION_NED"
        ]
    )
    track = read(packed).track
    inside = (rows[:, 0] >= track.t_s[0]) & (rows[:, 0] <= track.t_s[-1])
    np.testing.assert_array_equal(track.t_s, rows[inside, 0])
    np.testing.assert_allclose(np.diff(track.position_m, axis=0), np.diff(rows[inside, 1:], axis=0), atol=1e-9)


@cache
def of_ardupilot() -> tuple[Track, Judged]:
    track = read(LOGS / "ardupilot_survey_auto.tlog.gz").track
    return track, judged(survey(), track)


@cache
def survey() -> MissionSpec:
    return load_mission(ROOT / "missions" / "survey.yaml")


@tried(15)
@given(st.lists(st.tuples(st.floats(0.0, 0.98), st.floats(0.0, 0.15)), min_size=1, max_size=3))
def test_gaps_in_a_real_log_are_never_contradicted_by_all_of_it(gaps: list[tuple[float, float]]) -> None:
    track, whole = of_ardupilot()
    assert not contradictions(judged(survey(), kept(track, gaps)), whole)
