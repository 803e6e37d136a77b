"""What drives the autopilot from inside: time, estimate, failures, take-off and landing.

What may follow what is written in the tables of `modes`. Without a pilot, modes by hand see centred sticks.
"""

from math import ceil, cos, inf, sin
from typing import Final

from vehicle_sim.autopilot import texts
from vehicle_sim.autopilot.arming import REMINDER_PERIOD_S, REMINDERS
from vehicle_sim.autopilot.avoidance import within_fence
from vehicle_sim.autopilot.guard import Situation
from vehicle_sim.autopilot.hand import HandTask
from vehicle_sim.autopilot.legs import CircleTask, GoTask, Reference, course_rad
from vehicle_sim.autopilot.mission import Progress
from vehicle_sim.autopilot.mission_items import SpeedAxis
from vehicle_sim.autopilot.mission_task import MissionTask
from vehicle_sim.autopilot.modes import (
    FAILSAFE_MODES,
    KEEPING_PLACE,
    TRANSITIONS,
    Entry,
    Event,
    Failsafe,
    Mode,
    Outcome,
    Severity,
    StatusText,
)
from vehicle_sim.autopilot.rally import Destination, destination
from vehicle_sim.autopilot.retracing import RetraceTask
from vehicle_sim.autopilot.state import State
from vehicle_sim.autopilot.tasks import GuidedTask, HoldTask, LandTask, ReturnTask, TakeoffTask, Task, stopping_place
from vehicle_sim.geodesy import ned_offset_m
from vehicle_sim.parameters import Action, FenceType, Flavour, FlightSettings
from vehicle_sim.signals import FREE, CameraOrder, Estimate, Guidance, Limits, PartialVector, Setpoint, Vector

_ALIGNS_ABOVE_M: Final = 2.5
"""Height from which the iron in the ground disturbs no compass: EKF3_MAG_FINAL_RESET_ALT."""


