"""Whether the lanes of a plan cover what they are said to cover, and pictures are taken along them."""

from itertools import accumulate
from math import atan2, isclose, pi, remainder
from typing import Any, Final, NamedTuple

import numpy as np
import shapely

from mission.decimals import count
from mission.geometry.regions import union_of
from mission.spec.camera import spacing_of, trigger_of
from mission.verify.plans.patches import patches_of, pieces_of
from mission.verify.plans.written import Verdict, Written

_SHARE: Final = 2e-3
_BESIDE: Final = 3.0 / 16.0 + 1.0 / 30.0  # of a spacing: rounded ends are cut off, small steps aside left out
_SAME: Final = 1e-9
_SAME_S: Final = 1e-6
_SAME_M: Final = 1e-6
_SETTLE_S: Final = 0.5  # after a turn
_STRAIGHT_RAD: Final = 0.01
_SAMPLES: Final = np.linspace(0.0, 1.0, 65)  # of a lane, which is straight but for its ends


def lanes_cover(plan: Written) -> Verdict:
    """Each visit that covers: its lanes are flown, and cover as much as it says; each flight of lanes is a visit."""
    visits = plan.data["covers"]
    pieces = [piece for leg in plan.data["trajectory"]["legs"] for piece in pieces_of(leg["curve"])]
    begins = accumulate((float(patches_of(piece).ends_s[-1]) for piece in pieces), initial=0.0)
    flown = [s for s, piece in zip(begins, pieces, strict=False) if piece["kind"] == "rounded polyline"]
    for visit in visits:
        fault = _visit_fault(plan, visit, flown) or _first_fault(plan, visit)
        if fault:
            return f"{visit['region']} {fault}", ""
    covered = {visit["region"] for visit in visits}
    for name, begin, end in plan.visits(region.name for region in plan.spec.regions if region.cover is not None):
        if name not in covered:
            return f"{name} is visited from {begin:.3f} s to {end:.3f} s on the curve, and there are no lanes in it", ""
    lanes = count(sum(len(visit["lanes_m"]) for visit in visits), "lane")
    before = ", beside what an earlier plan covered" if any(visit.get("before") for visit in visits) else ""
    return None, f"{lanes} in {count(len(visits), 'visit')}{before}"


def _visit_fault(plan: Written, visit: dict[str, Any], flown: list[float]) -> str | None:
    """What is wrong with a visit that covers a region, where lanes begin at some places on the curve."""
    cover = next((region.cover for region in plan.spec.regions if region.name == visit["region"]), None)
    if cover is None:
        return "is not to be covered"
    altitude_m = plan.spec.flight.altitude_m
    spacing_m, trigger_m = spacing_of(cover, altitude_m), trigger_of(cover, altitude_m)
    if [visit[key] for key in ("spacing_m", "trigger_m", "share")] != [spacing_m, trigger_m, cover.share]:
        return f"asks for lanes {spacing_m:g} m apart, pictures every {trigger_m} m, and a share of {cover.share:g}"
    if not any(isclose(visit["start_s"], s, abs_tol=_SAME_S) for s in flown):
        return f"has no lanes that begin at {visit['start_s']:.3f} s on the path"
    lanes, times_s = (
        np.array(visit[key], dtype=float).reshape(len(visit[key]), 2, -1) for key in ("lanes_m", "lanes_s")
    )
    order, end_s = np.append(visit["start_s"], times_s.ravel()), float(plan.curve.ends_s[-1])
    if len(times_s) != len(lanes) or (np.diff(order) < -_SAME * end_s).any() or order[-1] > end_s * (1.0 + _SAME):
        return "has lanes that are not in order"
    begins, ends = np.minimum(np.maximum.accumulate(times_s.ravel()), end_s).reshape(-1, 2, 1).swapaxes(0, 1)
    flights = plan.curve.at((begins + (ends - begins) * _SAMPLES).ravel()).reshape(len(lanes), -1, 2)
    beside = np.linalg.norm(flights[:, [0, -1]] - lanes, axis=2).max(axis=1)
    if beside.max() > _BESIDE * spacing_m:
        return f"has a lane, {int(np.argmax(beside))}, that is flown {beside.max():.3f} m beside itself"
    area = union_of(plan.partition, plan.own(visit["region"]) & ~plan.restricted)
    # Of a lane that is too short to be more than a moment of the flight, its place counts.
    flown_over = [*shapely.linestrings(flights), *shapely.points(flights[:, 0])]
    swaths = shapely.buffer(flown_over, spacing_m / 2.0, quad_segs=32)
    before = [shapely.Polygon(outer, holes) for outer, *holes in visit.get("before") or ()]
    share = 1.0 - area.difference(shapely.union_all([*swaths, *before])).area / area.area
    off = abs(share - visit["planned_share"]) > _SHARE
    return f"is covered to {share:.2%}, and not to {visit['planned_share']:.2%}" if off else None


