"""How the curve is flown: within the limits, with the stops that the mission asks for, and where the nose looks."""

from itertools import pairwise
from math import isclose, pi, tan
from typing import Final

import numpy as np

from mission.decimals import count
from mission.geometry.arrays import BoolArray, FloatArray
from mission.geometry.bernstein import raised, times, undecided
from mission.geometry.regions import union_of
from mission.spec.heading import Look
from mission.verify.plans.lanes import photographed
from mission.verify.plans.motion import Motion, excess, motion_of
from mission.verify.plans.written import Verdict, Written

SAME_S: Final = 1e-6
_GRAVITY_M_S2: Final = 9.80665
_SAME: Final = 1e-9
_SETTLE_S: Final = 0.5  # after a turn
_STANDING_M_S: Final = 0.05  # slower than that the direction of the flight is none
_NEAR_M: Final = 1.0  # nearer than that to what it looks toward, the nose stays as it is
_HALVINGS: Final = 8
_MOMENT_S: Final = 1e-3
_ROUNDING: Final = 1.02  # of the yaw rate
_STRAIGHT_RAD: Final = 0.02


def limits_kept(plan: Written) -> Verdict:
    """Each leg within the limits, at rest wherever the curve turns at once; from leg to leg nothing jumps.

    The tube is in a region with a largest speed in no pieces of the proof but those that name a triangle of it.
    """
    of = plan.spec.limits
    limits = (of.speed_m_s, min(of.acceleration_m_s2, _GRAVITY_M_S2 * tan(of.tilt_rad)), of.jerk_m_s3)
    knots, sets = plan.knots_s, plan.sets
    slow = [(each, plan.own(each.name)) for each in plan.spec.regions if each.speed_m_s is not None]
    inside = {each: np.array([own[named].any() for named in sets]) for each, own in slow}
    for number, (curve, law, start) in enumerate(zip(plan.legs, plan.laws, plan.starts_s.tolist(), strict=False)):
        end_s, rests = float(curve.ends_s[-1]), [s for s, _ in law.rests()]
        turns = [s for s in curve.jumps_s.tolist() if min(abs(s - rest) for rest in rests) > _SAME * end_s]
        fault = law.fault or ("it ends elsewhere than its curve" if abs(law.place_s - end_s) > _SAME * end_s else None)
        fault = fault or (f"it does not rest at {turns[0]:.3f} s, where its curve turns at once" if turns else None)
        if not fault:
            motion = motion_of(curve, law, knots - start)
            piece = np.clip(np.searchsorted(knots, start + motion.middles) - 1, 0, len(sets) - 1)
            fault = excess(motion, limits)
            for region, named in inside.items() if not fault else ():
                fault = excess(motion.taken(named[piece]), (region.speed_m_s or 0.0, np.inf, np.inf))
                if fault:
                    fault = f"in {region.name}, {fault}"
                    break
        if fault:
            return f"the law of leg {number}: {fault}", ""
    most = "{:g} m/s, {:.3g} m/s^2 and {:g} m/s^3".format(*limits)
    begins = "" if plan.data.get("onward") is None else ", begun in flight"
    return _jump_between_legs(plan), f"{sum(law.duration_s for law in plan.laws):.1f} s, at most {most}{begins}"


