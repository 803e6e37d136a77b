"""How each item of a mission is flown: the stages that it becomes, with their places and headings.

Sources of what the flavours do: ArduPilot `mode_auto.cpp`, PX4 `mission.cpp` and `mission_base.cpp`.
"""

from collections import deque
from collections.abc import Callable
from math import hypot, inf, pi, tau
from typing import Final, Protocol

from vehicle_sim.autopilot.legs import CircleTask, CruiseTask, Reference, corner_speed, course_rad, distance_m
from vehicle_sim.autopilot.mission import Mission
from vehicle_sim.autopilot.mission_items import Command, MissionItem, Place, SpeedAxis
from vehicle_sim.autopilot.modes import Event, Severity, StatusText
from vehicle_sim.autopilot.rally import Destination
from vehicle_sim.autopilot.tasks import HoldTask, LandTask, ReturnTask, TakeoffTask, Task
from vehicle_sim.geodesy import geodetic_at, ned_offset_m
from vehicle_sim.parameters import Flavour, FlightSettings, YawBehaviour
from vehicle_sim.signals import FREE, CameraOrder, Estimate, Geodetic, PartialVector, Setpoint, Vector

Stages = list[Callable[[], Task]]
"""What an item becomes: tasks that follow each other, each made when its turn comes; none: it goes on as is."""

_EDGE_M: Final = 0.5
_LEAST_CLIMB_M: Final = 1.0
_FLOWN_ON: Final = frozenset(
    {Command.WAYPOINT, Command.LOITER_UNLIMITED, Command.LOITER_TIME, Command.LOITER_TO_ALTITUDE}
)


class Craft(Protocol):
    """What a mission sees of the machine that flies it, and may change."""

    flavour: Flavour
    settings: FlightSettings
    home: Geodetic | None
    flying: bool
    texts: deque[StatusText]
    camera_orders: deque[CameraOrder]
    mission: Mission

    @property
    def mission_fault(self) -> str | None:
        """Why the mission cannot be flown; None if it can."""
        ...

    def place_home(self, place: Geodetic) -> bool:
        """Make a place home, if it may be one."""
        ...

    def way_home(self) -> Destination:
        """Where a return leads from here."""
        ...


