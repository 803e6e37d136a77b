"""The program as its users meet it: options, faults in one line, announcements, signals."""

import errno
import io
import os
import signal
import socket
import subprocess
import sys
from contextlib import closing
from math import cos, radians, sin
from typing import Any

import pytest
from pymavlink.dialects.v20 import ardupilotmega as mavlink

from tests.support.vehicle_program import running
from vehicle_sim import cli
from vehicle_sim.cli.command_line import build_parser, with_negative_values
from vehicle_sim.protocol.endpoint import Endpoint
from vehicle_sim.server import fleet


def port_of(address: str) -> int:
    return int(address.rpartition(":")[2])


@pytest.mark.parametrize(
    "options",
    [
        ["--wind", "strong"],
        ["--wind", "nan,1"],
        ["--wind", "-3@90"],
        ["--wind", "99,0"],
        ["--gusts", "-1"],
        ["--drag", "0"],
        ["--drag", "6"],
        ["--gains", "mine"],
        ["--home", "47,8"],
        ["--home", "91,8,0"],
        ["--home", "47,8,inf"],
        ["--seed", "-1"],
        ["--seed", "1.5"],
        ["--sysid", "0"],
        ["--sysid", "256"],
        ["--speed", "0"],
        ["--speed", "nan"],
        ["--patience", "-1"],
        ["--patience", "61"],
        ["--flavour", "betaflight"],
        ["--listen", "udpout:127.0.0.1:14550"],
        ["--connect", "udpin:127.0.0.1:14550"],
        ["--listen", "14550"],
        ["--listen", "udpin:no-such-host.invalid:0"],
        ["--no-such-option"],
        ["--count", "0"],
        ["--count", "3", "--sysid", "254"],
        ["--spacing", "-1"],
        ["--component-id", "256"],
        ["--signing-key", "/there/is/none"],
        ["--listen", "udpin:127.0.0.1:0,signing=required"],
        ["--listen", "udpin:127.0.0.1:0,signing=often"],
        ["--connect", "serial:/dev/there-is-none:57600"],
        ["--count", "2", "--connect", "serial:/dev/ttyS0:57600"],
    ],
)
def test_faults_are_one_line_and_exit_code_2(options: list[str], capsys: pytest.CaptureFixture[str]) -> None:
    try:
        code = cli.main(["--no-ground-station", *options])
    except SystemExit as stop:
        code = int(stop.code or 0)
    said = capsys.readouterr()
    assert code == 2
    assert said.out == ""
    assert said.err.startswith("vehicle-sim: ")
    assert said.err.count("\n") == 1


def test_a_name_cannot_colour_the_terminal(capsys: pytest.CaptureFixture[str]) -> None:
    assert cli.main(["--faults", "no\x1b[31m\u202e\nsuch"]) == 2
    assert capsys.readouterr().err.startswith("vehicle-sim: cannot read no\\x1b[31m\\u202e\\nsuch: ")


def test_help_and_version(capsys: pytest.CaptureFixture[str]) -> None:
    for option, words in (("--help", "--no-ground-station"), ("--version", "vehicle-sim ")):
        with pytest.raises(SystemExit) as stop:
            cli.main([option])
        assert stop.value.code == 0
        assert words in capsys.readouterr().out


def test_help_loads_nothing_heavy() -> None:
    code = (
        "import sys, vehicle_sim.cli as cli\n"
        "try: cli.main(['--help'])\n"
        "except SystemExit: pass\n"
        "print(sorted({'numpy', 'scipy', 'filterpy', 'pymavlink'} & set(sys.modules)))"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)  # noqa: S603
    assert done.stdout.rstrip().endswith("[]")


@pytest.mark.parametrize(
    ("text", "north", "east"), [("3,1", 3.0, 1.0), ("-3,-1", -3.0, -1.0), ("4@270", 0.0, 4.0), ("2@0", -2.0, 0.0)]
)
def test_wind_blows_where_the_user_says(text: str, north: float, east: float) -> None:
    options = build_parser().parse_args(with_negative_values(["--wind", text]))
    speed, from_deg = options.wind
    assert -speed * cos(radians(from_deg)) == pytest.approx(north, abs=1e-9)
    assert -speed * sin(radians(from_deg)) == pytest.approx(east, abs=1e-9)


def test_homes_south_of_the_equator() -> None:
    options = build_parser().parse_args(with_negative_values(["--home", "-33.9,151.2,20"]))
    assert options.home == (-33.9, 151.2, 20.0)


