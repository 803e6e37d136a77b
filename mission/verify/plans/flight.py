"""How the curve is flown: within the limits, with the stops, the lanes and the pictures that the mission asks for."""

from collections.abc import Iterator
from itertools import accumulate, groupby, pairwise
from math import atan2, isclose, pi, remainder, tan
from typing import Final, NamedTuple

import numpy as np
import shapely

from mission.geometry.regions import union_of
from mission.spec.heading import Look
from mission.spec.model import Region
from mission.verify.plans.lanes import cover_faults
from mission.verify.plans.law import Law
from mission.verify.plans.patches import Patches, patches_of
from mission.verify.plans.proof import Verdict, certified, pieces_of
from mission.verify.plans.tube import touching
from mission.verify.plans.written import Written

GRAVITY_M_S2: Final = 9.80665
_SAME: Final = 1e-9
_SAME_S: Final = 1e-6
_SETTLE_S: Final = 0.5  # after a turn
_STRAIGHT_RAD: Final = 0.01


def limits_kept(plan: Written) -> Verdict:
    """Each leg within the limits, at rest wherever the curve turns at once; from leg to leg nothing jumps."""
    limits, durations = plan.spec.limits, []
    level = min(limits.acceleration_m_s2, GRAVITY_M_S2 * tan(limits.tilt_rad))
    for number, (curve, law) in enumerate(zip(plan.legs, plan.laws, strict=True)):
        end_s, rests = float(curve.ends_s[-1]), [rest.s for rest in law.rests()]
        turns = [s for s in curve.jumps_s.tolist() if min(abs(s - rest) for rest in rests) > _SAME * end_s]
        fault = (
            law.fault
            or ("it ends elsewhere than its curve" if abs(law.place_s - end_s) > _SAME * end_s else None)
            or (f"it does not rest at {turns[0]:.3f} s, where its curve turns at once" if turns else None)
            or law.excess(curve, limits.speed_m_s, level, limits.jerk_m_s3)
        )
        for region in plan.spec.regions if not fault else ():
            fault = fault or _too_fast(plan, curve, law, region)
        if fault:
            return f"the law of leg {number}: {fault}", ""
        durations.append(law.duration_s)
    if fault := _seams(plan):
        return fault, ""
    most = f"{limits.speed_m_s:g} m/s, {level:.3g} m/s^2 and {limits.jerk_m_s3:g} m/s^3"
    return None, f"{sum(durations):.1f} s, at most {most}"


def _seams(plan: Written) -> str | None:
    """Where the vehicle would change its velocity or acceleration at once, from leg to leg or from lap to lap."""
    (rate, growth), onward = plan.laws[0].ends[0], plan.data.get("onward")
    if plan.laws[-1].ends[1] != (0.0, 0.0) or (onward is None and (rate, growth) != (0.0, 0.0)):
        return "the trajectory does not begin and end at rest"
    if onward is not None:
        slope, bend = (plan.legs[0].derivative(order)[0, 0] for order in (1, 2))
        told = np.array([slope * rate, bend * rate**2 + slope * growth]) - np.array(onward, dtype=float)
        if np.abs(told).max() > _SAME_S:
            return "the trajectory does not begin with the velocity and the acceleration that it is said to"
    count = len(plan.legs)
    for before, after in [*pairwise(range(count)), *([(plan.lap, plan.lap)] if plan.lap is not None else [])]:
        ends, begins = plan.laws[before].ends[1], plan.laws[after].ends[0]
        if max(abs(end - begin) for end, begin in zip(ends, begins, strict=True)) > _SAME:
            return f"from leg {before} to leg {after} the rate jumps"
        for order in (1, 2) if any(ends) else ():
            end, begin = plan.legs[before].derivative(order)[-1, -1], plan.legs[after].derivative(order)[0, 0]
            if float(np.abs(end - begin).max()) > _SAME_S * (1.0 + float(np.abs(end).max())):
                return f"from leg {before} to leg {after} the vehicle flies on, and the curve turns at once"
    return None


