"""pymavlink's own client of MAVLink FTP, over loopback, against the program; and the logs that the program keeps."""

import signal
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest
from pymavlink import mavutil
from pymavlink.dialects.v20 import ardupilotmega as mavlink

from tests.support.recorded import entries_of
from tests.support.vehicle_program import running
from vehicle_sim.parameters import Flavour, default_parameters

mavftp = pytest.importorskip("pymavlink.mavftp")


@contextmanager
def connected(address: str) -> Iterator["mavutil.mavfile"]:
    master = mavutil.mavlink_connection(f"tcp:{address.partition(':')[2]}")
    try:
        master.mav.heartbeat_send(mavlink.MAV_TYPE_GCS, mavlink.MAV_AUTOPILOT_INVALID, 0, 0, 0)
        assert master.wait_heartbeat(timeout=20.0) is not None
        yield master
    finally:
        master.close()


def armed_and_disarmed(master: "mavutil.mavfile") -> None:
    for value in (1, 0):
        while True:
            master.mav.command_long_send(1, 1, mavlink.MAV_CMD_COMPONENT_ARM_DISARM, 0, value, *(0,) * 6)
            answer = master.recv_match(type="COMMAND_ACK", blocking=True, timeout=20.0)
            assert answer is not None
            if answer.result == mavlink.MAV_RESULT_ACCEPTED:
                break
        while bool(master.wait_heartbeat(timeout=20.0).base_mode & mavlink.MAV_MODE_FLAG_SAFETY_ARMED) is not bool(
            value
        ):
            pass  # what is armed for less than a step has no log


@pytest.mark.parametrize("flavour", Flavour)
def test_pymavlinks_client_lists_and_reads(flavour: Flavour, tmp_path: Path) -> None:
    listen = ("--listen", "tcpin:127.0.0.1:0", "--no-ground-station")
    options = ("--flavour", flavour.value, "--speed", "10", "--logs", str(tmp_path / "logs"), *listen)
    with running(*options) as (process, (address,)), connected(address) as master:
        armed_and_disarmed(master)
        client = mavftp.MAVFTP(master, 1, 1)
        folder = "/APM/LOGS" if flavour is Flavour.ARDUPILOT else "/fs/microsd/log"
        listing = client.cmd_list([folder])
        assert listing.error_code == 0
        if listing.directory_listing[0].is_dir:
            folder = f"{folder}/{listing.directory_listing[0].name}"
            listing = client.cmd_list([folder])
        (entry,) = listing.directory_listing
        copy = tmp_path / "copy.tlog"
        assert client.cmd_get([f"{folder}/{entry.name}", str(copy)]).error_code == 0
        assert client.process_ftp_reply("OpenFileRO", timeout=20).error_code == 0
        data = copy.read_bytes()
        assert len(data) == entry.size_b
        assert entries_of(data)
        if flavour is Flavour.ARDUPILOT:
            values, defaults = tmp_path / "values", tmp_path / "defaults"
            assert client.cmd_getparams([str(values), str(defaults)]).error_code == 0
            client.process_ftp_reply("OpenFileRO", timeout=20)
            names = [line.split(",")[0] for line in values.read_text().splitlines()]
            assert sorted(names) == sorted(default_parameters(flavour))
        process.send_signal(signal.SIGTERM)
        process.wait(10.0)
    (kept,) = (tmp_path / "logs").iterdir()
    assert kept.read_bytes() == data
    replayed = mavutil.mavlink_connection(str(kept))  # as whatever plays telemetry logs opens them
    messages = list(iter(replayed.recv_msg, None))
    replayed.close()
    entries = entries_of(data)
    assert [message.get_type() for message in messages] == [message.get_type() for _, message in entries]
    assert messages[-1]._timestamp == pytest.approx(entries[-1][0] * 1e-6)
