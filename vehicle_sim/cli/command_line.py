"""The options of `vehicle-sim`, their help, and how a command line is read."""

import argparse
from collections.abc import Sequence
from pathlib import Path
from typing import Final, NoReturn

from vehicle_sim.cli.fleet_options import LINKS_HELP, add_fleet_options
from vehicle_sim.cli.option_values import (
    address,
    assignment,
    connect_address,
    home,
    listen_address,
    not_negative,
    patience,
    seed,
    speed,
    system_id,
    whole,
    wind,
)
from vehicle_sim.cli.printable import printable

GROUND_STATION: Final = "udpout:127.0.0.1:14550"
USAGE_ERROR: Final = 2
_DIGITS: Final = frozenset("0123456789.")

_DESCRIPTION: Final = """\
A multicopter in software behind a MAVLink autopilot. It answers like ArduCopter, or like PX4 with --flavour px4."""

_EPILOG: Final = f"""\
links:
  udpin:HOST:PORT   wait for datagrams; each peer that speaks MAVLink is answered
  tcpin:HOST:PORT   TCP server; each connection is a link
  udpout:HOST:PORT  speak to this address from the start
  tcp:HOST:PORT     connect to this TCP server
  pty:              make a pseudo terminal and say its name, which clients open like a serial line
  serial:DEVICE:BAUD   speak over a serial line
  Port 0 takes a free one (see --announce). Without --listen and --connect there are the links that users of the two
  autopilots' own simulators know: ardupilot listens on tcpin:127.0.0.1:5760; px4 listens on udpin:127.0.0.1:14580
  and speaks to udpout:127.0.0.1:14540. A ground station on this machine's UDP port 14550 finds the vehicle in any
  case, unless --no-ground-station is given.

{LINKS_HELP}
wind:
  --wind 3,1        blows 3 m/s to the north and 1 m/s to the east
  --wind 4@270      blows 4 m/s from 270 degrees (from the west)

faults:
  A file with a list `faults`; each has `fault`, `at_s` and mostly `for_s` and `ramp_s`, in seconds of the vehicle's
  clock, counted `since` boot, arming or takeoff, and numbers of its own:
    wind, gust              north_m_s, east_m_s, up_m_s      (a gust swells and fades over for_s)
    gps_loss, gps_stuck     gps_jump: north_m, east_m, up_m  gps_drift: north_m_s, east_m_s, up_m_s
    gps_noise: noise_m      gps_lag: lag_s                   gps_satellites: count
    accelerometer_bias: x_m_s2, y_m_s2, z_m_s2               gyro_bias: x_rad_s, y_rad_s, z_rad_s
    compass_loss            compass_offset: x_gauss, y_gauss, z_gauss
    baro_loss, baro_stuck   baro_jump: up_m                  baro_drift: up_m_s
    motor: rotor (1 front, 2 right, 3 rear, 4 left), efficiency (0 to 1)
    battery: voltage_v (at rest)
    link: drop, duplicate, corrupt, reorder (likelihoods), delay_s, jitter_s; up: 0 or down: 0 spares a direction
  The same by parameter in flight: SIM_GPS1_ENABLE, SIM_ACC1_BIAS_X and so on, as in ArduPilot's simulator.

lock-step:
  With --lockstep, vehicle time stands still until those who fly have had their turn: after each 0.04 s at most, the
  vehicle sends a PING on the links of --listen and --connect, and goes on when it is answered. It stands at zero until
  somebody has answered, and goes on without those who have not answered for 30 s. A program that handles what it is
  told before it answers, as `mission` does, then flies the same flight at any speed and on any machine.

patience:
  For clients that answer no PING: at many times real time, one that the machine keeps from its turn for a moment
  misses seconds of the vehicle's time. With --patience, vehicle time stands still while the vehicle flies by setpoints
  and the newest is older than 0.15 s, or while heartbeats that have come each second of vehicle time stay away. A
  stream that does not go on within that many seconds of real time has ended: vehicle time goes on, and failsafes come
  as ever. Heartbeats that come by real time, as from a ground station, are not waited for.

examples:
  vehicle-sim
  vehicle-sim --flavour px4 --speed 5 --wind 4@270 --gusts 1
  vehicle-sim --listen udpin:127.0.0.1:14551 --no-ground-station --speed 20 --lockstep
  vehicle-sim --count 20 --spacing 8 --shared tcpin:127.0.0.1:6000
"""


def with_negative_values(arguments: Sequence[str]) -> list[str]:
    """Join an option and the coordinates after it: argparse takes `-33.9,151.2,20` for an option otherwise."""
    joined: list[str] = []
    for argument in arguments:
        if joined and joined[-1] in ("--home", "--wind") and argument[:1] == "-" and argument[1:2] in _DIGITS:
            joined[-1] += f"={argument}"
        else:
            joined.append(argument)
    return joined


