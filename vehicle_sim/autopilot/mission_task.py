"""The mode that flies missions: a table of what each command does when its turn comes, and when it is done."""

from collections import deque
from collections.abc import Callable, Mapping
from math import hypot, inf, pi, tau
from typing import ClassVar, Final, NamedTuple

from vehicle_sim.autopilot.cursor import Cursor
from vehicle_sim.autopilot.legs import CircleTask, CruiseTask, distance_m
from vehicle_sim.autopilot.mission_items import FOREVER, Command, Kind, MissionItem, SpeedAxis
from vehicle_sim.autopilot.mission_stages import Craft, StagedTask, Stages, wrap
from vehicle_sim.autopilot.modes import Event, Severity
from vehicle_sim.autopilot.tasks import HoldTask, Task
from vehicle_sim.signals import CameraOrder, Estimate

_AT_REST_M_S: Final = 0.4
_TURNED_RAD: Final = pi / 90.0
_REPORTED: Final = frozenset({Command.WAYPOINT, Command.LOITER_TIME})
_UNTOLD: Final = frozenset({Command.PHOTOGRAPH, Command.NOTHING})
"""Acts that ArduPilot does not call reached."""


class _Row(NamedTuple):
    """One row of the table: what an item does when its turn comes, and what tells that it is done."""

    starts: Callable[["MissionTask", MissionItem], Stages]
    is_done: Callable[["MissionTask", MissionItem], bool]


