"""What the autopilot knows and is doing, and what can be seen of it from outside.

`machine` drives it from inside, `requests` from outside.
"""

from collections import deque
from dataclasses import replace
from math import hypot, inf
from typing import TYPE_CHECKING, Final

from vehicle_sim.autopilot import texts
from vehicle_sim.autopilot.arming import ON_REQUEST_ALONE, ArmingFault, arming_faults
from vehicle_sim.autopilot.feasibility import mission_fault
from vehicle_sim.autopilot.guard import Guard, Situation
from vehicle_sim.autopilot.hand import Pilot
from vehicle_sim.autopilot.landing import LandDetector
from vehicle_sim.autopilot.legs import CircleTask
from vehicle_sim.autopilot.mission import Mission
from vehicle_sim.autopilot.modes import (
    FIRST_MODE,
    MODES,
    Failsafe,
    LandedState,
    Mode,
    ModeRule,
    Outcome,
    Severity,
    StatusText,
)
from vehicle_sim.autopilot.retracing import FlownPath
from vehicle_sim.autopilot.tasks import LevelTask, Task
from vehicle_sim.battery import Battery, BatteryLevel
from vehicle_sim.geodesy import geodetic_at, ned_offset_m
from vehicle_sim.parameters import Action, Flavour, FlightSettings
from vehicle_sim.signals import CameraOrder, Estimate, Geodetic, Guidance, Setpoint, Vector

if TYPE_CHECKING:
    from vehicle_sim.autopilot.mission_items import SpeedAxis
    from vehicle_sim.autopilot.rally import RallyPoint

_MOST_TEXTS: Final = 64
_LINGERS_S: Final = 0.5
_FARTHEST_HOME_M: Final = 50_000.0
"""ArduCopter's `far_from_EKF_origin`: once in every direction, of late in the vertical alone."""


