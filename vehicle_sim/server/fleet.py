"""Several vehicles in one process: each with its own system id, noise and place, on ports of its own.

The numbering is that of the autopilots' own simulators: instance i of ArduPilot's listens ten ports higher for each
(5760, 5770, ...), instance i of PX4's one higher (14580, 14581, ...). All speak to one ground station.
"""

from dataclasses import replace
from math import ceil, sqrt
from typing import TYPE_CHECKING, Final

from vehicle_sim.errors import ConfigurationError
from vehicle_sim.geodesy import geodetic_at
from vehicle_sim.protocol.bad_links import BadLinksEndpoint
from vehicle_sim.protocol.dialect import AUTOPILOT_COMPONENT
from vehicle_sim.protocol.endpoint import Endpoint
from vehicle_sim.protocol.signing import TICKS_PER_S, Signer
from vehicle_sim.vehicle import Vehicle, VehicleConfig

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from vehicle_sim.parameters import ParameterStore
    from vehicle_sim.server.key_file import KeyFile

_LAST_ID: Final = 255
_NOTED_TICKS: Final = 60 * TICKS_PER_S


def grid_place(index: int, count: int, spacing_m: float) -> tuple[float, float]:
    """Return where a vehicle stands, in metres north and east of the first: rows from west to east, in a square."""
    columns = ceil(sqrt(count))
    row, column = divmod(index, columns)
    return row * spacing_m, column * spacing_m


def config_of(first: VehicleConfig, index: int, count: int, spacing_m: float) -> VehicleConfig:
    """Return the configuration of one vehicle: the first one's, with noise and a place of its own."""
    north_m, east_m = grid_place(index, count, spacing_m)
    place = geodetic_at(first.home, (north_m, east_m, 0.0))
    return replace(first, seed=first.seed + index, home_lat_deg=place.lat_deg, home_lon_deg=place.lon_deg)


def fleet_of(
    first: VehicleConfig,
    *,
    count: int,
    spacing_m: float,
    system_id: int,
    component_id: int = AUTOPILOT_COMPONENT,
    key_file: "KeyFile | None" = None,
    parameters: "Sequence[ParameterStore]" = (),
    now: "Callable[[], int]" = lambda: 0,
    notify: "Callable[[str], None]" = lambda _sentence: None,
) -> list[Endpoint]:
    """Return the endpoints of several vehicles.

    Args:
        first: The configuration of the first one.
        count: How many.
        spacing_m: Metres between neighbours.
        system_id: Of the first one; the others follow.
        component_id: Of the autopilot of each.
        key_file: The signing key of all of them.
        parameters: Of each vehicle; those that have none take the flavour's.
        now: The time that signing goes by, in units of 10 microseconds since 2015-01-01.
        notify: Takes sentences for whoever runs the program.

    Raises:
        ConfigurationError: There are not so many system ids.
    """
    if system_id + count - 1 > _LAST_ID:
        raise ConfigurationError(f"{count} vehicles from system id {system_id} on: the last system id is {_LAST_ID}")
    endpoints = []
    for index in range(count):
        own_id = system_id + index
        config = first if index == 0 else config_of(first, index, count, spacing_m)
        signer = Signer(now=now) if key_file is None else _signer(key_file, own_id, component_id, now, notify)
        vehicle = Vehicle(config, parameters[index] if index < len(parameters) else None)
        kind = BadLinksEndpoint if vehicle.faults.link_faults else Endpoint
        endpoint = kind(vehicle, config.flavour, own_id, component_id=component_id, signer=signer)
        endpoint.key_setup.on_key = _key_keeper(key_file if count == 1 else None, notify)
        endpoints.append(endpoint)
    return endpoints


def _signer(
    key_file: "KeyFile",
    system_id: int,
    component_id: int,
    now: "Callable[[], int]",
    notify: "Callable[[str], None]",
) -> Signer:
    timestamp = key_file.timestamp(system_id, component_id)
    key_file.keep_timestamp(system_id, component_id, timestamp)  # what cannot be kept is told before the flight

    def keep(timestamp: int) -> None:
        try:
            key_file.keep_timestamp(system_id, component_id, timestamp)
        except ConfigurationError as error:
            notify(str(error))  # in flight, a full disk is no reason to fall down

    afresh = (
        "whoever signs by the right time is not heard. To begin afresh, set all clocks right, end every program with "
        f"the key, delete {key_file.beside(system_id, component_id)} and the timestamps that the others keep, "
        "and start again"
    )

    def tell(system: int, component: int, ticks: int) -> None:
        who = f"system {system}, component {component}"
        notify(f"{who} signs by a clock {_span(ticks)} ahead of this machine's: {afresh}")

    if timestamp - now() > _NOTED_TICKS:
        notify(f"the timestamps kept are {_span(timestamp - now())} ahead of this machine's clock: {afresh}")
    return Signer(key_file.key, now=now, timestamp=timestamp, on_reserve=keep, on_ahead=tell)


def _span(ticks: int) -> str:
    days = ticks / TICKS_PER_S / 86_400.0
    return f"{days:.1f} days" if days >= 1.0 else f"{days * 1440.0:.1f} minutes"


def _key_keeper(key_file: "KeyFile | None", notify: "Callable[[str], None]") -> "Callable[[bytes | None], None]":
    def keep(key: bytes | None) -> None:
        if key is None:
            notify("a ground station has ended signing, until the program ends")
            return
        kept = "it holds until the program ends"
        if key_file is not None:
            try:
                key_file.keep_key(key)
                kept = "it is kept in the key file"
            except ConfigurationError as error:
                kept = f"it holds until the program ends ({error})"
        notify(f"a ground station has given another signing key; {kept}")

    return keep