class StagedTask(Task):
    """What flying an item needs: the leg that is flown now, the speeds, the heading, and places in the local frame."""

    def __init__(self, craft: Craft, estimate: Estimate, speeds: dict[SpeedAxis, float]) -> None:
        """Hold the place; `speeds` are those that items and commands set."""
        hold = HoldTask(estimate, craft.settings)
        super().__init__(hold.setpoint)
        self._craft = craft
        self._mission = craft.mission
        self._px4 = craft.flavour is Flavour.PX4
        self._speeds = speeds
        self._estimate = estimate
        self._leg: Task = hold
        self._look_at: Vector | None = None
        self._yaw_rad: float | None = None

    def _say(self, severity: Severity, text: str) -> None:
        self._craft.texts.append(StatusText(severity, text))

    def configure(self, settings: FlightSettings) -> None:
        """Go by other settings from now on, also on the leg that is flown."""
        super().configure(settings)
        self._leg.configure(settings)

    def turn(self, yaw_rad: float) -> None:
        """Look into a direction until the next leg."""
        self._yaw_rad = yaw_rad
        self.setpoint = self._turned(self.setpoint)

    def finish(self, event: Event) -> None:
        """Let the machine know that the mode is done."""
        self.finished, self.event = True, event

    # What an item does when its turn comes.

    def take_off(self, item: MissionItem) -> Stages:
        """Climb straight up; PX4 then flies to the item's place."""
        target = self._ned(item.place)
        stages: Stages = [lambda: self._climb(target[2])]
        if self._px4 and item.place is not None:
            stages.append(lambda: self._cruise(target, yaw_rad=item.yaw_rad))
        return stages

    def fly_to(self, item: MissionItem) -> Stages:
        """Fly to the item's place, and stay as long as it says."""
        target = self._ned(item.place)
        stages: Stages = [lambda: self._cruise(target, item=item, yaw_rad=item.yaw_rad)]
        if self._px4 and not self._craft.flying:
            # PX4 leaves the ground by itself, straight up, whatever the first item is.
            lowest = self._home_down_m() - self._craft.settings.takeoff_height_m
            stages.insert(0, lambda: self._climb(min(target[2], lowest)))
        return stages

    def circle(self, item: MissionItem) -> Stages:
        """Fly to the nearest point of the circle, then round."""
        centre = self._ned(item.place)
        radius = item.radius_m or self._craft.settings.circle_radius_m
        here = self._estimate.position_ned_m
        north, east = here[0] - centre[0], here[1] - centre[1]
        off = hypot(north, east)
        out = (north / off, east / off) if off > 0.0 else (-1.0, 0.0)
        edge = (centre[0] + radius * out[0], centre[1] + radius * out[1], centre[2])
        # From inside it does not look where it goes, so as not to spin.
        yaw = None if off > radius else self._estimate.yaw_rad

        def circle() -> Task:
            return CircleTask(
                self._reference(),
                self._craft.settings,
                centre=centre,
                radius_m=radius,
                turns=item.turns,
                clockwise=item.clockwise,
                speeds=self._speeds,
            )

        return [lambda: self._cruise(edge, yaw_rad=yaw, accept_m=_EDGE_M), circle]

    def land(self, item: MissionItem) -> Stages:
        """Fly over the place at the present height, where there is one, and descend."""
        place = item.place
        down = self._estimate.position_ned_m[2]
        if isinstance(self._leg, CruiseTask):
            down = self._leg.end[2]
        stages: Stages = []
        spot: PartialVector = FREE
        if place is not None and place.lat_deg is not None:
            north, east, _ = self._ned(place)
            spot = (north, east, None)
            stages.append(lambda: self._cruise((north, east, down)))
        return [
            *stages,
            lambda: LandTask(self._estimate, self._craft.settings, home_down_m=self._home_down_m(), place=spot),
        ]

    def go_home(self, _item: MissionItem) -> Stages:
        """Return and land: ArduPilot within the mode, PX4 by changing it."""
        if self._px4 and self._craft.flying:
            # There it is a command like any other: it changes the mode.
            mission = self._mission
            mission.reach(mission.current)
            if not mission.advance():
                mission.complete()
            self.finish(Event.RETURN_DUE)
        if self._px4:
            return []
        return [lambda: ReturnTask(self._estimate, self._craft.settings, goal=self._craft.way_home())]

    def delay(self, item: MissionItem) -> Stages:
        """Stay."""
        if not self._px4:
            self._say(Severity.INFO, f"Delaying {int(item.seconds)} sec")
        if self._craft.flying and not isinstance(self._leg, (CruiseTask, HoldTask)):
            return [lambda: HoldTask(self._estimate, self._craft.settings)]
        return []

    def stay(self, _item: MissionItem) -> Stages:
        """Go on as is."""
        return []

    def turn_to(self, item: MissionItem) -> Stages:
        """Look into the item's direction until the next leg."""
        yaw = item.yaw_rad or 0.0
        if item.relative:
            yaw = self._estimate.yaw_rad + (yaw if item.clockwise else -yaw)
        self._yaw_rad = wrap(yaw)
        self.yaw_rate_rad_s = item.yaw_rate_rad_s or inf
        return []

    def change_speed(self, item: MissionItem) -> Stages:
        """Fly with the item's speed from now on."""
        if item.axis is not None and item.speed_m_s > 0.0:
            fastest = self._craft.settings.setpoint_speed_m_s if self._px4 else inf
            self._speeds[item.axis] = min(item.speed_m_s, fastest)
        elif item.axis is not None and self._px4:
            self._speeds.pop(item.axis, None)
        return []

    def set_home(self, item: MissionItem) -> Stages:
        """Make the item's place home, or the present one."""
        here = self._here()
        self._craft.place_home(here if item.place is None else item.place.geodetic(self._craft.home, here))
        return []

    def look(self, item: MissionItem) -> Stages:
        """Look at the item's place from now on, or ahead again."""
        self._look_at = None if item.place is None else self._ned(item.place)
        return []

    def photograph(self, item: MissionItem) -> Stages:
        """Let the camera do what the item says."""
        if item.order is not None:
            self._craft.camera_orders.append(item.order)
        return []

    # Stages.

    def _climb(self, down_m: float) -> Task:
        here = self._estimate.position_ned_m[2]
        least = 0.0 if self._craft.flying else _LEAST_CLIMB_M
        return TakeoffTask(self._estimate, self._craft.settings, down_m=min(down_m, here - least))

    def _cruise(
        self,
        end: Vector,
        *,
        item: MissionItem | None = None,
        yaw_rad: float | None = None,
        accept_m: float | None = None,
    ) -> Task:
        settings, leg = self._craft.settings, self._leg
        reference = self._reference()
        # The line begins where the last leg ended, also while the vehicle goes round that corner; otherwise here.
        start = leg.end if isinstance(leg, CruiseTask) and leg.reached else reference.place
        accept = accept_m or (item.radius_m if item is not None else 0.0) or settings.accept_m
        hold = 0.0 if item is None else item.seconds
        yaw = self._default_yaw(start, end) if yaw_rad is None else yaw_rad
        return CruiseTask(
            reference,
            settings,
            start=start,
            end=end,
            speeds=self._speeds,
            accept_m=accept,
            accept_height_m=settings.accept_height_m,
            corner_m_s=self._corner(item, start, end, accept),
            hold_s=hold,
            yaw_rad=yaw,
        )

    def _corner(self, item: MissionItem | None, start: Vector, end: Vector, accept_m: float) -> float:
        """Return the speed with which the next leg is begun; 0 where the vehicle has to stop between."""
        if item is None or item.command is not Command.WAYPOINT or item.seconds > 0.0 or not item.continues:
            return 0.0
        following = self._mission.cursor.upcoming()
        if following is None or following.command not in _FLOWN_ON:
            return 0.0
        acceleration = self._craft.settings.acceleration_m_s2
        return corner_speed(start, end, self._ned(following.place, end), accept_m, 0.5 * acceleration)

    def _reference(self) -> Reference:
        """Return the reference to go on with: the last leg's, else the vehicle itself."""
        leg, estimate = self._leg, self._estimate
        if isinstance(leg, (CruiseTask, CircleTask)):
            return leg.reference
        if isinstance(leg, (TakeoffTask, HoldTask)):
            north, east, down = leg.setpoint.position_ned_m
            if north is not None and east is not None and down is not None:
                still = Reference((north, east, down), (0.0, 0.0, 0.0))
                if distance_m(still.place, estimate.position_ned_m) < self._craft.settings.accept_m:
                    return still
        return Reference(estimate.position_ned_m, estimate.velocity_ned_m_s)

    # Places and headings.

    def _here(self) -> Geodetic:
        origin = self._estimate.origin or Geodetic(0.0, 0.0, 0.0)
        return geodetic_at(origin, self._estimate.position_ned_m)

    def _ned(self, place: Place | None, default: Vector | None = None) -> Vector:
        """Return a place relative to the estimator's origin; what it leaves open is as at `default`, else as here."""
        origin = self._estimate.origin
        here = self._estimate.position_ned_m if default is None else default
        if place is None or origin is None:
            return here
        there = place.geodetic(self._craft.home, geodetic_at(origin, here))
        return ned_offset_m(origin, there)

    def _home_ned_m(self) -> Vector:
        home, origin = self._craft.home, self._estimate.origin
        return self._estimate.position_ned_m if home is None or origin is None else ned_offset_m(origin, home)

    def _home_down_m(self) -> float:
        return self._home_ned_m()[2]

    def _default_yaw(self, start: Vector, end: Vector) -> float:
        """Return the heading of a leg that names none: what the parameters say."""
        behaviour, here = self._craft.settings.yaw_behaviour, self._estimate.position_ned_m
        course: float | None = None
        if behaviour is YawBehaviour.AHEAD:
            course = course_rad(start, end)
        elif behaviour is not YawBehaviour.KEEP:
            course = course_rad(here, self._home_ned_m())
            if course is not None and behaviour is YawBehaviour.FROM_HOME:
                course += pi
        if course is None:
            yaw = self.setpoint.yaw_rad
            return self._estimate.yaw_rad if yaw is None else yaw
        return course

    def _turned(self, setpoint: Setpoint) -> Setpoint:
        yaw = self._yaw_rad
        if yaw is None and self._look_at is not None and not self._leg.landing:
            yaw = course_rad(self._estimate.position_ned_m, self._look_at)
        if yaw is None or yaw == setpoint.yaw_rad:
            return setpoint
        return Setpoint(
            position_ned_m=setpoint.position_ned_m,
            velocity_ned_m_s=setpoint.velocity_ned_m_s,
            acceleration_ned_m_s2=setpoint.acceleration_ned_m_s2,
            yaw_rad=yaw,
        )


def wrap(angle_rad: float) -> float:
    """Return the angle in [-pi, pi)."""
    return (angle_rad + pi) % tau - pi
