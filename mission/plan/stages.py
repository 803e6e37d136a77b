"""The stages of planning, one after the other; each is a function of what came before it."""

from functools import partial

import numpy as np

from mission.errors import Fault, LateError, NoPlanError, NoRollingStartError, SpecError
from mission.geometry.arrays import IntArray
from mission.geometry.location import OUTSIDE, Locator
from mission.plan.beginning import Beginning
from mission.plan.best_runs import BestRuns, OneRun, Runs, best_runs, objective_of
from mission.plan.corridor_path import pace_of
from mission.plan.costs import UNIT, run_costs, transition_weights
from mission.plan.covering import Covering
from mission.plan.crossing_maps import CrossingMaps
from mission.plan.detour import Avoidance
from mission.plan.explained import explained
from mission.plan.feasibility import Feasibility
from mission.plan.flight_plan import FlightPlan
from mission.plan.heading import looked_toward
from mission.plan.in_motion import planned_in_motion
from mission.plan.kept import Kept
from mission.plan.narrows import closed_by_clearances
from mission.plan.pace import trajectory_of
from mission.plan.photographs import along_lanes
from mission.plan.proved_path import PathPlanner
from mission.plan.shortest_way import RunSearch
from mission.plan.slow_parts import slow_parts
from mission.plan.steered import Steered, Steering
from mission.plan.tasks import dropped_tasks
from mission.plan.timely import Law, given_up_in_time, in_time
from mission.planning.run import Run
from mission.planning.transition_system import TransitionSystem
from mission.spec.domain import as_drawn, build_domain, restricted_triangles
from mission.spec.model import Cost, MissionSpec, Point
from mission.spec.specification import Specification, deterministic_of, of_mission
from mission.steering.trajectory import Trajectory


def plan_mission(spec: MissionSpec, *, start_m: Point | None = None, run: int | None = None) -> FlightPlan:
    """Plan a mission, from rest.

    Args:
        spec: The mission.
        start_m: Where the flight begins, ENU in the domain; the mission's own start by default.
        run: Which of the shortest runs to fly; the mission's own choice by default. Where neither chooses, and the
            first one is not proved, others are tried, and then some that cost more.

    Raises:
        FormulaSyntaxError: If the formula cannot be parsed.
        AutomatonSizeError: If the formula or the automaton asks for one that is too large.
        SpecError: If the domain, the start or the number of the run cannot be used.
        NoPlanError: If no run, or no smoothing with a proof, exists.
    """
    return planned(spec, Beginning(spec.start.position_m if start_m is None else start_m), run)


def foresee(spec: MissionSpec) -> None:
    """Make what is remembered of a mission wherever it is begun: its triangles, those of its outlines, its automata.

    Raises:
        MissionError: As in ``plan_mission``.
    """
    partition, labelling = build_domain(spec)
    locator, restricted, start = Locator(partition), restricted_triangles(spec, labelling), spec.start.position_m
    required = of_mission(spec, labelling.letters)
    _ = required.shown
    automaton = deterministic_of(required.formula, required.given, labelling.letters)
    maps = CrossingMaps(spec, labelling, restricted, locator, start, _start_triangle(locator, restricted, start))
    maps.foresee(automaton)


