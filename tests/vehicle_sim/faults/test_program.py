"""Fault files as users of the programs meet them, and a bad link over a real socket."""

import socket
from contextlib import closing
from pathlib import Path

import pytest
from pymavlink.dialects.v20 import ardupilotmega as mavlink

from mission.errors import SpecError
from mission.fly import BundledVehicle, VehicleOptions
from tests.support.vehicle_program import running
from tests.vehicle_sim.cli.test_cli import port_of
from vehicle_sim import cli

BROKEN = "faults:\n- {fault: gps_los}\n- {fault: motor, rotor: 9, efficiency: 1}\n"


def test_a_broken_file_is_told_line_by_line(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    file = tmp_path / "f.yaml"
    file.write_text(BROKEN)
    assert cli.main(["--faults", str(file)]) == 2
    lines = capsys.readouterr().err.splitlines()
    assert [line.removeprefix("vehicle-sim: ").partition(" ")[0] for line in lines] == [f"{file}:2:", f"{file}:3:"]
    assert "did you mean `gps_loss`?" in lines[0]


def test_a_file_that_is_not_there_is_said(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert cli.main(["--faults", str(tmp_path / "none.yaml")]) == 2
    assert "cannot read" in capsys.readouterr().err


def test_the_bundled_vehicle_refuses_it_as_bad_input(tmp_path: Path) -> None:
    file = tmp_path / "f.yaml"
    file.write_text(BROKEN)
    with pytest.raises(SpecError, match="did you mean `gps_loss`"), BundledVehicle(VehicleOptions(faults=str(file))):
        pass


def test_a_bad_link_over_udp_repeats_every_datagram(tmp_path: Path) -> None:
    file = tmp_path / "f.yaml"
    file.write_text("faults:\n- {fault: link, duplicate: 1, up: 0}\n")
    options = ("--listen", "udpin:127.0.0.1:0", "--no-ground-station", "--speed", "20", "--faults", str(file))
    with (
        running(*options) as (_, addresses),
        closing(socket.socket(socket.AF_INET, socket.SOCK_DGRAM)) as peer,
    ):
        peer.settimeout(30.0)
        mav = mavlink.MAVLink(None, srcSystem=255, srcComponent=190)
        ping = mavlink.MAVLink_heartbeat_message(6, 8, 0, 0, 0, 3).pack(mav)
        peer.sendto(ping, ("127.0.0.1", port_of(addresses[0])))
        received = [peer.recv(4096) for _ in range(6)]
    assert received[0::2] == received[1::2]
    assert len(set(received)) == 3
