"""A camera that looks straight down and is triggered by the autopilot: by distance, by time, and one at a time.

ArduPilot's (`AP_Camera_Backend.cpp`, a shutter on a servo) goes by the distance of a parameter or of a later command,
and measures it from where it was set. PX4's (`camera_trigger.cpp`, a shutter on a pin) is enabled, paused and resumed,
and takes the first picture when that happens. Both go by the estimated position; neither asks whether motors are armed.
"""

from collections import deque
from math import degrees, hypot, inf
from typing import Final, NamedTuple, Protocol

from vehicle_sim.parameters import Flavour, ParameterStore
from vehicle_sim.signals import CameraOrder, Estimate

_MOST_NEWS: Final = 64
_FOREVER: Final = -1
_FARTHEST_M: Final = 1000.0


class Photo(NamedTuple):
    """One picture: its number, as the autopilot counts, and what the vehicle believed of itself then."""

    number: int
    estimate: Estimate


class Camera(Protocol):
    """What takes pictures; switched on with the flight controller.

    Attributes:
        taken: How many it has taken.
        news: Pictures that were not told of yet, oldest first; its reader pops what it has taken.
    """

    taken: int
    news: deque[Photo]

    @property
    def interval_s(self) -> float:
        """Time between the pictures of a series."""
        ...

    @property
    def left(self) -> int:
        """How many pictures of a series are still to be taken; -1 without end."""
        ...

    def take(self, order: CameraOrder) -> bool:
        """Carry an order out; False where it asks for a picture that cannot be taken now."""
        ...

    def step(self, estimate: Estimate, *, in_mission: bool) -> None:
        """Take a picture if one is due."""
        ...


def camera_of(parameters: ParameterStore) -> Camera | None:
    """Return the camera that the parameters tell of at boot, if any."""
    if parameters.flavour is Flavour.PX4:
        return PinCamera(parameters) if parameters["TRIG_MODE"] else None
    return ServoCamera(parameters) if parameters["CAM1_TYPE"] else None


class ServoCamera:
    """ArduPilot's."""

    def __init__(self, parameters: ParameterStore) -> None:
        self._parameters = parameters
        self.taken = 0
        self.news: deque[Photo] = deque(maxlen=_MOST_NEWS)
        self.interval_s = 0.0
        self.left = 0
        self._parameter_m = self._distance_m = parameters["CAM1_TRIGG_DIST"]
        self._waits = False
        self._taken_s = -inf
        self._from_ne_m: tuple[float, float] | None = None
        self._estimate: Estimate | None = None

    def take(self, order: CameraOrder) -> bool:
        """Carry an order out; a picture too soon after the last is taken as soon as it may be, and False said of it."""
        if order.distance_m is not None:
            self._distance_m = order.distance_m  # not stored: the next boot does not begin with it
        if order.pictures is not None:
            self.left, self.interval_s = order.pictures, order.interval_s or 0.0
        return self._shoot() if order.shoots else True

    def step(self, estimate: Estimate, *, in_mission: bool) -> None:
        """Take a picture if one is due; a series goes before the distance."""
        self._estimate = estimate
        if self._waits:
            self._shoot()
        if self.left:
            if estimate.time_s - self._taken_s > self.interval_s and self._shoot() and self.left != _FOREVER:
                self.left -= 1
            return
        parameters = self._parameters
        if parameters["CAM1_TRIGG_DIST"] != self._parameter_m:
            self._parameter_m = self._distance_m = parameters["CAM1_TRIGG_DIST"]
        if self._distance_m <= 0.0:
            self._from_ne_m = None
            return
        if estimate.origin is None or (parameters["CAM_AUTO_ONLY"] and not in_mission):
            return
        if 0.0 < parameters["CAM_MAX_ROLL"] < abs(degrees(estimate.roll_rad)):
            return
        north, east, _down = estimate.position_ned_m
        if self._from_ne_m is None:
            self._from_ne_m = (north, east)
        elif hypot(north - self._from_ne_m[0], east - self._from_ne_m[1]) >= self._distance_m:
            self._shoot()

    def _shoot(self) -> bool:
        estimate = self._estimate
        self._waits = estimate is None or estimate.time_s - self._taken_s < self._parameters["CAM1_INTRVAL_MIN"]
        if estimate is None or self._waits:
            return False
        self.taken += 1
        self._taken_s = estimate.time_s
        self._from_ne_m = estimate.position_ned_m[:2]
        self.news.append(Photo(self.taken, estimate))
        return True


class PinCamera:
    """PX4's: TRIG_MODE says whether it goes by time (1, 2) or distance (3, 4), and whether from boot on (2, 3)."""

    left = 0

    def __init__(self, parameters: ParameterStore) -> None:
        self._parameters = parameters
        mode = int(parameters["TRIG_MODE"])
        self._by_distance = mode in (3, 4)
        self.taken = self._next = 0
        self.news: deque[Photo] = deque(maxlen=_MOST_NEWS)
        self._enabled = mode in (2, 3)
        self._paused = False
        self._one_shot = False
        self._taken_s = self._series_s = -inf
        self._from_ne_m: tuple[float, float] | None = None
        self._now_s = 0.0

    @property
    def interval_s(self) -> float:
        """Time between the pictures of a series."""
        return self._parameters["TRIG_INTERVAL"] / 1000.0

    def take(self, order: CameraOrder) -> bool:
        """Carry an order out; False where the last picture is so young that no other may be asked for."""
        if order.shoots and order.distance_m is None and self._now_s - self._taken_s < self._least_s:
            return False
        before = self._runs
        if order.distance_m is not None:
            self._parameters.set("TRIG_DISTANCE", min(order.distance_m, _FARTHEST_M))
            self._from_ne_m = None
        if order.interval_s is not None:
            self._parameters.set("TRIG_INTERVAL", min(max(1000.0 * order.interval_s, 4.0), 10_000.0))
        if order.restarts:
            self._next = 0
        self._paused = self._paused if order.paused is None else order.paused
        self._enabled = self._enabled if order.enabled is None else order.enabled
        self._one_shot |= order.shoots
        if self._runs != before:
            # What begins anew begins with a picture.
            self._from_ne_m, self._series_s = None, -inf
        return True

    def step(self, estimate: Estimate, *, in_mission: bool) -> None:  # noqa: ARG002 - every mode is as good as another
        """Take a picture if one is due."""
        self._now_s = estimate.time_s
        due = self._one_shot
        if self._runs:
            due |= self._is_far(estimate) if self._by_distance else self._is_late()
        self._one_shot = False
        if due and self._now_s - self._taken_s >= self._least_s:
            self._taken_s = self._now_s
            self.news.append(Photo(self._next, estimate))
            self._next += 1
            self.taken += 1

    @property
    def _runs(self) -> bool:
        return self._enabled and not self._paused

    @property
    def _least_s(self) -> float:
        return self._parameters["TRIG_MIN_INTERVA"] / 1000.0

    def _is_far(self, estimate: Estimate) -> bool:
        if not estimate.status.position_ok:
            return False
        north, east, _down = estimate.position_ned_m
        start = self._from_ne_m
        far = start is None or hypot(north - start[0], east - start[1]) >= self._parameters["TRIG_DISTANCE"]
        if far:
            self._from_ne_m = (north, east)
        return far

    def _is_late(self) -> bool:
        late = self._now_s - self._series_s >= self.interval_s
        if late:
            self._series_s = self._now_s
        return late
