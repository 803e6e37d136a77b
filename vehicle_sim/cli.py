"""The program `vehicle-sim`: options, sockets and signals around one vehicle; the only place that prints.

What takes time to import is imported once the options are known to be good.
"""

import argparse
import os
import signal
import sys
import threading
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Final, NoReturn

from vehicle_sim.addresses import LISTENING, Address, parse_address
from vehicle_sim.errors import ConfigurationError, ParameterError
from vehicle_sim.fleet_options import LINKS_HELP, add_fleet_options
from vehicle_sim.option_values import (
    HOME_FIELDS,
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

if TYPE_CHECKING:
    from vehicle_sim.faults import Schedule
    from vehicle_sim.parameters import ParameterStore

_GROUND_STATION: Final = "udpout:127.0.0.1:14550"
_DEFAULT_LISTEN: Final = {"ardupilot": "tcpin:127.0.0.1:5760", "px4": "udpin:127.0.0.1:14580"}
_DEFAULT_CONNECT: Final = {"ardupilot": (), "px4": ("udpout:127.0.0.1:14540",)}
_PORT_STEPS: Final = {"ardupilot": 10, "px4": 1}
_USAGE_ERROR: Final = 2
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

patience:
  At many times real time, a client that the machine keeps from its turn for a moment misses seconds of the vehicle's
  time. With --patience, vehicle time stands still while the vehicle flies by setpoints and the newest is older than
  0.15 s, or while heartbeats that have come each second of vehicle time stay away. A stream that does not go on within
  that many seconds of real time has ended: vehicle time goes on, and failsafes come as ever. Heartbeats that come by
  real time, as from a ground station, are not waited for.

examples:
  vehicle-sim
  vehicle-sim --flavour px4 --speed 5 --wind 4@270 --gusts 1
  vehicle-sim --listen udpin:127.0.0.1:14551 --no-ground-station --speed 20 --patience 2
  vehicle-sim --count 20 --spacing 8 --shared tcpin:127.0.0.1:6000
"""


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the program; return its exit code: 0 ended as asked, 2 an option or address that cannot be used."""
    parser = _parser()
    options = parser.parse_args(_with_negative_values(sys.argv[1:] if arguments is None else arguments))
    if options.modes is not None:
        _show_modes(options)
        return 0
    try:
        _run(options)
    except ConfigurationError as error:
        print(f"vehicle-sim: {error}", file=sys.stderr)  # noqa: T201 - the program's own voice
        return _USAGE_ERROR
    return 0


def _with_negative_values(arguments: Sequence[str]) -> list[str]:
    """Join an option and the coordinates after it: argparse takes `-33.9,151.2,20` for an option otherwise."""
    joined: list[str] = []
    for argument in arguments:
        if joined and joined[-1] in ("--home", "--wind") and argument[:1] == "-" and argument[1:2] in _DIGITS:
            joined[-1] += f"={argument}"
        else:
            joined.append(argument)
    return joined


def _run(options: argparse.Namespace) -> None:
    # numpy, filterpy and pymavlink would make `--help` wait.
    from vehicle_sim.clock import WallClock  # noqa: PLC0415
    from vehicle_sim.dynamics.airframe import Dynamics  # noqa: PLC0415
    from vehicle_sim.faults import NO_FAULTS  # noqa: PLC0415
    from vehicle_sim.fleet import fleet_of  # noqa: PLC0415
    from vehicle_sim.key_file import KeyFile, signing_time  # noqa: PLC0415
    from vehicle_sim.log_folder import keep_logs  # noqa: PLC0415
    from vehicle_sim.parameter_file import keep_parameters  # noqa: PLC0415
    from vehicle_sim.parameters import Flavour  # noqa: PLC0415
    from vehicle_sim.party import Fleet, Party  # noqa: PLC0415
    from vehicle_sim.patience import Patience  # noqa: PLC0415
    from vehicle_sim.ports import Port, open_port  # noqa: PLC0415
    from vehicle_sim.protocol.flavour import TABLES, Rates  # noqa: PLC0415
    from vehicle_sim.server import Server  # noqa: PLC0415
    from vehicle_sim.vehicle import VehicleConfig  # noqa: PLC0415

    flavour = Flavour(options.flavour)
    speed_m_s, from_deg = options.wind
    place = {} if options.home is None else dict(zip(HOME_FIELDS, options.home, strict=True))
    config = VehicleConfig(
        seed=options.seed,
        flavour=flavour,
        dynamics=Dynamics(options.dynamics),
        wind_m_s=speed_m_s,
        wind_from_deg=from_deg,
        gust_m_s=options.gusts,
        faults=NO_FAULTS if options.faults is None else _schedule(options.faults),
        **place,
    )
    stores = [_parameters(options) for _ in range(options.count)]
    named = int(stores[0][TABLES[flavour].system_id_parameter])
    key_file = None if options.signing_key is None else KeyFile(options.signing_key, _notify)
    endpoints = fleet_of(
        config,
        parameters=stores,
        count=options.count,
        spacing_m=options.spacing,
        system_id=named if options.sysid is None else options.sysid,
        component_id=options.component_id,
        key_file=key_file,
        now=signing_time,
        notify=_notify,
    )
    if options.parameters is not None:
        keep_parameters(options.parameters, stores[0], _notify)
    if options.logs is not None:
        keep_logs(options.logs, endpoints, _notify)
    parties: list[tuple[Party, list[tuple[Address, str, bool]]]] = [
        (endpoint, _links(options, index)) for index, endpoint in enumerate(endpoints)
    ]
    if options.shared:
        parties.append((Fleet(endpoints), [(address, "GROUND_STATION", True) for address in options.shared]))
    ports: list[Port] = []
    try:
        for party, links in parties:
            for address, rates_name, is_asked in links:
                _check_signing(address, has_key=key_file is not None)
                try:
                    ports.append(open_port(address, party, Rates[rates_name], _notify))
                except ConfigurationError as error:
                    if is_asked:
                        raise
                    _notify(f"{error}; going on without it")
        bound = [port.address for port in ports]
        stopping = _stop_flag(with_parent=options.exit_with_parent)
        _tell(options, [endpoint.system_id for endpoint in endpoints], bound)
        patience = [Patience(options.patience) for _ in endpoints] if options.patience > 0.0 else []
        Server(endpoints, ports, clock=WallClock(), notify=_notify, patience=patience).run(options.speed, stopping)
    finally:
        for endpoint in endpoints:
            endpoint.recorder.finish()
        for port in ports:
            port.close()


def _show_modes(options: argparse.Namespace) -> None:
    from vehicle_sim.autopilot.diagram import Drawing, drawing  # noqa: PLC0415
    from vehicle_sim.parameters import Flavour  # noqa: PLC0415

    print(drawing(Flavour(options.flavour), Drawing(options.modes)), end="")  # noqa: T201 - what was asked for


def _parameters(options: argparse.Namespace) -> "ParameterStore":
    """Return the flavour's parameters with the values of the file, then those of the options."""
    from vehicle_sim.parameter_file import load_parameters  # noqa: PLC0415
    from vehicle_sim.parameters import Flavour, default_parameters  # noqa: PLC0415
    from vehicle_sim.parameters.file import take_value  # noqa: PLC0415

    if options.parameters is not None and options.count > 1:
        raise ConfigurationError("--parameters FILE keeps the parameters of one vehicle: leave it out, or --count")
    store = default_parameters(Flavour(options.flavour))
    if options.parameters is not None:
        load_parameters(options.parameters, store)
    for name, value in options.set:
        try:
            take_value(store, name, value)
        except ParameterError as error:
            raise ConfigurationError(f"--set {name}={value}: {error}") from error
    return store


def _schedule(path: str) -> "Schedule":
    from vehicle_sim.faults import read_schedule  # noqa: PLC0415
    from vehicle_sim.faults.fault_file import MAX_BYTES  # noqa: PLC0415

    try:
        with Path(path).open("rb") as file:
            content = file.read(MAX_BYTES + 1)
    except OSError as error:
        raise ConfigurationError(f"cannot read {path}: {error.strerror or error}; check its name") from error
    return read_schedule(content, path)


def _check_signing(address: Address, *, has_key: bool) -> None:
    if address.signing is not None and address.signing != "off" and not has_key:
        raise ConfigurationError(f"{address}: without --signing-key FILE there is no key to sign with")


def _links(options: argparse.Namespace, index: int = 0) -> list[tuple[Address, str, bool]]:
    """Return each address to open for a vehicle, what is streamed there, and whether the user asked for it."""
    asked = [*options.listen, *options.connect]
    links = [(address, "ONBOARD", True) for address in asked]
    if not asked:
        flavour = options.flavour
        defaults = (_DEFAULT_LISTEN[flavour], *_DEFAULT_CONNECT[flavour])
        links = [(parse_address(text), "ONBOARD", False) for text in defaults]
    ports = index * (options.port_step or _PORT_STEPS[options.flavour])
    links = [(address.shifted(ports), rates, is_asked) for address, rates, is_asked in links]
    if options.ground_station is not None:
        links.append((options.ground_station, "GROUND_STATION", True))
    elif not options.no_ground_station:
        links.append((parse_address(_GROUND_STATION), "GROUND_STATION", False))
    unique = {address: (address, rates, is_asked) for address, rates, is_asked in reversed(links)}
    return list(reversed(unique.values()))


def _tell(options: argparse.Namespace, ids: Sequence[int], bound: list[Address]) -> None:
    if options.announce:
        listening = " ".join(str(address) for address in bound if address.scheme in LISTENING)
        print(f"READY {listening}", flush=True)  # noqa: T201 - what the parent process reads
    if not options.quiet:
        links = ", ".join(str(address) for address in bound)
        who = f"system {ids[0]}" if len(ids) == 1 else f"systems {ids[0]} to {ids[-1]}"
        _notify(f"{options.flavour}, {who}, {options.speed:g} times real time, on {links}")


def _notify(sentence: str) -> None:
    print(f"vehicle-sim: {sentence}", file=sys.stderr, flush=True)  # noqa: T201 - the program's own voice


def _stop_flag(*, with_parent: bool) -> Callable[[], bool]:
    """Return a function that tells whether to stop: after SIGINT or SIGTERM, or once standard input is closed."""
    stop = threading.Event()
    for number in (signal.SIGINT, signal.SIGTERM):
        signal.signal(number, lambda _number, _frame: stop.set())
    if with_parent:
        # A thread that only ever waits: standard input cannot be polled together with sockets on every system.
        threading.Thread(target=_wait_for_end_of_input, args=(stop,), daemon=True).start()
    return stop.is_set


def _wait_for_end_of_input(stop: threading.Event) -> None:
    try:
        while os.read(sys.stdin.fileno(), 4096):
            pass
    finally:
        stop.set()


class _OneLineParser(argparse.ArgumentParser):
    """Says what is wrong in one line, without the usage in front of it."""

    def error(self, message: str) -> NoReturn:
        self.exit(_USAGE_ERROR, f"{self.prog}: {message} (see {self.prog} --help)\n")


class _Version(argparse.Action):
    """Prints the installed version; looked up only when it is asked for."""

    def __call__(self, parser: argparse.ArgumentParser, *_arguments: object) -> None:
        from importlib.metadata import version  # noqa: PLC0415 - reads the disk

        print(f"vehicle-sim {version('ltl-mission')}")  # noqa: T201 - what was asked for
        parser.exit()


def _parser() -> argparse.ArgumentParser:
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
    vehicle.add_argument(
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
        "--ground-station", type=address, metavar="ADDRESS", help=f"where the ground station is ({_GROUND_STATION})"
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
