"""PX4's events: beside texts, the report of arming checks, the count, and events that are asked for again."""

import pytest
from pymavlink.dialects.v20 import ardupilotmega as mavlink

from tests.support.station import Station, endpoint_of
from vehicle_sim.autopilot import ArmingReason, Mode
from vehicle_sim.autopilot.modes import MODES
from vehicle_sim.autopilot.texts import mode_refused
from vehicle_sim.parameters import Flavour
from vehicle_sim.protocol.dialect import Message
from vehicle_sim.protocol.event_list import event_list
from vehicle_sim.protocol.events import _CHECKS, FIRST_SEQUENCE, KEPT
from vehicle_sim.protocol.late_messages import RequestEvent

HEARTBEAT = mavlink.MAVLink_heartbeat_message(mavlink.MAV_TYPE_GCS, mavlink.MAV_AUTOPILOT_INVALID, 0, 0, 4, 3)
SUMMARY, HEALTH = "commander_arming_check_summary", "commander_health_summary"


def px4() -> Station:
    return Station(endpoint_of(Flavour.PX4))


def named(event: Message) -> str:
    names = {known.number: name for name, known in event_list().events.items()}
    return names[int(event.id)]


def arguments(event: Message) -> tuple[float, ...]:
    event_bytes = bytes(event.arguments)
    packing = event_list().events[named(event)].packing
    return packing.unpack(event_bytes[: packing.size])


def report(station: Station) -> dict[str, tuple[float, ...]]:
    """Return the events of the last report, by name."""
    events = station.of("EVENT")
    starts = [place for place, event in enumerate(events) if named(event) == SUMMARY]
    assert starts, "no report"
    return {named(event): arguments(event) for event in events[starts[-1] :]}


def fnv1a(name: str) -> int:
    value = 0x811C9DC5
    for byte in name.encode():
        value = (value ^ byte) * 0x01000193 & 0xFFFFFFFF
    return value & 0xFFFFFF


def test_numbers_of_events_are_made_of_their_names() -> None:
    for name, event in event_list().events.items():
        assert event.number == 1 << 24 | fnv1a(name)


def test_every_reason_has_an_event_and_a_component() -> None:
    radio = {ArmingReason.NO_RADIO, ArmingReason.RADIO_LOST, ArmingReason.THROTTLE_HIGH}  # ArduPilot's
    assert set(_CHECKS) == set(ArmingReason) - radio
    for check in _CHECKS.values():
        assert check.event in event_list().events
        assert check.component in event_list().component_bits


def test_the_report_tells_what_is_wrong_until_nothing_is() -> None:
    station = px4()
    station.run(0.1)
    bits = event_list().mode_bits
    first = report(station)
    numbers = station.endpoint.table.custom_modes
    _chunk, errors, _warnings, can_arm, can_run = (int(value) for value in first[SUMMARY])
    assert errors & event_list().component_bits["attitude_estimate"]
    assert not can_arm & bits[numbers[Mode.HOLD]]
    assert not can_run & bits[numbers[Mode.HOLD]]
    assert "check_modes_attitude" in first
    modes, component = first["check_modes_global_pos"]
    assert int(modes) & bits[numbers[Mode.POSITION]]
    assert not int(modes) & bits[numbers[Mode.STABILIZE]]
    assert 1 << int(component) == event_list().component_bits["global_position_estimate"]
    assert HEALTH in first

    station.wait_for_position()
    station.run(2.5)
    last = report(station)
    assert int(last[SUMMARY][3]) & bits[numbers[Mode.HOLD]]
    assert not int(last[SUMMARY][3]) & bits[numbers[Mode.GUIDED]]  # nobody sends setpoints
    missing = {"check_modes_offboard_signal", "check_modes_mission", "check_modes_manual_control"}
    assert set(last) == {SUMMARY, HEALTH, *missing}
    assert not int(last["check_modes_manual_control"][0])  # a warning, although such modes cannot be entered
    assert not int(last[SUMMARY][3]) & bits[numbers[Mode.POSITION]]
    station.forget()
    station.run(5.0)
    assert not station.of("EVENT")  # nothing has changed


def test_who_comes_or_asks_gets_the_report() -> None:
    station = px4()
    station.wait_for_position()
    station.run(2.5)
    station.forget()
    station.send(HEARTBEAT)
    station.run(2.1)
    assert HEALTH in report(station)
    station.forget()
    assert station.command(mavlink.MAV_CMD_RUN_PREARM_CHECKS) == mavlink.MAV_RESULT_ACCEPTED
    assert HEALTH in report(station)


