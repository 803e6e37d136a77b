"""Which vehicle a command flies: the bundled one, started for it, or one at an address."""

from argparse import Namespace
from contextlib import ExitStack, suppress
from dataclasses import replace
from pathlib import Path

from mission.cli.screen import print_warnings
from mission.clock import Clock
from mission.errors import Fault, SpecError
from mission.fly import BundledVehicle, VehicleOptions, home_for
from mission.fly.linking import linked
from mission.link.address import parse_address
from mission.link.identity import LinkOptions
from mission.link.key_file import open_signatures
from mission.link.transport import Transport
from mission.spec.model import MissionSpec

_OF_THE_BUNDLED_VEHICLE = ("speed", "seed", "wind", "flavour", "dynamics", "faults", "no_ground_station")
UNHEARD = (
    "check that the vehicle or its simulator runs and sends MAVLink there; "
    "udpin: waits for a vehicle that calls, udpout: and tcp: call one"
)


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
    return linked(arguments.connect or _vehicle_options(arguments, spec), link, stack)


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