def _too_fast(plan: Written, curve: Patches, law: Law, region: Region) -> str | None:
    """Where the vehicle may be faster than it may be while any of its tube is in a region."""
    if region.speed_m_s is None:
        return None
    own = np.zeros(plan.partition.size, dtype=np.bool_)
    own[plan.labelling.triangles_of(region.name)] = True
    for stretch in touching(plan.ground, curve, plan.spec.flight.tube_m, own):
        fault = law.excess(curve, region.speed_m_s, on_s=stretch)
        if fault:
            return f"in {region.name}, {fault}"
    return None


def stops_made(plan: Written) -> Verdict:
    """A stop in each visit of a region to loiter in, all of the tube inside, and no stops but in such regions."""
    stops = [(float(s), float(seconds)) for s, seconds in plan.data["stops"]]
    loitering = {region.name: region.loiter_s for region in plan.spec.regions if region.loiter_s > 0.0}
    half = plan.spec.flight.tube_m + plan.ground.slack_m
    if sorted(stops) != stops:
        return "`stops` are not in order", ""
    for number, (s, seconds) in enumerate(stops):
        x, y = plan.curve.at(np.array([s]))[0].tolist()
        _, met, outside = plan.ground.met(np.array([shapely.box(x - half, y - half, x + half, y + half)]))
        inside = frozenset.intersection(*(plan.labelling.label(triangle) for triangle in met.tolist()))
        if outside[0] or seconds not in {loitering[name] for name in inside & loitering.keys()}:
            return f"`stops.{number}` is not in a region in which to loiter for {seconds:g} s, with all of the tube", ""
    for name, begin, end in _visits(plan, frozenset(loitering)):
        if not any(begin - _SAME_S <= s <= end + _SAME_S and seconds >= loitering[name] for s, seconds in stops):
            return f"there is no stop in {name}, which is visited from {begin:.3f} s to {end:.3f} s on the curve", ""
    legs = zip(plan.laws, plan.starts_s.tolist(), strict=False)
    held = sorted(
        (start + rest.s, rest.seconds) for law, start in legs for rest in law.rests() if rest.seconds > _SAME_S
    )
    for stop in stops:
        if not any(isclose(stop[0], s, abs_tol=_SAME_S) and seconds >= stop[1] - _SAME_S for s, seconds in held):
            return f"the trajectory does not stand still for {stop[1]:g} s at {stop[0]:.3f} s on its curve", ""
    # Before a lane that is photographed the vehicle may wait until it has turned; one that looks ahead, wherever it
    # turns, but no longer than it takes to turn right round.
    places = [s for s, _ in stops] + [lane.begin_s for lane in _photographed(plan)]
    heading, round_s = plan.spec.flight.heading, pi / plan.spec.limits.yaw_rate_rad_s + 2.0 * _SETTLE_S
    turning_s = round_s if heading is not None and heading.look in {Look.AHEAD, Look.LANES} else 0.0
    unasked = [s for s, seconds in held if seconds > turning_s]
    others = [s for s in unasked if not any(isclose(s, place, abs_tol=_SAME_S) for place in places)]
    fault = f"the trajectory stands still at {others[0]:.3f} s on its curve, for no stop" if others else None
    return fault, f"{len(stops)} stops, {sum(seconds for _, seconds in stops):g} s"


