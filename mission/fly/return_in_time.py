"""A return in time: what the charge of the battery has to say in flight, and what is done about it.

While the charge suffices for the rest of the plan, nothing is. Once it does not, a way home is planned from here beside
the flight, as if the vehicle were to turn back; how long that takes is known then. Whoever flies away from there can
come back in the same time at most, so another one is asked for only when no more than that time is spare. Where nothing
is spare even then, the return is planned from where the vehicle is, proved, and flown as a leg of its own.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass
from itertools import count
from typing import TYPE_CHECKING, Final

import numpy as np

from mission.fly.cause import Cause
from mission.fly.preflight.known import told_of
from mission.fly.preflight.surroundings import CAPACITY
from mission.fly.recording import Recording
from mission.fly.replanner import PlanRequest, Replanner
from mission.fly.replanning import Replanning
from mission.fly.watch import FlightWatch
from mission.geometry.arrays import FloatArray
from mission.link.course import Flown
from mission.link.guidance import Guidance
from mission.link.session import Session
from mission.monitor.charge import Charge, Moments, Prospect, Resolve, least_share, margin_s, resolved, share
from mission.monitor.stage import Stage
from mission.plan.rest import Rest
from mission.spec.air_time import landing_s
from mission.spec.battery import Battery
from mission.spec.model import Point

if TYPE_CHECKING:
    from mission.link.values import Battery as ToldBattery
    from mission.plan import FlightPlan

_LOOK_S: Final = 0.2
_FRESH_S: Final = 1.5
_AGAIN_S: Final = 2.0
_SAMPLES: Final = 64
_MUCH: Final = 1.05
_STILL: Final[Moments] = (0.0, 0.0, 0.0)
_LAP_AHEAD_S: Final = 2.0
"""So long before a lap ends it is decided whether it is the last."""


@dataclass(frozen=True)
class _Asked:
    number: int
    at_s: float


@dataclass(frozen=True)
class _WayHome:
    """A return that is proved.

    Attributes:
        from_s: Vehicle time at which it would begin.
        duration_s: How long its trajectory lasts.
        moments: Of it.
    """

    from_s: float
    duration_s: float
    moments: Moments


class ReturnInTime:
    """Watches the charge while the trajectory is flown, where the file says what a flight takes."""

    def __init__(
        self,
        session: Session,
        watch: FlightWatch,
        record: Recording,
        replanning: Replanning,
        *,
        replanner: Replanner,
        say: Callable[[str], None],
    ) -> None:
        """Watch nothing yet; ``say`` tells whoever watches the vehicle what is intended."""
        self._session, self._watch, self._record = session, watch, record
        self._replanning, self._replanner, self._say = replanning, replanner, say
        self._charge: Charge | None = None
        self._told: ToldBattery | None = None
        self._numbers = count(1)
        self._asked: _Asked | None = None
        self._way: _WayHome | None = None
        self._warned = False
        self._home: tuple[FlightPlan, Point] | None = None
        self._looked_s = self._again_s = -math.inf
        self._last_lap = ""
        self._since: list[Point] = []

    @property
    def text(self) -> str:
        """What the charge has changed of the flight, and what was left undone, in plain words; empty where nothing."""
        undone, charge, at_s = self._watch.legs.undone, self._charge, self._session.vehicle.clock.newest_s
        if charge is None or at_s is None or not (self._last_lap or undone):
            return ""
        left = f"{charge.left_mah(at_s):.0f} mAh of {charge.capacity_mah:.0f} were left"
        return "; ".join(filter(None, (self._last_lap, undone, left)))

    def turn(self, now_s: float) -> str:
        """Do what is due; says why the flight cannot go on, empty where it can.

        Args:
            now_s: The time here.
        """
        session, battery = self._session, self._watch.plan.spec.battery
        vehicle_s, guidance = session.contact.arrives_s(now_s), session.guidance
        if battery is None or vehicle_s is None or not isinstance(guidance, Guidance) or self._watch.began_s is None:
            return ""
        if self._charge is None:
            self._charge = self._charge_of(battery)
        charge, told = self._charge, session.vehicle.battery
        self._since.append(self._watch.velocity_m_s)
        if told is not None and told is not self._told:
            self._told = told
            pace = guidance.pace_at(vehicle_s)[1]
            charge.tell(vehicle_s, told.consumed_mah, told.percent, pace, _moments(np.array(self._since)))
            self._since.clear()
        if session.stage is not Stage.FLY or not session.redirectable or self._replanning.busy:
            self._asked = None
            return ""
        if not charge.is_known or vehicle_s < self._looked_s + _LOOK_S or self._watch.legs.given_up is not None:
            return ""
        self._looked_s = vehicle_s
        self._hear(charge, guidance, vehicle_s)
        prospect = self._prospect(charge, guidance, vehicle_s)
        return self._act(charge, prospect, guidance, vehicle_s, now_s)

    def _charge_of(self, battery: Battery) -> Charge:
        """Where nobody says what a full battery holds, no report of it tells anything."""
        capacity = CAPACITY.of(told_of(self._session.contact, self._watch.plan))
        return Charge(battery, 0.0 if capacity is None else capacity.value)

    def _prospect(self, charge: Charge, guidance: Guidance, vehicle_s: float) -> Prospect:
        """For how long there is charge beyond the rest, a return and the straight way."""
        spec, course, elapsed_s = self._watch.plan.spec, guidance.course_at(vehicle_s), _elapsed_s(guidance, vehicle_s)
        landing = landing_s(spec.flight.altitude_m)
        work, flown = guidance.correction.drag.work_w_kg, self._flown_w_kg(charge, guidance)
        landing *= share(work(_STILL), flown)
        # Laps that were not begun are another matter (``_count_laps``).
        rest_s = math.inf
        if not course.waits:
            once = course.trajectory.ended_after(elapsed_s)
            rest_s = (once.duration_s - elapsed_s) * share(work(_moments_of(once, elapsed_s)), flown)
        straight_s = math.dist(self._watch.place_m, self._home_m) / spec.limits.speed_m_s
        return_s, way = None, self._way
        if way is not None:
            more = self._share_of(way, charge, guidance)
            flight_s = more * charge.flying_s(way.duration_s) + landing
            # Flown on for so long, it takes so long to come back as well.
            away_s = max(vehicle_s - way.from_s, 0.0)
            turning_s = 2.0 * math.hypot(*self._watch.velocity_m_s) / spec.limits.acceleration_m_s2
            needed_s = flight_s + more * (away_s + turning_s) + margin_s(flight_s) + 2.0 * self._takes_s
            return_s = charge.spare_s(vehicle_s, needed_s)
        return Prospect(
            rest_s=charge.spare_s(vehicle_s, charge.flying_s(rest_s) + landing),
            return_s=return_s,
            straight_s=charge.spare_s(
                vehicle_s, least_share(flown) * (straight_s + landing_s(spec.flight.altitude_m)), reserve=False
            ),
            fresh=way is not None and vehicle_s - way.from_s <= _FRESH_S,
        )

    def _act(self, charge: Charge, now: Prospect, guidance: Guidance, vehicle_s: float, now_s: float) -> str:
        """Do what the table says."""
        resolve = resolved(now)
        if resolve is Resolve.GO_ON:
            self._count_laps(charge, guidance, vehicle_s, now_s)
            return ""
        figures = (
            f"battery: {charge.left_mah(vehicle_s):.0f} mAh left at {charge.current_a:.1f} A, "
            f"{charge.reserve_mah:.0f} to stay{self._against_wind(charge, guidance)}"
        )
        if resolve is Resolve.GIVE_UP:
            return f"{figures}: it suffices for no way home"
        if not self._warned:
            self._warned = True
            self._say(f"{figures}: not enough for the rest; flying on while a return suffices")
        if self._asked is None and vehicle_s >= self._again_s:
            if resolve is Resolve.LOOK_BACK:
                self._ask(guidance, vehicle_s)
            elif resolve is Resolve.RETURN:
                self._begin(figures, vehicle_s)
        return ""

    def _ask(self, guidance: Guidance, vehicle_s: float) -> None:
        """Ask for the way home from where the vehicle will be when there is an answer, as if it stood there."""
        watch, at_s = self._watch, vehicle_s + self._takes_s
        x, y, _ = guidance.reference(at_s).position_m
        foreseen = watch.monitor.foreseen((watch.place_m, (x, y)))
        leg = watch.legs.now
        laps, _ = leg.laps_at(foreseen, leg.in_tube_until_s)
        rest = Rest(foreseen.word, (x, y), laps=laps - leg.laps_before)
        # Numbers below zero: those from zero up are of plans that are to be flown.
        self._asked = _Asked(-next(self._numbers), at_s)
        self._replanner.ask(PlanRequest(self._asked.number, watch.plan, rest, returns=True))

    def _hear(self, charge: Charge, guidance: Guidance, vehicle_s: float) -> None:
        """Listen for the way home."""
        answer = None if self._asked is None else self._replanner.answer()
        if answer is None or self._asked is None or answer.number != self._asked.number:
            return
        at_s, self._asked = self._asked.at_s, None
        if answer.plan is not None:
            trajectory = answer.plan.trajectory
            self._way = way = _WayHome(at_s, trajectory.duration_s, _moments_of(trajectory, 0.0))
            self._record.write(
                "event",
                vehicle_s,
                name="way home",
                from_s=at_s,
                duration_s=way.duration_s,
                mean_current_a=charge.current_a,
                current_a=charge.current_a * self._share_of(way, charge, guidance),
            )
        else:
            self._again_s = vehicle_s + _AGAIN_S
            self._record.write("event", vehicle_s, name="no way home", reason=answer.refusal)

    def _begin(self, figures: str, vehicle_s: float) -> None:
        """Ask for the return that is flown."""

        def told(why: str) -> None:
            self._way = None
            if why:
                self._again_s = vehicle_s + _AGAIN_S

        reason = f"{figures}: returning while that suffices"
        self._say(reason)
        self._record.warn(reason)
        self._replanning.begin(Cause(reason, returns=True, told=told))

    def _count_laps(self, charge: Charge, guidance: Guidance, vehicle_s: float, now_s: float) -> None:
        """Let a lap be the last shortly before its end, if the charge does not suffice for another and the way back."""
        course, elapsed_s = guidance.course_at(vehicle_s), _elapsed_s(guidance, vehicle_s)
        once = course.trajectory.ended_after(elapsed_s)
        if once.laps == course.laps or once.laps_end_s - elapsed_s > _LAP_AHEAD_S:
            return
        another = course.trajectory.ended_after(once.laps_end_s + _LOOK_S)
        work, flown = guidance.correction.drag.work_w_kg, self._flown_w_kg(charge, guidance)
        needed_s = share(work(_moments_of(another, elapsed_s)), flown) * charge.flying_s(another.duration_s - elapsed_s)
        needed_s += share(work(_STILL), flown) * landing_s(self._watch.plan.spec.flight.altitude_m)
        if charge.spare_s(vehicle_s, needed_s + margin_s(needed_s)) >= 0.0 or not self._session.end_laps(now_s):
            return
        self._watch.returning = True
        self._last_lap = f"battery: {charge.left_mah(vehicle_s):.0f} mAh were not enough for one more lap"
        self._record.write("event", vehicle_s, name="returning after this lap", reason=self._last_lap)
        self._record.warn(self._last_lap)
        self._say(self._last_lap)

    def _share_of(self, way: _WayHome, charge: Charge, guidance: Guidance) -> float:
        """How much of the mean current the way home may take, with its own wind."""
        return share(guidance.correction.drag.work_w_kg(way.moments), self._flown_w_kg(charge, guidance))

    def _against_wind(self, charge: Charge, guidance: Guidance) -> str:
        """What is reckoned with on the way home, where that is much more; empty where it is not, or none is known."""
        more = 1.0 if self._way is None else self._share_of(self._way, charge, guidance)
        return f", up to {more * charge.current_a:.1f} A on the way home against the wind" if more > _MUCH else ""

    def _flown_w_kg(self, charge: Charge, guidance: Guidance) -> float:
        """Mean work against the air while the mean current flowed."""
        return guidance.correction.drag.work_w_kg(charge.moments)

    @property
    def _takes_s(self) -> float:
        """How long a plan takes about, in vehicle time."""
        return max(self._session.vehicle.clock.rate, 1.0) * self._replanner.takes_s

    @property
    def _home_m(self) -> Point:
        """Where the plan ends."""
        plan = self._watch.plan
        if self._home is None or self._home[0] is not plan:
            last = plan.trajectory.legs[-1]
            x, y = last.state(np.array([last.duration_s]))[0][0].tolist()
            self._home = plan, (x, y)
        return self._home[1]


def _moments(velocities_m_s: FloatArray) -> Moments:
    """Of some velocities, shape (K, 2)."""
    east, north = velocities_m_s.mean(axis=0).tolist()
    return east, north, float((velocities_m_s**2).sum(axis=1).mean())


def _moments_of(trajectory: Flown, from_s: float) -> Moments:
    """Of the rest of a trajectory."""
    times_s = np.linspace(min(from_s, trajectory.duration_s), trajectory.duration_s, _SAMPLES)
    return _moments(trajectory.state(times_s)[1])


def _elapsed_s(guidance: Guidance, vehicle_s: float) -> float:
    """Time on the course that is flown."""
    return max(guidance.pace_at(vehicle_s)[0], 0.0)
