"""A restart on request: the flight controller begins anew where the vehicle stands, with its parameters."""

import pytest
from pymavlink.dialects.v20 import ardupilotmega as mavlink

from tests.support.bare_vehicle import run
from tests.support.station import Station, endpoint_of
from vehicle_sim.autopilot import Mode, Outcome, Progress
from vehicle_sim.autopilot.geofence import FencePlan
from vehicle_sim.autopilot.hand import CENTRED
from vehicle_sim.autopilot.modes import FIRST_MODE
from vehicle_sim.faults import Schedule
from vehicle_sim.faults.conditions import SensorState
from vehicle_sim.faults.schedule import ScheduledFault, Since
from vehicle_sim.parameters import Flavour
from vehicle_sim.protocol.endpoint import Endpoint
from vehicle_sim.protocol.flavour import Rates
from vehicle_sim.protocol.signing import Signer
from vehicle_sim.signals import Geodetic
from vehicle_sim.vehicle import Vehicle, VehicleConfig

ACCEPTED = mavlink.MAV_RESULT_ACCEPTED
REBOOT = mavlink.MAV_CMD_PREFLIGHT_REBOOT_SHUTDOWN
ATTITUDE = mavlink.MAVLINK_MSG_ID_ATTITUDE
BOTH = pytest.mark.parametrize("flavour", Flavour)


def reboot(station: Station) -> None:
    assert station.command(REBOOT, 1) == ACCEPTED
    before_us = station.endpoint.now_us
    station.wait_until(lambda: station.endpoint.now_us < before_us, within_s=1.0)


@BOTH
def test_a_restart_begins_at_time_zero_without_position_and_converges_again(flavour: Flavour) -> None:
    station = Station(endpoint_of(flavour))
    station.wait_for_position()
    station.command(mavlink.MAV_CMD_SET_MESSAGE_INTERVAL, ATTITUDE, 100_000)
    station.run(1.0)
    assert station.endpoint.vehicle.estimate.status.position_ok
    reboot(station)
    vehicle = station.endpoint.vehicle
    assert vehicle.time_boot_ms <= 10
    assert (vehicle.estimate.origin, vehicle.autopilot.home) == (None, None)
    assert vehicle.autopilot.mode is FIRST_MODE[flavour]
    station.forget()
    station.run(1.0)
    assert not station.of("ATTITUDE")  # intervals are forgotten with everything else
    assert len(station.of("HEARTBEAT")) == 1
    station.request(ATTITUDE)
    assert station.last("ATTITUDE").time_boot_ms == vehicle.time_boot_ms < 1100
    station.wait_for_position()
    station.run(0.1)
    assert len(station.of("GPS_GLOBAL_ORIGIN")) == len(station.of("HOME_POSITION")) == 1
    assert station.command(mavlink.MAV_CMD_COMPONENT_ARM_DISARM, 1) == ACCEPTED


@pytest.mark.parametrize(
    ("flavour", "result"),
    [(Flavour.ARDUPILOT, mavlink.MAV_RESULT_FAILED), (Flavour.PX4, mavlink.MAV_RESULT_DENIED)],
)
def test_an_armed_vehicle_never_restarts(flavour: Flavour, result: int) -> None:
    station = Station(endpoint_of(flavour))
    station.take_off()
    before_us = station.endpoint.now_us
    assert station.command(REBOOT, 1) == result
    station.run(1.0)
    assert station.endpoint.now_us == before_us + 1_000_000


@BOTH
def test_only_a_restart_can_be_asked_for(flavour: Flavour) -> None:
    station = Station(endpoint_of(flavour))
    refused = mavlink.MAV_RESULT_DENIED if flavour is Flavour.PX4 else mavlink.MAV_RESULT_UNSUPPORTED
    for action in (2, 4, float("nan"), -1):
        assert station.command(REBOOT, action) == refused
    assert station.command(REBOOT, 0) == (ACCEPTED if flavour is Flavour.PX4 else refused)
    station.run(1.0)
    assert station.endpoint.now_us == 1_000_000


