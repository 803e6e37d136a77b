"""How fast a path is flown: the trajectory along it within a mission's limits."""

import math
from collections.abc import Sequence
from itertools import pairwise
from typing import Final

import numpy as np

from mission.errors import NoRollingStartError
from mission.plan.covering import CoveredVisit
from mission.plan.turning import RunIn, looked_along, run_ins, slow_to_turn, turns_at_rest
from mission.spec.model import UNTIL_STOPPED, MissionSpec, Point
from mission.steering.grid import Limits, Slow
from mission.steering.joined import Curve, JoinedCurve, Piece, joins_smoothly
from mission.steering.known_laws import KnownLaw
from mission.steering.smoothing import FourierCurve
from mission.steering.stopping import stopping
from mission.steering.timing import even_rate, level_acceleration, time_law
from mission.steering.trajectory import Leg, Trajectory

_ROUNDING: Final = 1.0 - 1e-4
_OF_ACCELERATION: Final = 0.88
"""What a trajectory asks for: a vehicle that brakes with all that it has cannot make up for an error meanwhile."""

_IN_MOTION: Final = 1.06
_PULLED: Final = 1.15
"""Of speed and acceleration with which a flight begins, what its law may ask for: proofs of bounds leave a little."""

_SPARE: Final = 0.999

_Holds = tuple[tuple[float, float], ...]
_Standing = tuple[_Holds, _Holds]
"""The stops, and the waits to turn."""


def trajectory_of(
    spec: MissionSpec,
    curve: JoinedCurve,
    stops: tuple[tuple[float, float], ...],
    lap: int | None,
    covers: Sequence[CoveredVisit] = (),
    *,
    slow: tuple[Slow, ...] = (),
    toward_m: Point | None = None,
    begins: tuple[float, float] | None = None,
    known: Sequence[KnownLaw] = (),
    wait: tuple[float, float] | None = None,
) -> Trajectory:
    """The fastest flight along a curve within a mission's limits that has time to turn where its nose has to.

    Args:
        spec: The mission.
        curve: The smoothed path.
        stops: Pairs (curve parameter, seconds) at which the vehicle stands still.
        lap: Which leg is the lap.
        covers: The lanes on it.
        slow: Where the vehicle must be slow.
        toward_m: Where the nose looks, if that is one place.
        begins: The rate and its growth with which the flight begins; None where it begins at rest.
        known: Laws of pieces of the curve that are known already.
        wait: A place at which to stand still for a while, and how long, s; not where it begins in motion.

    Raises:
        ValueError: A stop is not on the curve, or it cannot be flown with such a beginning.
    """
    if not all(math.isfinite(s) and s <= curve.duration_s for s, _ in stops):
        raise ValueError("a stop is not on the curve")
    lanes = looked_along(spec, covers)
    slowly, turns_s = slow_to_turn(spec, curve, lanes, toward_m)
    slow, turns_s = (*slow, *slowly), (*turns_at_rest(spec, curve, lap), *turns_s)
    if begins is not None:
        turns_s = tuple((s, seconds) for s, seconds in turns_s if s > 0.0)
    if wait is not None:
        turns_s = (wait, *turns_s)
    flown = _trajectory(spec, curve, (stops, turns_s), lap, slow, begins=begins, known=known)
    turns: tuple[RunIn, ...] = ()
    # Where one part is flown more slowly another one may be faster than it was, and lack time in turn.
    while more := tuple(each for each in run_ins(flown, lanes, spec.limits.yaw_rate_rad_s) if each not in turns):
        turns += more
        waits = tuple((each.end_s, each.wait_s) for each in turns if each.wait_s > 0.0)
        slower = (*slow, *(Slow(each.begin_s, each.end_s, each.rate) for each in turns))
        # Of two waits at one place the first says where it is: the begin of a lane, and nowhere behind it.
        flown = _trajectory(spec, curve, (stops, (*waits, *turns_s)), lap, slower, begins=begins, known=known)
    return flown


def law_onward(spec: MissionSpec, piece: Piece, begins: tuple[float, float]) -> KnownLaw:
    """The law of the first piece of a curve, from a rate and its growth to rest.

    Raises:
        NoRollingStartError: There is none.
    """
    # On other cells its bounds are others, but for less than this.
    limits = Limits(*(_SPARE * limit for limit in limits_in_motion(spec, piece, begins)))
    try:
        law = time_law(
            piece,
            limits,
            fastest=_fastest(piece),
            slow=tuple(each._replace(speed_m_s=_SPARE * each.speed_m_s) for each in _slowed_down(spec, piece, begins)),
            ends=(begins[0], 0.0),
            growth=begins[1],
        )
    except ValueError as error:
        raise NoRollingStartError(str(error)) from error
    return KnownLaw(piece, law)


def _trajectory(
    spec: MissionSpec,
    curve: JoinedCurve,
    standing: _Standing,
    lap: int | None,
    slow: tuple[Slow, ...],
    *,
    begins: tuple[float, float] | None,
    known: Sequence[KnownLaw],
) -> Trajectory:
    rate = _rate_between_laps(spec, curve, [s for each in standing for s, _ in each], lap, slow)
    try:
        legs = _legs(spec, curve, standing, slow, (lap, rate), begins=begins, known=known)
    except ValueError:
        if rate == 0.0:
            raise
        legs = _legs(spec, curve, standing, slow, (lap, 0.0), begins=begins, known=known)
    laps = 1 if lap is None else None if spec.flight.laps == UNTIL_STOPPED else spec.flight.laps
    return Trajectory(legs, spec.flight.altitude_m, lap, laps)


