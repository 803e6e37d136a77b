"""Plans the way back from the laps: the first one of ``homeward.ways_back`` that can be smoothed with a proof."""

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import partial

from mission.errors import AutomatonSizeError, NoPlanError
from mission.geometry.arrays import BoolArray
from mission.logic.automata.safety import Safety
from mission.plan.flight_plan import prover_of
from mission.plan.homeward import Homeward, ends_of_flight, ways_back
from mission.plan.proved_path import PathPlanner
from mission.planning.run import Run
from mission.spec.model import Semantics
from mission.steering.joined import JoinedCurve
from mission.steering.path import SteeringPath
from mission.steering.proved_smoothing import ProvedCurve


@dataclass(frozen=True, eq=False)
class WayBack:
    """A way back: its run with its proof, its path, and the smoothed one."""

    homeward: Homeward
    path: SteeringPath
    curve: JoinedCurve


def way_back(
    planner: PathPlanner,
    way: Callable[[Safety, BoolArray], Run | None],
    safety: Safety,
    restricted: BoolArray,
    *,
    laps: Run,
    proved: ProvedCurve,
) -> WayBack | None:
    """Plan the way back from laps.

    Args:
        planner: Of the mission.
        way: Finds a best run from where the laps end into some triangles, on which nothing is violated.
        safety: What its specification forbids in finite time, over the letters of T.
        restricted: Shape (M,), triangles that must not be entered.
        laps: The run of the laps.
        proved: Their smoothed path.

    Returns:
        None where no way is proved to violate nothing, or the question is too large.
    """
    try:
        refutation = safety.refutation()
        prover = prover_of(planner.spec, planner.partition, planner.labelling, refutation, restricted)
        reached = prover.reached(proved.curve, proved.certificate)
        ends = ends_of_flight(planner.spec, planner.labelling, restricted, laps.states[0])
        found = list(ways_back(way, safety, reached, lap_triangle=laps.suffix[0], ends=ends))
    except AutomatonSizeError:
        return None
    # The label of the triangle in which the laps end was read when they did.
    # What is on the way is not covered again.
    onward = replace(planner, spec=replace(planner.spec, semantics=Semantics.PAPER), covering=None)
    end = proved.curve.position([proved.curve.duration_s])[0]
    longest_s = max(leg.duration_s for leg in proved.curve.legs)
    for run in found:
        path = onward.path(run, safety.watched(), (float(end[0]), float(end[1])))
        try:
            share = min(1.0, path.duration_s / longest_s)
            smooth = onward.smoothed(path, partial(prover.certify, begins=reached), joins=True, share=share)
        except NoPlanError:
            continue
        return WayBack(Homeward(run, smooth.certificate), path, smooth.curve)
    return None
