"""The pictures that the vehicle tells of, each once, with time, place and attitude.

ArduPilot sends CAMERA_FEEDBACK. PX4 sends CAMERA_TRIGGER when it releases the shutter and CAMERA_IMAGE_CAPTURED with
the place, but not both on every link: a release that no image follows counts where the vehicle was then.
"""

import math
from collections import deque
from typing import Final

from mission.errors import GeometryError
from mission.geometry.geodesy import LatLon, enu_offset_m
from mission.link.events import Event, Photographed
from mission.link.frames import Vector, ned_from_enu
from mission.link.leading import Leader
from mission.link.values import Image
from mission.link.vehicle_state import VehicleState

_FOLLOWS_S: Final = 1.0
"""Vehicle time within which the image of a release is told."""

_Key = tuple[int, int]


class PictureBook:
    """Which pictures were told of so far.

    Attributes:
        guidance: What ties the vehicle's frame and time to the domain and the trajectory; None before it is there.
    """

    def __init__(self, vehicle: VehicleState, events: deque[Event], guidance: Leader | None = None) -> None:
        """Know of none; each goes to ``events``, where what is not told is as the vehicle last reported it."""
        self.guidance = guidance
        self._vehicle, self._events = vehicle, events
        self._told: set[_Key] = set()
        self._released: dict[_Key, tuple[Image, float]] = {}

    def take(self, image: Image, vehicle_s: float) -> None:
        """Take a message: of a picture that was told before, failed, or may still be told better, nothing comes."""
        key = (image.number, image.stamp)
        if key in self._told or not image.captured:
            return
        if image.released:
            self._released.setdefault(key, (image, vehicle_s))
            return
        self._released.pop(key, None)
        self._tell(key, image, vehicle_s)

    def advance(self, vehicle_s: float) -> None:
        """Tell of releases whose images are overdue; at infinity of all."""
        late = [key for key, (_, heard_s) in self._released.items() if vehicle_s - heard_s > _FOLLOWS_S]
        for key in late:
            self._tell(key, *self._released.pop(key))

    def _tell(self, key: _Key, image: Image, vehicle_s: float) -> None:
        self._told.add(key)
        vehicle, guidance, place, attitude = self._vehicle, self.guidance, image.place, image.angles_rad
        if place is None and vehicle.place is not None:
            told = vehicle.place
            place = (told.latitude_deg, told.longitude_deg, told.altitude_amsl_m)
        if attitude is None and vehicle.attitude is not None:
            attitude = vehicle.attitude.angles_rad
        t_s = vehicle_s if image.boot_s is None else image.boot_s
        self._events.append(
            Photographed(
                t_s=t_s,
                number=image.number,
                utc_us=image.utc_us or None,
                place=place,
                position_m=None if guidance is None else _in_domain(place, vehicle, guidance),
                attitude_rad=attitude,
                accuracy_m=vehicle.accuracy_m,
                trajectory_s=None if guidance is None else guidance.trajectory_s(t_s),
            )
        )


def _in_domain(place: Vector | None, vehicle: VehicleState, guidance: Leader) -> Vector | None:
    """The place in the domain; where it cannot be told from the globe, where the vehicle reported itself last."""
    origin = vehicle.origin
    if place is not None and origin is not None and all(map(math.isfinite, place)):
        try:
            east_m, north_m = enu_offset_m(
                LatLon(origin.latitude_deg, origin.longitude_deg), LatLon(place[0], place[1])
            )
        except GeometryError:
            pass
        else:
            return guidance.anchor.to_domain(ned_from_enu((east_m, north_m, place[2] - origin.altitude_amsl_m)))
    return None if vehicle.position is None else guidance.anchor.to_domain(vehicle.position.position_ned_m)
