"""An airspace that closes is flown in time by both autopilots, and judged by the monitor and on the record."""

import io
from dataclasses import replace

import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st

from mission.fly import fly
from mission.monitor.flight import FlightMonitor
from mission.monitor.stage import Stage
from mission.report.reading import parse_record
from mission.report.record import FlightRecord
from mission.verify.flown.judging import Judged, judged
from mission.verify.logs.flight_record import track_of_record
from mission.verify.logs.telemetry import Clock
from mission.verify.logs.track import Track
from tests.support.closing_missions import closing, closing_plan
from tests.support.faults import schedule_of
from tests.support.lockstep import LockstepVehicle, vehicle_of

GATE = shapely.box(40.0, 0.0, 46.0, 30.0)


@pytest.mark.parametrize(
    ("flavour", "window", "before"), [("ardupilot", "[14, 60]", True), ("px4", "[null, 12]", False)]
)
def test_a_gate_is_passed_before_it_closes_or_when_it_is_open(flavour: str, window: str, before: bool) -> None:  # noqa: FBT001 - what is expected
    plan = closing_plan("F far", gate=window)
    vehicle, sink = LockstepVehicle(vehicle_of(flavour, seed=4)), io.BytesIO()
    result = fly(plan, vehicle, vehicle, FlightRecord(sink, mission="a gate"))
    assert result.achieved, result.reason
    track = track_of_record(parse_record(sink.getvalue()))
    verdict = judged(plan.spec, track)
    assert verdict.achieved, verdict.reason
    (bound,) = verdict.bounds
    assert bound.met
    inside = shapely.contains_xy(GATE, *track.position_m.T)
    met = track.t_s[inside] - track.word_from_s
    assert met.size
    assert (met.max() < 14.0) if before else (met.min() > 12.0)


@pytest.mark.parametrize(("flavour", "late"), [("ardupilot", True), ("px4", False)])
def test_a_flight_that_a_link_makes_late_holds_before_a_gate_that_would_have_closed(flavour: str, late: bool) -> None:  # noqa: FBT001 - what is expected
    """The link takes a second from soon after the start on; ArduPilot is kept by that for longer than there is."""
    plan = closing_plan("F far", gate="[13.5, 60]")
    config = replace(vehicle_of(flavour, seed=4), faults=schedule_of("link, delay_s: 0.5, at_s: 20"))
    vehicle, sink = LockstepVehicle(config), io.BytesIO()
    result = fly(plan, vehicle, vehicle, FlightRecord(sink, mission="a gate"))
    assert result.achieved is not late
    if late:
        assert result.reason.startswith("the flight is 2.8 s late and would come into gate[13.5,60]; ")
        assert not shapely.contains_xy(GATE, *track_of_record(parse_record(sink.getvalue())).position_m.T).any()


def flown(times: np.ndarray, places: np.ndarray) -> Track:
    return Track(
        t_s=100.0 + times,
        position_m=places,
        word_from_s=100.0,
        begins_whole=True,
        ends_whole=True,
        pictures=(),
        clock=Clock.of(()),
        frame="as drawn",
    )


def on_a_log(window: tuple[float, float], track: Track, kind: str) -> Judged:
    formula = "F gate" if kind == "area" else "true"
    return judged(closing(formula, "[visit: home]", kind=kind, gate=f"[{window[0]}, {window[1]}]"), track)


@settings(max_examples=20, deadline=None)
@given(
    corners=st.lists(st.tuples(st.floats(20.0, 60.0), st.floats(2.0, 28.0)), min_size=1, max_size=4),
    window=st.tuples(st.integers(0, 60), st.integers(1, 40)),
    kind=st.sampled_from(["restricted", "area"]),
)
def test_a_random_flight_is_judged_as_dense_samples_of_it_say(
    corners: list[tuple[float, float]], window: tuple[int, int], kind: str
) -> None:
    way = np.array([(9.0, 15.0), *corners, (9.0, 15.0)])
    legs_s = np.linalg.norm(np.diff(way, axis=0), axis=1) / 4.0 + 0.1
    at_s = np.concatenate(([0.0], np.cumsum(legs_s)))

    def places(times: np.ndarray) -> np.ndarray:
        return np.column_stack([np.interp(times, at_s, axis) for axis in way.T])

    begin_s, end_s = window[0] / 2, (window[0] + window[1]) / 2
    dense = np.arange(0.0, at_s[-1], 0.002)
    inside = dense[shapely.contains_xy(GATE, *places(dense).T)]
    there = bool(((inside >= begin_s) & (inside <= end_s)).any())
    times = np.arange(0.0, at_s[-1] + 1.0, 0.1)
    track = flown(times, places(times))
    verdict = on_a_log((begin_s, end_s), track, kind)
    met = {bound.formula.partition("[")[0]: bound.met for bound in verdict.bounds}
    # What a report is not sure of it leaves open, but what it says is so.
    assert met["F gate" if kind == "area" else "G !gate"] in (None, there is (kind == "area"))
    near = np.abs(inside[:, None] - [begin_s, end_s]).min() if inside.size else np.inf
    if near > 0.5 and (shapely.distance(GATE, shapely.LineString(way)) > 1.0 or there):
        assert verdict.bounds[0].met is (there is (kind == "area"))


def test_the_monitor_tells_when_it_was_missed_and_what_is_left() -> None:
    plan = closing_plan(kind="area")
    monitor = FlightMonitor(closing_plan("F far", gate="[60, 180]"))
    times = np.arange(0.0, plan.trajectory.duration_s, 0.1)
    for t_s, place in zip(times, plan.trajectory.position(times), strict=True):
        monitor.report(Stage.FLY, float(t_s), (float(place[0]), float(place[1])))
        (bound,) = monitor.monitor.bounds
        assert bound.met is None
        inside = "gate" in monitor.monitor.word[-1]  # who stays there misses it when it comes
        assert (bound.at_s, bound.will) == ((60.0, False) if inside else (180.0, True))
        assert bound.text(50.0) == f"G !gate[60,180] open, {'10 s left' if inside else '130 s to go'}"
    late = FlightMonitor(closing_plan("F far", gate="[60, 180]"))
    for t_s, place in zip(times + 50.0, plan.trajectory.position(times), strict=True):
        late.report(Stage.FLY, 0.0 if t_s == 50.0 else float(t_s), (float(place[0]), float(place[1])))
    (bound,) = late.monitor.bounds
    assert bound.met is False
    assert bound.at_s == 60.0
    assert "G !gate[60,180] was missed 60.0 s after" in late.monitor.outcome(stays=True).reason
