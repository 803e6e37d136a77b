"""Flights with stretches of their logs cut out: what is told of them is never contradicted by the whole log."""

import math
from dataclasses import replace
from functools import cache
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from mission.geometry.location import Locator
from mission.logic.automata.automaton import compile_to_alphabet
from mission.monitor.monitor import Monitor
from mission.spec.domain import build_domain, restricted_triangles
from mission.spec.loader import parse_mission
from mission.spec.model import MissionSpec, Point
from mission.spec.specification import deterministic_of, of_mission
from mission.verify.flown.judging import judged
from mission.verify.logs.telemetry import Clock
from mission.verify.logs.track import Track
from tests.support.drawn_cases import tried
from tests.support.gaps import contradictions, kept

STEP_S = 0.1
ACCELERATION_M_S2 = 4.0
SPEED_M_S = 8.0

MISSION = """\
domain:
  boundary: [[0, 0], [60, 0], [60, 40], [0, 40]]
regions:
  home: {kind: home, polygon: [[4, 4], [14, 4], [14, 12], [4, 12]]}
  field: {kind: survey, polygon: [[36, 4], [52, 4], [52, 16], [36, 16]]COVER}
  barn: {kind: restricted, polygon: [[24, 10], [30, 10], [30, 16], [24, 16]]}
  gate: {kind: area, polygon: [[20, 30], [26, 30], [26, 38], [20, 38]]}
mission:
  formula: FORMULA
start:
  position_m: [9, 8]
"""

FORMULAS = (
    "F (field & F home) & G !barn",
    "F field & (!field U gate)",
    "F gate & G (gate -> !home)",
    "G !gate & F field",
    "F (field | gate) | G home",
    "G !gate",
)
COVER = ", cover: {spacing_m: 8, share: 0.6}"
PLACES = (
    *((9.0, 8.0), (9.0, 34.0), (23.0, 34.0), (40.0, 9.0), (48.0, 12.0), (33.0, 6.0), (55.0, 30.0)),
    *((27.0, 8.5), (27.0, 13.0), (22.0, 13.0), (18.0, 28.0), (28.0, 32.0)),
)


@cache
def mission(formula: str, cover: str = "") -> MissionSpec:
    return parse_mission(MISSION.replace("FORMULA", formula).replace("COVER", cover).encode())


def flown(places: list[Point]) -> Track:
    """From rest to rest along straight lines, with bounded acceleration: quintic in time, sampled at 10 Hz."""
    parts = [np.array([places[0]])]
    for begin, end in pairwise(places):
        length = math.dist(begin, end)
        lasts_s = max(math.sqrt(5.78 * length / ACCELERATION_M_S2), 1.875 * length / SPEED_M_S, STEP_S)
        share = np.arange(1, math.ceil(lasts_s / STEP_S) + 1) * STEP_S / (math.ceil(lasts_s / STEP_S) * STEP_S)
        along = share**3 * (10.0 - 15.0 * share + 6.0 * share**2)
        parts.append(np.array(begin) + along[:, None] * (np.array(end) - begin))
    positions = np.concatenate(parts)
    times = np.linspace(100.0, 100.0 + STEP_S * (len(positions) - 1), len(positions))
    return Track(times, positions, 100.0, True, True, (), Clock.of(()), "as they are")


CUT_FLIGHTS = (
    st.sampled_from(FORMULAS),
    st.lists(st.sampled_from(PLACES), min_size=1, max_size=6),
    st.lists(st.tuples(st.floats(0.0, 0.95), st.floats(0.0, 0.3)), min_size=1, max_size=3),
)


@tried(40)
@given(*CUT_FLIGHTS)
def test_gaps_are_gaps_in_the_verdict_and_no_guesses(
    formula: str, places: list[Point], gaps: list[tuple[float, float]]
) -> None:
    assert_never_contradicted(formula, places, gaps)


