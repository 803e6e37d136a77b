"""The camera on the wire, as each autopilot has it."""

from math import degrees, isnan

import pytest
from pymavlink.dialects.v20 import ardupilotmega as mavlink

from tests.support.missions import Pilot, Step, land, takeoff, waypoint
from tests.support.station import Station, endpoint_of
from vehicle_sim.autopilot import LandedState, Mode
from vehicle_sim.parameters import Flavour, default_parameters
from vehicle_sim.protocol.endpoint import Endpoint
from vehicle_sim.protocol.flavour import Rates
from vehicle_sim.vehicle import Vehicle, VehicleConfig

AP, PX4 = Flavour.ARDUPILOT, Flavour.PX4
ACCEPTED, DENIED = mavlink.MAV_RESULT_ACCEPTED, mavlink.MAV_RESULT_DENIED
FAILED, UNSUPPORTED = mavlink.MAV_RESULT_FAILED, mavlink.MAV_RESULT_UNSUPPORTED
REJECTED, SILENCE = mavlink.MAV_RESULT_TEMPORARILY_REJECTED, -1
DISTANCE, DIGICAM = mavlink.MAV_CMD_DO_SET_CAM_TRIGG_DIST, mavlink.MAV_CMD_DO_DIGICAM_CONTROL
START, STOP = mavlink.MAV_CMD_IMAGE_START_CAPTURE, mavlink.MAV_CMD_IMAGE_STOP_CAPTURE
CONTROL, INTERVAL = mavlink.MAV_CMD_DO_TRIGGER_CONTROL, mavlink.MAV_CMD_DO_SET_CAM_TRIGG_INTERVAL
MODE = mavlink.MAV_CMD_SET_CAMERA_MODE
MOUNT, PITCHYAW = mavlink.MAV_CMD_DO_MOUNT_CONTROL, mavlink.MAV_CMD_DO_GIMBAL_MANAGER_PITCHYAW
CONFIGURE = mavlink.MAV_CMD_DO_GIMBAL_MANAGER_CONFIGURE
NAN = float("nan")
BOTH = pytest.mark.parametrize("flavour", Flavour)


def pictures(station: Station) -> list[mavlink.MAVLink_message]:
    return station.of("CAMERA_FEEDBACK" if station.endpoint.table.flavour is AP else "CAMERA_IMAGE_CAPTURED")


def started(flavour: Flavour, rates: Rates = Rates.ONBOARD, **parameters: float) -> Station:
    store = default_parameters(flavour)
    for name, value in parameters.items():
        store.set(name, value)
    station = Station(Endpoint(Vehicle(VehicleConfig(flavour=flavour), store), flavour), rates=rates)
    station.run(0.1)
    return station


SINGLE = (0, 0, 0, 0, 1)


@pytest.mark.parametrize(
    ("command", "params", "ardupilot", "px4"),
    [
        (DISTANCE, (5.0,), ACCEPTED, ACCEPTED),
        (DISTANCE, (0.0,), ACCEPTED, ACCEPTED),
        (DISTANCE, (-1.0,), ACCEPTED, ACCEPTED),
        (DISTANCE, (NAN,), ACCEPTED, ACCEPTED),
        (DIGICAM, SINGLE, ACCEPTED, ACCEPTED),
        (START, (0, 0, 1), ACCEPTED, UNSUPPORTED),
        (START, (1, 0, 0), ACCEPTED, UNSUPPORTED),
        (START, (-1, 0, 1), UNSUPPORTED, UNSUPPORTED),
        (START, (0, 0, 3), FAILED, UNSUPPORTED),
        (START, (0, 0.5, 3), ACCEPTED, UNSUPPORTED),
        (START, (2, 0.5, 3), FAILED, UNSUPPORTED),
        (STOP, (0,), ACCEPTED, UNSUPPORTED),
        (STOP, (3,), UNSUPPORTED, UNSUPPORTED),
        (INTERVAL, (500.0,), UNSUPPORTED, ACCEPTED),
        (CONTROL, (1, 0, 0), UNSUPPORTED, ACCEPTED),
        (MODE, (0, 0), UNSUPPORTED, SILENCE),
        (mavlink.MAV_CMD_VIDEO_START_CAPTURE, (0,), FAILED, UNSUPPORTED),
        (MOUNT, (-90, 0, 0, 0, 0, 0, 2), ACCEPTED, ACCEPTED),
        (PITCHYAW, (-90, 0, NAN, NAN), ACCEPTED, DENIED),
        (PITCHYAW, (NAN, NAN, NAN, NAN), FAILED, DENIED),
        (PITCHYAW, (-90, 0, NAN, NAN, 0, 0, 3), FAILED, DENIED),
    ],
)
@BOTH
def test_each_command_is_answered_as_by_its_autopilot(
    flavour: Flavour, command: int, params: tuple[float, ...], ardupilot: int, px4: int
) -> None:
    assert started(flavour).command(command, *params) == (ardupilot if flavour is AP else px4)


