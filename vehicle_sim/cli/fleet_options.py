"""The options of `vehicle-sim` about several vehicles, ids, shared links and signing."""

import argparse
from collections.abc import Callable
from pathlib import Path
from typing import Any, Final

LINKS_HELP: Final = """\
several vehicles:
  --count 3 flies three, of system ids 1 to 3, in a square grid of rows from west to east. Each has the links above on
  its own ports: 10 higher for each further vehicle with the flavour ardupilot (5760, 5770, 5780), 1 higher with px4
  (14580, 14581, 14582), as those simulators number their instances; see --port-step. --shared ADDRESS opens one link
  that carries all of them. All speak to the same ground station.

signing:
  --signing-key FILE signs all that is sent with the key in the file (32 bytes, 64 hexadecimal digits, or a passphrase,
  which is hashed with SHA-256 as MAVProxy does it), and hears only what is signed with it. Addresses may differ:
  --listen udpin:0.0.0.0:14550,signing=allowed   hears what is not signed too (MAVLink 1 cannot be signed)
  --listen tcpin:127.0.0.1:5760,signing=off      neither signs nor checks
  Timestamps are kept beside the key file, so that none is ever used twice. A ground station on this machine, or one
  that holds the key, can give another key while the vehicle is disarmed (SETUP_SIGNING).
"""


def add_fleet_options(
    parser: argparse.ArgumentParser,
    *,
    whole: Callable[[str, int, int], int],
    number: Callable[[str], float],
    address: Callable[[str], Any],
) -> None:
    """Add the options, with the program's own readers of values."""
    fleet = parser.add_argument_group("several vehicles, ids, signing")
    fleet.add_argument(
        "--count", type=lambda text: whole(text, 1, 255), default=1, metavar="N", help="how many vehicles (1)"
    )
    fleet.add_argument("--spacing", type=number, default=5.0, metavar="M", help="metres between neighbours (5)")
    fleet.add_argument(
        "--port-step",
        type=lambda text: whole(text, 1, 1000),
        metavar="N",
        help="by how much the ports of the next vehicle are higher (ardupilot 10, px4 1)",
    )
    fleet.add_argument(
        "--shared",
        type=address,
        action="append",
        default=[],
        metavar="ADDRESS",
        help="a link that carries all vehicles, of any kind, repeatable",
    )
    fleet.add_argument(
        "--component-id",
        type=lambda text: whole(text, 1, 255),
        default=1,
        metavar="N",
        help="MAVLink component id of the autopilot, 1 to 255 (1)",
    )
    fleet.add_argument(
        "--signing-key", type=Path, metavar="FILE", help="sign what is sent, and hear only what is signed; see below"
    )