def _first_fault(plan: Written, visit: dict[str, Any]) -> str | None:
    """What is wrong with where the first picture is taken of a lane that is the rest of one."""
    first_s, begin_s, trigger_m = visit.get("first_s"), float(visit["lanes_s"][0][0]), visit["trigger_m"]
    if first_s is None:
        return None
    if trigger_m is None or first_s < begin_s:
        return "takes a first picture where none is due"
    way_m = np.linalg.norm(np.diff(plan.curve.at(begin_s + (first_s - begin_s) * _SAMPLES), axis=0), axis=1).sum()
    late = way_m > trigger_m + _SAME_M
    return f"takes its first picture after {way_m:.3f} m of a lane, and is to every {trigger_m:.3f} m" if late else None


class _Lane(NamedTuple):
    """A lane that is photographed: where on the curve, the distance of pictures, and the heading from north."""

    begin_s: float
    end_s: float
    trigger_m: float
    heading_rad: float


def photographed(plan: Written) -> list[_Lane]:
    """The lanes along which pictures are taken."""
    found = []
    for visit in plan.data["covers"]:
        if visit["trigger_m"] is not None:
            lanes_s = [[begin, end] for begin, end in visit["lanes_s"]]
            if visit.get("first_s") is not None:
                lanes_s[0][0] = visit["first_s"]
            for (begin, end), ((x, y), (u, v)) in zip(lanes_s, visit["lanes_m"], strict=True):
                found.append(_Lane(begin, end, visit["trigger_m"], atan2(u - x, v - y)))
    return [lane for lane in found if lane.begin_s < lane.end_s]


def pictures_taken(plan: Written) -> Verdict:
    """A stretch of pictures along each lane of a region of which some are to be taken, with the time to turn before."""
    lanes, stretches = photographed(plan), plan.data.get("photographs", ())
    if len(stretches) != len(lanes):
        return f"pictures are taken in {len(stretches)} stretches, and there are {len(lanes)} lanes to take them in", ""
    begun: tuple[int, float, float] | None = None  # the leg of the lane before, when it ended, and its heading
    for number, ((begin, end, distance, heading), lane) in enumerate(zip(stretches, lanes, strict=True)):
        told = _place(plan, float(begin)), _place(plan, float(end)), distance, heading
        if not all(isclose(one, due, rel_tol=_SAME, abs_tol=_SAME_S) for one, due in zip(told, lane, strict=True)):
            return f"`photographs.{number}` is not along its lane, {lane.begin_s:.3f} s to {lane.end_s:.3f} s", ""
        leg = int(np.searchsorted(plan.starts_s[1:-1], lane.begin_s, side="right"))
        since, turn = sum(law.duration_s for law in plan.laws[:leg]), pi
        if begun is not None and begun[0] == leg:
            since, turn = begun[1], abs(remainder(heading - begun[2], 2.0 * pi))
        if turn > _STRAIGHT_RAD and begin - since < turn / plan.spec.limits.yaw_rate_rad_s + _SETTLE_S - _SAME_S:
            return f"before `photographs.{number}` there is too little time to turn by {turn:.2f} rad", ""
        begun = leg, end, heading
    return None, f"along {count(len(stretches), 'lane')}"


def _place(plan: Written, t_s: float) -> float:
    """Where on the curve the vehicle is at a time, of the first lap."""
    begins = 0.0
    for law, start in zip(plan.laws, plan.starts_s.tolist(), strict=False):
        if t_s <= begins + law.duration_s:
            return float(start + law.jet(np.array([t_s - begins]))[0][0])
        begins += law.duration_s
    return float("inf")
