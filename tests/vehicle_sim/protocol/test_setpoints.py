"""Setpoints on the wire: what each flavour flies, stops for, ignores and complains about."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st
from pymavlink.dialects.v20 import ardupilotmega as mavlink

from tests.support.drawn_cases import tried
from tests.support.station import Station, endpoint_of
from vehicle_sim.autopilot import Mode
from vehicle_sim.geodesy import geodetic_at
from vehicle_sim.parameters import Flavour
from vehicle_sim.protocol.motion import type_mask
from vehicle_sim.signals import FREE, Setpoint

POSITION_ONLY = 0xDF8
VELOCITY_ONLY = 0xDC7
POSITION_VELOCITY = 0xDC0
ALL = 0xC00
LOCAL = mavlink.MAV_FRAME_LOCAL_NED
BODY = mavlink.MAV_FRAME_BODY_NED


class Recorder:
    """Stands where the autopilot takes its setpoints, and writes down what it is handed."""

    def __init__(self, station: Station) -> None:
        self.taken: list[Setpoint] = []
        self.halts = 0
        autopilot = station.endpoint.vehicle.autopilot
        autopilot.setpoint = self._take  # type: ignore[method-assign]
        autopilot.halt = self._halt  # type: ignore[method-assign]

    def _take(self, setpoint: Setpoint) -> bool:
        self.taken.append(setpoint)
        return True

    def _halt(self) -> None:
        self.halts += 1


def guided(flavour: Flavour = Flavour.ARDUPILOT) -> tuple[Station, Recorder]:
    station = Station(endpoint_of(flavour))
    station.wait_for_position()
    station.set_mode(Mode.GUIDED)
    return station, Recorder(station)


def test_the_four_masks_of_clients() -> None:
    station, recorder = guided()
    for mask in (POSITION_ONLY, VELOCITY_ONLY, POSITION_VELOCITY, ALL):
        station.setpoint((1, 2, -3), (4, 5, 6), (7, 8, 9), mask=mask)
    assert recorder.halts == 0
    assert recorder.taken == [
        Setpoint(position_ned_m=(1, 2, -3)),
        Setpoint(velocity_ned_m_s=(4, 5, 6)),
        Setpoint(position_ned_m=(1, 2, -3), velocity_ned_m_s=(4, 5, 6)),
        Setpoint(position_ned_m=(1, 2, -3), velocity_ned_m_s=(4, 5, 6), acceleration_ned_m_s2=(7, 8, 9)),
    ]
    assert [type_mask(setpoint) for setpoint in recorder.taken] == [
        POSITION_ONLY,
        VELOCITY_ONLY,
        POSITION_VELOCITY,
        ALL,
    ]


@tried(150)
@given(st.integers(0, 0xFFF))
def test_ardupilot_takes_whole_groups_or_stops(mask: int) -> None:
    station, recorder = _GUIDED
    recorder.taken.clear()
    recorder.halts = 0
    station.setpoint((1, 2, -3), (4, 5, 6), (7, 8, 9), mask=mask, yaw=0.5)
    groups = [mask >> shift & 7 for shift in (0, 3, 6)]
    has = tuple(group == 0 for group in groups)
    whole = all(group in (0, 7) for group in groups)
    combination = has in {(1, 0, 0), (0, 1, 0), (0, 1, 1), (0, 0, 1), (1, 1, 0), (1, 1, 1)}
    if whole and combination and not (has[2] and mask & 0x200):
        (taken,) = recorder.taken
        assert type_mask(taken) == mask & ~0x200
        assert recorder.halts == 0
    else:
        assert (recorder.taken, recorder.halts) == ([], 1)


_GUIDED = guided()


@pytest.mark.parametrize("frame", [0, 2, 4, 6, 12, 20])
def test_ardupilot_stops_for_frames_that_it_does_not_know(frame: int) -> None:
    station, recorder = guided()
    station.setpoint((1, 2, -3), mask=POSITION_ONLY, frame=frame)
    assert (recorder.taken, recorder.halts) == ([], 1)


def test_ardupilot_ignores_setpoints_outside_guided() -> None:
    station, recorder = guided()
    station.set_mode(Mode.STABILIZE)
    station.forget()
    station.setpoint((1, 2, -3), mask=POSITION_ONLY)
    station.setpoint((1, 2, -3), mask=0xFFF)
    assert (recorder.taken, recorder.halts, station.heard) == ([], 0, [])


def test_frames_that_hang_on_the_vehicle() -> None:
    station, recorder = guided()
    estimate = station.endpoint.vehicle.estimate
    north, east, down = estimate.position_ned_m
    cosine, sine = math.cos(estimate.yaw_rad), math.sin(estimate.yaw_rad)
    station.setpoint((3, 0, -1), mask=POSITION_ONLY, frame=mavlink.MAV_FRAME_LOCAL_OFFSET_NED)
    station.setpoint((3, 0, -1), mask=POSITION_ONLY, frame=mavlink.MAV_FRAME_BODY_OFFSET_NED)
    station.setpoint((0, 0, 0), (2, 1, 0), mask=VELOCITY_ONLY, frame=BODY)
    offset, forward, velocity = recorder.taken
    assert offset.position_ned_m == pytest.approx((north + 3, east, down - 1))
    assert forward.position_ned_m == pytest.approx((north + 3 * cosine, east + 3 * sine, down - 1))
    assert velocity.velocity_ned_m_s == pytest.approx((2 * cosine - sine, 2 * sine + cosine, 0))


def test_px4_frees_each_axis_by_itself() -> None:
    station, recorder = guided(Flavour.PX4)
    nan = math.nan
    station.setpoint((1, 2, -3), (nan, 5, 6), (nan, nan, nan), mask=0b100_000_000_100, yaw=nan)
    assert recorder.taken == [Setpoint(position_ned_m=(1, 2, None), velocity_ned_m_s=(None, 5, 6))]


def test_px4_says_what_it_cannot_do() -> None:
    station, recorder = guided(Flavour.PX4)
    station.setpoint((1, 2, -3), mask=POSITION_ONLY, frame=7)
    station.setpoint((1, 2, -3), mask=0xFFF)
    station.setpoint((1, 2, -3), mask=ALL | 0x200)
    assert recorder.taken == []
    said = "".join(station.texts())
    for words in ("coordinate frame 7 unsupported", "invalid", "force not supported"):
        assert words in said


def test_px4_in_body_axes_takes_motion_only() -> None:
    station, recorder = guided(Flavour.PX4)
    station.setpoint((9, 9, 9), (1, 0, 0), mask=POSITION_VELOCITY, frame=BODY)
    (taken,) = recorder.taken
    assert taken.position_ned_m == FREE
    north, east, down = taken.velocity_ned_m_s
    assert north is not None
    assert east is not None
    assert down is not None
    assert math.hypot(north, east, down) == pytest.approx(1.0)


@pytest.mark.parametrize("flavour", Flavour)
@pytest.mark.parametrize("bad", [math.inf, -math.inf])
def test_numbers_that_are_none_are_dropped(flavour: Flavour, bad: float) -> None:
    station, recorder = guided(flavour)
    station.setpoint((1, bad, -3), mask=POSITION_ONLY)
    assert recorder.taken == []


@pytest.mark.parametrize("flavour", Flavour)
def test_global_setpoints_arrive_at_the_same_place(flavour: Flavour) -> None:
    station, recorder = guided(flavour)
    vehicle = station.endpoint.vehicle
    assert vehicle.estimate.origin is not None
    assert vehicle.autopilot.home is not None
    place = geodetic_at(vehicle.estimate.origin, (30.0, -20.0, -10.0))
    home_m = vehicle.autopilot.home.alt_m
    for frame, height in ((mavlink.MAV_FRAME_GLOBAL_INT, place.alt_m), (6, place.alt_m - home_m)):
        station.send(
            mavlink.MAVLink_set_position_target_global_int_message(
                0, 1, 1, frame, POSITION_ONLY, round(place.lat_deg * 1e7), round(place.lon_deg * 1e7), height, *(0,) * 8
            )
        )
    assert len(recorder.taken) == 2
    for taken in recorder.taken:
        assert taken.position_ned_m == pytest.approx((30.0, -20.0, -10.0), abs=0.02)


def test_a_place_off_the_earth_stops_ardupilot() -> None:
    station, recorder = guided()
    for lat, mask, frame in ((950_000_000, POSITION_ONLY, 5), (0, VELOCITY_ONLY, 1)):
        station.send(
            mavlink.MAVLink_set_position_target_global_int_message(0, 1, 1, frame, mask, lat, 0, 10.0, *(0,) * 8)
        )
    assert (recorder.taken, recorder.halts) == ([], 2)


def test_px4_refuses_frames_of_global_setpoints_with_words() -> None:
    station, recorder = guided(Flavour.PX4)
    station.send(mavlink.MAVLink_set_position_target_global_int_message(0, 1, 1, 1, 0xDF8, 0, 0, 10.0, *(0,) * 8))
    assert recorder.taken == []
    assert "invalid coordinate frame 1" in "".join(station.texts())


@pytest.mark.parametrize("flavour", Flavour)
def test_a_stream_of_setpoints_is_flown_and_echoed(flavour: Flavour) -> None:
    station = Station(endpoint_of(flavour))
    station.take_off(8.0)
    station.run(4.0)
    estimate = station.endpoint.vehicle.estimate
    goal = (estimate.position_ned_m[0] + 4.0, estimate.position_ned_m[1] - 3.0, estimate.position_ned_m[2] - 1.0)

    def stream(seconds: float) -> None:
        for _ in range(round(seconds * 20)):
            station.setpoint(goal, mask=POSITION_VELOCITY & ~0x400)
            station.run(0.05)

    stream(1.0)
    assert station.set_mode(Mode.GUIDED) == mavlink.MAV_RESULT_ACCEPTED
    stream(12.0)
    assert station.endpoint.vehicle.autopilot.mode is Mode.GUIDED
    assert station.endpoint.vehicle.estimate.position_ned_m == pytest.approx(goal, abs=0.6)
    assert station.request(mavlink.MAVLINK_MSG_ID_POSITION_TARGET_LOCAL_NED) == mavlink.MAV_RESULT_ACCEPTED
    echo = station.last("POSITION_TARGET_LOCAL_NED")
    assert (echo.x, echo.y, echo.z) == pytest.approx(goal, abs=0.01)
    assert echo.coordinate_frame == LOCAL


@pytest.mark.parametrize("flavour", Flavour)
@pytest.mark.parametrize(("system", "component", "taken"), [(1, 1, True), (0, 0, True), (2, 1, False), (2, 0, False)])
def test_setpoints_for_another_vehicle_are_not_taken(
    flavour: Flavour, system: int, component: int, *, taken: bool
) -> None:
    station = Station(endpoint_of(flavour))
    station.take_off()
    autopilot = station.endpoint.vehicle.autopilot
    if flavour is Flavour.PX4:
        station.setpoint((1.0, 2.0, -5.0), mask=0xDF8)
    assert station.set_mode(Mode.GUIDED) == mavlink.MAV_RESULT_ACCEPTED
    station.send(
        mavlink.MAVLink_set_position_target_local_ned_message(
            0, system, component, 1, 0xDF8, 7, 8, -9, 0, 0, 0, 0, 0, 0, 0, 0
        )
    )
    assert autopilot.target is not None
    assert (autopilot.target.position_ned_m == (7.0, 8.0, -9.0)) is taken
