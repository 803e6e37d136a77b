"""The folder of a flight: what is in it, and that all that is in it says the same."""

import json
import shutil
from pathlib import Path

import pytest
from pymavlink import mavutil

from mission.clock import TimeOfDay
from mission.fly import FlightOptions, fly
from mission.fly.folder import FlightFolder
from mission.plan import plan_to_json
from mission.report.reading import read_record
from tests.support.commands import ran
from tests.support.lockstep import LockstepVehicle, vehicle_of
from tests.support.small_missions import SMALL, plan_of

BEGAN_US = 1_790_000_000_000_000


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Of a flight that was flown to its end."""
    plan, vehicle = plan_of(SMALL), LockstepVehicle(vehicle_of("ardupilot", seed=3))
    root = tmp_path_factory.mktemp("flights")
    with FlightFolder.begun(root, "small", TimeOfDay(vehicle, BEGAN_US).us) as kept:
        options = FlightOptions(land_when_stopped=True)
        assert fly(plan, kept.logged(vehicle), vehicle, kept, options=options).achieved
    (kept.path / "plan.json").write_text(plan_to_json(plan), encoding="utf-8")
    (kept.path / "mission.yaml").write_text(SMALL, encoding="utf-8")
    return kept.path


def test_the_log_has_both_directions_by_the_time_of_the_vehicle(folder: Path) -> None:
    log, times, senders = mavutil.mavlink_connection(str(folder / "flight.tlog")), [], set[tuple[int, str]]()
    ahead_s = []
    while (message := log.recv_match()) is not None:
        times.append(message._timestamp)
        senders.add((message.get_srcSystem(), message.get_type()))
        if message.get_type() == "LOCAL_POSITION_NED":
            ahead_s.append(message._timestamp - BEGAN_US * 1e-6 - message.time_boot_ms * 1e-3)
    log.close()
    assert {(1, "LOCAL_POSITION_NED"), (1, "HEARTBEAT"), (1, "COMMAND_ACK")} <= senders
    assert {(255, "SET_POSITION_TARGET_LOCAL_NED"), (255, "HEARTBEAT"), (255, "COMMAND_LONG")} <= senders
    assert times == sorted(times)
    assert times[0] == pytest.approx(BEGAN_US * 1e-6, abs=1.0)
    assert len(ahead_s) > 1000
    assert max(map(abs, ahead_s)) < 0.1


def test_the_log_and_the_record_are_judged_alike(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    mission = str(folder / "mission.yaml")
    of_record = ran(capsys, "verify", "--mission", mission, "--flight", str(folder), "--json")
    of_log = ran(capsys, "verify", "--mission", mission, "--flight", str(folder / "flight.tlog"), "--json")
    assert (of_record.code, of_log.code) == (0, 0)
    record, log = json.loads(of_record.out), json.loads(of_log.out)
    for same in ("achieved", "reason", "violations"):
        assert record[same] == log[same]
    assert [each["regions"] for each in record["word"]] == [each["regions"] for each in log["word"]]
    assert record["restricted"][0]["least_m"] == pytest.approx(log["restricted"][0]["least_m"], abs=0.1)


def test_events_and_the_verdict_are_those_of_the_record(folder: Path) -> None:
    lines = [json.loads(line) for line in (folder / "record.jsonl").read_text().splitlines()]
    events = [json.loads(line) for line in (folder / "events.jsonl").read_text().splitlines()]
    told = [{name: value for name, value in event.items() if name != "utc"} for event in events]
    assert told == [line for line in lines if line["kind"] in {each["kind"] for each in told}]
    series = {"header", "telemetry", "at", "setpoint", "conditions", "truth"}
    assert {line["kind"] for line in lines} - {each["kind"] for each in told} == series
    times = [event["utc"] for event in events]
    assert times == sorted(times)
    assert times[0].startswith("2026-09-21T")
    verdict = json.loads((folder / "verdict.json").read_text())
    assert verdict.pop("utc") == times[-1]
    assert verdict == read_record(folder).verdict


def test_a_folder_that_is_gone_on_with_loses_what_was_cut_and_its_verdict(folder: Path, tmp_path: Path) -> None:
    cut = shutil.copytree(folder, tmp_path / "cut")
    for name in ("record.jsonl", "events.jsonl", "flight.tlog"):
        (cut / name).write_bytes((cut / name).read_bytes()[:-7])
    size = read_record(cut).size
    clock = LockstepVehicle(vehicle_of("ardupilot"))
    with FlightFolder.reopened(cut, "small", TimeOfDay(clock, BEGAN_US).us, size) as kept:
        assert not (cut / "verdict.json").exists()
        kept.write("event", 1.0, name="again")
        kept.write("verdict", 2.0, achieved=False, reason="enough")
    assert [event.text for event in read_record(cut).events][-1] == "again"
    events = [json.loads(line) for line in (cut / "events.jsonl").read_text().splitlines()]
    assert [event["kind"] for event in events[-2:]] == ["event", "verdict"]
    assert json.loads((cut / "verdict.json").read_text())["reason"] == "enough"
    assert (folder / "flight.tlog").read_bytes().startswith((cut / "flight.tlog").read_bytes())