@pytest.mark.long
@pytest.mark.timeout(1200)
@tried(3000)
@given(*CUT_FLIGHTS)
def test_thousands_of_logs_with_gaps(formula: str, places: list[Point], gaps: list[tuple[float, float]]) -> None:
    assert_never_contradicted(formula, places, gaps)


def assert_never_contradicted(formula: str, places: list[Point], gaps: list[tuple[float, float]]) -> None:
    whole = flown([(9.0, 8.0), *places])
    spec = mission(formula, COVER)
    told = judged(spec, kept(whole, gaps), fastest_m_s=SPEED_M_S + 0.5)
    assert not contradictions(told, judged(spec, whole, fastest_m_s=SPEED_M_S + 0.5))


def monitor_of(spec: MissionSpec) -> Monitor:
    partition, labelling = build_domain(spec)
    required = of_mission(spec, labelling.letters)
    return Monitor(
        Locator(partition),
        labelling,
        satisfied_by=required.satisfied_by,
        automata=tuple(compile_to_alphabet(part, labelling.letters) for part in required.automata),
        whole=deterministic_of(required.formula, required.given, labelling.letters).whole,
        refutation=compile_to_alphabet(required.refutation, labelling.letters),
        semantics=spec.semantics,
        restricted=restricted_triangles(spec, labelling),
    )


@tried(25)
@given(st.sampled_from(FORMULAS), st.lists(st.sampled_from(PLACES), min_size=1, max_size=6))
def test_a_log_without_gaps_is_judged_as_in_flight(formula: str, places: list[Point]) -> None:
    track, spec = flown([(9.0, 8.0), *places]), mission(formula)
    monitor = monitor_of(spec)
    for t_s, (east, north) in zip(track.t_s.tolist(), track.position_m.tolist(), strict=True):
        monitor.observe(t_s, (east, north))
    found = judged(spec, track)
    if found.achieved is None:
        return  # what the monitor takes for certain
    assert found.achieved is monitor.verdict_at_end(stays=True).achieved
    assert bool(found.violations) is bool(monitor.violations)


ALL_OF_THE_FIELD = [(9.0, 8.0), (33.0, 6.0), (37.0, 8.0), (51.0, 8.0), (51.0, 14.0), (37.0, 14.0)]
"""All of the field, past the barn."""


def test_the_example_of_a_flight_that_is_known() -> None:
    found = judged(mission(FORMULAS[0], COVER), flown([*ALL_OF_THE_FIELD, (33.0, 6.0), (9.0, 8.0)]))
    assert found.achieved, found.reason
    assert [letter.regions for letter in found.word] == [("home",), (), ("field",), (), ("home",)]
    assert found.covered[0].least > 0.9
    assert found.nearness[0].least_m == pytest.approx(3.25 * math.cos(math.atan(1.0 / 12.0)))


def test_a_gap_beside_what_is_restricted_is_named_with_its_time() -> None:
    whole = flown([*ALL_OF_THE_FIELD, (33.0, 6.0), (9.0, 8.0)])
    slow = kept(whole, [(0.06, 0.06)])
    found = judged(mission(FORMULAS[0]), slow)
    assert found.achieved is None
    (doubt,) = [doubt for doubt in found.doubts if doubt.violates]
    gap = int(np.argmax(np.diff(slow.t_s)))
    assert (doubt.from_s, doubt.to_s) == (slow.t_s[gap], slow.t_s[gap + 1])
    assert doubt.restricted == ("barn",)
    assert found.nearness[0].surely_m == 0.0


def test_a_gap_in_the_middle_of_nowhere_costs_nothing() -> None:
    whole = flown([(9.0, 8.0), (33.0, 6.0), (44.0, 10.0)])
    formula = "F field & G !barn"
    still = np.linspace(96.0, whole.t_s[-1], 40 + len(whole.t_s))
    positions = np.concatenate((np.tile(whole.position_m[0], (40, 1)), whole.position_m))
    slow = replace(whole, word_from_s=96.0, t_s=still, position_m=positions)
    # One second without a word while it stands at home, 4 m from the border.
    inside = (slow.t_s < 97.0) | (slow.t_s > 98.0)
    told = replace(slow, t_s=slow.t_s[inside], position_m=slow.position_m[inside])
    found = judged(mission(formula), told)
    assert not found.doubts
    assert found.longest_gap_s > 1.0


