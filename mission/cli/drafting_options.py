"""The command line of what makes mission files: ``mission new`` and ``mission import``."""

import argparse
from collections.abc import Callable

from mission.cli.option_values import extent, positive

_NEW = """\
Write a mission file that plans. On a terminal it asks a few questions, each of which an option answers; elsewhere what
no option says is as drawn, or usual. It is planned before it is written, and what does not plan is not written. A file
that is there is kept.
"""
_IMPORT = """\
Write a mission file from what other programs have drawn: GeoJSON, KML and KMZ, GPX, plans of QGroundControl, waypoint
and fence files of ArduPilot's ground stations. It is planned before it is written, and where there is no plan, that is
said here and in its first lines (exit code 3); its comments ask what the drawing does not tell.
"""
_WISHES = (
    ("visit", "what is to be visited, by its name in the drawing; all: whatever is for nothing else"),
    ("avoid", "what is never to be entered"),
    ("home", "where the flight begins and ends"),
    ("boundary", "what the vehicle may fly in"),
)


def add_drafting(add_parser: Callable[..., argparse.ArgumentParser]) -> None:
    """Add both; ``add_parser`` adds one."""
    new = add_parser("new", help="write a mission file, from a few answers or options", description=_NEW)
    new.add_argument(
        "--from",
        dest="drawings",
        nargs="+",
        metavar="FILE",
        default=[],
        help="what draws the area: KML, GeoJSON and what else `mission import` reads",
    )
    new.add_argument(
        "--extent",
        type=extent,
        metavar="EAST,NORTH",
        help="of a rectangle, where nothing is drawn, m (default: 120,80)",
    )
    for wish, words in _WISHES:
        new.add_argument(f"--{wish}", nargs="+", metavar="NAME", default=[], help=words)
    new.add_argument("--altitude", type=positive, metavar="M", help="how high, metres (default: as drawn, or 30)")
    new.add_argument("--speed", type=positive, metavar="M_S", help="how fast, m/s (default: as drawn, or 5)")
    new.add_argument("--name", metavar="WORDS", help="of the mission (default: that of the drawing)")
    new.add_argument(
        "--out",
        metavar="MISSION.yaml",
        help="where to write it, - for standard output (default: the drawing's name, here)",
    )
    new.add_argument("--force", action="store_true", help="write over a file that is there already")

    draft = add_parser(
        "import", help="write a mission file from areas that other programs have drawn", description=_IMPORT
    )
    draft.add_argument("files", nargs="+", metavar="FILE", help="one file or several, all for one mission")
    draft.add_argument("--out", metavar="MISSION.yaml", help="where to write it (default: standard output)")
    draft.add_argument("--force", action="store_true", help="write over a file that is there already")
    draft.add_argument("--metres", action="store_true", help="coordinates of GeoJSON are metres, whatever it says")
    draft.set_defaults(module="importing")