def _legs(
    spec: MissionSpec,
    curve: JoinedCurve,
    standing: _Standing,
    slow: tuple[Slow, ...],
    flown_through: tuple[int | None, float],
    *,
    begins: tuple[float, float] | None,
    known: Sequence[KnownLaw],
) -> tuple[Leg, ...]:
    """The legs with their laws.

    Args:
        spec: The mission.
        curve: The smoothed path.
        standing: The stops, and the waits to turn.
        slow: Where the vehicle must be slow.
        flown_through: Which leg is the lap, and the rate with which it begins and ends.
        begins: As in ``trajectory_of``, of the first leg.
        known: As there.
    """
    (stops, waits), (lap, rate) = standing, flown_through
    legs = []
    for number, leg in enumerate(curve.legs):
        begin, end = curve.starts_s[number : number + 2].tolist()
        # At the place where two legs meet, it is the earlier one that has come into a region, and the later one that
        # begins with a lane: in each lap, if it is the lap.
        holds = [(s, held) for s, held in stops if begin < s <= end or (number == 0 and s <= begin)]
        holds += [(s, held) for s, held in waits if begin <= s < end]
        onward = begins if number == 0 else None
        first, growth = onward or (rate if lap in {number - 1, number} else 0.0, None)
        ends = (first, rate if lap in {number, number + 1} else 0.0)
        law = time_law(
            leg,
            _vehicle_limits(spec, leg) if onward is None else limits_in_motion(spec, leg, onward),
            fastest=_fastest(leg),
            holds=tuple((min(s - begin, leg.duration_s), held) for s, held in holds),
            slow=(
                *(
                    each._replace(begin_s=max(each.begin_s, begin) - begin, end_s=min(each.end_s, end) - begin)
                    for each in slow
                    if max(each.begin_s, begin) < min(each.end_s, end)
                ),
                *(() if onward is None else _slowed_down(spec, leg, onward)),
            ),
            ends=ends,
            growth=growth,
            known=known,
        )
        legs.append(Leg(leg, law))
    return tuple(legs)


def _rate_between_laps(
    spec: MissionSpec, curve: JoinedCurve, stops_s: list[float], lap: int | None, slow: tuple[Slow, ...]
) -> float:
    """The rate with which laps are begun and ended; 0 where they do not go on smoothly, or the vehicle stops there."""
    if lap is None or not 0 < lap < len(curve.legs) - 1:
        return 0.0
    ends_s = curve.starts_s[lap : lap + 2].tolist()
    near = curve.legs[lap - 1 : lap + 2]
    onward = (*pairwise(near), (curve.legs[lap],) * 2)
    if any(s in ends_s for s in stops_s) or not all(joins_smoothly(*each) for each in onward):
        return 0.0
    begin, end = curve.starts_s[[lap - 1, lap + 2]].tolist()
    slow = tuple(each for each in slow if begin < each.end_s and each.begin_s < end)
    speed_m_s, rate = (
        min((each.speed_m_s for each in slow), default=math.inf),
        min((each.rate for each in slow), default=math.inf),
    )
    limits = [_vehicle_limits(spec, leg) for leg in near]
    return min(
        even_rate(leg, each._replace(speed_m_s=min(each.speed_m_s, speed_m_s)), min(rate, _fastest(leg)))
        for leg, each in zip(near, limits, strict=True)
    )


def _fastest(curve: Curve) -> float:
    """The largest sigma': a series smooths a path that has the speed of its fields, which is the one asked for.

    Who stands has no speed that could be limited.
    """
    return 1.0 if _has_waves(curve) or curve.length_m == 0.0 else math.inf


def _has_waves(curve: Curve) -> bool:
    """Whether a curve, or a piece of it, is a Fourier series."""
    return any(
        isinstance(piece, FourierCurve) for piece in (curve.pieces if isinstance(curve, JoinedCurve) else [curve])
    )


def limits_in_motion(spec: MissionSpec, curve: Curve, begins: tuple[float, float]) -> Limits:
    """Those of a curve that begins in motion, which may be as fast as it asks for already."""
    limits = _vehicle_limits(spec, curve)
    (rate, growth), (slope, bend) = begins, (curve.derivative([0.0], order)[0] for order in (1, 2))
    velocity, acceleration = (float(np.hypot(*each)) for each in (slope * rate, bend * rate**2 + slope * growth))
    most = level_acceleration(spec.limits.acceleration_m_s2, spec.limits.tilt_rad)
    return limits._replace(
        speed_m_s=min(spec.limits.speed_m_s, max(limits.speed_m_s, _IN_MOTION * velocity)),
        acceleration_m_s2=min(most, max(limits.acceleration_m_s2, _PULLED * acceleration)),
    )


def _slowed_down(spec: MissionSpec, curve: Curve, begins: tuple[float, float]) -> tuple[Slow, ...]:
    """Where a flight that begins in motion is no faster than others any more: after the way on which it could stop."""
    limits, first = _vehicle_limits(spec, curve), float(np.hypot(*curve.derivative([0.0], 1)[0]))
    way = stopping(*begins, limits.acceleration_m_s2 / first, limits.jerk_m_s3 / first).way
    if way >= curve.duration_s:
        return ()
    return (Slow(way, curve.duration_s, speed_m_s=limits.speed_m_s),)


def _vehicle_limits(spec: MissionSpec, curve: Curve) -> Limits:
    """What the vehicle may do on a curve, level."""
    limits = spec.limits
    speed_m_s = limits.speed_m_s if _has_waves(curve) else min(limits.speed_m_s, spec.flight.speed_m_s)
    acceleration_m_s2 = _OF_ACCELERATION * level_acceleration(limits.acceleration_m_s2, limits.tilt_rad)
    # Third derivatives of curves far from the origin are good to fewer digits than those that a checker asks for.
    return Limits(speed_m_s, acceleration_m_s2, _ROUNDING * limits.jerk_m_s3)