def test_what_no_way_leads_round_was_entered_even_in_a_gap() -> None:
    wall = (
        MISSION.replace("FORMULA", "F field")
        .replace("COVER", "")
        .replace("polygon: [[24, 10], [30, 10], [30, 16], [24, 16]]", "polygon: [[24, 0], [30, 0], [30, 40], [24, 40]]")
    )
    track = flown([(9.0, 8.0), (20.0, 8.0), (34.0, 8.0), (44.0, 8.0)])
    beyond = (track.position_m[:, 0] < 22.0) | (track.position_m[:, 0] > 32.0)
    told = replace(track, t_s=track.t_s[beyond], position_m=track.position_m[beyond])
    found = judged(parse_mission(wall.encode()), told)
    assert found.achieved is False
    assert [violation.names for violation in found.violations] == [("barn",)]


def test_a_log_that_begins_or_ends_in_the_air_cannot_tell_the_rest() -> None:
    spec, track = mission("F field & G !barn"), flown([(9.0, 8.0), (33.0, 6.0), (44.0, 10.0)])
    for cut in (replace(track, begins_whole=False), replace(track, ends_whole=False)):
        found = judged(spec, cut)
        assert found.achieved is None
        assert any(math.isinf(doubt.from_s) or math.isinf(doubt.to_s) for doubt in found.doubts)
        assert found.nearness[0].surely_m == 0.0


def test_slow_reports_leave_open_what_fast_ones_tell() -> None:
    # Half a metre beside the barn, at full speed.
    spec, track = mission("F field & G !barn"), flown([(9.0, 8.0), (14.0, 9.5), (40.0, 9.5)])
    assert judged(spec, track).achieved
    rare = replace(track, t_s=track.t_s[::8], position_m=track.position_m[::8])
    rare = replace(
        rare,
        t_s=np.append(rare.t_s[rare.t_s < track.t_s[-1]], track.t_s[-1]),
        position_m=np.append(rare.position_m[rare.t_s < track.t_s[-1]], track.position_m[-1:], axis=0),
    )
    found = judged(spec, rare)
    assert found.achieved is None
    assert {name for doubt in found.doubts for name in doubt.restricted} == {"barn"}


def test_a_jump_of_the_position_is_no_flight() -> None:
    spec, track = mission("F field & G !barn"), flown([(9.0, 8.0), (20.0, 6.0), (33.0, 6.0), (44.0, 10.0)])
    positions = track.position_m.copy()
    middle = int(np.argmin(np.hypot(*(positions - (20.0, 6.0)).T)))
    positions[middle] += (0.0, 5.0)
    found = judged(spec, replace(track, position_m=positions))
    assert len(found.jumps) == 2
    assert found.achieved is None or found.achieved
    assert found.nearness[0].surely_m < found.nearness[0].least_m


@pytest.mark.parametrize(("velocity", "verdict"), [((0.0, 0.0), "True"), ((0.0, 3.0), "None")])
def test_a_vehicle_that_nobody_led_stayed_where_its_limits_let_it(velocity: Point, verdict: str) -> None:
    """Beside the barn, for a minute: one that hovered did not go there, of one that flew at it nobody knows."""
    whole = flown([(9.0, 8.0), (27.0, 8.0), (48.0, 12.0)])
    here = int(np.argmin(np.abs(whole.position_m[:, 0] - 27.0)))
    told = replace(whole, t_s=whole.t_s + np.where(np.arange(len(whole.t_s)) > here, 60.0, 0.0))
    spec = mission("F field & G !barn")
    assert judged(spec, told).achieved is None
    found = judged(spec, replace(told, left=((float(told.t_s[here]), velocity),)))
    assert str(found.achieved) == verdict
    assert any(doubt.violates for doubt in found.doubts) is (verdict == "None")
