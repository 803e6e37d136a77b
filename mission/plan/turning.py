"""Time to turn: where the nose has to look somewhere, the vehicle has turned by then, or flies as slowly as it turns.

A camera looks along a lane from its first picture on. The heading goes on turning from the end of one lane to the begin
of the next, whatever the way there is like, and is then given ``SETTLE_S`` to come to rest. Where the vehicle is faster
than that, it slows down on its way, and waits at the begin of the lane where there is hardly any way.

With a heading that the mission asks for, the yaw rate is that of the direction: on r(s) flown at sigma', |r' x r''| /
|r'|^2 sigma' of the flight's, |d x r'| / |d|^2 sigma' of that to a place at d from the vehicle.
"""

import math
from collections.abc import Iterable
from dataclasses import dataclass
from itertools import pairwise
from typing import Final

import numpy as np

from mission.geometry.arrays import FloatArray, IntArray
from mission.plan.covering import CoveredVisit
from mission.spec.heading import YAW_RATE_DEG_S, Look
from mission.spec.model import MissionSpec, Point
from mission.steering.grid import Slow
from mission.steering.joined import Curve, JoinedCurve
from mission.steering.trajectory import Trajectory

TURN_RAD_S: Final = math.radians(YAW_RATE_DEG_S)
"""How fast the heading turns where the mission says nothing of that."""
SETTLE_S: Final = 0.75
NEAR_M: Final = 1.0
"""Nearer than that to what it looks toward, the nose stays as it is."""
_STRAIGHT_RAD: Final = 0.01
_SLOWEST: Final = 0.3
"""Of the planned speed: whoever would have to be slower waits for the rest."""
_SHARP_M: Final = 0.03
"""Radius of bends too sharp to be flown as slowly as the nose turns: there the vehicle stands still and turns."""
_CELLS: Final = 256
_CELLS_PER_WAVE: Final = 8
_HALVINGS: Final = 12
_LITTLE_RAD: Final = 0.1
_TINY: Final = 1e-100  # against a division by nothing
_SAMPLES: Final = 5  # of a cell, its ends among them
_SPARE: Final = 0.95  # of the yaw rate, for what is between samples
_MOST_PARTS: Final = 400
_NEXT: Final = 1e-4  # of a curve: where its direction at an end is looked for


@dataclass(frozen=True)
class RunIn:
    """A stretch of a path on which there must be time to turn.

    Attributes:
        begin_s: Where it begins, steering time.
        end_s: Where it ends, where the vehicle has turned.
        lasts_s: How long it takes at least.
    """

    begin_s: float
    end_s: float
    lasts_s: float

    @property
    def rate(self) -> float:
        """The largest share of the planned speed."""
        return max((self.end_s - self.begin_s) / self.lasts_s, _SLOWEST)

    @property
    def wait_s(self) -> float:
        """How long the vehicle waits at the end."""
        return self.lasts_s - (self.end_s - self.begin_s) / self.rate

    def missing_s(self, trajectory: Trajectory) -> float:
        """How much longer it would have to take on a trajectory; not positive where that is slow enough."""
        begin = trajectory.time_at([self.begin_s])
        end = trajectory.time_at([self.end_s], leaving=True)
        return float(self.lasts_s - (end - begin)[0])


def lead_s(rate_rad_s: float) -> float:
    """How long before a lane the heading is its own at most: turning right round takes no longer."""
    return math.pi / rate_rad_s + SETTLE_S


def turn_s(before_rad: float, after_rad: float, rate_rad_s: float = TURN_RAD_S) -> float:
    """How long it takes to turn from a heading to another, the short way round, and to come to rest."""
    angle = abs(math.remainder(after_rad - before_rad, 2.0 * math.pi))
    return angle / rate_rad_s + SETTLE_S if angle > _STRAIGHT_RAD else 0.0


def headings_of(lanes_m: FloatArray) -> FloatArray:
    """The headings of lanes, shape (n, 2, 2), clockwise from north: shape (n,), radians."""
    steps = lanes_m[:, 1] - lanes_m[:, 0]
    return np.asarray(np.arctan2(steps[:, 0], steps[:, 1]))