class State:
    """Modes, arming, tasks and failsafes of one vehicle, as they are now.

    Public attributes to read: `mode`, `intended_mode` (the one last asked for), `armed`, `flying`, `flights` (how often
    it was disarmed), `home`, `home_revision` (grows with every change of home), `guidance`, `slowed` (the fence keeps
    velocities lower than asked), `guard`, `pilot` (who may be at the sticks), and `texts`, a queue whose reader pops
    what it has taken (old ones drop out of a full queue); `camera_orders` is such a queue, too. To be set: `rally`.
    """

    def __init__(self, flavour: Flavour, settings: FlightSettings, battery: Battery, estimate: Estimate) -> None:
        """Stand on the ground, disarmed, in the first mode of the flavour."""
        self.flavour = flavour
        self.modes = MODES[self.flavour]
        self.mode = FIRST_MODE[self.flavour]
        self.armed = False
        self.flying = False
        self.terminated = False
        self.home: Geodetic | None = None
        self.home_revision = 0
        self.mission = Mission(self.flavour)
        self.texts: deque[StatusText] = deque(texts.BOOTED[flavour], maxlen=_MOST_TEXTS)
        self.camera_orders: deque[CameraOrder] = deque(maxlen=_MOST_TEXTS)
        self.settings, self._limits = settings, settings.limits()
        self._battery = battery
        self._estimate = estimate
        self._now_s = 0.0
        self._home_locked = False
        self._home_ned_m: Vector = (0.0, 0.0, 0.0)
        self._aligned = False
        self._origin_known = False
        self._detector = LandDetector()
        self.guard = Guard(self.flavour, self.settings)
        self.rally: tuple[RallyPoint, ...] = ()
        self.intended_mode = self._armable_mode = self.mode
        self._wind_ned_m_s: Vector = (0.0, 0.0, 0.0)
        self.flights = 0
        self._armed_at_s = 0.0
        self._taken_off_at_s = 0.0
        self._has_flown = self._has_climbed = False
        self._landed_at_s = -inf
        self._disarmed_at_s = -inf
        self._reminded_at_s = -inf
        self._ground_heard_s: float | None = None
        self._stream_s = -inf
        self._stream: Setpoint | None = None
        self._takeoff_height_m: float | None = None
        self._speeds: dict[SpeedAxis, float] = {}
        self._yaw_rate_rad_s = inf
        self._paused: Setpoint | None = None
        self._looked_at: Geodetic | None = None
        self.pilot = Pilot(self.settings.hand)
        self.path = FlownPath()
        self._task: Task = LevelTask(estimate)
        self.slowed = False
        self.guidance = Guidance(None, self._limits)

    # What can be seen from outside.

    @property
    def rule(self) -> ModeRule:
        """The table's row of the present mode."""
        return self.modes[self.mode]

    @property
    def armed_at_s(self) -> float | None:
        """When it was armed; None while it is not."""
        return self._armed_at_s if self.armed else None

    @property
    def taken_off_at_s(self) -> float | None:
        """When it left the ground for the first time since it was armed; None before, and once it is disarmed."""
        return self._taken_off_at_s if self.armed and self._has_flown else None

    @property
    def flown_as(self) -> Mode:
        """The mode that the present one is flown like, which is mostly itself."""
        return self.rule.like or self.mode

    @property
    def target(self) -> Setpoint | None:
        """The setpoint that is flown now; None while the motors idle."""
        return self.guidance.setpoint

    @property
    def circle(self) -> CircleTask | None:
        """The circle that is flown in the mode for that."""
        return self._task if self.mode is Mode.CIRCLE and isinstance(self._task, CircleTask) else None

    @property
    def failsafe(self) -> Failsafe:
        """The worst failure that is present."""
        return self.guard.monitor.present

    @property
    def in_failsafe(self) -> bool:
        """Whether the heartbeat calls the state critical."""
        return self.guard.in_failsafe

    @property
    def landed_state(self) -> LandedState:
        """Where the vehicle is between ground and air."""
        if not self.flying:
            # ArduPilot says that it lands for a moment after it has landed and disarmed (observed).
            lingers = self.flavour is Flavour.ARDUPILOT and self._task.landing and not self.armed
            if lingers and self._now_s - self._disarmed_at_s < _LINGERS_S:
                return LandedState.LANDING
            return LandedState.ON_GROUND
        if self._task.landing:
            return LandedState.LANDING
        return LandedState.TAKEOFF if self._task.taking_off else LandedState.IN_AIR

    @property
    def arming_faults(self) -> tuple[ArmingFault, ...]:
        """The arming checks that fail now, in the present mode."""
        return self.arming_faults_in(self.mode)

    def arming_faults_in(self, mode: Mode) -> tuple[ArmingFault, ...]:
        """Return the arming checks that would fail now in another mode."""
        rule = self.modes[mode]
        return arming_faults(
            flavour=self.flavour,
            mode=mode,
            rule=replace(rule, armable=self.settings.mission_arms) if mode is Mode.AUTO else rule,
            estimate=self._estimate,
            home_known=self.home is not None,
            setpoints_fresh=self._stream_fresh,
            ground_lost=self._ground_lost,
            battery=self._battery.level if self.settings.battery_checked else BatteryLevel.OK,
            fence_blind=self.guard.is_blind(position_ok=self._estimate.status.position_ok, home=self.home is not None),
            outside_fence=self.guard.is_outside,
            mission_flyable=mode is not Mode.AUTO or self.mission_fault is None,
            pilot=self.pilot,
            now_s=self._now_s,
        )

    @property
    def prearm_faults(self) -> tuple[ArmingFault, ...]:
        """The arming checks that fail now, of those that are looked at all the time."""
        later = ON_REQUEST_ALONE[self.flavour]
        return tuple(fault for fault in self.arming_faults if fault.reason not in later)

    @property
    def ready_to_arm(self) -> bool:
        """Whether arming would be accepted."""
        return not self.armed and not self.terminated and not self.arming_faults

    @property
    def mission_fault(self) -> str | None:
        """Why the mission cannot be flown now; None if it can. Before there is a home, PX4 does not know."""
        if not self.mission.present:
            return "No valid mission available"
        if self.flavour is Flavour.ARDUPILOT or self.home is None:
            return None
        return mission_fault(self.mission.items, self.settings, self.home, landed=not self.flying)

    @property
    def ground_heard(self) -> bool:
        """Whether a ground station lives."""
        heard = self._ground_heard_s
        return heard is not None and self._now_s - heard <= self.settings.ground_timeout_s

    @property
    def _stream_fresh(self) -> bool:
        return self._now_s - self._stream_s <= self.settings.setpoint_timeout_s

    @property
    def _ground_lost(self) -> bool:
        acts = self.settings.ground_loss is not Action.NOTHING
        return acts and self._ground_heard_s is not None and not self.ground_heard

    @property
    def _refusal(self) -> Outcome:
        return Outcome.TEMPORARILY_REJECTED if self.flavour is Flavour.PX4 else Outcome.FAILED

    # What all that follows goes by.

    def _situation(self) -> Situation:
        return Situation(
            self._now_s,
            self._estimate,
            self.flying,
            self.intended_mode,
            self._stream_fresh,
            self.pilot.is_lost(self._now_s),
            self._ground_lost,
            self._battery.level,
            self._wind_ned_m_s,
            self._home_ned_m,
        )

    def _say(self, severity: Severity, text: str) -> None:
        self.texts.append(StatusText(severity, text))

    def _here(self) -> Geodetic:
        origin = self._estimate.origin or Geodetic(0.0, 0.0, 0.0)
        return geodetic_at(origin, self._estimate.position_ned_m)

    def place_home(self, place: Geodetic) -> bool:
        """Make a place home; tell whether it is near enough to the estimator's origin to be one (to ArduPilot)."""
        ned_m = self._home_ned_m if self._estimate.origin is None else ned_offset_m(self._estimate.origin, place)
        if self.flavour is Flavour.ARDUPILOT and hypot(*ned_m) > _FARTHEST_HOME_M:
            return False
        self.home = place
        self.home_revision += 1
        self._home_ned_m = ned_m
        return True
