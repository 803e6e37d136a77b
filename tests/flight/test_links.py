"""Flights over other links: signed, over a serial line, and of one vehicle among several that share a link."""

import os
import socket
from contextlib import closing
from pathlib import Path

import pytest
from pymavlink.dialects.v20 import ardupilotmega as mavlink

from mission.cli import main
from mission.link.identity import LinkOptions
from mission.report.reading import read_record
from tests.support.small_missions import SMALL
from tests.support.vehicle_program import running

VEHICLE = ("--no-ground-station", "--speed", "15", "--patience", "2")


@pytest.fixture
def mission_file(tmp_path: Path) -> Path:
    file = tmp_path / "small.yaml"
    file.write_text(SMALL)
    return file


@pytest.fixture
def key_file(tmp_path: Path) -> Path:
    file = tmp_path / "key"
    file.write_text("a passphrase\n")
    file.chmod(0o600)
    return file


def flown(file: Path, *options: str) -> int:
    return main(["fly", str(file), "--out", str(file.parent / "out"), "--no-pictures", *options])


def called(announced: str) -> str:
    return "udpout:" + announced.removeprefix("udpin:")


def test_a_signed_flight_of_the_bundled_vehicle(mission_file: Path, key_file: Path) -> None:
    assert flown(mission_file, "--no-ground-station", "--speed", "500", "--signing-key", str(key_file)) == 0
    kept = sorted(path.name for path in key_file.parent.glob("key.timestamp.*"))
    assert kept == ["key.timestamp.1.1", "key.timestamp.255.191"]


def test_who_does_not_hold_the_key_cannot_fly_and_changes_nothing(
    mission_file: Path, key_file: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    listen = ("--listen", "udpin:127.0.0.1:0", "--listen", "udpin:127.0.0.1:0,signing=off")
    with running(*VEHICLE, "--signing-key", str(key_file), *listen) as (process, (address, open_address)):
        monkeypatch.setattr("mission.cli.vehicle_link.LinkOptions", lambda **_options: LinkOptions(connect_s=1.0))
        assert flown(mission_file, "--connect", called(address)) == 4
        assert "no vehicle was heard" in capsys.readouterr().err
        monkeypatch.undo()
        # On the link that asks for no signatures, the vehicle tells that it stands there disarmed.
        with closing(socket.socket(socket.AF_INET, socket.SOCK_DGRAM)) as watcher:
            watcher.settimeout(20.0)
            mav = mavlink.MAVLink(None, srcSystem=254, srcComponent=190)
            beat = mavlink.MAVLink_heartbeat_message(6, 8, 0, 0, 4, 3).pack(mav)
            watcher.sendto(beat, ("127.0.0.1", int(open_address.partition(",")[0].rpartition(":")[2])))
            (first, *_) = mav.parse_buffer(watcher.recv(4096))
            assert first.get_type() == "HEARTBEAT"
            assert not first.base_mode & mavlink.MAV_MODE_FLAG_SAFETY_ARMED
        assert process.poll() is None


@pytest.mark.skipif(not hasattr(os, "openpty"), reason="this system has no pseudo terminals")
def test_a_flight_over_a_serial_line(mission_file: Path) -> None:
    with running(*VEHICLE, "--listen", "pty:") as (_process, (address,)):
        device = address.removeprefix("pty:")
        assert flown(mission_file, "--connect", f"serial:{device}:57600") == 0


def test_one_vehicle_of_three_on_a_shared_link(mission_file: Path) -> None:
    options = ("--count", "3", "--shared", "tcpin:127.0.0.1:0", "--listen", "udpin:127.0.0.1:0")
    with running(*VEHICLE, *options) as (_process, addresses):
        assert [address.partition(":")[0] for address in addresses] == ["udpin", "udpin", "udpin", "tcpin"]
        shared = addresses[-1].replace("tcpin:", "tcp:")
        assert flown(mission_file, "--connect", shared, "--system-id", "2") == 0
    (folder,) = (mission_file.parent / "out").iterdir()
    assert read_record(folder).vehicle["system_id"] == 2