@BOTH
def test_parameters_and_plans_outlast_it_and_so_does_where_the_vehicle_stands(flavour: Flavour) -> None:
    station = Station(endpoint_of(flavour))
    station.take_off()
    vehicle = station.endpoint.vehicle
    name, value = ("MPC_XY_CRUISE", 4.0) if flavour is Flavour.PX4 else ("WPNAV_SPEED", 450.0)
    vehicle.parameters.set(name, value)
    station.send(mavlink.MAVLink_manual_control_message(1, 1000, 0, 500, 0, 0))
    station.set_mode(Mode.POSITION)
    station.run(0.5)
    station.set_mode(Mode.LAND)
    station.wait_until(lambda: not vehicle.autopilot.armed, within_s=60.0)
    place, drawn = vehicle.truth.position_ned_m, vehicle.battery.consumed_mah
    assert abs(place[0]) > 0.3
    reboot(station)
    assert vehicle.parameters[name] == pytest.approx(value)
    assert vehicle.truth.position_ned_m == pytest.approx(place, abs=0.01)
    assert vehicle.battery.consumed_mah >= drawn
    station.wait_for_position()
    # The new origin is where it stands now, not where it stood first.
    assert vehicle.estimate.position_ned_m[0] == pytest.approx(0.0, abs=2.0)
    assert vehicle.config.home != vehicle.estimate.origin


@BOTH
def test_default_streams_and_a_new_system_id_begin_with_it(flavour: Flavour) -> None:
    station = Station(endpoint_of(flavour), rates=Rates.GROUND_STATION)
    name = station.endpoint.table.system_id_parameter
    station.endpoint.vehicle.parameters.set(name, 9)
    station.run(0.5)
    assert {message.get_srcSystem() for message in station.heard} == {1}
    reboot(station)
    station.forget()
    station.run(2.0)
    assert {message.get_srcSystem() for message in station.heard} == {9}
    assert station.command(mavlink.MAV_CMD_RUN_PREARM_CHECKS) == -1
    assert station.command(mavlink.MAV_CMD_RUN_PREARM_CHECKS, target=9) != -1
    assert len(station.of("ATTITUDE")) == pytest.approx(30 if flavour is Flavour.PX4 else 0, abs=1)


@BOTH
def test_a_second_request_does_not_put_it_off(flavour: Flavour) -> None:
    station = Station(endpoint_of(flavour))
    station.run(1.0)
    assert station.command(REBOOT, 1) == ACCEPTED
    station.run(0.15)
    assert station.command(REBOOT, 1) == ACCEPTED
    station.run(0.3)
    assert station.endpoint.now_us < 1_000_000


@BOTH
def test_restarts_are_the_same_from_the_same_seed(flavour: Flavour) -> None:
    def bytes_of_a_run() -> bytes:
        endpoint = endpoint_of(flavour)
        station = Station(endpoint, rates=Rates.ONBOARD)
        station.run(1.0)
        endpoint.receive(
            station.name, station.packed(mavlink.MAVLink_command_long_message(1, 1, REBOOT, 0, *[1.0] * 7))
        )
        data = b""
        for _ in range(200):
            endpoint.advance()
            data += b"".join(endpoint.outgoing(station.name))
        return data

    assert bytes_of_a_run() == bytes_of_a_run()


@BOTH
def test_a_reset_of_all_parameters_waits_for_the_restart_on_ardupilot_alone(flavour: Flavour) -> None:
    station = Station(endpoint_of(flavour))
    store = station.endpoint.vehicle.parameters
    name, value = ("MPC_XY_CRUISE", 4.0) if flavour is Flavour.PX4 else ("WPNAV_SPEED", 450.0)
    store.set(name, value)
    default = store.definition(name).default
    for nothing in (0, 1):
        done = station.command(mavlink.MAV_CMD_PREFLIGHT_STORAGE, nothing)
        assert done == (ACCEPTED if flavour is Flavour.PX4 else mavlink.MAV_RESULT_UNSUPPORTED)
    assert store[name] == value
    assert station.command(mavlink.MAV_CMD_PREFLIGHT_STORAGE, 2) == ACCEPTED
    assert store[name] == (default if flavour is Flavour.PX4 else value)
    station.run(1.0)
    reboot(station)
    assert store[name] == default
    store.set(name, value)
    station.run(1.0)
    reboot(station)
    assert store[name] == value


