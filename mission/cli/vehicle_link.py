"""Which vehicle a command flies: the bundled one, started for it, or one at an address."""

import errno
import socket
from argparse import Namespace
from contextlib import ExitStack, suppress
from dataclasses import replace
from pathlib import Path

from mission.cli.screen import print_warnings
from mission.clock import Clock, WallClock
from mission.errors import Fault, LinkError, SpecError, reason
from mission.fly import BundledVehicle, VehicleOptions, home_for
from mission.link.address import parse_address
from mission.link.identity import LinkOptions
from mission.link.key_file import open_signatures
from mission.link.lockstep import LockstepLink
from mission.link.transport import Transport, open_transport
from mission.spec.model import MissionSpec

_OF_THE_BUNDLED_VEHICLE = ("speed", "seed", "wind", "flavour", "dynamics", "faults", "no_ground_station")
UNHEARD = (
    "check that the vehicle or its simulator runs and sends MAVLink there; "
    "udpin: waits for a vehicle that calls, udpout: and tcp: call one"
)
_HINTS = {
    errno.ECONNREFUSED: "start the vehicle or its simulator first, and check the port",
    errno.EADDRINUSE: "another program, such as a ground station, listens there: close it, or take another port",
    errno.EADDRNOTAVAIL: "listen at an address of this machine, such as 0.0.0.0; to call the vehicle use udpout:",
    errno.ENOENT: "check the name of the device, such as /dev/ttyUSB0 or /dev/ttyACM0",
    errno.EACCES: "this user may not use it: for a serial line join its group, for a port below 1024 take a higher one",
    errno.ETIMEDOUT: "check the address, and that no firewall is in between",
    errno.EHOSTUNREACH: "check the address, and the network between here and there",
    errno.ENETUNREACH: "check the address, and the network between here and there",
}


def check_vehicle_options(arguments: Namespace) -> None:
    """Refuse options of the bundled vehicle for one at an address, and the other way round.

    Raises:
        SpecError: There are such.
    """
    if arguments.connect is None:
        if arguments.system_id is not None:
            hint = "leave it out to fly the bundled vehicle, or say with --connect where the vehicle is"
            raise SpecError((Fault(0, 0, "--system-id", "chooses among the vehicles at an address", hint),))
        return
    parse_address(arguments.connect)
    # A seed of 0 is given, too.
    given = [
        n for n in _OF_THE_BUNDLED_VEHICLE if getattr(arguments, n) is not None and getattr(arguments, n) is not False
    ]
    if given:
        names = ", ".join("--" + name.replace("_", "-") for name in given)
        hint = f"leave out --connect to fly the bundled vehicle, or leave out {names}"
        raise SpecError((Fault(0, 0, names, "is for the bundled vehicle, not for one at an address", hint),))


def link_options(arguments: Namespace) -> LinkOptions:
    """Whom to fly, and with which key."""
    link = LinkOptions(vehicle_id=arguments.system_id or 0)
    if arguments.signing_key is None:
        return link
    who = (link.system_id, link.component_id)
    signatures = open_signatures(Path(arguments.signing_key), who, warn)
    return replace(link, signatures=signatures)


def warn(words: str) -> None:
    """Say what does not end the flight; nor does it where nobody reads that."""
    with suppress(OSError):
        print_warnings((words,))


def link_to(
    arguments: Namespace, link: LinkOptions, spec: MissionSpec, stack: ExitStack
) -> tuple[BundledVehicle | None, Transport, Clock]:
    """The bundled vehicle, if that is to be flown, the link to what is, and the clock to fly by."""
    vehicle = None
    if arguments.connect is None:
        vehicle = stack.enter_context(BundledVehicle(_vehicle_options(arguments, spec)))
    transport = open_link(arguments.connect if vehicle is None else vehicle.address, link)
    stack.callback(transport.close)
    if vehicle is None:
        return None, transport, WallClock()
    lockstep = LockstepLink(transport, WallClock())
    return vehicle, lockstep, lockstep


def open_link(address: str, link: LinkOptions) -> Transport:
    """The link at an address.

    Raises:
        LinkError: It cannot be opened; with what to do.
    """
    try:
        return open_transport(address, None if link.signatures is None else link.signatures.is_genuine)
    except LinkError as error:
        cause = error.__cause__
        if not isinstance(cause, OSError):
            raise
        if isinstance(cause, socket.gaierror):
            hint = "check the name of the host"
        else:
            hint = _HINTS.get(cause.errno or 0, "check the address")
        raise LinkError(f"cannot open {address}: {reason(cause)}; {hint}") from error


def _vehicle_options(arguments: Namespace, spec: MissionSpec) -> VehicleOptions:
    default = VehicleOptions()
    return VehicleOptions(
        speed=arguments.speed or default.speed,
        seed=arguments.seed,
        wind=arguments.wind,
        flavour=arguments.flavour,
        dynamics=arguments.dynamics,
        faults=arguments.faults,
        home=home_for(spec),
        ground_station=not arguments.no_ground_station,
        signing_key=arguments.signing_key,
    )
