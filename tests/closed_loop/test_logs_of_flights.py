"""Flights of the bundled vehicle judged by their logs: the record of this program, and what a ground station hears."""

import io
import math
import struct
from functools import cache
from itertools import groupby
from pathlib import Path

import pytest

from mission.fly import FlightOptions, fly
from mission.link.framing import split
from mission.plan import plan_to_json
from mission.report.reading import Record, parse_record
from mission.report.record import FlightRecord
from mission.verify.flown.judging import Judged, judged
from mission.verify.logs.flight_record import track_of_record
from mission.verify.logs.reading import read_flight
from tests.support.commands import ran
from tests.support.lockstep import LockstepVehicle, vehicle_of
from tests.support.small_missions import ROUNDS, SMALL, plan_of
from tests.support.steered_plans import BY_FIELDS


class HeardVehicle(LockstepVehicle):
    """Writes a telemetry log of what it says."""

    def __init__(self, flavour: str) -> None:
        super().__init__(vehicle_of(flavour, seed=3))
        self.log = bytearray()

    def receive(self, within_s: float) -> list[bytes]:
        heard = super().receive(within_s)
        for datagram in heard:
            for frame in split(datagram)[0]:
                self.log += struct.pack(">Q", 1_790_000_000_000_000 + int(self.now_s() * 1e6)) + frame.data
        return heard


_INSTANT_S = 0.1


@cache
def flown(text: str, flavour: str) -> tuple[Record, bytes, bytes]:
    """The record of the flight of a mission, the log of who heard the vehicle, and the vehicle's own."""
    vehicle, sink = HeardVehicle(flavour), io.BytesIO()
    record = FlightRecord(sink, mission="heard")
    fly(plan_of(text), vehicle, vehicle, record, options=FlightOptions(land_when_stopped=True))
    (own,) = vehicle.endpoint.recorder.logs
    return parse_record(sink.getvalue()), bytes(vehicle.log), bytes(own.data)


def word_of(found: Judged) -> list[list[str]]:
    """What was spelled for longer than an instant: a correction of the estimate may cross a border to and fro."""
    until_s = [*(letter.t_s for letter in found.word[1:]), math.inf]
    lasting = [letter for letter, end_s in zip(found.word, until_s, strict=True) if end_s - letter.t_s > _INSTANT_S]
    return [list(regions or ()) for regions, _ in groupby(letter.regions for letter in lasting)]


@pytest.mark.parametrize(
    ("text", "flavour"), [(SMALL, "px4"), (ROUNDS + BY_FIELDS, "ardupilot")], ids=["stays", "laps"]
)
def test_all_logs_say_what_was_known_in_flight(text: str, flavour: str, tmp_path: Path) -> None:
    plan = plan_of(text)
    record, *logs = flown(text, flavour)
    assert record.verdict is not None
    tracks = [track_of_record(record)]
    for log in logs:
        file = tmp_path / "heard.tlog"
        file.write_bytes(log)
        tracks.append(read_flight(file, origin=None, start_m=plan.start_m).track)
    found_in = [judged(plan.spec, track, plan=plan) for track in tracks]
    assert record.verdict["achieved"]
    letters = [letter for letter, _ in groupby(record.verdict["word"])]
    for found in found_in:
        assert found.achieved, found.reason
        assert word_of(found) == letters
        assert not found.violations
        assert found.deviation is not None
        assert found.deviation.largest_m < 1.0
        if plan.run.recurrent:
            assert found.laps == (record.verdict["laps"], plan.spec.flight.laps)
        # The flight was laid where the vehicle was armed, and is here where it took off: its estimate wanders a little.
        assert found.nearness[0].least_m == pytest.approx(found_in[0].nearness[0].least_m, abs=0.2)


def test_the_folder_of_a_flight_is_enough(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    plan = plan_of(SMALL)
    vehicle = LockstepVehicle(vehicle_of("ardupilot", seed=3))
    with FlightRecord.in_folder(tmp_path, "small") as record:
        fly(plan, vehicle, vehicle, record, options=FlightOptions(land_when_stopped=True))
    assert record.folder is not None
    (record.folder / "plan.json").write_text(plan_to_json(plan), encoding="utf-8")
    result = ran(capsys, "verify", "--flight", str(record.folder))
    assert result.code == 0, result.out + result.err
    assert result.out.startswith("flight    flight record: ")
    assert "from the planned path" in result.out


def test_a_record_of_a_flight_that_was_cut_leaves_the_rest_open() -> None:
    plan = plan_of(SMALL)
    record, *_ = flown(SMALL, "px4")
    half = len(record.track.t_s) // 2
    assert judged(plan.spec, track_of_record(record)).achieved
    stages = [event for event in record.events if event.text == "stage" and event.t_s < record.track.t_s[half]]
    cut = Record(
        record.mission,
        record.vehicle,
        type(record.track)(
            record.track.t_s[:half],
            record.track.position_m[:half],
            record.track.velocity_m_s[:half],
            record.track.attitude_rad[:half],
            record.track.stages[:half],
        ),
        record.setpoints,
        record.visits,
        tuple(stages),
        record.pictures,
        record.texts,
        None,
        cut=True,
    )
    found = judged(plan.spec, track_of_record(cut))
    assert found.achieved is None
    assert "ends in the air" in found.reason
