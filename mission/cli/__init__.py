"""The program ``mission``: the commands, and the only place of the planner that prints.

Exit codes: 0 achieved, 1 flown but not achieved, 2 bad input, 3 no plan exists, 4 link or vehicle failure.
Commands are imported when they are asked for, so that ``mission --help`` stays quick.
"""

import argparse
import importlib
import sys
from collections.abc import Sequence
from importlib import metadata

from mission.errors import MissionError

_EXIT_CODES = """\
exit codes:
  0  done; for a flight: the specification was achieved
  1  flown, but the specification was not achieved
  2  the mission file, the formula or an option cannot be used
  3  no plan exists
  4  the link or the vehicle failed
"""
INTERRUPTED = 130


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(
        prog="mission",
        description="Plan drone missions written in linear temporal logic, prove the plan, and fly it over MAVLink.",
        epilog=_EXIT_CODES,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("--version", action="version", version=f"mission {metadata.version('ltl-mission')}")
    commands = parser.add_subparsers(title="commands", dest="command", metavar="COMMAND", required=True)

    check = commands.add_parser("check", help="report every fault of a mission file, without flying")
    check.add_argument("files", nargs="+", metavar="FILE", help="mission file (YAML)")

    commands.add_parser("schema", help="print the JSON Schema of mission files, for editors")

    plan = commands.add_parser("plan", help="plan a mission and show the plan")
    plan.add_argument("file", metavar="FILE", help="mission file (YAML)")
    plan.add_argument(
        "--run", type=_natural, metavar="I", help="take the I-th shortest run, from 0 (default: as the file)"
    )
    plan.add_argument("--runs", type=_natural, metavar="N", help="list the first N of the shortest runs")
    plan.add_argument("--transitions", action="store_true", help="print the full transition maps of T and A")
    plan.add_argument("--out", metavar="PLAN.json", help="write the whole plan to a file")
    plan.add_argument("--pictures", metavar="FOLDER", help="draw the plan's pictures into a folder")
    plan.add_argument("--json", action="store_true", help="print one JSON object instead of tables")

    verify = commands.add_parser("verify", help="prove a written plan again, from the plan alone")
    verify.add_argument("plan", metavar="PLAN.json", help="a plan that 'mission plan --out' wrote")

    fly = commands.add_parser(
        "fly",
        help="fly a mission over MAVLink and report",
        description="Fly a mission. Without --connect, the bundled vehicle is started on loopback and stopped again.",
    )
    fly.add_argument("file", metavar="FILE", help="mission file (YAML)")
    fly.add_argument(
        "--connect",
        metavar="ADDRESS",
        help="fly what answers at udpin:HOST:PORT, udpout:HOST:PORT, tcp:HOST:PORT or serial:DEVICE:BAUD",
    )
    fly.add_argument(
        "--run", type=_natural, metavar="I", help="take the I-th shortest run, from 0 (default: as the file)"
    )
    fly.add_argument("--out", metavar="FOLDER", default="flights", help="where its folder goes (default: %(default)s)")
    fly.add_argument("--no-pictures", action="store_true", help="write the record and the report without pictures")
    bundled = fly.add_argument_group("the bundled vehicle (not with --connect)")
    bundled.add_argument("--speed", type=_positive, metavar="X", help="multiples of real time (default: 20)")
    bundled.add_argument("--seed", type=_natural, metavar="N", help="seed of its noise (default: 0)")
    bundled.add_argument("--wind", metavar="NORTH,EAST", help="where the wind blows to, m/s (default: none)")
    bundled.add_argument("--flavour", choices=("ardupilot", "px4"), help="what it behaves like (default: ardupilot)")
    bundled.add_argument(
        "--no-ground-station", action="store_true", help="do not offer the flight to a ground station on UDP port 14550"
    )

    report = commands.add_parser("report", help="write the report and the pictures of a flight folder again")
    report.add_argument("folder", metavar="FOLDER", help="a folder that 'mission fly' wrote")
    return parser


def _natural(text: str) -> int:
    value = int(text)
    if value < 0:
        raise argparse.ArgumentTypeError("must not be negative")
    return value


def _positive(text: str) -> float:
    value = float(text)
    if not 0 < value < float("inf"):
        raise argparse.ArgumentTypeError("must be a positive number")
    return value


def main(argv: Sequence[str] | None = None) -> int:
    """Run one command and return its exit code; ``argv`` defaults to the program's own arguments."""
    arguments = _parser().parse_args(argv)
    try:
        command = importlib.import_module(f"mission.cli.{arguments.command}")
        return int(command.run(arguments))
    except MissionError as error:
        from mission.cli.screen import print_error  # noqa: PLC0415 - the terminal library is loaded when it is needed

        print_error(error)
        return error.exit_code
    except KeyboardInterrupt:
        return INTERRUPTED
    except BrokenPipeError:  # the reader of a pipe, such as `head`, has seen enough
        sys.stderr.close()
        return 0
