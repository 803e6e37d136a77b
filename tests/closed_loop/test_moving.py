"""Flights among regions that move, with both autopilots: late ones, ones that hold, and what their records say.

Some plans are made as if nothing moved; what moves is chosen so that it meets nothing of a flight that is on time.
"""

import io
from pathlib import Path

import numpy as np
import pytest
import shapely

from mission.fly import FlightOptions, fly
from mission.fly.requests import Request
from mission.monitor.stage import Stage
from mission.plan import plan_mission
from mission.report.reading import parse_record
from mission.report.record import FlightRecord
from mission.verify.flown.judging import judged
from mission.verify.logs.flight_record import track_of_record
from mission.verify.logs.reading import read_flight
from tests.closed_loop.test_logs_of_flights import HeardVehicle
from tests.closed_loop.test_requests import Asked
from tests.support.drifting_flights import k_at, planned_still
from tests.support.drifting_missions import drifting
from tests.support.replanned import Replanned

BEHIND = "{velocity_m_s: [0, 2], from_s: 9.7, until_s: 29.7}"
"""It is on the way from home to S1 a second after that was flown, at 19 s, and gone before the way back, at 48 s."""

LATER = "{velocity_m_s: [0, 2], from_s: 57, until_s: 77}"

AWAY = "{velocity_m_s: [0, -0.02], until_s: 60}"


def apart_m(flight: Replanned) -> np.ndarray:
    """How far the vehicle was from the region at each report, by the polygon where it is then."""
    track = track_of_record(flight.record)
    since_s = track.t_s - track.word_from_s
    places = zip(np.maximum(since_s, 0.0).tolist(), track.position_m, strict=True)
    return np.array([k_at(flight.plan.spec, t).distance(shapely.Point(place)) for t, place in places])


def test_one_that_a_link_makes_late_holds_before_it_would_come_into_it() -> None:
    """The link takes a second from soon after the start on: more than a way has that was planned without what moves."""
    plan = planned_still(motion=BEHIND)
    flight = Replanned(plan, "ardupilot", "link, delay_s: 0.5, at_s: 20")
    assert not flight.result.achieved
    assert not judged(plan.spec, track_of_record(flight.record)).achieved
    assert "s late and would come into K, which moves; " in flight.result.reason
    assert apart_m(flight).min() > 10.0


@pytest.mark.parametrize("flavour", ["ardupilot", "px4"])
def test_one_that_was_planned_among_what_moves_may_be_a_second_late(flavour: str) -> None:
    plan = plan_mission(drifting(motion=BEHIND))
    flight = Replanned(plan, flavour, "link, delay_s: 0.5, at_s: 20")
    assert flight.result.achieved
    assert judged(plan.spec, track_of_record(flight.record)).achieved
    assert apart_m(flight).min() > plan.certificate.tube_m


@pytest.mark.parametrize("flavour", ["ardupilot", "px4"])
def test_who_waits_where_the_region_will_come_lands_in_time(flavour: str) -> None:
    asked = Asked((15.5, Request.HOLD))
    options = FlightOptions(land_when_stopped=False)
    flight = Replanned(planned_still(motion=LATER), flavour, at_step=asked.look, requests=asked, options=options)
    ((*_, granted),) = asked.answers
    assert granted
    why = "the vehicle cannot wait on; K moves to where the vehicle would hold, in 43 s: it lands"
    assert flight.result.reason.startswith(why)
    assert any(line.get("stage") == Stage.DONE for line in flight.events("stage"))
    assert apart_m(flight).min() > 5.0


def test_to_wait_is_refused_where_the_region_comes_soon_and_to_go_on_while_it_is_in_the_way() -> None:
    asked = Asked((3.0, Request.HOLD), (8.0, Request.RESUME), (24.0, Request.RESUME), (26.0, Request.LAND))
    Replanned(planned_still(motion=BEHIND), "px4", at_step=asked.look, requests=asked)
    assert [granted for *_, granted in asked.answers] == [True, False, True, True]
    assert asked.answers[1][2] == "the flight is 3.1 s late and would come into K, which moves"
    asked = Asked((15.5, Request.HOLD), (16.0, Request.LAND))
    Replanned(planned_still(motion=BEHIND), "px4", at_step=asked.look, requests=asked)
    assert asked.answers[0][2] == "K moves to where the vehicle would hold, in 0 s; the plan is flown on"


@pytest.mark.parametrize(
    ("flavour", "suffix", "motion", "achieved"),
    [("ardupilot", "bin", AWAY, True), ("px4", "ulg", BEHIND, None)],
)
def test_logs_are_judged_among_what_moves_and_do_not_say_what_they_do_not_tell(
    flavour: str,
    suffix: str,
    motion: str,
    achieved: bool | None,  # noqa: FBT001 - what is expected
    tmp_path: Path,
) -> None:
    """When the trajectory began is not told: had it been as it armed, it might have met what comes behind it."""
    plan, vehicle, sink = planned_still(motion=motion), HeardVehicle(flavour), io.BytesIO()
    fly(plan, vehicle, vehicle, FlightRecord(sink, mission="heard"))
    assert judged(plan.spec, track_of_record(parse_record(sink.getvalue()))).achieved
    (own,) = vehicle.endpoint.recorder.logs
    for name, log in (("heard.tlog", bytes(vehicle.log)), (f"own.{suffix}", bytes(own.data))):
        (tmp_path / name).write_bytes(log)
        track = read_flight(tmp_path / name, origin=None, start_m=plan.start_m).track
        assert judged(plan.spec, track).achieved is achieved