class _OneLineParser(argparse.ArgumentParser):
    """Says what is wrong in one line, without the usage in front of it."""

    def error(self, message: str) -> NoReturn:
        self.exit(USAGE_ERROR, f"{self.prog}: {printable(message)} (see {self.prog} --help)\n")


class _Version(argparse.Action):
    """Prints the installed version; looked up only when it is asked for."""

    def __call__(self, parser: argparse.ArgumentParser, *_arguments: object) -> None:
        from importlib.metadata import version  # noqa: PLC0415 - reads the disk

        print(f"vehicle-sim {version('ltl-mission')}")  # noqa: T201 - what was asked for
        parser.exit()


def build_parser() -> argparse.ArgumentParser:
    """Return the parser of all options; what it reads is checked one by one."""
    parser = _OneLineParser(
        prog="vehicle-sim",
        description=_DESCRIPTION,
        epilog=_EPILOG,
        formatter_class=argparse.RawDescriptionHelpFormatter,
        allow_abbrev=False,
    )
    vehicle = parser.add_argument_group("vehicle")
    vehicle.add_argument(
        "--flavour", choices=("ardupilot", "px4"), default="ardupilot", help="autopilot to answer like (ardupilot)"
    )
    vehicle.add_argument(
        "--dynamics",
        choices=("hover", "quadrotor"),
        default="hover",
        help="linearised about hover, or the full quadrotor with its rotors (hover)",
    )
    vehicle.add_argument("--seed", type=seed, default=1, metavar="N", help="seed of all noise and gusts (1)")
    vehicle.add_argument(
        "--wind", type=wind, default=(0.0, 0.0), metavar="WIND", help="NORTH,EAST or SPEED@FROM_DEGREES in m/s (calm)"
    )
    vehicle.add_argument(
        "--gusts", type=not_negative, default=0.0, metavar="M_S", help="standard deviation of gusts, m/s (0)"
    )
    vehicle.add_argument(
        "--drag",
        type=not_negative,
        metavar="PER_S",
        help="drag over mass, level (ardupilot 0.41, px4 0.95, as in their own simulators)",
    )
    vehicle.add_argument(
        "--gains",
        choices=("observer", "px4"),
        help="how it follows: with an observer of disturbances (ardupilot), or late where drag changes, as PX4 (px4)",
    )
    vehicle.add_argument("--faults", metavar="FILE", help="what goes wrong and when: a YAML file, see below")
    vehicle.add_argument(
        "--home", type=home, metavar="LAT,LON,ALT", help="where it stands: degrees, degrees, metres above sea level"
    )
    vehicle.add_argument(
        "--parameters", type=Path, metavar="FILE", help="keep the parameters in this file (they are forgotten)"
    )
    vehicle.add_argument("--logs", type=Path, metavar="FOLDER", help="keep the log of each flight there, as .tlog")
    vehicle.add_argument(
        "--set", type=assignment, action="append", default=[], metavar="NAME=VALUE", help="a parameter, repeatable"
    )
    vehicle.add_argument(
        "--system-id", "--sysid", dest="sysid", type=system_id, metavar="N", help="MAVLink system id, 1 to 255 (1)"
    )
    vehicle.add_argument("--speed", type=speed, default=1.0, metavar="N", help="multiples of real time (1)")
    pace = vehicle.add_mutually_exclusive_group()
    pace.add_argument(
        "--lockstep", action="store_true", help="vehicle time goes on only when those who fly have had their turn"
    )
    pace.add_argument(
        "--patience",
        type=patience,
        default=0.0,
        metavar="SECONDS",
        help="above real time: how long a late client is waited for (0)",
    )
    add_fleet_options(parser, whole=whole, number=not_negative, address=address)
    links = parser.add_argument_group("links")
    links.add_argument(
        "--listen",
        type=listen_address,
        action="append",
        default=[],
        metavar="ADDRESS",
        help="udpin:, tcpin: or pty:, repeatable",
    )
    links.add_argument(
        "--connect",
        type=connect_address,
        action="append",
        default=[],
        metavar="ADDRESS",
        help="udpout:, tcp: or serial:, repeatable",
    )
    station = links.add_mutually_exclusive_group()
    station.add_argument(
        "--ground-station", type=address, metavar="ADDRESS", help=f"where the ground station is ({GROUND_STATION})"
    )
    station.add_argument("--no-ground-station", action="store_true", help="do not look for a ground station")
    process = parser.add_argument_group("process")
    process.add_argument(
        "--announce", action="store_true", help="print one line READY ADDRESS... with the ports really bound"
    )
    process.add_argument("--exit-with-parent", action="store_true", help="end when standard input is closed")
    process.add_argument("--quiet", action="store_true", help="say nothing but warnings")
    process.add_argument(
        "--modes",
        nargs="?",
        const="table",
        choices=("table", "dot", "mermaid"),
        help="print the flavour's modes and what leads where, and exit: as a table, for Graphviz, for Mermaid",
    )
    process.add_argument("--version", action=_Version, nargs=0, help="print the version and exit")
    return parser
