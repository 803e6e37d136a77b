"""The command line of ``mission``: its commands and their options; those that fly have a file of their own."""

import argparse
import re
import sys
from collections.abc import Sequence
from difflib import get_close_matches
from typing import Any, NoReturn

from mission import __version__
from mission.cli.changes import add_changes
from mission.cli.drafting_options import add_drafting
from mission.cli.examples import EXAMPLES, examples_of
from mission.cli.flight_options import add_check, add_flights, add_open, add_run
from mission.cli.option_values import add_format, offset, place, positive, positive_whole, system_id
from mission.cli.voice import add_voice
from mission.printable import printable

PROGRAM = "mission"
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

completion, in this shell and, written into ~/.bashrc or ~/.zshrc, in all to come:
  eval "$(mission --completion bash)"
"""
_SCHEMA = """\
Print the JSON Schema of mission files. With it, editors complete and check a mission while it is written:

  mission schema > mission.schema.json

and, as the first line of a mission file beside it, for editors that use the YAML language server:

  # yaml-language-server: $schema=mission.schema.json
"""
_AMEND = """\
Change the mission of a flight that another process flies, while it flies. What is left of the mission is planned with
the change from where the vehicle is, and taken over; what cannot be met is refused, and the old plan is flown on. Where
the change forbids what lies ahead on the old plan, the vehicle stops at once. FILE is a whole mission file; without it,
each line of standard input is a change:

  restrict NAME [[x, y], [x, y], [x, y]]   a restricted region more, or {centre: [x, y], radius_m: r}
  drop NAME                                a region less
  formula FORMULA                          this from now on
  laps N                                   so many laps in all
  go on                                    where the vehicle holds after a refusal: fly the old plan on
"""
_AUTOMATON = """\
Show the Büchi automaton of a formula of linear temporal logic, or of a file in the Hanoi Omega-Automata format: its
states, edges and which of them accept. Of two formulas or files it is said whether they accept the same words, and if
not, which word one accepts and the other does not.
"""
_PLAN = """\
Plan a mission and show what is flown and what is proved of it: the way, the stays and lanes, the certificate, and what
was searched. Nothing is flown. Where there is no plan, it is said which parts of the mission cannot be met together.
"""
_REPORT = """\
Write the report and the pictures of a flight again, from its folder alone; of several folders, compare the flights.
"""
_SIMULATE = """\
Run the paper's own closed loop: two integrators an axis (Eq. 5) track the smoothed path under the law of Eq. 12,
exactly, from the mission's start and velocity. Figures 8 to 10 of the paper are drawn: steering law and true states,
control signals, planned path and true trajectory.
"""
_VERIFY = """\
Judge each claim of a written plan:

  mission verify plan.json
  mission verify plan.json --mission survey.yaml    (that it is a plan of this mission, too)

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


_VIEW = """\
Show a flight that is over, moment by moment, on a page in the browser of this computer: the map with the plan, the path
that was flown and the vehicle, the automaton with its present states, what was still to be done. Of a plan, or of a
mission file that is planned first, the page shows a vehicle that is exactly where the plan says. Nothing can be
commanded here; `mission fly --view` shows a flight while it is flown. Ctrl-C ends it.
"""


class _Parser(argparse.ArgumentParser):
    """Says of a word that is none of those to choose from which one is like it, and shows examples at its end."""

    def __init__(self, **options: Any) -> None:  # noqa: ANN401 - argparse's own
        super().__init__(**{"formatter_class": argparse.RawDescriptionHelpFormatter, **options})
        command = self.prog.rpartition(" ")[2]
        if command in EXAMPLES:
            self.epilog = "\n".join(part for part in (self.epilog, examples_of(command)) if part)

    def error(self, message: str) -> NoReturn:
        wrong = _INVALID.search(message)
        likely = get_close_matches(wrong[1], re.findall(r"[\w-]+", wrong[2]), 1) if wrong else []
        super().error(printable(f"{message}; did you mean {likely[0]}?" if likely else message))