def _jump_between_legs(plan: Written) -> str | None:
    """Where the vehicle would change its velocity or acceleration at once, from leg to leg or from lap to lap."""
    (rate, growth), onward = plan.laws[0].ends[0], plan.data.get("onward")
    if plan.laws[-1].ends[1] != (0.0, 0.0) or (onward is None and (rate, growth) != (0.0, 0.0)):
        return "the trajectory does not begin and end at rest"
    if onward is not None:
        slope, bend = (plan.legs[0].derivative(order)[0, 0] for order in (1, 2))
        told = np.array([slope * rate, bend * rate**2 + slope * growth]) - np.array(onward, dtype=float)
        if np.abs(told).max() > SAME_S:
            return "the trajectory does not begin with the velocity and the acceleration that it is said to"
    laps = [(plan.lap, plan.lap)] if plan.lap is not None else []
    for before, after in [*pairwise(range(len(plan.legs))), *laps]:
        ends, begins = plan.laws[before].ends[1], plan.laws[after].ends[0]
        if max(abs(end - begin) for end, begin in zip(ends, begins, strict=True)) > _SAME:
            return f"from leg {before} to leg {after} the rate jumps"
        for order in (1, 2) if any(ends) else ():
            end, begin = plan.legs[before].derivative(order)[-1, -1], plan.legs[after].derivative(order)[0, 0]
            if float(np.abs(end - begin).max()) > SAME_S * (1.0 + float(np.abs(end).max())):
                return f"from leg {before} to leg {after} the vehicle flies on, and the curve turns at once"
    return None


def stops_made(plan: Written) -> Verdict:
    """A stop in each visit of a region to loiter in, all of the tube inside, and no stops but in such regions."""
    stops = [(float(s), float(seconds)) for s, seconds in plan.data["stops"]]
    loitering = {region.name: region.loiter_s for region in plan.spec.regions if region.loiter_s > 0.0}
    if sorted(stops) != stops:
        return "`stops` are not in order", ""
    begun = plan.labelling.label([*plan.data["run"]["prefix"], *plan.data["run"]["suffix"]][0])
    for number, (s, seconds) in enumerate(stops):
        _, met, outside = plan.stop_met(s, plan.spec.flight.tube_m)
        inside = frozenset.intersection(*(plan.labelling.label(triangle) for triangle in met.tolist()))
        whole = {loitering[name] for name in inside & loitering.keys()}
        # In a region in which the flight begins, it stands as long as it still has to.
        rest = {loitering[name] for name in inside & loitering.keys() & begun} if number == 0 else set()
        if outside[0] or not (seconds in whole or any(seconds < each for each in rest)):
            return f"`stops.{number}` is not in a region in which to loiter for {seconds:g} s, with all of the tube", ""
    for name, begin, end in plan.visits(loitering):
        if not any(begin - SAME_S <= s <= end + SAME_S and seconds >= loitering[name] for s, seconds in stops):
            return f"there is no stop in {name}, which is visited from {begin:.3f} s to {end:.3f} s on the curve", ""
    legs = zip(plan.laws, plan.starts_s.tolist(), strict=False)
    held = [(start + s, seconds) for law, start in legs for s, seconds in law.rests() if seconds > SAME_S]
    for s, seconds in stops:
        if not any(isclose(s, at, abs_tol=SAME_S) and lasts >= seconds - SAME_S for at, lasts in held):
            return f"the trajectory does not stand still for {seconds:g} s at {s:.3f} s on its curve", ""
    # Before a lane that is photographed the vehicle may wait until it has turned; one that looks ahead, wherever it
    # turns, but no longer than it takes to turn right round.
    places = [s for s, _ in stops] + [lane.begin_s for lane in photographed(plan)]
    heading, round_s = plan.spec.flight.heading, pi / plan.spec.limits.yaw_rate_rad_s + 2.0 * _SETTLE_S
    turning_s = round_s if heading is not None and heading.look in {Look.AHEAD, Look.LANES} else 0.0
    # What may not come too soon is waited for, and is judged by its time.
    unasked = [] if plan.specification.timed else [s for s, lasts in sorted(held) if lasts > turning_s]
    others = [s for s in unasked if not any(isclose(s, place, abs_tol=SAME_S) for place in places)]
    fault = f"the trajectory stands still at {others[0]:.3f} s on its curve, for no stop" if others else None
    return fault, f"{count(len(stops), 'stop')}, {sum(seconds for _, seconds in stops):g} s"