def _visits(plan: Written, names: frozenset[str]) -> Iterator[tuple[str, float, float]]:
    """When the tube comes into a region and leaves it, by the pieces of the proof; all of it is inside in between.

    To begin inside is no visit.
    """
    knots, sets = [0.0], []
    for _, proof in certified(plan):
        its_knots, its_sets = pieces_of(proof)
        knots += (knots[-1] + its_knots[1:]).tolist()
        sets += its_sets
    letters = [[plan.labelling.label(triangle) for triangle in each] for each in sets]
    for name in sorted(names):
        touched = [any(name in letter for letter in each) for each in letters]
        filled = [all(name in letter for letter in each) for each in letters]
        for inside, group in groupby(range(len(sets)), key=touched.__getitem__):
            first, *others = group
            if inside and first > 0 and any(filled[k] for k in (first, *others)):
                yield name, knots[first], knots[[first, *others][-1] + 1]


def lanes_cover(plan: Written) -> Verdict:
    """Each visit that covers: its lanes are flown, and cover as much as it says; each flight of lanes is a visit."""
    visits = plan.data["covers"]
    pieces = [piece for leg in plan.pieces for piece in leg]
    begins = accumulate((float(patches_of(piece).ends_s[-1]) for piece in pieces), initial=0.0)
    flown = [s for s, piece in zip(begins, pieces, strict=False) if piece["kind"] == "rounded polyline"]
    for visit in visits:
        if not any(isclose(visit["start_s"], s, abs_tol=_SAME_S) for s in flown):
            return f"no lanes of {visit['region']} begin at {visit['start_s']:.3f} s on the path", ""
    for visit in visits:
        own = np.zeros(plan.partition.size, dtype=np.bool_)
        own[plan.labelling.triangles_of(visit["region"])] = True
        area = union_of(plan.partition, own & ~plan.restricted)
        for fault in cover_faults(plan.spec, visit, area, plan.curve):
            return f"{visit['region']} {fault}", ""
    return None, f"{sum(len(visit['lanes_m']) for visit in visits)} lanes in {len(visits)} visits"


class _Lane(NamedTuple):
    """A lane that is photographed: where on the curve, the distance of pictures, and the heading from north."""

    begin_s: float
    end_s: float
    trigger_m: float
    heading_rad: float


def _photographed(plan: Written) -> list[_Lane]:
    found = []
    for visit in plan.data["covers"]:
        if visit["trigger_m"] is not None:
            for (begin, end), ((x, y), (u, v)) in zip(visit["lanes_s"], visit["lanes_m"], strict=True):
                found.append(_Lane(begin, end, visit["trigger_m"], atan2(u - x, v - y)))
    return [lane for lane in found if lane.begin_s < lane.end_s]


def pictures_taken(plan: Written) -> Verdict:
    """A stretch of pictures along each lane of a region of which some are to be taken, with the time to turn before."""
    lanes, stretches = _photographed(plan), plan.data.get("photographs", ())
    if len(stretches) != len(lanes):
        return f"pictures are taken in {len(stretches)} stretches, and there are {len(lanes)} lanes to take them in", ""
    begun: tuple[int, float, float] | None = None  # the leg of the lane before, when it ended, and its heading
    for number, ((begin, end, distance, heading), lane) in enumerate(zip(stretches, lanes, strict=True)):
        told = plan.place(float(begin)), plan.place(float(end)), distance, heading
        if not all(isclose(one, due, rel_tol=_SAME, abs_tol=_SAME_S) for one, due in zip(told, lane, strict=True)):
            return f"`photographs.{number}` is not along its lane, {lane.begin_s:.3f} s to {lane.end_s:.3f} s", ""
        leg = int(np.searchsorted(plan.starts_s[1:-1], lane.begin_s, side="right"))
        since, turn = sum(law.duration_s for law in plan.laws[:leg]), pi
        if begun is not None and begun[0] == leg:
            since, turn = begun[1], abs(remainder(heading - begun[2], 2.0 * pi))
        if turn > _STRAIGHT_RAD and begin - since < turn / plan.spec.limits.yaw_rate_rad_s + _SETTLE_S - _SAME_S:
            return f"before `photographs.{number}` there is too little time to turn by {turn:.2f} rad", ""
        begun = leg, end, heading
    return None, f"{len(stretches)} stretches"
