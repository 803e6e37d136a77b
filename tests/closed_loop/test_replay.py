"""The same monitor serves the flight and the record: what was known at each moment is known from the record again."""

import io
from functools import cache

import pytest

from mission.fly import FlightOptions, Progress, StopRequest, fly
from mission.monitor.verdict import Verdict
from mission.report.reading import parse_record
from mission.report.record import FlightRecord
from mission.report.replay import judged_again, replay
from mission.report.summary import summary
from mission.spec.air_time import air_s
from mission.verify.logs.flight_record import track_of_record
from tests.support.lockstep import LockstepVehicle, vehicle_of
from tests.support.small_missions import ROUNDS, SMALL, plan_of


@cache
def flown(text: str, stop_after_s: float | None = None) -> tuple[list[Progress], bytes]:
    """What was shown in a flight of a mission, and the record; given up at a time on the trajectory."""
    vehicle, sink = LockstepVehicle(vehicle_of("ardupilot", seed=2)), io.BytesIO()
    moments: list[Progress] = []
    requests = [] if stop_after_s is None else [StopRequest("enough")]

    def request() -> StopRequest | None:
        late = moments and stop_after_s is not None and moments[-1].trajectory_s > stop_after_s
        return requests.pop() if requests and late else None

    fly(
        plan_of(text),
        vehicle,
        vehicle,
        FlightRecord(sink, mission="replayed"),
        options=FlightOptions(land_when_stopped=True),
        on_progress=moments.append,
        stop_request=request,
    )
    return moments, sink.getvalue()


def test_a_flight_takes_no_longer_from_arming_to_landing_than_is_reckoned() -> None:
    plan, told = plan_of(SMALL), track_of_record(parse_record(flown(SMALL)[1])).aloft_s
    assert told is not None
    takes_s = air_s(plan.spec.flight.altitude_m, plan.trajectory.duration_s)
    assert takes_s - 20.0 < told[0] == told[1] < takes_s


@pytest.mark.parametrize(
    ("text", "stop_after_s"), [(SMALL, None), (ROUNDS, None), (ROUNDS, 9.0)], ids=["stays", "laps", "given up"]
)
def test_the_record_is_judged_as_the_flight_was(text: str, stop_after_s: float | None) -> None:
    plan = plan_of(text)
    moments, data = flown(text, stop_after_s)
    record = parse_record(data)
    shown = iter([moment for moment in moments if moment.t_s is not None])
    moment, compared = next(shown), 0
    for t_s, judged in replay(plan, record):
        known, progress = judged.monitor, judged.monitor.progress
        while moment.t_s is not None and moment.t_s <= t_s:
            if moment.t_s == t_s:
                compared += 1
                then = (moment.verdict, moment.done, moment.total, moment.awaited, moment.laps)
                assert then == (known.verdict, progress.done, progress.total, progress.awaited, known.laps)
            following = next(shown, None)
            if following is None:
                break
            moment = following
    assert compared > 50
    end = judged_again(plan, record).now.judged
    assert record.verdict is not None
    assert record.verdict["word"] == [sorted(letter) for letter in end.monitor.word]
    assert record.verdict["laps"] == end.monitor.laps
    assert {name: record.verdict[name] for name in ("so_far", "done", "total")} == {
        "so_far": end.monitor.verdict,
        "done": end.monitor.progress.done,
        "total": end.monitor.progress.total,
    }
    assert tuple(record.verdict["awaited"]) == end.monitor.progress.awaited
    assert [(visit.t_s, visit.triangle) for visit in record.visits] == [
        (visit.entered_s, visit.triangle) for visit in end.monitor.visits
    ]
    outcome = end.monitor.verdict_at_end(stays=not plan.run.recurrent)
    assert outcome.achieved or stop_after_s is not None
    if stop_after_s is None:
        assert (record.verdict["achieved"], record.verdict["reason"]) == (outcome.achieved, outcome.reason)


def test_a_record_that_is_cut_tells_what_was_known_up_to_there() -> None:
    plan = plan_of(SMALL)
    _, data = flown(SMALL, None)
    half = parse_record(data[: len(data) // 2])
    assert half.cut
    judged = summary(plan, half)["flown"]["judged"]
    assert judged["so_far"] == Verdict.OPEN
    assert judged["done"] < judged["total"]
    assert judged["awaited"] == ["goal"] or judged["awaited"] == ["home"]
    assert judged["violations"] == []