@pytest.mark.parametrize(
    ("command", "params", "ardupilot"),
    [
        (DISTANCE, (5.0,), ACCEPTED),
        (DIGICAM, SINGLE, ACCEPTED),
        (START, (0, 0, 1), FAILED),
        (STOP, (0,), ACCEPTED),
        (STOP, (1,), UNSUPPORTED),
        (MOUNT, (-90,), FAILED),
        (PITCHYAW, (-90, 0, NAN, NAN), FAILED),
    ],
)
def test_without_a_camera_ardupilot_accepts_in_vain_and_px4_is_silent(
    command: int, params: tuple[float, ...], ardupilot: int
) -> None:
    bare = started(AP, CAM1_TYPE=0, MNT1_TYPE=0)
    assert bare.command(command, *params) == ardupilot
    expected = UNSUPPORTED if command in (START, STOP) else SILENCE
    assert started(PX4, TRIG_MODE=0, MNT_MODE_IN=-1).command(command, *params) == expected
    bare.run(0.1)
    assert not pictures(bare)


def test_px4s_mount_obeys_whoever_was_put_in_control() -> None:
    station = started(PX4)
    assert station.command(CONFIGURE, 255, 190, -1, -1) == ACCEPTED
    assert station.command(PITCHYAW, -90, 0, NAN, NAN) == ACCEPTED
    assert station.command(CONFIGURE, -3, -3) == ACCEPTED
    assert station.command(PITCHYAW, -90, 0, NAN, NAN) == DENIED
    assert station.command(CONFIGURE, -2, -2) == ACCEPTED
    assert station.command(PITCHYAW, -90, 0, NAN, NAN) == DENIED