def looked_along(spec: MissionSpec, visits: Iterable[CoveredVisit]) -> tuple[CoveredVisit, ...]:
    """The visits along whose lanes the nose looks: those that are photographed, or all where the mission says so."""
    lanes = spec.flight.heading is not None and spec.flight.heading.look is Look.LANES
    return tuple(visit for visit in visits if lanes or visit.trigger_m is not None)


def run_ins(
    trajectory: Trajectory, visits: Iterable[CoveredVisit], rate_rad_s: float = TURN_RAD_S
) -> tuple[RunIn, ...]:
    """Where a trajectory, flown without regard to this, leaves too little time to turn before a lane.

    Args:
        trajectory: The flight.
        visits: Those along whose lanes the nose looks.
        rate_rad_s: How fast the vehicle turns.
    """
    starts, found = trajectory.curve.starts_s, []
    leg, end, heading = -1, 0.0, 0.0
    for visit in visits:
        for (begin_s, end_s), after in zip(visit.imaged_s.tolist(), headings_of(visit.lanes_m).tolist(), strict=True):
            here = int(np.searchsorted(starts[1:-1], begin_s, side="right"))
            # Whatever the heading is at the begin of a leg, turning right round is the most.
            from_s, lasts_s = float(starts[here]), lead_s(rate_rad_s)
            if here == leg:
                from_s, lasts_s = end, turn_s(heading, after, rate_rad_s)
            run_in = RunIn(from_s, begin_s, lasts_s)
            if run_in.missing_s(trajectory) > 0.0:
                found.append(run_in)
            leg, end, heading = here, end_s, after
    return tuple(found)


def turns_at_rest(spec: MissionSpec, curve: JoinedCurve, lap: int | None) -> tuple[tuple[float, float], ...]:
    """Where the path turns at once and the nose goes with it: pairs of the place and the seconds to wait there."""
    if spec.flight.heading is None or spec.flight.heading.look not in {Look.AHEAD, Look.LANES}:
        return ()
    pieces, rate = curve.pieces, spec.limits.yaw_rate_rad_s
    waits = {
        place: turn_s(_direction(before, at_end=True), _direction(after), rate)
        for place, (before, after) in zip(curve.joints_s[1:-1].tolist(), pairwise(pieces), strict=True)
    }
    if lap is not None:
        begin, leg = float(curve.starts_s[lap]), curve.legs[lap]
        waits[begin] = max(waits.get(begin, 0.0), turn_s(_direction(leg, at_end=True), _direction(leg), rate))
    return tuple((place, seconds) for place, seconds in sorted(waits.items()) if seconds > 0.0)


def _direction(curve: Curve, *, at_end: bool = False) -> float:
    """Where a curve leads at its begin or its end, clockwise from north."""
    near = _NEXT * curve.duration_s
    ends = [curve.duration_s - near, curve.duration_s] if at_end else [0.0, near]
    (x, y), (u, v) = curve.position(ends).tolist()
    return math.atan2(u - x, v - y)