class Machine(State):
    """Modes, arming, tasks and failsafes of one vehicle, going on with vehicle time."""

    def terminate(self) -> Outcome:
        """End the flight here and now: motors off, for good."""
        self.terminated = True
        self._disarm(StatusText(Severity.EMERGENCY, "Flight termination"))
        return Outcome.ACCEPTED

    def configure(self, settings: FlightSettings) -> None:
        """Go by other settings from now on, in what is flown as in what is asked next."""
        self.settings, self._limits = settings, settings.limits()
        self.pilot.hand = settings.hand
        self.guard.configure(settings)
        self._task.configure(settings)
        self._refresh()

    def observe(self, now_s: float, estimate: Estimate) -> None:
        """Note the time and the estimate, so that requests act on the newest ones."""
        self._now_s = now_s
        self._estimate = estimate
        self._watch_origin()

    def advance(self, thrust_m_s2: float, wind_ned_m_s: Vector = (0.0, 0.0, 0.0)) -> None:
        """Do what is due.

        Args:
            thrust_m_s2: The specific thrust that the controller asked for last.
            wind_ned_m_s: The wind that the vehicle feels.
        """
        self._wind_ned_m_s = wind_ned_m_s
        self.pilot.listen(self._now_s, landed=not self.flying)
        situation = self._situation()
        fresh = self.guard.look_at_fence(situation)
        if self.armed:
            self._protect(situation, fresh)
        keeps = self.armed and self.mode is not Mode.SMART_RTL
        if ended := self.path.advance(self._estimate, self.settings, keeps=keeps):
            self._say(Severity.WARNING, ended)
        if self.armed:
            self._fly()
        elif self._now_s - self._reminded_at_s >= REMINDER_PERIOD_S and (
            told := [fault.text for fault in self.prearm_faults if fault.text]
        ):
            self._reminded_at_s = self._now_s
            self._say(Severity.CRITICAL, REMINDERS[self.flavour].format(text=told[0]))
        self._watch_ground(thrust_m_s2)
        self._refresh()

    # Inside.

    def _watch_origin(self) -> None:
        if not self._aligned and self._estimate.status.attitude_ok:
            self._aligned = True
            self.texts.extend(texts.ALIGNED[self.flavour])
        if not self._origin_known and self._estimate.origin is not None:
            self._origin_known = True
            self.texts.extend(texts.filled(texts.ORIGIN_SET[self.flavour], alt_m=self._estimate.origin.alt_m))
        # Whoever hears of a position, or of one that is predicted, looks for home.
        if self.home is None and self._origin_known:
            self.place_home(self._here())

    def _obstacle(self, mode: Mode) -> str:
        """Return why `mode` cannot be entered with motors armed; empty if it can."""
        if self.modes[mode].needs_position and not self._estimate.status.position_ok:
            return "requires position"
        if mode is Mode.AUTO:
            return self._mission_obstacle()
        if mode is Mode.GUIDED and self.flavour is Flavour.PX4 and not self._stream_fresh:
            return "no setpoints"
        return ""

    def _is_closed(self, mode: Mode) -> bool:
        """Whether a mode cannot be entered as things stand, position or not."""
        return {
            Entry.ALWAYS: False,
            Entry.NEVER: True,
            Entry.FLYING: not (self.armed and self.flying),
            Entry.DISARMED: self.armed,
        }[self.modes[mode].entry] or (mode is Mode.SMART_RTL and not self.path.places)

    def _mission_obstacle(self) -> str:
        lifts = self.flavour is Flavour.PX4 or self.flying
        if self.mission_fault is not None:
            return "init failed"
        if not lifts and not self.mission.starts_with_takeoff(restarts=self.settings.mission_restarts):
            # ArduPilot would turn over on the ground.
            self._say(Severity.CRITICAL, "Auto: Missing Takeoff Cmd")
            return "init failed"
        return ""

    def _enter(self, mode: Mode) -> None:
        if self.flavour is Flavour.PX4 and self.mode is Mode.AUTO:
            self.camera_orders.append(CameraOrder(paused=True))
        self.mission.stop()
        if mode is not self.mode:  # a take-off that ends in GUIDED goes on looking
            self._looked_at = None
        self.mode = mode
        self._speeds.clear()
        self._yaw_rate_rad_s = inf
        self._paused = None
        self._begin(mode)

    def _begin(self, mode: Mode) -> None:
        estimate, settings, mode = self._estimate, self.settings, self.modes[mode].like or mode
        if mode is Mode.GUIDED:
            self._task = self._guided()
        elif mode is Mode.CIRCLE:
            self._task = self._circling(FREE, settings.circle_radius_m, clockwise=settings.circle_rate_rad_s >= 0.0)
        elif mode is Mode.AUTO:
            self._task = MissionTask(self, estimate, self._speeds, may_lift=settings.mission_lifts)
        elif mode is Mode.LAND:
            self._task = LandTask(estimate, settings, home_down_m=self._home_ned_m[2])
        elif mode is Mode.RETURN:
            self._task = self._returning()
        elif mode is Mode.TAKEOFF:
            height = settings.takeoff_height_m if self._takeoff_height_m is None else self._takeoff_height_m
            if self.armed and self._takeoff_height_m is None:
                self._say(Severity.INFO, f"Using default takeoff altitude: {height:.1f} m")
            self._task = TakeoffTask(estimate, settings, down_m=self._home_ned_m[2] - height)
        elif self.modes[mode].manual or mode in KEEPING_PLACE:
            self._task = HandTask(estimate, settings, self.pilot, keeps_place=mode in KEEPING_PLACE)
        elif mode is Mode.HOLD:
            self._task = self._going(HoldTask(estimate, settings, place=self._reached()).setpoint)
        else:
            self._task = HoldTask(estimate, settings)
        self._refresh()

    def _returning(self) -> Task:
        """Return the task that leads home, or back along the path that was flown."""
        estimate, settings = self._estimate, self.settings
        if self.mode is Mode.SMART_RTL and self.path.places:
            return RetraceTask(estimate, settings, self.path, self._speeds)
        task = ReturnTask(estimate, settings, goal=self.way_home())
        up_m, zero_m = -task.down_m, 0.0 if estimate.origin is None else estimate.origin.alt_m
        said, height_m = texts.RETURNS[self.flavour], self._home_ned_m[2] + up_m
        self.texts.extend(texts.filled(said, alt_m=ceil(zero_m + up_m), height_m=ceil(height_m)))
        return task

    def _going(self, goal: Setpoint) -> GoTask:
        """Return the task of going somewhere and staying there, as PX4 does."""
        return GoTask(self._estimate, self.settings, goal=goal, speeds=self._speeds)

    def _circling(self, centre: PartialVector, radius_m: float, *, clockwise: bool) -> CircleTask:
        """Return the task of circling round a place; where none is given, ahead of where the vehicle comes to rest."""
        estimate = self._estimate
        here, yaw = stopping_place(estimate, self.settings), estimate.yaw_rad
        ahead = (here[0] + radius_m * cos(yaw), here[1] + radius_m * sin(yaw), here[2])
        north, east, down = (ahead[i] if value is None else value for i, value in enumerate(centre))
        return CircleTask(
            Reference(here, (0.0, 0.0, 0.0)),
            self.settings,
            centre=(north, east, down),
            radius_m=radius_m,
            turns=inf,
            clockwise=clockwise,
            speeds=self._speeds,
        )

    def way_home(self) -> Destination:
        """Where a return leads from here, no higher than the fence's margin allows."""
        origin, fence = self._estimate.origin, self.settings.fence
        points = [] if origin is None else [(ned_offset_m(origin, point.place), point.height_m) for point in self.rally]
        goal = destination(self._estimate.position_ned_m, self._home_ned_m, points, self.settings)
        if FenceType.ALTITUDE not in self.guard.fence.enabled:
            return goal
        return goal._replace(height_m=min(goal.height_m, fence.ceiling_m - fence.margin_m))

    def _reached(self) -> PartialVector:
        """Return the height of a take-off that has just ended, to be kept as it was asked for."""
        task = self._task
        ended = isinstance(task, TakeoffTask) and not task.taking_off
        return (None, None, task.goal[2]) if ended else FREE

    def _guided(self) -> GuidedTask:
        px4 = self.flavour is Flavour.PX4
        task = GuidedTask(self._estimate, self.settings, place=self._reached(), lifts_off=px4, stops=not px4)
        if px4 and self._stream is not None and self._stream_fresh:
            task.take(self._stream, self._stream_s)
        return task

    def _disarm(self, text: StatusText) -> None:
        if self.armed:
            self.texts.append(text)
            self.flights += 1
        self.armed = False
        self._disarmed_at_s = self._now_s
        self._takeoff_height_m = None
        self.guard.monitor.disarmed()
        self.mission.disarmed()
        if self.flavour is Flavour.PX4 and not self.terminated:
            self._intend(self._armable_mode)
            if self.mode is not self.intended_mode:
                self._enter(self.intended_mode)
        self._refresh()

    def _intend(self, mode: Mode) -> None:
        self.intended_mode = mode
        if self.modes[mode].armable:
            self._armable_mode = mode

    def _happen(self, event: Event) -> None:
        if (mode := TRANSITIONS[self.flavour].get((self.mode, event))) is not None:
            self._intend(mode)
            self._enter(mode)

    def _fly(self) -> None:
        task = self._task
        spooled = self._now_s - self._armed_at_s >= self.settings.lift_off_s
        if not self.flying and spooled and task.lifts(self._estimate):
            self.flying = self._has_flown = True
            self._taken_off_at_s = self._now_s
            self.guard.trust_position(self._now_s)
            self._detector.reset()
            self.texts.extend(texts.TAKEN_OFF[self.flavour])
        height_m = self._home_ned_m[2] - self._estimate.position_ned_m[2]
        if self.flying and not self._has_climbed and height_m > _ALIGNS_ABOVE_M:
            self._has_climbed = True
            self.texts.extend(texts.CLIMBED[self.flavour])
        if self.flying or task.acts_on_ground:
            was_landing = task.landing
            task.advance(self._now_s, self._estimate)
            if isinstance(task, ReturnTask) and task.landing and not was_landing:
                self.texts.extend(texts.RETURNED[self.flavour])
            if task.finished:
                task.finished = False
                self._happen(task.event)

    def hit_ground(self, speed_m_s: float) -> None:
        """Note that the ground has been met: whoever simulates the flight says how fast."""
        self.texts.extend(texts.filled(texts.GROUND_HIT[self.flavour], speed_m_s=speed_m_s))

    def _watch_ground(self, thrust_m_s2: float) -> None:
        if self.flying and self._detector.landed(self._now_s, self._estimate, thrust_m_s2):
            self.flying = False
            self._landed_at_s = self._now_s
            self.texts.extend(texts.LANDED[self.flavour])
        if not self.armed or self.flying:
            return
        if self._has_flown:
            over = self.mode is Mode.AUTO and self.mission.progress is Progress.COMPLETE
            at_once = self.flavour is Flavour.ARDUPILOT and (over or self.flown_as in (Mode.LAND, Mode.RETURN))
            due = self._landed_at_s + (0.0 if at_once else self.settings.disarm_landed_s)
        else:
            due = self._armed_at_s + self.settings.disarm_unflown_s
        if self._now_s >= due:
            self._disarm(texts.DISARMED_BY_LANDING[self.flavour])

    def _choose(self, mode: Mode) -> None:
        """Note the mode that the pilot wants: a failsafe that acts is taken over, one that pauses is called off."""
        self._intend(mode)
        self.guard.monitor.overridden()

    def _protect(self, situation: Situation, fresh: FenceType) -> None:
        """Carry out what the guard decides, when it decides something new."""
        decision, said = self.guard.decide(situation, fresh)
        self.texts.extend(said)
        if not decision.is_other:
            return
        if decision.action > Action.NOTHING:
            before = self.mode
            self._act(decision.action)
            ardupilot = self.flavour is Flavour.ARDUPILOT
            if ardupilot and Failsafe.ESTIMATOR in decision.appeared and self.mode is not before:
                self.texts.append(texts.estimator_changed(self.rule.name))
        elif self.flavour is Flavour.PX4:
            self._go_on()

    def _go_on(self) -> None:
        """Return to the mode that the pilot wants, if that is possible."""
        if self.mode is not self.intended_mode and not self._obstacle(self.intended_mode):
            self._enter(self.intended_mode)

    def _act(self, action: Action) -> None:
        """Carry out a failsafe's action by the first of its modes that the estimator allows."""
        if action is Action.TERMINATE:
            self.terminate()
            return
        # ArduPilot stops the motors of a vehicle that has not left the ground.
        if action is Action.DISARM or (self.flavour is Flavour.ARDUPILOT and not self.flying):
            self._disarm(texts.DISARMED[self.flavour])
            return
        modes = FAILSAFE_MODES[self.flavour].get(action, ())
        for mode in modes:
            if mode is Mode.SMART_RTL and not self.path.places:
                self._say(Severity.WARNING, texts.UNAVAILABLE[modes[1]])
            elif not self._obstacle(mode):
                # Who has been told to land is not sent away again.
                if mode is not self.mode and self.intended_mode is not Mode.LAND:
                    self._enter(mode)
                break

    def _refresh(self) -> None:
        """Make the guidance of the present task."""
        task, speeds, limits = self._task, self._speeds, self._limits
        self.slowed = False
        if self._looked_at is not None and self._estimate.origin is not None:
            place = ned_offset_m(self._estimate.origin, self._looked_at)
            course = course_rad(self._estimate.position_ned_m, place)
            if course is not None and self.mode in (Mode.GUIDED, Mode.AUTO):
                task.turn(course)
        if not (self.armed and self.flying):
            self.guidance = Guidance(None, limits)
            return
        settings, speed, acceleration = self.settings, limits.speed_m_s, limits.acceleration_m_s2
        setpoint = task.setpoint
        if isinstance(task, GuidedTask):
            setpoint = within_fence(setpoint, self._estimate, settings, self.guard.fence, self._home_ned_m)
            self.slowed = setpoint is not task.setpoint
            speed, acceleration = settings.setpoint_speed_m_s, settings.setpoint_acceleration_m_s2
        limits = Limits(
            speeds.get(SpeedAxis.HORIZONTAL, task.speed_m_s or speed),
            speeds.get(SpeedAxis.UP, task.climb_m_s or limits.climb_m_s),
            speeds.get(SpeedAxis.DOWN, task.descent_m_s or limits.descent_m_s),
            acceleration,
            limits.braking_m_s2,
            limits.vertical_acceleration_m_s2,
            limits.tilt_rad,
            min(limits.yaw_rate_rad_s, self._yaw_rate_rad_s, task.yaw_rate_rad_s),
        )
        self.guidance = Guidance(setpoint, limits)
