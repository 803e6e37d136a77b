"""What the autopilot leaves open: a slow and bounded correction of the setpoints by the following error.

With the error e = p - p* on an axis (reported less planned, at the time of the report), four things are added:

- To the position, an offset c' = -e / T - c / T_0, kept within the reach. It takes out what stays, and fades where
  nothing does. A vehicle that needed none of it would be led off by the reach at most: it is part of the tube.
- To the velocity, -e per second, kept within ``_MOST_PULL_M_S``. It points at the path from wherever the vehicle
  is, so it leads no vehicle off.
- To the acceleration, -e' per second, kept within ``_MOST_DAMPING_M_S2``. The pull makes the autopilot's law stiffer,
  and so less damped: gusts at its own frequency swing one with PX4's gains out by 1.8 times what they do with this.
  A push of at most w then leads such a vehicle off by at most 0.53 w, and by 0.99 w without either, in s^2: the
  integral over the size of the answer to an impulse. What the tube has beyond that is left for its own lateness.
- To the acceleration also share * k * v*, with the drag k for which the vehicle leans (``drag``) and the planned speed.
  Both autopilots learn a steady push by an integral of some seconds' time, so they are late after each change of the
  drag that comes with speed: PX4 in its own simulator by 2 m. The share is 1 until the vehicle is seen ahead of the
  trajectory, as one with an observer of its own is, and falls then.

Velocity and acceleration are asked for ahead of their time, for a multicopter tilts before it accelerates, and
setpoints take their time on the link: by both together and by ``MOST_LEAD_S`` at most, for a push that turns round
while the vehicle brakes looks like being late, too. The lead begins with what tilting takes, grows while the velocity
is late where the trajectory accelerates or brakes, -e' a* / |a*|^2 per second, and falls where it is early. The
position is asked for ahead by the delay of the link, which shows in how far the vehicle is behind on the whole, since
autopilots let no lasting error stand. Both are leads in time, on the path itself, so they take nothing of the tube.

What is seen shows what was asked for a round trip of the link before. A loop of the gain k with the dead time D stays
calm while k D is small, so all gains fall by the same factor where D is long (``calm``).

All of it is frozen where nothing is flown, across gaps, and while the vehicle is farther off than ``_FARTHEST_M``.
"""

import math
from collections.abc import Iterable
from typing import Final

from mission.link.course import Reference
from mission.link.drag import DragEstimate
from mission.link.frames import Vector
from mission.monitor.gaps import GAP_S

OFFSET_S: Final = 10.0
"""T: an error that stays is half taken out after about seven seconds."""

FADING_S: Final = 30.0
"""T_0: how long an offset lasts that nothing asks for any more."""

_FIRST_LEAD_S: Final = 0.1
_TILTING_S: Final = 0.2
MOST_LEAD_S: Final = 0.4
_DELAY_PER_S: Final = 0.1
_GENTLE_M2_S4: Final = 0.5

_CALM: Final = 0.3
"""The longest round trip at which the gains are whole, s."""

_PULL_PER_S: Final = 1.0
_MOST_PULL_M_S: Final = 1.0
_DAMPING_PER_S: Final = 1.0
_MOST_DAMPING_M_S2: Final = 1.0
_FARTHEST_M: Final = 3.0
_SHARE_PER_S2: Final = 1.0
_SLOW_M2_S2: Final = 0.5
_LITTLE_DRAG_PER_S: Final = 0.15
"""What the laws of autopilots make up for by themselves."""

_DRAG_GROWTH_PER_S2: Final = 0.5
_MOST_PUSH_M_S2: Final = 5.0
_HALVINGS: Final = 10


