"""ArduPilot's terrain, which is flat and as high as home: TERRAIN_REPORT, and TERRAIN_CHECK of any place.

https://mavlink.io/en/services/terrain.html. All of it is known, so none is asked for.
"""

from typing import TYPE_CHECKING, Final

from vehicle_sim.geodesy import geodetic_at
from vehicle_sim.parameters import Flavour
from vehicle_sim.protocol.dialect import Message, mavlink
from vehicle_sim.protocol.units import E7

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    from vehicle_sim.protocol.host import Host, Sender
    from vehicle_sim.protocol.telemetry import Builder

_SPACING_M: Final = 100
_BLOCKS: Final = 504
"""Of the grid around the vehicle that ArduPilot loads."""


class TerrainService:
    """Tells how high the ground is."""

    def __init__(self, host: "Host") -> None:
        self._host = host
        is_px4 = host.table.flavour is Flavour.PX4
        self.messages: Mapping[int, Callable[[Sender, Message], None]] = (
            {} if is_px4 else {mavlink.MAVLINK_MSG_ID_TERRAIN_CHECK: self.on_check}
        )
        self.telemetry: Mapping[int, Builder] = (
            {} if is_px4 else {mavlink.MAVLINK_MSG_ID_TERRAIN_REPORT: lambda _host: self._here()}
        )

    def on_check(self, sender: "Sender", message: Message) -> None:
        """Tell the height of the ground at a place, once there is a home."""
        report = self._report(message.lat, message.lon)
        if report is not None:
            sender.link.send(report)

    def _here(self) -> Message | None:
        estimate = self._host.vehicle.estimate
        if estimate.origin is None:
            return None
        place = geodetic_at(estimate.origin, estimate.position_ned_m)
        return self._report(round(place.lat_deg * E7), round(place.lon_deg * E7))

    def _report(self, lat: int, lon: int) -> Message | None:
        home, estimate = self._host.vehicle.autopilot.home, self._host.vehicle.estimate
        if home is None or estimate.origin is None:
            return None
        above_m = estimate.origin.alt_m - estimate.position_ned_m[2] - home.alt_m
        return mavlink.MAVLink_terrain_report_message(lat, lon, _SPACING_M, home.alt_m, above_m, 0, _BLOCKS)
