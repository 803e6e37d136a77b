"""Lower bounds of the time of flights: of no plan, on whatever map, is anything sooner."""

import re
from dataclasses import replace
from functools import cache
from itertools import pairwise, permutations

import numpy as np
import pytest
import shapely

from mission.errors import LateError
from mission.logic.formula.parser import parse_formula, parse_timed_formula
from mission.plan import FlightPlan, plan_mission
from mission.plan.crossing_maps import CrossingMaps
from mission.plan.earliest import Earliest, before_of, due_of, met_by
from mission.spec.model import MissionSpec
from mission.spec.specification import of_mission
from tests.support.random_maps import random_mission
from tests.support.timed_missions import timed

LONG_S = 9000
SPARE_S = 0.06
TO_SPARE_S = 0.05


def earliest_of(plan: FlightPlan, spec: MissionSpec) -> Earliest:
    triangle = int(plan.locator.triangle_at(np.array([plan.start_m]))[0])
    return Earliest(CrossingMaps(spec, plan.labelling, plan.restricted, plan.locator, plan.start_m, triangle))


def asked_on(seed: int) -> MissionSpec:
    """A mission on a map of chance with bounds that any flight keeps."""
    spec = random_mission(seed)
    names = [name for name in ("a", "b") if name in spec.formula]
    due = [f"F[0,{LONG_S}] {name}" for name in names]
    reactions = [f"G (a -> F[0,{LONG_S}] b)"] if "b" in names and "G F" in spec.formula else []
    returns = [f"G ({name} -> G F[0,{LONG_S}] {name})" for name in names] if "G F" in spec.formula else []
    formula = " & ".join((spec.formula, *due, *reactions, *returns))
    return replace(spec, formula=formula, flight=replace(spec.flight, longest_s=1.0e6, replan=False))


def as_it_was_kept(plan: FlightPlan) -> MissionSpec:
    """The mission of a plan with each bound as tight as the plan just keeps it."""
    *bounds, aloft = plan.bounds
    parts = [part for part in plan.spec.formula.split(" & ") if str(LONG_S) not in part]
    parts += [str(each.formula).replace(str(LONG_S), f"{LONG_S - each.margin_s + SPARE_S:.3f}") for each in bounds]
    flight = replace(plan.spec.flight, longest_s=1.0e6 - aloft.margin_s + SPARE_S)
    return replace(plan.spec, formula=" & ".join(parts), flight=flight)


@pytest.mark.parametrize("seed", [0, 3, 8, 10])
def test_what_a_plan_keeps_is_not_called_hopeless_on_whatever_map(seed: int) -> None:
    plan = plan_mission(asked_on(seed))
    tight = as_it_was_kept(plan)
    assert not earliest_of(plan, tight).hopeless(of_mission(tight, plan.labelling.letters))


@cache
def plan_of_three() -> FlightPlan:
    """Home at the start, a place on the way, and a place beyond a gate, with stays."""
    spec = timed()
    stays = {"near": 3.0, "far": 7.0}
    regions = tuple(replace(each, loiter_s=stays.get(each.name, 0.0)) for each in spec.regions)
    return plan_mission(replace(spec, regions=regions))


def ways_s(names: tuple[str, ...]) -> list[float]:
    """When places are reached in an order at the earliest, by distances of polygons and the formula for each way."""
    plan, limits = plan_of_three(), plan_of_three().spec.limits
    shapes = {"near": (24, 18, 32, 26), "gate": (40, 0, 46, 30), "far": (60, 8, 70, 18)}
    tube_m, speed, acceleration = plan.certificate.tube_m, plan.spec.flight.speed_m_s, limits.acceleration_m_s2
    boxes = [
        shapely.box(x0 + tube_m, y0 + tube_m, x1 - tube_m, y1 - tube_m)
        for x0, y0, x1, y1 in (shapes[name] for name in names)
    ]
    found, at_s, halted = [], 0.0, True
    for name, (here, there) in zip(names, pairwise([shapely.Point(plan.start_m), *boxes]), strict=True):
        at_s += shapely.distance(here, there) / speed + (speed / (2.0 * acceleration) if halted else 0.0)
        found.append(at_s)
        stay_s = {"near": 3.0, "far": 7.0}.get(name, 0.0)
        at_s, halted = at_s + stay_s, stay_s > 0.0
    return found


@pytest.mark.parametrize(
    "due", [{"far": 14.0, "near": 20.0}, {"far": 14.0, "near": 9.0, "gate": 30.0}, {"near": 3.0, "gate": 12.0}]
)
def test_the_least_delay_is_that_of_the_best_of_all_orders(due: dict[str, float]) -> None:
    plan = plan_of_three()
    asked = [f"F[0,{due_s}] {name}" for name, due_s in due.items()]
    late_s = min(
        max(at_s - due[name] for name, at_s in zip(order, ways_s(order), strict=True)) for order in permutations(due)
    )
    spec = replace(plan.spec, formula=" & ".join((plan.spec.formula, *asked)))
    found = earliest_of(plan, spec).hopeless(of_mission(spec, plan.labelling.letters))
    alone = max(ways_s((name,))[0] - due_s for name, due_s in due.items())
    least_s = TO_SPARE_S + (alone if alone > -TO_SPARE_S else late_s)
    figures = [float(figure) for each in found for figure in re.findall(r"at least ([\d.]+) s", each.text)]
    assert figures == ([] if least_s <= 0.0 else [pytest.approx(least_s, abs=0.006)])


def test_what_comes_first_in_any_case_counts() -> None:
    plan = plan_of_three()
    earliest = earliest_of(plan, plan.spec)
    formula = parse_timed_formula("F[0,60] near", frozenset({"near"}))
    assert earliest.soonest_s(formula) == pytest.approx(ways_s(("near",))[0], abs=0.01)
    spec = replace(plan.spec, formula="F G home & !near U far & F[0,20] near", tasks=())
    (found,) = earliest.hopeless(of_mission(spec, plan.labelling.letters))
    assert "no flight is there before" in found.text


@pytest.mark.parametrize(
    ("formula", "due"),
    [
        ("F[0,9] a & F[0,7] (a & b) & G F b", {"a": 7.0, "b": 7.0}),
        ("!a U[0,5] b & F[2,4] c & F d & G[0,3] e", {"b": 5.0, "c": 4.0}),
        ("F[0,9] (a | b) & F[0,9] !c", {}),
    ],
)
def test_what_is_due_is_read_from_formulas(formula: str, due: dict[str, float]) -> None:
    parsed = parse_timed_formula(formula, frozenset("abcde"))
    assert due_of(parsed.operands) == due


def test_what_is_met_in_any_case_is_read_from_formulas() -> None:
    names = frozenset("abcde")
    assert met_by(parse_formula("F (a & F b) & (F c | F (c & d)) & G (d -> F e)", names)) == {"a", "b", "c"}
    assert met_by(parse_formula("!a U b & G F c & (d W e)", names)) == {"b", "c"}
    assert before_of(parse_formula("!a U b & F c & (c U d) & !(a & c) U e", names).operands) == {("b", "a")}


def test_a_refusal_without_a_plan_says_what_no_flight_can_do() -> None:
    with pytest.raises(LateError, match="no flight keeps its bounds in seconds") as refused:
        plan_mission(timed("F G home", "[{visit: far, by_s: 8}, {visit: near}]"))
    assert refused.value.conjuncts == ("F[0,8] far",)