@BOTH
def test_a_picture_is_told_with_time_place_and_attitude(flavour: Flavour) -> None:
    station = started(flavour)
    station.take_off()
    vehicle = station.endpoint.vehicle
    for command, params in ((DIGICAM, SINGLE), (DISTANCE, (50.0, 0, 1))):
        station.forget()
        assert station.command(command, *params) == ACCEPTED
        station.run(0.02)
        (picture,) = pictures(station)
        estimate, home = vehicle.estimate, vehicle.autopilot.home
        assert home is not None
        assert (picture.get_srcSystem(), picture.get_srcComponent()) == (1, 1)
        assert station.request(mavlink.MAVLINK_MSG_ID_GLOBAL_POSITION_INT) == ACCEPTED
        place = station.last("GLOBAL_POSITION_INT")
        if flavour is AP:
            assert (picture.lat, picture.lng) == pytest.approx((place.lat, place.lon), abs=3)
            assert picture.alt_msl == pytest.approx(place.alt / 1000.0, abs=0.05)
            assert picture.alt_rel == pytest.approx(place.relative_alt / 1000.0, abs=0.05)
            angles = (degrees(estimate.roll_rad), degrees(estimate.pitch_rad), degrees(estimate.yaw_rad))
            assert (picture.roll, picture.pitch, picture.yaw) == pytest.approx(angles, abs=0.2)
            assert (picture.cam_idx, picture.flags, picture.foc_len) == (0, mavlink.CAMERA_FEEDBACK_PHOTO, 0.0)
            assert station.request(mavlink.MAVLINK_MSG_ID_SYSTEM_TIME) == ACCEPTED
            assert station.last("SYSTEM_TIME").time_unix_usec - picture.time_usec <= 20_000
        else:
            assert (picture.lat, picture.lon) == pytest.approx((place.lat, place.lon), abs=3)
            assert picture.alt == pytest.approx(place.alt, abs=50)
            assert vehicle.time_boot_ms - picture.time_boot_ms <= 20
            assert (picture.camera_id, picture.capture_result, picture.relative_alt) == (1, 1, -1000)
            trigger = station.last("CAMERA_TRIGGER")
            assert (trigger.seq, trigger.time_usec // 1000) == (picture.image_index, picture.time_boot_ms)
    assert vehicle.camera is not None
    assert vehicle.camera.taken == 2


def test_px4_tells_pictures_on_the_links_that_stream_them() -> None:
    station = started(PX4, Rates.GROUND_STATION)
    quiet = Station(station.endpoint, "quiet", rates=Rates.SILENT)
    station.wait_for_position()
    station.command(DIGICAM, *SINGLE)
    station.run(0.02)
    quiet.collect()
    assert pictures(station)
    assert not station.of("CAMERA_TRIGGER")
    assert not pictures(quiet)
    wanted = mavlink.MAVLINK_MSG_ID_CAMERA_IMAGE_CAPTURED
    assert quiet.command(mavlink.MAV_CMD_SET_MESSAGE_INTERVAL, wanted, 1000) == ACCEPTED
    assert station.command(mavlink.MAV_CMD_SET_MESSAGE_INTERVAL, wanted, -1) == ACCEPTED
    station.forget()
    station.command(DIGICAM, *SINGLE)
    station.run(0.02)
    quiet.collect()
    assert not pictures(station)
    assert [picture.image_index for picture in pictures(quiet)] == [1]


def test_px4_refuses_a_picture_so_soon_after_the_last() -> None:
    station = started(PX4, TRIG_MIN_INTERVA=1000)
    assert station.command(DIGICAM, *SINGLE) == ACCEPTED
    station.run(0.5)
    assert station.command(DIGICAM, *SINGLE) == REJECTED
    station.run(0.6)
    assert station.command(DIGICAM, *SINGLE) == ACCEPTED


def test_what_there_is_to_know_of_the_camera_ardupilot_tells_on_request() -> None:
    station = started(AP)
    assert station.request(mavlink.MAVLINK_MSG_ID_CAMERA_INFORMATION) == ACCEPTED
    information = station.last("CAMERA_INFORMATION")
    assert information.flags == mavlink.CAMERA_CAP_FLAGS_CAPTURE_IMAGE
    assert isnan(information.focal_length)
    assert (information.resolution_h, information.gimbal_device_id) == (0, 1)
    assert station.request(mavlink.MAVLINK_MSG_ID_CAMERA_SETTINGS) == ACCEPTED
    assert station.last("CAMERA_SETTINGS").mode_id == mavlink.CAMERA_MODE_IMAGE
    station.command(START, 0, 0.5, 4)
    station.run(0.7)
    assert station.request(mavlink.MAVLINK_MSG_ID_CAMERA_CAPTURE_STATUS) == ACCEPTED
    status = station.last("CAMERA_CAPTURE_STATUS")
    assert (status.image_status, status.image_interval, status.image_count) == (2, 0.5, 2)
    assert station.request(mavlink.MAVLINK_MSG_ID_STORAGE_INFORMATION) == FAILED


def test_px4_leaves_that_to_cameras_with_a_link_of_their_own() -> None:
    station = started(PX4)
    for name in ("CAMERA_INFORMATION", "CAMERA_SETTINGS", "CAMERA_CAPTURE_STATUS", "STORAGE_INFORMATION"):
        assert station.request(getattr(mavlink, f"MAVLINK_MSG_ID_{name}")) == DENIED


@BOTH
def test_disarming_leaves_the_trigger_as_it_is_and_a_restart_forgets_it(flavour: Flavour) -> None:
    station = started(flavour)
    station.take_off()
    assert station.command(DISTANCE, 2.0, 0, 1) == ACCEPTED
    station.run(0.02)
    vehicle = station.endpoint.vehicle
    vehicle.autopilot.disarm(force=True)
    station.run(3.0)
    assert vehicle.camera is not None
    assert vehicle.camera.taken >= 1
    assert station.command(mavlink.MAV_CMD_PREFLIGHT_REBOOT_SHUTDOWN, 1) == ACCEPTED
    station.run(1.0)
    assert vehicle.camera.taken == 0
    station.forget()
    station.run(10.0)
    assert not pictures(station)


@BOTH
def test_pictures_are_in_the_log_of_the_flight(flavour: Flavour) -> None:
    station = started(flavour)
    station.take_off()
    station.command(DIGICAM, *SINGLE)
    station.run(0.1)
    reader = mavlink.MAVLink(None)
    reader.robust_parsing = True
    (log,) = station.endpoint.recorder.logs
    kinds = [message.get_type() for message in reader.parse_buffer(bytes(log.data)) or ()]
    expected = ["CAMERA_FEEDBACK"] if flavour is AP else ["CAMERA_TRIGGER", "CAMERA_IMAGE_CAPTURED"]
    assert [kind for kind in kinds if kind.startswith("CAMERA")] == expected


@BOTH
def test_a_mission_switches_the_trigger_on_and_off(flavour: Flavour) -> None:
    pilot = Pilot(flavour)
    pilot.fly(
        [
            takeoff(8.0),
            waypoint(10.0, 0.0, 8.0),
            Step(DISTANCE, (4.0, 0.0, 1.0, 0.0)),
            waypoint(34.0, 0.0, 8.0),
            Step(DISTANCE, (0.0, 0.0, 0.0, 0.0)),
            waypoint(34.0, 20.0, 8.0),
            Step(START, (0.0, 0.0, 1.0, 0.0)),
            land(34.0, 20.0),
        ]
    )
    places: list[tuple[float, float, float]] = []
    camera = pilot.station.endpoint.vehicle.camera
    assert camera is not None
    while pilot.autopilot.landed_state is not LandedState.LANDING:
        before = camera.taken
        pilot.station.endpoint.advance()
        pilot.station.collect()
        places += [pilot.place()] * (camera.taken - before)
    *row, single = places
    assert 6 <= len(row) <= 8
    assert all(8.0 < north < 37.0 and abs(east) < 2.0 for north, east, _ in row)
    assert single[:2] == pytest.approx((34.0, 20.0), abs=3.0)


def test_px4_pauses_the_trigger_with_its_mission_and_resumes_it_at_the_next_waypoint() -> None:
    pilot = Pilot(PX4)
    pilot.fly([takeoff(8.0), Step(DISTANCE, (3.0, 0.0, 0.0, 0.0)), waypoint(30, 0, 8.0), waypoint(60, 0), land(60, 0)])
    camera = pilot.station.endpoint.vehicle.camera
    assert camera is not None
    pilot.station.wait_until(lambda: camera.taken >= 3, within_s=60.0)
    assert pilot.station.set_mode(Mode.HOLD) == ACCEPTED
    pilot.station.run(4.0)
    held = camera.taken
    assert pilot.station.set_mode(Mode.AUTO) == ACCEPTED
    pilot.until_reached(2)
    assert camera.taken <= held + 1
    pilot.until_reached(3)
    assert camera.taken > held + 5


def test_ardupilot_goes_on_in_any_mode() -> None:
    pilot = Pilot(AP)
    pilot.fly([takeoff(8.0), Step(DISTANCE, (3.0, 0.0, 0.0, 0.0)), waypoint(40, 0, 8.0), land(40, 0)])
    camera = pilot.station.endpoint.vehicle.camera
    assert camera is not None
    pilot.station.wait_until(lambda: camera.taken >= 3, within_s=60.0)
    held = camera.taken
    assert pilot.station.set_mode(Mode.RETURN) == ACCEPTED
    pilot.station.run(12.0)
    assert camera.taken > held + 1


ITEMS = {
    AP: ("DO_DIGICAM_CONFIGURE", "SET_CAMERA_ZOOM", "SET_CAMERA_FOCUS", "VIDEO_START_CAPTURE", "DO_MOUNT_CONTROL"),
    PX4: (
        "DO_GIMBAL_MANAGER_CONFIGURE",
        "DO_CONTROL_VIDEO",
        "SET_CAMERA_MODE",
        "SET_CAMERA_ZOOM",
        "DO_TRIGGER_CONTROL",
    ),
}


@BOTH
def test_items_for_cameras_with_more_to_them_are_taken_too(flavour: Flavour) -> None:
    pilot = Pilot(flavour)
    others = [Step(getattr(mavlink, f"MAV_CMD_{name}")) for name in ITEMS[flavour]]
    assert pilot.upload([takeoff(), *others, land(0, 0)]) == mavlink.MAV_MISSION_ACCEPTED
    lacking = Step(
        mavlink.MAV_CMD_DO_GIMBAL_MANAGER_CONFIGURE if flavour is AP else mavlink.MAV_CMD_DO_DIGICAM_CONFIGURE
    )
    pilot.station.forget()
    pilot.upload([takeoff(), lacking, land(0, 0)])
    assert pilot.station.of("MISSION_ACK")[0].type == mavlink.MAV_MISSION_UNSUPPORTED


def test_an_item_that_carries_a_frame_of_places_is_understood_by_ardupilot() -> None:
    station = Station(endpoint_of(AP))
    station.wait_for_position()
    waypoint_there = (3, mavlink.MAV_CMD_NAV_WAYPOINT, 0, 1, 0, 0, 0, 0, 47.0, 8.0, 5.0, 0)
    shot = (3, DIGICAM, 0, 1, 0, 0, 0, 0, 1.0, 0.0, 0.0, 0)
    station.send(
        mavlink.MAVLink_mission_count_message(1, 1, 2, 0),
        mavlink.MAVLink_mission_item_message(1, 1, 0, *waypoint_there),
        mavlink.MAVLink_mission_item_message(1, 1, 1, *shot),
    )
    assert station.last("MISSION_ACK").type == mavlink.MAV_MISSION_ACCEPTED
    order = station.endpoint.vehicle.autopilot.mission.items[1].order
    assert order is not None
    assert order.shoots
