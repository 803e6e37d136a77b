"""The way back from laps that are flown through a corridor."""

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from functools import partial
from typing import Final

import numpy as np
import shapely

from mission.errors import AutomatonSizeError, NoPlanError
from mission.geometry.arrays import BoolArray, FloatArray
from mission.geometry.location import Locator
from mission.geometry.shapes import polygonal
from mission.logic.automata.safety import Safety
from mission.plan.corridor_path import CorridorPath, CorridorPlanner
from mission.plan.flight_plan import prover_of
from mission.plan.homeward import Homeward, ends_of_flight, ways_back
from mission.plan.landing import room_to_land
from mission.plan.progress import Grounds
from mission.planning.run import Run
from mission.steering.corridor import Way, smooth_ways
from mission.steering.joined import JoinedCurve, Piece
from mission.steering.layered_paths import NoWayError
from mission.steering.polyline import Polyline
from mission.steering.taut import Stretch, taut_path

_BRAKING: Final = 1.5
"""How much longer the way is on which the vehicle comes to rest than it must be."""


@dataclass(frozen=True, eq=False)
class CorridorBack:
    """A way back: its run with its proof, the taut path, and the curve."""

    homeward: Homeward
    planned: Polyline
    curve: Piece


def way_back_in_corridor(
    planner: CorridorPlanner, way: Callable[..., Run | None], safety: Safety, laps: Run, flown: CorridorPath
) -> CorridorBack | None:
    """Plan the way back from laps, which goes on as they end, with continuous acceleration where they do not rest.

    Args:
        planner: Of the mission.
        way: As in ``ways_back``, with ``lap_triangle``, the triangle in which the laps end.
        safety: What its specification forbids in finite time, over the letters of T.
        laps: The run of the laps.
        flown: Their path.

    Returns:
        None where no way is proved to violate nothing, or the question is too large.
    """
    spec, partition, labelling = planner.spec, planner.partition, planner.labelling
    end_m = flown.curve.position([flown.curve.duration_s])[0]
    triangle = int(Locator(partition).triangle_at(end_m[None])[0])
    ends = ends_of_flight(spec, labelling, planner.restricted, laps.states[0])
    grounds = Grounds(partition, labelling, planner.restricted, flown.margin_m)
    try:
        prover = prover_of(spec, partition, labelling, safety.refutation(), planner.restricted)
        reached = prover.reached(flown.curve, flown.certificate)
        runs = list(ways_back(partial(way, lap_triangle=triangle), safety, reached, lap_triangle=triangle, ends=ends))
    except AutomatonSizeError:
        return None
    here = {int(labelling.letter_of[each]) for each in reached}
    harmless = _harmless(safety, reached.values(), grounds.letters)
    free, leaving = grounds.touching_only(harmless), grounds.touching_only(harmless | here)
    for run in runs:
        goal = ends if ends[run.suffix[0]] else np.arange(partition.size) == run.suffix[0]
        try:
            onward = np.zeros(2) if flown.onward is None else flown.onward.slope
            inside = polygonal(shapely.intersection(free, grounds.inside(goal)))
            ends = room_to_land(inside, free, spec.flight.landing_m)
            ways = _taut((leaving, free), ends, end_m, onward, planner.pace.acceleration_m_s2)
            (curve,) = smooth_ways(ways, planner.pace, onward=flown.onward)
        except (NoPlanError, NoWayError):
            continue
        certificate = prover.certify(JoinedCurve((curve,)), begins=reached)
        if certificate.holds:
            points = np.concatenate([ways[0].points_m, *(way.points_m[1:] for way in ways[1:])])
            return CorridorBack(Homeward(run, certificate), Polyline(points, planner.pace.speed_m_s), curve)
    return None


def _taut(
    frees: tuple[shapely.Geometry, shapely.Geometry],
    goal: shapely.Geometry,
    begin_m: FloatArray,
    onward: FloatArray,
    acceleration_m_s2: float,
) -> list[Way]:
    """The shortest way into the goal; where the laps end in it, on to where the vehicle is at rest in it.

    It begins where what the laps end in may be touched, and goes on where it is not touched again.
    """
    leaving, free = frees
    stretches = [Stretch(free, goal)]
    if not shapely.covers(free, leaving):
        stretches.insert(0, Stretch(leaving, free))
    ways = [
        Way(line.points_m, line.free, stretch.target if number + 1 < len(stretches) else None)
        for number, (line, stretch) in enumerate(zip(taut_path(begin_m, stretches).lines, stretches, strict=True))
    ]
    if any(len(way.points_m) > 1 for way in ways):
        return ways
    if onward.any():
        stop_m = begin_m + onward * np.hypot(*onward) * _BRAKING / (2.0 * acceleration_m_s2)
        return [Way(np.stack((begin_m, stop_m)), free, None)]
    (line,) = taut_path(begin_m, [Stretch(free, shapely.point_on_surface(goal))]).lines
    return [Way(line.points_m, free, None)]


def _harmless(safety: Safety, reached: Iterable[int], letters: frozenset[int]) -> frozenset[int]:
    """Letters of which no word is bad after what was reached: the first that are found when bad ones are left out."""
    states = {state for mask in reached for state in range(len(safety.rows)) if mask >> state & 1}
    allowed = np.array(sorted(letters))
    while len(allowed):
        seen, waiting = set(states), list(states)
        guilty: set[int] = set()
        while waiting:
            after: BoolArray = safety.rows[waiting.pop(), allowed]
            guilty.update(allowed[after == safety.bad].tolist())
            new = set(after.tolist()) - seen - {safety.bad}
            seen |= new
            waiting += new
        if not guilty:
            break
        allowed = np.array([letter for letter in allowed.tolist() if letter not in guilty], dtype=np.int64)
    return frozenset(allowed.tolist())
