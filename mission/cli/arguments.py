"""The command line of ``mission``: its commands, their options, and what values they take."""

import argparse
import math
import re
import sys
from collections.abc import Sequence
from difflib import get_close_matches
from importlib import import_module
from typing import NoReturn

from mission.errors import GeometryError
from mission.geometry.geodesy import LatLon
from mission.printable import printable
from mission.spec.model import MOST_LAPS, UNTIL_STOPPED

PROGRAM = "mission"
_DIGITS = 18
_MOST_ID = 255
_INVALID = re.compile(r"invalid choice: '(.*)' \(choose from (.*)\)$", re.DOTALL)
_EXIT_CODES = """\
exit codes:
  0  done; for a flight: the specification was achieved
  1  flown, but the specification was not achieved; for verify: not proved, or not known to be achieved; for two
     automata: not equivalent
  2  a file, a formula or an option cannot be used
  3  no plan exists
  4  the link or the vehicle failed

first steps:
  mission check missions/survey.yaml
  mission plan missions/survey.yaml --pictures pictures
  mission fly missions/survey.yaml
"""
_SCHEMA = """\
Print the JSON Schema of mission files. With it, editors complete and check a mission while it is written:

  mission schema > mission.schema.json

and, as the first line of a mission file beside it, for editors that use the YAML language server:

  # yaml-language-server: $schema=mission.schema.json
"""
_IMPORT = """\
Write a mission file from what other programs have drawn: GeoJSON, KML and KMZ, GPX, plans of QGroundControl, waypoint
and fence files of ArduPilot's ground stations. It is planned before it is written, and where there is no plan, that is
said here and in its first lines (exit code 3); its comments ask what the drawing does not tell.
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
_VERIFY = """\
Judge each claim of a written plan:

  mission verify plan.json

or judge a flight by its log, whoever flew it and with what:

  mission verify --mission survey.yaml --flight flight.tlog

Logs are telemetry logs of ground stations (.tlog), DataFlash logs of ArduPilot (.bin), ULogs of PX4 (.ulg, with the
extra `ulog`) and records of this program, packed by gzip or not. The verdict is three-valued: what a log leaves open is
said to be so, with the time.
"""
_EXPORT = """\
Write a plan for autopilots to fly by themselves (.plan of QGroundControl with geofence and rally points, .waypoints of
all ground stations), or for looking at (.geojson, .kml, .kmz, .gpx): the path on straight legs, which satisfy the
mission like the path itself.
"""
_ADDRESSES = """\
addresses:
  udpin:0.0.0.0:14550      wait there for a vehicle that calls (ArduPilot's and PX4's simulators do)
  udpout:192.168.4.1:14550 call a vehicle
  tcp:127.0.0.1:5760       call one over TCP (tcpin:HOST:PORT waits for one)
  serial:/dev/ttyUSB0:57600
