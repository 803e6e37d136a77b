"""Bounds in seconds on logs: kept, missed at a time, or not to be told."""

from dataclasses import replace

import numpy as np
import pytest

from mission.spec.model import MissionSpec
from mission.spec.specification import of_mission
from mission.verify.flown.judging import Judged, judged
from mission.verify.logs.flights import flights_of
from mission.verify.logs.telemetry import Clock, Log, Telemetry
from mission.verify.logs.track import Track, track_of
from tests.support.timed_missions import timed, timed_plan

FORMULA = "F G home & F[0,60] far & G[0,12] !gate"


def track(*, later_s: float = 0.0, without: tuple[float, float] = (0.0, 0.0)) -> Track:
    """The planned flight, begun at 100 s and after a wait; nothing is told between two times."""
    trajectory = timed_plan(FORMULA).trajectory
    times = np.arange(0.0, trajectory.duration_s + later_s, 0.1)
    times = times[(times <= without[0]) | (times >= without[1])]
    return Track(
        t_s=100.0 + times,
        position_m=trajectory.position(np.maximum(times - later_s, 0.0)),
        word_from_s=100.0,
        begins_whole=True,
        ends_whole=True,
        pictures=(),
        clock=Clock.of(()),
        frame="as planned",
    )


def found(spec: MissionSpec, flown: Track) -> tuple[Judged, dict[str, bool | None]]:
    verdict = judged(spec, flown)
    return verdict, {bound.formula: bound.met for bound in verdict.bounds}


def test_the_planned_flight_keeps_its_bounds() -> None:
    verdict, bounds = found(timed(FORMULA), track())
    assert verdict.achieved
    assert bounds == {"F[0,60] far": True, "G[0,12] !gate": True}
    margins = {bound.formula: bound.margin_s for bound in verdict.bounds}
    planned = {str(bound.formula): bound.margin_s for bound in timed_plan(FORMULA).bounds}
    # On its path the vehicle is inside later, and not sooner, than wherever it may be in the tube.
    assert all((margins[name] or 0.0) >= margin - 0.2 for name, margin in planned.items())


def test_a_flight_that_is_late_misses_a_bound_at_a_time() -> None:
    spec = timed("F G home & F[0,15] far")
    verdict, bounds = found(spec, track())
    assert verdict.achieved is False
    assert verdict.reason == "F[0,15] far was missed, 15.0 s after the trajectory began"
    assert bounds == {"F[0,15] far": False}


def test_a_gap_over_a_bound_leaves_it_open() -> None:
    spec = timed("F G home & F[0,19] far")
    assert found(spec, track())[1] == {"F[0,19] far": True}
    verdict, bounds = found(spec, track(without=(15.0, 25.0)))
    assert bounds == {"F[0,19] far": None}
    assert verdict.achieved is None


def test_a_log_that_does_not_tell_when_the_trajectory_began_leaves_open_what_depends_on_it() -> None:
    flown = replace(track(later_s=5.0), moves_from_s=107.0)
    verdict, bounds = found(timed("F G home & F[0,60] far & F[0,20] far"), flown)
    assert bounds == {"F[0,60] far": True, "F[0,20] far": None}
    assert verdict.achieved is None
    assert "depends on what the log does not tell" in verdict.reason


def test_a_wish_is_met_in_time_or_not() -> None:
    spec = timed(
        "F G home & F far", "[visit: near, {visit: far, by_s: 40, weight: 1}, {visit: far, by_s: 9, weight: 1}]"
    )
    assert [wish.met for wish in judged(spec, track()).wishes] == [True, False]


@pytest.mark.parametrize(("every_s", "kept"), [(60, True), (20, False)])
def test_laps_keep_a_bound_between_visits(every_s: int, kept: bool) -> None:  # noqa: FBT001 - what is expected
    plan = timed_plan("G F home", "[{patrol: [near, far], every_s: 60}]")
    times = np.arange(0.0, plan.trajectory.duration_s, 0.1)
    flown = replace(track(), t_s=times, position_m=plan.trajectory.position(times), word_from_s=0.0)
    spec = timed("G F home", f"[{{patrol: [near, far], every_s: {every_s}}}]")
    verdict = judged(spec, flown, plan=replace(plan, required=of_mission(spec, plan.labelling.letters)))
    assert verdict.achieved is kept
    assert {bound.met for bound in verdict.bounds} == {kept}


@pytest.mark.parametrize(
    ("aloft_s", "met", "achieved"),
    [
        ((58.0, 60.0), True, True),
        ((59.5, 60.5), None, None),
        ((60.5, 62.5), False, False),
        (None, None, None),
    ],
)
def test_the_time_from_arming_to_landing_is_judged_as_far_as_the_log_tells_it(
    aloft_s: tuple[float, float] | None,
    met: bool | None,  # noqa: FBT001 - what is expected
    achieved: bool | None,  # noqa: FBT001 - likewise
) -> None:
    spec = timed("F G home")
    spec = replace(spec, flight=replace(spec.flight, longest_s=60.0))
    verdict, bounds = found(spec, replace(track(), aloft_s=aloft_s))
    assert bounds == {"flight.longest_s: 60": met}
    assert verdict.achieved is achieved


@pytest.mark.parametrize(
    ("armed", "airborne", "aloft_s"),
    [
        ([(0.0, False), (10.0, True), (70.0, False)], [(0.0, False), (14.0, True), (65.0, False)], (54.0, 56.0)),
        ([(9.0, True), (70.0, False)], [(0.0, False), (14.0, True), (65.0, False)], None),
        ([(0.0, False), (10.0, True)], [(0.0, False), (14.0, True)], None),
        ([], [(0.0, False), (14.0, True), (65.0, False)], None),
    ],
)
def test_a_log_tells_the_time_from_arming_to_landing_where_it_has_both(
    armed: list[tuple[float, bool]], airborne: list[tuple[float, bool]], aloft_s: tuple[float, float] | None
) -> None:
    told = Telemetry(armed=armed, airborne=airborne)
    for t_s in range(8, 70):
        told.local.extend((float(t_s), 0.0, 0.0, -5.0))
    (flight,) = flights_of(Log("", (told,)))
    assert track_of(flight, None, (9.0, 15.0)).aloft_s == aloft_s