class MissionTask(StagedTask):
    """Fly the mission that the machine holds, from where its cursor stands."""

    acts_on_ground = True

    def __init__(self, craft: Craft, estimate: Estimate, speeds: dict[SpeedAxis, float], *, may_lift: bool) -> None:
        """Begin by holding the place; the mission starts or goes on at the first `advance`.

        `speeds` are those that items and commands set; the limits of flight follow them. `may_lift` says whether the
        mission may leave the ground by itself.
        """
        super().__init__(craft, estimate, speeds)
        self.may_lift = may_lift
        self._now_s = 0.0
        self._begun = False
        self._over = False
        self._stuck = False
        self._lost = False
        self._revision = self._mission.revision
        self._replacements = self._mission.replacements
        self._stages: deque[Callable[[], Task]] = deque()
        self._started_s = 0.0
        self._beside: tuple[int, MissionItem, float] | None = None
        self._turns_told = 0
        self._home = craft.home
        self._photographed: CameraOrder | None = None

    # What the machine asks.

    def lifts(self, estimate: Estimate) -> bool:
        """Leave the ground when a take-off has begun."""
        return self.may_lift and self._leg.lifts(estimate)

    def pause(self) -> bool:
        """Stop on the leg; False where nothing can be paused."""
        leg = self._leg
        if not isinstance(leg, CruiseTask) or leg.reached or self._over:
            return False
        leg.paused = True
        return True

    def resume(self) -> bool:
        """Go on with what was paused; False where nothing could have been."""
        leg = self._leg
        if not isinstance(leg, CruiseTask):
            return False
        leg.paused = False
        return True

    def restart(self) -> None:
        """Start or resume a mission that is over, or that was given a new position since."""
        if not self._mission.running:
            self._begun = self._over = False

    def advance(self, now_s: float, estimate: Estimate) -> None:
        """Do what is due: begin, go on to the next item, act beside it, and move along the leg."""
        self._now_s, self._estimate = now_s, estimate
        mission = self._mission
        if not self._begun:
            self._begin()
        elif mission.running and (self._revision != mission.revision or self._has_moved_home()):
            self._renew()
        elif mission.running and not self._stuck and self._done():
            self._go_on()
        if mission.running and not self._px4:
            self._act_beside()
        if self._craft.flying:
            self._leg.advance(now_s, estimate)
            if self._leg.finished and self._stages:
                self._leg = self._stages.popleft()()
                self._leg.advance(now_s, estimate)
        self._show()
        if self._over and self._px4 and self._craft.flying and hypot(*estimate.velocity_ned_m_s) < _AT_REST_M_S:
            self.finish(Event.MISSION_ENDED)

    # Going on.

    def _begin(self) -> None:
        self._begun = True
        self._revision, self._replacements = self._mission.revision, self._mission.replacements
        if self._px4:
            self._say(Severity.INFO, "Executing Mission")
        if not self._mission.begin(restarts=self._craft.settings.mission_restarts):
            self._end()
            return
        if self._px4:
            self._recall_speeds()
            self._recall_camera()
        self._start()

    def _recall_camera(self) -> None:
        """Find what the camera was to do before the current item; it does so again from the next one on (PX4)."""
        orders = [item.order for item in self._mission.items[: self._mission.current] if item.order is not None]
        self._photographed = orders[-1] if orders and orders[-1].triggers else None

    def _recall_speeds(self) -> None:
        """Set the speeds again that items before the current one have set (PX4)."""
        for item in self._mission.items[: self._mission.current]:
            if item.command is Command.CHANGE_SPEED:
                self.change_speed(item)

    def _renew(self) -> None:
        """Fly the current item from here: the mission was changed, or another item was chosen."""
        self._revision = self._mission.revision
        self._stuck = False
        mission = self._mission
        if self._px4 and self._craft.mission_fault is not None:
            how = "loitering" if self._craft.flying else "refusing takeoff"
            self._say(Severity.CRITICAL, f"No valid mission available, {how}")
            self._leg = HoldTask(self._estimate, self._craft.settings)
            self._stop()
            mission.running = False
            return
        replaced, self._replacements = self._replacements != mission.replacements, mission.replacements
        if replaced and not mission.settle():
            if self._px4:
                self._end()
                return
            # It flies to where it was going, and then looks for the next item.
            self._say(Severity.CRITICAL, "Auto mission changed but failed to restart command")
            self._lost = True
            return
        if replaced and not self._px4:
            self._say(Severity.CRITICAL, "Auto mission changed, restarted command")
        self._start()

    def _has_moved_home(self) -> bool:
        """Tell whether heights above home have changed under the vehicle; ArduPilot looks at home once a leg."""
        moved = self._px4 and self._craft.home != self._home
        self._home = self._craft.home
        item = self._mission.item
        flies = item is not None and item.kind is Kind.NAVIGATE and isinstance(self._leg, CruiseTask)
        return moved and flies

    def _done(self) -> bool:
        """Tell whether the current item has done what it asked for."""
        item = self._mission.item
        if self._lost or item is None:
            return self._leg.finished
        return not self._stages and self._TABLE[item.command].is_done(self, item)

    def _go_on(self) -> None:
        mission, item = self._mission, self._mission.item
        if item is not None and not self._lost:
            index = mission.current
            if not self._px4 and item.command in _REPORTED:
                self._say(Severity.INFO, f"Reached command #{index}")
            mission.reach(index)
            if self._px4 and not item.continues:
                self._stuck = True
                return
            if not self._px4 and item.command is Command.LAND and not self._takes_off_again():
                self._end()
                return
        if mission.advance():
            if self._photographed is not None:
                self._craft.camera_orders.append(self._photographed)
                self._photographed = None
            self._start()
        else:
            self._end()

    def _takes_off_again(self) -> bool:
        following = self._mission.cursor.upcoming()
        return following is not None and following.command is Command.TAKEOFF

    def _end(self) -> None:
        """The last item is done: ArduPilot stays in the mode and loiters, PX4 comes to rest and changes to Hold."""
        if self._px4:
            how = "loitering" if self._craft.flying else "landed"
            self._say(Severity.INFO, f"Mission finished, {how}")
        self._stop()
        self._mission.complete()

    def _stop(self) -> None:
        self._over = True
        self._stages.clear()
        self._beside = None
        if not isinstance(self._leg, CruiseTask):
            self._leg = HoldTask(self._estimate, self._craft.settings)

    def _start(self) -> None:
        """Begin the current item."""
        self._lost = False
        mission, cursor = self._mission, self._mission.cursor
        self._started_s = self._now_s
        self._beside = None
        item = mission.items[mission.current]
        if item.kind is Kind.NAVIGATE and item.command is not Command.DELAY:
            self._yaw_rad, self.yaw_rate_rad_s = None, inf
        if not self._px4:
            self._tell_jumps(cursor)
            # The first that stands before the leg takes effect before it: speeds, home.
            self._act_beside()
            self._say(Severity.INFO, f"Mission: {mission.current} {item.name}")
        self._turns_told = 0
        stages = self._TABLE[item.command].starts(self, item)
        if stages:
            self._stages = deque(stages)
            self._leg = self._stages.popleft()()

    def _tell_jumps(self, cursor: Cursor) -> None:
        for jump in cursor.jumps:
            of = "unlimited" if jump.repeats == FOREVER else jump.repeats
            self._say(Severity.INFO, f"Mission: {jump.item} Jump {jump.times}/{of}")

    # Beside the navigation (ArduPilot).

    def _act_beside(self) -> None:
        """Start the next item beside the leg, or see whether the present one is done; one at a time."""
        queue = self._mission.cursor.beside
        if self._beside is None:
            if not queue:
                return
            index = queue.popleft()
            item = self._mission.items[index]
            self._say(Severity.INFO, f"Mission: {index} {item.name}")
            self._beside = (index, item, self._now_s)
            self._TABLE[item.command].starts(self, item)
            return
        index, item, since_s = self._beside
        if item.command is Command.WAIT:
            done = self._now_s - since_s > item.seconds
        elif item.command is Command.WITHIN_DISTANCE:
            done = self._distance_m() < item.radius_m
        elif item.command is Command.TURN:
            # The next waypoint takes the heading; while the turn lasts it keeps it.
            done = self._yaw_rad is None or abs(wrap(self._yaw_rad - self._estimate.yaw_rad)) < _TURNED_RAD
        else:
            done = True
        if done:
            self._beside = None
            if item.command not in _UNTOLD:
                self._mission.reach(index)

    def _distance_m(self) -> float:
        leg = self._leg
        return distance_m(self._estimate.position_ned_m, leg.end) if isinstance(leg, CruiseTask) else 0.0

    def _show(self) -> None:
        """Pass the leg on as the mode's own."""
        leg = self._leg
        self.setpoint = self._turned(leg.setpoint)
        self.landing, self.taking_off = leg.landing, leg.taking_off
        self.speed_m_s, self.climb_m_s, self.descent_m_s = leg.speed_m_s, leg.climb_m_s, leg.descent_m_s
        if isinstance(leg, CircleTask) and not self._px4 and (turn := int(leg.turned_rad / tau) + 1) > self._turns_told:
            item = self._mission.item
            if item is not None and turn <= item.turns:
                self._turns_told = turn
                self._say(Severity.INFO, f"Mission: starting circle {turn}/{int(item.turns)}")

    # When an item is done.

    def _flown(self, _item: MissionItem) -> bool:
        return self._leg.finished

    def _landed(self, _item: MissionItem) -> bool:
        return self._leg.landing and not self._craft.flying

    def _timed_out(self, item: MissionItem) -> bool:
        return self._now_s - self._started_s >= item.seconds

    def _never(self, _item: MissionItem) -> bool:
        return False

    def _at_once(self, _item: MissionItem) -> bool:
        return True

    def _returned(self, item: MissionItem) -> bool:
        return self._px4 or self._landed(item)

    _TABLE: ClassVar[Mapping[Command, _Row]] = {
        Command.TAKEOFF: _Row(StagedTask.take_off, _flown),
        Command.WAYPOINT: _Row(StagedTask.fly_to, _flown),
        Command.LOITER_UNLIMITED: _Row(StagedTask.fly_to, _never),
        Command.LOITER_TIME: _Row(StagedTask.fly_to, _flown),
        Command.LOITER_TURNS: _Row(StagedTask.circle, _flown),
        Command.LOITER_TO_ALTITUDE: _Row(StagedTask.fly_to, _flown),
        Command.LAND: _Row(StagedTask.land, _landed),
        Command.RETURN: _Row(StagedTask.go_home, _returned),
        Command.DELAY: _Row(StagedTask.delay, _timed_out),
        Command.WAIT: _Row(StagedTask.stay, _at_once),
        Command.WITHIN_DISTANCE: _Row(StagedTask.stay, _at_once),
        Command.TURN: _Row(StagedTask.turn_to, _at_once),
        Command.CHANGE_SPEED: _Row(StagedTask.change_speed, _at_once),
        Command.SET_HOME: _Row(StagedTask.set_home, _at_once),
        Command.LOOK_AT: _Row(StagedTask.look, _at_once),
        Command.LOOK_AHEAD: _Row(StagedTask.look, _at_once),
        Command.PHOTOGRAPH: _Row(StagedTask.photograph, _at_once),
        Command.NOTHING: _Row(StagedTask.stay, _at_once),
    }
