"""The command line of what is flown: ``mission fly`` and ``mission calibrate``, and the vehicle that either flies."""

import argparse
from collections.abc import Callable

from mission.cli.changes import add_changes
from mission.cli.option_values import add_format, positive, seed, system_id, whole, wind
from mission.cli.voice import add_voice

_CHECK = """\
Report every fault of mission files, and whether each has a plan. With --connect also whether the vehicle there may fly
the plan: its battery, place, limits, failsafes and more, each with its figures and what to do. It is asked for
telemetry and parameters; nothing is armed or changed.
"""
_FLY = """\
Fly a mission. Without --connect, the bundled vehicle is started on loopback and stopped again.

The flight gets a folder of its own with the record, the plan, the report and the pictures. Ctrl-C ends a flight
safely: the vehicle lands, or holds where it is not the bundled one; a second Ctrl-C ends the program at once. A flight
of laps takes one Ctrl-C more: at the first it completes the lap that it is in, and returns.
"""
_CALIBRATE = """\
Fly a figure of eight about the start at the mission's speed and within its limits, three times, and measure how far the
vehicle is from it: that is what the tube of the proof has to hold. Without a mission file it flies in an open field of
120 m; without --connect, with the bundled vehicle. Where there is no room, nothing takes off.
"""
ADDRESSES = """\
addresses:
  udpin:0.0.0.0:14550      wait there for a vehicle that calls (ArduPilot's and PX4's simulators do)
  udpout:192.168.4.1:14550 call a vehicle
  tcp:127.0.0.1:5760       call one over TCP (tcpin:HOST:PORT waits for one)
  serial:/dev/ttyUSB0:57600
"""


def add_flights(add_parser: Callable[..., argparse.ArgumentParser]) -> None:
    """Add the commands that fly; ``add_parser`` adds one."""
    for name, brief, description, add_options in (
        ("fly", "fly a mission over MAVLink and report", _FLY, _add_flight),
        ("calibrate", "measure how a vehicle follows, by a figure of eight", _CALIBRATE, _add_calibration),
    ):
        add_options(
            add_parser(
                name,
                help=brief,
                description=description,
                epilog=ADDRESSES,
            )
        )


def add_check(add_parser: Callable[..., argparse.ArgumentParser]) -> None:
    """Add the command that looks before a flight."""
    check = add_parser(
        "check",
        help="report every fault of mission files, without flying; with --connect, go or no-go",
        description=_CHECK,
        epilog=ADDRESSES,
    )
    check.add_argument("files", nargs="+", metavar="FILE", help="mission file (YAML), - for standard input")
    add_link(check, "look at")
    add_voice(
        check,
        "what `mission plan` shows of each",
        "missions (of each file, exit_code, warnings, and plan as of `mission plan --json`, or error and faults); with "
        "--connect mission, go and rows of the check",
    )


def add_run(command: argparse.ArgumentParser) -> None:
    """Add the choice among the shortest runs."""
    command.add_argument(
        "--run", type=whole, metavar="I", help="take the I-th shortest run, counted from 0 (default: as in the file)"
    )


def add_open(command: argparse.ArgumentParser) -> None:
    """Add the wish to have the page opened."""
    command.add_argument("--open", action="store_true", help="open the page in the browser, not only say where it is")


def _add_flight(fly: argparse.ArgumentParser) -> None:
    fly.add_argument("file", nargs="?", metavar="FILE", help="mission file (YAML), - for standard input")
    add_run(fly)
    fly.add_argument(
        "--resume",
        metavar="FOLDER",
        help="go on with the flight that left this folder, with its vehicle that hovers where it was left",
    )
    fly.add_argument(
        "--resume-when-handed-back",
        action="store_true",
        help="where a pilot takes the vehicle over, wait for GUIDED or OFFBOARD to be set again, and go on from there",
    )
    fly.add_argument("--out", metavar="FOLDER", default="flights", help="where its folder goes (default: %(default)s)")
    fly.add_argument(
        "--force",
        action="append",
        default=[],
        metavar="ROW",
        help="fly although this row of the check before the flight is a no-go, by its name; several times for several",
    )
    fly.add_argument(
        "--view",
        action="store_true",
        help="show the flight on a page of this computer, with buttons to hold, resume, return and land",
    )
    add_open(fly)
    fly.add_argument("--no-pictures", action="store_true", help="write the record and the report without pictures")
    add_format(fly, beside_png=True)
    fly.add_argument(
        "--fence",
        action=argparse.BooleanOptionalAction,
        default=True,
        help="let the vehicle's own geofence guard the flight, set before arming (default: it does)",
    )
    fly.add_argument("--keep-fence", action="store_true", help="leave it there; else what was there before is put back")
    add_changes(fly, speed=False)
    _add_vehicle(fly)
    add_voice(
        fly,
        "each command, answer and word of the vehicle as it comes",
        "mission, folder, report, vehicle, duration_s, elapsed_s, tube_m, and the verdict of the record: achieved, "
        "reason, ending, word, laps, largest_error_m and more",
    )


def _add_calibration(calibrate: argparse.ArgumentParser) -> None:
    calibrate.add_argument(
        "file", nargs="?", metavar="FILE", help="mission file (YAML) with the place, the limits and the speed"
    )
    calibrate.add_argument("--out", metavar="TUBE.yaml", help="where the measured lines go (default: standard output)")
    calibrate.add_argument("--force", action="store_true", help="write over a file that is there already")
    _add_vehicle(calibrate)


def add_link(command: argparse.ArgumentParser, what: str) -> None:
    """Add where the vehicle is, and which; ``what`` is done there."""
    command.add_argument("--connect", metavar="ADDRESS", help=f"{what} the vehicle at this address, see below")
    command.add_argument(
        "--system-id",
        type=system_id,
        metavar="N",
        help=f"the vehicle to {what}, where several share the link (default: the first heard)",
    )
    command.add_argument(
        "--signing-key",
        metavar="FILE",
        help="sign what is sent and hear only what is signed: 32 bytes, 64 hexadecimal digits or a passphrase",
    )


def _add_vehicle(fly: argparse.ArgumentParser) -> None:
    add_link(fly, "fly")
    bundled = fly.add_argument_group("the bundled vehicle (not with --connect)")
    bundled.add_argument("--speed", type=positive, metavar="X", help="multiples of real time (default: 20)")
    bundled.add_argument("--seed", type=seed, metavar="N", help="seed of its noise (default: 1)")
    bundled.add_argument(
        "--wind", type=wind, metavar="WIND", help="NORTH,EAST it blows to, or SPEED@FROM_DEGREES, m/s (default: calm)"
    )
    bundled.add_argument("--flavour", choices=("ardupilot", "px4"), help="what it behaves like (default: ardupilot)")
    bundled.add_argument(
        "--dynamics", choices=("hover", "quadrotor"), help="its equations of motion, see vehicle-sim (default: hover)"
    )
    bundled.add_argument(
        "--faults", metavar="FAULTS", help="what goes wrong and when: a YAML file, see vehicle-sim --help"
    )
    bundled.add_argument(
        "--no-ground-station", action="store_true", help="do not offer the flight to a ground station on UDP port 14550"
    )