class _Version(argparse.Action):
    def __call__(self, parser: argparse.ArgumentParser, *_: object) -> NoReturn:
        sys.stdout.write(f"{PROGRAM} {__version__}\n")
        parser.exit()


class _Completion(argparse.Action):
    def __call__(self, parser: argparse.ArgumentParser, _: object, values: object, *__: object) -> NoReturn:
        from mission.cli.completion import completion  # noqa: PLC0415 - a library that this alone needs

        sys.stdout.write(f"{completion(parser, str(values))}\n")
        parser.exit()


def build_parser() -> argparse.ArgumentParser:
    """Build the parser of the whole program."""
    parser = _Parser(
        prog=PROGRAM,
        description="Plan drone missions written in linear temporal logic, prove the plan, and fly it over MAVLink.",
        epilog=_EXIT_CODES,
    )
    parser.add_argument("--version", action=_Version, nargs=0, help="show the version and exit")
    parser.add_argument(
        "--completion", action=_Completion, choices=("bash", "zsh"), help="print what makes a shell complete commands"
    )
    commands = parser.add_subparsers(title="commands", dest="command", metavar="COMMAND")

    add_check(commands.add_parser)

    schema = commands.add_parser(
        "schema", help="print the JSON Schema of mission files, for editors", description=_SCHEMA
    )
    schema.add_argument(
        "--markdown", action="store_true", help="instead, every key with unit, default and example, for people"
    )

    automaton = commands.add_parser(
        "automaton",
        help="show the Büchi automaton of a formula or a file, or compare two of either",
        description=_AUTOMATON,
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

    add_drafting(commands.add_parser)

    plan = commands.add_parser("plan", help="plan a mission and show the plan", description=_PLAN)
    plan.add_argument("file", metavar="FILE", help="mission file (YAML), - for standard input")
    add_run(plan)
    add_changes(plan, speed=True)
    plan.add_argument("--runs", type=positive_whole, metavar="N", help="list the first N of the shortest runs")
    plan.add_argument(
        "--transitions",
        action="store_true",
        help="print the triangles, the run, the full transition maps of T and A, and that of P so far as it is reached",
    )
    plan.add_argument(
        "--equations",
        action="store_true",
        help="print the field of each triangle of the run, and the conditions that it meets (the paper's Eq. 13 to 21)",
    )
    plan.add_argument("--out", metavar="PLAN.json", help="write the whole plan to a file")
    plan.add_argument("--pictures", metavar="FOLDER", help="draw the plan's pictures into a folder")
    add_format(plan)
    plan.add_argument("--json", action="store_true", help="print one JSON object instead of tables")
    plan.set_defaults(document=True)

    _add_simulate(
        commands.add_parser(
            "simulate",
            help="fly a plan with the paper's vehicle: two integrators, no sensors, no MAVLink",
            description=_SIMULATE,
        )
    )

    _add_verify(
        commands.add_parser(
            "verify",
            help="judge a written plan, or any flight of which there is a log",
            description=_VERIFY,
        )
    )

    _add_export(commands.add_parser("export", help="write a plan into a file of other programs", description=_EXPORT))

    add_flights(commands.add_parser)

    amend = commands.add_parser(
        "amend",
        help="change the mission of a flight that is under way",
        description=_AMEND,
    )
    amend.add_argument("folder", metavar="FOLDER", help="the folder of a flight that is under way")
    amend.add_argument(
        "file", nargs="?", metavar="FILE", default="-", help="a mission file, or - for lines (default: -)"
    )
    amend.add_argument(
        "--within", type=positive, metavar="S", default=60.0, help="how long to wait for an answer, s (default: 60)"
    )

    view = commands.add_parser(
        "view",
        help="show a flight that is over, or a plan, moment by moment on a page of this computer",
        description=_VIEW,
    )
    view.add_argument(
        "shown", metavar="FOLDER|PLAN|FILE", help="a folder that 'mission fly' wrote, a written plan, or a mission file"
    )
    add_open(view)

    report = commands.add_parser(
        "report",
        help="write the report and the pictures of a flight folder again, or compare flights",
        description=_REPORT,
    )
    report.add_argument(
        "folder", nargs="+", metavar="FOLDER", help="a folder that 'mission fly' wrote; several are compared in a table"
    )
    add_format(report, beside_png=True)
    add_voice(
        report,
        "each file with its size, and of several flights why each achieved what it did",
        "folder, report, and what the report shows: mission, formula, planned, certificate, flown, verdict and more; "
        "of several, flights",
    )
    return parser


def with_negative_pairs(arguments: Sequence[str]) -> list[str]:
    """Join ``--wind``, ``--at`` and their like with a value such as ``-3,1``, which argparse takes for an option."""
    joined: list[str] = []
    for argument in arguments:
        if joined and joined[-1] in {"--wind", "--at", "--off", "--start"} and re.match(r"-[\d.]", argument):
            joined[-1] += f"={argument}"
        else:
            joined.append(argument)
    return joined


def _add_simulate(simulate: argparse.ArgumentParser) -> None:
    simulate.add_argument("file", metavar="FILE", help="mission file (YAML), - for standard input")
    add_run(simulate)
    add_changes(simulate, speed=True)
    simulate.add_argument(
        "--off",
        type=offset,
        metavar="EAST,NORTH",
        default=(0.0, 0.0),
        help="how far beside the mission's start the vehicle begins, metres (default: 0,0)",
    )
    simulate.add_argument(
        "--pictures", metavar="FOLDER", default="simulated", help="where to draw (default: %(default)s)"
    )
    add_format(simulate)
    simulate.add_argument("--no-pictures", action="store_true", help="draw nothing")
    simulate.add_argument("--csv", metavar="FILE", help="write time, states, steering law and control, a row a sample")
    simulate.add_argument("--json", action="store_true", help="print one JSON object instead of lines")
    simulate.set_defaults(document=True)


def _add_verify(verify: argparse.ArgumentParser) -> None:
    verify.add_argument("plan", nargs="?", metavar="PLAN.json", help="a plan that 'mission plan --out' wrote")
    flight = verify.add_argument_group("a flight")
    flight.add_argument("--flight", metavar="LOG", help="the log; of a flight of this program, its folder serves too")
    flight.add_argument(
        "--mission",
        metavar="FILE",
        help="what it is judged by, or what PLAN.json must be of (default: what the plan says itself)",
    )
    flight.add_argument(
        "--plan",
        dest="compared",
        metavar="PLAN.json",
        help="a plan of the mission: how far the flight was from its path is told, too",
    )
    flight.add_argument(
        "--system", type=system_id, metavar="N", help="the vehicle, by its system id, of a .tlog that has several"
    )
    flight.add_argument(
        "--flight-number",
        type=positive_whole,
        metavar="N",
        help="which flight of the log, from 1 (default: the longest)",
    )
    flight.add_argument(
        "--fastest",
        type=positive,
        metavar="M_S",
        default=20.0,
        help="no vehicle was faster: bounds where it may have been in gaps, m/s (default: %(default)g)",
    )
    add_voice(
        verify,
        "what `mission plan` shows of a plan, and all that a log leaves open, not the first ten times only",
        "of a plan plan, proved, guidance and claims; of a flight achieved, reason, specification, log, word, "
        "violations, not_told, restricted, covered, wishes, laps, pictures and deviation, or parts with these where it "
        "was amended",
    )


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
        type=place,
        metavar="LAT,LON",
        help="where the (0, 0) of a mission without `origin` lies, degrees",
    )
    export.add_argument(
        "--tolerance",
        type=positive,
        metavar="M",
        help="how far the legs may be from the smooth path, metres (default: 0.2, or half the proved tube if less)",
    )
    export.add_argument(
        "--flavour",
        choices=("ardupilot", "px4"),
        default="ardupilot",
        help="what a .plan or .waypoints is for (default: %(default)s)",
    )
    export.add_argument("--force", action="store_true", help="write over a file that is there")
