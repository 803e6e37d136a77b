"""The camera on the wire: its commands, what it is, and each picture when it is taken, all by the autopilot itself.

ArduPilot (`AP_Camera.cpp`) tells every link CAMERA_FEEDBACK, and has CAMERA_INFORMATION, CAMERA_SETTINGS and
CAMERA_CAPTURE_STATUS on request. PX4 (`camera_trigger`, `camera_feedback`) tells CAMERA_TRIGGER and
CAMERA_IMAGE_CAPTURED on the links that stream them, and has none of the others: they are those of cameras with a link
of their own. Without a camera PX4 leaves the commands unanswered: they are meant for a driver that is not there.
"""

from math import degrees, nan
from typing import TYPE_CHECKING, Final

from vehicle_sim.autopilot import Outcome
from vehicle_sim.geodesy import geodetic_at
from vehicle_sim.parameters import Flavour
from vehicle_sim.protocol.camera_orders import COMMANDS
from vehicle_sim.protocol.dialect import Message, mavlink
from vehicle_sim.protocol.motion import quaternion
from vehicle_sim.protocol.units import E7, wrapped
from vehicle_sim.signals import CameraOrder

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Mapping

    from vehicle_sim.camera import Photo
    from vehicle_sim.protocol.commands import Request
    from vehicle_sim.protocol.host import Host
    from vehicle_sim.protocol.telemetry import Builder

_FEEDBACK: Final = mavlink.MAVLINK_MSG_ID_CAMERA_FEEDBACK
_TRIGGER: Final = mavlink.MAVLINK_MSG_ID_CAMERA_TRIGGER
_CAPTURED: Final = mavlink.MAVLINK_MSG_ID_CAMERA_IMAGE_CAPTURED
_ANSWERED_ANYWAY: Final = frozenset(
    (
        mavlink.MAV_CMD_DO_DIGICAM_CONFIGURE,
        mavlink.MAV_CMD_DO_DIGICAM_CONTROL,
        mavlink.MAV_CMD_DO_SET_CAM_TRIGG_DIST,
    )
)
"""What ArduPilot accepts whether or not a picture comes of it, or there is a camera at all."""


