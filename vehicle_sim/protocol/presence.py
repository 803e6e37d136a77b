"""Who is there, and where is home: heartbeats of others, and the announcements that a vehicle makes of itself."""

from typing import TYPE_CHECKING

from vehicle_sim.parameters import Flavour
from vehicle_sim.protocol.dialect import Message, mavlink
from vehicle_sim.protocol.places import global_place

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    from vehicle_sim.protocol.host import Host, Sender


class PresenceService:
    """Notes that a ground station lives; tells everyone of a new origin or home, once each."""

    def __init__(self, host: "Host") -> None:
        self._host = host
        self._told_home = host.vehicle.autopilot.home_revision
        self._told_origin = False
        self.messages: Mapping[int, Callable[[Sender, Message], None]] = {
            mavlink.MAVLINK_MSG_ID_HEARTBEAT: self.on_heartbeat,
            mavlink.MAVLINK_MSG_ID_AUTOPILOT_VERSION_REQUEST: self.on_version_request,
            mavlink.MAVLINK_MSG_ID_SET_GPS_GLOBAL_ORIGIN: self.on_set_origin,
            mavlink.MAVLINK_MSG_ID_SET_HOME_POSITION: self.on_set_home,
        }

    def reboot(self) -> None:
        """Forget what was announced: the vehicle has neither origin nor home again."""
        self._told_home = self._host.vehicle.autopilot.home_revision
        self._told_origin = False

    def advance(self) -> None:
        """Announce what has changed since the last step."""
        vehicle = self._host.vehicle
        if not self._told_origin and vehicle.estimate.origin is not None:
            self._told_origin = True
            self._announce(mavlink.MAVLINK_MSG_ID_GPS_GLOBAL_ORIGIN)
        if self._told_origin and vehicle.autopilot.home_revision != self._told_home:
            self._told_home = vehicle.autopilot.home_revision
            self._announce(mavlink.MAVLINK_MSG_ID_HOME_POSITION)

    def _announce(self, message_id: int) -> None:
        message = self._host.telemetry(message_id)
        if message is not None:
            self._host.broadcast(message)

    def on_heartbeat(self, sender: "Sender", message: Message) -> None:
        """Tell the autopilot of a ground station: PX4 goes by its type, ArduPilot by the system id alone."""
        if self._host.table.flavour is Flavour.PX4 and message.type != mavlink.MAV_TYPE_GCS:
            return
        self._host.vehicle.autopilot.heartbeat_from_ground(sender.system_id, self._host.now_us * 1e-6)

    def on_version_request(self, sender: "Sender", _message: Message) -> None:
        """Answer the request for AUTOPILOT_VERSION that came before REQUEST_MESSAGE."""
        self._answer(sender, mavlink.MAVLINK_MSG_ID_AUTOPILOT_VERSION)

    def on_set_origin(self, sender: "Sender", _message: Message) -> None:
        """Tell the origin; it cannot be moved, it is where the receiver first found the vehicle."""
        self._answer(sender, mavlink.MAVLINK_MSG_ID_GPS_GLOBAL_ORIGIN)

    def on_set_home(self, sender: "Sender", message: Message) -> None:
        """Move home to a place above mean sea level (zeros alone mean here), and tell where it is now."""
        lat, lon, alt = message.latitude, message.longitude, message.altitude
        place = global_place(lat * 1e-7, lon * 1e-7, alt * 1e-3, mavlink.MAV_FRAME_GLOBAL, None)
        if place is not None or lat == lon == alt == 0:
            self._host.vehicle.autopilot.set_home(place)
        self._answer(sender, mavlink.MAVLINK_MSG_ID_HOME_POSITION)

    def _answer(self, sender: "Sender", message_id: int) -> None:
        message = self._host.telemetry(message_id)
        if message is not None:
            sender.link.send(message)