def heading_kept(plan: Written) -> Verdict:
    """The nose can follow what it looks at: no faster than the yaw rate in flight, and with time to turn at rest.

    With q the direction of the flight, or that to the place that it looks toward, the yaw rate is |q x q'| / |q|^2:
    at most w where the polynomials w |q|^2 - q x q' and w |q|^2 + q x q' are not negative.
    """
    heading, most = plan.spec.flight.heading, plan.spec.limits.yaw_rate_rad_s
    if heading is None or heading.look is Look.FIXED:
        return None, "none is asked for" if heading is None else "it is one"
    toward = heading.look is Look.TOWARD
    centre = np.array(union_of(plan.partition, plan.own(heading.region)).centroid.coords[0]) if toward else np.zeros(2)
    far = _NEAR_M if toward else _STANDING_M_S

    def turns(pieces: Motion) -> BoolArray:
        looked = (centre - pieces.place, -pieces.velocity) if toward else (pieces.velocity, pieces.acceleration)
        room, size = _room(*looked, _ROUNDING * most), np.hypot(*looked[0].T)
        # In the end, what is left of where it begins to count is left out.
        counts = (size > far).any(axis=0) & (
            (size[[0, -1]] > far).all(axis=0) | ((pieces.ends_s - pieces.begins_s) > _MOMENT_S)
        )
        return np.asarray(counts & (room < 0.0))

    for number, (curve, law, start) in enumerate(zip(plan.legs, plan.laws, plan.starts_s.tolist(), strict=False)):
        motion = motion_of(curve, law)
        motion = motion.taken(~_between_lanes(plan, start + motion.middles))
        left = undecided(motion, turns)
        if len(left):
            return f"leg {number} turns by more than {most:.2f} rad/s at {left.begins_s[0]:.2f} s", ""
        if not toward and (fault := _unturned(motion, most)):
            return f"leg {number} {fault}", ""
    return None, f"at most {most:.2f} rad/s"


def _room(looked: FloatArray, change: FloatArray, most: float) -> FloatArray:
    """The least control point, shape (K,), of w |q|^2 -+ q x q' for control points of q and q'."""
    square = times(looked, looked).sum(axis=2, keepdims=True)
    crossed = times(looked[..., :1], change[..., 1:]) - times(looked[..., 1:], change[..., :1])
    room = most * square - np.abs(raised(crossed, square.shape[1] - 1))
    return np.asarray(room.min(axis=(1, 2)) + _SAME)


def _unturned(pieces: Motion, most: float) -> str | None:
    """Where the vehicle sets out after a rest that was too short for it to turn: between instants at which it moves."""
    found: list[tuple[FloatArray, FloatArray]] = []
    for _ in range(_HALVINGS):
        velocity, times_s = pieces.velocity[:, [0, -1]], np.stack((pieces.begins_s, pieces.ends_s), axis=1)
        moves = np.linalg.norm(velocity, axis=2) > _STANDING_M_S
        found.append((times_s[moves], velocity[moves]))
        pieces = pieces.taken(~moves.all(axis=1)).halves()
    t, velocity = (np.concatenate(each) for each in zip(*found, strict=True))
    order = np.argsort(t, kind="stable")
    turned = np.abs((np.diff(np.arctan2(*velocity[order].T)) + pi) % (2.0 * pi) - pi)
    late = turned > _STRAIGHT_RAD + _ROUNDING * most * np.diff(t[order])
    k = int(np.argmax(late)) if late.any() else None
    return k if k is None else f"sets out at {t[order][k + 1]:.2f} s, too soon to turn by {turned[k]:.2f} rad"


def _between_lanes(plan: Written, place_s: FloatArray) -> BoolArray:
    """Which places on the curve lie between two lanes of a visit along whose lanes the nose looks."""
    heading, found = plan.spec.flight.heading, np.zeros(len(place_s), dtype=np.bool_)
    for visit in plan.data["covers"]:
        if visit["trigger_m"] is not None or (heading is not None and heading.look is Look.LANES):
            found |= (place_s > visit["lanes_s"][0][0] - SAME_S) & (place_s < visit["lanes_s"][-1][1] + SAME_S)
    return found