class CameraService:
    """Passes on what is asked of the camera, and tells of its pictures.

    Attributes:
        commands: What the command service calls for the camera; None is no answer.
        telemetry: What there is to request of it, or to stream.
    """

    def __init__(self, host: "Host") -> None:
        self._host = host
        self._is_px4 = host.table.flavour is Flavour.PX4
        self._last: Photo | None = None
        self.commands: Mapping[int, Callable[[Request], Outcome | None]] = {
            **dict.fromkeys(COMMANDS[host.table.flavour], self._command),
            **({mavlink.MAV_CMD_SET_CAMERA_MODE: lambda _request: None} if self._is_px4 else {}),
        }
        self.telemetry: Mapping[int, Builder] = (
            {_TRIGGER: self._last_of(self._trigger), _CAPTURED: self._last_of(self._captured)}
            if self._is_px4
            else {
                _FEEDBACK: self._last_of(self._feedback),
                mavlink.MAVLINK_MSG_ID_CAMERA_INFORMATION: lambda _host: self._information(),
                mavlink.MAVLINK_MSG_ID_CAMERA_SETTINGS: lambda _host: self._settings(),
                mavlink.MAVLINK_MSG_ID_CAMERA_CAPTURE_STATUS: lambda _host: self._capture_status(),
            }
        )

    def news(self) -> "Iterator[Message]":
        """Make the messages about pictures that were not told of yet."""
        camera = self._host.vehicle.camera
        while camera is not None and camera.news:
            self._last = photo = camera.news.popleft()
            for make in (self._trigger, self._captured) if self._is_px4 else (self._feedback,):
                if (message := make(photo)) is not None:
                    yield message

    def reboot(self) -> None:
        """Forget the last picture."""
        self._last = None

    def _command(self, request: "Request") -> Outcome | None:
        camera = self._host.vehicle.camera
        if camera is None and self._is_px4:
            return None
        params = request.params
        if request.frame is not None:  # COMMAND_INT has a whole number there, which was taken for a latitude
            params = (*params[:4], params[4] * E7, *params[5:])
        order = COMMANDS[self._host.table.flavour][request.command](params)
        if not isinstance(order, CameraOrder):
            return order
        done = camera is not None and camera.take(order)
        if done or (request.command in _ANSWERED_ANYWAY and not self._is_px4):
            return Outcome.ACCEPTED
        if request.command == mavlink.MAV_CMD_IMAGE_STOP_CAPTURE:
            return Outcome.ACCEPTED if params[0] == 0.0 else Outcome.UNSUPPORTED
        return Outcome.TEMPORARILY_REJECTED if self._is_px4 else Outcome.FAILED

    # Messages.

    def _last_of(self, make: "Callable[[Photo], Message | None]") -> "Builder":
        return lambda _host: None if self._last is None else make(self._last)

    def _utc_us(self, time_us: int) -> int:
        return self._host.utc_of_boot_us + time_us if self._host.vehicle.readings.gps is not None else 0

    def _feedback(self, photo: "Photo") -> Message:
        """CAMERA_FEEDBACK: where the vehicle was and how it lay; its time is that of the satellites."""
        estimate, home = photo.estimate, self._host.vehicle.autopilot.home
        lat = lon = 0
        alt_m = above_m = 0.0
        if estimate.origin is not None:
            place = geodetic_at(estimate.origin, estimate.position_ned_m)
            lat, lon, alt_m = round(place.lat_deg * E7), round(place.lon_deg * E7), place.alt_m
            above_m = alt_m - (estimate.origin if home is None else home).alt_m
        angles_deg = (degrees(angle) for angle in (estimate.roll_rad, estimate.pitch_rad, wrapped(estimate.yaw_rad)))
        return mavlink.MAVLink_camera_feedback_message(
            self._utc_us(round(estimate.time_s * 1e6)),
            0,
            0,
            photo.number & 0xFFFF,
            lat,
            lon,
            alt_m,
            above_m,
            *angles_deg,
            0.0,
            mavlink.CAMERA_FEEDBACK_PHOTO,
        )

    def _trigger(self, photo: "Photo") -> Message:
        """CAMERA_TRIGGER: that the shutter was released, and when."""
        return mavlink.MAVLink_camera_trigger_message(round(photo.estimate.time_s * 1e6), photo.number)

    def _captured(self, photo: "Photo") -> Message | None:
        """CAMERA_IMAGE_CAPTURED: the place above sea level, without the distance to the ground, which is not known."""
        estimate = photo.estimate
        if estimate.origin is None:
            return None
        place = geodetic_at(estimate.origin, estimate.position_ned_m)
        return mavlink.MAVLink_camera_image_captured_message(
            round(estimate.time_s * 1000.0),
            self._utc_us(round(estimate.time_s * 1e6)),
            1,
            round(place.lat_deg * E7),
            round(place.lon_deg * E7),
            round(place.alt_m * 1000.0),
            -1000,
            quaternion(estimate),
            photo.number,
            1,
            b"",
        )

    def _information(self) -> Message | None:
        """CAMERA_INFORMATION: ArduPilot knows no more of a camera on a servo than that it takes images."""
        if self._host.vehicle.camera is None:
            return None
        return mavlink.MAVLink_camera_information_message(
            self._host.now_us // 1000,
            [0] * 32,
            [0] * 32,
            0,
            nan,
            nan,
            nan,
            0,
            0,
            0,
            mavlink.CAMERA_CAP_FLAGS_CAPTURE_IMAGE,
            0,
            b"",
            gimbal_device_id=int(self._host.vehicle.parameters["MNT1_TYPE"] > 0.0),
        )

    def _settings(self) -> Message | None:
        if self._host.vehicle.camera is None:
            return None
        return mavlink.MAVLink_camera_settings_message(self._host.now_us // 1000, mavlink.CAMERA_MODE_IMAGE, nan, nan)

    def _capture_status(self) -> Message | None:
        camera = self._host.vehicle.camera
        if camera is None:
            return None
        return mavlink.MAVLink_camera_capture_status_message(
            self._host.now_us // 1000, 2 if camera.left > 0 else 0, 0, camera.interval_s, 0, nan, camera.taken
        )
