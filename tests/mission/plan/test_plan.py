"""Whole plans: the paper's numbers, the journey through JSON, proofs made anew, refusals."""

import dataclasses
import json
from pathlib import Path

import numpy as np
import pytest

from mission.errors import FormulaSyntaxError, NoPlanError, SpecError
from mission.plan import FlightPlan, plan_from_json, plan_mission, plan_to_json, shortest_runs
from mission.spec.loader import load_mission, parse_mission
from mission.spec.model import Extension, MissionSpec, Semantics, Smoothing
from tests.support.proofs import untrue
from tests.support.small_missions import ROUNDS
from tests.support.steered_plans import fields_of, series_of

MISSIONS = Path(__file__).parents[3] / "missions"


def changed(spec: MissionSpec, **values: object) -> MissionSpec:
    return dataclasses.replace(spec, **values)  # type: ignore[arg-type] # a test's shorthand


@pytest.fixture(scope="module")
def paper() -> FlightPlan:
    return plan_mission(load_mission(MISSIONS / "paper.yaml"))


def test_the_paper_is_reproduced(paper: FlightPlan) -> None:
    # expected: the paper, Secs. 5 and 6, with its errata
    assert paper.partition.size == 13
    assert paper.automaton.size == 3
    assert paper.product_states == 39
    assert paper.shortest_runs == 4
    assert paper.run.states == (0, 8, 11, 12, 4, 5, 7, 3, 1, 5, 4, 12, 10)
    assert paper.run.controls == (1, 3, 3, 1, 1, 3, 1, 2, 2, 2, 3, 2, 0)
    assert [run.states[6:9] for run in shortest_runs(paper)] == [(7, 3, 1), (1, 3, 1), (7, 3, 7), (1, 3, 7)]
    assert paper.path.length_m == pytest.approx(35.2, abs=0.05)
    assert paper.path.duration_s == pytest.approx(843.0, abs=0.5)
    assert paper.curve.frequencies == 28
    moved = np.linalg.norm(paper.trajectory.position([0.0])[0] - (11.0, 9.5))
    assert moved == pytest.approx(0.33, abs=0.005)  # the even extension moves the start
    assert paper.certificate.holds
    assert paper.certificate.word == tuple(map(frozenset, (["S2"], [], ["S1"], [], ["R"])))


@pytest.mark.parametrize("extension", list(Extension))
@pytest.mark.parametrize("run", range(4))
def test_each_of_the_papers_runs_is_proved(run: int, extension: Extension) -> None:
    spec = load_mission(MISSIONS / "paper.yaml")
    smoothing = Smoothing(extension, 28) if extension is Extension.EVEN else Smoothing(extension, "auto")
    plan = plan_mission(changed(spec, smoothing=smoothing), run=run)
    assert plan.certificate.holds
    turns = [i for i in range(1, 12) if plan.run.states[i - 1] == plan.run.states[i + 1]]
    assert [i for i in turns if plan.run.states[i] == 3] == turns  # only S1 is turned back from
    assert sum(segment.control == 0 for segment in fields_of(plan).segments) == 1 + len(turns)


def test_the_papers_own_semantics_gives_the_same_numbers() -> None:
    plan = plan_mission(changed(load_mission(MISSIONS / "paper.yaml"), semantics=Semantics.PAPER))
    assert (plan.product_states, plan.shortest_runs) == (39, 4)
    assert plan.run.states == (0, 8, 11, 12, 4, 5, 7, 3, 1, 5, 4, 12, 10)


@pytest.mark.parametrize("file", ["paper", "patrol", "inspection"])
def test_a_plan_survives_json_bit_by_bit_and_is_proved_from_it(file: str) -> None:
    plan = plan_mission(load_mission(MISSIONS / f"{file}.yaml"))
    text = plan_to_json(plan)
    again = plan_from_json(text)
    assert plan_to_json(again) == text
    assert again.run == plan.run
    times = np.linspace(0.0, plan.trajectory.duration_s, 57)
    np.testing.assert_array_equal(again.trajectory.position(times), plan.trajectory.position(times))
    assert not untrue(again)


def test_planning_is_deterministic() -> None:
    spec = load_mission(MISSIONS / "survey.yaml")
    assert plan_to_json(plan_mission(spec)) == plan_to_json(plan_mission(spec))


def test_a_forged_plan_is_not_proved(paper: FlightPlan) -> None:
    document = json.loads(plan_to_json(paper))
    document["trajectory"]["legs"][0]["curve"]["base_m"][0] -= 3.0  # moves the whole path west
    forged = plan_from_json(json.dumps(document))
    assert forged.certificate.holds  # as it claims
    assert untrue(forged)


@pytest.mark.parametrize(
    "text", ["", "[]", "null", "{}", '{"format": "ltl-mission plan 1"}', '{"format": 7}', "[" * 100_000]
)
def test_what_is_no_plan_is_refused(text: str) -> None:
    with pytest.raises(SpecError, match="not a plan"):
        plan_from_json(text)


