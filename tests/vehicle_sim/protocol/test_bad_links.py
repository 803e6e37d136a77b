"""Links that lose, delay, reorder, repeat and break packets: what gets through means what was sent."""

import pytest
from pymavlink.dialects.v20 import ardupilotmega as mavlink

from tests.support.faults import schedule_of
from tests.support.station import Station
from vehicle_sim.autopilot import Mode
from vehicle_sim.parameters import Flavour
from vehicle_sim.protocol.bad_links import BadLinksEndpoint
from vehicle_sim.protocol.dialect import Message
from vehicle_sim.protocol.flavour import Rates
from vehicle_sim.vehicle import Vehicle, VehicleConfig

ARM = mavlink.MAV_CMD_COMPONENT_ARM_DISARM


def station_of(*faults: str, flavour: Flavour = Flavour.ARDUPILOT, seed: int = 1, **station: Rates) -> Station:
    vehicle = Vehicle(VehicleConfig(flavour=flavour, seed=seed, faults=schedule_of(*faults)))
    return Station(BadLinksEndpoint(vehicle, flavour), **station)  # type: ignore[arg-type]


def mode_command(station: Station, mode: Mode) -> bytes:
    number = station.endpoint.table.custom_modes[mode]
    return station.packed(mavlink.MAVLink_command_long_message(1, 1, 176, 0, 1, number, 0, 0, 0, 0, 0))


def test_a_link_without_faults_is_a_link() -> None:
    station = station_of("link, at_s: 50, drop: 1")
    assert station.set_mode(Mode.GUIDED) == mavlink.MAV_RESULT_ACCEPTED


@pytest.mark.parametrize(("spared", "arrives", "answered"), [("up: 0", True, False), ("down: 0", False, False)])
def test_each_direction_fails_on_its_own(spared: str, *, arrives: bool, answered: bool) -> None:
    station = station_of(f"link, drop: 1, {spared}")
    assert (station.set_mode(Mode.GUIDED) != -1) is answered
    assert (station.endpoint.vehicle.autopilot.mode is Mode.GUIDED) is arrives


def test_delay_is_vehicle_time_and_goes_both_ways() -> None:
    station = station_of("link, delay_s: 0.5")
    sent_s = station.endpoint.vehicle.time_s
    assert station.set_mode(Mode.GUIDED) == -1
    station.wait_until(lambda: station.endpoint.vehicle.autopilot.mode is Mode.GUIDED, within_s=1.0)
    assert station.endpoint.vehicle.time_s - sent_s == pytest.approx(0.5, abs=0.02)
    station.wait_until(lambda: bool(station.of("COMMAND_ACK")), within_s=1.0)
    assert station.endpoint.vehicle.time_s - sent_s == pytest.approx(1.0, abs=0.04)


def test_a_repeated_command_is_answered_twice_and_done_once() -> None:
    station = station_of("link, duplicate: 1, down: 0")
    station.wait_for_position()
    revision = station.endpoint.vehicle.autopilot.home_revision
    station.forget()
    assert station.command(ARM, 1) == mavlink.MAV_RESULT_ACCEPTED
    assert [ack.result for ack in station.of("COMMAND_ACK")] == [mavlink.MAV_RESULT_ACCEPTED] * 2
    assert station.endpoint.vehicle.autopilot.armed
    assert station.endpoint.vehicle.autopilot.home_revision <= revision + 2


def test_broken_packets_change_nothing() -> None:
    station = station_of("link, corrupt: 1, down: 0")
    parameters = station.endpoint.vehicle.parameters
    before = {name: parameters[name] for name in parameters}
    for value in range(200):
        station.send(
            mavlink.MAVLink_param_set_message(1, 1, b"WPNAV_SPEED", float(200 + value), mavlink.MAV_PARAM_TYPE_REAL32)
        )
        station.set_mode(Mode.GUIDED)
    station.run(1.0)
    assert {name: parameters[name] for name in parameters} == before
    assert station.endpoint.vehicle.autopilot.mode is Mode.STABILIZE


def test_reordered_telemetry_is_all_there() -> None:
    plain, shuffled = (
        station_of(*faults, flavour=Flavour.PX4, rates=Rates.ONBOARD) for faults in ((), ("link, reorder: 0.3, up: 0",))
    )
    for station in (plain, shuffled):
        station.run(20.0)
        station.run(0.2)
    times = [message.time_boot_ms for message in shuffled.of("ATTITUDE")]
    assert times != sorted(times)
    assert len(times) > 1000
    assert sorted(times)[:1000] == [message.time_boot_ms for message in plain.of("ATTITUDE")][:1000]


def test_an_upload_over_a_very_bad_link_is_the_plan_that_was_sent() -> None:
    station = station_of("link, drop: 0.2, duplicate: 0.3, corrupt: 0.1, reorder: 0.2, delay_s: 0.05, jitter_s: 0.1")
    items = [
        mavlink.MAVLink_mission_item_int_message(1, 1, seq, 3, 16, 0, 1, 0, 0, 0, 0, 473977000 + seq, 85456000, 20.0, 0)
        for seq in range(12)
    ]

    def acknowledged() -> bool:
        return any(ack.type == mavlink.MAV_MISSION_ACCEPTED for ack in station.of("MISSION_ACK"))

    answered = 0
    for _ in range(20):
        station.send(mavlink.MAVLink_mission_count_message(1, 1, len(items), 0))
        for _ in range(600):
            station.run(0.02)
            asked = [m for m in station.heard if m.get_type() in ("MISSION_REQUEST", "MISSION_REQUEST_INT")]
            for request in asked[answered:]:
                station.send(items[request.seq])
            answered = len(asked)
            if acknowledged():
                break
        if acknowledged():
            break
    assert acknowledged()
    # ArduPilot's first item is its home, whatever was sent.
    back = [(item.x, item.y) for item in downloaded(station, len(items))]
    assert back[1:] == [(item.x, item.y) for item in items[1:]]


def downloaded(station: Station, count: int) -> list[Message]:
    """The mission as it is read back by a link that is asked until it answers."""
    items: list[Message] = []
    while len(items) < count:
        if len(items) == 0:
            station.send(mavlink.MAVLink_mission_request_list_message(1, 1, 0))
            station.run(0.2)
        station.send(mavlink.MAVLink_mission_request_int_message(1, 1, len(items), 0))
        station.run(0.3)
        items += [item for item in station.of("MISSION_ITEM_INT") if item.seq == len(items)][-1:]
        assert station.endpoint.vehicle.time_s < 600.0
    return items


def test_equal_seeds_give_equal_bytes() -> None:
    def flight(seed: int) -> list[str]:
        station = station_of(
            "link, drop: 0.3, corrupt: 0.1, jitter_s: 0.1", seed=seed, flavour=Flavour.PX4, rates=Rates.ONBOARD
        )
        for _ in range(5):
            station.run(1.0)
            station.set_mode(Mode.GUIDED)
        return [str(message.to_dict()) for message in station.heard]

    assert flight(3) == flight(3)
    assert flight(3) != flight(4)


def test_a_peer_is_known_although_its_first_words_are_late() -> None:
    station = station_of("link, delay_s: 1")
    endpoint = station.endpoint
    endpoint.add_link("stranger", Rates.SILENT)
    assert endpoint.receive("stranger", mode_command(station, Mode.GUIDED)) == 1
    assert endpoint.receive("stranger", b"nonsense") == 0
    station.run(1.1)
    assert endpoint.vehicle.autopilot.mode is Mode.GUIDED
    endpoint.remove_link("stranger")
