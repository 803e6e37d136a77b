"""The autopilot: one machine for both flavours, and the requests that it answers.

Requests answer at once with an `Outcome`; what they set going is done by the machine as vehicle time goes on.
"""

from math import inf, pi

from vehicle_sim.autopilot import texts
from vehicle_sim.autopilot.arming import REFUSALS, lacks_sticks, stick_denial
from vehicle_sim.autopilot.attitude_task import Attitude, AttitudeTask
from vehicle_sim.autopilot.geofence import Area, FencePlan, LocalFence
from vehicle_sim.autopilot.legs import GoTask
from vehicle_sim.autopilot.machine import Machine
from vehicle_sim.autopilot.mission_items import MissionItem, SpeedAxis
from vehicle_sim.autopilot.mission_task import MissionTask
from vehicle_sim.autopilot.modes import BY_ATTITUDE, DIRECT, HOLDING, Mode, Outcome, Severity
from vehicle_sim.autopilot.tasks import GuidedTask, HoldTask, TakeoffTask
from vehicle_sim.parameters import Flavour
from vehicle_sim.signals import Geodetic, PartialVector, Setpoint


class Autopilot(Machine):
    """Modes, arming, tasks and failsafes of one vehicle, as seen from its links."""

    def arm(self, *, force: bool = False, by_sticks: bool = False) -> Outcome:
        """Arm; `force` skips the checks of position, battery and mode, never those of attitude."""
        if self.armed:
            return Outcome.ACCEPTED
        denial = stick_denial(self.flavour, self.mode, self.rule, self.pilot, self._now_s, by_sticks=by_sticks)
        if denial and not force:
            self._say(Severity.CRITICAL, denial)
            return self._refusal
        # Its settings, its areas or home may have changed since it was looked at last.
        self.guard.look_at_fence(self._situation())
        faults = self.arming_faults
        if self.terminated or not self._estimate.status.attitude_ok or (faults and not force):
            text = faults[0].text if faults else "Flight terminated"
            self._say(Severity.CRITICAL, REFUSALS[self.flavour].format(text=text))
            return self._refusal
        if self.pilot.is_lost(self._now_s):
            # Who is not there now is not missed later.
            self.pilot.leave()
        self.armed = True
        self._armed_at_s = self._now_s
        self._has_flown = self._has_climbed = False
        self.intended_mode = self.mode
        if self._estimate.status.position_ok and not self._home_locked:
            self.place_home(self._here())
        self.texts.append((texts.ARMED_BY_STICKS if by_sticks else texts.ARMED)[self.flavour])
        if self.path.places:
            self.path.begin(self._estimate)
        self._begin(self.mode)
        return Outcome.ACCEPTED

    def disarm(self, *, force: bool = False, by_sticks: bool = False) -> Outcome:
        """Stop the motors; in the air only by `force`, or by sticks whose throttle is thrust."""
        if not self.armed:
            return Outcome.ACCEPTED
        if self.flying and not force and not (by_sticks and self.mode in DIRECT):
            if not by_sticks:
                self.texts.append(texts.DISARM_REFUSED[self.flavour])
            return self._refusal
        self._disarm((texts.DISARMED_BY_STICKS if by_sticks else texts.DISARMED)[self.flavour])
        return Outcome.ACCEPTED

    def set_mode(self, mode: Mode) -> Outcome:
        """Change the mode, if the flavour has it and, once armed, the estimator and the table allow it.

        PX4 answers a change to Offboard without a stream with ACCEPTED and does not make it (observed).
        """
        if mode not in self.modes:
            return Outcome.DENIED
        if self.flying and self.guard.recovers and self.mode is not self.intended_mode:
            if mode is self.mode:
                return Outcome.ACCEPTED
            self.texts.append(texts.mode_refused(self.flavour, self.modes[mode].name, "in fence recovery"))
            return self._refusal
        if mode is self.mode:
            self._choose(mode)
            return Outcome.ACCEPTED
        closed = self._is_closed(mode) or (
            self.armed and lacks_sticks(self.flavour, mode, self.modes[mode], self.pilot, self._now_s)
        )
        if reason := self.modes[mode].refusal if closed else self._obstacle(mode) if self.armed else "":
            if wants := self.modes[mode].wants:
                self._say(Severity.WARNING, wants)
            self.texts.append(texts.mode_refused(self.flavour, self.modes[mode].name, reason))
            streamless = self.flavour is Flavour.PX4 and mode is Mode.GUIDED and self._estimate.status.position_ok
            return Outcome.ACCEPTED if streamless else self._refusal
        self._choose(mode)
        self._enter(mode)
        return Outcome.ACCEPTED

    def takeoff(self, height_m: float | None = None) -> Outcome:
        """Climb on the spot to `height_m` above home (None: the parameter's height, where the flavour has one).

        ArduPilot wants GUIDED and motors armed, on the ground; PX4 changes the mode by itself.
        """
        height = self.settings.takeoff_height_m if height_m is None else height_m
        if self.flavour is Flavour.PX4:
            if not self._estimate.status.position_ok or self.home is None or not height < inf:
                return Outcome.TEMPORARILY_REJECTED
            self._takeoff_height_m = height_m
            self._choose(Mode.TAKEOFF)
            self._enter(Mode.TAKEOFF)
            return Outcome.ACCEPTED
        target_down = self._home_ned_m[2] - height
        if isinstance(self._task, TakeoffTask) and self.armed and self._task.down_m == target_down:
            return Outcome.ACCEPTED
        ready = self.armed and not self.flying and self.mode is Mode.GUIDED and self._estimate.status.position_ok
        if not ready or not 0.0 < height < inf:
            return Outcome.FAILED
        self._task = TakeoffTask(self._estimate, self.settings, down_m=target_down)
        return Outcome.ACCEPTED

    def land(self) -> Outcome:
        """Land where the vehicle is."""
        return self.set_mode(Mode.LAND)

    def return_to_launch(self) -> Outcome:
        """Fly home and land."""
        return self.set_mode(Mode.RETURN)

    def hold(self) -> Outcome:
        """Stay here."""
        return self.set_mode(HOLDING[self.flavour])

    def pause(self) -> Outcome:
        """Interrupt what is flown and stay here: ArduPilot within GUIDED or AUTO, PX4 by changing to Hold."""
        if self.flavour is Flavour.PX4:
            return self.hold()
        if isinstance(self._task, MissionTask):
            return Outcome.ACCEPTED if self.armed and self._task.pause() else Outcome.FAILED
        if not (self.armed and isinstance(self._task, GuidedTask)):
            return Outcome.FAILED
        self._paused = self._paused or self._task.setpoint
        self._task.halt(self._estimate)
        self._refresh()
        return Outcome.ACCEPTED

    def resume(self) -> Outcome:
        """Go on with what was paused; PX4 knows that of missions only."""
        if self.flavour is Flavour.PX4:
            return self.set_mode(Mode.AUTO)
        if isinstance(self._task, MissionTask):
            return Outcome.ACCEPTED if self.armed and self._task.resume() else Outcome.FAILED
        if not (self.armed and isinstance(self._task, GuidedTask)):
            return Outcome.FAILED
        if self._paused is not None:
            self._task.take(self._paused, self._now_s)
            self._paused = None
        self._refresh()
        return Outcome.ACCEPTED

    def load_mission(self, items: tuple[MissionItem, ...], current: int | None = None) -> None:
        """Replace the mission; PX4 looks at the whole and says what is wrong with it."""
        self.mission.load(items, current)
        fault = self.mission_fault
        if items and fault is not None and self.flavour is Flavour.PX4:
            self._say(Severity.CRITICAL, fault)

    def start_mission(self, first: int | None = None) -> Outcome:
        """Fly the mission, PX4 from item `first` on. PX4 arms, too; ArduPilot wants that done, and takes off."""
        if self.flavour is Flavour.PX4:
            if (fault := self.mission_fault) is not None:
                self._say(Severity.CRITICAL, fault)
                return Outcome.DENIED
            if first is not None and not self.mission.set_current(first):
                return Outcome.DENIED
            if self.set_mode(Mode.AUTO) is not Outcome.ACCEPTED:
                return Outcome.TEMPORARILY_REJECTED
            return self.arm()
        if self.set_mode(Mode.AUTO) is not Outcome.ACCEPTED:
            return Outcome.FAILED
        if isinstance(self._task, MissionTask):
            self._task.may_lift = True
            self._task.restart()
        return Outcome.ACCEPTED

    def reposition(
        self,
        place_ned_m: PartialVector,
        *,
        yaw_rad: float | None = None,
        speed_m_s: float | None = None,
        change_mode: bool = False,
    ) -> Outcome:
        """Fly to a place relative to the estimator's origin (axes left free: stay), and remain there.

        ArduPilot does it in GUIDED, which `change_mode` enters; PX4 in Hold, where without a place a change of height
        or heading keeps the place that is held or flown to, and without any of them the vehicle stops.
        """
        if not self._estimate.status.position_ok:
            return Outcome.DENIED
        mode = Mode.HOLD if self.flavour is Flavour.PX4 else Mode.GUIDED
        if self.flavour is Flavour.ARDUPILOT and self.mode is not mode and not change_mode:
            return Outcome.DENIED
        kept = self._task if isinstance(self._task, (HoldTask, TakeoffTask, GoTask)) else None
        if self.set_mode(mode) is not Outcome.ACCEPTED:
            return self._refusal
        north, east, down = place_ned_m
        if north is east is None and kept is not None and (down is not None or yaw_rad is not None):
            place_ned_m = (*kept.goal[:2], down)
            yaw_rad = kept.setpoint.yaw_rad if yaw_rad is None else yaw_rad
        task = HoldTask(self._estimate, self.settings, place=place_ned_m, yaw_rad=yaw_rad)
        if self._is_fenced_off(task.setpoint.position_ned_m):
            if self.flavour is Flavour.ARDUPILOT:
                return Outcome.FAILED
            # PX4 has accepted the command, and changed the mode, before it looks at the place.
            self.texts.append(texts.REPOSITION_OUTSIDE)
            return Outcome.ACCEPTED
        if isinstance(self._task, GuidedTask):
            self._task.go_to(task.setpoint)
        else:
            self._task = self._going(task.setpoint)
        if speed_m_s is not None:
            self.change_speed(speed_m_s)
        self._refresh()
        return Outcome.ACCEPTED

    def orbit(self, centre: PartialVector, *, radius_m: float | None = None, speed_m_s: float | None = None) -> Outcome:
        """Circle round a place as PX4 does, to the left below 0; axes left free: ahead of the vehicle, as high."""
        if self.set_mode(Mode.CIRCLE) is not Outcome.ACCEPTED:
            self._say(Severity.CRITICAL, "Orbit command rejected")
            return self._refusal
        radius = self.settings.circle_radius_m if radius_m is None else radius_m
        self._task = self._circling(centre, abs(radius), clockwise=radius >= 0.0)
        if speed_m_s is not None:
            self.change_speed(speed_m_s)
        self._refresh()
        return Outcome.ACCEPTED

    def follow(self, place_ned_m: PartialVector) -> None:
        """Go where whoever is followed asks for, in PX4's mode for that; its height stays."""
        if self.mode is Mode.FOLLOW and self.armed and isinstance(self._task, GoTask):
            place = (*place_ned_m[:2], self._task.goal[2])
            self._task = self._going(HoldTask(self._estimate, self.settings, place=place).setpoint)
            self._refresh()

    def look_at(self, place: Geodetic | None) -> None:
        """Look at a place in modes that fly by themselves, as ArduPilot does, until the mode changes."""
        self._looked_at = place

    def change_speed(self, speed_m_s: float, axis: SpeedAxis = SpeedAxis.HORIZONTAL) -> Outcome:
        """Fly no faster than `speed_m_s` along `axis` until the mode changes."""
        if not 0.0 < speed_m_s < inf:
            return self._refusal
        self._speeds[axis] = speed_m_s
        self._refresh()
        return Outcome.ACCEPTED

    def turn(self, yaw_rad: float, *, rate_rad_s: float | None = None, relative: bool = False) -> Outcome:
        """Look into a direction, by `relative` counted from the present one; only in modes that fly by themselves."""
        if self.flavour is Flavour.PX4:
            return Outcome.UNSUPPORTED
        if self.mode not in (Mode.GUIDED, Mode.AUTO):
            return Outcome.FAILED
        yaw = yaw_rad + self._estimate.yaw_rad if relative else yaw_rad
        self._task.turn((yaw + pi) % (2.0 * pi) - pi)
        self._yaw_rate_rad_s = rate_rad_s or inf
        self._refresh()
        return Outcome.ACCEPTED

    def set_home(self, place: Geodetic | None = None) -> Outcome:
        """Make `place` home (None: here), and keep it at the next arming."""
        if self._estimate.origin is None or (place is None and not self._estimate.status.position_ok):
            return self._refusal
        if not self.place_home(self._here() if place is None else place):
            return self._refusal
        self._home_locked = True
        return Outcome.ACCEPTED

    def setpoint(self, setpoint: Setpoint) -> bool:
        """Take a setpoint from outside; tell whether it is flown.

        In other modes than GUIDED ArduPilot ignores it; PX4 notes that the stream is alive. ArduPilot also ignores a
        place outside of the fence and goes on with what it had before.
        """
        self._stream_s = self._now_s
        self._stream = setpoint
        if self.mode is not Mode.GUIDED or not self.armed:
            return False
        if self.flavour is Flavour.ARDUPILOT and self._is_fenced_off(setpoint.position_ned_m):
            return False
        if not isinstance(self._task, GuidedTask):
            self._task = self._guided()
        if isinstance(self._task, GuidedTask):
            self._task.take(setpoint, self._now_s)
        self._refresh()
        return True

    def attitude(self, attitude: Attitude) -> bool:
        """Take an attitude from outside, as `setpoint` takes a setpoint; tell whether it is flown."""
        self._stream_s = self._now_s
        self._stream = None
        if self.mode not in BY_ATTITUDE or not self.armed:
            return False
        if not isinstance(self._task, AttitudeTask):
            px4 = self.flavour is Flavour.PX4
            self._task = AttitudeTask(self._estimate, self.settings, lifts_off=px4, stops=not px4)
        if isinstance(self._task, AttitudeTask):
            self._task.follow(attitude, self._now_s, self._estimate)
        self._refresh()
        return True

    def halt(self) -> None:
        """Stop where the vehicle is: ArduPilot's answer to a setpoint that it cannot fly."""
        if self.mode is Mode.GUIDED and self.armed and isinstance(self._task, GuidedTask):
            self._task.halt(self._estimate)
            self._refresh()

    def fence_in(self, plan: FencePlan) -> None:
        """Keep an uploaded fence; PX4 leaves areas out that home, or the flying vehicle, would breach at once."""
        origin = self._estimate.origin
        if self.flavour is Flavour.PX4 and origin is not None:
            inside: list[Area] = []
            for area in plan.areas:
                local = LocalFence((area,), origin)
                places = {"Home position": self._home_ned_m} if self.home is not None else {}
                if self.flying and self.settings.fence.reports:
                    places["current vehicle position"] = self._estimate.position_ned_m
                missing = [name for name, place in places.items() if local.excess_m(place[0], place[1]) >= 0.0]
                self.texts.extend(texts.fence_without(name) for name in missing)
                inside += [] if missing else [area]
            plan = FencePlan(tuple(inside), plan.return_point)
        self.guard.fence.load(plan)

    def _is_fenced_off(self, place: PartialVector) -> bool:
        """Whether the fence forbids a place, which is one only if all its axes are given."""
        north, east, down = place
        origin = self._estimate.origin
        if north is None or east is None or down is None or origin is None:
            return False
        return self.guard.fence.forbids((north, east, down), self._home_ned_m, origin)

    def take_over(self, before: Machine) -> None:
        """Keep what is stored over a restart of the autopilot `before`: mission, fence, rally points and flights."""
        self.flights = before.flights
        if before.mission.items:
            self.mission.load(before.mission.items)
        self.guard.fence.load(before.guard.fence.plan)
        self.rally = before.rally

    def heartbeat_from_ground(self, system_id: int, now_s: float) -> None:
        """Note that a ground station lives; ArduPilot counts only the one that its parameter names."""
        if self.settings.ground_system_id in (None, system_id):
            self._ground_heard_s = now_s