class Correction:
    """The correction of one flight; ENU, level axes only.

    Attributes:
        offset_m: What is added to the position.
        lead_s: How much ahead of their time velocity and acceleration are asked for.
        delay_s: How much ahead of its time the position is.
        drag_per_s: What is multiplied by the planned velocity and added to the acceleration.
        drag: What the vehicle leans against the air.
        calm: Factor of all gains, from 0 to 1.
        error_m: The error of the last report that counted.
        error_m_s: That of its velocity.
        behind_m: The same without what the vehicle is ahead of the trajectory, the larger of both axes.
    """

    def __init__(self, reach_m: float) -> None:
        """Correct nothing yet; ``reach_m`` bounds the offset on each axis."""
        self.offset_m = (0.0, 0.0)
        self.drag_per_s = 0.0
        self.lead_s = _FIRST_LEAD_S
        self.delay_s = 0.0
        self.error_m = (0.0, 0.0)
        self.error_m_s = (0.0, 0.0)
        self.behind_m = 0.0
        self.calm = 1.0
        self._most_lead_s = _TILTING_S
        self._reach_m = reach_m
        self.drag = DragEstimate()
        self._share = 1.0
        self._seen_s = math.inf

    def know_delay(self, dead_s: float) -> None:
        """Reckon with so long a round trip of the link."""
        self._most_lead_s = min(_TILTING_S + dead_s, MOST_LEAD_S)
        self.calm = min(1.0, _CALM / max(dead_s, _CALM))

    def observe(
        self,
        t_s: float,
        error_m: tuple[float, float],
        planned: Reference,
        flown_m_s: Vector,
        attitude_rad: Vector | None,
    ) -> None:
        """Learn from a report on the trajectory.

        Args:
            t_s: Vehicle time of the report.
            error_m: Reported less planned position.
            planned: The point that was planned for that time.
            flown_m_s: Reported velocity.
            attitude_rad: Roll, pitch, yaw against NED; None where nothing is known of it.
        """
        passed_s, planned_m_s = t_s - self._seen_s, planned.velocity_m_s
        self._seen_s = t_s
        along = error_m[0] * planned_m_s[0] + error_m[1] * planned_m_s[1]
        square = planned_m_s[0] ** 2 + planned_m_s[1] ** 2
        ahead = max(along, 0.0) / (square or 1.0)
        self.behind_m = max(abs(e - ahead * v) for e, v in zip(error_m, planned_m_s, strict=False))
        if math.hypot(*error_m) > _FARTHEST_M:
            self.error_m = self.error_m_s = (0.0, 0.0)
            return
        self.error_m = error_m
        self.error_m_s = (flown_m_s[0] - planned_m_s[0], flown_m_s[1] - planned_m_s[1])
        if not 0.0 < passed_s <= GAP_S:
            return
        east, north = (
            _clipped(c - passed_s * (self.calm * e / OFFSET_S + c / FADING_S), self._reach_m)
            for c, e in zip(self.offset_m, error_m, strict=True)
        )
        self.offset_m = (east, north)
        learnt_s = self.calm * passed_s
        self._share = min(max(self._share - learnt_s * _SHARE_PER_S2 * along / (square + _SLOW_M2_S2), 0.0), 1.0)
        behind = -_DELAY_PER_S * along / (square + _SLOW_M2_S2)
        self.delay_s = min(max(self.delay_s + learnt_s * behind, 0.0), MOST_LEAD_S)
        gained = planned.acceleration_m_s2
        late = sum((v - f) * a for v, f, a in zip(planned_m_s[:2], flown_m_s[:2], gained[:2], strict=True))
        sharp = _SHARE_PER_S2 * late / (gained[0] ** 2 + gained[1] ** 2 + _GENTLE_M2_S4)
        self.lead_s = min(max(self.lead_s + learnt_s * sharp, 0.0), self._most_lead_s)
        if attitude_rad is not None:
            self.drag.observe(t_s, flown_m_s, attitude_rad)
        growth = _DRAG_GROWTH_PER_S2 * passed_s
        wanted = self._share * max(self.drag.drag_per_s - _LITTLE_DRAG_PER_S, 0.0)
        self.drag_per_s += _clipped(wanted - self.drag_per_s, growth)

    def corrected(self, planned: Reference) -> Reference:
        """What to ask for instead of a planned point."""
        (x, y, z), (vx, vy, vz), (ax, ay, az) = planned
        error_m, error_m_s, offset_m = self.error_m, self.error_m_s, self.offset_m
        return Reference(
            (x + offset_m[0], y + offset_m[1], z),
            (vx + self._pull_m_s(error_m[0]), vy + self._pull_m_s(error_m[1]), vz),
            (ax + self._push_m_s2(vx, error_m_s[0]), ay + self._push_m_s2(vy, error_m_s[1]), az),
        )

    def _pull_m_s(self, error_m: float) -> float:
        return _clipped(-self.calm * _PULL_PER_S * error_m, _MOST_PULL_M_S)

    def _push_m_s2(self, planned_m_s: float, error_m_s: float) -> float:
        damping = _clipped(self.calm * _DAMPING_PER_S * error_m_s, _MOST_DAMPING_M_S2)
        return _clipped(self.drag_per_s * planned_m_s, _MOST_PUSH_M_S2) - damping

    def rate_within(self, lean_m_s2: float, planned: Iterable[Reference]) -> float:
        """The largest rate, up to 1, at which points of the trajectory are flown without leaning more than that.

        Args:
            lean_m_s2: g tan(lean).
            planned: At the trajectory's own pace; not looked at where there is hardly any drag.
        """
        if self.drag.drag_per_s <= _LITTLE_DRAG_PER_S:
            return 1.0
        (still_x, still_y, _), drag = self.drag.lean_m_s2
        return min(_rate_within(lean_m_s2, (still_x, still_y), drag, point) for point in planned)

    def rest(self) -> None:
        """Nothing is flown: ask for the planned points, moved by the offset that was learned."""
        self.error_m = self.error_m_s = (0.0, 0.0)
        self.behind_m, self._seen_s = 0.0, math.inf


def _rate_within(lean_m_s2: float, still_m_s2: tuple[float, float], drag_per_s: float, planned: Reference) -> float:
    """The same for one point: flown at a rate s, it needs k (s v* - w) + s^2 a* of the lean, of it -k w at rest."""
    (vx, vy, _), (ax, ay, _) = planned.velocity_m_s, planned.acceleration_m_s2
    low, high = 0.0, 2.0
    for _ in range(_HALVINGS):
        rate = 0.5 * (low + high)
        east = still_m_s2[0] + rate * (drag_per_s * vx + rate * ax)
        north = still_m_s2[1] + rate * (drag_per_s * vy + rate * ay)
        low, high = (rate, high) if math.hypot(east, north) <= lean_m_s2 else (low, rate)
    return min(low, 1.0)


def _clipped(value: float, most: float) -> float:
    return max(-most, min(value, most))