"""


class _Parser(argparse.ArgumentParser):
    """Says of a word that is none of those to choose from which one is like it."""

    def error(self, message: str) -> NoReturn:
        wrong = _INVALID.search(message)
        likely = get_close_matches(wrong[1], re.findall(r"[\w-]+", wrong[2]), 1) if wrong else []
        super().error(printable(f"{message}; did you mean {likely[0]}?" if likely else message))


class _Version(argparse.Action):
    """Looks the version up when it is asked for: reading the metadata of packages is slow."""

    def __call__(self, parser: argparse.ArgumentParser, *_: object) -> NoReturn:
        version = import_module("importlib.metadata").version("ltl-mission")
        sys.stdout.write(f"{PROGRAM} {version}\n")
        parser.exit()


def build_parser() -> argparse.ArgumentParser:
    """Build the parser of the whole program."""
    parser = _Parser(
        prog=PROGRAM,
        description="Plan drone missions written in linear temporal logic, prove the plan, and fly it over MAVLink.",
        epilog=_EXIT_CODES,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("--version", action=_Version, nargs=0, help="show the version and exit")
    commands = parser.add_subparsers(title="commands", dest="command", metavar="COMMAND")

    check = commands.add_parser("check", help="report every fault of mission files, without flying")
    check.add_argument("files", nargs="+", metavar="FILE", help="mission file (YAML)")

    commands.add_parser(
        "schema",
        help="print the JSON Schema of mission files, for editors",
        description=_SCHEMA,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )

    automaton = commands.add_parser(
        "automaton", help="show the Büchi automaton of a formula or a file, or compare two of either"
    )
    automaton.add_argument(
        "languages",
        metavar="FORMULA",
        nargs="+",
        help="in LTL, such as 'F (a & F b) & G !c', or an automaton's file, whose name ends in .hoa; "
        "of two it is said whether they are equivalent",
    )
    forms = automaton.add_mutually_exclusive_group()
    for form, words in (("hoa", "in the Hanoi Omega-Automata format"), ("dot", "for Graphviz"), ("json", "as JSON")):
        forms.add_argument(f"--{form}", dest="form", action="store_const", const=form, help=f"print it {words}")
    forms.add_argument(
        "--generalised",
        dest="form",
        action="store_const",
        const="generalised",
        help="print the smaller generalised automaton, whose transitions accept, in that format",
    )
    automaton.set_defaults(form="table")
    automaton.add_argument("--picture", metavar="FILE", help="draw it into a file (.png, .svg, .pdf), too")

    draft = commands.add_parser(
        "import",
        help="write a mission file from areas that other programs have drawn",
        description=_IMPORT,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    draft.add_argument("files", nargs="+", metavar="FILE", help="one file or several, all for one mission")
    draft.add_argument("--out", metavar="MISSION.yaml", help="where to write it (default: standard output)")
    draft.add_argument("--force", action="store_true", help="write over a file that is there already")
    draft.add_argument("--metres", action="store_true", help="coordinates of GeoJSON are metres, whatever it says")
    draft.set_defaults(module="importing")

    plan = commands.add_parser("plan", help="plan a mission and show the plan")
    plan.add_argument("file", metavar="FILE", help="mission file (YAML)")
    _add_run(plan)
    plan.add_argument("--runs", type=_positive_whole, metavar="N", help="list the first N of the shortest runs")
    plan.add_argument("--transitions", action="store_true", help="print the full transition maps of T and A")
    plan.add_argument("--out", metavar="PLAN.json", help="write the whole plan to a file")
    plan.add_argument("--pictures", metavar="FOLDER", help="draw the plan's pictures into a folder")
    plan.add_argument("--json", action="store_true", help="print one JSON object instead of tables")

    _add_verify(
        commands.add_parser(
            "verify",
            help="judge a written plan, or any flight of which there is a log",
            description=_VERIFY,
            formatter_class=argparse.RawDescriptionHelpFormatter,
        )
    )

    _add_export(commands.add_parser("export", help="write a plan into a file of other programs", description=_EXPORT))

    fly = commands.add_parser(
        "fly",
        help="fly a mission over MAVLink and report",
        description=_FLY,
        epilog=_ADDRESSES,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    _add_flight(fly)

    calibrate = commands.add_parser(
        "calibrate",
        help="measure how a vehicle follows, by a figure of eight",
        description=_CALIBRATE,
        epilog=_ADDRESSES,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    _add_calibration(calibrate)

    report = commands.add_parser("report", help="write the report and the pictures of a flight folder again")
    report.add_argument("folder", metavar="FOLDER", help="a folder that 'mission fly' wrote")
    return parser


def with_negative_pairs(arguments: Sequence[str]) -> list[str]:
    """Join ``--wind`` or ``--at`` and a value like ``-3,1`` after it, which argparse takes for an option otherwise."""
    joined: list[str] = []
    for argument in arguments:
        if joined and joined[-1] in {"--wind", "--at"} and re.match(r"-[\d.]", argument):
            joined[-1] += f"={argument}"
        else:
            joined.append(argument)
    return joined


def _add_run(command: argparse.ArgumentParser) -> None:
    command.add_argument(
        "--run", type=_whole, metavar="I", help="take the I-th shortest run, counted from 0 (default: as in the file)"
    )


def _add_verify(verify: argparse.ArgumentParser) -> None:
    verify.add_argument("plan", nargs="?", metavar="PLAN.json", help="a plan that 'mission plan --out' wrote")
    flight = verify.add_argument_group("a flight")
    flight.add_argument("--flight", metavar="LOG", help="the log; of a flight of this program, its folder serves too")
    flight.add_argument("--mission", metavar="FILE", help="what it is judged by (default: the mission of the plan)")
    flight.add_argument(
        "--plan",
        dest="compared",
        metavar="PLAN.json",
        help="a plan of the mission: how far the flight was from its path is told, too",
    )
    flight.add_argument(
        "--system", type=_system_id, metavar="N", help="the vehicle, by its system id, of a .tlog that has several"
    )
    flight.add_argument(
        "--flight-number",
        type=_positive_whole,
        metavar="N",
        help="which flight of the log, from 1 (default: the longest)",
    )
    flight.add_argument(
        "--fastest",
        type=_positive,
        metavar="M_S",
        default=20.0,
        help="no vehicle was faster: bounds where it may have been in gaps, m/s (default: %(default)g)",
    )
    flight.add_argument("--json", action="store_true", help="print one JSON object instead of lines")


def _add_export(export: argparse.ArgumentParser) -> None:
    export.add_argument("plan", metavar="PLAN", help="a plan that 'mission plan --out' wrote, or a mission file")
    export.add_argument(
        "--to",
        required=True,
        metavar="FILE",
        help="what to write, its kind by its ending: .plan, .waypoints, .geojson, .kml, .kmz, .gpx",
    )
    export.add_argument(
        "--at",
        type=_place,
        metavar="LAT,LON",
        help="where the (0, 0) of a mission without `origin` lies, degrees",
    )
    export.add_argument(
        "--tolerance",
        type=_positive,
        metavar="M",
        help="how far the legs may be from the smooth path, metres (default: 0.2, or half the proved tube if less)",
    )
    export.add_argument(
        "--flavour",
        choices=("ardupilot", "px4"),
        default="ardupilot",
        help="what a .plan is for (default: %(default)s)",
    )
    export.add_argument("--force", action="store_true", help="write over a file that is there")


def _add_flight(fly: argparse.ArgumentParser) -> None:
    fly.add_argument("file", metavar="FILE", help="mission file (YAML)")
    _add_run(fly)
    fly.add_argument(
        "--laps", type=_laps, metavar="N", help="fly so many laps, or until-stopped (default: as in the file)"
    )
    fly.add_argument("--out", metavar="FOLDER", default="flights", help="where its folder goes (default: %(default)s)")
    fly.add_argument("--no-pictures", action="store_true", help="write the record and the report without pictures")
    _add_vehicle(fly)


def _add_calibration(calibrate: argparse.ArgumentParser) -> None:
    calibrate.add_argument(
        "file", nargs="?", metavar="FILE", help="mission file (YAML) with the place, the limits and the speed"
    )
    calibrate.add_argument("--out", metavar="TUBE.yaml", help="where the measured lines go (default: standard output)")
    calibrate.add_argument("--force", action="store_true", help="write over a file that is there already")
    _add_vehicle(calibrate)


def _add_vehicle(fly: argparse.ArgumentParser) -> None:
    fly.add_argument("--connect", metavar="ADDRESS", help="fly the vehicle at this address, see below")
    fly.add_argument(
        "--system-id",
        type=_system_id,
        metavar="N",
        help="the vehicle to fly, where several share the link (default: the first heard)",
    )
    fly.add_argument(
        "--signing-key",
        metavar="FILE",
        help="sign what is sent and hear only what is signed: 32 bytes, 64 hexadecimal digits or a passphrase",
    )
    bundled = fly.add_argument_group("the bundled vehicle (not with --connect)")
    bundled.add_argument("--speed", type=_positive, metavar="X", help="multiples of real time (default: 20)")
    bundled.add_argument("--seed", type=_seed, metavar="N", help="seed of its noise (default: 1)")
    bundled.add_argument(
        "--wind", type=_wind, metavar="WIND", help="NORTH,EAST it blows to, or SPEED@FROM_DEGREES, m/s (default: calm)"
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


def _whole(text: str) -> int:
    if not (text.isascii() and text.isdigit() and len(text) <= _DIGITS):
        raise argparse.ArgumentTypeError(f"{text!r} is not a whole number from 0")
    return int(text)


def _positive_whole(text: str) -> int:
    if not _whole(text):
        raise argparse.ArgumentTypeError("write a whole number from 1")
    return int(text)


def _system_id(text: str) -> int:
    number = _positive_whole(text)
    if number > _MOST_ID:
        raise argparse.ArgumentTypeError(f"system ids are 1 to {_MOST_ID}, {text} is not")
    return number


def _laps(text: str) -> int | str:
    if text.replace("-", "_") == UNTIL_STOPPED:
        return UNTIL_STOPPED
    laps = _positive_whole(text)
    if laps > MOST_LAPS:
        raise argparse.ArgumentTypeError(f"{text} laps are more than {MOST_LAPS}; until-stopped has no end")
    return laps


def _seed(text: str) -> int:
    if _whole(text) >= 2**32:
        raise argparse.ArgumentTypeError(f"a seed is less than 2^32, {text} is not")
    return int(text)


def _number(text: str) -> float:
    try:
        value = float(text)
    except ValueError:
        value = math.nan
    if not math.isfinite(value):
        raise argparse.ArgumentTypeError(f"{text!r} is not a finite number")
    return value


def _positive(text: str) -> float:
    value = _number(text)
    if value <= 0.0:
        raise argparse.ArgumentTypeError(f"{text} is not positive")
    return value


def _place(text: str) -> LatLon:
    latitude, separator, longitude = text.partition(",")
    if not separator:
        raise argparse.ArgumentTypeError(f"write LATITUDE,LONGITUDE in degrees, not {text!r}")
    try:
        return LatLon(_number(latitude), _number(longitude))
    except GeometryError as error:
        raise argparse.ArgumentTypeError(str(error)) from None


def _wind(text: str) -> str:
    first, separator, second = text.partition("@" if "@" in text else ",")
    if not separator:
        raise argparse.ArgumentTypeError(f"write NORTH,EAST or SPEED@FROM_DEGREES, not {text!r}")
    if _number(first) < 0.0 and separator == "@":
        raise argparse.ArgumentTypeError(f"the speed {first} is negative")
    _number(second)
    return text