@BOTH
def test_parameters_are_not_reset_while_armed(flavour: Flavour) -> None:
    station = Station(endpoint_of(flavour))
    station.wait_for_position()
    assert station.command(mavlink.MAV_CMD_COMPONENT_ARM_DISARM, 1) == ACCEPTED
    refused = mavlink.MAV_RESULT_TEMPORARILY_REJECTED if flavour is Flavour.PX4 else mavlink.MAV_RESULT_FAILED
    assert station.command(mavlink.MAV_CMD_PREFLIGHT_STORAGE, 2) == refused


@BOTH
def test_component_and_key_outlast_it(flavour: Flavour) -> None:
    key = bytes(range(32))
    vehicle = Vehicle(VehicleConfig(flavour=flavour))
    endpoint = Endpoint(vehicle, flavour, component_id=7, signer=Signer(key))
    station = Station(endpoint)
    station.mav.signing.secret_key, station.mav.signing.sign_outgoing = key, True
    station.mav.signing.timestamp = 1
    station.run(1.0)
    assert station.command(REBOOT, 1, component=7) == ACCEPTED
    signed_before = endpoint.signer.timestamp
    station.wait_until(lambda: 0 < endpoint.now_us < 100_000, within_s=1.0)
    station.forget()
    assert station.command(mavlink.MAV_CMD_RUN_PREARM_CHECKS, component=7) != -1
    # What claims to come from the vehicle itself is an echo, and nothing else is.
    for component, answered in ((7, False), (1, True)):
        other = Station(endpoint, str(component), system_id=1, component_id=component)
        other.mav.signing.secret_key, other.mav.signing.sign_outgoing = key, True
        other.mav.signing.timestamp, other.mav.signing.link_id = 1, component
        assert (other.command(mavlink.MAV_CMD_RUN_PREARM_CHECKS, component=7) != -1) is answered
    assert {message.get_srcComponent() for message in station.heard} == {7}
    assert endpoint.signer.key == key
    assert endpoint.signer.timestamp > signed_before
    station.mav.signing.sign_outgoing = False
    assert station.command(mavlink.MAV_CMD_RUN_PREARM_CHECKS, component=7) == -1


def upload(station: Station, kind: int, items: list[tuple[int, float, int, float]]) -> None:
    """Upload items of command, first parameter, distance to the north (1e-7 degrees) and height."""
    station.send(mavlink.MAVLink_mission_count_message(1, 1, len(items), kind))
    for seq, (command, first, north, up) in enumerate(items):
        place = (473_977_420 + north, 85_455_940, up)
        station.send(
            mavlink.MAVLink_mission_item_int_message(1, 1, seq, 6, command, 0, 1, first, 0, 0, 0, *place, kind)
        )
    assert station.last("MISSION_ACK").type == mavlink.MAV_MISSION_ACCEPTED


def downloaded(station: Station, kind: int) -> list[dict[str, object]]:
    station.forget()
    station.send(mavlink.MAVLink_mission_request_list_message(1, 1, kind))
    for seq in range(station.last("MISSION_COUNT").count):
        station.send(mavlink.MAVLink_mission_request_int_message(1, 1, seq, kind))
    return [message.to_dict() | {"current": 0} for message in station.of("MISSION_ITEM_INT")]


