"""A flight of laps: the way to one lap, which is proved and repeated, and a way back on which nothing is violated."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from mission.logic.automata.safety import safety_of
from mission.plan import (
    FlightPlan,
    plan_from_json,
    plan_mission,
    plan_to_json,
)
from mission.plan.flight_plan import prover_of
from mission.spec.loader import load_mission, parse_mission
from mission.spec.model import UNTIL_STOPPED, Extension
from mission.steering.joined import JoinedCurve
from mission.steering.smoothing import FourierCurve, fit_fourier
from tests.support.proofs import untrue
from tests.support.required import required
from tests.support.small_missions import ROUNDS, plan_of
from tests.support.steered_plans import by_fields, fields_of

PATROL = Path(__file__).parents[3] / "missions" / "patrol.yaml"


@pytest.fixture(scope="module")
def patrol() -> FlightPlan:
    return plan_mission(load_mission(PATROL))


def with_a_shortcut(curve: FourierCurve, at_s: float, toward_m: tuple[float, float]) -> FourierCurve:
    """The curve pulled toward a point around one time, left alone elsewhere."""
    s = np.linspace(0.0, curve.duration_s, 4001)
    pull = np.exp(-(((s - at_s) / 6.0) ** 2))[:, None]
    bent = curve.position(s) + 0.9 * pull * (np.array(toward_m) - curve.position(s))
    rest = bent - curve.base_m - np.multiply.outer(s, curve.slope_m_s)
    n = np.arange(1, 201)
    waves = np.sin(np.multiply.outer(n, s) * np.pi / curve.duration_s)
    amplitudes = 2.0 / len(s) * waves @ rest
    return FourierCurve(curve.extension, curve.duration_s, curve.base_m, curve.slope_m_s, amplitudes)


def test_a_lap_that_skips_a_gate_is_refused_although_the_way_to_it_passes_there() -> None:
    spec = by_fields(load_mission(PATROL))
    patrol = plan_mission(replace(spec, formula=f"F (north & F home) & {spec.formula}"))
    prover = prover_of(patrol.spec, patrol.partition, patrol.labelling, patrol.compiled_refutation, patrol.restricted)
    out, lap, _ = fields_of(patrol).legs
    assert any("north" in patrol.labelling.label(segment.triangle) for segment in out.segments)
    whole = [fit_fourier(leg, 200, Extension.ODD) for leg in (out, lap)]
    assert prover.certify(JoinedCurve(tuple(whole)), repeats=True).holds
    visit = next(s for s in lap.segments if "north" in patrol.labelling.label(s.triangle))
    skipping = with_a_shortcut(whole[1], visit.start_s + 0.5 * visit.duration_s, (60.0, 66.0))
    refused = prover.certify(JoinedCurve((whole[0], skipping)), repeats=True)
    assert not refused.holds
    assert "its lap does not enter home, north (within" in refused.reason
    assert prover.certify(JoinedCurve((whole[0], whole[1], skipping)), repeats=False).counterexample  # no lap, no proof


def test_the_lap_is_flown_through_where_it_ends_and_begins(patrol: FlightPlan) -> None:
    trajectory = patrol.trajectory
    assert (trajectory.lap, trajectory.laps, len(trajectory.legs)) == (1, 2, 3)
    lap = trajectory.legs[1]
    ends, speeds, accelerations = lap.state(np.array([0.0, lap.duration_s]))
    assert ends[1] == pytest.approx(ends[0], abs=1e-9)
    assert speeds[1] == pytest.approx(speeds[0], abs=1e-6)
    assert np.hypot(*speeds[0]) > 0.5
    assert accelerations[1] == pytest.approx(accelerations[0], abs=1e-6)


def test_the_vehicle_returns_to_the_region_of_kind_home(patrol: FlightPlan) -> None:
    assert patrol.homeward is not None
    assert patrol.homeward.certificate.holds
    lap_ends = patrol.curve.position([patrol.curve.starts_s[2]])
    assert patrol.homeward.run.prefix[0] == patrol.locator.triangle_at(lap_ends)[0]
    end = patrol.trajectory.position([patrol.trajectory.duration_s])
    assert patrol.labelling.label(int(patrol.locator.triangle_at(end)[0])) == {"home"}
    assert not patrol.warnings


def test_more_laps_make_no_larger_plan(patrol: FlightPlan) -> None:
    flight = patrol.spec.flight
    many = plan_mission(replace(patrol.spec, flight=replace(flight, laps=10_000)))
    endless = plan_mission(replace(patrol.spec, flight=replace(flight, laps=UNTIL_STOPPED)))
    lap_s = patrol.trajectory.legs[1].duration_s
    assert many.trajectory.duration_s == pytest.approx(patrol.trajectory.duration_s + 9_998 * lap_s)
    assert endless.trajectory.duration_s == np.inf
    for plan in (many, endless):
        assert len(plan_to_json(plan)) == pytest.approx(len(plan_to_json(patrol)), abs=100)
        assert plan.certificate.to_json() == patrol.certificate.to_json()


@pytest.mark.parametrize("laps", ["3", "until_stopped"])
def test_a_plan_of_laps_survives_its_file(laps: str) -> None:
    plan = plan_of(ROUNDS.replace("laps: 2", f"laps: {laps}"))
    again = plan_from_json(plan_to_json(plan))
    assert plan_to_json(again) == plan_to_json(plan)
    assert again.homeward is not None
    assert not untrue(again)


def test_laps_join_whatever_extension_the_file_asks_for() -> None:
    plan = plan_of(ROUNDS + "smoothing: {extension: even}\n")
    assert {leg.extension for leg in plan.curve.legs if isinstance(leg, FourierCurve)} == {Extension.ODD}


def test_a_fixed_number_of_frequencies_is_that_of_the_longest_leg() -> None:
    plan = plan_of(ROUNDS + "smoothing: {frequencies: 90}\n")
    shares = [leg.frequencies / leg.duration_s for leg in plan.curve.legs]
    assert plan.curve.frequencies == 90
    assert shares == pytest.approx([shares[0]] * 3, rel=0.1)


def label_at_the_end(plan: FlightPlan) -> frozenset[str]:
    return plan.labelling.label(int(plan.locator.triangle_at(plan.curve.position([plan.curve.duration_s]))[0]))


def test_without_a_home_it_returns_to_where_it_started() -> None:
    plan = plan_of(ROUNDS.replace("kind: home", "kind: survey"))
    assert plan.homeward is not None
    assert plan.homeward.run.suffix == (plan.run.states[0],)
    assert not plan.warnings


def test_a_way_back_that_violates_the_formula_is_not_flown() -> None:
    # Once outside, home is forbidden: not by its kind, by the formula.
    plan = plan_of(ROUNDS.replace("& G !pond", "& G !pond & G (east -> G !home)"))
    assert label_at_the_end(plan) != {"home"}
    assert plan.homeward is not None  # staying where the laps end is proved
    assert any("flight ends where its laps do" in warning for warning in plan.warnings)


def test_what_must_be_kept_on_the_way_back_is_kept() -> None:
    # A triangle on the short way home is closed from the first visit to east on.
    plan = plan_of(ROUNDS)
    assert plan.homeward is not None
    free = [t for t in plan.homeward.run.states if not plan.labelling.label(t)]
    place = plan.partition.incentres_m[free[len(free) // 2]].tolist()
    text = ROUNDS.replace("  pond:", f"  middle: {{kind: survey, at: {place}}}\n  pond:")
    open_way, closed = plan_of(text), plan_of(text.replace("& G !pond", "& G !pond & G (east -> G !middle)"))

    def passes(plan: FlightPlan) -> bool:
        assert plan.homeward is not None
        return any("middle" in plan.labelling.label(t) for t in plan.homeward.run.states)

    assert label_at_the_end(open_way) == label_at_the_end(closed) == {"home"}
    assert passes(open_way)
    assert not passes(closed)


def test_the_proof_of_the_way_back_refuses_one_that_violates() -> None:
    plan = plan_of(ROUNDS)
    stricter = plan_of(ROUNDS.replace("& G !pond", "& G !pond & G (east -> G !home)"))
    safety = safety_of(required(stricter.formula, stricter.labelling.letters).whole)
    prover = prover_of(plan.spec, plan.partition, plan.labelling, safety.refutation(), plan.restricted)
    reached = prover.reached(JoinedCurve(plan.curve.legs[:2]), plan.certificate)
    back = JoinedCurve(plan.curve.legs[2:])
    refused = prover.certify(back, begins=reached)
    assert not refused.holds
    assert "home" in refused.reason


def test_laps_of_a_formula_that_is_never_safe_to_leave_still_end_somewhere() -> None:
    spec = parse_mission(ROUNDS.replace("laps: 2", "laps: until_stopped").encode())
    plan = plan_mission(spec, start_m=(9.0, 8.0))
    ended = plan.trajectory.ended_after(1.0)
    assert ended.laps == 1
    assert ended.position([ended.duration_s]) == pytest.approx(plan.curve.position([plan.curve.duration_s]), abs=1e-6)