def test_texts_are_events_too_and_end_in_a_tab() -> None:
    station = px4()
    station.take_off(3.0)
    said = {text for text in station.texts() if text.endswith("\t")}
    assert {"Armed by external command\t", "Takeoff detected\t"} <= said
    events = {named(event): arguments(event) for event in station.of("EVENT")}
    assert list(events["commander_armed_by"]) == [4]
    assert not events["commander_takeoff_detected"]


def test_a_take_off_without_a_height_names_the_one_that_it_uses() -> None:
    station = px4()
    station.wait_for_position()
    station.command(mavlink.MAV_CMD_COMPONENT_ARM_DISARM, 1)
    assert station.command(mavlink.MAV_CMD_NAV_TAKEOFF, *(float("nan"),) * 7) == mavlink.MAV_RESULT_ACCEPTED
    station.run(0.1)
    assert "Using default takeoff altitude: 2.5 m\t" in station.texts()
    named_events = {named(event): arguments(event) for event in station.of("EVENT")}
    assert list(named_events["navigator_takeoff_default_alt"]) == [2.5]


@pytest.mark.parametrize("mode", MODES[Flavour.PX4])
def test_a_refusal_of_each_mode_is_an_event(mode: Mode) -> None:
    text = mode_refused(Flavour.PX4, MODES[Flavour.PX4][mode].name, "").text
    found = event_list().find(text)
    assert found is not None
    assert found[0] == "commander_modeswitch_not_avail"


def test_arguments_are_read_from_the_text() -> None:
    assert event_list().find("RTL: start return at 520 m (30 m above destination)") == ("vrtl_return_at", [520, 30])
    assert event_list().find("Using default takeoff altitude: 2.5 m") == ("navigator_takeoff_default_alt", [2.5])
    assert event_list().find("Something else") is None


def test_the_count_is_told_and_events_are_sent_again() -> None:
    station = px4()
    station.wait_for_position()
    station.run(3.1)
    counts = station.of("CURRENT_EVENT_SEQUENCE")
    assert counts[0].flags == 1  # whoever counted before begins anew
    assert (counts[0].sequence, counts[-1].flags) == (FIRST_SEQUENCE, 0)
    events = station.of("EVENT")
    assert [event.sequence for event in events] == [(FIRST_SEQUENCE + 1 + n) % 65536 for n in range(len(events))]
    assert counts[-1].sequence == events[-1].sequence

    last = events[-1].sequence
    station.forget()
    station.send(RequestEvent((last - 1) % 65536, last, 1, 1))
    assert [(event.sequence, event.arguments) for event in station.of("EVENT")] == [
        (event.sequence, event.arguments) for event in events[-2:]
    ]
    station.send(RequestEvent((last + 5) % 65536, (last + 5) % 65536, 1, 1))
    error = station.last("RESPONSE_EVENT_ERROR")
    assert (error.sequence, error.target_system, error.target_component) == ((last + 5) % 65536, 255, 190)
    kept = events[-KEPT:]
    assert error.sequence_oldest_available == kept[0].sequence


def test_a_request_for_all_there_ever_were_gets_few_answers() -> None:
    station = px4()
    station.run(1.0)
    station.forget()
    last = px4_last(station)
    station.forget()
    station.send(RequestEvent((last + 1) % 65536, last, 1, 1))
    assert len(station.of("RESPONSE_EVENT_ERROR")) + len(station.of("EVENT")) <= KEPT + 1


def px4_last(station: Station) -> int:
    station.run(3.0)
    return int(station.last("CURRENT_EVENT_SEQUENCE").sequence)


def test_a_restart_begins_to_count_anew() -> None:
    station = px4()
    station.run(1.0)
    assert station.command(mavlink.MAV_CMD_PREFLIGHT_REBOOT_SHUTDOWN, 1) == mavlink.MAV_RESULT_ACCEPTED
    station.run(0.4)
    station.forget()
    station.run(0.2)
    assert station.of("CURRENT_EVENT_SEQUENCE")[0].flags == 1
    assert station.of("EVENT")[0].sequence == (FIRST_SEQUENCE + 1) % 65536


def test_ardupilot_has_no_events() -> None:
    station = Station(endpoint_of(Flavour.ARDUPILOT))
    station.wait_for_position()
    station.run(3.1)
    assert not station.of("EVENT")
    assert not station.of("CURRENT_EVENT_SEQUENCE")
    assert not [text for text in station.texts() if text.endswith("\t")]
