"""The program `vehicle-sim`: options, sockets and signals around one vehicle; the only place that prints.

What takes time to import is imported once the options are known to be good.
"""

import argparse
import os
import signal
import sys
import threading
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager, suppress
from dataclasses import replace
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING, Final

from vehicle_sim.cli.command_line import GROUND_STATION, USAGE_ERROR, build_parser, with_negative_values
from vehicle_sim.cli.option_values import HOME_FIELDS
from vehicle_sim.cli.printable import printable
from vehicle_sim.errors import ConfigurationError, ParameterError
from vehicle_sim.server.addresses import LISTENING, Address, parse_address

if TYPE_CHECKING:
    from vehicle_sim.faults import Schedule
    from vehicle_sim.parameters import ParameterStore
    from vehicle_sim.vehicle import VehicleConfig

_DEFAULT_LISTEN: Final = {"ardupilot": "tcpin:127.0.0.1:5760", "px4": "udpin:127.0.0.1:14580"}
_DEFAULT_CONNECT: Final = {"ardupilot": (), "px4": ("udpout:127.0.0.1:14540",)}
_PORT_STEPS: Final = {"ardupilot": 10, "px4": 1}


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the program; return its exit code: 0 ended as asked, 2 an option or address that cannot be used."""
    parser = build_parser()
    options = parser.parse_args(with_negative_values(sys.argv[1:] if arguments is None else arguments))
    if options.modes is not None:
        _show_modes(options)
        return 0
    try:
        with _stop_flag(
            with_parent=options.exit_with_parent
        ) as stopping:  # before all that takes time: it may be told to end before it has begun
            _run(options, stopping)
    except ConfigurationError as error:
        _notify(str(error))
        return USAGE_ERROR
    return 0


def _run(options: argparse.Namespace, stopping: Callable[[], bool]) -> None:
    # numpy, filterpy and pymavlink would make `--help` wait.
    from vehicle_sim.clock import WallClock  # noqa: PLC0415
    from vehicle_sim.protocol.flavour import TABLES, Rates  # noqa: PLC0415
    from vehicle_sim.server.fleet import fleet_of  # noqa: PLC0415
    from vehicle_sim.server.key_file import KeyFile, signing_time  # noqa: PLC0415
    from vehicle_sim.server.lockstep import Lockstep  # noqa: PLC0415
    from vehicle_sim.server.log_folder import keep_logs  # noqa: PLC0415
    from vehicle_sim.server.parameter_file import keep_parameters  # noqa: PLC0415
    from vehicle_sim.server.party import Fleet, Party  # noqa: PLC0415
    from vehicle_sim.server.patience import Patience  # noqa: PLC0415
    from vehicle_sim.server.ports import Port, open_port  # noqa: PLC0415
    from vehicle_sim.server.server import Server  # noqa: PLC0415

    config = _config(options)
    stores = [_parameters(options) for _ in range(options.count)]
    named = int(stores[0][TABLES[config.flavour].system_id_parameter])
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
        _tell(options, [endpoint.system_id for endpoint in endpoints], bound)
        patience = [Patience(options.patience) for _ in endpoints] if options.patience > 0.0 else []
        lockstep = Lockstep(endpoints, _notify) if options.lockstep else None
        # The estimators want it seconds after the start only, and it takes as long to load as all the rest.
        threading.Thread(target=import_module, args=("filterpy.kalman",)).start()
        server = Server(endpoints, ports, clock=WallClock(), notify=_notify, patience=patience, lockstep=lockstep)
        server.run(options.speed, stopping)
    finally:
        for endpoint in endpoints:
            endpoint.recorder.finish()
            endpoint.signer.finish()
        for port in ports:
            port.close()


def _config(options: argparse.Namespace) -> "VehicleConfig":
    """Return the vehicle that the options describe."""
    from vehicle_sim.control.controller import NAMED_GAINS  # noqa: PLC0415
    from vehicle_sim.dynamics.airframe import Dynamics  # noqa: PLC0415
    from vehicle_sim.faults import NO_FAULTS  # noqa: PLC0415
    from vehicle_sim.parameters import Flavour  # noqa: PLC0415
    from vehicle_sim.vehicle import AS_THEY_COME  # noqa: PLC0415

    speed_m_s, from_deg = options.wind
    usual = AS_THEY_COME[Flavour(options.flavour)]
    place = {} if options.home is None else dict(zip(HOME_FIELDS, options.home, strict=True))
    return replace(
        usual,
        seed=options.seed,
        dynamics=Dynamics(options.dynamics),
        wind_m_s=speed_m_s,
        wind_from_deg=from_deg,
        gust_m_s=options.gusts,
        drag_per_s=usual.drag_per_s if options.drag is None else options.drag,
        gains=usual.gains if options.gains is None else NAMED_GAINS[options.gains],
        faults=NO_FAULTS if options.faults is None else _schedule(options.faults),
        **place,
    )


def _show_modes(options: argparse.Namespace) -> None:
    from vehicle_sim.autopilot.diagram import Drawing, drawing  # noqa: PLC0415
    from vehicle_sim.parameters import Flavour  # noqa: PLC0415

    print(drawing(Flavour(options.flavour), Drawing(options.modes)), end="")  # noqa: T201 - what was asked for


def _parameters(options: argparse.Namespace) -> "ParameterStore":
    """Return the flavour's parameters with the values of the file, then those of the options."""
    from vehicle_sim.parameters import Flavour, default_parameters  # noqa: PLC0415
    from vehicle_sim.parameters.file import take_value  # noqa: PLC0415
    from vehicle_sim.server.parameter_file import load_parameters  # noqa: PLC0415

    if options.parameters is not None and options.count > 1:
        raise ConfigurationError("--parameters FILE keeps the parameters of one vehicle: leave it out, or --count")
    store = default_parameters(Flavour(options.flavour))
    if options.parameters is not None:
        load_parameters(options.parameters, store)
    for name, value in options.set:
        try:
            take_value(store, name, value)
            store.require_obeyed(name)
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
        raise ConfigurationError(f"cannot read {printable(path)}: {error.strerror or error}; check its name") from error
    return read_schedule(content, printable(path))


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
        links.append((parse_address(GROUND_STATION), "GROUND_STATION", False))
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
    lines = "\n".join(map(printable, sentence.split("\n")))  # the faults of a file have a line each
    with suppress(OSError):  # a vehicle that flies does not fall for want of a listener
        print(f"vehicle-sim: {lines}", file=sys.stderr, flush=True)  # noqa: T201 - the program's own voice


@contextmanager
def _stop_flag(*, with_parent: bool) -> Iterator[Callable[[], bool]]:
    """Give a function that tells whether to stop: after SIGINT or SIGTERM, or once standard input is closed."""
    stop = threading.Event()
    numbers = (signal.SIGINT, signal.SIGTERM)
    before = {number: signal.signal(number, lambda _number, _frame: stop.set()) for number in numbers}
    if with_parent:
        # A thread that only ever waits: standard input cannot be polled together with sockets on every system.
        threading.Thread(target=_wait_for_end_of_input, args=(stop,), daemon=True).start()
    try:
        yield stop.is_set
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)


def _wait_for_end_of_input(stop: threading.Event) -> None:
    try:
        while os.read(sys.stdin.fileno(), 4096):
            pass
    finally:
        stop.set()