@pytest.mark.parametrize(
    ("part", "value", "says"),
    [
        ("path", ..., "it has no `path`"),
        ("path", 7, "`path` is not as it was written"),
        ("labels", {"letters": []}, "`labels` is not as it was written"),
        ("stops", [["a", "b"]], "`stops` is not as it was written"),
        ("partition", {"vertices_m": [], "triangles": [0.5], "neighbours": []}, "whole numbers are expected here"),
        ("run_index", 1e999, "`run_index` is not as it was written"),
        ("certificate", None, "`certificate` is not as it was written"),
    ],
)
def test_what_is_damaged_is_named_and_not_in_the_words_of_python(
    paper: FlightPlan, part: str, value: object, says: str
) -> None:
    document = json.loads(plan_to_json(paper))
    document[part] = value
    if value is ...:
        del document[part]
    with pytest.raises(SpecError) as refused:
        plan_from_json(json.dumps(document))
    (fault,) = refused.value.faults
    assert fault.message.startswith("this is not a plan: ")
    assert fault.message.endswith(says)


@pytest.mark.parametrize(
    ("text", "says"),
    [
        ("[3]", "its format is not 'ltl-mission plan 4'"),
        ("{}", "its format is not 'ltl-mission plan 4'"),
        ('{"format":', "JSON ends at line 1, column 11"),
        ("1" * 5000, "it is nested too deep, or has too long a number"),
    ],
)
def test_what_is_no_plan_at_all_is_said_in_plain_words(text: str, says: str) -> None:
    with pytest.raises(SpecError) as refused:
        plan_from_json(text)
    assert refused.value.faults[0].message == f"this is not a plan: {says}"


def test_a_plan_from_elsewhere_begins_there(paper: FlightPlan) -> None:
    plan = plan_mission(paper.spec, start_m=(12.0, 3.0))
    assert plan.run.states[0] == 9
    assert plan.path.position([0.0])[0] == pytest.approx((12.0, 3.0))


@pytest.mark.parametrize(("start_m", "says"), [((20.0, 5.0), "outside the domain"), ((6.5, 7.5), "restricted region")])
def test_a_start_that_cannot_be_used_is_refused(paper: FlightPlan, start_m: tuple[float, float], says: str) -> None:
    with pytest.raises(SpecError, match=says):
        plan_mission(paper.spec, start_m=start_m)


def test_a_run_that_does_not_exist_is_refused(paper: FlightPlan) -> None:
    assert plan_mission(paper.spec, run=3).run.states[6:9] == (1, 3, 7)
    with pytest.raises(SpecError, match="no run 4"):
        plan_mission(paper.spec, run=4)


def test_restricted_regions_are_kept_off_even_if_the_formula_forgets_them(paper: FlightPlan) -> None:
    plan = plan_mission(changed(paper.spec, formula="F S1"))
    assert not plan.restricted[list(plan.run.states)].any()
    with pytest.raises(NoPlanError, match="K1 is restricted: it is never entered"):
        plan_mission(changed(paper.spec, formula="F K1"))


def test_too_few_frequencies_are_refused_with_the_place(paper: FlightPlan) -> None:
    rough = changed(paper.spec, smoothing=dataclasses.replace(series_of(paper.spec), frequencies=2))
    with pytest.raises(NoPlanError, match=r"2 frequencies is not proved .* ask for more frequencies"):
        plan_mission(rough)


def test_a_tube_wider_than_the_gaps_has_no_proof(paper: FlightPlan) -> None:
    flight = dataclasses.replace(paper.spec.flight, disturbance_m_s2=0.2)  # 5 m at tau = 5 s
    smoothing = dataclasses.replace(series_of(paper.spec), frequencies="auto")
    with pytest.raises(NoPlanError, match="tube of 5 m"):
        plan_mission(changed(paper.spec, flight=flight, smoothing=smoothing))


def test_a_formula_that_is_none_is_refused(paper: FlightPlan) -> None:
    with pytest.raises(FormulaSyntaxError):
        plan_mission(changed(paper.spec, formula="F (S1 &"))


@pytest.mark.parametrize(
    ("frequencies", "disturbance", "advice"),
    [
        ("1", 0.0, "a `loiter_s` of theirs, or a `disturbance_m_s2` above 0"),
        ("1", 0.5, "the tube is 0.5 m wide on each side"),
        ("auto", 7.0, "not with this one of 7 m per axis:\n    the tube does not fit into north"),
    ],
)
def test_where_nothing_is_proved_it_says_what_may_help(frequencies: str, disturbance: float, advice: str) -> None:
    text = ROUNDS.replace("disturbance_m_s2: 0.4", f"disturbance_m_s2: {disturbance}")
    spec = parse_mission((text + f"smoothing: {{frequencies: {frequencies}}}\n").encode())
    with pytest.raises(NoPlanError, match=advice):
        plan_mission(spec, run=0)  # no other run is tried in its place
