"""What a ground station on another link of the vehicle sees of a flight: words, figures, heartbeats, and no more."""

import io
from dataclasses import dataclass

import pytest
from pymavlink.dialects.v20 import ardupilotmega as mavlink

from mission.errors import VehicleError
from mission.fly import FlightOptions, FlightResult, fly
from mission.link.announcer import COMPONENT, Announcer, Severity
from mission.link.texts import TextAssembler
from mission.link.values import Words
from mission.plan import FlightPlan
from mission.report.record import FlightRecord
from tests.support.lockstep import LockstepVehicle, vehicle_of
from tests.support.small_missions import ROUNDS, SMALL, plan_of
from tests.support.station import Station
from tests.support.usual_cases import PX4
from vehicle_sim.protocol.dialect import Message

FIGURES = {"ltl_pct", "ltl_left_s", "ltl_state", "ltl_done", "ltl_so_far"}


@dataclass
class Seen:
    """What the planner's component was heard to say, with the vehicle's time of each."""

    result: FlightResult | VehicleError
    said: list[tuple[float, Message]]
    seconds: float

    def texts(self) -> list[tuple[int, str]]:
        assembler = TextAssembler()
        texts = []
        for t_s, message in self.said:
            if message.get_type() == "STATUSTEXT":
                words = Words(message.severity, message.text, message.id, message.chunk_seq)
                texts += assembler.take(words, t_s)
        return [(text.severity, text.text) for text in texts]

    def figures(self, name: str) -> list[tuple[float, float]]:
        return [
            (message.time_boot_ms / 1000.0, message.value)
            for _, message in self.said
            if message.get_type() == "NAMED_VALUE_FLOAT" and message.name == name
        ]


def watched(plan: FlightPlan, flavour: str) -> Seen:
    said: list[tuple[float, Message]] = []

    def listen(lockstep: LockstepVehicle) -> None:
        station.collect()
        said.extend((lockstep.vehicle.time_s, message) for message in station.heard if message.get_srcComponent() != 1)
        station.forget()

    vehicle = LockstepVehicle(vehicle_of(flavour), at_step=listen)
    station = Station(vehicle.endpoint, "ground station")
    result: FlightResult | VehicleError
    try:
        result = fly(plan, vehicle, vehicle, FlightRecord(io.BytesIO(), mission="m"), options=FlightOptions(fence=True))
    except VehicleError as error:
        result = error
    vehicle.endpoint.advance()
    listen(vehicle)
    ours = [(t_s, message) for t_s, message in said if message.get_srcSystem() == 1]
    assert {message.get_srcComponent() for _, message in ours} == {COMPONENT}
    return Seen(result, ours, vehicle.vehicle.time_s)


@PX4
def test_another_station_sees_progress_state_and_verdict(flavour: str) -> None:
    plan = plan_of(SMALL)
    seen = watched(plan, flavour)
    assert isinstance(seen.result, FlightResult)
    assert seen.result.achieved
    texts = [text for _, text in seen.texts()]
    said = ["taking off", "0 of 2 done, next goal", "1 of 2 done, next home", "2 of 2 done", "landing"]
    assert texts[:-1] == [f"Small round: {words}" for words in said]
    assert seen.texts()[-1] == (Severity.NOTICE, f"Small round: ACHIEVED, {seen.result.reason}")
    done = [value for _, value in seen.figures("ltl_pct")]
    assert done == sorted(done)
    assert (done[0], done[-1]) == (0.0, 100.0)
    assert [value for _, value in seen.figures("ltl_so_far")][-1] == 0.0  # what follows may always undo it
    states = [value for _, value in seen.figures("ltl_state")]
    assert states[0] == -1.0
    assert set(states) - {-1.0} <= set(range(plan.deterministic.size))
    left = dict(seen.figures("ltl_left_s"))
    assert max(left.values()) == pytest.approx(plan.trajectory.duration_s, abs=0.01)
    kinds = {message.get_type() for _, message in seen.said}
    assert kinds == {"HEARTBEAT", "NAMED_VALUE_FLOAT", "STATUSTEXT"}
    beats = [message for _, message in seen.said if message.get_type() == "HEARTBEAT"]
    assert {beat.type for beat in beats} == {mavlink.MAV_TYPE_ONBOARD_CONTROLLER}
    assert abs(len(beats) - seen.seconds) < 8
    # In no ten seconds more than a twentieth of what a radio at 57,600 baud carries.
    sizes = [(t_s, len(message.get_msgbuf())) for t_s, message in seen.said]
    for t_s, _ in sizes[:: len(FIGURES)]:
        assert sum(size for at_s, size in sizes if t_s <= at_s < t_s + 10.0) < 0.05 * 5760.0 * 10.0


def test_laps_are_told() -> None:
    texts = [text for _, text in watched(plan_of(ROUNDS), "ardupilot").texts()]
    assert "Small rounds: lap 1 of 2 done" in texts
    assert texts[-1].startswith("Small rounds: ACHIEVED, 2 of 2 laps")


def test_of_too_many_texts_the_oldest_are_left_out_and_long_ones_come_in_pieces() -> None:
    announcer = Announcer(1, None)
    for number in range(20):
        announcer.say(f"{number}")
    announcer.say("x" * 100)
    announcer.say("y" * 500, Severity.WARNING)
    assert announcer.is_due(0.0)
    reader = mavlink.MAVLink(None)
    frames = announcer.frames(0.0, {"a": 1.5})
    assert not announcer.is_due(0.99)
    assert announcer.is_due(1.0)
    frames += announcer.last_frames(1.0, {})
    messages = [reader.decode(bytearray(frame)) for frame in frames]
    assembler = TextAssembler()
    texts = []
    for message in messages:
        if message.get_type() == "STATUSTEXT":
            texts += assembler.take(Words(message.severity, message.text, message.id, message.chunk_seq), 0.0)
    assert [text.text for text in texts] == [*map(str, range(14, 20)), "x" * 100, "y" * 197 + "..."]
    (figure,) = [message for message in messages if message.get_type() == "NAMED_VALUE_FLOAT"]
    assert (figure.name, figure.value, figure.time_boot_ms) == ("a", 1.5, 0)