def test_links_without_options_are_those_that_users_know() -> None:
    for flavour, expected in (
        ("ardupilot", ["tcpin:127.0.0.1:5760", "udpout:127.0.0.1:14550"]),
        ("px4", ["udpin:127.0.0.1:14580", "udpout:127.0.0.1:14540", "udpout:127.0.0.1:14550"]),
    ):
        links = cli._links(build_parser().parse_args(["--flavour", flavour]))
        assert [str(address) for address, _, _ in links] == expected
    asked = cli._links(build_parser().parse_args(["--listen", "udpin:127.0.0.1:0", "--no-ground-station"]))
    assert [str(address) for address, _, _ in asked] == ["udpin:127.0.0.1:0"]


def test_it_announces_its_ports_answers_there_and_ends_on_a_signal() -> None:
    options = [
        "--no-ground-station",
        "--listen",
        "udpin:127.0.0.1:0",
        "--listen",
        "tcpin:127.0.0.1:0",
        "--sysid",
        "9",
        "--speed",
        "10",
    ]
    with running(*options) as (process, addresses):
        assert [address.partition(":")[0] for address in addresses] == ["udpin", "tcpin"]
        parser = mavlink.MAVLink(None)
        with closing(socket.create_connection(("127.0.0.1", port_of(addresses[1])), timeout=20.0)) as client:
            beat = None
            while beat is None:
                beat = next(iter(parser.parse_buffer(client.recv(4096)) or ()), None)
            assert beat.get_srcSystem() == 9
        process.send_signal(signal.SIGTERM)
        assert process.wait(20.0) == 0


@pytest.mark.skipif(os.name == "nt", reason="SIGINT cannot be sent to one process there")
def test_ctrl_c_ends_it_cleanly() -> None:
    with running("--no-ground-station", "--listen", "udpin:127.0.0.1:0") as (process, _addresses):
        process.send_signal(signal.SIGINT)
        assert process.wait(20.0) == 0
        assert process.stderr is not None
        assert process.stderr.read() == ""


class Full(io.StringIO):
    def write(self, _text: str) -> int:
        raise OSError(errno.ENOSPC, "No space left on device")


def test_it_ends_cleanly_before_it_has_begun_whoever_hears_it(monkeypatch: pytest.MonkeyPatch) -> None:
    made, before = fleet.fleet_of, signal.getsignal(signal.SIGTERM)

    def told_to_end(*args: Any, **options: Any) -> list[Endpoint]:  # noqa: ANN401 - passed on
        signal.raise_signal(signal.SIGTERM)
        return made(*args, **options)

    monkeypatch.setattr(fleet, "fleet_of", told_to_end)
    monkeypatch.setattr("sys.stderr", Full())
    assert cli.main(["--no-ground-station", "--listen", "udpin:127.0.0.1:0"]) == 0
    assert signal.getsignal(signal.SIGTERM) == before


def test_a_ground_station_sees_it_and_it_ends_with_its_parent() -> None:
    with closing(socket.socket(socket.AF_INET, socket.SOCK_DGRAM)) as station:
        station.bind(("127.0.0.1", 0))
        station.settimeout(20.0)
        where = f"udpout:127.0.0.1:{station.getsockname()[1]}"
        options = ["--listen", "udpin:127.0.0.1:0", "--ground-station", where, "--exit-with-parent"]
        with running(*options) as (process, _addresses):
            heard = {mavlink.MAVLink(None).parse_buffer(station.recv(4096))[0].get_type() for _ in range(10)}
            assert "HEARTBEAT" in heard  # beside what it says as it starts
            assert process.stdin is not None
            process.stdin.close()
            assert process.wait(20.0) == 0
            assert process.stderr is not None
            assert process.stderr.read() == ""
            process.stdin = None


def test_a_taken_port_that_was_asked_for_is_a_fault(capsys: pytest.CaptureFixture[str]) -> None:
    with closing(socket.create_server(("127.0.0.1", 0))) as taken:
        port = taken.getsockname()[1]
        assert cli.main(["--listen", f"tcpin:127.0.0.1:{port}", "--no-ground-station"]) == 2
    assert str(port) in capsys.readouterr().err


def test_ports_are_open_before_the_library_of_the_estimator_is_loaded() -> None:
    code = "import sys, vehicle_sim.server.fleet; print({'filterpy', 'scipy.stats', 'mission'} & set(sys.modules))"
    told = subprocess.run([sys.executable, "-c", code], capture_output=True, check=True, text=True)  # noqa: S603
    assert told.stdout == "set()\n"
