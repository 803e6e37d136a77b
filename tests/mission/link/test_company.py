"""Other vehicles on the link: they are told of, none is flown by mistake, and two of one id not at all."""

import io
from dataclasses import replace

import pytest
from pymavlink.dialects.v20 import ardupilotmega as mavlink

from mission.errors import VehicleError
from mission.fly import FlightOptions, StopRequest, fly
from mission.fly.preflight import inspect
from mission.link.arrival import Arrival
from mission.link.contact import Contact
from mission.link.identity import LinkOptions
from mission.link.values import TimeAnswer
from mission.link.vehicle_clock import VehicleClock
from mission.plan import FlightPlan
from mission.report.reading import parse_record
from mission.report.record import FlightRecord
from tests.support.lockstep import vehicle_of
from tests.support.several import Several
from tests.support.small_missions import SMALL, plan_of
from tests.support.spoken_for import SpokenFor


@pytest.fixture(scope="module")
def plan() -> FlightPlan:
    return plan_of(SMALL)


def answers(*offsets_s: float, late_s: float = 0.0, rate: float = 1.0) -> Arrival:
    """What requests come to, each answered by clocks that are so far off, or so late: by each of them alike."""
    clock = VehicleClock()
    arrival = Arrival(clock)
    for step in range(round(400 / rate)):
        local_s = 0.01 * step
        clock.observe(round(1000 * rate * local_s), local_s)
        if (asked_ns := arrival.due(local_s)) is not None:
            for offset_s in offsets_s:
                told_s = 100.0 + rate * local_s + offset_s
                arrival.take(TimeAnswer(round(1e9 * told_s), asked_ns), local_s + late_s)
    return arrival


@pytest.mark.parametrize("offset_s", [-90.0, -4.0, 1.5, 500.0])
def test_two_clocks_are_two_vehicles(offset_s: float) -> None:
    assert answers(0.0, offset_s).doubled


@pytest.mark.parametrize("rate", [1.0, 20.0])
def test_a_request_that_comes_twice_is_no_second_vehicle(rate: float) -> None:
    assert not answers(0.0, 0.0, 0.5 * rate, late_s=0.5, rate=rate).doubled


def contact_with(*messages: mavlink.MAVLink_message) -> Contact:
    contact = Contact(LinkOptions(), needs_origin=False)
    mouth = mavlink.MAVLink(None, srcSystem=1, srcComponent=1)
    for message in messages:
        for body in contact.receive(bytes(message.pack(mouth)), 0.0):
            contact.take(body, 0.0)
    return contact


def beats(autopilot: int) -> mavlink.MAVLink_message:
    return mavlink.MAVLink_heartbeat_message(mavlink.MAV_TYPE_QUADROTOR, autopilot, 81, 0, 3, 3)


def version(uid: int, *uid2: int) -> mavlink.MAVLink_message:
    board = [*uid2, *[0] * (18 - len(uid2))]
    return mavlink.MAVLink_autopilot_version_message(0, 0x04070000, 0, 0, 0, *[[0] * 8] * 3, 0, 0, uid, board)


ARDUPILOT, PX4 = beats(mavlink.MAV_AUTOPILOT_ARDUPILOTMEGA), beats(mavlink.MAV_AUTOPILOT_PX4)


@pytest.mark.parametrize(
    ("messages", "two"),
    [
        ((ARDUPILOT, PX4), True),
        ((ARDUPILOT, ARDUPILOT, version(7), version(7)), False),
        ((ARDUPILOT, version(7), version(8)), True),
        ((ARDUPILOT, version(0), version(8)), False),
        ((PX4, version(7, 1, 2), version(7, 1, 3)), True),
        ((PX4, beats(mavlink.MAV_AUTOPILOT_INVALID)), False),
    ],
)
def test_two_kinds_or_two_boards_are_two_vehicles(messages: tuple[mavlink.MAVLink_message, ...], two: bool) -> None:  # noqa: FBT001 - a test's parameter
    trouble = contact_with(*messages).trouble(0.0, departed=False)
    assert (trouble is not None) == two
    assert trouble is None or "two vehicles with the system id 1 are heard" in str(trouble)


def test_two_vehicles_with_one_id_are_not_armed(plan: FlightPlan) -> None:
    both = Several(("ardupilot", 1, 0.0), ("ardupilot", 1, 40.0))
    with pytest.raises(VehicleError, match="give one another id"):
        fly(plan, both, both, FlightRecord(io.BytesIO(), mission="two"))
    assert not both.armed


def test_of_two_vehicles_one_has_to_be_named(plan: FlightPlan) -> None:
    both = Several(("ardupilot", 3, 30.0), ("px4", 7, 30.0))
    findings = inspect(plan, both, both)
    (row,) = findings.forbidding
    assert row.words.startswith("vehicle: system id 3 was heard first; also heard: 7")
    assert "--system-id 3" in row.words
    findings = inspect(plan, both, both, link=LinkOptions(vehicle_id=7))
    assert findings.rows[0].judgement.figure == "system id 7, as asked for; also heard: 3"


def test_one_that_is_heard_in_flight_is_told_of_and_changes_nothing(plan: FlightPlan) -> None:
    vehicle, warnings, sink = SpokenFor(vehicle_of("ardupilot")), list[str](), io.BytesIO()
    stops = iter([StopRequest("enough")])
    vehicle._mouth = mavlink.MAVLink(None, srcSystem=9, srcComponent=1)

    def stop() -> StopRequest | None:
        vehicle.says = [PX4] if vehicle.vehicle.autopilot.armed else []
        return next(stops, None) if warnings else None

    options = replace(FlightOptions(), land_when_stopped=True)
    result = fly(
        plan,
        vehicle,
        vehicle,
        FlightRecord(sink, mission="two"),
        options=options,
        stop_request=stop,
        on_warning=warnings.append,
    )
    assert result.reason == "enough"
    assert warnings == ["vehicles of other system ids are heard now: 9; the flight stays with 1"]
    (event,) = (each for each in parse_record(sink.getvalue()).events if each.text == "other vehicles are heard")
    assert event.values["system_ids"] == [9]