@BOTH
def test_plans_outlast_it_in_the_store_and_in_the_autopilot_and_begin_anew(flavour: Flavour) -> None:
    station = Station(endpoint_of(flavour))
    station.wait_for_position()
    # Item 0 of ArduPilot's mission is home, which is where it stands now.
    first = 1 if flavour is Flavour.ARDUPILOT else 0
    waypoints = [(22, 0.0, 0, 10.0), (16, 0.0, 2000, 10.0), (16, 0.0, 3000, 10.0), (16, 0.0, 4000, 10.0)]
    upload(station, mavlink.MAV_MISSION_TYPE_MISSION, [*waypoints[:first], *waypoints])
    circle = mavlink.MAV_CMD_NAV_FENCE_CIRCLE_INCLUSION
    upload(station, mavlink.MAV_MISSION_TYPE_FENCE, [(circle, 90.0, 0, 0.0)])
    upload(station, mavlink.MAV_MISSION_TYPE_RALLY, [(mavlink.MAV_CMD_NAV_RALLY_POINT, 0.0, 3000, 20.0)])
    before = station.endpoint.vehicle.autopilot
    before.set_home(Geodetic(47.398, 8.5456, 490.0))
    assert before.mission.set_current(3)
    plans = [downloaded(station, kind) for kind in range(3)]
    reboot(station)
    autopilot = station.endpoint.vehicle.autopilot
    assert autopilot is not before
    assert autopilot.mission.items == before.mission.items != ()
    assert autopilot.guard.fence.plan == before.guard.fence.plan != FencePlan()
    assert autopilot.rally == before.rally != ()
    assert (autopilot.mission.current, autopilot.mission.progress) == (0, Progress.NOT_STARTED)
    assert autopilot.home is None
    station.wait_for_position()
    again = [downloaded(station, kind) for kind in range(3)]
    assert again[0][first:] == plans[0][first:]
    assert again[1:] == plans[1:]
    assert autopilot.set_mode(Mode.AUTO) is Outcome.ACCEPTED
    if flavour is Flavour.PX4:
        assert autopilot.start_mission() is Outcome.ACCEPTED
    else:
        autopilot.set_mode(Mode.GUIDED)
        assert autopilot.arm() is Outcome.ACCEPTED
        assert autopilot.start_mission() is Outcome.ACCEPTED
    station.wait_until(lambda: station.height_m() > 8.0, within_s=30.0)


@BOTH
def test_an_upload_and_the_pilots_sticks_do_not_outlast_it(flavour: Flavour) -> None:
    station = Station(endpoint_of(flavour))
    station.run(1.0)
    station.send(mavlink.MAVLink_manual_control_message(1, 1000, 0, 500, 0, 0))
    station.send(mavlink.MAVLink_mission_count_message(1, 1, 3, 0))
    reboot(station)
    station.forget()
    station.run(10.0)
    assert not station.of("MISSION_REQUEST") + station.of("MISSION_REQUEST_INT") + station.of("MISSION_ACK")
    vehicle = station.endpoint.vehicle
    assert vehicle.autopilot.pilot.standing(vehicle.time_s) == CENTRED


@BOTH
def test_a_receiver_that_is_lost_stays_lost_and_times_of_faults_count_anew(flavour: Flavour) -> None:
    station = Station(endpoint_of(flavour))
    station.run(1.0)
    station.endpoint.vehicle.parameters.set("SIM_GPS1_ENABLE", 0)
    station.run(1.0)
    reboot(station)
    station.run(20.0)
    assert not station.endpoint.vehicle.estimate.status.position_ok

    late = ScheduledFault(kind="gps_loss", values={}, at_s=5.0, since=Since.BOOT)
    vehicle = Vehicle(VehicleConfig(flavour=flavour, faults=Schedule((late,))))
    run(vehicle, 6.0)
    seen = [vehicle.faults.conditions.gps]
    vehicle.reboot()
    for seconds in (1.0, 5.0):
        run(vehicle, seconds)
        seen.append(vehicle.faults.conditions.gps)
    assert [gps is SensorState.SILENT for gps in seen] == [True, False, True]