def slow_to_turn(
    spec: MissionSpec, curve: JoinedCurve, visits: Iterable[CoveredVisit], toward_m: Point | None
) -> tuple[tuple[Slow, ...], tuple[tuple[float, float], ...]]:
    """The parts of a curve on which the nose could not follow what the mission says that it looks at.

    In those on which it could not even where the vehicle creeps it is to wait, for the time that it takes to turn.

    Args:
        spec: The mission.
        curve: The path.
        visits: Those along whose lanes the nose looks; between these lanes it turns anyhow, and is given the time.
        toward_m: What it looks toward; None where that is the direction of the flight.

    Returns:
        Where the vehicle is to be slow, and pairs of a place and the seconds to wait there.
    """
    heading = spec.flight.heading
    if heading is None or heading.look is Look.FIXED or (heading.look is Look.TOWARD and toward_m is None):
        return (), ()
    knots = _resolved(curve, curve.sampled(max(_CELLS, _CELLS_PER_WAVE * curve.frequencies)).knots_s)
    shares = np.linspace(1e-6, 1.0 - 1e-6, _SAMPLES)
    within = knots[:-1, None] + np.diff(knots)[:, None] * shares
    place, slope, bend = (values.reshape(*within.shape, 2) for values in curve.jet(within.ravel()))
    reach = place - np.asarray(toward_m) if heading.look is Look.TOWARD else slope
    change = slope if heading.look is Look.TOWARD else bend
    square = (reach**2).sum(axis=2)
    turning = np.abs(reach[..., 0] * change[..., 1] - reach[..., 1] * change[..., 0])
    turning = np.divide(turning, square, out=np.zeros_like(square), where=square > 0.0)
    if heading.look is Look.TOWARD:
        turning[square < NEAR_M**2] = 0.0
    # A curve that goes back on itself turns where it has no speed.
    angles = np.arctan2(reach[:, [0, -1], 0], reach[:, [0, -1], 1])
    turned = np.abs((angles[:, 1] - angles[:, 0] + math.pi) % (2.0 * math.pi) - math.pi)
    turned = turned if heading.look is not Look.TOWARD else np.zeros_like(turned)
    most, steep = (
        np.maximum(turning.max(axis=1), turned / np.diff(knots)),
        np.hypot(slope[..., 0], slope[..., 1]).max(axis=1),
    )
    steep, most = np.maximum(steep, _TINY), np.maximum(most, _TINY)
    rates = _SPARE * spec.limits.yaw_rate_rad_s / most
    slow = rates < min(spec.limits.speed_m_s, spec.flight.speed_m_s) / steep
    for visit in visits:
        for before, after in zip(visit.lanes_s[:-1, 1].tolist(), visit.lanes_s[1:, 0].tolist(), strict=True):
            slow &= ~((knots[:-1] >= before) & (knots[1:] <= after))
    creep = _SHARP_M * spec.limits.yaw_rate_rad_s / steep
    waits: list[tuple[float, float]] = []
    for group in _runs(np.flatnonzero(slow & (rates < creep))):
        angle = float(np.maximum(turning[group].mean(axis=1) * np.diff(knots)[group], turned[group]).sum())
        sharpest = int(group[np.argmax(most[group])])
        waits.append(
            (
                0.5 * float(knots[sharpest] + knots[sharpest + 1]),
                min(angle, math.pi) / spec.limits.yaw_rate_rad_s + SETTLE_S,
            )
        )
    rates, cells = np.maximum(rates, creep), np.flatnonzero(slow)
    # Of very many, those that are next to each other are one.
    groups = _runs(cells) if len(cells) > _MOST_PARTS else list(cells[:, None])
    parts = [Slow(float(knots[group[0]]), float(knots[group[-1] + 1]), float(rates[group].min())) for group in groups]
    return tuple(parts), tuple(waits)


def _resolved(curve: JoinedCurve, knots: FloatArray) -> FloatArray:
    """Knots between which a curve turns by little, however sharp its bends are."""
    for _ in range(_HALVINGS):
        _, slope, bend = curve.jet(0.5 * (knots[1:] + knots[:-1]))
        turning = np.abs(slope[:, 0] * bend[:, 1] - slope[:, 1] * bend[:, 0])
        turned = np.diff(np.unwrap(np.arctan2(*curve.derivative(knots, 1).T)))
        coarse = np.abs(turned) > _LITTLE_RAD
        coarse |= turning * np.diff(knots) > _LITTLE_RAD * (slope**2).sum(axis=1)
        if not coarse.any():
            break
        knots = np.union1d(knots, 0.5 * (knots[1:] + knots[:-1])[coarse])
    return knots


def _runs(cells: IntArray) -> list[IntArray]:
    """Numbers in order, those that follow each other together."""
    return [run for run in np.split(cells, np.flatnonzero(np.diff(cells) > 1) + 1) if len(run)]