def planned(
    spec: MissionSpec, begins: Beginning, run: int | None = None, *, known: FlightPlan | None = None
) -> FlightPlan:
    """Plan a mission from a place, at rest or in motion.

    Args:
        spec: The mission.
        begins: The place, and the motion there.
        run: As in ``plan_mission``.
        known: Another plan, whose triangles are taken where it is on the same map, and what of its ways is the same.

    Raises:
        NoRollingStartError: There is no plan with this motion; at rest there may be one.
        MissionError: As in ``plan_mission``.
    """
    if spec.moves:
        if begins.moves or known is not None:
            raise NoRollingStartError("a map that moves is planned on from rest")
        return planned_in_motion(spec, lambda still: planned(still, begins, run))
    start = begins.place_m
    if known is not None and _map_of(spec) == _map_of(known.spec):
        partition, labelling, locator = known.partition, known.labelling, known.locator
    else:
        partition, labelling = build_domain(spec)
        locator = Locator(partition)
    restricted = restricted_triangles(spec, labelling)
    triangle = _start_triangle(locator, restricted, start)
    weights = transition_weights(partition, spec.search.cost, spec.flight.speed_m_s)
    system = TransitionSystem.from_partition(partition, labelling, restricted, weights)

    maps = CrossingMaps(spec, labelling, restricted, locator, start, triangle)
    search = RunSearch(system, maps, closing=begins.completes)
    covering = Covering(spec, partition, labelling, restricted)
    planner = PathPlanner(spec, partition, labelling, covering)

    def told(error: NoPlanError, mission: MissionSpec) -> NoPlanError:
        return explained(error, mission, partition, labelling, start=triangle)

    def in_its_time(left_out: frozenset[int]) -> tuple[Specification, BestRuns, Steered, Trajectory]:
        specification = of_mission(spec, labelling.letters, left_out)
        try:
            found = search.best(specification)
        except NoPlanError as error:
            raise closed_by_clearances(told(error, spec), spec, start) from error
        steering = Steering(
            restricted=restricted,
            planner=planner,
            specification=specification,
            search=search,
            found=found,
            index=_index(spec, found, run),
            free=run is None and spec.run == 0,
            kept=Kept.of(known, spec),
        )
        try:
            return specification, found, *in_time(steering, partial(_flown, beginning=begins))
        except (LateError, NoRollingStartError):
            raise
        except NoPlanError as error:
            raise closed_by_clearances(error, spec, start) from error

    try:
        dropped = dropped_tasks(spec, Feasibility(search, planner).refusal, told)
    except NoPlanError as error:
        raise closed_by_clearances(told(error, spec), spec, start) from error
    dropped, (specification, found, flown, trajectory) = given_up_in_time(spec, dropped, in_its_time)
    runs = found.runs
    return FlightPlan(
        spec=spec,
        start_m=start,
        partition=partition,
        labelling=labelling,
        required=specification,
        product_states=found.product.full_size,
        product_states_reachable=found.product.reachable_size,
        shortest_runs=flown.among.runs.count,
        best_in_any_order=flown.among.exact,
        run_index=flown.run_index,
        run=flown.run,
        costs=_costs(flown.among, flown.searched, weights, spec.search.cost),
        path=flown.path,
        stops=flown.stops,
        trajectory=trajectory,
        certificate=flown.certificate,
        dropped=dropped,
        homeward=flown.homeward,
        passed_over=flown.passed_over,
        covers=flown.covers,
        photographs=along_lanes(trajectory, flown.covers),
        avoidance=Avoidance(flown.avoided, _costs(found, runs[0], weights, spec.search.cost))
        if flown.avoided
        else None,
        way=flown.among.way,
        instead=flown.instead,
        onward=(begins.velocity_m_s, begins.acceleration_m_s2) if begins.moves else None,
    )


def _index(spec: MissionSpec, found: BestRuns, run: int | None) -> int:
    """The number of the run that is asked for; raises SpecError where there is none of that number."""
    index = spec.run if run is None else run
    if index < found.runs.count:
        return index
    hint = f"the runs are numbered from 0 to {found.runs.count - 1}"
    if found.way is not None:
        hint = f"by {spec.search.cost} there is one run, number 0; by `search: {{cost: transitions}}` there are more"
    raise SpecError((Fault(0, 0, "mission.run", f"there is no run {index} among the shortest", hint),), spec.name)


def _map_of(spec: MissionSpec) -> tuple[object, ...]:
    """All that the triangles of a mission, and their labels, follow from."""
    return spec.domain, [as_drawn(each) for each in spec.regions]


def _flown(steering: Steering, beginning: Beginning) -> tuple[Steered, Law]:
    """A smooth path, and how it is flown: in motion from the first, or from a halt on, or from rest."""
    of, pace = steering.planner, pace_of(steering.planner.spec)
    onward, way = beginning.onward(pace), steering.found.way
    refused = NoRollingStartError("")
    for begins in beginning.each(np.empty((0, 2)) if way is None else way.prefix_m, pace):
        try:
            flown = steering.steered(begins)
            law = partial(
                trajectory_of,
                of.spec,
                flown.curve,
                flown.stops,
                flown.lap,
                flown.covers,
                slow=slow_parts(flown.proofs, of.labelling, of.spec.regions),
                toward_m=looked_toward(of.spec, of.partition, of.labelling),
                begins=None if onward is None else onward.law,
                known=(*flown.known, *steering.kept.laws),
            )
            return flown, Law(law(), None if onward else law)
        except NoRollingStartError as error:
            refused = error
        except ValueError as error:
            if onward is None:
                raise
            refused = NoRollingStartError(str(error))
    raise refused


def shortest_runs(plan: FlightPlan) -> Runs:
    """All the runs that a plan could have flown at the same cost, clear of what it avoids."""
    if plan.way is not None:
        return OneRun(plan.run, round(objective_of(plan.spec).cost(*plan.costs) / UNIT[plan.spec.search.cost][1]))
    objective = objective_of(plan.spec)
    system = plan.system if plan.avoidance is None else plan.system.without(plan.avoidance.closed)
    return best_runs(system, plan.required, plan.run.states[0], plan.spec.semantics, objective).runs


def _costs(found: BestRuns, run: Run, weights: IntArray, cost: Cost) -> tuple[float, float]:
    return found.way_costs or run_costs(weights, run, cost)


def _start_triangle(locator: Locator, restricted: np.ndarray, start_m: Point) -> int:
    triangle = int(locator.triangle_at(np.array([start_m]))[0])
    place = f"({start_m[0]:.2f}, {start_m[1]:.2f})"
    if triangle == OUTSIDE:
        raise SpecError((Fault(0, 0, "start", f"the start {place} lies outside the domain"),))
    if restricted[locator.triangles_touching(start_m)].any():
        raise SpecError((Fault(0, 0, "start", f"the start {place} lies in or on the edge of a restricted region"),))
    return triangle
